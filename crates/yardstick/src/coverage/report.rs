//! What is said of each sort of answers, and how much of each sort there must be.

use std::{
    collections::BTreeMap,
    io::{self, Write},
};

use serde::{Deserialize, Serialize};

use super::{
    outcome::{Asked, FaultKind, Outcome},
    tally::Tally,
};

/// By what answers are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum By {
    /// What was asked, of convex or of which concave forms.
    Question,
    /// A form that took part.
    Form,
    /// What is hard about it.
    Extreme,
    /// How exact the answer had to be.
    Accuracy,
}

impl By {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Question, Self::Form, Self::Extreme, Self::Accuracy];

    /// The heading of its table.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Question => "question",
            Self::Form => "form",
            Self::Extreme => "extreme",
            Self::Accuracy => "accuracy",
        }
    }
}

/// What the answers of a question are counted as.
#[derive(Clone, Debug, Default)]
pub struct Labels {
    /// The class of the forms: convex, or the most concave of both.
    pub class: &'static str,
    /// Forms that took part, each once.
    pub forms: Vec<&'static str>,
    /// What is hard about it.
    pub extremes: Vec<&'static str>,
    /// The tier, and whether a tolerance was named.
    pub accuracy: &'static str,
}

/// What came of all answers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Sorts of answers.
    pub tables: BTreeMap<By, BTreeMap<String, Tally>>,
    /// Each answer once.
    pub total: Tally,
    /// Questions with a form that the crate refused.
    pub refused: u64,
}

impl Report {
    /// Adds what came of a question.
    pub fn add(&mut self, labels: &Labels, outcome: &Outcome) {
        for answer in &outcome.answers {
            self.total.add(outcome, answer);
            let mut count = |by: By, name: String| {
                self.tables.entry(by).or_default().entry(name).or_default().add(outcome, answer);
            };
            count(By::Question, format!("{} {}", answer.asked.name(), labels.class));
            labels.forms.iter().for_each(|form| count(By::Form, (*form).into()));
            labels.extremes.iter().for_each(|extreme| count(By::Extreme, (*extreme).into()));
            count(By::Accuracy, labels.accuracy.into());
        }
    }

    /// Takes in another.
    pub fn merge(&mut self, other: &Self) {
        for (by, table) in &other.tables {
            for (name, tally) in table {
                self.tables.entry(*by).or_default().entry(name.clone()).or_default().merge(tally);
            }
        }
        self.total.merge(&other.total);
        self.refused += other.refused;
    }

    fn count(&self, by: By, name: &str) -> u64 {
        self.tables.get(&by).and_then(|table| table.get(name)).map_or(0, |tally| tally.count)
    }

    /// Sorts of which there are too few, in words.
    #[must_use]
    pub fn shortages(&self) -> Vec<String> {
        let questions = Asked::ALL.iter().filter(|asked| !asked.is_convex_only()).flat_map(|asked| {
            CLASSES.iter().map(move |(class, least)| (By::Question, format!("{} {class}", asked.name()), *least))
        });
        let warm = Asked::ALL.iter().filter(|asked| asked.is_convex_only());
        let warm = warm.map(|asked| (By::Question, format!("{} convex", asked.name()), LEAST_WARM));
        let named = |by: By, list: &'static [(&'static str, f64)]| {
            list.iter().map(move |(name, least)| (by, (*name).to_owned(), *least))
        };
        let all = questions
            .chain(warm)
            .chain(named(By::Form, FORMS))
            .chain(named(By::Extreme, EXTREMES))
            .chain(named(By::Accuracy, ACCURACIES));
        all.filter_map(|(by, name, least)| {
            let share = self.total.share(self.count(by, &name));
            let (found, wanted) = (100.0 * share, 100.0 * least);
            let what = format!("{} {name}: {found:.3} % of the answers, at least {wanted:.3} % are wanted", by.name());
            (share < least).then_some(what)
        })
        .collect()
    }

    /// The report as JSON.
    ///
    /// # Errors
    /// The writer's.
    pub fn write_json(&self, out: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer_pretty(out, self).map_err(io::Error::from)
    }

    /// The report as tables.
    ///
    /// # Errors
    /// The writer's.
    pub fn print(&self, out: &mut dyn Write) -> io::Result<()> {
        for (by, table) in &self.tables {
            heading(out, by.name())?;
            table.iter().try_for_each(|(name, tally)| line(out, name, tally, self.total.count))?;
            writeln!(out)?;
        }
        heading(out, "all")?;
        line(out, "all", &self.total, self.total.count)?;
        writeln!(out, "forms refused: {} questions", self.refused)
    }
}

