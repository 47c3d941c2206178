//! Rays against rounded boxes, cylinders, cones and ellipsoids.
//!
//! # Method
//! The nearest point of the core gives a plane, and the plane says how far the ray is free:
//!
//! ```text
//!                       plane    radius
//!   ray  *--------------->|...........:  core
//!      point           next           nearest point
//! ```
//!
//! The distance from the core is convex along the ray, so that going from plane to plane never passes the wall, ends at
//! once at flat faces and gains digits twice as fast with each step at round ones. It is done for the body larger by the
//! error, which proves the way free whatever the direction of the plane, and on from there for the body itself. A point is
//! proved to be inside by a point of the core that is nearer than the radius less the error; it is sought just beyond the
//! wall. The exit is the entry of the ray that comes the other way.
//!
//! # Source
//! The steps are Newton's; as a ray cast: van den Bergen, "Ray casting against general convex objects" (2004).
//!
//! # Limits
//! Where the radius is within the error, no such point is sought: what crosses the core alone is inside.

use glam::DVec3;

use super::{
    crossing::{Crossing, Wall},
    frame::LocalRay,
    nearest::Solid,
    stretch::{Stretch, walls},
};
use crate::{
    accuracy::Accuracy,
    answer::{Method, Stop},
    math::Norm,
};

/// Steps in search of a point inside: each halves a stretch or makes it four times as long.
const SEARCH: usize = 64;

/// Steps that bring it nearer to the wall, if it was not found at once.
const REFINEMENT: usize = 8;

/// A rounded core about the centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounded {
    pub core: Solid,
    pub radius: f64,
    /// All of it lies within this of the centre.
    pub reach: f64,
}

impl Rounded {
    /// Where the line crosses it; `None` if surely nowhere. `core` tells where it crosses the core alone, which is asked only
    /// if the radius is within the error.
    pub(super) fn crossing(
        &self,
        ray: &LocalRay,
        accuracy: &Accuracy,
        core: impl FnOnce() -> Option<Crossing>,
    ) -> Option<Crossing> {
        let way = |direction: DVec3| Way {
            body: self,
            foot: ray.foot,
            direction,
            end: self.reach + 2.0 * ray.error,
            error: 2.0 * ray.error,
            budget: accuracy.budget,
            steps: 0,
        };
        let (mut there, mut back) = (way(ray.direction), way(-ray.direction));
        let (entry, exit) = (there.arrival()?, back.arrival()?);
        let outer = Stretch { begin: entry.free, end: -exit.free };
        let inner = if self.radius > 2.0 * ray.error {
            entry.inside.zip(exit.inside).map(|(begin, end)| Stretch { begin, end: -end })
        } else {
            let core = core().filter(|core| core.certain);
            core.map(|core| Stretch {
                begin: core.entry.bound.upper - ray.shift,
                end: core.exit.bound.lower - ray.shift,
            })
        };
        let (entry_bound, exit_bound) = walls(ray, outer, inner);
        let wall = |bound, best: f64, normal| Wall { bound, best: best + ray.shift, normal, face: None };
        Some(Crossing {
            entry: wall(entry_bound, entry.best, entry.normal),
            exit: wall(exit_bound, -exit.best, exit.normal),
            certain: inner.is_some(),
            method: Method::Advancement,
            stop: if there.is_spent() || back.is_spent() { Stop::Budget } else { Stop::Converged },
            iterations: there.steps.saturating_add(back.steps),
        })
    }
}

/// The line seen from one of its ends. Distances are metres from the foot.
struct Way<'a> {
    body: &'a Rounded,
    foot: DVec3,
    direction: DVec3,
    /// Beyond this on either side there is nothing.
    end: f64,
    error: f64,
    budget: u32,
    steps: u32,
}

/// What one end sees of the body.
struct Arrival {
    /// Up to there the line is surely outside.
    free: f64,
    /// There it is surely inside.
    inside: Option<f64>,
    best: f64,
    normal: DVec3,
}

/// A place on the way and a plane between it and the core.
struct Place {
    at: f64,
    normal: DVec3,
}

impl Way<'_> {
    fn arrival(&mut self) -> Option<Arrival> {
        let radius = self.body.radius;
        let free = self.go_on(-self.end, radius + self.error)?;
        let best = self.go_on(free.at, radius).unwrap_or(Place { at: free.at, normal: free.normal });
        let inside = if radius > self.error { self.point_inside(&best) } else { None };
        Some(Arrival { free: free.at, inside, best: best.at, normal: best.normal })
    }

    fn point_at(&self, at: f64) -> DVec3 {
        self.foot + self.direction * at
    }

    fn is_spent(&self) -> bool {
        self.steps >= self.budget
    }

    /// From plane to plane until the core is within `radius`; `None` if it never is.
    fn go_on(&mut self, from: f64, radius: f64) -> Option<Place> {
        let core = self.body.core;
        let mut place = Place { at: from, normal: -self.direction };
        loop {
            let point = self.point_at(place.at);
            let Some(near) = core.nearest(point) else { return Some(place) };
            place.normal = near.normal;
            self.steps = self.steps.saturating_add(1);
            let gap = near.normal.dot(point) - core.support(near.normal) - radius;
            if gap <= 0.0 {
                return Some(place);
            }
            let closing = -near.normal.dot(self.direction);
            let next = place.at + gap / closing;
            if closing <= 0.0 || next > self.end {
                return None;
            }
            if next <= place.at || self.is_spent() {
                return Some(place);
            }
            place.at = next;
        }
    }

    /// A place that is surely inside, near the wall.
    fn point_inside(&mut self, wall: &Place) -> Option<f64> {
        let closing = -wall.normal.dot(self.direction);
        let mut low = wall.at;
        let mut high = None;
        let mut step = if closing > 0.0 { 1.25 * self.error / closing } else { self.error };
        for tries in 0..SEARCH {
            let at = high.map_or(low + step, |high: f64| 0.5 * low + 0.5 * high);
            if at <= low || at > self.end || high.is_some_and(|high| at >= high) || self.is_spent() {
                return None;
            }
            match self.closing_at(at) {
                None => return Some(if tries == 0 { at } else { self.refined(low, at) }),
                Some(closing) if closing > 0.0 => low = at,
                Some(_) => high = Some(at),
            }
            step *= 4.0;
        }
        None
    }

    /// A place inside nearer to the wall than `inside`, which is after `outside`.
    fn refined(&mut self, mut outside: f64, mut inside: f64) -> f64 {
        for _ in 0..REFINEMENT {
            let at = 0.5 * outside + 0.5 * inside;
            match self.closing_at(at) {
                None => inside = at,
                Some(_) => outside = at,
            }
        }
        inside
    }

    /// `None` if the place is surely inside, else how fast the core comes nearer there.
    fn closing_at(&mut self, at: f64) -> Option<f64> {
        self.steps = self.steps.saturating_add(1);
        let point = self.point_at(at);
        let near = self.body.core.nearest(point)?;
        let is_inside = (point - near.point).norm() <= self.body.radius - self.error;
        (!is_inside).then(|| -near.normal.dot(self.direction))
    }
}
