//! The signed distance of a core and a half space: one support point.

use glam::DVec3;

use super::{
    double::{Double, Number},
    form::{Core, Solid},
    frame::{Body, Pair},
    space::{Vector, exponent_of, times_power_of_two},
};

/// The signed distance of the cores and the unit vector from `a` to `b` along which it is; `None` if neither is a half
/// space. Two half spaces are not known here.
pub(super) fn signed_distance(a: &Solid, b: &Solid, pair: &Pair) -> Option<(Double, Vector<Double>)> {
    let height = |solid: &Solid, space: &Body<Double>, body: &Body<Double>| {
        let Core::HalfSpace { normal, offset } = &solid.core else { return None };
        let exponent = -exponent_of(normal.abs().max_element());
        let normal = normal.to_array().map(|part| times_power_of_two(part, exponent));
        let normal = space.turn.out(Vector::of(DVec3::from_array(normal))).unit()?;
        let offset = Double::of(times_power_of_two(*offset, pair.exponent));
        Some(((body.support(-normal) - space.position).dot(normal) - offset, normal))
    };
    let (of_a, of_b) = (&pair.exact.a, &pair.exact.b);
    let b_above = height(a, of_a, of_b);
    b_above.or_else(|| height(b, of_b, of_a).map(|(gap, normal)| (gap, -normal)))
}
