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
    crossing::Crossing,
    frame::LocalRay,
    stretch::{self, Nested, Stretch},
};

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

impl Round {
    /// Where the line crosses it; `None` if surely nowhere.
    pub(super) fn crossing(&self, ray: &LocalRay) -> Option<Crossing> {
        let nested = Nested::of(2.0 * ray.error, |growth| self.stretch(ray, growth))?;
        Some(nested.crossing(ray, |point| self.normal_at(point)))
    }

    fn normal_at(&self, point: DVec3) -> DVec3 {
        let from_center = point - self.center;
        from_center - self.axis * from_center.dot(self.axis).clamp(-self.half, self.half)
    }

    /// The stretch inside, the surface moved outwards by `growth`.
    fn stretch(&self, ray: &LocalRay, growth: f64) -> Option<Stretch> {
        let radius = self.radius + growth;
        if growth < 0.0 && radius <= 0.0 {
            return None;
        }
        let foot = ray.foot - self.center;
        if self.half == 0.0 {
            return stretch::ball(foot, ray.direction, radius);
        }
        let tip = self.axis * self.half;
        let ends = [foot - tip, foot + tip].map(|foot| stretch::ball(foot, ray.direction, radius));
        ends.into_iter().chain([self.between_ends(ray, growth)]).flatten().reduce(Stretch::hull)
    }

    /// The stretch inside the cylinder between the two ends.
    fn between_ends(&self, ray: &LocalRay, growth: f64) -> Option<Stretch> {
        let foot = ray.foot - self.center;
        let (height, climb) = (foot.dot(self.axis), ray.direction.dot(self.axis));
        let (across, speed) = (foot - self.axis * height, ray.direction - self.axis * climb);
        let half = self.half + growth;
        let between = stretch::slab(ray, height, climb, -half, half)?;
        between.and(stretch::tube(ray, across, speed, self.radius + growth)?)
    }
}
