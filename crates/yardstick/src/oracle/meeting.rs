//! The first touch of two convex forms that move and do not turn.
//!
//! # Method
//! The signed distance of such forms is a convex function of the time. From a time at which they are apart, the plane between
//! them says how long they surely stay so; from there the next plane. That is Newton's method from the outside of a convex
//! function: no step is too far, and a plane that they do not close in on proves that they never meet.
//!
//! # Limits
//! At a graze the steps only halve the rest: what is left then stays open.

use glam::DVec3;

use super::{
    double::{Double, Number},
    form::Solid,
    gap::Gap,
    place::Place,
    space::{Vector, times_power_of_two},
};

/// When two forms first touch.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// They surely do not touch before this time; infinite if they never meet from the start on.
    pub free_until: f64,
    /// They surely touch at this time, if that is known: a little later than the first touch.
    pub touching_at: Option<f64>,
    /// They touch at the start, surely or within rounding.
    pub touches_at_start: bool,
    /// Cosine between the way and the normal that they meet along, below 0 if they touch at the start and part; 1 where they do not
    /// meet or do not move.
    pub cosine: f64,
    /// From `a` to `b` shortly before they meet; within a tenth of a radian.
    pub normal_a_to_b: DVec3,
    /// How far apart they surely are at the start, metres.
    pub gap_at_start: f64,
}

/// Steps at most.
const STEPS_MAX: usize = 150;

/// When two forms first touch after the start; their spins are not looked at.
#[must_use]
pub fn meeting(sides: [(&Solid, &Place); 2]) -> Meeting {
    let at = |time: Double| Gap::at(sides, time);
    let mut time = Double::of(0.0);
    let mut here = at(time);
    // At rest, whose frame is finer than that of a long way.
    let still = sides.map(|(solid, place)| (solid, Place { displacement: DVec3::ZERO, ..*place }));
    let rest = Gap::at([(still[0].0, &still[0].1), (still[1].0, &still[1].1)], time);
    let gap_at_start = rest.metres(rest.lower);
    let never = |free_until: f64| Meeting {
        free_until,
        touching_at: None,
        touches_at_start: false,
        cosine: 1.0,
        normal_a_to_b: DVec3::ZERO,
        gap_at_start,
    };
    let scaled = |v: DVec3| v.to_array().map(|part| Double::of(times_power_of_two(part, here.exponent)));
    let (of_a, of_b) = (scaled(sides[0].1.displacement), scaled(sides[1].1.displacement));
    let ahead = Vector { x: of_b[0] - of_a[0], y: of_b[1] - of_a[1], z: of_b[2] - of_a[2] };
    let length = ahead.length().nearest();
    if !rest.is_open() || !here.is_open() {
        let touching_at = rest.is_surely_closed().then_some(0.0);
        let cosine = if length > 0.0 { -rest.normal.dot(ahead).nearest() / length } else { 1.0 };
        return Meeting { touching_at, touches_at_start: true, cosine, ..never(0.0) };
    }
    let (mut cosine, mut normal) = (1.0, here.normal);
    for _ in 0..STEPS_MAX {
        if !here.is_open() {
            break;
        }
        let (gap, opening) = (here.lower, here.normal.dot(ahead));
        if opening.nearest() >= 0.0 {
            return never(f64::INFINITY);
        }
        (cosine, normal) = (-opening.nearest() / length, here.normal);
        let next = time + gap / -opening;
        if next.nearest() > BEYOND {
            return never(next.nearest());
        }
        if next <= time {
            break;
        }
        (time, here) = (next, at(next));
    }
    let touching_at = touching_after(time, at);
    Meeting {
        free_until: time.nearest().next_down(),
        touching_at,
        touches_at_start: false,
        cosine,
        normal_a_to_b: normal.nearest(),
        gap_at_start,
    }
}

/// Later times are of no account: motions end at 1.
const BEYOND: f64 = 1.5;

/// A time soon after another at which they surely touch, at growing steps; `None` if there is none, or they barely do.
fn touching_after(time: Double, at: impl Fn(Double) -> Gap) -> Option<f64> {
    if at(time).is_closed() {
        return Some(time.nearest().next_up());
    }
    let mut step = 1e-26;
    while step < 1e-3 {
        let later = time + Double::of(step);
        let gap = at(later);
        if gap.is_closed() {
            return Some(later.nearest().next_up());
        }
        if gap.is_open() && step > 1e-20 {
            return None;
        }
        step *= 32.0;
    }
    None
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::oracle::{Core, PlacedSolid};

    /// A ball on a plane that is left: whether they touch at the start is known only where 32 digits tell it.
    #[test]
    fn a_gap_below_the_rounding_of_32_digits_is_no_touch_and_none_surely() {
        let plane = Solid { core: Core::HalfSpace { normal: DVec3::X, offset: 0.0 }, radius: 0.0 };
        let ball = Solid { core: Core::Point, radius: 0.5 };
        let place = |solid: &Solid, position: DVec3| {
            Place::of(&PlacedSolid { solid: solid.clone(), position, rotation: DQuat::IDENTITY })
        };
        let met = |gap: f64| {
            let left = Place { displacement: -DVec3::X, ..place(&plane, DVec3::new(-0.5, 0.0, 0.0)) };
            meeting([(&ball, &place(&ball, DVec3::new(gap, 0.0, 0.0))), (&plane, &left)])
        };
        let [apart, open, touching, deep] = [1e-20, 2e-27, 0.0, -1e-20].map(met);
        assert!(apart.touching_at.is_none() && !apart.touches_at_start, "{apart:?}");
        assert!(open.touching_at.is_none() && open.touches_at_start, "{open:?}");
        assert_eq!([touching, deep].map(|met| met.touching_at), [Some(0.0); 2]);
    }
}
