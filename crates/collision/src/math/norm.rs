//! Lengths of vectors by the processor's own square root.
//!
//! # Method
//! A root is rounded to nearest on every machine, so unlike the functions that glam takes from libm for the sake of equal
//! bytes it needs no software: a call into libm costs a kernel a fifth of its time.

use glam::{DVec2, DVec3};

use crate::tolerance::SQUARE_MIN;

/// Lengths and directions, of the same bits as glam's.
pub trait Norm: Sized {
    /// The length.
    #[must_use]
    fn norm(self) -> f64;

    /// The same direction with length 1, to within 4 roundings in each component; `None` for a length of 0 or one whose
    /// square leaves the range in which f64 has all its digits: see [`SQUARE_MIN`].
    #[must_use]
    fn try_unit(self) -> Option<Self>;
}

impl Norm for DVec3 {
    #[inline]
    fn norm(self) -> f64 {
        self.length_squared().sqrt()
    }

    #[inline]
    fn try_unit(self) -> Option<Self> {
        reciprocal_root(self.length_squared()).map(|reciprocal| self * reciprocal)
    }
}

impl Norm for DVec2 {
    #[inline]
    fn norm(self) -> f64 {
        self.length_squared().sqrt()
    }

    #[inline]
    fn try_unit(self) -> Option<Self> {
        reciprocal_root(self.length_squared()).map(|reciprocal| self * reciprocal)
    }
}

#[inline]
fn reciprocal_root(square: f64) -> Option<f64> {
    (SQUARE_MIN..=f64::MAX).contains(&square).then(|| 1.0 / square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found by a random search: below the root of the least normal number lengths were off by up to a half, and what was
    /// projected on such a vector too short.
    #[test]
    fn what_has_no_exact_square_has_no_unit_vector() {
        for power in -165..=155 {
            let vector = DVec3::new(0.3, -0.7, 0.55) * 10f64.powi(power);
            let unit = vector.try_unit();
            assert_eq!(unit.is_some(), (-137..=154).contains(&power), "1e{power}");
            assert!(unit.is_none_or(|unit| (unit.length() - 1.0).abs() < 1e-15), "1e{power}");
        }
    }
}
