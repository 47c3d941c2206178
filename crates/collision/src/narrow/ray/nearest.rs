//! The nearest point of a box, a cylinder, a cone or an ellipsoid, and how far each reaches in a direction.
//!
//! # Method
//! Boxes and cylinders clamp, a cone is nearest to its side or to its base:
//!
//! ```text
//!        point *          apex +
//!               \             /|\  * point
//!   +------------+           / | \/
//!   |            |          /  |  \
//!   +------------+         +---+---+
//! ```
//!
//! The nearest point of an ellipsoid is `r²·p / (r² + λ)` with the λ ≥ 0 that puts it on the surface. `1/|r·p/(r² + λ)|` is
//! almost straight in λ and bends to one side, so that Newton's method on it takes few steps and never too long ones.
//!
//! # Source
//! The secular equation as in Moré, Sorensen, "Computing a trust region step" (1983), section 3.
//!
//! # Limits
//! The λ is as good as it gets in a bounded number of steps. What is made of it stays true with any λ: the point is put
//! on the surface, and every direction has its support.

use glam::{DVec2, DVec3};

use crate::{math::Norm, shape::Core};

/// Steps for the λ of an ellipsoid: more than six are rare, whatever the aspect.
const STEPS: usize = 40;

/// A core whose nearest point has a formula; about the origin.
#[derive(Clone, Copy, Debug)]
pub(super) enum Solid {
    Cuboid { half_extents: DVec3 },
    Cylinder { half_height: f64, radius: f64 },
    Cone { half_height: f64, radius: f64 },
    Ellipsoid { radii: DVec3 },
}

/// What a point outside is nearest to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// A point of the core.
    pub point: DVec3,
    /// Unit vector from there.
    pub normal: DVec3,
}

impl Solid {
    pub(super) fn of(core: &Core) -> Option<Self> {
        match *core {
            Core::Cuboid { half_extents } => Some(Self::Cuboid { half_extents }),
            Core::Cylinder { half_height, radius } => Some(Self::Cylinder { half_height, radius }),
            Core::Cone { half_height, radius } => Some(Self::Cone { half_height, radius }),
            Core::Ellipsoid { radii } => Some(Self::Ellipsoid { radii }),
            Core::Point | Core::Segment { .. } | Core::Hull(_) | Core::Triangle(_) => None,
        }
    }

    /// `None` if the point is inside.
    pub(super) fn nearest(&self, point: DVec3) -> Option<Near> {
        let nearest = match *self {
            Self::Cuboid { half_extents } => point.clamp(-half_extents, half_extents),
            Self::Cylinder { half_height, radius } => {
                on_profile(point, |out, y| (out.min(radius), y.clamp(-half_height, half_height)))
            }
            Self::Cone { half_height, radius } => {
                on_profile(point, |out, y| nearest_of_cone(half_height, radius, DVec2::new(out, y)))
            }
            Self::Ellipsoid { radii } => return nearest_of_ellipsoid(radii, point),
        };
        let normal = (point - nearest).try_unit()?;
        Some(Near { point: nearest, normal })
    }

    /// The largest `normal · p` of its points.
    pub(super) fn support(&self, normal: DVec3) -> f64 {
        let out = || DVec2::new(normal.x, normal.z).norm();
        match *self {
            Self::Cuboid { half_extents } => half_extents.dot(normal.abs()),
            Self::Cylinder { half_height, radius } => half_height * normal.y.abs() + radius * out(),
            Self::Cone { half_height, radius } => (half_height * normal.y).max(radius * out() - half_height * normal.y),
            Self::Ellipsoid { radii } => (radii * normal).norm(),
        }
    }
}

/// The nearest point of a body turned about y, from that of its profile.
fn on_profile(point: DVec3, nearest: impl Fn(f64, f64) -> (f64, f64)) -> DVec3 {
    let out = DVec2::new(point.x, point.z).norm();
    let (nearest_out, y) = nearest(out, point.y);
    // Inside of the profile nothing is rounded, so that nothing seems to be outside.
    let share = if nearest_out < out { nearest_out / out } else { 1.0 };
    DVec3::new(point.x * share, y, point.z * share)
}

/// In the plane of the axis, as the distance from it and the height.
fn nearest_of_cone(half_height: f64, radius: f64, point: DVec2) -> (f64, f64) {
    let (apex, rim) = (DVec2::new(0.0, half_height), DVec2::new(radius, -half_height));
    let side = rim - apex;
    let on_base = DVec2::new(point.x.min(radius), -half_height);
    if side.perp_dot(point - apex) <= 0.0 {
        return if point.y >= -half_height { (point.x, point.y) } else { (on_base.x, on_base.y) };
    }
    let along = ((point - apex).dot(side) / side.length_squared()).clamp(0.0, 1.0);
    let on_side = apex + side * along;
    let nearest = if on_side.distance_squared(point) <= on_base.distance_squared(point) { on_side } else { on_base };
    (nearest.x, nearest.y)
}

fn nearest_of_ellipsoid(radii: DVec3, point: DVec3) -> Option<Near> {
    let squares = radii * radii;
    let mut lambda = 0.0;
    for step in 0..STEPS {
        let share = point / (squares + lambda);
        let on_ball = radii * share;
        let size = on_ball.norm();
        if step == 0 && size <= 1.0 {
            return None;
        }
        let next = lambda + (size - 1.0) * size * size / (on_ball * on_ball / (squares + lambda)).element_sum();
        if !(size > 1.0 && next > lambda) || step + 1 == STEPS {
            return Some(Near { point: radii * (on_ball / size), normal: share.try_unit()? });
        }
        lambda = next;
    }
    None
}
