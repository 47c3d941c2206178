//! The first touch of two convex forms of which at least one turns.
//!
//! # Method
//! Advancement from both sides. At an instant GJK gives the gap, its normal and, by the speeds of the nearest points, how
//! fast it closes; from that and the instant before the touch is predicted, and the next instant is taken a little short
//! of it. Between two instants the way is proved free by their gaps alone ([`super::motion`]); where that proof fails, an
//! instant between them is taken. Prediction decides the work, never an answer. Once the predicted touch is within the width
//! that was asked, an instant of proved overlap is sought so far ahead: a small gap proves no touch.
//!
//! Where the gap is within rounding, overlap is sought at growing steps. If the gap opens again before any is proved, what
//! lies between is stepped past and the search goes on: a later proved touch is then a hit over the whole doubtful time,
//! else the answer is open.
//!
//! # Source
//! Mirtich, "Impulse-based dynamic simulation" (1996), section 2.3: conservative advancement; Tang, Kim, Manocha, "C²A:
//! controlled conservative advancement" (2009): coarse gaps far from the touch; Catto, "Continuous collision" (GDC
//! 2013): bilateral advancement, here with proofs on both sides.
//!
//! # Limits
//! A gap that spins of many turns leave narrow all the time takes an instant for each part of a turn; a budget that is
//! spent leaves the rest of the motion open. Forms without volume in common, such as two segments, never prove a touch.

use glam::DVec3;

use super::{
    PlacedConvex, depth,
    frame::Pair,
    gjk::{self, Gap},
    impact::Touch,
    motion::{Course, Instant},
    progress::{Doubt, Look, Progress, Width, touch_at},
    separation,
    warm::Seed,
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Stop, Verdict},
    narrow::InitialTouch,
    tolerance::{PAIR_ROUNDING, ROUNDING},
};

/// A gap is measured to this part of itself: enough to predict by. It gets as exact as the arithmetic by itself as the gap
/// closes.
const COARSE: f64 = 1.0 / 64.0;

/// A pair on its course and what is known of it.
pub(super) struct Search<'a> {
    placed: [PlacedConvex<'a>; 2],
    pub(super) course: Course<'a>,
    width: Width,
    budget: u32,
    seed: Option<Seed>,
    pub(super) iterations: u32,
}

/// What comes of a doubtful gap.
enum Resolved {
    Touch(f64),
    OpenAgain(Look),
    Never,
    Spent,
}

/// What comes of a touch at the start that is ignored.
enum Start {
    Clear(Look),
    NeverClear,
    /// The budget was spent at this time.
    Spent(f64),
}

