//! The way of a point or of a box, and where it enters a box.
//!
//! # Method
//! A path is tested against the box of a cell in f64, restarted where it enters it, and rounded to f32 there; below, eight
//! boxes are tested at a time. What rounding may shift, the origin and reach once and the direction over the whole length
//! within the cell, widens the path: Ize's factor alone covers the rounding of the test itself only. A path that is known to
//! be short and near is not tested in f64, which costs as much as two nodes.
//!
//! # Source
//! Slab test: Williams, Barrus, Morley, Shirley, "An Efficient and Robust Ray-Box Intersection Algorithm", 2005, with
//! the widening of Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.

use glam::{DVec3, Vec3A, Vec3Swizzles, Vec4};

use super::{
    node::{Lanes, Node},
    wide::Wide,
};
use crate::{
    math::{Aabb, larger, smaller},
    tolerance,
};

/// The way of a point or of a box: `origin + t * direction` for `t >= 0`, and all points within `reach` of it in each
/// component.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// Where it begins (for a box: its centre).
    pub origin: DVec3,
    /// Of any length but 0, components up to 1e150; `t` counts multiples of it.
    pub direction: DVec3,
    /// Half extents of the mover, plus how far from this path the true one may be; 0 for an exact ray. Each at least 0.
    pub reach: DVec3,
}

impl Path {
    /// A `t` before which the path does not enter `bounds`, at least 0; `None` if it surely enters it nowhere from 0 to
    /// `limit`. Whenever this is `Some`, a search along this path offers a leaf of that box.
    #[must_use]
    pub fn entry(&self, bounds: &Aabb, limit: f64) -> Option<f64> {
        Line::new(self).entry(bounds, limit)
    }
}

/// A path made ready for many boxes.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// The path.
    pub path: Path,
    /// ±∞ where the direction is ±0: then a box is entered in that axis at all times or never.
    inverse: DVec3,
    backwards: [bool; 3],
}

impl Line {
    /// Makes a path ready.
    #[must_use]
    pub fn new(path: &Path) -> Self {
        Self { path: *path, inverse: path.direction.recip(), backwards: signs(path.direction) }
    }

    /// As [`Path::entry`].
    #[inline]
    #[must_use]
    pub fn entry(&self, bounds: &Aabb, limit: f64) -> Option<f64> {
        Some(self.stay(bounds, limit)?.0)
    }

    /// The path's reach, and what rounding the walls of a box can shift them by.
    ///
    /// Rounding, derived: a wall is computed as `fl(b ∓ reach)`, off by at most `u(|b| + reach)`, and `reach` itself
    /// was rounded when this slack was added; all other operations have relative errors in `t` only, which
    /// [`tolerance::SLAB_WIDENING`] covers. The path's own origin counts as well, because callers compute it from
    /// positions of that size. The largest component counts for all three, so that a component of the direction whose
    /// inverse overflows cannot lose a box whose wall is a denormal away.
    #[inline]
    fn reach(&self, bounds: &Aabb) -> DVec3 {
        let walls = bounds.min.abs().max(bounds.max.abs());
        let magnitude = (walls + self.path.reach + self.path.origin.abs()).max_element();
        self.path.reach + magnitude * tolerance::SLAB_SLACK
    }

    /// A `t` at or before the entry, and one at or after the exit; `None` if it is surely not entered up to `limit`.
    #[inline]
    fn stay(&self, bounds: &Aabb, limit: f64) -> Option<(f64, f64)> {
        let reach = self.reach(bounds);
        let (low, high) = (bounds.min - reach, bounds.max + reach);
        let near = (select(self.backwards, high, low) - self.path.origin) * self.inverse;
        let far = (select(self.backwards, low, high) - self.path.origin) * self.inverse;
        // The origin in a wall and no motion across it is 0 · ∞ = NaN. As the first operand of these it drops out:
        // the wall counts as entered, which is the safe branch.
        let entry = larger(near.x, larger(near.y, larger(near.z, 0.0)));
        let exit = smaller(far.x, smaller(far.y, smaller(far.z, limit))) * tolerance::SLAB_WIDENING;
        (entry <= exit).then_some((entry * tolerance::SLAB_NARROWING, exit))
    }
}

/// The sign bits of a vector; −0 counts as negative, so that its inverse −∞ is met by the right wall.
fn signs(v: DVec3) -> [bool; 3] {
    v.to_array().map(f64::is_sign_negative)
}

/// Of each component one of the two, without a branch: no processor foresees where a path goes.
#[inline]
fn select(is_first: [bool; 3], first: DVec3, second: DVec3) -> DVec3 {
    let both = [second.to_array(), first.to_array()];
    DVec3::from_array([0, 1, 2].map(|axis| both[usize::from(is_first[axis])][axis]))
}

/// A path within one cell, in f32: `s` counts multiples of its direction from where the cell is entered.
pub(super) struct LocalPath {
    /// Of each axis: whether a box is entered by its upper plane and left by its lower one.
    is_backwards: [bool; 3],
    /// What is taken from the one and from the other: the origin, moved by the reach and by all that was rounded.
    origin_entered: [Vec4; 3],
    origin_left: [Vec4; 3],
    /// 1 over the direction. A finite number for 0, so that there is no 0 · ∞: whoever stands in a wall and does not move
    /// across it has entered at once, whoever stands outside enters beyond any limit.
    inverse: [Vec4; 3],
    times: Times,
}

