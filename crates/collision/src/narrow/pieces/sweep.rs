//! Where a form that moves past a concave one may come, in the concave form's own axes: a straight path and a reach about it.
//!
//! # Method
//! Without turns the form's box goes along a straight line. Otherwise a ball around the form is followed: its centre, seen
//! from the concave form, goes along a curve that departs from its chord by at most an eighth of the greatest acceleration.
//! With `c` the centre in the form, `p` the form's place, `v` its velocity, `ω` its turn and `μ` that of the concave form
//! (all relative to what that turns about), the acceleration is at most `|c|(|ω − μ|² + |ω × μ|) + |μ|²|p| + 2|μ||v|`.
//!
//! # Limits
//! For turns of more than about a radian the path is no longer near: many pieces are then asked.

use glam::{DMat3, DVec3};

use super::{Side, concave::Concave, rod::Rod};
use crate::{
    broad::Path,
    math::{Aabb, try_unit},
    narrow::Motion,
    tolerance::{BEND_WIDENING, RELATIVE_POSE},
};

/// The path of `form` past a concave form, in the axes of that as they were at the start. In `motion` the form that is
/// followed is `a`, the concave one is `b`. Of a form that is a rod and does not turn also that.
pub(super) fn swept(concave: &Concave<'_>, form: &Side<'_>, motion: &Motion) -> (Path, Option<Rod>) {
    if motion.turns() {
        return (turning(concave, form, motion), None);
    }
    let direction = concave.displacement_in(motion.displacement_a - motion.displacement_b);
    if let Some(rod) = Rod::of(form, concave) {
        let rod = rod.moving(direction);
        return (Path { origin: rod.middle(), direction, reach: rod.reach() }, Some(rod));
    }
    let start = concave.box_of(form);
    let center = start.center();
    let half = (start.max - center).max(center - start.min);
    let reach = half + RELATIVE_POSE * (half.length() + direction.length());
    (Path { origin: center, direction, reach }, None)
}

fn turning(concave: &Concave<'_>, form: &Side<'_>, motion: &Motion) -> Path {
    let way = motion.displacement_a - motion.displacement_b;
    let (turn, turn_of_concave) = (motion.rotation_a, motion.rotation_b);
    let local = form.local_bounds();
    let (own, place) = (concave.place(), form.place());
    let apart = (place.pose.position - place.arm) - (own.pose.position - own.arm);
    let arm = place.arm + place.pose.matrix() * local.center();
    let radius = ball_of(local, form.reach()) + own.blur + place.blur;
    let end = turned(-turn_of_concave, apart + way + turned(turn, arm));
    let (start, end) = (concave.displacement_in(apart + arm - own.arm), concave.displacement_in(end - own.arm));
    let (arm, own_arm, speed) = (arm.length(), own.arm.length(), turn_of_concave.length());
    let farthest = apart.length().max((apart + way).length());
    let bend = arm * ((turn - turn_of_concave).length_squared() + turn.cross(turn_of_concave).length())
        + speed * (speed * farthest + 2.0 * way.length());
    // However far it turns, it stays as near to the concave form's place as it ever is, and so does its chord.
    let departure = (bend / 8.0).min(2.0 * (farthest + arm)) * BEND_WIDENING;
    let slack = RELATIVE_POSE * (farthest + arm + own_arm + radius) * (1.0 + turn.length() + speed);
    Path { origin: start, direction: end - start, reach: DVec3::splat(radius + departure + slack) }
}

/// Radius of a ball around the middle of a local box that holds the form.
fn ball_of(local: Aabb, reach: f64) -> f64 {
    let center = local.center();
    (local.max - center).max(center - local.min).length().min(reach + center.length())
}

/// A vector after a turn by a rotation vector.
pub(super) fn turned(turn: DVec3, vector: DVec3) -> DVec3 {
    try_unit(turn).map_or(vector, |axis| DMat3::from_axis_angle(axis, turn.length()) * vector)
}
