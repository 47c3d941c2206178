//! The way of one core to another, as far as planes prove it free.
//!
//! # Method
//! A GJK search whose target moves: as soon as a support plane parts the forms, the time goes on to where the moving form
//! would reach that plane, and the search goes on from the same corners. Every plane on the way is a proof, so the time
//! that is reached is a lower bound of the first touch whatever made the search end.
//!
//! ```text
//!      o------->            the way of the origin relative to the difference
//!        |    \   ______
//!      plane 1 \ /      \   each plane that parts the two moves the origin up to itself
//!         plane 2 difference
//! ```
//!
//! # Source
//! Van den Bergen, "Ray casting against general convex objects with application to continuous collision detection" (2004),
//! sections 3 and 4. What was changed: radii stay outside, planes are lowered by their rounding.

use glam::DVec3;

use super::{
    frame::Pair,
    gjk,
    simplex::{Simplex, Vertex},
};
use crate::{
    math::Norm,
    tolerance::{PAIR_ROUNDING, STEP_SHORTENING},
};

/// How far the way is proved to be free.
pub(super) struct Approach {
    /// Free up to this fraction of the way; above 1 it is free to its end.
    pub(super) time: f64,
    /// Unit vector from `b` to `a` of the last plane; 0 if there was none.
    pub(super) normal: DVec3,
    /// What is nearest at that time, if it is known.
    pub(super) simplex: Option<Simplex>,
    pub(super) iterations: u32,
}

/// Advances along `way`, by which `b` goes backwards over the time from 0 to 1, from where the pair is; up to `entry`
/// that is known to be free.
pub(super) fn approach(pair: &Pair<'_>, way: DVec3, entry: f64, budget: u32) -> Approach {
    let radius = pair.radius();
    let toward_a = pair.a.center() - pair.b.center() + way * entry;
    let first = gjk::support(pair, toward_a.try_unit().unwrap_or(DVec3::X));
    let mut simplex = Simplex::of(moved(first, way * entry));
    let mut found = Approach { time: entry, normal: DVec3::ZERO, simplex: None, iterations: 0 };
    let mut is_ahead = true;
    while found.iterations < budget {
        found.iterations += 1;
        let nearest = simplex.point();
        let length = nearest.norm();
        if length <= radius + 2.0 * PAIR_ROUNDING || simplex.vertices().len() == 4 {
            break;
        }
        let ahead = if is_ahead { foreseen(&simplex, way, radius) } else { None };
        let toward = ahead.unwrap_or(nearest / length);
        let vertex = moved(gjk::support(pair, toward), way * found.time);
        let free = toward.dot(vertex.point) - PAIR_ROUNDING - radius;
        let closing = -toward.dot(way);
        let step = if free <= 0.0 {
            0.0
        } else if closing > 0.0 {
            free / closing * STEP_SHORTENING
        } else {
            f64::INFINITY
        };
        if found.time + step > 1.0 {
            found.time = f64::INFINITY;
            break;
        }
        let is_known = simplex.contains(&vertex);
        let is_nearer = if found.time + step > found.time {
            (found.normal, found.time) = (toward, found.time + step);
            if !is_known {
                simplex.push(vertex);
            }
            simplex.go(way * step);
            true
        } else {
            !is_known && simplex.take_in(&vertex)
        };
        // What is foreseen may be wrong: then the plane across what is nearest now has the say.
        if !is_nearer && ahead.is_none() {
            break;
        }
        is_ahead = is_nearer;
    }
    Approach { simplex: Some(simplex), ..found }
}

/// The direction towards the features that are nearest, at the time when they will be as near as `radius`; `None` if that
/// is the present one or if they pass by. For a corner or an edge it is the normal of the touch, which planes only
/// converge to.
fn foreseen(simplex: &Simplex, way: DVec3, radius: f64) -> Option<DVec3> {
    let nearest = simplex.point();
    let across = match simplex.vertices() {
        [_] => way,
        [a, b] => {
            let along = (b.point - a.point).try_unit()?;
            way - along * along.dot(way)
        }
        _ => return None,
    };
    let (toward, speed_sq) = (-nearest.dot(across), across.length_squared());
    let excess = nearest.length_squared() - radius * radius;
    let root = toward * toward - speed_sq * excess;
    if radius > 0.0 && toward > 0.0 && root > 0.0 {
        (nearest + across * (excess / (toward + root.sqrt()))).try_unit()
    } else {
        None
    }
}

/// A vertex after `b` has gone by `-way`.
pub(super) fn moved(vertex: Vertex, way: DVec3) -> Vertex {
    Vertex { point: vertex.point + way, ..vertex }
}
