//! Numbers of twice the precision of an f64: about 32 digits.
//!
//! # Method
//! A number is the unevaluated sum of two f64, the second at most half a unit in the last place of the first. Sums and
//! products are split into result and error without loss (Knuth, The Art of Computer Programming 2, 4.2.2; Dekker,
//! "A floating-point technique for extending the available precision", 1971).
//!
//! # Limits
//! Range is that of f64: products below 1e-290 lose digits. Callers scale first.

use std::{
    cmp::Ordering,
    fmt::Debug,
    ops::{Add, Div, Mul, Neg, Sub},
};

use super::space::times_power_of_two;

/// What the oracle computes with, so that one formula serves both precisions.
pub trait Number:
    Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Exactly this number.
    fn of(value: f64) -> Self;
    /// The nearest f64.
    fn nearest(self) -> f64;
    /// The square root; 0 for what rounding took below 0.
    #[must_use]
    fn root(self) -> Self;

    /// Without its sign.
    #[must_use]
    fn size(self) -> Self {
        if self < Self::of(0.0) { -self } else { self }
    }
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn nearest(self) -> f64 {
        self
    }

    fn root(self) -> Self {
        if self > 0.0 { self.sqrt() } else { 0.0 }
    }
}

/// A number of about 32 digits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Double {
    high: f64,
    low: f64,
}

impl Double {
    /// The exact difference of two numbers.
    #[must_use]
    pub fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low }
    }

    /// The exact product of two numbers.
    #[must_use]
    pub fn product(a: f64, b: f64) -> Self {
        let (high, low) = two_product(a, b);
        Self { high, low }
    }

    /// Times a power of two: exact unless it leaves the range of f64.
    #[must_use]
    pub fn times_power_of_two(self, exponent: i32) -> Self {
        Self { high: times_power_of_two(self.high, exponent), low: times_power_of_two(self.low, exponent) }
    }

    #[inline]
    fn renormalised(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }
}

/// Sum and its error, exactly.
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// Splits 53 bits into 26 and 27.
const SPLITTER: f64 = 134_217_729.0;

#[inline]
fn halves(a: f64) -> (f64, f64) {
    let wide = SPLITTER * a;
    let high = wide - (wide - a);
    (high, a - high)
}

/// Product and its error, exactly where nothing underflows.
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    (product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

impl Number for Double {
    #[inline]
    fn of(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    #[inline]
    fn nearest(self) -> f64 {
        self.high
    }

    #[inline]
    /// One step of Newton's from the root of the higher part doubles its digits.
    fn root(self) -> Self {
        if self.high <= 0.0 {
            return Self::default();
        }
        let near = self.high.sqrt();
        let rest = self - Self::product(near, near);
        Self::renormalised(near, rest.high / (2.0 * near))
    }
}

impl Add for Double {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let (high, high_error) = two_sum(self.high, other.high);
        let (low, low_error) = two_sum(self.low, other.low);
        let near = Self::renormalised(high, high_error + low);
        Self::renormalised(near.high, near.low + low_error)
    }
}

impl Neg for Double {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Double {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let (product, error) = two_product(self.high, other.high);
        Self::renormalised(product, error + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Double {
    type Output = Self;

    /// Long division with three digits of 53 bits each.
    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::of(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::of(second);
        let third = rest.high / other.high;
        Self::renormalised(first, second) + Self::of(third)
    }
}

impl PartialOrd for Double {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.high.partial_cmp(&other.high)?.then(self.low.partial_cmp(&other.low)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within some units of the 106th bit.
    fn is_near(a: Double, b: Double) -> bool {
        (a - b).nearest().abs() <= 1e-31 * b.nearest().abs()
    }

    #[test]
    fn the_root_of_two_is_known() {
        // 1.41421356237309504880168872420969807856967...
        let known = Double { high: std::f64::consts::SQRT_2, low: -9.667_293_313_452_913e-17 };
        assert!(is_near(Double::of(2.0).root(), known));
        assert!(is_near(known * known, Double::of(2.0)));
    }

    #[test]
    fn a_third_three_times_is_one() {
        let third = Double::of(1.0) / Double::of(3.0);
        assert!(is_near(third + third + third, Double::of(1.0)));
        assert_eq!(third.low, 1.850_371_707_708_594e-17);
    }

    #[test]
    fn differences_and_products_are_exact() {
        let tiny = f64::EPSILON / 4.0;
        let sum = Double::of(1.0) + Double::of(tiny);
        assert_eq!(sum, Double { high: 1.0, low: tiny });
        assert!(sum > Double::of(1.0) && -sum < Double::of(-1.0));
        assert_eq!(Double::difference(1e9, 1e-9) - Double::of(1e9), Double::of(-1e-9));
        let (a, b) = (1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
        assert_eq!(Double::product(a, b), Double { high: 1.0, low: -f64::EPSILON * f64::EPSILON });
    }

    #[test]
    fn what_rounding_took_below_zero_has_root_zero() {
        assert_eq!(Double::of(-1e-40).root(), Double::default());
        assert_eq!(Number::root(-1e-40_f64), 0.0);
    }
}
