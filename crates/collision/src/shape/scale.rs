//! At which scale points are decided on, so that the signs of volumes are exact.
//!
//! # Method
//! All coordinates are multiplied by the power of two that takes the largest to 2¹⁰⁰ (from 2⁴⁹ on, if it is subnormal).
//! Volumes then stay below 2³¹⁰, and where all bits of all coordinates are at least 2⁻³⁵⁸, products of three are
//! multiples of 2⁻¹⁰⁷⁴, which f64 holds exactly.
//!
//! # Limits
//! A coordinate below 2⁻⁴⁰⁶ of the largest counts as 0: points so near to each other are one, and points so nearly in a
//! plane are in it.

use glam::DVec3;

/// The binary exponent to which the largest coordinate is taken.
const LARGEST_EXPONENT: i32 = 100;

/// The least exponent of a coordinate that counts, so that its last bit is 2⁻³⁵⁸.
const LEAST_EXPONENT: i32 = -358 + 52;

/// Points, scaled by a power of two.
pub(super) struct Scaled {
    /// The points, in their order.
    pub(super) points: Vec<DVec3>,
    /// How far a point may lie from the exact one, scaled: 0 unless coordinates counted as 0.
    pub(super) blur: f64,
    lift: i32,
}

impl Scaled {
    /// The scaled form of finite points.
    pub(super) fn new(points: &[DVec3]) -> Self {
        let largest = points.iter().map(|point| point.abs().max_element()).fold(0.0, f64::max);
        let lift = LARGEST_EXPONENT - exponent(largest);
        let least = power_of_two(LEAST_EXPONENT);
        let mut blur = 0.0;
        let mut number = |value: f64| {
            let lifted = times_power_of_two(value, lift);
            if lifted.abs() >= least {
                return lifted;
            }
            if value != 0.0 {
                // √3 of it, for three coordinates.
                blur = 2.0 * least;
            }
            0.0
        };
        let points = points.iter().map(|point| DVec3::from_array(point.to_array().map(&mut number))).collect();
        Self { points, blur, lift }
    }

    /// A length at this scale in metres; of what is subnormal the next larger one.
    pub(super) fn length_out_up(&self, length: f64) -> f64 {
        let metres = times_power_of_two(length, -self.lift);
        if length > 0.0 && metres < f64::MIN_POSITIVE { metres.next_up() } else { metres }
    }

    /// A length in metres at this scale; infinite if it is beyond.
    pub(super) fn length_in(&self, metres: f64) -> f64 {
        times_power_of_two(metres, self.lift)
    }
}

/// In two steps, since no single power of two takes the least number to the largest coordinate.
fn times_power_of_two(value: f64, exponent: i32) -> f64 {
    value * power_of_two(exponent / 2) * power_of_two(exponent - exponent / 2)
}

/// The binary exponent of a number; that of subnormal ones and of 0 is −1023.
fn exponent(value: f64) -> i32 {
    (value.to_bits() >> 52 & 0x7FF) as i32 - 1023
}

/// 2 to a power from −1022 to 1023.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}
