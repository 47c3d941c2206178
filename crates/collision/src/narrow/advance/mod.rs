//! The first touch of two forms whose gap can be measured at any time: the advancement of all motions that turn.
//!
//! # Method
//! Advancement from both sides. At an instant the gap is measured, along which normal it is, and how fast it closes; from
//! that and the instant before the touch is foretold ([`progress`]), and the next instant is taken a little short of it.
//! Between two instants the way is proved free by their gaps alone; where that proof fails, an instant between them is
//! taken. What is foretold decides the work, never an answer. Once the foretold touch is within the width that was asked, an
//! instant of proved overlap is sought so far ahead: a small gap proves no touch.
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
//! A gap that a spin of many turns leaves narrow all the time takes an instant for each part of a turn; a budget that is
//! spent leaves the rest of the motion open.

mod progress;

use glam::DVec3;

use self::progress::{Doubt, Progress};
use super::InitialTouch;
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Stop, Verdict},
    tolerance::{ROUNDING, WIDEST_OF_MOTION, WIDEST_OF_TIME},
};

/// A first touch, in the axes of whoever measured the gaps.
pub(super) struct Touch {
    pub(super) fraction: f64,
    pub(super) bound: Bound,
    pub(super) verdict: Verdict,
    pub(super) stop: Stop,
    /// Unit vector from the second form to the first.
    pub(super) normal: Option<DVec3>,
    pub(super) point: DVec3,
    pub(super) is_initial: bool,
}

/// A time at which the gap is known.
#[derive(Clone, Copy)]
pub(super) struct Instant {
    pub(super) time: f64,
    /// The gap that is proved, radii and rounding taken off; not above 0 where none is.
    pub(super) free: f64,
    /// Unit vector from the second form to the first along which it is; 0 where none is.
    pub(super) normal: DVec3,
}

/// What is known of the gap at an instant.
#[derive(Clone, Copy)]
pub(super) struct Look {
    pub(super) instant: Instant,
    /// The best value.
    pub(super) gap: f64,
    /// How fast the gap grows.
    pub(super) growth: f64,
    /// Overlap is proved.
    pub(super) is_overlap: bool,
    /// Where the forms are nearest.
    pub(super) point: DVec3,
}

/// What bounds the gap's changes, for the time 1 and in the unit of the gaps.
#[derive(Clone, Copy)]
pub(super) struct Paces {
    /// No gap closes faster.
    pub(super) speed: f64,
    /// The speed of a gap along a fixed normal changes no faster.
    pub(super) bend: f64,
    /// The faster of the turns, radians.
    pub(super) turn: f64,
    /// What a measured gap may be off by.
    pub(super) doubt: f64,
}

/// Widest interval to accept.
pub(super) struct Width {
    /// As a part of the motion.
    of_motion: f64,
    /// As a part of the time itself.
    of_time: f64,
}

impl Width {
    /// What an accuracy asks, where the fastest point covers `way` metres.
    pub(super) fn of(accuracy: &Accuracy, way: f64) -> Self {
        let of_motion = if way > 0.0 { accuracy.max_error / way } else { 1.0 };
        let of_time = accuracy.max_error_relative.min(WIDEST_OF_TIME);
        Self { of_motion: of_motion.min(WIDEST_OF_MOTION), of_time }
    }

    /// For a touch at a time.
    fn at(&self, time: f64) -> f64 {
        self.of_motion.max(self.of_time * time)
    }
}

/// Two forms in motion over the time from 0 to 1, whose gap can be measured. Counts what that costs.
pub(super) trait Gaps {
    /// The gap at a time, as exactly as foretelling takes.
    fn look(&mut self, time: f64) -> Look;

    /// The same, and with all that may be had whether they overlap.
    fn look_closely(&mut self, time: f64) -> Look;

    /// A depth that is surely there at the time last looked at; at most 0 if none is.
    fn depth(&mut self) -> f64;

    /// Whether they touch at the start, as exactly as at rest.
    fn at_rest(&mut self) -> Verdict;

    /// How much the gap may shrink between two instants, as a multiple of what their gaps leave it: below 1 the way between
    /// them is proved free. Infinite where there is no gap.
    fn strain_between(&self, from: &Instant, to: &Instant) -> f64;

    /// Whether all that is left of the way is cheaply proved free.
    fn is_free_to_end(&mut self, from: &Instant) -> bool;

    fn paces(&self) -> Paces;

