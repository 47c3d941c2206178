//! The depth of two rounded cores, and how they touch.
//!
//! # Method
//! The cheapest way that is exact, in this order: boxes by their fifteen axes; while the cores are apart, the radii less the
//! gap, which GJK proves; where the cores overlap, a formula if there is one, the balls and capsules inside round cores and an
//! expanding polytope; and where that is wider than rounding, all separating axes of polytopes, and of round cores a ball in the
//! one about a point of the other and a search over all directions. The upper bound is the width along the returned normal, a true way out for any normal.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    axes,
    body::Corner,
    boxes, directions, epa, formula,
    frame::Pair,
    gjk::{self, Gap},
    inscribed,
    manifold::{self, edge_names, names},
    nested,
    warm::Seed,
};
use crate::{
    accuracy::Accuracy,
    answer::{Method, Stop, Verdict},
    tolerance::{DEPTH_WIDTH, PAIR_ROUNDING},
};

/// Most vertices of a polytope inside the difference of round cores: where that does not end by then, a search over directions
/// mostly does.
const ROUND_ITERATIONS_MAX: u32 = 512;

/// The depth of two rounded cores in the pair's frame, and how they touch.
pub(super) struct Touch {
    pub(super) best: f64,
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// Unit vector from `b` to `a`.
    pub(super) normal: DVec3,
    /// The points of the cores that are nearest, or deepest in each other, where they are known.
    pub(super) witnesses: Option<(DVec3, DVec3)>,
    /// The edges that touch, where an edge pair gave the normal.
    pub(super) edges: Option<[[Corner; 2]; 2]>,
    /// Names of the features that touch, on `a` and on `b`, where they are known.
    pub(super) features: Option<[u16; 2]>,
    pub(super) method: Method,
    pub(super) stop: Stop,
    pub(super) iterations: u32,
}

/// What is asked of a depth, in the pair's frame.
pub(super) struct Ask {
    pub(super) budget: u32,
    /// Gaps that are proved to be wider are not measured.
    pub(super) max_gap: f64,
    /// Widest interval to accept.
    pub(super) widest: f64,
    /// Widest interval to accept as a part of the depth.
    pub(super) relative: f64,
}

impl Ask {
    /// What an accuracy asks of a pair.
    pub(super) fn of(pair: &Pair<'_>, max_gap: f64, accuracy: &Accuracy) -> Self {
        Self {
            budget: accuracy.budget,
            max_gap: pair.length_in(max_gap),
            widest: pair.length_in(accuracy.max_error),
            relative: accuracy.max_error_relative,
        }
    }

    fn is_narrow(&self, lower: f64, upper: f64) -> bool {
        upper - lower <= self.widest || upper - lower <= self.relative * lower
    }
}

/// Depth and normal; `None` if the gap is proved to be above `max_gap`.
pub(super) fn touch(pair: &Pair<'_>, ask: &Ask, seed: &mut Option<Seed>) -> Option<Touch> {
    let radius = pair.radius();
    if radius <= 0.0
        && let Some(depth) = boxes::depth(pair, ask.max_gap + PAIR_ROUNDING)
    {
        if -depth.upper > ask.max_gap {
            return None;
        }
        if depth.lower > 0.0 {
            return Some(Touch::by_axes(depth, 0.0));
        }
    }
    let mut gap = gjk::gap_warm(pair, seed, ask.budget, |lower, _| lower - radius > ask.max_gap);
    touch_from(pair, &mut gap, ask)
}

/// Depth and normal where the gap of the cores is known; `None` if that is proved to be above `max_gap`.
fn touch_from(pair: &Pair<'_>, gap: &mut Gap, ask: &Ask) -> Option<Touch> {
    let radius = pair.radius();
    if gap.lower - radius > ask.max_gap {
        return None;
    }
    if gap.lower > 0.0 {
        return Some(Touch::by_gap(gap, radius));
    }
    let mut touch = overlapping(pair, gap, ask.budget, |lower, upper| ask.is_narrow(lower, upper));
    if gap.go_on(pair, &touch, ask.budget) {
        return (gap.lower - radius <= ask.max_gap).then(|| Touch::by_gap(gap, radius));
    }
    // The depth is no less than the ball around the origin that a tetrahedron of the difference holds, or, where the cores
    // may be apart, than what the gap leaves of the radii.
    let by_gap = if gap.inside > PAIR_ROUNDING { radius + gap.inside - PAIR_ROUNDING } else { radius - gap.upper };
    touch.lower = touch.lower.max(by_gap).min(touch.upper);
    touch.best = touch.best.clamp(touch.lower, touch.upper);
    touch.iterations = touch.iterations.saturating_add(gap.iterations);
    // Cores that only touch do so where GJK ended; of deep ones its simplex may pass through the origin as well.
    if gap.inside <= PAIR_ROUNDING && touch.edges.is_none() && touch.best - radius <= DEPTH_WIDTH {
        touch.witnesses = Some(gap.witnesses());
    }
    (-touch.upper <= ask.max_gap).then_some(touch)
}

