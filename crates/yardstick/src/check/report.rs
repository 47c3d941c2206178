//! What is said of each file and category.

use std::{
    collections::BTreeMap,
    io::{self, Write},
    time::Duration,
};

use super::{Fault, FaultKind, Outcome};

/// What came of the records of one category of a set.
#[derive(Clone, Debug, Default)]
pub struct CategoryReport {
    /// Records.
    pub count: usize,
    /// Records with anything wrong.
    pub short: usize,
    /// Records for each kind of fault; one record may have several.
    by_kind: [usize; KINDS.len()],
    /// The errors over scale of the values that were compared.
    errors: Vec<f64>,
    /// The first records with faults, and what is wrong with them.
    pub examples: Vec<(u64, Fault)>,
    /// Time spent on asking.
    pub time: Duration,
}

const KINDS: [FaultKind; 5] =
    [FaultKind::Verdict, FaultKind::Unanswered, FaultKind::Value, FaultKind::Witness, FaultKind::Interval];

impl CategoryReport {
    /// Adds a record. At most `examples_max` faulty ones are kept to be shown.
    pub fn add(&mut self, index: u64, outcome: Outcome, time: Duration, examples_max: usize) {
        self.count += 1;
        self.time += time;
        self.errors.extend(outcome.error_over_scale);
        for (slot, kind) in self.by_kind.iter_mut().zip(KINDS) {
            *slot += usize::from(outcome.faults.iter().any(|fault| fault.kind == kind));
        }
        if let Some(fault) = outcome.faults.into_iter().next() {
            self.short += 1;
            if self.examples.len() < examples_max {
                self.examples.push((index, fault));
            }
        }
    }

    /// Records with a fault of this kind.
    #[must_use]
    pub fn with(&self, kind: FaultKind) -> usize {
        KINDS.iter().zip(self.by_kind).find(|(listed, _)| **listed == kind).map_or(0, |(_, count)| count)
    }

    /// The largest error over scale, and the one that 99.9 % of all do not exceed; `None` if none was compared.
    #[must_use]
    pub fn errors(&self) -> Option<(f64, f64)> {
        let mut sorted = self.errors.clone();
        sorted.sort_by(f64::total_cmp);
        let largest = *sorted.last()?;
        // The least number that at least 999 of 1000 errors do not exceed.
        let rank = (sorted.len() * 999).div_ceil(1000);
        Some((largest, sorted[rank - 1]))
    }
}

/// What came of a set.
#[derive(Clone, Debug, Default)]
pub struct SetReport {
    /// Its name.
    pub name: String,
    /// By category.
    pub categories: BTreeMap<String, CategoryReport>,
    /// Said instead of a table, where a set was not asked.
    pub note: Option<String>,
}

impl SetReport {
    /// Time spent on asking.
    #[must_use]
    pub fn time(&self) -> Duration {
        self.categories.values().map(|category| category.time).sum()
    }
}

/// Writes the table of a set.
///
/// # Errors
/// The writer's.
pub fn print_set(out: &mut dyn Write, report: &SetReport) -> io::Result<()> {
    if let Some(note) = &report.note {
        return writeln!(out, "{}: {note}\n", report.name);
    }
    let count: usize = report.categories.values().map(|category| category.count).sum();
    let short: usize = report.categories.values().map(|category| category.short).sum();
    writeln!(out, "{}: {count} records, {short} short, {}", report.name, milliseconds(report.time()))?;
    writeln!(
        out,
        "  {:<16}{:>7}{:>12}{:>12}{:>8}{:>10}{:>7}{:>9}{:>10}{:>12}",
        "category", "count", "max err/s", "p99.9", "wrong", "(no answer", "value", "witness", "interval", "time"
    )?;
    for (name, category) in &report.categories {
        print_category(out, name, category)?;
    }
    writeln!(out)
}

fn print_category(out: &mut dyn Write, name: &str, category: &CategoryReport) -> io::Result<()> {
    let (largest, most) =
        category.errors().map_or(("-".to_owned(), "-".to_owned()), |(a, b)| (format!("{a:.1e}"), format!("{b:.1e}")));
    let unanswered = category.with(FaultKind::Unanswered);
    writeln!(
        out,
        "  {name:<16}{:>7}{largest:>12}{most:>12}{:>8}{:>10}{:>7}{:>9}{:>10}{:>12}",
        category.count,
        category.with(FaultKind::Verdict) + unanswered,
        unanswered,
        category.with(FaultKind::Value),
        category.with(FaultKind::Witness),
        category.with(FaultKind::Interval),
        milliseconds(category.time),
    )?;
    for (index, fault) in &category.examples {
        writeln!(out, "    i={index}: {}", fault.what)?;
    }
    Ok(())
}

fn milliseconds(time: Duration) -> String {
    format!("{:.1} ms", time.as_secs_f64() * 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_counted_once_and_by_kind() {
        let mut report = CategoryReport::default();
        let mut outcome = Outcome { error_over_scale: Some(0.5), faults: vec![] };
        report.add(0, outcome.clone(), Duration::ZERO, 3);
        outcome.fault(FaultKind::Value, "off");
        outcome.fault(FaultKind::Interval, "misses");
        outcome.fault(FaultKind::Interval, "misses again");
        report.add(1, outcome, Duration::ZERO, 3);
        assert_eq!((report.count, report.short), (2, 1));
        assert_eq!((report.with(FaultKind::Value), report.with(FaultKind::Interval)), (1, 1));
        assert_eq!(report.with(FaultKind::Verdict), 0);
        assert_eq!(report.examples.len(), 1);
    }

    #[test]
    fn the_percentile_leaves_one_in_a_thousand_out() {
        let mut report = CategoryReport::default();
        for index in 0..2000_u32 {
            let outcome = Outcome { error_over_scale: Some(f64::from(index)), faults: vec![] };
            report.add(u64::from(index), outcome, Duration::ZERO, 0);
        }
        assert_eq!(report.errors(), Some((1999.0, 1997.0)));
    }
}
