//! Lengths of vectors by the processor's own square root.
//!
//! # Method
//! A root is rounded to nearest on every machine, so unlike the functions that glam takes from libm for the sake of equal
//! bytes it needs no software: a call into libm costs a kernel a fifth of its time.

use glam::{DVec2, DVec3};

/// Lengths and directions, of the same bits as glam's.
pub trait Norm: Sized {
    /// The length.
    #[must_use]
    fn norm(self) -> f64;

    /// The same direction with length 1, to within 4 roundings in each component; `None` for a length of 0 or one whose
    /// square or reciprocal leaves the range of f64.
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
        let reciprocal = 1.0 / self.norm();
        (reciprocal.is_finite() && reciprocal > 0.0).then(|| self * reciprocal)
    }
}

impl Norm for DVec2 {
    #[inline]
    fn norm(self) -> f64 {
        self.length_squared().sqrt()
    }

    #[inline]
    fn try_unit(self) -> Option<Self> {
        let reciprocal = 1.0 / self.norm();
        (reciprocal.is_finite() && reciprocal > 0.0).then(|| self * reciprocal)
    }
}
