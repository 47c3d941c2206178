//! Numbers of twice the length: an f64 and what it lacks of the true value.
//!
//! # Method
//! Each operation keeps its own rounding error and adds it to the shorter part, so that it is off by at most 16·2⁻¹⁰⁶ of
//! its result. Unlike [`super::expansion`] it is not exact, and needs no memory.
//!
//! # Source
//! Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word arithmetic" (2017):
//! algorithms 6 (sum), 11 (product) and 17 (quotient); the root is one Newton step upon f64's.
//!
//! # Limits
//! As [`super::exact`].

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::exact::{two_product, two_sum};

/// `high + low`, where `high` is the f64 nearest to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twofold {
    /// The nearest f64.
    pub high: f64,
    /// What that lacks.
    pub low: f64,
}

impl Twofold {
    /// Exactly `value`.
    #[must_use]
    pub const fn of(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    /// Exactly `a - b`.
    #[must_use]
    pub fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low }
    }

    /// Exactly `a * b`.
    #[must_use]
    pub fn product(a: f64, b: f64) -> Self {
        let (high, low) = two_product(a, b);
        Self { high, low }
    }

    /// The square root; 0 for 0.
    #[must_use]
    pub fn sqrt(self) -> Self {
        let root = self.high.sqrt();
        if root == 0.0 {
            return Self::default();
        }
        let rest = self - Self::product(root, root);
        Self::normalized(root, rest.high / (2.0 * root))
    }

    fn normalized(high: f64, low: f64) -> Self {
        let (high, low) = two_sum(high, low);
        Self { high, low }
    }
}

impl Add for Twofold {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, error_low) = two_sum(self.low, other.low);
        let sum = Self::normalized(high, error + low);
        Self::normalized(sum.high, error_low + sum.low)
    }
}

impl Neg for Twofold {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Twofold {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twofold {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        Self::normalized(high, error + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Twofold {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let high = self.high / other.high;
        let rest = self - other * Self::of(high);
        Self::normalized(high, rest.high / other.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_one_f64_loses_is_kept() {
        let third = Twofold::of(1.0) / Twofold::of(3.0);
        let back = third * Twofold::of(3.0) - Twofold::of(1.0);
        assert!(back.high.abs() < f64::EPSILON * f64::EPSILON, "{back:?}");
        let root = Twofold::of(2.0).sqrt();
        let back = root * root - Twofold::of(2.0);
        assert!(back.high.abs() < 4.0 * f64::EPSILON * f64::EPSILON, "{back:?}");
        let sum = Twofold::of(1e16) + Twofold::of(1.0) + Twofold::of(-1e16);
        assert_eq!(sum, Twofold::of(1.0));
        assert_eq!(Twofold::default().sqrt(), Twofold::default());
    }
}