/// How `s` is told from `t`.
struct Times {
    /// The `t` where `s` is 0, and where the cell is left.
    start: f64,
    end: f64,
    /// `s` for each `t`, a power of two.
    per_unit: f64,
}

impl LocalPath {
    /// `None` if the box of the cell is surely not entered up to `limit`.
    pub(super) fn new(line: &Line, bounds: &Aabb, cell: DVec3, limit: f64) -> Option<Self> {
        let (start, end) = line.stay(bounds, limit)?;
        let path = &line.path;
        let (unit, per_unit) = towards_one(path.direction.abs().max_element());
        let origin = path.origin - cell + path.direction * start;
        // It stays in the box, whatever the limit; below, components of the direction are less than 2.
        let length = (bounds.max - bounds.min + 2.0 * path.reach).max_element();
        let length = smaller((end - start) * per_unit * 2.0, length);
        let positions = path.origin.abs() + cell.abs() + path.direction.abs() * start;
        let rounded = (origin.abs() + path.reach).max_element() + length;
        let slack = rounded * tolerance::TREE_SLACK + positions.max_element() * tolerance::SLAB_SLACK;
        let reach = path.reach + slack;
        Some(Self::of(origin, path.direction * unit, reach, Times { start, end, per_unit }))
    }

    /// Of a path with a unit vector for its direction, whose beginning and end are near the cell compared with its size: `s` is `t`.
    #[inline]
    pub(super) fn near(path: Path, cell: DVec3, limit: f64) -> Self {
        let origin = path.origin - cell;
        let rounded = (origin.abs() + path.reach).max_element() + limit;
        let positions = rounded + cell.abs().max_element();
        let slack = rounded * tolerance::TREE_SLACK + positions * (2.0 * tolerance::SLAB_SLACK);
        Self::of(origin, path.direction, path.reach + slack, Times { start: 0.0, end: limit, per_unit: 1.0 })
    }

    /// With a reach that allows for all that is rounded.
    #[inline]
    fn of(origin: DVec3, direction: DVec3, reach: DVec3, times: Times) -> Self {
        // A box is entered by its upper plane where the direction is negative, and −0 counts as that.
        let forwards = reach.copysign(direction);
        let splat = |v: Vec3A| [v.xxxx(), v.yyyy(), v.zzzz()];
        let (least, greatest) = (Vec3A::splat(f32::MIN), Vec3A::splat(f32::MAX));
        Self {
            is_backwards: signs(direction),
            origin_entered: splat((origin + forwards).as_vec3a()),
            origin_left: splat((origin - forwards).as_vec3a()),
            inverse: splat(direction.as_vec3a().recip().max(least).min(greatest)),
            times,
        }
    }

    /// The `s` of a limit, rounded up.
    #[inline]
    pub(super) fn limit(&self, limit: f64) -> f32 {
        let Times { start, end, per_unit } = self.times;
        ((smaller(limit, end) - start) * per_unit * tolerance::TREE_LIMIT_WIDENING) as f32
    }

    /// The lanes whose boxes are entered before `limit`, and an `s` at or before which each is.
    #[inline]
    pub(super) fn entering(&self, node: &Node, limit: f32) -> (Lanes, Wide) {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let is_backwards = self.is_backwards[axis];
            let entered = node.planes[axis + 3 * usize::from(is_backwards)];
            let left = node.planes[axis + 3 * usize::from(!is_backwards)];
            let inverse = Wide::same(self.inverse[axis]);
            let near = (entered - Wide::same(self.origin_entered[axis])) * inverse;
            let far = (left - Wide::same(self.origin_left[axis])) * inverse;
            (near, far)
        });
        let entry = x.0.max(y.0).max(z.0.max(Wide::splat(0.0)));
        let exit = x.1.min(y.1).min(z.1.min(Wide::splat(limit)));
        (Lanes::of(entry.at_most(exit * Wide::splat(tolerance::TREE_SLAB_WIDENING))), entry)
    }
}

/// A power of two, by which a positive number comes to lie in [1, 2), or as near to it as a normal factor brings it; and what undoes it.
fn towards_one(value: f64) -> (f64, f64) {
    let exponent = ((value.to_bits() >> 52) & 0x7ff) as i64 - 1023;
    let exponent = exponent.clamp(-1022, 1022);
    (f64::from_bits(((1023 - exponent) as u64) << 52), f64::from_bits(((1023 + exponent) as u64) << 52))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_two_brings_a_number_near_to_one() {
        for value in [1.0, 1.999, 3.7e-5, 6.5e17, 1e150, 1e-300] {
            let (factor, inverse) = towards_one(value);
            assert!((1.0..2.0).contains(&(value * factor)) && factor * inverse == 1.0, "{value}");
        }
        for value in [f64::MIN_POSITIVE / 8.0, f64::MAX] {
            let scaled = value * towards_one(value).0;
            assert!(scaled > 0.0 && scaled < 4.0, "{value}");
        }
    }
}
