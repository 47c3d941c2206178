//! What is said of each pair of kinds.

use std::{
    collections::BTreeMap,
    io::{self, Write},
};

use serde::Serialize;

use super::{
    forms::Kind,
    judge::{FaultKind, Outcome},
};

/// What came of the pairs of two kinds.
#[derive(Clone, Debug, Default)]
pub struct KindReport {
    /// Pairs asked.
    pub count: usize,
    /// Pairs whose forms the crate refused.
    pub refused: usize,
    /// Pairs that overlap.
    pub overlaps: usize,
    /// Pairs whose overlap was left open.
    pub undecided: usize,
    /// Pairs with anything wrong.
    pub failed: usize,
    /// Those of them whose intervals hold the truth and are wider than they should be, no more.
    pub wide: usize,
    /// Pairs for each kind of fault.
    by_fault: [usize; FaultKind::ALL.len()],
    distance_widths: Vec<f64>,
    depth_widths: Vec<f64>,
    /// Pairs on which the oracle's own bounds are farther apart than 1e-13·s, so that it judges less sharply.
    pub blurred: usize,
}

/// What the oracle should be narrower than, as a part of s.
const BLURRED: f64 = 1e-13;

impl KindReport {
    /// Adds a pair.
    pub fn add(&mut self, outcome: &Outcome) {
        self.count += 1;
        self.overlaps += usize::from(outcome.overlaps);
        self.undecided += usize::from(outcome.is_undecided);
        self.failed += usize::from(!outcome.faults.is_empty());
        let is_wide_only = outcome.faults.iter().all(|fault| fault.kind == FaultKind::Width);
        self.wide += usize::from(is_wide_only && !outcome.faults.is_empty());
        self.blurred += usize::from(outcome.blur > BLURRED);
        self.distance_widths.extend(outcome.distance_width);
        self.depth_widths.extend(outcome.depth_width);
        for (slot, kind) in self.by_fault.iter_mut().zip(FaultKind::ALL) {
            *slot += usize::from(outcome.faults.iter().any(|fault| fault.kind == kind));
        }
    }

    /// Takes in another.
    pub fn merge(&mut self, other: Self) {
        self.count += other.count;
        self.refused += other.refused;
        self.overlaps += other.overlaps;
        self.undecided += other.undecided;
        self.failed += other.failed;
        self.wide += other.wide;
        self.blurred += other.blurred;
        self.distance_widths.extend(other.distance_widths);
        self.depth_widths.extend(other.depth_widths);
        for (slot, more) in self.by_fault.iter_mut().zip(other.by_fault) {
            *slot += more;
        }
    }

    /// Pairs with this kind of fault.
    #[must_use]
    pub fn with(&self, kind: FaultKind) -> usize {
        FaultKind::ALL.iter().zip(self.by_fault).find(|(listed, _)| **listed == kind).map_or(0, |(_, count)| count)
    }

    fn summary(&self, name: String) -> Summary {
        let (distance_p99, distance_max) = p99_and_most(&self.distance_widths);
        let (depth_p99, depth_max) = p99_and_most(&self.depth_widths);
        let share = |part: usize| part as f64 / self.count.max(1) as f64;
        Summary {
            kinds: name,
            count: self.count,
            refused: self.refused,
            overlap_share: share(self.overlaps),
            undecided_share: share(self.undecided),
            distance_width_p99: distance_p99,
            distance_width_max: distance_max,
            depth_width_p99: depth_p99,
            depth_width_max: depth_max,
            failed: self.failed,
            faults: FaultKind::ALL.into_iter().map(|kind| (kind.name(), self.with(kind))).collect(),
            blurred: self.blurred,
        }
    }
}

/// The width that 99 % do not exceed, and the greatest.
fn p99_and_most(widths: &[f64]) -> (f64, f64) {
    let mut sorted = widths.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (sorted.len() * 99).div_ceil(100);
    let p99 = rank.checked_sub(1).and_then(|index| sorted.get(index));
    (p99.copied().unwrap_or(0.0), sorted.last().copied().unwrap_or(0.0))
}

#[derive(Serialize)]
struct Summary {
    kinds: String,
    count: usize,
    refused: usize,
    overlap_share: f64,
    undecided_share: f64,
    distance_width_p99: f64,
    distance_width_max: f64,
    depth_width_p99: f64,
    depth_width_max: f64,
    failed: usize,
    faults: BTreeMap<&'static str, usize>,
    blurred: usize,
}

/// What was asked of which kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Row {
    /// Distance, overlap and depth of a pair.
    Pair(Kind, Kind),
    /// A ray at a form: `overlaps` counts the lines that meet it, the distance's widths are those of the way.
    Ray(Kind),
}

impl Row {
    /// As one word.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Pair(a, b) => format!("{}-{}", a.name(), b.name()),
            Self::Ray(kind) => format!("ray-{}", kind.name()),
        }
    }
}

/// What came of all pairs and rays.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// By what was asked of which kinds.
    pub rows: BTreeMap<Row, KindReport>,
}

impl Report {
    /// All kinds together.
    #[must_use]
    pub fn total(&self) -> KindReport {
        let mut total = KindReport::default();
        self.rows.values().for_each(|report| total.merge(report.clone()));
        total
    }

    /// Takes in another.
    pub fn merge(&mut self, other: Self) {
        for (row, report) in other.rows {
            self.rows.entry(row).or_default().merge(report);
        }
    }

    fn summaries(&self) -> Vec<Summary> {
        let all = self.rows.iter().map(|(row, report)| report.summary(row.name()));
        all.chain([self.total().summary("all".into())]).collect()
    }

    /// The report as JSON: one object for each pair of kinds, and one for all.
    ///
    /// # Errors
    /// The writer's.
    pub fn write_json(&self, out: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer_pretty(out, &self.summaries()).map_err(io::Error::from)
    }

    /// The report as a table.
    ///
    /// # Errors
    /// The writer's.
    pub fn print(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "{:<20}{:>8}{:>9}{:>11}{:>10}{:>9}{:>10}{:>9}{:>8}  faults",
            "kinds", "pairs", "overlap", "undecided", "dist p99", "max", "depth p99", "max", "failed"
        )?;
        for row in self.summaries() {
            let faults: Vec<String> = row
                .faults
                .iter()
                .filter(|(_, count)| **count > 0)
                .map(|(name, count)| format!("{name} {count}"))
                .collect();
            let blurred = if row.blurred > 0 { format!(" (oracle blurred {})", row.blurred) } else { String::new() };
            writeln!(
                out,
                "{:<20}{:>8}{:>8.1}%{:>10.3}%{:>10.1e}{:>9.1e}{:>10.1e}{:>9.1e}{:>8}  {}{blurred}",
                row.kinds,
                row.count,
                100.0 * row.overlap_share,
                100.0 * row.undecided_share,
                row.distance_width_p99,
                row.distance_width_max,
                row.depth_width_p99,
                row.depth_width_max,
                row.failed,
                faults.join(", "),
            )?;
        }
        Ok(())
    }
}