/// The depth of rounded cores that are not proved to be apart, until `is_enough(lower, upper)`.
pub(super) fn overlapping(pair: &Pair<'_>, gap: &Gap, budget: u32, is_enough: impl Fn(f64, f64) -> bool) -> Touch {
    let radius = pair.radius();
    if let Some(depth) = boxes::depth(pair, f64::INFINITY) {
        return Touch::by_axes(depth, radius);
    }
    let by_formula = formula::bounds(pair);
    if let Some(found) = &by_formula
        && (found.width() <= DEPTH_WIDTH || is_enough(radius - found.upper, radius - found.lower))
    {
        return Touch::by_formula(found, radius);
    }
    let rest = budget.saturating_sub(gap.iterations).max(1);
    // What the cores are surely deep by.
    let by_form = by_formula.as_ref().map_or(f64::NEG_INFINITY, |found| -found.upper);
    let floor = by_form.max(inscribed::depth_lower(pair) - radius);
    let turns = if has_round_core(pair) { rest.min(ROUND_ITERATIONS_MAX) } else { rest };
    let grown = epa::depth(pair, &gap.simplex, floor, turns, |lower, upper| is_enough(lower + radius, upper + radius));
    let points = grown.as_ref().and_then(|grown| grown.witnesses);
    let touch = match grown {
        Some(grown) if grown.stop != Stop::Converged || grown.upper - grown.lower <= DEPTH_WIDTH => {
            let witnesses = grown.witnesses;
            let touch = Touch::by_polytope(grown, radius);
            // The triangle that gave the normal may lie far below the support point there.
            let is_deep = has_round_core(pair) && touch.best - radius > DEPTH_WIDTH;
            if is_deep { Touch { witnesses: Some(deepest(pair, touch.normal, witnesses)), ..touch } } else { touch }
        }
        Some(grown) => {
            let grown = Touch::by_polytope(grown, radius);
            // All axes of round cores are too many.
            match axes::bounded_depth(pair) {
                Some(by_axes) => Touch::by_axes(by_axes, radius).beside(grown),
                None => grown,
            }
        }
        None => Touch::by_axes(axes::depth(pair), radius),
    };
    let touch = touch.with_ball(pair, points, rest, &is_enough);
    let touch = narrowed(pair, touch, rest, &is_enough).with_ball(pair, None, rest, &is_enough);
    match by_formula.map(|found| Touch::by_formula(&found, radius)) {
        Some(found) if found.upper < touch.upper => {
            Touch { lower: touch.lower, stop: touch.stop, iterations: touch.iterations, ..found }
        }
        _ => touch,
    }
}

fn has_round_core(pair: &Pair<'_>) -> bool {
    !pair.a.core.is_polytope() || !pair.b.core.is_polytope()
}

/// A depth of round cores that is known less well than the arithmetic allows, narrowed by a search over all directions.
fn narrowed(pair: &Pair<'_>, touch: Touch, budget: u32, is_enough: &impl Fn(f64, f64) -> bool) -> Touch {
    let radius = pair.radius();
    let known = touch.upper - PAIR_ROUNDING - radius;
    let is_narrow = touch.upper - touch.lower <= DEPTH_WIDTH || is_enough(touch.lower, touch.upper);
    if is_narrow || !has_round_core(pair) || known <= DEPTH_WIDTH {
        return touch;
    }
    if touch.iterations >= budget {
        return Touch { stop: Stop::Budget, ..touch };
    }
    let up = |best: f64| best + radius + PAIR_ROUNDING;
    let found = directions::depth(pair, known, budget - touch.iterations, |lower, best| {
        is_enough(touch.lower.max(lower + radius), up(best))
    });
    let (best, upper, normal) = if found.normal == DVec3::ZERO {
        (touch.best, touch.upper, touch.normal)
    } else {
        (found.best + radius, up(found.best), found.normal)
    };
    Touch {
        best,
        lower: touch.lower.max(found.lower + radius),
        upper,
        normal,
        witnesses: Some(deepest(pair, normal, touch.witnesses)),
        edges: None,
        stop: found.stop,
        iterations: touch.iterations.saturating_add(found.iterations),
        ..touch
    }
}

/// The points that are known, or the farthest ones along the normal, whichever lie less far beside it, each on its form's plane
/// across the normal.
pub(super) fn deepest(pair: &Pair<'_>, normal: DVec3, known: Option<(DVec3, DVec3)>) -> (DVec3, DVec3) {
    let (a, b) = (pair.a.support(DVec3::ZERO - normal).point, pair.b.support(normal).point);
    let beside = |(on_a, on_b): (DVec3, DVec3)| {
        let apart = on_a - on_b;
        (apart - normal * (a - b).dot(normal)).length_squared()
    };
    let (on_a, on_b) = known.filter(|&known| beside(known) <= beside((a, b))).unwrap_or((a, b));
    (on_a + normal * (a - on_a).dot(normal), on_b + normal * (b - on_b).dot(normal))
}

