//! What tells soonest that a box, a ball or a capsule does not touch a triangle: planes between the two.
//!
//! # Method
//! The form is a middle, up to three half axes and a radius, so how far it reaches along any vector is a sum; taken once into the
//! concave form's axes, it is asked against each triangle that a search offers. Tried are the triangle's own plane, and the planes
//! along one of its sides and along the way, or, where nothing moves, along its normal and along the half axis of a capsule.
//! Whatever none of them parts is left to the kernels.
//!
//! ```text
//!       ---.          a side, seen along the way:
//!      ( o  )--> way      |  .        what goes along the way keeps to
//!       '--'       ------>|  . o      its side of the plane through both
//!             plane       |  .
//! ```
//!
//! # Source
//! Separating axes: Gottschalk, Lin, Manocha, "OBBTree" (1996), section 5. The bounds of their errors are ours.
//!
//! # Never
//! A plane that parts less surely than its rounding allows to tell.

use glam::DVec3;
use smallvec::SmallVec;

use super::{Piece, Side, concave::Concave};
use crate::{
    math::Aabb,
    shape::Core,
    tolerance::{AXIS_ROUNDING, CROSS_PRODUCT, RELATIVE_POSE, SQUARE_MIN},
};

/// A form that is a middle, half axes and a radius, in the axes of a concave one.
pub(super) struct Rod {
    middle: DVec3,
    halves: SmallVec<[DVec3; 3]>,
    /// All that it may be off by included.
    radius: f64,
    /// Where it goes; 0 if it stands.
    way: DVec3,
    /// Not below the sum of all its lengths.
    extent: f64,
}

/// The cross product of two vectors, and how far each of its components may be off.
#[derive(Clone, Copy)]
struct Axis {
    vector: DVec3,
    error: f64,
}

impl Axis {
    /// `a` and `b` may be differences that were rounded.
    fn across(a: DVec3, b: DVec3) -> Self {
        let largest = a.abs().max_element() * b.abs().max_element();
        Self { vector: a.cross(b), error: CROSS_PRODUCT * largest }
    }
}

impl Rod {
    /// `None` if the form is something else.
    pub(super) fn of(form: &Side<'_>, concave: &Concave<'_>) -> Option<Self> {
        let Side::Convex(Piece { convex, .. }) = form else { return None };
        if !matches!(convex.core, Core::Point | Core::Segment { .. } | Core::Cuboid { .. }) {
            return None;
        }
        let (own, place) = (concave.place(), form.place());
        let apart = place.pose.position - own.pose.position;
        let mut halves: SmallVec<[DVec3; 3]> = SmallVec::new();
        match convex.core {
            Core::Segment { half_height } => halves.push(place.pose.matrix().y_axis * half_height),
            Core::Cuboid { half_extents } => {
                let axes = place.pose.matrix();
                halves.extend([
                    axes.x_axis * half_extents.x,
                    axes.y_axis * half_extents.y,
                    axes.z_axis * half_extents.z,
                ]);
            }
            _ => {}
        }
        let mut middle = apart;
        if own.pose.rotation.xyz() != DVec3::ZERO {
            let to_local = own.pose.matrix().transpose();
            middle = to_local * apart;
            halves.iter_mut().for_each(|half| *half = to_local * *half);
        }
        let reach = halves.iter().map(|half: &DVec3| half.abs().element_sum()).sum::<f64>();
        let slack = RELATIVE_POSE * (apart.abs().element_sum() + reach) + own.blur + place.blur;
        let radius = convex.radius + slack;
        Some(Self { middle, halves, radius, way: DVec3::ZERO, extent: radius + reach })
    }

    /// The same grown by a margin, metres.
    pub(super) fn grown(mut self, margin: f64) -> Self {
        self.radius += margin;
        self.extent += margin;
        self
    }

    /// The same on its way, which is in the concave form's axes as well.
    pub(super) fn moving(mut self, way: DVec3) -> Self {
        let length = way.abs().element_sum();
        self.way = way;
        self.radius += RELATIVE_POSE * length;
        self.extent += 2.0 * length;
        self
    }

    /// How far it is from its middle in each component, rounded outwards.
    pub(super) fn reach(&self) -> DVec3 {
        let reach = self.halves.iter().fold(DVec3::splat(self.radius), |sum, half| sum + half.abs());
        reach + AXIS_ROUNDING * self.extent
    }

    pub(super) fn middle(&self) -> DVec3 {
        self.middle
    }

    /// A box that surely holds it where it stands.
    pub(super) fn bounds(&self) -> Aabb {
        let reach = self.reach() + AXIS_ROUNDING * self.middle.abs();
        Aabb::new(self.middle - reach, self.middle + reach)
    }

    /// Whether it surely does not touch a piece up to a part of its way. Of what is no triangle nothing is known.
    pub(super) fn is_clear_of(&self, piece: &Side<'_>, part: f64) -> bool {
        match piece {
            Side::Convex(Piece { convex, .. }) => match &convex.core {
                Core::Triangle(corners) if convex.radius == 0.0 => self.is_clear(corners, part),
                _ => false,
            },
            Side::Concave(_) | Side::Space(_) => false,
        }
    }

    /// Whether it is surely farther than `distance` metres from a piece.
    pub(super) fn is_beyond(&mut self, piece: &Side<'_>, distance: f64) -> bool {
        let (radius, extent) = (self.radius, self.extent);
        (self.radius, self.extent) = (radius + distance, extent + distance);
        let is_beyond = distance.is_finite() && self.is_clear_of(piece, 1.0);
        (self.radius, self.extent) = (radius, extent);
        is_beyond
    }

