//! Rays against cones.
//!
//! # Method
//! A cone is what lies under a nappe and above its base. Within an error of it, all points lie under the nappe moved out by
//! the error (which puts the apex up by more, the more pointed the cone is) and within the cylinder around the cone moved
//! out by it; and those within the error of a point under the nappe moved in, above the base moved in, lie in the cone:
//!
//! ```text
//!           /\          apex, +half_height
//!          /  \
//!         /    \  z: depth under the apex
//!        /      \
//!       +---+----+      base, -half_height
//!           |<-->| radius
//! ```
//!
//! With lengths across the axis as parts of the radius and lengths along it as parts of the height, the nappe is `|u| ≤ w`,
//! and along the line `f = |u|² − w²` is a quadratic, of which three things are taken care of:
//!
//! * It is set up at the point of the line nearest to the apex *in these units*. A point of the nappe at distance ω from
//!   the apex then has `t² + |p0|² = ω²`, and the coefficients' rounding moves it by a few roundings of ω, near the apex as
//!   well as at the base. Coordinates are rounded before they are divided, so that the aspect of the cone costs nothing.
//! * Its discriminant is `|n|² − k²` with the moments `n = v·w0 + u0·c` and `k = u0 × v` of the line about the apex: a
//!   difference of two lengths, each of which is as exact as the numbers it is made of. A rounding of theirs is one
//!   of the slope.
//! * Its roots are `q/a` and `b/q`, so that lines along the side, where one root goes to infinity, lose nothing.
//!
//! # Source
//! The bound is our own. With the discriminant off by δ, at most 12 roundings of |p0|², the residual of both roots is
//! `|f| ≤ 2δ/|a|`, which is small for |a| ≥ ½. For |a| < ½ both |v| and |c| are at least ½, and either w0 ≥ |p0|/4, so that
//! |q| ≥ |p0|/4 and `|f| ≤ 16δ·(1 + t²/|p0|²)`, or |u0|² − w0² ≥ ⅞|p0|², and `|f| ≤ 3δ·(1 + t²/|p0|²)`: at most 192 roundings
//! of 2ω², that is a surface that is moved by 192 roundings of the cone's size. This is three times what
//! [`crate::tolerance::RAY_KERNEL`] allows for a kernel, so the cone is moved by four errors where others are by two.

use glam::{DVec2, DVec3};

use super::{
    crossing::Crossing,
    frame::LocalRay,
    stretch::{self, Nested, Stretch},
};
use crate::math::Norm;

/// A cone about the centre, along y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    half_height: f64,
    radius: f64,
    /// From the apex to the rim.
    side: f64,
}

impl Cone {
    pub(super) fn new(half_height: f64, radius: f64) -> Self {
        Self { half_height, radius, side: DVec2::new(2.0 * half_height, radius).norm() }
    }

    /// Where the line crosses it; `None` if surely nowhere.
    pub(super) fn crossing(&self, ray: &LocalRay) -> Option<Crossing> {
        let nested = Nested::of(4.0 * ray.error, |growth| self.stretch(ray, growth))?;
        Some(nested.crossing(ray, |point| self.normal_at(point)))
    }

    fn stretch(&self, ray: &LocalRay, growth: f64) -> Option<Stretch> {
        let end = self.half_height + growth;
        let mut between = stretch::slab(ray, ray.foot.y, ray.direction.y, -end, end)?;
        if growth > 0.0 {
            // Apex and rim get no longer than the growth, however sharp they are.
            let (across, speed) = (DVec3 { y: 0.0, ..ray.foot }, DVec3 { y: 0.0, ..ray.direction });
            between = between.and(stretch::tube(ray, across, speed, self.radius + growth)?)?;
        }
        between.and(self.under_nappe(ray, self.half_height + growth * (self.side / self.radius))?)
    }

    /// The stretch under the nappe whose apex is at a height.
    fn under_nappe(&self, ray: &LocalRay, apex: f64) -> Option<Stretch> {
        let height = 2.0 * self.half_height;
        let across = |point: DVec3| DVec2::new(point.x, point.z) / self.radius;
        let (u, w) = (across(ray.foot), (apex - ray.foot.y) / height);
        let (v, climb) = (across(ray.direction), ray.direction.y / height);
        let speed = DVec3::new(v.x, v.y, climb).norm();
        let (v, climb) = (v / speed, climb / speed);
        let shift = (w * climb - u.dot(v)) / speed;
        let nearest = ray.foot + ray.direction * shift;
        let line = ScaledLine { u: across(nearest), w: (apex - nearest.y) / height, v, climb };
        let Stretch { begin, end } = line.under_nappe()?;
        Some(Stretch { begin: begin / speed + shift, end: end / speed + shift })
    }

    /// Of the base or of the side, whichever the point lies farther out of.
    fn normal_at(&self, point: DVec3) -> DVec3 {
        let (height, out) = (2.0 * self.half_height, DVec2::new(point.x, point.z));
        let beside = (height * out.norm() - self.radius * (self.half_height - point.y)) / self.side;
        if -self.half_height - point.y > beside {
            return -DVec3::Y;
        }
        let out = out.try_unit().unwrap_or(DVec2::ZERO) * height;
        DVec3::new(out.x, self.radius, out.y)
    }
}

/// A line where the nappe is `|u| ≤ w`; it moves by the unit vector of `v` and `-climb`.
struct ScaledLine {
    u: DVec2,
    w: f64,
    v: DVec2,
    climb: f64,
}

impl ScaledLine {
    fn under_nappe(&self) -> Option<Stretch> {
        let &Self { u, w, v, climb } = self;
        let squared = |long: f64, short: f64| (long - short) * (long + short);
        let a = squared(v.norm(), climb.abs());
        let half_b = u.dot(v) + w * climb;
        let c = squared(u.norm(), w);
        let discriminant = squared((v * w + u * climb).norm(), u.perp_dot(v).abs());
        if discriminant < 0.0 && a >= 0.0 {
            return None;
        }
        let q = -half_b - discriminant.max(0.0).sqrt().copysign(half_b);
        // Both are 0 for a line through the apex.
        let (first, second) = if q == 0.0 { (0.0, 0.0) } else { (q / a, c / q) };
        let both = Stretch { begin: first.min(second), end: first.max(second) };
        if a >= 0.0 {
            // Between the roots the line is under this nappe or over the other one. One end at most is infinite.
            let is_under = w - climb * (0.5 * both.begin + 0.5 * both.end) >= 0.0;
            return is_under.then_some(both);
        }
        // It comes from under one nappe and goes on over the other.
        Some(if climb > 0.0 {
            Stretch { begin: f64::NEG_INFINITY, end: both.begin }
        } else {
            Stretch { begin: both.end, end: f64::INFINITY }
        })
    }
}