impl Touch {
    fn by_gap(gap: &Gap, radius: f64) -> Self {
        Self {
            best: (radius - gap.length).clamp(radius - gap.upper, radius - gap.lower),
            lower: radius - gap.upper,
            upper: radius - gap.lower,
            normal: gap.normal,
            witnesses: Some(gap.witnesses()),
            edges: None,
            features: Some(names(gap.simplex.vertices())),
            method: gap.method,
            stop: gap.stop,
            iterations: gap.iterations,
        }
    }

    fn by_axes(depth: axes::Depth, radius: f64) -> Self {
        Self {
            best: depth.best + radius,
            lower: depth.lower + radius,
            upper: depth.upper + radius,
            normal: depth.normal,
            witnesses: None,
            features: depth.edges.map(edge_names),
            edges: depth.edges,
            method: Method::SeparatingAxes,
            stop: depth.stop,
            iterations: depth.iterations,
        }
    }

    fn by_formula(found: &formula::Signed, radius: f64) -> Self {
        Self {
            best: radius - found.best(),
            lower: radius - found.upper,
            upper: radius - found.lower,
            normal: found.normal,
            witnesses: Some((found.on_a, found.on_b)),
            edges: None,
            features: Some(found.corners.map(manifold::short)),
            method: Method::ClosedForm,
            stop: if found.width() <= DEPTH_WIDTH { Stop::Converged } else { Stop::Tolerance },
            iterations: 1,
        }
    }

    fn by_polytope(depth: epa::Penetration, radius: f64) -> Self {
        Self {
            best: depth.best + radius,
            lower: depth.lower + radius,
            upper: depth.upper + radius,
            normal: depth.normal,
            witnesses: depth.witnesses,
            edges: None,
            features: depth.features,
            method: Method::Epa,
            stop: depth.stop,
            iterations: depth.iterations,
        }
    }

    /// The same with what a ball in one core about a point of the other proves, and the way out that it shows: the search for it begins
    /// at the points that are known, or at the farthest ones along the normal. Not where less is enough, and once at least.
    fn with_ball(
        self,
        pair: &Pair<'_>,
        points: Option<(DVec3, DVec3)>,
        budget: u32,
        is_enough: &impl Fn(f64, f64) -> bool,
    ) -> Self {
        if self.upper - self.lower <= DEPTH_WIDTH || is_enough(self.lower, self.upper) {
            return self;
        }
        let climbs = budget.saturating_sub(self.iterations).max(1);
        let farthest = || (pair.a.support(DVec3::ZERO - self.normal).point, pair.b.support(self.normal).point);
        let Some(ball) = nested::greatest(pair, points.unwrap_or_else(farthest), climbs) else { return self };
        let radius = pair.radius();
        let best = radius - formula::plane(pair, ball.normal) - PAIR_ROUNDING;
        let (best, upper, normal, witnesses) = if best < self.best {
            let known = Some((ball.point, ball.point));
            (best, best + PAIR_ROUNDING, ball.normal, Some(deepest(pair, ball.normal, known)))
        } else {
            (self.best, self.upper, self.normal, self.witnesses)
        };
        let lower = self.lower.max((ball.radius + radius).min(upper));
        let stop = if upper - lower <= DEPTH_WIDTH { Stop::Converged } else { self.stop };
        let iterations = self.iterations.saturating_add(ball.climbs);
        Self { best: best.max(lower), lower, upper, normal, witnesses, stop, iterations, ..self }
    }

    /// The shorter of two ways out. What the other proves from below holds for it too, unless that is more than this way out:
    /// the faces of a hull that is flat but for rounding have no normals by which edges could be passed over.
    fn beside(self, shorter: Self) -> Self {
        if shorter.upper >= self.upper {
            return self;
        }
        let lower = if self.lower <= shorter.upper { self.lower } else { f64::NEG_INFINITY };
        Self { lower: shorter.lower.max(lower), stop: self.stop, ..shorter }
    }

    /// Takes in the exact sign of the signed distance, and says what it proves.
    pub(super) fn bounded_by(&mut self, sign: Ordering) -> Verdict {
        if sign != Ordering::Greater {
            self.lower = self.lower.max(0.0);
        }
        if sign != Ordering::Less {
            self.upper = self.upper.min(0.0);
        }
        self.best = self.best.clamp(self.lower, self.upper);
        if sign == Ordering::Greater { Verdict::Miss } else { Verdict::Hit }
    }
}
