//! Is a point seen from another?
//!
//! # Method
//! Seen is what no shape hides: none touches the straight way between the two, ends included. That way is asked as a ray for any
//! hit, always from the end that comes first by x, then y, then z, so that seeing is mutual, bit by bit.
//!
//! # Limits
//! Sensors hide nothing. The way is taken as the difference of its ends, rounded: an end that a surface goes through to within
//! rounding may be told as undecided.

use std::cmp::Ordering;

use glam::DVec3;

use super::{Filter, HitMode, Meter, QuestionError, Raycast, Snapshot, filter::Sieve};
use crate::{
    accuracy::Accuracy,
    answer::Verdict,
    math::Norm,
    narrow::{Faces, Ray},
};

/// Is a point seen from another?
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// From where, world frame, metres.
    pub eye: DVec3,
    /// What is looked at.
    pub point: DVec3,
    /// What is farther than this, metres, is not looked at.
    pub max_distance: f64,
}

/// Whether a point is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seen {
    /// Proved: nothing touches the way to it.
    Visible,
    /// Proved: something does.
    Hidden,
    /// Neither is proved.
    Undecided,
    /// It is too far away to be looked at.
    Beyond,
}

/// How many points of a target were found to be what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeenCount {
    /// Surely seen.
    pub visible: u32,
    /// Surely hidden.
    pub hidden: u32,
    /// Neither is proved.
    pub undecided: u32,
}

impl SeenCount {
    /// Counts one more. What is beyond is counted nowhere.
    pub fn add(&mut self, seen: Seen) {
        match seen {
            Seen::Visible => self.visible += 1,
            Seen::Hidden => self.hidden += 1,
            Seen::Undecided => self.undecided += 1,
            Seen::Beyond => {}
        }
    }
}

impl Sight {
    /// The way between the two as a ray, from either end (so that both see alike): what it hits hides one from the other. `None` if
    /// it is too long.
    #[must_use]
    pub fn ray(&self) -> Option<Ray> {
        let (from, to) =
            if comes_first(self.point, self.eye) { (self.point, self.eye) } else { (self.eye, self.point) };
        let way = to - from;
        let max_distance = way.norm();
        (max_distance <= self.max_distance).then_some(Ray {
            origin: from,
            // Any direction leads nowhere.
            direction: if way == DVec3::ZERO { DVec3::X } else { way },
            min_distance: 0.0,
            max_distance,
            hollow: false,
            faces: Faces::Both,
        })
    }
}

/// Whether `a` comes before `b` by x, then y, then z.
fn comes_first(a: DVec3, b: DVec3) -> bool {
    let by = |a: f64, b: f64| a.total_cmp(&b);
    by(a.x, b.x).then_with(|| by(a.y, b.y)).then_with(|| by(a.z, b.z)) == Ordering::Less
}

impl Snapshot {
    /// Whether a point is seen from another, past the shapes that the filter lets through; sensors hide nothing. Costs a ray.
    ///
    /// # Errors
    /// [`QuestionError::Interrupted`].
    pub fn sight(
        &self,
        question: &Sight,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Seen, QuestionError> {
        let Some(ray) = question.ray() else { return Ok(Seen::Beyond) };
        let sieve = Sieve::new(filter, None).without_sensors();
        let found = self.cast(&Raycast { ray, mode: HitMode::Any }, &sieve, accuracy, meter)?;
        Ok(match found.verdict {
            Verdict::Hit => Seen::Hidden,
            Verdict::Miss => Seen::Visible,
            Verdict::Undecided => Seen::Undecided,
        })
    }
}
