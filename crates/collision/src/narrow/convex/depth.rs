//! The depth of two rounded cores, and how they touch.
//!
//! # Method
//! The cheapest way that is exact, in this order: boxes by their fifteen axes; while the cores are apart, the radii less the
//! gap, which GJK proves; where the cores overlap, a formula if there is one, an expanding polytope, and where its answer is wider than rounding, all
//! separating axes of polytopes and the balls and capsules inside round cores. The upper bound is the width along the
//! returned normal, a true way out for any normal.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    axes,
    body::Corner,
    boxes, epa, formula,
    frame::Pair,
    gjk::{self, Gap},
    inscribed,
    manifold::{self, edge_names, names},
    warm::Seed,
};
use crate::{
    accuracy::Accuracy,
    answer::{Method, Stop, Verdict},
    tolerance::{DEPTH_WIDTH, PAIR_ROUNDING},
};

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
    let gap = gjk::gap_warm(pair, seed, ask.budget, |lower, _| lower - radius > ask.max_gap);
    touch_from(pair, &gap, ask)
}

/// Depth and normal where the gap of the cores is known; `None` if that is proved to be above `max_gap`.
fn touch_from(pair: &Pair<'_>, gap: &Gap, ask: &Ask) -> Option<Touch> {
    let radius = pair.radius();
    if gap.lower - radius > ask.max_gap {
        return None;
    }
    if gap.lower > 0.0 {
        return Some(Touch::by_gap(gap, radius));
    }
    let mut touch = overlapping(pair, gap, ask.budget, |lower, upper| ask.is_narrow(lower, upper));
    // The depth is no less than the ball around the origin that a tetrahedron of the difference holds, or, where the cores
    // may be apart, than what the gap leaves of the radii.
    let by_gap = if gap.inside > PAIR_ROUNDING { radius + gap.inside - PAIR_ROUNDING } else { radius - gap.upper };
    touch.lower = touch.lower.max(by_gap).min(touch.upper);
    touch.best = touch.best.clamp(touch.lower, touch.upper);
    touch.iterations = touch.iterations.saturating_add(gap.iterations);
    if gap.inside <= PAIR_ROUNDING && touch.edges.is_none() {
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
    let grown = epa::depth(pair, &gap.simplex, floor, rest, |lower, upper| is_enough(lower + radius, upper + radius));
    let touch = match grown {
        Some(grown) if grown.stop != Stop::Converged || grown.upper - grown.lower <= DEPTH_WIDTH => {
            Touch::by_polytope(grown, radius)
        }
        // All axes of round cores are too many.
        Some(grown) if !axes::is_bounded(pair) => Touch::by_polytope(grown, radius),
        Some(grown) => Touch::by_axes(axes::depth(pair), radius).beside(Touch::by_polytope(grown, radius)),
        None => Touch::by_axes(axes::depth(pair), radius),
    };
    match by_formula.map(|found| Touch::by_formula(&found, radius)) {
        Some(found) if found.upper < touch.upper => {
            Touch { lower: touch.lower, stop: touch.stop, iterations: touch.iterations, ..found }
        }
        _ => touch,
    }
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
            witnesses: Some(depth.witnesses),
            edges: None,
            features: depth.features,
            method: Method::Epa,
            stop: depth.stop,
            iterations: depth.iterations,
        }
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
