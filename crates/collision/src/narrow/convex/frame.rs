//! The pair's own frame, in which every kernel works.
//!
//! # Method
//! Positions are differenced in f64 and turned into the axes of the first form, so that far from the origin nothing is
//! lost but what the difference itself loses. Then everything is scaled by a power of two (exactly) so that
//! `S = reach_a + reach_b + |p_b − p_a| + path` lies in [1, 2): every tolerance is a plain number.

use glam::{DMat3, DVec3};

use super::PlacedConvex;
use crate::{
    answer::Bound,
    math::Pose,
    shape::{Convex, Core, Hull},
};

/// A core in the pair's frame.
pub(super) struct Body<'a> {
    /// The form, unscaled, in its own frame.
    pub(super) core: &'a Core,
    /// Radius around the core, scaled.
    pub(super) radius: f64,
    /// From its own axes to those of the frame.
    pub(super) rotation: DMat3,
    /// Where its local origin is.
    pub(super) position: DVec3,
    scale: f64,
}

/// A corner of a core, in the pair's frame, and its number within the core.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub(super) point: DVec3,
    pub(super) index: u32,
}

/// Two cores in one frame.
pub(super) struct Pair<'a> {
    pub(super) a: Body<'a>,
    pub(super) b: Body<'a>,
    scale: f64,
    axes: DMat3,
    origin: DVec3,
}

impl<'a> Pair<'a> {
    /// The frame of a pair whose relative motion covers `path` metres.
    pub(super) fn new(a: PlacedConvex<'a>, b: PlacedConvex<'a>, path: f64) -> Self {
        let axes = a.pose.matrix();
        let apart = b.pose.position - a.pose.position;
        let extent = reach(a.convex) + reach(b.convex) + apart.length() + path;
        let scale = power_of_two_below_reciprocal(extent);
        let body = |convex: &'a Convex, rotation, position: DVec3| Body {
            core: &convex.core,
            radius: convex.radius * scale,
            rotation,
            position: position * scale,
            scale,
        };
        Self {
            a: body(a.convex, DMat3::IDENTITY, DVec3::ZERO),
            b: body(b.convex, relative_rotation(&a.pose, &b.pose), axes.transpose() * apart),
            scale,
            axes,
            origin: a.pose.position,
        }
    }

    /// Sum of the radii around the cores.
    pub(super) fn radius(&self) -> f64 {
        self.a.radius + self.b.radius
    }

    /// A displacement in the world, taken into the frame.
    pub(super) fn displacement_in(&self, world: DVec3) -> DVec3 {
        self.axes.transpose() * world * self.scale
    }

    /// A point of the frame in the world.
    pub(super) fn point_out(&self, point: DVec3) -> DVec3 {
        self.axes * (point / self.scale) + self.origin
    }

    /// A unit vector of the frame in the world.
    pub(super) fn direction_out(&self, direction: DVec3) -> DVec3 {
        (self.axes * direction).normalize() + DVec3::ZERO
    }

    /// A length of the frame in metres; exact.
    pub(super) fn length_out(&self, length: f64) -> f64 {
        length / self.scale + 0.0
    }

    /// A length in metres in the frame; exact.
    pub(super) fn length_in(&self, length: f64) -> f64 {
        length * self.scale
    }

    /// Bounds of a length in metres.
    pub(super) fn bound_out(&self, lower: f64, upper: f64) -> Bound {
        Bound::new(self.length_out(lower), self.length_out(upper))
    }
}

