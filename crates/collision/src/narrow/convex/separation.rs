//! Distance and overlap of two convex forms.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    PlacedConvex, boxes, depth,
    frame::Pair,
    gjk::{self, Gap},
    order, touch,
    warm::{Seed, Warm},
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Feature, Method, Model, Stop, Verdict, Work},
    math::Norm,
    narrow::Separation,
    tolerance::PAIR_ROUNDING,
};

/// How far apart two convex forms are; `None` if that is proved to be beyond `limit` metres.
pub(crate) fn distance(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    limit: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Separation> {
    let (first, second, is_swapped) = order::in_order(a, b);
    let found = distance_in_order(first, second, limit, accuracy, &mut None, work);
    if is_swapped { found.map(Separation::swapped) } else { found }
}

/// The same from what was remembered.
pub(crate) fn distance_warm(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    limit: f64,
    accuracy: &Accuracy,
    warm: &mut Warm,
    work: &mut Work,
) -> Option<Separation> {
    let (first, second, is_swapped) = order::in_order(a, b);
    let found = distance_in_order(first, second, limit, accuracy, warm.seed(is_swapped), work);
    if is_swapped { found.map(Separation::swapped) } else { found }
}

/// Whether two convex forms touch; the bound is that of the signed distance.
pub(crate) fn overlap(a: PlacedConvex<'_>, b: PlacedConvex<'_>, accuracy: &Accuracy, work: &mut Work) -> Certificate {
    let (a, b, _) = order::in_order(a, b);
    let pair = Pair::new(a, b, 0.0);
    let signed = signed(&pair, accuracy.budget).or_exactly(a, b);
    signed.certificate(&pair, 0.0, work)
}

/// Whether two convex forms come within `margin` metres of each other.
pub(crate) fn within(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    margin: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Certificate {
    let (a, b, _) = order::in_order(a, b);
    let mut pair = Pair::new(a, b, margin);
    let margin = pair.length_in(margin);
    pair.a.radius += margin;
    signed(&pair, accuracy.budget).certificate(&pair, margin, work)
}

/// Bounds of the signed distance of two rounded cores, in the pair's frame.
pub(super) struct Signed {
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// What is proved; exact touch counts as a hit.
    pub(super) verdict: Verdict,
    method: Method,
    stop: Stop,
    pub(super) iterations: u32,
}

impl Signed {
    fn new(lower: f64, upper: f64, method: Method, stop: Stop, iterations: u32) -> Self {
        Self { lower, upper, verdict: Bound::new(lower, upper).touch_verdict(), method, stop, iterations }
    }

    /// What was proved of forms one of which was grown by `margin`, in the frame.
    fn certificate(&self, pair: &Pair<'_>, margin: f64, work: &mut Work) -> Certificate {
        work.pairs_tested += 1;
        work.iterations += u64::from(self.iterations);
        Certificate {
            verdict: self.verdict,
            bound: pair.bound_out(self.lower + margin, self.upper + margin),
            model: Model::EXACT,
            method: self.method,
            stop: if self.verdict == Verdict::Undecided { self.stop } else { Stop::Tolerance },
            iterations: self.iterations,
        }
    }

    /// The same, and where the verdict is open, what the exact sign of forms that are not turned proves.
    #[inline(always)]
    pub(super) fn or_exactly(self, a: PlacedConvex<'_>, b: PlacedConvex<'_>) -> Self {
        if self.verdict != Verdict::Undecided {
            return self;
        }
        match touch::sign(a, b) {
            Some(Ordering::Less) => Self { upper: 0.0, verdict: Verdict::Hit, method: Method::ClosedForm, ..self },
            Some(Ordering::Equal) => {
                Self { lower: 0.0, upper: 0.0, verdict: Verdict::Hit, method: Method::ClosedForm, ..self }
            }
            Some(Ordering::Greater) => {
                Self { lower: self.lower.max(0.0), verdict: Verdict::Miss, method: Method::ClosedForm, ..self }
            }
            None => self,
        }
    }
}

/// Bounds of the signed distance, no narrower than it takes to tell whether the pair touches where it is.
pub(super) fn signed(pair: &Pair<'_>, budget: u32) -> Signed {
    let radius = pair.radius();
    if radius <= 0.0
        && let Some(depth) = boxes::depth(pair, PAIR_ROUNDING)
    {
        let signed = Signed::new(-depth.upper, -depth.lower, Method::SeparatingAxes, depth.stop, depth.iterations);
        // Of boxes that are apart the axes prove no more than that.
        match signed.verdict {
            Verdict::Miss => return Signed { upper: f64::INFINITY, ..signed },
            Verdict::Hit => return signed,
            Verdict::Undecided => {}
        }
    }
    let mut gap = gjk::gap(pair, budget, |lower, upper| lower > radius || upper <= radius);
    signed_gap(pair, &mut gap, budget)
}

/// The signed distance from the gap of the cores, and from the depth where the gap leaves the verdict open.
#[inline(always)]
fn signed_gap(pair: &Pair<'_>, gap: &mut Gap, budget: u32) -> Signed {
    let radius = pair.radius();
    let is_inside = gap.inside > PAIR_ROUNDING;
    let lower = if gap.lower > 0.0 { gap.lower - radius } else { f64::NEG_INFINITY };
    let upper = if is_inside { PAIR_ROUNDING - gap.inside - radius } else { gap.upper - radius };
    let by_gap = Signed::new(lower, upper, gap.method, gap.stop, gap.iterations);
    let is_open = by_gap.verdict == Verdict::Undecided && gap.stop == Stop::Converged;
    if !is_open || gap.lower > 0.0 && radius > 0.0 {
        return by_gap;
    }
    signed_by_depth(pair, gap, budget, [lower, upper])
}

/// The same from the depth of the cores, where the bounds by the gap are `lower` and `upper`.
#[inline(never)]
fn signed_by_depth(pair: &Pair<'_>, gap: &mut Gap, budget: u32, [lower, upper]: [f64; 2]) -> Signed {
    let touch = depth::overlapping(pair, gap, budget, |lower, _| lower > 0.0);
    let (mut lower, mut upper) = (lower.max(-touch.upper), upper.min(-touch.lower));
    if gap.go_on(pair, &touch, budget) {
        (lower, upper) = (lower.max(gap.lower - pair.radius()), upper.min(gap.upper - pair.radius()));
    }
    Signed::new(lower, upper, touch.method, touch.stop, gap.iterations.saturating_add(touch.iterations))
}

fn distance_in_order(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    limit: f64,
    accuracy: &Accuracy,
    seed: &mut Option<Seed>,
    work: &mut Work,
) -> Option<Separation> {
    let pair = Pair::new(a, b, 0.0);
    let radius = pair.radius();
    let limit_in = pair.length_in(limit);
    let widest = pair.length_in(accuracy.max_error);
    let mut gap = gjk::gap_warm(&pair, seed, accuracy.budget, |lower, upper| {
        let width = upper.max(radius) - lower.max(radius);
        lower - radius > limit_in || width <= widest || width <= accuracy.max_error_relative * (lower - radius)
    });
    let signed = signed_gap(&pair, &mut gap, accuracy.budget).or_exactly(a, b);
    work.pairs_tested += 1;
    work.iterations += u64::from(signed.iterations);
    let (lower, upper) = (signed.lower.max(0.0), signed.upper.max(0.0));
    if lower > limit_in {
        return None;
    }
    let verdict = if upper <= limit_in { Verdict::Hit } else { Verdict::Undecided };
    let (on_a, on_b) = gap.witnesses();
    let apart = on_a - on_b;
    let best = if upper == 0.0 { 0.0 } else { (apart.norm() - radius).clamp(lower, upper) };
    // Of a narrow gap the plane's normal is known best; the points are as far apart along the way between them.
    let is_settled = gap.stop == Stop::Converged && gap.normal != DVec3::ZERO;
    let toward_a = apart.try_unit();
    let normal = if is_settled { Some(gap.normal) } else { toward_a };
    let (point_on_a, point_on_b) = match toward_a {
        Some(toward_a) if best > 0.0 => (on_a - toward_a * pair.a.radius, on_b + toward_a * pair.b.radius),
        _ => {
            let common = common_point(on_a, on_b, pair.a.radius, pair.b.radius);
            (common, common)
        }
    };
    Some(Separation {
        distance: pair.length_out(best),
        point_on_a: pair.point_out(point_on_a),
        point_on_b: pair.point_out(point_on_b),
        normal_b_to_a: normal.filter(|_| best > 0.0).map(|normal| pair.direction_out(normal)),
        feature_a: Feature::default(),
        feature_b: Feature::default(),
        certificate: Certificate {
            verdict,
            bound: pair.bound_out(lower, upper),
            model: Model::EXACT,
            method: signed.method,
            stop: gap.stop,
            iterations: signed.iterations,
        },
    })
}

/// A point within both radii of the nearest points of two cores that overlap when rounded.
fn common_point(on_a: DVec3, on_b: DVec3, radius_a: f64, radius_b: f64) -> DVec3 {
    let apart = on_b - on_a;
    let length = apart.norm();
    let along = ((length + radius_a - radius_b) / 2.0).clamp(0.0, length);
    on_a + apart.try_unit().unwrap_or_default() * along
}

impl Separation {
    /// The same answer with the arguments swapped.
    pub(in crate::narrow) fn swapped(self) -> Self {
        Self {
            point_on_a: self.point_on_b,
            point_on_b: self.point_on_a,
            normal_b_to_a: self.normal_b_to_a.map(|normal| DVec3::ZERO - normal),
            feature_a: self.feature_b,
            feature_b: self.feature_a,
            ..self
        }
    }
}
