//! Whether two rounded cores surely overlap, within a budget.
//!
//! # Method
//! A tetrahedron of the difference that GJK ends with, or nearest points within the radii; the fifteen axes of boxes; what
//! round cores hold; a polytope that grows until it holds the origin. All separating axes of hulls are not asked: they
//! measure a depth to the last digit, which nobody wants here, at a cost that no budget bounds.

use std::cmp::Ordering;

use glam::DVec3;

use super::{PlacedConvex, boxes, epa, frame::Pair, gjk, inscribed, simplex::Simplex, touch};
use crate::{
    answer::{Method, Verdict},
    tolerance::PAIR_ROUNDING,
};

/// What was proved, and what it cost.
pub(super) struct Proof {
    pub(super) verdict: Verdict,
    pub(super) iterations: u32,
}

/// Seeks a proof that the pair is deeper in each other than `depth_min` where it is now, or that it is apart.
pub(super) fn prove(pair: &Pair<'_>, depth_min: f64, budget: u32) -> Proof {
    let radius = pair.radius();
    let deep = depth_min - radius;
    let gap = gjk::gap(pair, budget, |lower, upper| lower > radius || upper + depth_min <= radius);
    let proof = |verdict, iterations: u32| Proof { verdict, iterations: gap.iterations.saturating_add(iterations) };
    if gap.lower > radius {
        return proof(Verdict::Miss, 0);
    }
    if gap.upper + depth_min <= radius || gap.inside > PAIR_ROUNDING + deep.max(0.0) {
        return proof(Verdict::Hit, 0);
    }
    let hit_if = |is_deep| if is_deep { Verdict::Hit } else { Verdict::Undecided };
    if let Some(depth) = boxes::depth(pair, f64::INFINITY) {
        return proof(if -depth.upper > radius { Verdict::Miss } else { hit_if(depth.lower > deep) }, depth.iterations);
    }
    let inscribed = inscribed::depth_lower(pair) - radius;
    let rest = budget.saturating_sub(gap.iterations);
    if inscribed > deep || rest == 0 || gap.lower > 0.0 {
        return proof(hit_if(inscribed > deep), 0);
    }
    // Where axes are all but parallel a formula's nearest points are off by the lean: they may lie in neither form.
    let start = match gap.method {
        Method::ClosedForm => Simplex::of(gjk::support(pair, DVec3::X)),
        _ => gap.simplex,
    };
    let grown = epa::depth(pair, &start, inscribed, rest, |lower, _| lower > deep);
    grown.map_or(proof(Verdict::Undecided, 1), |grown| proof(hit_if(grown.lower > deep), grown.iterations))
}

/// Whether the pair touches at rest; of forms that are not turned exactly.
pub(super) fn at_rest(a: PlacedConvex<'_>, b: PlacedConvex<'_>, budget: u32) -> Proof {
    let proof = prove(&Pair::new(a, b, 0.0), 0.0, budget);
    match (proof.verdict, touch::sign(a, b)) {
        (Verdict::Undecided, Some(Ordering::Greater)) => Proof { verdict: Verdict::Miss, ..proof },
        (Verdict::Undecided, Some(_)) => Proof { verdict: Verdict::Hit, ..proof },
        _ => proof,
    }
}
