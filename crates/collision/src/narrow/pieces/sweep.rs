//! Where a form that moves past a concave one may come, in the concave form's own axes: a straight path and a reach about it.
//!
//! # Method
//! Without turns the form's box goes along a straight line. Otherwise a ball around the form is followed: its centre, seen
//! from the concave form, goes along a curve that departs from its chord by at most an eighth of the greatest acceleration.
//! With `c` the centre in the form, `p` the form's place, `v` its velocity, `ω` its turn and `μ` that of the concave form
//! (all relative to what that turns about), the acceleration is at most `|c|(|ω − μ|² + |ω × μ|) + |μ|²|p| + 2|μ||v|`.
//!
//! A turn is taken in spans of time, for each of which that is small: over a whole radian the path of a corner of a mesh departs from
//! its chord by an eighth of the mesh.
//!
//! # Limits
//! Of many turns a span holds more than a part of one: many pieces are then asked.

use glam::{DMat3, DVec3};

use super::{Side, concave::Concave, rod::Rod};
use crate::{
    broad::Path,
    math::{Aabb, Norm, try_unit},
    narrow::Motion,
    tolerance::{BEND_WIDENING, RELATIVE_POSE},
};

/// What a span turns at most, radians. Measured with herds of meshes: half of it takes as long.
const SPAN_TURN: f64 = 0.125;

/// Spans at most.
const SPANS_MAX: f64 = 64.0;

/// A part of a motion, from one fraction of it to another.
#[derive(Clone, Copy)]
pub(super) struct Span {
    begin: f64,
    end: f64,
}

impl Span {
    /// All of the motion.
    pub(super) const WHOLE: Self = Self { begin: 0.0, end: 1.0 };

    /// What a motion is taken apart into, in the order of time. It is left whole where no concave form turns: what turns about its own
    /// middle goes straight on.
    pub(super) fn of(a: &Side<'_>, b: &Side<'_>, motion: &Motion) -> impl Iterator<Item = Self> {
        let turn_of =
            |side: &Side<'_>, rotation: DVec3| if let Side::Concave(_) = side { rotation.norm() } else { 0.0 };
        let turn = turn_of(a, motion.rotation_a) + turn_of(b, motion.rotation_b);
        let count = (turn / SPAN_TURN).ceil().clamp(1.0, SPANS_MAX);
        let at = move |number: f64| number / count;
        (0..count as u32).map(f64::from).map(move |number| Self { begin: at(number), end: at(number + 1.0) })
    }

    /// A fraction of the motion as one of the span, rounded up: 1 at its end, below 0 before it.
    pub(super) fn reaches(&self, fraction: f64) -> f64 {
        let part = (fraction - self.begin) / (self.end - self.begin);
        if part <= 0.0 && fraction < self.begin { part } else { part.next_up().next_up().min(1.0) }
    }
}

/// The path of `form` past a concave form in a span of the motion, in the axes of that as they were at the start. In `motion` the form
/// that is followed is `a`, the concave one is `b`. Of a form that is a rod and does not turn also that; the span is then the whole.
pub(super) fn swept(concave: &Concave<'_>, form: &Side<'_>, motion: &Motion, span: Span) -> (Path, Option<Rod>) {
    if motion.turns() {
        return (turning(concave, form, motion, span), None);
    }
    let direction = concave.displacement_in(motion.displacement_a - motion.displacement_b);
    if let Some(rod) = Rod::of(form, concave) {
        let rod = rod.moving(direction);
        return (Path { origin: rod.middle(), direction, reach: rod.reach() }, Some(rod));
    }
    let start = concave.box_of(form);
    let center = start.center();
    let half = (start.max - center).max(center - start.min);
    let reach = half + RELATIVE_POSE * (half.norm() + direction.norm());
    (Path { origin: center, direction, reach }, None)
}

fn turning(concave: &Concave<'_>, form: &Side<'_>, motion: &Motion, span: Span) -> Path {
    let way = motion.displacement_a - motion.displacement_b;
    let (turn, turn_of_concave) = (motion.rotation_a, motion.rotation_b);
    let local = form.local_bounds();
    let (own, place) = (concave.place(), form.place());
    let apart = (place.pose.position - place.arm) - (own.pose.position - own.arm);
    let arm = place.arm + place.pose.matrix() * local.center();
    let radius = ball_of(local, form.reach()) + own.blur + place.blur;
    let at = |time: f64| {
        let seen = turned(-turn_of_concave * time, apart + way * time + turned(turn * time, arm));
        concave.displacement_in(seen - own.arm)
    };
    let (start, end) = (at(span.begin), at(span.end));
    let part = span.end - span.begin;
    let (arm, own_arm, speed) = (arm.norm(), own.arm.norm(), turn_of_concave.norm());
    let farthest = apart.norm().max((apart + way).norm());
    let bend = arm * ((turn - turn_of_concave).length_squared() + turn.cross(turn_of_concave).norm())
        + speed * (speed * farthest + 2.0 * way.norm());
    // However far it turns, it stays as near to the concave form's place as it ever is, and so does its chord.
    let departure = (bend * (part * part) / 8.0).min(2.0 * (farthest + arm)) * BEND_WIDENING;
    let slack = RELATIVE_POSE * (farthest + arm + own_arm + radius) * (1.0 + turn.norm() + speed);
    Path { origin: start, direction: end - start, reach: DVec3::splat(radius + departure + slack) }
}

/// Radius of a ball around the middle of a local box that holds the form.
fn ball_of(local: Aabb, reach: f64) -> f64 {
    let center = local.center();
    (local.max - center).max(center - local.min).norm().min(reach + center.norm())
}

/// A vector after a turn by a rotation vector.
pub(super) fn turned(turn: DVec3, vector: DVec3) -> DVec3 {
    try_unit(turn).map_or(vector, |axis| DMat3::from_axis_angle(axis, turn.norm()) * vector)
}
