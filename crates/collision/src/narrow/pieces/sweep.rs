//! Where a form that moves past a mesh may come, in the mesh's own axes: a straight path and a reach about it.
//!
//! # Method
//! Without turns the form's box goes along a straight line. Otherwise a ball around the form is followed: its centre, seen
//! from the mesh, goes along a curve that departs from its chord by at most an eighth of the greatest acceleration. With
//! `c` the centre in the form, `p` the form's place, `v` its velocity, `ω` its turn and `μ` the mesh's (all relative to the mesh's
//! place), the acceleration is at most `|c|(|ω − μ|² + |ω × μ|) + |μ|²|p| + 2|μ||v|`.
//!
//! # Limits
//! For turns of more than about a radian the path is no longer near: many triangles are then asked.

use glam::{DMat3, DVec3};

use super::Surface;
use crate::{
    broad::Path,
    math::{Aabb, try_unit},
    narrow::convex::PlacedConvex,
    tolerance::{BEND_WIDENING, RELATIVE_POSE},
};

/// How a form moves past a mesh, in the axes of the world.
pub(super) struct Passage {
    /// How far it goes relative to the mesh, metres.
    pub(super) way: DVec3,
    /// How it turns, a rotation vector.
    pub(super) turn: DVec3,
    /// How the mesh turns.
    pub(super) turn_of_mesh: DVec3,
}

/// A form that moves.
pub(super) struct Mover {
    /// Its box at the start, in the mesh's axes.
    start: Aabb,
    /// From the mesh's place to its own, in the axes of the world.
    apart: DVec3,
    /// From its place to the middle of its local box, in the axes of the world.
    arm: DVec3,
    /// Of the ball around it.
    radius: f64,
}

impl Mover {
    /// A convex form that moves past a mesh.
    pub(super) fn convex(mesh: &Surface<'_>, form: PlacedConvex<'_>) -> Self {
        let local = form.convex.local_bounds();
        let center = local.center();
        Self {
            start: mesh.box_of(form),
            apart: form.pose.position - mesh.whole.pose.position,
            arm: form.pose.matrix() * center,
            radius: ball_of(local, form.convex.reach()),
        }
    }

    /// A mesh that moves past another.
    pub(super) fn surface(mesh: &Surface<'_>, other: &Surface<'_>) -> Self {
        let (geometry, pose) = (other.whole.geometry, other.whole.pose);
        Self {
            start: mesh.box_of_surface(other),
            apart: pose.position - mesh.whole.pose.position,
            arm: pose.matrix() * geometry.local_bounds().center(),
            radius: ball_of(geometry.local_bounds(), geometry.reach()),
        }
    }
}

/// Radius of a ball around the middle of a local box that holds the form.
fn ball_of(local: Aabb, reach: f64) -> f64 {
    let center = local.center();
    (local.max - center).max(center - local.min).length().min(reach + center.length())
}

/// The path of a form past a mesh, in the mesh's own axes as they were at the start.
pub(super) fn swept(mesh: &Surface<'_>, mover: &Mover, passage: &Passage) -> Path {
    if passage.turn == DVec3::ZERO && passage.turn_of_mesh == DVec3::ZERO {
        let center = mover.start.center();
        let direction = mesh.displacement_in(passage.way);
        let half = (mover.start.max - center).max(center - mover.start.min);
        return Path { origin: center, direction, reach: half + RELATIVE_POSE * (half.length() + direction.length()) };
    }
    let Passage { way, turn, turn_of_mesh } = *passage;
    let end = turned(-turn_of_mesh, mover.apart + way + turned(turn, mover.arm));
    let (start, end) = (mesh.displacement_in(mover.apart + mover.arm), mesh.displacement_in(end));
    let (arm, speed) = (mover.arm.length(), turn_of_mesh.length());
    let farthest = mover.apart.length().max((mover.apart + way).length());
    let bend = arm * ((turn - turn_of_mesh).length_squared() + turn.cross(turn_of_mesh).length())
        + speed * (speed * farthest + 2.0 * way.length());
    // However far it turns, it stays as near to the mesh's place as it ever is, and so does its chord.
    let departure = (bend / 8.0).min(2.0 * (farthest + arm)) * BEND_WIDENING;
    let slack = RELATIVE_POSE * (farthest + arm + mover.radius) * (1.0 + turn.length() + speed);
    Path { origin: start, direction: end - start, reach: DVec3::splat(mover.radius + departure + slack) }
}

/// A vector after a turn by a rotation vector.
fn turned(turn: DVec3, vector: DVec3) -> DVec3 {
    try_unit(turn).map_or(vector, |axis| DMat3::from_axis_angle(axis, turn.length()) * vector)
}
