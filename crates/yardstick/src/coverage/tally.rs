//! Counts of answers, which merge and can be kept in a file.

use serde::{Deserialize, Serialize};

use super::outcome::{Answer, FaultKind, Outcome};

/// How many widths there were of about each size: sixteen steps for each power of ten from 1e-20 to 10.
#[derive(Clone, Debug, Default, Serialize, Deserialize, PartialEq)]
pub struct Widths {
    /// By step; shorter than all steps if the rest is 0.
    counts: Vec<u64>,
    /// The greatest of all.
    pub most: f64,
}

const STEPS_PER_DECADE: f64 = 16.0;
const DECADES_BELOW_ONE: f64 = 20.0;
const STEPS: usize = 16 * 21;

impl Widths {
    fn add(&mut self, width: f64) {
        let step = ((width.log10() + DECADES_BELOW_ONE) * STEPS_PER_DECADE).ceil();
        // Widths of 0, and what is beyond either end, count at the ends.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 0 and the number of steps")]
        let step = step.clamp(0.0, (STEPS - 1) as f64) as usize;
        self.add_to(step, 1);
        self.most = self.most.max(width);
    }

    fn add_to(&mut self, step: usize, count: u64) {
        if self.counts.len() <= step {
            self.counts.resize(step + 1, 0);
        }
        self.counts[step] += count;
    }

    fn merge(&mut self, other: &Self) {
        other.counts.iter().enumerate().for_each(|(step, &count)| self.add_to(step, count));
        self.most = self.most.max(other.most);
    }

    /// A width that 99 % do not exceed: the upper end of a step.
    #[must_use]
    pub fn p99(&self) -> f64 {
        let all: u64 = self.counts.iter().sum();
        let wanted = (all * 99).div_ceil(100);
        let mut seen = 0;
        let step = self.counts.iter().position(|count| {
            seen += count;
            seen >= wanted && wanted > 0
        });
        match step {
            None | Some(0) => 0.0,
            Some(step) => 10f64.powf(step as f64 / STEPS_PER_DECADE - DECADES_BELOW_ONE).min(self.most),
        }
    }
}

/// What came of answers of one sort.
#[derive(Clone, Debug, Default, Serialize, Deserialize, PartialEq)]
pub struct Tally {
    /// Answers.
    pub count: u64,
    /// Those where the forms overlap or meet.
    pub overlaps: u64,
    /// Those that proved neither hit nor miss.
    pub undecided: u64,
    /// Those with anything wrong.
    pub failed: u64,
    /// Those that the budget of the exact tier ended, wider than rounding makes them.
    pub unfinished: u64,
    /// Those on which the oracle's own bounds are farther apart than 1e-13·s, so that it judges less sharply.
    pub blurred: u64,
    /// Answers for each kind of fault, in order of [`FaultKind::ALL`].
    by_fault: Vec<u64>,
    /// Of the intervals in the exact tier.
    pub widths: Widths,
}

/// What the oracle should be narrower than, as a part of s.
const BLURRED: f64 = 1e-13;

impl Tally {
    /// Adds an answer.
    pub fn add(&mut self, outcome: &Outcome, answer: &Answer) {
        self.count += 1;
        self.overlaps += u64::from(outcome.overlaps);
        self.undecided += u64::from(answer.is_undecided);
        self.failed += u64::from(!answer.faults.is_empty());
        self.unfinished += u64::from(answer.is_unfinished);
        self.blurred += u64::from(outcome.blur > BLURRED);
        self.by_fault.resize(FaultKind::ALL.len(), 0);
        for (slot, kind) in self.by_fault.iter_mut().zip(FaultKind::ALL) {
            *slot += u64::from(answer.faults.iter().any(|fault| fault.kind == kind));
        }
        if let Some(width) = answer.width {
            self.widths.add(width);
        }
    }

    /// Takes in another.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.overlaps += other.overlaps;
        self.undecided += other.undecided;
        self.failed += other.failed;
        self.unfinished += other.unfinished;
        self.blurred += other.blurred;
        self.by_fault.resize(FaultKind::ALL.len(), 0);
        for (slot, more) in self.by_fault.iter_mut().zip(&other.by_fault) {
            *slot += more;
        }
        self.widths.merge(&other.widths);
    }

    /// Answers with this kind of fault.
    #[must_use]
    pub fn with(&self, kind: FaultKind) -> u64 {
        FaultKind::ALL.iter().zip(&self.by_fault).find(|(listed, _)| **listed == kind).map_or(0, |(_, &count)| count)
    }

    /// A part of all answers.
    #[must_use]
    pub fn share(&self, part: u64) -> f64 {
        part as f64 / self.count.max(1) as f64
    }
}
