//! What an advancement knows, and where it looks next.
//!
//! # Method
//! The touch is foretold by the gap, its speed and, once there are two looks, the change of that speed; the next look is
//! taken a little short of it, or, where the width that was asked reaches beyond it, at the end of that width. All of this
//! decides the work only: what is free and what touches is proved elsewhere.

use super::{Look, Paces, Touch, Width, touch_at};
use crate::answer::{Bound, Stop, Verdict};

/// The part of the predicted way that a first step, which knows no curvature, leaves over. Less, and it oversteps more
/// often; more, and more is left to the steps that follow.
const CAUTION: f64 = 1.0 / 16.0;

/// Where in the width that was asked the last free instant is aimed at, before the predicted touch; the proved overlap
/// is sought at the end of it.
const SHARE_BEFORE: f64 = 0.375;

/// And how much of that width such an attempt covers.
const SHARE_COVERED: f64 = 63.0 / 64.0;

/// A touch predicted within this part of the width is tried.
const SHARE_TRIED: f64 = 0.625;

/// How much nearer overlap is sought after an attempt that failed.
const NARROWING: f64 = 1.0 / 16.0;

/// The part of the step that strain would just allow which is tried: the gap may be narrower there.
const STRAIN_TRIED: f64 = 0.875;

/// No step turns further than this, radians: nothing is foretold over more.
const STEP_TURN_MAX: f64 = 2.0;

/// A time in which a touch is neither proved nor excluded.
#[derive(Clone, Copy)]
pub(super) struct Doubt {
    pub(super) from: Look,
    pub(super) until: f64,
}

/// The state of an advancement.
pub(super) struct Progress {
    /// Free until here, but for the doubt.
    pub(super) free: Look,
    pub(super) before: Option<Look>,
    /// Proved overlap.
    pub(super) overlap: Option<f64>,
    pub(super) doubt: Option<Doubt>,
    /// The next step is cut to this part.
    pub(super) cut: f64,
    /// Overlap is sought within this part of the width that was asked: it may last shorter than that.
    narrowing: f64,
}

impl Progress {
    /// At the first instant.
    pub(super) fn from(free: Look) -> Self {
        Self { free, before: None, overlap: None, doubt: None, cut: 1.0, narrowing: 1.0 }
    }

    /// A look at a time was of no use: the next is taken nearer. The strain grows with the square of the time.
    pub(super) fn shorten(&mut self, time: f64, strain: f64) {
        if time > self.free.instant.time + self.predicted() {
            self.narrowing *= NARROWING;
        }
        let provable = STRAIN_TRIED / strain.sqrt();
        let cut = if self.cut == 1.0 { 1.0 - 2.0 * CAUTION } else { self.cut * 0.5 };
        self.cut = if provable > 0.0 { cut.min(self.cut * provable) } else { cut };
    }

    /// Where to look next; `None` if the gap is within rounding, so that no step is to be had.
    pub(super) fn next_time(&self, paces: &Paces, width: &Width) -> Option<f64> {
        let free = &self.free;
        let (time, proved) = (free.instant.time, free.instant.free);
        let least = 4.0 * paces.doubt;
        if proved <= least {
            return None;
        }
        let sure = proved / paces.speed;
        let touch = self.predicted();
        let width = width.at((time + touch).min(1.0)) * self.narrowing;
        let step = if touch <= SHARE_TRIED * width && self.cut == 1.0 {
            SHARE_COVERED * width
        } else if touch < f64::INFINITY {
            let caution = self.before.map_or(CAUTION, |before| CAUTION.min((free.gap / before.gap).powi(2)));
            let kept = (caution * touch).max(SHARE_BEFORE * width).max(-least / free.growth);
            (touch - kept).max(0.875 * sure).min(self.provable(paces, sure))
        } else {
            self.provable(paces, sure)
        };
        let whole = self.overlap.map_or(1.0 - time, |overlap| (overlap - time) * (1.0 - CAUTION));
        let step = step.min(whole) * self.cut;
        // Steps that are cut below what the gap surely allows get nowhere: the gap is as good as closed.
        let next = if step >= 1.0 - time { 1.0 } else { time + step };
        (next > time && (self.cut == 1.0 || step > 0.125 * sure)).then_some(next)
    }

    /// About how far the proof between two instants may reach, if the gap goes on as it does.
    fn provable(&self, paces: &Paces, sure: f64) -> f64 {
        let free = &self.free;
        let bend = paces.bend;
        let left = 1.0 - free.instant.time;
        let proved = free.instant.free;
        let mut reach = left;
        if bend > 0.0 {
            for _ in 0..2 {
                let there = (proved + free.growth * reach).max(0.0);
                // Roots of numbers without a unit, so that a scale that is a power of two changes nothing.
                let roots = (2.0 * proved / bend).sqrt() + (2.0 * there / bend).sqrt();
                reach = left.min(0.75 * roots);
            }
            reach = reach.min(STEP_TURN_MAX / paces.turn);
        }
        reach.max(sure)
    }

    /// How long until the touch, as far as can be foretold; infinite if none can.
    pub(super) fn predicted(&self) -> f64 {
        let free = &self.free;
        let bend =
            self.before.map_or(0.0, |before| (free.growth - before.growth) / (free.instant.time - before.instant.time));
        let gap = free.gap.max(0.0);
        let inner = free.growth * free.growth - 2.0 * bend * gap;
        if inner < 0.0 {
            return f64::INFINITY;
        }
        let closing = inner.sqrt() - free.growth;
        if closing > 0.0 { 2.0 * gap / closing } else { f64::INFINITY }
    }

    pub(super) fn hit(&self, overlap: f64, stop: Stop) -> Touch {
        let lower = self.doubt.map_or(self.free.instant.time, |doubt| doubt.from.instant.time);
        let time = self.free.instant.time;
        let touch = time + self.predicted();
        let fraction = if touch <= overlap { touch } else { 0.5 * (time + overlap) };
        // What rounding leaves in doubt is as wide as it is, whatever was asked.
        let stop = if self.doubt.is_some() && stop == Stop::Tolerance { Stop::Converged } else { stop };
        touch_at(&self.free, fraction, Bound::new(lower, overlap), Verdict::Hit, stop)
    }

    /// The doubt, from its first instant or from here, until a time.
    pub(super) fn doubted(&self, until: f64) -> Doubt {
        Doubt { from: self.doubt.map_or(self.free, |doubt| doubt.from), until }
    }

    pub(super) fn spent(&self) -> Touch {
        Touch { stop: Stop::Budget, ..self.doubted(1.0).open() }
    }
}

impl Doubt {
    pub(super) fn open(&self) -> Touch {
        let lower = self.from.instant.time;
        touch_at(&self.from, lower, Bound::new(lower, self.until), Verdict::Undecided, Stop::Converged)
    }
}
