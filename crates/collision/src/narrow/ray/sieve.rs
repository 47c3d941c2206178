//! Which triangles a ray surely passes by, told in f32: nearly all of those that a tree offers without a touch.
//!
//! # Method
//! The triangle is seen along the ray, its three corners side by side, and the areas between the ray and its sides are found with an
//! error that allows for f32. What is said is "passed by" or nothing, and what nothing is said of is asked in f64, so no answer depends
//! on it.
//!
//! # Source
//! As in [`super::triangle`]; the bounds are [`tolerance::SIEVE_CORNER`] and [`tolerance::SIEVE_AREA`].

use glam::{DVec3, Mat3A, Vec3A};

use crate::tolerance;

/// A ray made ready to pass by triangles.
pub(super) struct Sieve {
    /// A point of the ray.
    origin: DVec3,
    /// Two unit vectors at right angles to the ray and to each other.
    across: [Vec3A; 2],
    /// How much an area may be off for the error of its corners: for each metre of their coordinates, and beside that.
    doubt: [f32; 2],
}

impl Sieve {
    /// Through `origin`, with two unit vectors at right angles to the ray. Corners are within `reach` of there, and off by `error`, the
    /// ray's own included.
    #[inline]
    pub(super) fn new(origin: DVec3, across: [DVec3; 2], reach: f64, error: f64) -> Self {
        let error = (error + reach * tolerance::SIEVE_CORNER) as f32;
        let doubt = [5.0 * error, 3.0 * error * error + f32::MIN_POSITIVE];
        Self { origin, across: across.map(|across| across.as_vec3a()), doubt }
    }

    /// Whether the ray surely passes a triangle by. Twice the areas between the ray and the sides have both signs then.
    #[inline]
    pub(super) fn passes(&self, corners: [DVec3; 3]) -> bool {
        let [a, b, c] = corners.map(|corner| (corner - self.origin).as_vec3a());
        let by_axis = Mat3A::from_cols(a, b, c).transpose();
        let [x, y] = self.across.map(|across| by_axis * across);
        let areas = x * next(y) - y * next(x);
        let farthest = x.abs().max(y.abs());
        let farthest = farthest.max(next(farthest));
        let [for_each_metre, beside] = self.doubt;
        let doubt = (farthest * tolerance::SIEVE_AREA + for_each_metre) * farthest + beside;
        areas.cmpgt(doubt).any() && areas.cmplt(-doubt).any()
    }
}

/// Of each side the other end.
#[inline]
fn next(corners: Vec3A) -> Vec3A {
    glam::Vec3Swizzles::yzx(corners)
}

#[cfg(test)]
mod tests {
    use super::{super::triangle::across, *};

    struct Dice(u64);

    impl Dice {
        /// From −1 to 1.
        fn number(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.number(), self.number(), self.number())
        }
    }

    /// Of triangles of any size within a reach, at edges and corners as well.
    #[test]
    fn nothing_that_is_touched_is_passed_by() {
        let mut dice = Dice(1);
        let mut passed = 0;
        let count = 200_000;
        for round in 0..count {
            let scale = f64::powi(2.0, round % 81 - 40);
            let middle = dice.vector() * scale;
            let size = scale * f64::powi(2.0, -(round % 27));
            let corners = [(); 3].map(|()| middle + dice.vector() * size);
            let weights = DVec3::new(dice.number(), dice.number(), dice.number()).abs();
            let weights = [weights, DVec3::new(weights.x, weights.y, 0.0), DVec3::X][round as usize % 3];
            let [a, b, c] = corners;
            let point = (a * weights.x + b * weights.y + c * weights.z) / weights.element_sum();
            let direction = dice.vector().normalize();
            let origin = point + direction * (dice.number() * scale);
            let reach = corners.into_iter().map(|corner| (corner - origin).length()).fold(0.0, f64::max);
            let sieve = Sieve::new(origin, across(direction), reach, 1e-15 * reach);
            assert!(!sieve.passes(corners), "{corners:?} at {point:?} along {direction:?}");
            let elsewhere = corners.map(|corner| corner + dice.vector() * (2.0 * size));
            passed += usize::from(sieve.passes(elsewhere));
        }
        assert!(passed * 2 > count as usize, "it says something of most others: {passed}");
    }
}
