//! Rays against half spaces.
//!
//! # Method
//! The height of the ray's origin over the plane and the speed at which the ray climbs are computed from what was sent, in
//! numbers of twice the length; the plane is met at their quotient. Nothing is lost far away, so no shift is needed. Where
//! the signs of height or speed are within their errors, exact sums decide what is not turned: a ray in the plane is in
//! the half space.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    Ray, RayTouches,
    crossing::{Crossing, Judged, Wall},
};
use crate::{
    answer::{Bound, Method, Stop},
    math::{Pose, scaled_by_power_of_two, twofold::Twofold},
    narrow::half_space::{ExactPlane, Height, Plane, difference, unit},
    shape::HalfSpace,
    tolerance::{ROUNDING, STEP_SHORTENING},
};

/// What a ray touches of a half space.
pub(super) fn touches(ray: &Ray, half_space: &HalfSpace, pose: &Pose) -> RayTouches {
    let plane = Plane::new(half_space, pose);
    let direction = scaled_by_power_of_two(ray.direction);
    let way = unit(direction.to_array().map(Twofold::of));
    let mut height = Range::new(plane.height(&difference(ray.origin, pose.position)));
    let mut climb = Range::new(plane.along(&way));
    if (height.sign.is_none() || climb.sign.is_none())
        && let Some(exact) = ExactPlane::new(half_space, pose)
    {
        height.learn(exact.sign(ray.origin, DVec3::ZERO, 0.0, [DVec3::ZERO; 2]));
        climb.learn(exact.side_of(direction));
    }
    let Some(crossing) = crossing(height, climb, plane.normal) else {
        return RayTouches::default();
    };
    let along = DVec3::from_array(way.map(|component| component.high));
    let touch = |judged: Judged| {
        let reached = ray.origin + along * judged.distance();
        // From far away the product is off by more than the plane is.
        let off = plane.height(&difference(reached, pose.position)).value.high;
        let point = if judged.is_inside() { reached } else { reached - plane.normal * off };
        let towards_asker = if climb.best > 0.0 { DVec3::ZERO - plane.normal } else { plane.normal };
        crossing.touch(judged, point + DVec3::ZERO, towards_asker)
    };
    let (certain, undecided) = crossing.judged(ray, ray.min_distance, ray.max_distance.min(f64::MAX));
    RayTouches { certain: certain.map(touch), undecided: undecided.map(touch) }
}

/// Bounds of a number, and its sign if that is known.
#[derive(Clone, Copy)]
struct Range {
    lower: f64,
    best: f64,
    upper: f64,
    sign: Option<Ordering>,
}

impl Range {
    fn new(height: Height) -> Self {
        let best = height.value.high;
        // What is subnormal has rounding that is no part of it.
        let error = height.error + ROUNDING * best.abs() + f64::MIN_POSITIVE;
        let (lower, upper) = (best - error, best + error);
        let sign = if lower > 0.0 {
            Some(Ordering::Greater)
        } else if upper < 0.0 {
            Some(Ordering::Less)
        } else {
            None
        };
        Self { lower, best, upper, sign }
    }

    /// Takes in the exact sign.
    fn learn(&mut self, sign: Option<Ordering>) {
        match sign {
            Some(Ordering::Less) => self.upper = self.upper.min(0.0),
            Some(Ordering::Equal) => (self.lower, self.upper) = (0.0, 0.0),
            Some(Ordering::Greater) => self.lower = self.lower.max(0.0),
            None => return,
        }
        self.best = self.best.clamp(self.lower, self.upper);
        self.sign = sign;
    }

    fn negated(self) -> Self {
        let sign = self.sign.map(Ordering::reverse);
        Self { lower: -self.upper, best: -self.best, upper: -self.lower, sign }
    }
}

/// The stretch of the line inside the half space; `None` if surely none.
fn crossing(height: Range, climb: Range, normal: DVec3) -> Option<Crossing> {
    const BEFORE: (f64, Bound) = (f64::NEG_INFINITY, Bound::new(f64::NEG_INFINITY, f64::NEG_INFINITY));
    const AFTER: (f64, Bound) = (f64::INFINITY, Bound::new(f64::INFINITY, f64::INFINITY));
    let is_inside = matches!(height.sign, Some(Ordering::Less | Ordering::Equal));
    let (entry, exit, certain) = match climb.sign {
        Some(Ordering::Less) => (quotient(height, climb.negated()), AFTER, true),
        Some(Ordering::Greater) => (BEFORE, quotient(height.negated(), climb), true),
        Some(Ordering::Equal) if height.sign == Some(Ordering::Greater) => return None,
        Some(Ordering::Equal) => (BEFORE, AFTER, is_inside),
        None => {
            // All but along the plane: inside, or outside, at least so far to both sides.
            let steepest = climb.lower.abs().max(climb.upper.abs());
            let least = (height.lower.max(-height.upper).max(0.0) / steepest) * STEP_SHORTENING;
            match height.sign {
                Some(Ordering::Less | Ordering::Equal) => {
                    ((-least, Bound::new(f64::NEG_INFINITY, -least)), (least, Bound::new(least, f64::INFINITY)), true)
                }
                Some(Ordering::Greater) => ((least, Bound::new(least, f64::INFINITY)), AFTER, false),
                None => ((0.0, Bound::new(f64::NEG_INFINITY, f64::INFINITY)), AFTER, false),
            }
        }
    };
    let wall = |(best, bound): (f64, Bound)| Wall { bound, best, normal, face: None };
    Some(Crossing {
        entry: wall(entry),
        exit: wall(exit),
        certain,
        method: Method::ClosedForm,
        stop: Stop::Converged,
        iterations: 1,
    })
}

/// `a / b` for a `b` above 0.
fn quotient(a: Range, b: Range) -> (f64, Bound) {
    let over = |value: f64, small: f64, large: f64| match value {
        0.0 => 0.0,
        // Never by −0, which would turn the sign.
        _ => value / (if value > 0.0 { small } else { large } + 0.0),
    };
    let (lower, upper) = (over(a.lower, b.upper, b.lower), over(a.upper, b.lower, b.upper));
    // Finite, so that no bound that is infinite becomes no number.
    let rounding = |value: f64| (1.0 - STEP_SHORTENING) * value.abs().min(f64::MAX);
    let bound = Bound::new(lower - rounding(lower), upper + rounding(upper));
    ((over(a.best, b.best, b.best)).clamp(bound.lower, bound.upper), bound)
}
