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
    /// square leaves the range of f64, or lies so near to its lower end that it lacks digits (1e-138).
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
        let length_sq = self.length_squared();
        let reciprocal = 1.0 / length_sq.sqrt();
        // NaN has no direction.
        (length_sq >= SQUARE_MIN && reciprocal > 0.0).then(|| self * reciprocal)
    }
}

impl Norm for DVec2 {
    #[inline]
    fn norm(self) -> f64 {
        self.length_squared().sqrt()
    }

    #[inline]
    fn try_unit(self) -> Option<Self> {
        let length_sq = self.length_squared();
        let reciprocal = 1.0 / length_sq.sqrt();
        // NaN has no direction.
        (length_sq >= SQUARE_MIN && reciprocal > 0.0).then(|| self * reciprocal)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::Norm;

    #[test]
    fn what_has_a_direction_has_one_of_length_one() {
        for exponent in -330..300 {
            let length = 10f64.powi(exponent);
            let units = [
                DVec3::new(0.3 * length, -length, 0.7 * length).try_unit().map(DVec3::length),
                DVec2::new(0.3 * length, -length).try_unit().map(DVec2::length),
            ];
            for unit in units.into_iter().flatten() {
                assert!((unit - 1.0).abs() < 1e-15, "1e{exponent}: {unit}");
            }
            assert_eq!(units[0].is_some(), (-138..=154).contains(&exponent), "1e{exponent}");
        }
    }
}
