//! Error-free transforms: sums and products whose rounding error is kept, so that differences lose nothing.
//!
//! # Source
//! Dekker, "A floating-point technique for extending the available precision" (1971), sections 4 and 5; Knuth, The Art of
//! Computer Programming 2, 4.2.2 (two-sum). No fused multiply-add, so that every machine gives the same bits.
//!
//! # Limits
//! Products below 1e-290 or above 1e290 lose the guarantee (the error term leaves the range); sizes of a world do not
//! reach there.

use std::ops::{Add, Sub};

use glam::DVec3;

/// `a + b` as a rounded sum and its exact error; of vectors each component's.
#[inline]
#[must_use]
pub fn two_sum<N: Copy + Add<Output = N> + Sub<Output = N>>(a: N, b: N) -> (N, N) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

/// `a - b` of each component as a rounded difference and its exact error.
#[inline]
#[must_use]
pub fn exact_difference(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    two_sum(a, -b)
}

/// `a * b` as a rounded product and its exact error.
#[must_use]
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}

/// `a * b - c * d` to within two units in the last place of the result.
#[must_use]
pub fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (left, left_error) = two_product(a, b);
    let (right, right_error) = two_product(c, d);
    let (difference, error) = two_sum(left, -right);
    difference + (error + (left_error - right_error))
}

/// `a × b`, each component to within two units in its last place.
#[must_use]
pub fn cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        difference_of_products(a.y, b.z, a.z, b.y),
        difference_of_products(a.z, b.x, a.x, b.z),
        difference_of_products(a.x, b.y, a.y, b.x),
    )
}

/// Splits into two halves of 26 bits whose sum is exact.
fn split(a: f64) -> (f64, f64) {
    const SPLITTER: f64 = 134_217_729.0; // 2^27 + 1
    let scaled = SPLITTER * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cancelled_products_keep_their_difference() {
        let (a, b) = (1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
        assert_eq!(a * b - 1.0, 0.0, "plain arithmetic loses it");
        assert_eq!(difference_of_products(a, b, 1.0, 1.0), -f64::EPSILON * f64::EPSILON);
    }

    #[test]
    fn two_product_is_exact_for_squares_of_odd_numbers() {
        let a = 134_217_729.0_f64 * 3.0 + 2.0;
        let (product, error) = two_product(a, a);
        let exact = (a as u128) * (a as u128);
        assert_eq!(product as u128 as i128 + error as i128, exact as i128);
    }
}
