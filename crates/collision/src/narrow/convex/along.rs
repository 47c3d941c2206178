//! The contact of two convex forms along a normal that somebody else chose.
//!
//! # Method
//! The width of both forms along a unit normal is a way out along it, and no shorter way along it is. So the depth along a normal
//! is known to within the rounding of two support points, whichever it is.

use glam::DVec3;
use smallvec::SmallVec;

use super::{
    PlacedConvex,
    contact::{Judged, judge},
    depth::{Touch, deepest},
    frame::Pair,
    order,
};
use crate::{
    accuracy::Accuracy,
    answer::{Method, Stop, Verdict, Work},
    math::Norm,
    narrow::Contact,
    tolerance::PAIR_ROUNDING,
};

/// What becomes of a contact whose normal is known.
pub(crate) enum Ruling {
    /// It is told as it is.
    Stands,
    /// It is not told.
    LeftOut,
    /// It is told along that of these directions, unit vectors in the world from `b` to `a`, which is the shortest way out.
    Along(SmallVec<[DVec3; 4]>),
}

/// As [`super::penetration`], where `rule` says what becomes of a contact, given its normal from `b` to `a` and what is proved
/// of the touch. What is proved stays as it is, whatever the normal.
pub(crate) fn penetration_ruled(
    [a, b]: [PlacedConvex<'_>; 2],
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
    rule: impl FnOnce(DVec3, Verdict) -> Ruling,
) -> Option<Contact> {
    let (first, second, is_swapped) = order::in_order(a, b);
    let turned = |normal: DVec3| if is_swapped { DVec3::ZERO - normal } else { normal };
    let found = judge(first, second, max_gap, accuracy, &mut None, work, |judged| {
        match rule(turned(judged.pair.direction_out(judged.touch.normal)), judged.verdict) {
            Ruling::Stands => Some(judged.contact(is_swapped)),
            Ruling::LeftOut => None,
            Ruling::Along(normals) => {
                let touch = shortest(judged.pair, judged.touch, normals.into_iter().map(turned));
                Some(Judged { touch: &touch, ..*judged }.contact(is_swapped))
            }
        }
    });
    found.flatten()
}

/// The touch along that of some directions of the world, from the second form to the first, which is the shortest way out;
/// of equals the first. Without any, the touch as it is.
fn shortest(pair: &Pair<'_>, known: &Touch, normals: impl Iterator<Item = DVec3>) -> Touch {
    let mut best: Option<Touch> = None;
    for normal in normals {
        let Some(normal) = pair.direction_in(normal).try_unit() else { continue };
        let touch = along(pair, known, normal);
        if best.as_ref().is_none_or(|best| touch.best < best.best) {
            best = Some(touch);
        }
    }
    best.unwrap_or_else(|| along(pair, known, known.normal))
}

fn along(pair: &Pair<'_>, known: &Touch, normal: DVec3) -> Touch {
    let low_of_a = pair.a.support(DVec3::ZERO - normal).point;
    let high_of_b = pair.b.support(normal).point;
    let best = (high_of_b - low_of_a).dot(normal) + pair.radius();
    Touch {
        best,
        lower: best - PAIR_ROUNDING,
        upper: best + PAIR_ROUNDING,
        normal,
        witnesses: Some(deepest(pair, normal, known.witnesses)),
        edges: None,
        features: None,
        method: Method::SeparatingAxes,
        stop: Stop::Converged,
        iterations: known.iterations,
    }
}
