//! The signed distance of two cores by formula, where one of them is round and there is a formula.
//!
//! # Method
//! A formula finds a direction and where the cores are nearest, or deepest in each other, along it. What it claims is not
//! taken on trust: the plane across the direction bounds the signed distance from below for any direction, and above are
//! two points of the cores that are so far apart, or what the formula proves of a ball inside of the difference. Where that
//! leaves more than rounding between them the general search is asked instead.
//!
//! # Source
//! [`revolved`] for bodies of revolution about parallel axes, [`ellipsoid`] for a point and an ellipsoid.

use glam::DVec3;

use super::{
    ellipsoid,
    frame::Pair,
    gjk::{self, Gap},
    revolved,
    simplex::{Simplex, Vertex},
};
use crate::{
    answer::{Method, Stop},
    tolerance::{DEPTH_WIDTH, PAIR_ROUNDING},
};

/// What a formula says of two cores, in the pair's frame.
pub(super) struct Signed {
    /// Of the signed distance.
    pub(super) lower: f64,
    /// Of the signed distance.
    pub(super) upper: f64,
    /// Unit vector from `b` to `a`.
    pub(super) normal: DVec3,
    /// The point of `a` that is nearest to `b`, or deepest in it.
    pub(super) on_a: DVec3,
    /// That of `b`.
    pub(super) on_b: DVec3,
    /// A point of both cores, if they overlap.
    pub(super) common: DVec3,
    /// Names the features that touch, on `a` and on `b`.
    pub(super) corners: [u32; 2],
}

/// The signed distance, if there is a formula for it and its bounds leave no more than rounding between them.
pub(super) fn signed(pair: &Pair<'_>) -> Option<Signed> {
    bounds(pair).filter(|found| found.width() <= DEPTH_WIDTH)
}

/// The same however wide the bounds are, if there is a formula that is at least nearly right.
pub(super) fn bounds(pair: &Pair<'_>) -> Option<Signed> {
    if pair.a.core.is_polytope() {
        return None;
    }
    revolved::signed(pair).or_else(|| ellipsoid::signed(pair))
}

/// The gap, by the same formula.
pub(super) fn gap(pair: &Pair<'_>) -> Option<Gap> {
    let found = signed(pair)?;
    let inside = (-found.upper).max(0.0);
    let (on_a, on_b) = if inside > PAIR_ROUNDING { (found.common, found.common) } else { (found.on_a, found.on_b) };
    let apart = on_a - on_b;
    let upper = if inside > 0.0 { PAIR_ROUNDING } else { found.upper };
    Some(Gap {
        lower: found.lower.max(0.0),
        upper,
        length: found.best().clamp(0.0, upper),
        normal: if found.lower > 0.0 { found.normal } else { DVec3::ZERO },
        simplex: Simplex::of(Vertex { point: apart, on_a, corners: found.corners }),
        inside,
        iterations: 1,
        method: Method::ClosedForm,
        stop: Stop::Converged,
    })
}

/// What the plane across a unit vector from `b` to `a` proves: the signed distance is not below this.
pub(super) fn plane(pair: &Pair<'_>, normal: DVec3) -> f64 {
    normal.dot(gjk::support(pair, normal).point) - PAIR_ROUNDING
}

impl Signed {
    /// How far the bounds are apart.
    pub(super) fn width(&self) -> f64 {
        self.upper - self.lower
    }

    /// The best value: that along the normal.
    pub(super) fn best(&self) -> f64 {
        (self.lower + PAIR_ROUNDING).min(self.upper)
    }
}
