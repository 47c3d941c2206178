//! Rays against cylinders.
//!
//! # Method
//! The cylinder is an endless one between two planes, taken larger and smaller as a whole:
//!
//! ```text
//!        |<- radius ->|
//!   +----------+------------+  y = +half_height
//!   |          |            |
//!   |          + origin     |
//!   |          |            |
//!   +----------+------------+  y = -half_height
//! ```
//!
//! All points within the error of the cylinder lie in the one that is wider and higher by it, and those within the error
//! of a point of the narrower and lower one lie in the cylinder. Across the axis the chord is that of a circle, measured
//! from the point nearest to the axis.

use glam::DVec3;

use super::{
    crossing::Crossing,
    frame::LocalRay,
    stretch::{self, Nested, Stretch},
};
use crate::math::Norm;

/// Where the line crosses a cylinder about the centre, along y; `None` if surely nowhere.
pub(super) fn crossing(ray: &LocalRay, half_height: f64, radius: f64) -> Option<Crossing> {
    let nested = Nested::of(2.0 * ray.error, |growth| stretch_inside(ray, half_height + growth, radius + growth))?;
    Some(nested.crossing(ray, |point| normal_at(point, half_height, radius)))
}

fn stretch_inside(ray: &LocalRay, half_height: f64, radius: f64) -> Option<Stretch> {
    let (across, speed) = (DVec3 { y: 0.0, ..ray.foot }, DVec3 { y: 0.0, ..ray.direction });
    let between = stretch::slab(ray, ray.foot.y, ray.direction.y, -half_height, half_height)?;
    between.and(stretch::tube(ray, across, speed, radius)?)
}

/// Of the end or of the side, whichever the point lies farther out of.
fn normal_at(point: DVec3, half_height: f64, radius: f64) -> DVec3 {
    let outwards = DVec3 { y: 0.0, ..point };
    if point.y.abs() - half_height > outwards.norm() - radius { DVec3::Y * point.y } else { outwards }
}