impl Asked {
    /// Concave forms remember nothing from one question to the next.
    fn is_convex_only(self) -> bool {
        matches!(self, Self::WarmDistance | Self::WarmPenetration)
    }
}

/// The least share of each question about forms of a class.
const CLASSES: [(&str, f64); 6] = [
    ("convex", 0.01),
    ("mesh", 0.001),
    ("one_sided", 0.001),
    ("solid", 0.001),
    ("height_field", 0.001),
    ("compound", 0.001),
];
const LEAST_WARM: f64 = 0.03;

/// The least share of answers about each form.
const FORMS: &[(&str, f64)] = &[
    ("point", 0.04),
    ("sphere", 0.04),
    ("capsule", 0.04),
    ("box", 0.04),
    ("hull", 0.04),
    ("flat", 0.04),
    ("needle", 0.04),
    ("cylinder", 0.04),
    ("cone", 0.04),
    ("ellipsoid", 0.04),
    ("half_space", 0.04),
    ("rounded", 0.04),
    ("large_hull", 0.0005),
    ("mesh", 0.01),
    ("one_sided", 0.01),
    ("solid", 0.01),
    ("height_field", 0.01),
    ("compound", 0.01),
];

/// The least share of answers to questions that are hard in each way.
const EXTREMES: &[(&str, f64)] = &[
    ("tiny", 0.01),
    ("huge", 0.01),
    ("far_offset", 0.01),
    ("flat", 0.04),
    ("needle", 0.04),
    ("aspect", 0.01),
    ("coplanar", 0.01),
    ("exact_touch", 0.01),
    ("near_touch", 0.01),
    ("identical", 0.01),
    ("concentric", 0.01),
    ("deep_inside", 0.01),
    ("near_parallel", 0.01),
    ("size_ratio", 0.01),
    ("distant", 0.01),
    ("denormal", 0.01),
    ("grazing", 0.005),
    ("zero_motion", 0.002),
    ("enormous_motion", 0.002),
    ("many_turns", 0.001),
];

/// The least share of answers of each accuracy.
const ACCURACIES: &[(&str, f64)] = &[
    ("exact", 0.3),
    ("exact within", 0.05),
    ("standard", 0.04),
    ("standard within", 0.01),
    ("fast", 0.04),
    ("fast within", 0.01),
];

fn heading(out: &mut dyn Write, name: &str) -> io::Result<()> {
    writeln!(
        out,
        "{name:<30}{:>10}{:>8}{:>9}{:>11}{:>10}{:>9}{:>12}{:>8}  faults",
        "answers", "share", "overlap", "undecided", "width p99", "max", "unfinished", "failed"
    )
}

fn line(out: &mut dyn Write, name: &str, tally: &Tally, all: u64) -> io::Result<()> {
    let with = |kind: FaultKind| format!("{} {}", kind.name(), tally.with(kind));
    let faults: Vec<String> = FaultKind::ALL.into_iter().filter(|&kind| tally.with(kind) > 0).map(with).collect();
    let blurred = if tally.blurred > 0 { format!(" (oracle blurred {})", tally.blurred) } else { String::new() };
    writeln!(
        out,
        "{name:<30}{:>10}{:>7.2}%{:>8.1}%{:>10.3}%{:>10.1e}{:>9.1e}{:>12}{:>8}  {}{blurred}",
        tally.count,
        100.0 * tally.count as f64 / all.max(1) as f64,
        100.0 * tally.share(tally.overlaps),
        100.0 * tally.share(tally.undecided),
        tally.widths.p99(),
        tally.widths.most,
        tally.unfinished,
        tally.failed,
        faults.join(", "),
    )
}