impl<'a> Search<'a> {
    pub(super) fn new(placed: [PlacedConvex<'a>; 2], way: DVec3, turns: [DVec3; 2], accuracy: &Accuracy) -> Self {
        let [a, b] = placed;
        let course = Course::new(a, b, way, turns);
        let speed = course.speed_of_surface();
        let of_motion = if speed > 0.0 { (course.pair.length_in(accuracy.max_error) / speed).min(1.0) } else { 1.0 };
        let width = Width { of_motion, of_time: accuracy.max_error_relative };
        Self { placed, course, width, budget: accuracy.budget, seed: None, iterations: 0 }
    }

    /// The first touch; `None` is a proof that the way is free, or that it is so after a touch at the start that is
    /// ignored.
    pub(super) fn first_touch(&mut self, initial: InitialTouch) -> Option<Touch> {
        let entry = self.course.entry_of_balls()?;
        let mut start = self.look(entry);
        let mut is_initial = false;
        if entry == 0.0 && start.instant.free <= 0.0 {
            let [a, b] = self.placed;
            let rest = separation::signed(&Pair::new(a, b, 0.0), self.remaining()).or_exactly(a, b);
            self.spend(rest.iterations);
            is_initial = rest.verdict != Verdict::Miss;
            if is_initial && initial == InitialTouch::IsIgnored {
                match self.clear_of_start() {
                    Start::Clear(clear) => start = clear,
                    Start::NeverClear => return None,
                    Start::Spent(time) => {
                        let bound = Bound::new(time, 1.0);
                        return Some(touch_at(&start, time, bound, Verdict::Undecided, Stop::Budget));
                    }
                }
                is_initial = false;
            } else if rest.verdict == Verdict::Hit || start.is_overlap {
                let bound = Bound::new(0.0, 0.0);
                let touch = touch_at(&start, 0.0, bound, Verdict::Hit, Stop::Tolerance);
                return Some(Touch { normal: None, is_initial: true, ..touch });
            }
        }
        let touch = self.advance(start)?;
        let is_initial = is_initial && touch.bound.lower == 0.0;
        Some(Touch { is_initial, ..touch })
    }

    fn advance(&mut self, start: Look) -> Option<Touch> {
        let mut progress = Progress::from(start);
        loop {
            let free = progress.free;
            if let Some(overlap) = progress.overlap
                && overlap - free.instant.time <= self.width.at(free.instant.time)
            {
                return Some(progress.hit(overlap, Stop::Tolerance));
            }
            if free.instant.time >= 1.0 {
                return progress.doubt.map(|doubt| doubt.open());
            }
            if self.remaining() == 0 {
                return Some(match progress.overlap {
                    Some(overlap) => progress.hit(overlap, Stop::Budget),
                    None => progress.spent(),
                });
            }
            if free.instant.time + progress.predicted() > 1.0 && self.is_free_to_end(&free) {
                return progress.doubt.map(|doubt| doubt.open());
            }
            match progress.next_time(&self.course, &self.width) {
                Some(time) => self.step(&mut progress, time),
                None => match self.resolve(&progress) {
                    Resolved::Touch(overlap) => return Some(progress.hit(overlap, Stop::Converged)),
                    Resolved::OpenAgain(look) => self.step_past(&mut progress, look),
                    Resolved::Never => return Some(progress.doubted(1.0).open()),
                    Resolved::Spent => return Some(progress.spent()),
                },
            }
        }
    }

    /// Looks at a time and takes it as free, or as overlapping, or cuts the step.
    fn step(&mut self, progress: &mut Progress, time: f64) {
        let look = self.look(time);
        let free = progress.free;
        if self.course.is_free_between(&free.instant, &look.instant) {
            (progress.before, progress.free, progress.cut) = (Some(free), look, 1.0);
            return;
        }
        if look.is_overlap {
            progress.overlap = Some(time);
        }
        progress.shorten(time);
    }

    /// Goes on behind a doubtful time, if that it was.
    fn step_past(&self, progress: &mut Progress, look: Look) {
        if !self.course.is_free_between(&progress.free.instant, &look.instant) {
            let from = progress.doubt.map_or(progress.free, |doubt| doubt.from);
            progress.doubt = Some(Doubt { from, until: look.instant.time });
        }
        (progress.before, progress.free, progress.cut) = (None, look, 1.0);
    }

    /// Whether the normal of an instant proves the rest of the way free, by one support pair.
    fn is_free_to_end(&mut self, free: &Look) -> bool {
        self.spend(1);
        self.course.go_to(1.0);
        let end = self.course.along(free.instant.normal, 1.0);
        self.course.is_free_between(&free.instant, &end)
    }

    /// From a gap within rounding: seeks proved overlap or a gap that is open again, at growing steps.
    fn resolve(&mut self, progress: &Progress) -> Resolved {
        let free = &progress.free;
        let time = free.instant.time;
        let blur = 8.0 * self.course.doubt();
        let closing = -free.growth;
        let straight = if closing > 0.0 { (free.gap.max(0.0) + blur) / closing } else { f64::INFINITY };
        let bent = (2.0 * blur / self.course.bend()).sqrt();
        let mut ahead = straight.min(bent).min(1.0).max(8.0 * ROUNDING * time);
        let end = progress.overlap.unwrap_or(1.0);
        loop {
            let next = (time + ahead).min(end);
            if next >= end && progress.overlap.is_some() {
                return Resolved::Touch(end);
            }
            if self.remaining() == 0 {
                return Resolved::Spent;
            }
            let look = self.look_closely(next);
            if look.is_overlap {
                return Resolved::Touch(next);
            }
            if look.instant.free > blur {
                return Resolved::OpenAgain(look);
            }
            if next >= 1.0 {
                return Resolved::Never;
            }
            ahead *= 4.0;
        }
    }

    /// From a touch at the start, where the pair is now: the first instant that is proved clear. A proved depth lasts as long
    /// as the fastest points need for it; only where none is proved are steps chosen freely.
    fn clear_of_start(&mut self) -> Start {
        let speed = self.course.speed();
        let blur = 8.0 * self.course.doubt();
        let (mut time, mut least) = (0.0, blur);
        if speed <= 0.0 {
            return Start::NeverClear;
        }
        loop {
            if self.remaining() == 0 {
                return Start::Spent(time);
            }
            let ask = depth::Ask { budget: self.remaining(), max_gap: f64::INFINITY, widest: 0.0, relative: COARSE };
            let depth = depth::touch(&self.course.pair, &ask, &mut self.seed);
            self.spend(depth.as_ref().map_or(1, |depth| depth.iterations));
            let proved = depth.map_or(0.0, |depth| depth.lower - self.course.rounding);
            least = if proved > blur { blur } else { 2.0 * least };
            time += proved.max(least) / speed;
            if time >= 1.0 {
                return Start::NeverClear;
            }
            let look = self.look(time);
            if look.instant.free > blur {
                return Start::Clear(look);
            }
        }
    }

    /// The gap at a time, as exactly as predicting takes.
    fn look(&mut self, time: f64) -> Look {
        self.course.go_to(time);
        let (radius, rounding) = (self.course.pair.radius(), self.course.rounding);
        let budget = self.remaining().max(1);
        let gap = gjk::gap_warm(&self.course.pair, &mut self.seed, budget, |lower, upper| {
            upper + rounding <= radius || upper - lower <= COARSE * (lower - radius)
        });
        self.spend(gap.iterations);
        self.seen(time, &gap)
    }

    /// The same, and whether forms overlap that GJK leaves open.
    fn look_closely(&mut self, time: f64) -> Look {
        let look = self.look(time);
        if look.is_overlap || look.instant.free > 0.0 {
            return look;
        }
        let signed = separation::signed(&self.course.pair, self.remaining().max(1));
        self.spend(signed.iterations);
        Look { is_overlap: signed.upper + self.course.rounding <= 0.0, ..look }
    }

    fn seen(&self, time: f64, gap: &Gap) -> Look {
        let Course { pair, rounding, .. } = &self.course;
        let radius = pair.radius();
        let (on_a, on_b) = gap.witnesses();
        let (on_a, on_b, normal) = (self.course.out(on_a), self.course.out(on_b), self.course.out(gap.normal));
        let apart = (on_a - on_b).length();
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

    fn remaining(&self) -> u32 {
        self.budget.saturating_sub(self.iterations)
    }

    fn spend(&mut self, iterations: u32) {
        self.iterations = self.iterations.saturating_add(iterations);
    }
}
