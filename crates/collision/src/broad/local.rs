//! Boxes in f32, relative to the origin of a cell, that surely hold the f64 boxes they stand for.
//!
//! # Method
//! The difference to the cell's origin is rounded to f32 and moved outwards by one unit in the last place. Seen from the
//! middle of what is near, f32 tells places apart that are 6e-8 of their distance from there.

use glam::{DVec3, Vec3A};

use super::wide::Wide;
use crate::{math::Aabb, tolerance};

/// A box in metres from the origin of its cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LocalBox {
    pub(super) min: Vec3A,
    pub(super) max: Vec3A,
}

impl LocalBox {
    /// Holds nothing, and changes no box that it is united with.
    pub(super) const NOTHING: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    /// Holds `bounds`, as seen from `origin`.
    pub(super) fn around(bounds: Aabb, origin: DVec3) -> Self {
        let (min, max) = ((bounds.min - origin).as_vec3a(), (bounds.max - origin).as_vec3a());
        Self { min: min - margin(min), max: max + margin(max) }
    }

    /// Holds all that it stands for, back in the world.
    pub(super) fn in_world(self, origin: DVec3) -> Aabb {
        let (min, max) = (self.min.as_dvec3() + origin, self.max.as_dvec3() + origin);
        Aabb::new(min.map(f64::next_down), max.map(f64::next_up))
    }

    pub(super) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub(super) fn contains(self, other: Self) -> bool {
        (self.min.cmple(other.min) & other.max.cmple(self.max)).all()
    }

    pub(super) fn touches(self, other: Self) -> bool {
        (self.min.cmple(other.max) & other.min.cmple(self.max)).all()
    }

    /// Half of the surface area, m².
    pub(super) fn half_area(self) -> f32 {
        let d = self.max - self.min;
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    /// Twice the centre.
    pub(super) fn center_doubled(self) -> Vec3A {
        self.min + self.max
    }

    /// Its six planes, each in all lanes: lower x, y, z, then upper.
    pub(super) fn splat(self) -> [Wide; 6] {
        // One by one: numbers gathered in an array first are written one by one and read four at a time, which waits.
        let [min, max] = [self.min, self.max].map(|corner| corner.to_array());
        let splat = |number: f32| Wide::splat(number);
        [splat(min[0]), splat(min[1]), splat(min[2]), splat(max[0]), splat(max[1]), splat(max[2])]
    }
}

fn margin(coordinate: Vec3A) -> Vec3A {
    coordinate.abs() * tolerance::TREE_WIDENING + Vec3A::splat(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_local_box_holds_what_it_stands_for() {
        let mut state = 1_u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let exponent = (state >> 40) % 120;
            ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * f64::powi(2.0, exponent as i32 - 80)
        };
        let mut tight = 0;
        for _ in 0..100_000 {
            let (a, b) = (DVec3::new(number(), number(), number()), DVec3::new(number(), number(), number()));
            let bounds = Aabb::new(a.min(b), a.max(b));
            let origin = DVec3::new(number(), number(), number());
            let local = LocalBox::around(bounds, origin);
            // Differences of doubles are compared exactly: as a sum of a rounded one and its error.
            let difference = |a: f64, b: f64| {
                let rounded = a - b;
                let part = rounded - a;
                (rounded, (a - (rounded - part)) - (b + part))
            };
            for axis in 0..3 {
                let (low, error) = difference(bounds.min[axis], origin[axis]);
                let below = f64::from(local.min[axis]) - low;
                assert!(below <= 0.0 && below - error <= 0.0, "{bounds:?} from {origin:?}");
                let (high, error) = difference(bounds.max[axis], origin[axis]);
                let above = f64::from(local.max[axis]) - high;
                assert!(above >= 0.0 && above - error >= 0.0, "{bounds:?} from {origin:?}");
                tight += usize::from(above <= high.abs() * 3e-7 + 1e-37);
            }
            assert!(local.in_world(origin).contains(bounds));
        }
        assert_eq!(tight, 300_000, "no wider than it must be");
    }
}