    /// Iterations left.
    fn remaining(&self) -> u32;
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

/// The first touch; `None` is a proof that the way is free, or that it is so after a touch at the start that is ignored. Up
/// to `entry` it is known to be free.
pub(super) fn first_touch(gaps: &mut impl Gaps, entry: f64, width: &Width, initial: InitialTouch) -> Option<Touch> {
    let mut start = gaps.look(entry);
    let mut is_initial = false;
    if entry == 0.0 && start.instant.free <= 0.0 {
        let rest = gaps.at_rest();
        is_initial = rest != Verdict::Miss;
        if is_initial && initial == InitialTouch::IsIgnored {
            match clear_of_start(gaps) {
                Start::Clear(clear) => start = clear,
                Start::NeverClear => return None,
                Start::Spent(time) => {
                    return Some(touch_at(&start, time, Bound::new(time, 1.0), Verdict::Undecided, Stop::Budget));
                }
            }
            is_initial = false;
        } else if rest == Verdict::Hit || start.is_overlap {
            let touch = touch_at(&start, 0.0, Bound::new(0.0, 0.0), Verdict::Hit, Stop::Tolerance);
            return Some(Touch { normal: None, is_initial: true, ..touch });
        }
    }
    let touch = advance(gaps, start, width)?;
    let is_initial = is_initial && touch.bound.lower == 0.0;
    Some(Touch { is_initial, ..touch })
}

fn advance(gaps: &mut impl Gaps, start: Look, width: &Width) -> Option<Touch> {
    let mut progress = Progress::from(start);
    loop {
        let free = progress.free.instant;
        if let Some(overlap) = progress.overlap
            && overlap - free.time <= width.at(free.time)
        {
            return Some(progress.hit(overlap, Stop::Tolerance));
        }
        if free.time >= 1.0 {
            return progress.doubt.map(|doubt| doubt.open());
        }
        if gaps.remaining() == 0 {
            return Some(match progress.overlap {
                Some(overlap) => progress.hit(overlap, Stop::Budget),
                None => progress.spent(),
            });
        }
        if free.time + progress.predicted() > 1.0 && gaps.is_free_to_end(&free) {
            return progress.doubt.map(|doubt| doubt.open());
        }
        match progress.next_time(&gaps.paces(), width) {
            Some(time) => step(gaps, &mut progress, time),
            None => match resolve(gaps, &progress) {
                Resolved::Touch(overlap) => return Some(progress.hit(overlap, Stop::Converged)),
                Resolved::OpenAgain(look) => step_past(gaps, &mut progress, look),
                Resolved::Never => return Some(progress.doubted(1.0).open()),
                Resolved::Spent => return Some(progress.spent()),
            },
        }
    }
}

/// Looks at a time and takes it as free, or as overlapping, or cuts the step.
fn step(gaps: &mut impl Gaps, progress: &mut Progress, time: f64) {
    let look = gaps.look(time);
    let free = progress.free;
    let strain = gaps.strain_between(&free.instant, &look.instant);
    if strain < 1.0 {
        (progress.before, progress.free, progress.cut) = (Some(free), look, 1.0);
        return;
    }
    if look.is_overlap {
        progress.overlap = Some(time);
    }
    progress.shorten(time, strain);
}

/// Goes on behind a doubtful time, if that it was.
fn step_past(gaps: &impl Gaps, progress: &mut Progress, look: Look) {
    let strain = gaps.strain_between(&progress.free.instant, &look.instant);
    let is_free = strain < 1.0;
    if !is_free {
        let from = progress.doubt.map_or(progress.free, |doubt| doubt.from);
        progress.doubt = Some(Doubt { from, until: look.instant.time });
    }
    (progress.before, progress.free, progress.cut) = (None, look, 1.0);
}

/// From a gap within rounding: seeks proved overlap or a gap that is open again, at growing steps.
fn resolve(gaps: &mut impl Gaps, progress: &Progress) -> Resolved {
    let free = &progress.free;
    let time = free.instant.time;
    let paces = gaps.paces();
    let blur = 8.0 * paces.doubt;
    let closing = -free.growth;
    let straight = if closing > 0.0 { (free.gap.max(0.0) + blur) / closing } else { f64::INFINITY };
    let bent = (2.0 * blur / paces.bend).sqrt();
    let mut ahead = straight.min(bent).min(1.0).max(8.0 * ROUNDING * time);
    let end = progress.overlap.unwrap_or(1.0);
    loop {
        let next = (time + ahead).min(end);
        if next >= end && progress.overlap.is_some() {
            return Resolved::Touch(end);
        }
        if gaps.remaining() == 0 {
            return Resolved::Spent;
        }
        let look = gaps.look_closely(next);
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

/// From a touch at the start, which was last looked at: the first instant that is proved clear. A proved depth lasts as long
/// as the fastest points need for it; only where none is proved are steps chosen freely.
fn clear_of_start(gaps: &mut impl Gaps) -> Start {
    let Paces { speed, doubt, .. } = gaps.paces();
    let blur = 8.0 * doubt;
    let (mut time, mut least) = (0.0, blur);
    if speed <= 0.0 {
        return Start::NeverClear;
    }
    loop {
        if gaps.remaining() == 0 {
            return Start::Spent(time);
        }
        let proved = gaps.depth();
        least = if proved > blur { blur } else { 2.0 * least };
        time += proved.max(least) / speed;
        if time >= 1.0 {
            return Start::NeverClear;
        }
        let look = gaps.look(time);
        if look.instant.free > blur {
            return Start::Clear(look);
        }
    }
}

/// A touch whose place and normal are those of a look.
fn touch_at(look: &Look, fraction: f64, bound: Bound, verdict: Verdict, stop: Stop) -> Touch {
    let normal = (look.instant.normal != DVec3::ZERO).then_some(look.instant.normal);
    Touch {
        fraction: fraction.clamp(bound.lower, bound.upper),
        bound,
        verdict,
        stop,
        normal,
        point: look.point,
        is_initial: false,
    }
}
