//! Exact vectors, rotations and fractions of whole numbers.
#![allow(dead_code, reason = "each test file uses its part of it")]

pub(crate) mod scene;

use std::cmp::Ordering;

use collision::DVec3;

/// A vector of whole numbers.
pub(crate) type V3 = [i128; 3];

/// A repeatable sequence of whole numbers.
pub(crate) struct Numbers(u64);

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// From 0 to `limit - 1`.
    pub(crate) fn below(&mut self, limit: i128) -> i128 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        i128::from(mixed >> 8) % limit
    }

    /// From `-limit` to `limit`.
    pub(crate) fn within(&mut self, limit: i128) -> i128 {
        self.below(2 * limit + 1) - limit
    }

    /// From −1 to 1.
    pub(crate) fn share(&mut self) -> f64 {
        self.within(1 << 40) as f64 / (1_u64 << 40) as f64
    }

    /// Each component from −1 to 1.
    pub(crate) fn shares(&mut self) -> DVec3 {
        DVec3::new(self.share(), self.share(), self.share())
    }

    /// A power of ten with an exponent in a range.
    pub(crate) fn magnitude(&mut self, from: f64, to: f64) -> f64 {
        10.0_f64.powf(from + (to - from) * (0.5 * self.share() + 0.5))
    }

    /// Each component from `-limit` to `limit`.
    pub(crate) fn vector(&mut self, limit: i128) -> V3 {
        [0; 3].map(|_| self.within(limit))
    }
}

pub(crate) fn to_f64(v: V3) -> DVec3 {
    DVec3::from_array(v.map(|part| part as f64))
}

pub(crate) fn dot(a: V3, b: V3) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn minus(a: V3, b: V3) -> V3 {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

pub(crate) fn cross(a: V3, b: V3) -> V3 {
    let part = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [part(1, 2), part(2, 0), part(0, 1)]
}

/// `|q|²` times the vector turned by the quaternion.
pub(crate) fn turned([x, y, z, w]: [i128; 4], v: V3) -> V3 {
    let (xx, yy, zz, ww) = (x * x, y * y, z * z, w * w);
    [
        dot([ww + xx - yy - zz, 2 * (x * y - w * z), 2 * (x * z + w * y)], v),
        dot([2 * (x * y + w * z), ww - xx + yy - zz, 2 * (y * z - w * x)], v),
        dot([2 * (x * z - w * y), 2 * (y * z + w * x), ww - xx - yy + zz], v),
    ]
}

/// `|q|²` times the vector turned back.
pub(crate) fn turned_back([x, y, z, w]: [i128; 4], v: V3) -> V3 {
    turned([-x, -y, -z, w], v)
}

/// A fraction with a positive denominator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fraction {
    numerator: i128,
    denominator: i128,
}

impl Fraction {
    pub(crate) fn new(numerator: i128, denominator: i128) -> Self {
        assert!(denominator > 0);
        Self { numerator, denominator }
    }

    pub(crate) fn to_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

impl Ord for Fraction {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.numerator * other.denominator).cmp(&(other.numerator * self.denominator))
    }
}

impl PartialOrd for Fraction {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Fraction {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Fraction {}
