//! The depth of two rounded cores, and how they touch.
//!
//! # Method
//! While the cores are apart, the depth is the radii less the gap, which GJK proves; only where the cores overlap are
//! separating axes asked. The upper bound is the width along the returned normal, a true way out for any normal.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    axes,
    frame::{Corner, Pair},
    gjk,
};
use crate::{
    answer::{Method, Stop, Verdict},
    tolerance::PAIR_ROUNDING,
};

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
    pub(super) method: Method,
    pub(super) stop: Stop,
    pub(super) iterations: u32,
}

/// Depth and normal; `None` if the gap is proved to be above `max_gap` (in the frame).
pub(super) fn touch(pair: &Pair<'_>, budget: u32, max_gap: f64) -> Option<Touch> {
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

impl Touch {
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