impl Body<'_> {
    /// The corner farthest along `direction`; of equal ones the first.
    pub(super) fn support(&self, direction: DVec3) -> Corner {
        let local = self.rotation.transpose() * direction;
        let index = match self.core {
            Core::Point => 0,
            Core::Segment { .. } => u32::from(local.y > 0.0),
            Core::Cuboid { .. } => {
                u32::from(local.x > 0.0) | u32::from(local.y > 0.0) << 1 | u32::from(local.z > 0.0) << 2
            }
            Core::Hull(hull) => farthest(hull.vertices(), local),
            Core::Triangle(corners) => farthest(corners, local),
            Core::Cylinder { half_height, radius } => {
                let rim = on_circle(local, *radius);
                return self.round_corner(DVec3::new(rim.x, half_height.copysign(local.y), rim.z));
            }
            Core::Cone { half_height, radius } => {
                let rim = on_circle(local, *radius) - DVec3::Y * *half_height;
                let apex = DVec3::Y * *half_height;
                return self.round_corner(if apex.dot(local) >= rim.dot(local) { apex } else { rim });
            }
            Core::Ellipsoid { radii } => {
                let stretched = *radii * local;
                return self.round_corner(*radii * stretched.normalize_or(DVec3::X));
            }
        };
        self.corner(index)
    }

    fn round_corner(&self, local: DVec3) -> Corner {
        Corner { point: self.out(local), index: 0 }
    }

    /// A corner by its number.
    pub(super) fn corner(&self, index: u32) -> Corner {
        Corner { point: self.out(self.local_corner(index)), index }
    }

    /// How many corners the core has.
    pub(super) fn corner_count(&self) -> usize {
        match self.core {
            Core::Point => 1,
            Core::Segment { .. } => 2,
            Core::Cuboid { .. } => 8,
            Core::Hull(hull) => hull.vertices().len(),
            Core::Triangle(_) => 3,
            Core::Cylinder { .. } | Core::Cone { .. } | Core::Ellipsoid { .. } => usize::MAX,
        }
    }

    /// A direction of the core's own frame in the pair's.
    pub(super) fn turn(&self, local: DVec3) -> DVec3 {
        self.rotation * local
    }

    /// A point inside the core.
    pub(super) fn center(&self) -> DVec3 {
        match self.core {
            Core::Point
            | Core::Segment { .. }
            | Core::Cuboid { .. }
            | Core::Cylinder { .. }
            | Core::Cone { .. }
            | Core::Ellipsoid { .. } => self.position,
            Core::Hull(hull) => self.out(mean(hull.vertices())),
            Core::Triangle(corners) => self.out(mean(corners)),
        }
    }

    /// The hull's faces and edges, if the core is a hull.
    pub(super) fn hull(&self) -> Option<&Hull> {
        match self.core {
            Core::Hull(hull) => Some(hull),
            Core::Point
            | Core::Segment { .. }
            | Core::Cuboid { .. }
            | Core::Triangle(_)
            | Core::Cylinder { .. }
            | Core::Cone { .. }
            | Core::Ellipsoid { .. } => None,
        }
    }

    fn out(&self, local: DVec3) -> DVec3 {
        self.rotation * (local * self.scale) + self.position
    }

    fn local_corner(&self, index: u32) -> DVec3 {
        match self.core {
            Core::Point | Core::Cylinder { .. } | Core::Cone { .. } | Core::Ellipsoid { .. } => DVec3::ZERO,
            Core::Segment { half_height } => DVec3::new(0.0, if index == 1 { *half_height } else { -half_height }, 0.0),
            Core::Cuboid { half_extents } => {
                let side = |bit: u32, half: f64| if index >> bit & 1 == 1 { half } else { -half };
                DVec3::new(side(0, half_extents.x), side(1, half_extents.y), side(2, half_extents.z))
            }
            Core::Hull(hull) => hull.vertices()[index as usize],
            Core::Triangle(corners) => corners[index as usize],
        }
    }
}

fn reach(convex: &Convex) -> f64 {
    convex.core.reach() + convex.radius
}

fn mean(points: &[DVec3]) -> DVec3 {
    points.iter().sum::<DVec3>() / points.len() as f64
}

/// The point of a circle about y that is farthest along a direction; any if the direction is along y.
fn on_circle(direction: DVec3, radius: f64) -> DVec3 {
    DVec3::new(direction.x, 0.0, direction.z).normalize_or(DVec3::X) * radius
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

/// The rotation of `b` in the axes of `a`; exactly none where both are turned alike.
fn relative_rotation(a: &Pose, b: &Pose) -> DMat3 {
    if a.rotation == b.rotation { DMat3::IDENTITY } else { a.matrix().transpose() * b.matrix() }
}

/// The power of two that takes `extent` into [1, 2); 1 for 0.
fn power_of_two_below_reciprocal(extent: f64) -> f64 {
    if extent == 0.0 {
        return 1.0;
    }
    // The limits of sizes and coordinates keep the extent between 1e-9 and 1e13, so the exponent field is a normal one.
    let exponent = (extent.to_bits() >> 52) & 0x7FF;
    f64::from_bits((2046 - exponent) << 52)
}

#[cfg(test)]
mod tests {
    use super::power_of_two_below_reciprocal;

    #[test]
    fn the_scaled_extent_lies_in_one_to_two() {
        for extent in [1e-9, 0.3, 1.0, 1.5, 2.0, 3.9999, 7e12] {
            let scaled = extent * power_of_two_below_reciprocal(extent);
            assert!((1.0..2.0).contains(&scaled), "{extent} became {scaled}");
        }
    }
}
