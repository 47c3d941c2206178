//! Looks for an overlap of two forms in any motion, before a time at which it is claimed that there was none.
//!
//! # Method
//! At each time looked at the signed distance is known on both sides. Apart, no point is faster than the sum of both
//! displacements and of spins times radii, so the forms stay apart for as long as the gap takes at that speed. What is left
//! after a number of such steps is looked at here and there, most densely just before the end.
//!
//! # Limits
//! That none is found proves there is none only as far as [`Sighting::free_until`] says.

use super::{
    double::{Double, Number},
    form::Solid,
    gap::Gap,
    place::Place,
};

/// What was seen.
#[derive(Clone, Copy, Debug)]
pub struct Sighting {
    /// A time before the end at which they surely overlap.
    pub overlap_at: Option<f64>,
    /// It is proved that they do not touch before this time, as a part of the motion.
    pub free_until: f64,
}

/// Steps with proof, and times looked at after those.
const STEPS_MAX: usize = 24;
const LOOKS: u32 = 12;

/// Looks for a time before `end` at which two forms surely overlap.
#[must_use]
pub fn look_for_overlap(sides: [(&Solid, &Place); 2], end: f64) -> Sighting {
    let speed = |(solid, place): (&Solid, &Place)| {
        let arm = place.part.map_or(0.0, |(position, _)| position.length());
        place.displacement.length() + place.spin.length() * (solid.reach() + arm)
    };
    let speed = (speed(sides[0]) + speed(sides[1])) * (1.0 + 1e-9);
    let look = |time: f64, seen: &mut Sighting| {
        let gap = Gap::at(sides, Double::of(time));
        if gap.is_closed() && seen.overlap_at.is_none() {
            seen.overlap_at = Some(time);
        }
        gap.metres(gap.lower).next_down()
    };
    let mut seen = Sighting { overlap_at: None, free_until: 0.0 };
    for _ in 0..STEPS_MAX {
        if seen.free_until >= end || seen.overlap_at.is_some() {
            return seen;
        }
        let gap = look(seen.free_until, &mut seen);
        // A point at rest is never faster than nothing.
        let next = seen.free_until + gap / speed;
        if next <= seen.free_until {
            break;
        }
        seen.free_until = if next.is_nan() { f64::INFINITY } else { next };
    }
    let rest = end - seen.free_until;
    for index in 1..=LOOKS {
        if seen.overlap_at.is_some() || rest <= 0.0 {
            break;
        }
        let spread = seen.free_until + rest * (f64::from(index) / f64::from(LOOKS + 1));
        let dense = end - rest * 0.25_f64.powf(f64::from(index) * 1.5);
        for time in [spread, dense, end.next_down()] {
            if time < end {
                look(time, &mut seen);
            }
        }
    }
    seen
}
