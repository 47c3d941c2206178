//! Depth and contact of two convex forms.
//!
//! # Method
//! While the cores are apart, the depth is the radii less the gap, which GJK proves; only where the cores overlap are
//! separating axes asked. The upper bound is the width along the returned normal, a true way out for any normal.

use glam::DVec3;

use super::{
    PlacedConvex, axes,
    frame::{Corner, Pair},
    gjk, manifold, order,
};
use crate::{
    accuracy::Accuracy,
    answer::{Certificate, Feature, Method, Stop, Verdict, Work},
    narrow::{Contact, ContactPoint},
    tolerance::PAIR_ROUNDING,
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

/// The depth of two rounded cores in the pair's frame, and how they touch.
pub(super) struct Touch {
    pub(super) best: f64,
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// Unit vector from `b` to `a`.
    pub(super) normal: DVec3,
    /// The points of the cores that are nearest, where the cores are apart.
    pub(super) witnesses: Option<(DVec3, DVec3)>,
    /// The edges that touch, where an edge pair gave the normal.
    pub(super) edges: Option<[[Corner; 2]; 2]>,
    method: Method,
    stop: Stop,
    iterations: u32,
}

fn penetration_in_order(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Contact> {
    let pair = Pair::new(a, b, 0.0);
    let touch = touch(&pair, accuracy.budget, pair.length_in(max_gap));
    work.pairs_tested += 1;
    work.iterations += touch.as_ref().map_or(1, |touch| u64::from(touch.iterations));
    let touch = touch?;
    let verdict = if touch.lower >= 0.0 {
        Verdict::Hit
    } else if touch.upper < 0.0 {
        Verdict::Miss
    } else {
        Verdict::Undecided
    };
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

/// Depth and normal; `None` if the gap is proved to be above `max_gap` (in the frame).
fn touch(pair: &Pair<'_>, budget: u32, max_gap: f64) -> Option<Touch> {
    let radius = pair.radius();
    let gap = gjk::gap(pair, budget, |lower, _| lower - radius > max_gap);
    if gap.lower - radius > max_gap {
        return None;
    }
    if gap.lower > 0.0 {
        return Some(Touch {
            best: (radius - gap.length).clamp(radius - gap.upper, radius - gap.lower),
            lower: radius - gap.upper,
            upper: radius - gap.lower,
            normal: gap.normal,
            witnesses: Some(gap.witnesses),
            edges: None,
            method: Method::Gjk,
            stop: gap.stop,
            iterations: gap.iterations,
        });
    }
    let depth = axes::depth(pair);
    if -depth.upper - radius > max_gap {
        return None;
    }
    // The depth is no less than the ball around the origin that a tetrahedron of the difference holds, or, where the cores
    // may be apart, than what the gap leaves of the radii.
    let by_gap = if gap.inside > PAIR_ROUNDING { radius + gap.inside - PAIR_ROUNDING } else { radius - gap.upper };
    let lower = (depth.lower + radius).max(by_gap).min(depth.upper + radius);
    Some(Touch {
        best: (depth.best + radius).clamp(lower, depth.upper + radius),
        lower,
        upper: depth.upper + radius,
        normal: depth.normal,
        witnesses: (gap.inside <= PAIR_ROUNDING && depth.edges.is_none()).then_some(gap.witnesses),
        edges: depth.edges,
        method: Method::SeparatingAxes,
        stop: depth.stop,
        iterations: gap.iterations.saturating_add(depth.iterations),
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
