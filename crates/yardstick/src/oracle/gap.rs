//! How far two forms are apart at a time of their motion, as well as one who looks for their touch needs it.

use super::{
    apart::{self, Needed},
    double::{Double, Number},
    form::Solid,
    frame::Pair,
    place::Place,
    plane,
    space::{Vector, times_power_of_two},
};

/// A gap, in the frame of the pair.
pub(super) struct Gap {
    /// They are so far apart at least.
    pub(super) lower: Double,
    /// They are not farther apart; to a thousandth of that.
    pub(super) upper: Double,
    /// From `a` to `b`, along which the lower bound is.
    pub(super) normal: Vector<Double>,
    /// Metres times two to this are lengths of the frame.
    pub(super) exponent: i32,
}

/// In the frame of the pair forms this near touch, or do so within the rounding of 32 digits.
const NEAR: f64 = 4e-27;

impl Gap {
    pub(super) fn at(sides: [(&Solid, &Place); 2], time: Double) -> Self {
        let pair = Pair::at(sides, time);
        let exponent = pair.exponent;
        if let Some((gap, normal)) = plane::signed_distance(sides[0].0, sides[1].0, &pair) {
            let gap = gap - pair.radius;
            return Self { lower: gap, upper: gap, normal, exponent };
        }
        let apart = apart::distance(&pair, Needed::Roughly);
        Self { lower: apart.lower - pair.radius, upper: apart.upper - pair.radius, normal: apart.normal, exponent }
    }

    /// They are surely apart.
    pub(super) fn is_open(&self) -> bool {
        self.lower.nearest() > NEAR
    }

    /// They touch, within rounding.
    pub(super) fn is_closed(&self) -> bool {
        self.upper.nearest() <= NEAR
    }

    /// They touch, whatever was rounded; exact zeros are such.
    pub(super) fn is_surely_closed(&self) -> bool {
        let upper = self.upper.nearest();
        upper <= -NEAR || upper == 0.0
    }

    /// A length in metres.
    pub(super) fn metres(&self, length: Double) -> f64 {
        times_power_of_two(length.nearest(), -self.exponent)
    }
}
