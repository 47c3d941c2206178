//! Heights with bounds.

use std::cmp::Ordering;

use crate::answer::{Bound, Certificate, Method, Model, Stop, Verdict};

/// Bounds of a signed height, metres, and what is proved: exact touch counts as a hit.
#[derive(Clone, Copy)]
pub(super) struct Signed {
    pub(super) lower: f64,
    pub(super) best: f64,
    pub(super) upper: f64,
    pub(super) verdict: Verdict,
}

impl Signed {
    pub(super) fn new(lower: f64, best: f64, upper: f64) -> Self {
        // Errors are parts of what they belong to, but below the normal numbers.
        let (lower, upper) = (lower - f64::MIN_POSITIVE, upper + f64::MIN_POSITIVE);
        Self { lower, best, upper, verdict: Bound::new(lower, upper).touch_verdict() }
    }

    /// With what the exact sign proves.
    pub(super) fn with_sign(self, sign: Option<Ordering>) -> Self {
        let (lower, upper, verdict) = match sign {
            None => return self,
            Some(Ordering::Less) => (self.lower, 0.0, Verdict::Hit),
            Some(Ordering::Equal) => (0.0, 0.0, Verdict::Hit),
            Some(Ordering::Greater) => (self.lower.max(0.0), self.upper, Verdict::Miss),
        };
        Self { lower, best: self.best.clamp(lower, upper), upper, verdict }
    }

    pub(super) fn certificate(self, verdict: Verdict, stop: Stop) -> Certificate {
        Certificate {
            verdict,
            bound: Bound::new(self.lower + 0.0, self.upper + 0.0),
            model: Model::EXACT,
            method: Method::ClosedForm,
            stop,
            iterations: 1,
        }
    }
}
