//! The first of several certain hits, and from when on there may have been one.
//!
//! # Method
//! Of hits whose intervals overlap, the one of least value is named. As another may in truth come before it, the lower bound of what is
//! named reaches down to that of all: the interval holds both the named shape's own value and the first of all. What is told depends
//! only on hits whose lower bound is not above the least upper one, which are always offered.

use super::{
    ShapeId,
    hits::{Hit, order},
};
use crate::answer::Stop;

/// The first of those that were offered.
pub(super) struct First<H> {
    named: Option<H>,
    earliest: Option<Earliest>,
    limit: f64,
}

/// What leaves open when there may be a hit.
struct Earliest {
    lower: f64,
    value: f64,
    id: Option<ShapeId>,
    stop: Stop,
}

impl<H: Hit> First<H> {
    /// None yet.
    pub(super) fn new() -> Self {
        Self { named: None, earliest: None, limit: f64::INFINITY }
    }

    /// Offers a certain hit.
    pub(super) fn add(&mut self, hit: H) {
        let certificate = hit.certificate();
        let found =
            Earliest { lower: certificate.bound.lower, value: hit.value(), id: hit.id(), stop: certificate.stop };
        self.limit = self.limit.min(certificate.bound.upper);
        if self.earliest.as_ref().is_none_or(|known| found.comes_before(known)) {
            self.earliest = Some(found);
        }
        if self.named.as_ref().is_none_or(|known| order(&hit, known).is_lt()) {
            self.named = Some(hit);
        }
    }

    /// The least upper bound: there surely is one by then.
    pub(super) fn limit(&self) -> f64 {
        self.limit
    }

    /// The hit that is named.
    pub(super) fn into_named(self) -> Option<H> {
        let (mut named, earliest) = (self.named?, self.earliest?);
        let certificate = named.certificate_mut();
        if earliest.lower < certificate.bound.lower {
            certificate.bound.lower = earliest.lower;
            certificate.stop = earliest.stop;
        }
        Some(named)
    }
}

impl Earliest {
    fn comes_before(&self, other: &Self) -> bool {
        let by_lower = self.lower.total_cmp(&other.lower);
        by_lower.then_with(|| self.value.total_cmp(&other.value)).then_with(|| self.id.cmp(&other.id)).is_lt()
    }
}
