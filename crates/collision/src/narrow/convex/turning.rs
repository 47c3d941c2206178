//! The gap of two convex forms of which at least one turns, from which [`advance`](crate::narrow::advance) finds the first
//! touch.
//!
//! # Method
//! GJK measures the gap at a time, each search from the features of the last; far from the touch only as well as
//! foretelling it takes; boxes are asked by their axes first. An overlap that is foretold is first sought behind the
//! corners that were nearest. What lies between two times is proved by [`super::motion`].
//!
//! # Limits
//! Forms without volume in common, such as two segments, never prove a touch: their answers stay open.

use glam::DVec3;

use super::{
    PlacedConvex, boxes, depth,
    gjk::{self, Gap},
    motion::{Course, Swings},
    overlapping, portal,
    warm::Seed,
};
use crate::{
    accuracy::Accuracy,
    answer::Verdict,
    math::Norm,
    narrow::{
        InitialTouch,
        advance::{self, Gaps, Instant, Look, Paces, Touch, Width},
    },
    shape::Core,
    tolerance::PAIR_ROUNDING,
};

/// A gap is measured to this part of itself: enough to predict by. It gets as exact as the arithmetic by itself as the gap
/// closes.
const COARSE: f64 = 1.0 / 4.0;

/// A pair on its course and what it cost so far.
pub(super) struct Search<'a> {
    placed: [PlacedConvex<'a>; 2],
    pub(super) course: Course<'a>,
    budget: u32,
    seed: Option<Seed>,
    /// Axes are asked before a search.
    are_boxes: bool,
    /// The last look that measured the gap.
    last: Option<Look>,
    pub(super) iterations: u32,
}

impl<'a> Search<'a> {
    pub(super) fn new(placed: [PlacedConvex<'a>; 2], way: DVec3, swings: Swings, budget: u32) -> Self {
        let [a, b] = placed;
        let are_boxes = [a, b].iter().all(|form| matches!(form.convex.core, Core::Cuboid { .. }));
        let seed = are_boxes.then_some(Seed::NOTHING);
        Self { placed, course: Course::new(a, b, way, &swings), budget, are_boxes, seed, last: None, iterations: 0 }
    }

    /// As [`advance::first_touch`].
    pub(super) fn first_touch(&mut self, initial: InitialTouch, accuracy: &Accuracy) -> Option<Touch> {
        let entry = self.course.entry_of_balls()?;
        let way = self.course.pair.length_out(self.course.speed_of_surface());
        advance::first_touch(self, entry, &Width::of(accuracy, way), initial)
    }

    fn seen(&self, time: f64, gap: &Gap) -> Look {
        let Course { pair, rounding, .. } = &self.course;
        let radius = pair.radius();
        let (on_a, on_b) = gap.witnesses();
        let (on_a, on_b, normal) = (self.course.out(on_a), self.course.out(on_b), self.course.out(gap.normal));
        let apart = (on_a - on_b).norm();
        let share = if apart > 0.0 { (pair.a.radius / apart).min(1.0) } else { 0.0 };
        let is_inside = gap.inside > PAIR_ROUNDING + rounding;
        Look {
            instant: Instant { time, free: gap.lower - radius - rounding, normal },
            gap: gap.length - radius,
            growth: self.course.growth(normal, on_a, on_b),
            is_overlap: is_inside || gap.upper + rounding <= radius,
            point: on_a + (on_b - on_a) * share,
        }
    }

    /// The overlap at the present time, where it is foretold and the corners that were nearest at the last look prove it:
    /// this spares most searches that would end inside.
    fn overlap_held(&mut self, time: f64) -> Option<Look> {
        // Of rounded forms a search says so by its first step.
        if !portal::applies(&self.course.pair) {
            return None;
        }
        let last = self.last.filter(|last| last.gap + last.growth * (time - last.instant.time) < 0.0)?;
        let corners = self.seed.as_ref()?.triangle(&self.course.pair)?;
        self.spend(1);
        let Course { pair, rounding, .. } = &self.course;
        let is_overlap = portal::is_behind(pair, &corners, DVec3::ZERO, PAIR_ROUNDING + rounding);
        let instant = Instant { time, free: 0.0, normal: DVec3::ZERO };
        is_overlap.then_some(Look { instant, gap: 0.0, is_overlap, ..last })
    }

    fn spend(&mut self, iterations: u32) {
        self.iterations = self.iterations.saturating_add(iterations);
    }
}

impl Gaps for Search<'_> {
    fn look(&mut self, time: f64) -> Look {
        self.course.go_to(time);
        if let Some(overlap) = self.overlap_held(time) {
            return overlap;
        }
        let (radius, rounding) = (self.course.pair.radius(), self.course.rounding);
        let budget = self.remaining().max(1);
        let by_axes = if self.are_boxes { boxes::gap(&self.course.pair) } else { None };
        // Fifteen axes take about as long as a step of a search.
        self.spend(u32::from(by_axes.is_some()));
        let gap = by_axes.unwrap_or_else(|| {
            let gap = gjk::gap_warm(&self.course.pair, &mut self.seed, budget, |lower, upper| {
                upper + rounding <= radius || upper - lower <= COARSE * (lower - radius)
            });
            self.spend(gap.iterations);
            gap
        });
        let look = self.seen(time, &gap);
        self.last = Some(look);
        look
    }

    fn look_closely(&mut self, time: f64) -> Look {
        let look = self.look(time);
        if look.is_overlap || look.instant.free > 0.0 {
            return look;
        }
        let overlap = overlapping::prove(&self.course.pair, self.course.rounding, self.remaining().max(1));
        self.spend(overlap.iterations);
        Look { is_overlap: overlap.verdict == Verdict::Hit, ..look }
    }

    fn depth(&mut self) -> f64 {
        let ask = depth::Ask { budget: self.remaining(), max_gap: f64::INFINITY, widest: 0.0, relative: COARSE };
        let depth = depth::touch(&self.course.pair, &ask, &mut self.seed);
        self.spend(depth.as_ref().map_or(1, |depth| depth.iterations));
        depth.map_or(0.0, |depth| depth.lower - self.course.rounding)
    }

    /// In the frame of the pair at rest, which is finer than that of a long way.
    fn at_rest(&mut self) -> Verdict {
        let [a, b] = self.placed;
        let rest = overlapping::at_rest(a, b, self.remaining().max(1));
        self.spend(rest.iterations);
        rest.verdict
    }

    fn strain_between(&self, from: &Instant, to: &Instant) -> f64 {
        self.course.strain_between(from, to)
    }

    /// By the same normal, which costs one support pair.
    fn is_free_to_end(&mut self, from: &Instant) -> bool {
        self.spend(1);
        self.course.go_to(1.0);
        let end = self.course.along(from.normal, 1.0);
        self.course.strain_between(from, &end) < 1.0
    }

    fn paces(&self) -> Paces {
        self.course.paces()
    }

    fn remaining(&self) -> u32 {
        self.budget.saturating_sub(self.iterations)
    }
}
