//! Rays against balls and capsules.
//!
//! # Method
//! A body of radius r is taken once larger and once smaller by the error of the ray: what enters the larger one may
//! touch, what enters the smaller one does, and the true entry lies between the two. Each root is backward stable: it is
//! the exact one of a radius that differs by a few roundings of the ray's extent, which the error holds as well.
//!
//! # Limits
//! A body of radius 0 has no smaller one: it is never surely hit.

use glam::DVec3;

use super::{
    crossing::{Crossing, Wall},
    frame::LocalRay,
};
use crate::answer::{Bound, Method};

/// All points within `radius` of the segment from `center - axis * half` to `center + axis * half`, relative to the
/// target's centre. With `half` 0 a ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    pub center: DVec3,
    /// Unit vector.
    pub axis: DVec3,
    pub half: f64,
    pub radius: f64,
}

/// A stretch of the line, metres from its foot.
type Stretch = (f64, f64);

impl Round {
    /// Where the line crosses it; `None` if surely nowhere.
    pub(super) fn crossing(&self, ray: &LocalRay) -> Option<Crossing> {
        let error = 2.0 * ray.error;
        let outer = self.stretch(ray, error)?;
        let inner = if self.radius > error { self.stretch(ray, -error) } else { None };
        let best = self.stretch(ray, 0.0).unwrap_or(outer);
        let (entry, exit) = match inner {
            Some(inner) => (Bound::new(outer.0, inner.0), Bound::new(inner.1, outer.1)),
            None => (Bound::new(outer.0, outer.1), Bound::new(outer.0, outer.1)),
        };
        let wall = |bound: Bound, best: f64| Wall {
            bound: Bound::new(bound.lower + ray.shift - ray.error, bound.upper + ray.shift + ray.error),
            best: best + ray.shift,
            normal: self.normal_at(ray.foot + ray.direction * best),
            face: None,
        };
        Some(Crossing {
            entry: wall(entry, best.0),
            exit: wall(exit, best.1),
            certain: inner.is_some(),
            method: Method::ClosedForm,
            iterations: 1,
        })
    }

    fn normal_at(&self, point: DVec3) -> DVec3 {
        let from_center = point - self.center;
        from_center - self.axis * from_center.dot(self.axis).clamp(-self.half, self.half)
    }

    /// The stretch inside, the surface moved outwards by `growth`.
    fn stretch(&self, ray: &LocalRay, growth: f64) -> Option<Stretch> {
        let radius = self.radius + growth;
        let foot = ray.foot - self.center;
        if self.half == 0.0 {
            return ball(foot, ray.direction, radius);
        }
        let tip = self.axis * self.half;
        [ball(foot - tip, ray.direction, radius), ball(foot + tip, ray.direction, radius), self.tube(ray, growth)]
            .into_iter()
            .flatten()
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// The stretch inside the cylinder between the two ends.
    fn tube(&self, ray: &LocalRay, growth: f64) -> Option<Stretch> {
        let foot = ray.foot - self.center;
        let (height, climb) = (foot.dot(self.axis), ray.direction.dot(self.axis));
        let (across, speed) = (foot - self.axis * height, ray.direction - self.axis * climb);
        let (radius, half) = (self.radius + growth, self.half + growth);
        let between = if climb.abs() * ray.extent <= ray.error {
            (height.abs() <= half).then_some((-ray.extent, ray.extent))?
        } else {
            let (a, b) = ((-half - height) / climb, (half - height) / climb);
            (a.min(b), a.max(b))
        };
        let speed_length = speed.length();
        let within = if speed_length * ray.extent <= ray.error {
            (across.length() <= radius).then_some((-ray.extent, ray.extent))?
        } else {
            let (begin, end) = ball(across, speed / speed_length, radius)?;
            (begin / speed_length, end / speed_length)
        };
        let both = (between.0.max(within.0), between.1.min(within.1));
        (both.0 <= both.1).then_some(both)
    }
}

/// The stretch inside a ball about the origin; `direction` is a unit vector. The chord is taken from the point nearest
/// to the middle, so that nothing cancels (the naive discriminant loses all digits from far away).
fn ball(foot: DVec3, direction: DVec3, radius: f64) -> Option<Stretch> {
    let along = foot.dot(direction);
    let distance = (foot - direction * along).length();
    if radius < 0.0 || distance > radius {
        return None;
    }
    let half_chord = ((radius - distance) * (radius + distance)).sqrt();
    Some((-along - half_chord, -along + half_chord))
}
