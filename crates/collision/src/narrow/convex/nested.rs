//! A lower bound of the depth from a ball in one core about a point of the other.
//!
//! # Method
//! Two cores are as deep in each other as any ball in the one about a point of the other: within its radius all ways are closed.
//! The greatest is the depth itself where the one core is so shallow in the other that the ball touches the surface in one
//! place only, as a small round form in a large face does, or an edge in the side of a leaf:
//!
//! ```text
//!     .----------.
//!    /    ___     \     the ball about the corner reaches the surface where the way out is shortest
//!   |    ( x )     |
//!    \__/_/_\_____/
//!      other core
//! ```
//!
//! The radius is a concave function of the point, so it is climbed: from where it is, to the point of the other core that lies
//! farthest from the place of the touch, as far as the radius grows.
//!
//! # Source
//! Ours; the climb is that of Frank, Wolfe, "An algorithm for quadratic programming" (1956).
//!
//! # Limits
//! Only forms for whose balls there is a formula hold them: boxes and round cores. Where the greatest ball touches in several
//! places it proves less than the depth.

use glam::{DVec2, DVec3};

use super::{body::Body, ellipsoid, frame::Pair};
use crate::{math::Norm, shape::Core, tolerance::PAIR_ROUNDING};

/// Most points of the other core that the climb goes towards: one or two do for edges, more for faces.
const CLIMBS_MAX: usize = 16;

/// Thirds cut off while the best point on the way is sought.
const CLIMB_STEPS: usize = 60;

/// A ball in one core about a point of the other.
pub(super) struct Nested {
    /// The cores are at least as deep in each other.
    pub(super) radius: f64,
    pub(super) point: DVec3,
    /// Unit vector from `b` to `a` along the shortest way out of the ball's core.
    pub(super) normal: DVec3,
}

/// The greater of the balls about points of either core in the other; `None` if there is none.
pub(super) fn greatest(pair: &Pair<'_>, (on_a, on_b): (DVec3, DVec3)) -> Option<Nested> {
    let in_a = climbed(&pair.a, &pair.b, on_b).map(|ball| Nested { normal: DVec3::ZERO - ball.normal, ..ball });
    let in_b = climbed(&pair.b, &pair.a, on_a);
    match (in_a, in_b) {
        (Some(in_a), Some(in_b)) => Some(if in_b.radius > in_a.radius { in_b } else { in_a }),
        (in_a, in_b) => in_a.or(in_b),
    }
}

/// The greatest ball in `body` about points of `other` that is found from one of them; its normal leads out of `body`.
fn climbed(body: &Body<'_>, other: &Body<'_>, start: DVec3) -> Option<Nested> {
    let mut point = start;
    let (mut radius, mut outward) = ball(body, point)?;
    for _ in 0..CLIMBS_MAX {
        let way = other.support(DVec3::ZERO - outward).point - point;
        let (mut near, mut far) = (0.0, 1.0);
        for _ in 0..CLIMB_STEPS {
            let third = (far - near) / 3.0;
            let [p, q] = [near + third, far - third].map(|share| ball(body, point + way * share));
            if p?.0 < q?.0 { near += third } else { far -= third }
        }
        let next = point + way * (0.5 * near + 0.5 * far);
        let found = ball(body, next)?;
        if found.0 <= radius {
            break;
        }
        (point, radius, outward) = (next, found.0, found.1);
    }
    // The point lies in the other core to one error, and so does the ball in this one.
    let radius = radius - 2.0 * PAIR_ROUNDING;
    (radius > 0.0).then_some(Nested { radius, point, normal: outward })
}

/// The radius of the greatest ball in a core about a point in the pair's frame, but for rounding, and the unit vector to where it
/// touches the surface; `None` where there is no formula for it.
fn ball(body: &Body<'_>, point: DVec3) -> Option<(f64, DVec3)> {
    let local = body.to_local(point - body.position);
    let (radius, outward) = match body.core {
        Core::Cuboid { half_extents } => {
            let inside = *half_extents * body.scale - local.abs();
            let radius = inside.min_element();
            let axis = inside.to_array().iter().position(|&side| side == radius)?;
            (radius, DVec3::AXES[axis] * local[axis].signum())
        }
        Core::Cylinder { half_height, radius } => {
            let (along, across) = upright(local);
            let ends = (half_height * body.scale - local.y.abs(), DVec3::Y * local.y.signum());
            let side = (radius * body.scale - along, across);
            if ends.0 < side.0 { ends } else { side }
        }
        Core::Cone { half_height, radius } => {
            let (from_axis, across) = upright(local);
            let [half_height, radius] = [half_height * body.scale, radius * body.scale];
            let steep = DVec2::new(2.0 * half_height, radius).try_unit()?;
            let slant =
                (steep.dot(DVec2::new(-from_axis, half_height - local.y)), across * steep.x + DVec3::Y * steep.y);
            let base = (local.y + half_height, DVec3::NEG_Y);
            if base.0 < slant.0 { base } else { slant }
        }
        Core::Ellipsoid { radii } => ellipsoid::ball_about(*radii * body.scale, local)?,
        Core::Point | Core::Segment { .. } | Core::Hull(_) | Core::Triangle(_) => return None,
    };
    Some((radius, body.turn(outward)))
}

/// How far a point is from the axis, and the unit vector that leads away from it.
fn upright(local: DVec3) -> (f64, DVec3) {
    let across = DVec3::new(local.x, 0.0, local.z);
    (across.norm(), across.try_unit().unwrap_or(DVec3::X))
}
