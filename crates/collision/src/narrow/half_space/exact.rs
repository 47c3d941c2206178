//! Exact touch of a form and a half space, neither of them turned.
//!
//! # Method
//! A corner `x` of a form of radius `r` touches the half space if `N·x <= (offset + r)·|N|`, where `N` is the normal as
//! sent. Both sides but `|N|` are exact sums; where their signs leave it open, squares are compared. The lowest point of
//! a box, a segment or a polytope is a corner; that of a round core is, if the normal is along the axis it is round
//! about. So a crate that stands on a floor, or on a ramp of 3 in 4, is not left open within rounding.
//!
//! # Source
//! Shewchuk (1997), by [`crate::math::expansion`].
//!
//! # Limits
//! Turned forms, and round cores on a slope: their touch stays open within rounding.

use std::cmp::Ordering;

use glam::DVec3;

use crate::{
    math::{
        Pose,
        expansion::{ExactVector, Expansion, is_in_range},
        scaled_by_power_of_two,
    },
    shape::{Convex, Core, HalfSpace},
};

/// A half space that is not turned, ready for exact questions.
pub(in crate::narrow) struct ExactPlane<'a> {
    half_space: &'a HalfSpace,
    position: DVec3,
    normal: ExactVector,
}

impl<'a> ExactPlane<'a> {
    /// `None` if it is turned, or its numbers are too large or small for exact products.
    pub(in crate::narrow) fn new(half_space: &'a HalfSpace, pose: &Pose) -> Option<Self> {
        let normal = scaled_by_power_of_two(half_space.normal);
        if pose.rotation.xyz() != DVec3::ZERO || !is_in_range(normal) || !is_in_range(DVec3::splat(half_space.offset)) {
            return None;
        }
        let normal = ExactVector::difference(normal, DVec3::ZERO);
        Some(Self { half_space, position: pose.position, normal })
    }

    /// The exact sign of `N·v`.
    pub(in crate::narrow) fn side_of(&self, v: DVec3) -> Option<Ordering> {
        let v = ExactVector::difference(v, DVec3::ZERO);
        v.is_in_range().then(|| self.normal.dot(&v).sign())
    }

    /// The sign of the height of a point, the radius around it taken off: `Greater` is outside. The point is `corner` in
    /// the axes of something at `position`, which has gone by `ways[0] - ways[1]` as seen by the half space.
    pub(in crate::narrow) fn sign(
        &self,
        position: DVec3,
        corner: DVec3,
        radius: f64,
        ways: [DVec3; 2],
    ) -> Option<Ordering> {
        let mut point = ExactVector::difference(position, self.position);
        for axis in 0..3 {
            for part in [corner[axis], ways[0][axis], -ways[1][axis]] {
                point.0[axis].add(part);
            }
        }
        let limit = Expansion::difference(self.half_space.offset, -radius);
        if !point.is_in_range() || !is_in_range(DVec3::splat(radius)) {
            return None;
        }
        let height = self.normal.dot(&point);
        Some(match (height.sign(), limit.sign()) {
            (Ordering::Greater, Ordering::Less | Ordering::Equal) | (Ordering::Equal, Ordering::Less) => {
                Ordering::Greater
            }
            (Ordering::Less, Ordering::Greater | Ordering::Equal) | (Ordering::Equal, Ordering::Greater) => {
                Ordering::Less
            }
            (Ordering::Equal, Ordering::Equal) => Ordering::Equal,
            (Ordering::Greater, Ordering::Greater) => self.compare_squares(&height, &limit),
            (Ordering::Less, Ordering::Less) => self.compare_squares(&height, &limit).reverse(),
        })
    }

    /// Compares `|height|` with `|limit| |N|`.
    fn compare_squares(&self, height: &Expansion, limit: &Expansion) -> Ordering {
        let (mut excess, mut limit_squared) = (Expansion::default(), Expansion::default());
        excess.add_product(height, height);
        limit_squared.add_product(limit, limit);
        excess.add_product(&limit_squared.negated(), &self.normal.dot(&self.normal));
        excess.sign()
    }
}

/// The points of a core, in its own axes, one of which is surely its lowest along `normal`; `near` says which corners may
/// be. `None` if none is known exactly.
pub(super) fn lowest_corners(convex: &Convex, normal: DVec3, near: impl Fn(DVec3) -> bool) -> Option<Vec<DVec3>> {
    let is_along_y = normal.x == 0.0 && normal.z == 0.0;
    let against = |half: DVec3| {
        let side = |axis: usize| if normal[axis] > 0.0 { -half[axis] } else { half[axis] };
        DVec3::from_array([0, 1, 2].map(side))
    };
    match &convex.core {
        Core::Point => Some(vec![DVec3::ZERO]),
        Core::Segment { half_height } => Some(vec![against(DVec3::Y * *half_height)]),
        Core::Cuboid { half_extents } => Some(vec![against(*half_extents)]),
        Core::Hull(hull) => Some(hull.vertices().iter().copied().filter(|&vertex| near(vertex)).collect()),
        Core::Triangle(corners) => Some(corners.to_vec()),
        Core::Cylinder { half_height, .. } | Core::Cone { half_height, .. } if is_along_y => {
            Some(vec![against(DVec3::Y * *half_height)])
        }
        Core::Ellipsoid { radii } => {
            let along = (0..3).find(|&axis| (0..3).all(|other| other == axis || normal[other] == 0.0))?;
            Some(vec![against(DVec3::AXES[along] * radii[along])])
        }
        Core::Cylinder { .. } | Core::Cone { .. } => None,
    }
}
