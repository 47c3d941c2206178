//! The larger and the smaller of two numbers, each in one instruction.
//!
//! # Method
//! Comparisons, where `f64::max` and `f64::min` see to NaN as well, which takes six instructions.

/// The larger one; `b` if `a` is NaN.
#[inline]
#[must_use]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller one; `b` if `a` is NaN.
#[inline]
#[must_use]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}
