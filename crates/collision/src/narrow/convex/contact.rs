//! The contact of two convex forms.

use std::cmp::Ordering;

use glam::DVec3;

use super::{PlacedConvex, depth, frame::Pair, manifold, order, touch};
use crate::{
    accuracy::Accuracy,
    answer::{Certificate, Feature, Verdict, Work},
    narrow::{Contact, ContactPoint},
};

/// The contact of two convex forms; `None` if they are proved to be more than `max_gap` metres apart.
pub(crate) fn penetration(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Contact> {
    if order::is_swapped(a, b) {
        return penetration_in_order(b, a, max_gap, accuracy, work).map(Contact::swapped);
    }
    penetration_in_order(a, b, max_gap, accuracy, work)
}

fn penetration_in_order(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Contact> {
    let pair = Pair::new(a, b, 0.0);
    let touch = depth::touch(&pair, &depth::Ask::of(&pair, max_gap, accuracy));
    work.pairs_tested += 1;
    work.iterations += touch.as_ref().map_or(1, |touch| u64::from(touch.iterations));
    let mut touch = touch?;
    let mut verdict = if touch.lower >= 0.0 {
        Verdict::Hit
    } else if touch.upper < 0.0 {
        Verdict::Miss
    } else {
        Verdict::Undecided
    };
    if verdict == Verdict::Undecided
        && let Some(sign) = touch::sign(a, b)
    {
        if sign == Ordering::Greater && max_gap <= 0.0 {
            return None;
        }
        verdict = touch.bounded_by(sign);
    }
    let points = manifold::points(&pair, &touch).into_iter().map(|point| ContactPoint {
        point_on_a: pair.point_out(point.on_a),
        point_on_b: pair.point_out(point.on_b),
        depth: pair.length_out((point.on_b - point.on_a).dot(touch.normal)),
        feature_pair: point.feature_pair,
    });
    Some(Contact {
        normal_b_to_a: pair.direction_out(touch.normal),
        depth: pair.length_out(touch.best),
        points: points.collect(),
        feature_a: Feature::default(),
        feature_b: Feature::default(),
        certificate: Certificate {
            verdict,
            bound: pair.bound_out(touch.lower, touch.upper),
            method: touch.method,
            stop: touch.stop,
            iterations: touch.iterations,
        },
    })
}

impl Contact {
    /// The same contact with the arguments swapped.
    fn swapped(mut self) -> Self {
        self.normal_b_to_a = DVec3::ZERO - self.normal_b_to_a;
        std::mem::swap(&mut self.feature_a, &mut self.feature_b);
        for point in &mut self.points {
            std::mem::swap(&mut point.point_on_a, &mut point.point_on_b);
            point.feature_pair = point.feature_pair.rotate_left(16);
        }
        self
    }
}