    fn is_clear(&self, &[a, b, c]: &[DVec3; 3], part: f64) -> bool {
        let corners = [a - self.middle, b - self.middle, c - self.middle];
        let farthest = corners[0].abs().max(corners[1].abs()).max(corners[2].abs());
        let extent = farthest.element_sum() + self.extent;
        let sides = [b - a, c - b, a - c];
        let normal = Axis::across(sides[0], c - a);
        let below = normal.vector.dot(corners[0]);
        let ahead = below - normal.vector.dot(self.way) * part;
        if self.is_beside(normal, [below.min(ahead), below.max(ahead)], extent) {
            return true;
        }
        let is_still = self.way == DVec3::ZERO;
        let along = if is_still { normal.vector } else { self.way };
        (0..3).any(|k| {
            let ends = [corners[k], corners[(k + 2) % 3]];
            self.is_parted(Axis::across(sides[k], along), ends, extent)
        }) || match (is_still, self.halves.as_slice()) {
            (true, &[half]) => (0..3).any(|k| {
                let ends = [corners[k], corners[(k + 2) % 3]];
                self.is_parted(Axis::across(sides[k], half), ends, extent)
            }),
            (false, &[half]) => {
                let axis = Axis::across(half, self.way);
                let heights = corners.map(|corner| axis.vector.dot(corner));
                let least = heights[0].min(heights[1]).min(heights[2]);
                let most = heights[0].max(heights[1]).max(heights[2]);
                self.is_beside(axis, [least, most], extent)
            }
            _ => false,
        }
    }

    /// Whether a plane across an axis that is level along a side and along all of the way parts the triangle from the form. `ends`
    /// are a corner of the side and the corner beyond it.
    fn is_parted(&self, axis: Axis, ends: [DVec3; 2], extent: f64) -> bool {
        let [side, beyond] = ends.map(|corner| axis.vector.dot(corner));
        self.is_beside(axis, [side.min(beyond), side.max(beyond)], extent)
    }

    /// Whether it surely lies beside what is from `least` to `most` along an axis, as seen from its middle.
    #[inline]
    fn is_beside(&self, axis: Axis, [least, most]: [f64; 2], extent: f64) -> bool {
        // Most that is not parted is on both sides of the middle, which needs no root.
        (least > 0.0 || most < 0.0)
            && self.reach_along(axis, extent).is_some_and(|reach| least > reach || most < -reach)
    }

    /// How far it reaches along an axis from its middle, times the length of that, and all that the heights of its own points and
    /// of points within `extent` of it may be off by. `None` if the axis is too short to tell.
    ///
    /// With `δ ≤ √3·error` for the axis, a height over `x` is off by at most `(δ + 5u·|axis|)·|x|` (a difference, three products
    /// and two sums), and so is the reach of each half axis; the lengths together are within `extent`.
    fn reach_along(&self, axis: Axis, extent: f64) -> Option<f64> {
        let square = axis.vector.length_squared();
        if square.is_nan() || square < SQUARE_MIN {
            return None;
        }
        let length = square.sqrt();
        let halves: f64 = self.halves.iter().map(|half| axis.vector.dot(*half).abs()).sum();
        Some(halves + length * self.radius + (2.0 * axis.error + AXIS_ROUNDING * length) * extent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{math::Pose, narrow::place::Place, shape::Geometry};

    /// Metres: what the roundings of ten metres leave room for.
    const NEAR: f64 = 1.0 / (1_u64 << 38) as f64;

    /// The mesh of one triangle, and a capsule beside it.
    fn is_clear(form: &Geometry, pose: Pose, way: DVec3, part: f64) -> bool {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Z];
        let mesh = Geometry::mesh(&corners, &[[0, 1, 2]]).expect("a triangle");
        let Side::Concave(concave) = Side::of(&mesh, Place::of(Pose::IDENTITY), None) else { panic!("a mesh") };
        let form = Side::of(form, Place::of(pose), None);
        let rod = Rod::of(&form, &concave).expect("a rod").moving(way);
        rod.is_clear(&corners, part)
    }

    #[test]
    fn a_touch_is_never_taken_for_none_however_near_it_is() {
        let ball = Geometry::sphere(0.5).expect("a ball");
        let at = |height: f64| Pose::at(DVec3::new(0.25, height, 0.25));
        assert!(!is_clear(&ball, at(0.5), DVec3::ZERO, 1.0), "it rests on the triangle");
        assert!(is_clear(&ball, at(0.5 + NEAR), DVec3::ZERO, 1.0));
        assert!(!is_clear(&ball, at(1.5), DVec3::NEG_Y, 1.0), "it ends on the triangle");
        assert!(is_clear(&ball, at(1.5), DVec3::NEG_Y, 1.0 - NEAR));
        assert!(is_clear(&ball, at(1.5), DVec3::X, 1.0));
        let beside = Pose::at(DVec3::new(1.0, 9.0, -0.5));
        assert!(!is_clear(&ball, beside, DVec3::NEG_Y * 10.0, 1.0), "it grazes the corner");
        let beside = Pose::at(DVec3::new(1.0, 9.0, -0.5 - NEAR));
        assert!(is_clear(&ball, beside, DVec3::NEG_Y * 10.0, 1.0));
        let capsule = Geometry::capsule(2.0, 0.25).expect("a capsule");
        let upright = Pose::at(DVec3::new(-0.25, 0.5, 0.5));
        assert!(!is_clear(&capsule, upright, DVec3::ZERO, 1.0), "it leans on the side");
        let upright = Pose::at(DVec3::new(-0.25 - NEAR, 0.5, 0.5));
        assert!(is_clear(&capsule, upright, DVec3::ZERO, 1.0));
    }
}
