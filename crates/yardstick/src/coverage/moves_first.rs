//! What the oracle knows of the first touch of two forms that do not turn.
//!
//! # Method
//! The first touch of each pair of convex pieces is known. One-sided triangles, of whose pairs some do not count, are told by the
//! normal of that touch and the way.
//!
//! # Limits
//! Where rounding, or what another piece met before, leaves open whether a pair counts, all is said to be open.

use std::collections::BTreeMap;

use collision::shape::MeshMode;
use glam::DVec3;

use super::{moves::MoveQuestion, whole::Whole};
use crate::oracle::{Place, Solid, Union, meeting};

/// What the oracle knows of all pieces.
pub(super) struct First {
    /// No pieces surely touch before this.
    pub(super) free_until: f64,
    /// Some pieces surely do at this time, if any.
    pub(super) touching_at: Option<f64>,
    /// Some touch at the start, surely or within rounding.
    pub(super) at_start: bool,
    /// How far apart all are at the start, those that never meet left out, metres.
    pub(super) gap_at_start: f64,
    pub(super) cosine: f64,
    /// A front that is met along its plane: whether that counts is a matter of rounding.
    pub(super) is_open: bool,
    /// The pieces that count and may touch, by their numbers.
    pub(super) counted: Vec<[usize; 2]>,
}

/// All pairs of pieces that may come near each other.
pub(super) fn pairs<'a>(unions: &'a [Union; 2], places: &[Place; 2]) -> Vec<[(&'a Solid, Place, usize); 2]> {
    let pieces = |side: usize| {
        let places = *places;
        unions[side]
            .pieces
            .iter()
            .enumerate()
            .map(move |(index, piece)| (&piece.solid, piece.place(&places[side]), index))
    };
    pieces(0).flat_map(|a| pieces(1).map(move |b| [a, b])).collect()
}

/// Whether a triangle that counts from its front is met from there: with its front towards the other form, which does not go away
/// from it. `None` if that is a matter of rounding.
fn is_met(whole: &Whole, index: usize, place: &Place, way: DVec3, towards_other: DVec3) -> Option<bool> {
    let Whole::Mesh { mode: MeshMode::OneSided, vertices, triangles } = whole else {
        // Those of compounds are not told apart here.
        return (!whole.is_one_sided()).then_some(true);
    };
    let [a, b, c] = triangles[index].map(|corner| vertices[corner as usize]);
    let front = place.rotation.normalize() * (b - a).cross(c - a).normalize_or_zero();
    let (closing, facing) = (-front.dot(way) / way.length(), front.dot(towards_other));
    if closing.abs() > LEAN && facing.abs() > LEAN_OF_NORMAL { Some(closing > 0.0 && facing > 0.0) } else { None }
}

/// What leans less than this towards a front or away from it may be either; the same of a normal, which the oracle knows less well.
const LEAN: f64 = 1e-6;
const LEAN_OF_NORMAL: f64 = 0.1;

/// The first touch as the oracle sees it.
pub(super) fn first(question: &MoveQuestion, unions: &[Union; 2]) -> First {
    let places = question.places();
    let way = places[1].displacement - places[0].displacement;
    let mut first = First {
        free_until: f64::INFINITY,
        touching_at: None,
        at_start: false,
        gap_at_start: f64::INFINITY,
        cosine: 1.0,
        is_open: false,
        counted: Vec::new(),
    };
    // Of each triangle the last time at which it is met from its front, and the first from its back.
    let mut met_at: BTreeMap<(usize, usize), (f64, f64)> = BTreeMap::new();
    for [(solid_a, place_a, a), (solid_b, place_b, b)] in pairs(unions, &places) {
        let met = meeting([(solid_a, &place_a), (solid_b, &place_b)]);
        if met.free_until > 1.0 {
            continue;
        }
        let sides = [&question.sides[0].whole, &question.sides[1].whole];
        // A terrain is asked by its skin, which here is the end of columns.
        first.is_open |= sides.iter().any(|whole| whole.is_one_sided())
            && sides.iter().any(|whole| matches!(whole, Whole::Field { .. }));
        let normal = met.normal_a_to_b;
        let of_a = is_met(sides[0], a, &place_a, way, normal);
        let of_b = is_met(sides[1], b, &place_b, -way, -normal);
        for (triangle, is_met) in [((0, a), of_a), ((1, b), of_b)] {
            let (front, back) = met_at.entry(triangle).or_insert((f64::NEG_INFINITY, f64::INFINITY));
            if is_met == Some(false) { *back = back.min(met.free_until) } else { *front = front.max(met.free_until) }
        }
        match (of_a, of_b) {
            (Some(true), Some(true)) => {}
            (Some(false), _) | (_, Some(false)) if !met.touches_at_start => continue,
            _ => first.is_open = true,
        }
        first.counted.push([a, b]);
        // At the start the middle of a form decides which side it is on.
        first.is_open |= met.touches_at_start && sides.iter().any(|whole| whole.is_one_sided());
        first.at_start |= met.touches_at_start;
        first.gap_at_start = first.gap_at_start.min(met.gap_at_start);
        if met.free_until < first.free_until {
            (first.free_until, first.cosine) = (met.free_until, met.cosine);
        }
        first.touching_at = match (first.touching_at, met.touching_at) {
            (Some(one), Some(other)) => Some(one.min(other)),
            (one, other) => one.or(other),
        };
    }
    // What is touched from its back first is passed over for the rest of the motion, by all of the other form.
    first.is_open |= met_at.values().any(|(front, back)| back <= front);
    first
}
