//! Support functions of placed convex forms, written for this purpose alone: what an answer's witnesses are measured by.

use collision::{
    DVec3,
    math::Pose,
    shape::{Convex, Core},
};

/// The largest `direction · (p - position)` over the points of a form at a pose; `direction` in the world, a unit vector.
#[must_use]
pub fn height(convex: &Convex, pose: &Pose, direction: DVec3) -> f64 {
    let local = pose.matrix().transpose() * direction;
    let core = match &convex.core {
        Core::Point => 0.0,
        Core::Segment { half_height } => half_height * local.y.abs(),
        Core::Cuboid { half_extents } => half_extents.dot(local.abs()),
        Core::Hull(hull) => highest(hull.vertices(), local),
        Core::Triangle(corners) => highest(corners, local),
        Core::Cylinder { half_height, radius } => half_height * local.y.abs() + radius * local.x.hypot(local.z),
        Core::Cone { half_height, radius } => {
            let base = radius * local.x.hypot(local.z) - half_height * local.y;
            base.max(half_height * local.y)
        }
        Core::Ellipsoid { radii } => (*radii * local).length(),
    };
    core + convex.radius
}

fn highest(points: &[DVec3], direction: DVec3) -> f64 {
    points.iter().map(|point| point.dot(direction)).fold(f64::NEG_INFINITY, f64::max)
}

/// How far `a` lies beyond `b` along a unit vector from `b` to `a`: a gap, or less than 0 an overlap.
#[must_use]
pub fn gap(a: (&Convex, &Pose), b: (&Convex, &Pose), normal_b_to_a: DVec3) -> f64 {
    let between = (a.1.position - b.1.position).dot(normal_b_to_a);
    between - height(a.0, a.1, -normal_b_to_a) - height(b.0, b.1, normal_b_to_a)
}
