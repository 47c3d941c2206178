//! The stretch of a line inside a body, and what a larger and a smaller body say of the one between them.
//!
//! # Method
//! A body is taken once larger and once smaller by the error of the ray. What enters the larger one may touch, what enters
//! the smaller one does, and the true walls lie between those of the two:
//!
//! ```text
//!           larger  smaller          smaller  larger
//!   ray ------|-------|------------------|-------|----->
//!             [ entry ]                  [  exit ]
//! ```

use glam::DVec3;

use super::{
    crossing::{Crossing, Wall},
    frame::LocalRay,
};
use crate::{
    answer::{Bound, Method, Stop},
    math::Norm,
};

/// A part of a line: metres from its foot, `begin` not after `end`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub begin: f64,
    pub end: f64,
}

impl Stretch {
    /// All of the line that matters.
    pub(super) fn whole(ray: &LocalRay) -> Self {
        Self { begin: -ray.extent, end: ray.extent }
    }

    /// The part in both.
    pub(super) fn and(self, other: Self) -> Option<Self> {
        let both = Self { begin: self.begin.max(other.begin), end: self.end.min(other.end) };
        (both.begin <= both.end).then_some(both)
    }

    /// The least stretch that holds both: the part inside a convex body, if each of them is.
    pub(super) fn hull(self, other: Self) -> Self {
        Self { begin: self.begin.min(other.begin), end: self.end.max(other.end) }
    }
}

/// What bodies around the true one say of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nested {
    /// The true stretch lies within it.
    pub outer: Stretch,
    /// It lies within the true stretch; `None` if the body might be missed.
    pub inner: Option<Stretch>,
    /// The best guess.
    pub best: Stretch,
}

impl Nested {
    /// Of a body whose stretch is known with its surface moved outwards by any growth, inwards if that is negative;
    /// `error` is how far the line and the formula may be off. `None` if it is surely missed.
    pub(super) fn of(error: f64, stretch: impl Fn(f64) -> Option<Stretch>) -> Option<Self> {
        let outer = stretch(error)?;
        Some(Self { outer, inner: stretch(-error), best: stretch(0.0).unwrap_or(outer) })
    }

    /// Where the line crosses the body; `normal_at` tells the outward normal at a point of the line.
    pub(super) fn crossing(self, ray: &LocalRay, normal_at: impl Fn(DVec3) -> DVec3) -> Crossing {
        let Self { outer, inner, best } = self;
        let (entry, exit) = walls(ray, outer, inner);
        let wall = |bound: Bound, best: f64| Wall {
            bound,
            best: best + ray.shift,
            normal: normal_at(ray.foot + ray.direction * best),
            face: None,
        };
        Crossing {
            entry: wall(entry, best.begin),
            exit: wall(exit, best.end),
            certain: inner.is_some(),
            method: Method::ClosedForm,
            stop: Stop::Converged,
            iterations: 1,
        }
    }
}

/// Between what of a larger and of a smaller body, if that is surely crossed, entry and exit lie: metres along the ray.
pub(super) fn walls(ray: &LocalRay, outer: Stretch, inner: Option<Stretch>) -> (Bound, Bound) {
    let moved =
        |lower: f64, upper: f64| Bound::new(lower + ray.shift - ray.error, upper.max(lower) + ray.shift + ray.error);
    match inner {
        Some(inner) => (moved(outer.begin, inner.begin), moved(inner.end.min(outer.end), outer.end)),
        None => (moved(outer.begin, outer.end), moved(outer.begin, outer.end)),
    }
}

/// The stretch inside a ball about the origin; `direction` is a unit vector. The chord is taken from the point nearest
/// to the middle, so that nothing cancels (the naive discriminant loses all digits from far away).
pub(super) fn ball(foot: DVec3, direction: DVec3, radius: f64) -> Option<Stretch> {
    let along = foot.dot(direction);
    let distance = (foot - direction * along).norm();
    if radius < 0.0 || distance > radius {
        return None;
    }
    let half_chord = ((radius - distance) * (radius + distance)).sqrt();
    Some(Stretch { begin: -along - half_chord, end: -along + half_chord })
}

/// The stretch inside an endless cylinder: the line seen along its axis is at `across` from it at its foot, and moves by
/// `speed` per metre.
pub(super) fn tube(ray: &LocalRay, across: DVec3, speed: DVec3, radius: f64) -> Option<Stretch> {
    let speed_length = speed.norm();
    if speed_length * ray.extent <= ray.error {
        return (across.norm() <= radius).then_some(Stretch::whole(ray));
    }
    let Stretch { begin, end } = ball(across, speed / speed_length, radius)?;
    Some(Stretch { begin: begin / speed_length, end: end / speed_length })
}

/// The stretch between two heights, of a line that is at `height` at its foot and climbs by `climb` per metre.
pub(super) fn slab(ray: &LocalRay, height: f64, climb: f64, low: f64, high: f64) -> Option<Stretch> {
    if low > high {
        return None;
    }
    if climb.abs() * ray.extent <= ray.error {
        return (low <= height && height <= high).then_some(Stretch::whole(ray));
    }
    let (a, b) = ((low - height) / climb, (high - height) / climb);
    Some(Stretch { begin: a.min(b), end: a.max(b) })
}
