//! Judges of answers: what is asked of a record, and what is wrong with the answers to it.

mod casts;
mod meshes;
mod pairs;
mod rays;
mod toi;

use super::{Answer, Claim, Question, Reply, Verdict};

/// What is wrong with an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// There is no answer.
    Unanswered,
    /// Yes, no or undecided where the truth is otherwise and clear.
    Verdict,
    /// A value is off by more than the tolerance.
    Value,
    /// A normal, a point or a face does not bear out the value.
    Witness,
    /// The truth is not in the interval.
    Interval,
}

/// One thing that is wrong.
#[derive(Clone, Debug)]
pub struct Fault {
    /// What kind of thing.
    pub kind: FaultKind,
    /// In words.
    pub what: String,
}

/// What came of a record.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The largest error of a value, over the record's scale, where a value was compared.
    pub error_over_scale: Option<f64>,
    /// What is wrong; nothing if it is right.
    pub faults: Vec<Fault>,
}

impl Outcome {
    /// Notes a fault.
    pub fn fault(&mut self, kind: FaultKind, what: impl Into<String>) {
        self.faults.push(Fault { kind, what: what.into() });
    }

    /// Compares a value with the truth. NaN is a fault.
    pub(super) fn compare(&mut self, what: &str, value: f64, truth: f64, limit: Limit) {
        let error = (value - truth).abs();
        self.note_error(error / limit.scale);
        if exceeds(error, limit.tolerance) {
            let tolerance = limit.tolerance;
            self.fault(
                FaultKind::Value,
                format!("{what} {value:e}, expected {truth:e}: off by {error:.2e} > {tolerance:.2e}"),
            );
        }
    }

    fn note_error(&mut self, error_over_scale: f64) {
        let error = if error_over_scale.is_nan() { f64::INFINITY } else { error_over_scale };
        self.error_over_scale = Some(self.error_over_scale.map_or(error, |before| before.max(error)));
    }

    /// Checks that an interval holds the truth.
    pub(super) fn hold(&mut self, what: &str, claim: &Claim, truth: f64, slack: f64) {
        if !claim.holds(truth, slack) {
            let Claim { lower, upper, .. } = claim;
            self.fault(FaultKind::Interval, format!("{what} [{lower:e}, {upper:e}] misses {truth:e}"));
        }
    }

    /// Checks a yes or no.
    fn verdict(&mut self, what: &str, found: Verdict, touches: bool) {
        let expected = if touches { Verdict::Hit } else { Verdict::Miss };
        if found != expected {
            self.fault(FaultKind::Verdict, format!("{what} says {found:?}, expected {expected:?}"));
        }
    }

    /// The answer of a reply, or a fault.
    fn answer<'a>(&mut self, what: &str, reply: &'a Reply) -> Option<&'a Answer> {
        match reply {
            Ok(answer) => Some(answer),
            Err(reason) => {
                self.fault(FaultKind::Unanswered, format!("{what}: {reason}"));
                None
            }
        }
    }
}

/// How far a value may be off, and what its error is shown relative to; both metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limit {
    pub(super) tolerance: f64,
    pub(super) scale: f64,
}

/// Whether a number is above a limit; NaN is above every limit, so that it is a fault.
fn exceeds(number: f64, limit: f64) -> bool {
    number.is_nan() || number > limit
}

/// A record of a set: it knows what to ask and what is right.
pub trait Case {
    /// Index in the file.
    fn index(&self) -> u64;

    /// Category.
    fn category(&self) -> &str;

    /// What to ask.
    fn questions(&self) -> Vec<Question>;

    /// What is wrong with the replies: one for each question, in order.
    fn judge(&self, replies: &[Reply]) -> Outcome;
}
