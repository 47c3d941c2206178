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
//! farthest from the place of the touch, as far as the radius grows. How steep it is there is known too, which tells the best point of
//! a way in few looks (Kelley, "The cutting-plane method for solving convex programs", 1960), and when there is nothing to be gained.
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
const CLIMBS_MAX: u32 = 16;

/// Points of a way that are looked at for the best: a flat form takes one or two, a round one halves the way each time.
const CLIMB_STEPS: usize = 60;

/// A ball in one core about a point of the other.
pub(super) struct Nested {
    /// The cores are at least as deep in each other.
    pub(super) radius: f64,
    pub(super) point: DVec3,
    /// Unit vector from `b` to `a` along the shortest way out of the ball's core.
    pub(super) normal: DVec3,
    /// How often a better point was looked for.
    pub(super) climbs: u32,
}

/// The greater of the balls about points of either core in the other, each found in so many climbs; `None` if there is none.
pub(super) fn greatest(pair: &Pair<'_>, (on_a, on_b): (DVec3, DVec3), climbs: u32) -> Option<Nested> {
    let in_a = climbed(&pair.a, &pair.b, on_b, climbs).map(|ball| Nested { normal: DVec3::ZERO - ball.normal, ..ball });
    let in_b = climbed(&pair.b, &pair.a, on_a, climbs);
    match (in_a, in_b) {
        (Some(in_a), Some(in_b)) => {
            let climbs = in_a.climbs + in_b.climbs;
            Some(Nested { climbs, ..if in_b.radius > in_a.radius { in_b } else { in_a } })
        }
        (in_a, in_b) => in_a.or(in_b),
    }
}

/// The greatest ball in `body` about points of `other` that is found from one of them in so many climbs; its normal leads out of
/// `body`.
fn climbed(body: &Body<'_>, other: &Body<'_>, start: DVec3, climbs: u32) -> Option<Nested> {
    let mut best = ball(body, start)?;
    let mut used = 0;
    while used < climbs.min(CLIMBS_MAX) {
        let way = other.support(DVec3::ZERO - best.outward).point - best.point;
        // No point of the other core is farther from the plane where the ball touches, so no ball is greater by more.
        let is_higher = -best.outward.dot(way) > PAIR_ROUNDING;
        if !is_higher {
            break;
        }
        used += 1;
        let found = highest_on(body, &best, way)?;
        if found.radius <= best.radius {
            break;
        }
        best = found;
    }
    // The point lies in the other core to one error, and so does the ball in this one.
    let radius = best.radius - 2.0 * PAIR_ROUNDING;
    (radius > 0.0).then_some(Nested { radius, point: best.point, normal: best.outward, climbs: used })
}

/// The greatest ball on the way from a point: where the tangents of the radius at both ends meet is no ball that is smaller, so that
/// place is looked at, and the way is cut there.
fn highest_on(body: &Body<'_>, start: &Ball, way: DVec3) -> Option<Ball> {
    let slope = |ball: &Ball| -ball.outward.dot(way);
    let mut best = *start;
    let (mut near, mut far) = ((0.0, *start), (1.0, ball(body, start.point + way)?));
    for _ in 0..CLIMB_STEPS {
        if far.1.radius > best.radius {
            best = far.1;
        }
        let (up, down) = (slope(&near.1), slope(&far.1));
        let has_top_between = up > 0.0 && down < 0.0;
        if !has_top_between {
            break;
        }
        let share = (far.1.radius - near.1.radius + up * near.0 - down * far.0) / (up - down);
        let bound = near.1.radius + up * (share - near.0);
        let is_worth_it = bound - best.radius > PAIR_ROUNDING && share > near.0 && share < far.0;
        if !is_worth_it {
            break;
        }
        let middle = ball(body, start.point + way * share)?;
        if slope(&middle) > 0.0 {
            near = (share, middle);
            if middle.radius > best.radius {
                best = middle;
            }
        } else {
            far = (share, middle);
        }
    }
    Some(best)
}

/// The greatest ball in a core about a point of the pair's frame, but for rounding.
#[derive(Clone, Copy)]
struct Ball {
    point: DVec3,
    /// Below 0 it is none: the point lies outside.
    radius: f64,
    /// Unit vector to where it touches the surface. Along another way the radius shrinks by no less than the part of it along this.
    outward: DVec3,
}

/// `None` where there is no formula for it.
fn ball(body: &Body<'_>, point: DVec3) -> Option<Ball> {
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
    Some(Ball { point, radius, outward: body.turn(outward) })
}

/// How far a point is from the axis, and the unit vector that leads away from it.
fn upright(local: DVec3) -> (f64, DVec3) {
    let across = DVec3::new(local.x, 0.0, local.z);
    (across.norm(), across.try_unit().unwrap_or(DVec3::X))
}
