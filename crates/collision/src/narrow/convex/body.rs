//! A core in the pair's frame: its support function, its corners.
//!
//! # Method
//! Directions are taken into the core's own axes, where a box needs three signs, a cylinder, a cone and an ellipsoid one
//! root; the corner that is found is taken back. Of equally high corners the first wins.
//!
//! # Limits
//! A support value is right to [`PAIR_ROUNDING`](crate::tolerance::PAIR_ROUNDING): the point that is returned is off the
//! surface by a few roundings of the reach, and a direction that is off moves it along the surface only.

use glam::{DMat3, DVec3};

use crate::{
    math::Norm,
    shape::{Convex, Core},
};

/// A core in the pair's frame.
pub(super) struct Body<'a> {
    /// The form, unscaled, in its own frame.
    pub(super) core: &'a Core,
    /// Radius around the core, scaled.
    pub(super) radius: f64,
    /// From its own axes to those of the frame.
    pub(super) rotation: DMat3,
    /// Its axes are not those of the frame.
    pub(super) is_turned: bool,
    /// Where its local origin is.
    pub(super) position: DVec3,
    /// What lengths of the form are multiplied by.
    pub(super) scale: f64,
}

/// A corner of a core, in the pair's frame, and its number within the core, or [`Corner::ON_ROUND`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::narrow) struct Corner {
    pub(in crate::narrow) point: DVec3,
    pub(in crate::narrow) index: u32,
}

impl Corner {
    /// The number of points of round cores, which have none.
    pub(super) const ON_ROUND: u32 = u32::MAX;
}

impl<'a> Body<'a> {
    /// A form in its own axes, in metres.
    pub(super) fn in_own_axes(convex: &'a Convex) -> Self {
        let (core, radius) = (&convex.core, convex.radius);
        Self { core, radius, rotation: DMat3::IDENTITY, is_turned: false, position: DVec3::ZERO, scale: 1.0 }
    }
}

impl Body<'_> {
    /// The corner farthest along `direction`; of equal ones the first.
    #[inline(always)]
    pub(super) fn support(&self, direction: DVec3) -> Corner {
        match self.core {
            Core::Point => Corner { point: self.position, index: 0 },
            Core::Hull(hull) => {
                let index = hull.support(self.to_local(direction));
                Corner { point: self.out(hull.vertex(index)), index }
            }
            _ => self.support_of_other(self.to_local(direction)),
        }
    }

    /// The same of cores that a search seldom meets, along a local direction.
    fn support_of_other(&self, local: DVec3) -> Corner {
        let index = match self.core {
            Core::Segment { .. } => u32::from(local.y > 0.0),
            Core::Cuboid { .. } => {
                u32::from(local.x > 0.0) | u32::from(local.y > 0.0) << 1 | u32::from(local.z > 0.0) << 2
            }
            Core::Triangle(corners) => farthest(corners, local),
            Core::Point | Core::Hull(_) => 0,
            Core::Cylinder { .. } | Core::Cone { .. } | Core::Ellipsoid { .. } => {
                return Corner { point: self.out(round_support(self.core, local)), index: Corner::ON_ROUND };
            }
        };
        self.corner(index)
    }

    /// A corner by its number.
    #[inline]
    pub(super) fn corner(&self, index: u32) -> Corner {
        Corner { point: self.out(self.local_corner(index)), index }
    }

    /// How many corners the core has; none that could be counted on round ones.
    pub(super) fn corner_count(&self) -> Option<usize> {
        match self.core {
            Core::Point => Some(1),
            Core::Segment { .. } => Some(2),
            Core::Cuboid { .. } => Some(8),
            Core::Hull(hull) => Some(hull.vertices().len()),
            Core::Triangle(_) => Some(3),
            Core::Cylinder { .. } | Core::Cone { .. } | Core::Ellipsoid { .. } => None,
        }
    }

    /// A direction of the core's own frame in the pair's.
    pub(super) fn turn(&self, local: DVec3) -> DVec3 {
        self.rotation * local
    }

    /// A direction of the pair's frame in the core's own.
    #[inline]
    pub(super) fn to_local(&self, direction: DVec3) -> DVec3 {
        if !self.is_turned {
            return direction;
        }
        let turn = &self.rotation;
        DVec3::new(turn.x_axis.dot(direction), turn.y_axis.dot(direction), turn.z_axis.dot(direction))
    }

    /// A point inside the core.
    pub(super) fn center(&self) -> DVec3 {
        match self.core {
            Core::Hull(hull) => self.out(hull.center()),
            Core::Triangle([a, b, c]) => self.out((*a + *b + *c) / 3.0),
            Core::Point
            | Core::Segment { .. }
            | Core::Cuboid { .. }
            | Core::Cylinder { .. }
            | Core::Cone { .. }
            | Core::Ellipsoid { .. } => self.position,
        }
    }

    /// A local point in the frame.
    #[inline]
    pub(super) fn out(&self, local: DVec3) -> DVec3 {
        let scaled = local * self.scale;
        (if self.is_turned { self.rotation * scaled } else { scaled }) + self.position
    }

    #[inline]
    fn local_corner(&self, index: u32) -> DVec3 {
        match self.core {
            Core::Point | Core::Cylinder { .. } | Core::Cone { .. } | Core::Ellipsoid { .. } => DVec3::ZERO,
            Core::Segment { half_height } => DVec3::new(0.0, if index == 1 { *half_height } else { -half_height }, 0.0),
            Core::Cuboid { half_extents } => {
                let side = |bit: u32, half: f64| if index >> bit & 1 == 1 { half } else { -half };
                DVec3::new(side(0, half_extents.x), side(1, half_extents.y), side(2, half_extents.z))
            }
            Core::Hull(hull) => hull.vertex(index),
            Core::Triangle(corners) => corners[index as usize],
        }
    }
}

/// The point of a round core that is farthest along a local direction.
fn round_support(core: &Core, direction: DVec3) -> DVec3 {
    match core {
        Core::Cylinder { half_height, radius } => {
            let rim = on_circle(direction, *radius);
            DVec3::new(rim.x, half_height.copysign(direction.y), rim.z)
        }
        Core::Cone { half_height, radius } => {
            let rim = on_circle(direction, *radius) - DVec3::Y * *half_height;
            let apex = DVec3::Y * *half_height;
            if apex.dot(direction) >= rim.dot(direction) { apex } else { rim }
        }
        Core::Ellipsoid { radii } => *radii * (*radii * direction).try_unit().unwrap_or(DVec3::X),
        Core::Point | Core::Segment { .. } | Core::Cuboid { .. } | Core::Hull(_) | Core::Triangle(_) => DVec3::ZERO,
    }
}

/// The point of a circle about y that is farthest along a direction; any if the direction is along y.
fn on_circle(direction: DVec3, radius: f64) -> DVec3 {
    DVec3::new(direction.x, 0.0, direction.z).try_unit().unwrap_or(DVec3::X) * radius
}

fn farthest(points: &[DVec3], direction: DVec3) -> u32 {
    let mut best = (0, f64::NEG_INFINITY);
    for (index, point) in (0..).zip(points) {
        let height = point.dot(direction);
        if height > best.1 {
            best = (index, height);
        }
    }
    best.0
}
