//! Exact sums and products of any number of f64, for signs that rounding would hide.
//!
//! # Method
//! A number is kept as a sum of f64 that do not overlap, smallest first, zeros left out. Inputs with few bits (f32 data)
//! give short sums, so the exact tier costs little where data allow it.
//!
//! # Source
//! Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates" (1997), sections 2.4 to
//! 2.8 (grow-expansion, zero elimination). Products are summed one by one instead of by distillation: this is a fallback.
//!
//! # Limits
//! As [`super::exact`]: factors between 1e-60 and 1e60 (or 0), for products of up to four of them.

use std::cmp::Ordering;

use glam::DVec3;

use super::exact::{self, two_product, two_sum};
use crate::tolerance;

/// An exact number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expansion {
    terms: Vec<f64>,
}

impl Expansion {
    /// Exactly `a - b`.
    #[must_use]
    pub fn difference(a: f64, b: f64) -> Self {
        let (difference, error) = two_sum(a, -b);
        let mut exact = Self::default();
        exact.add(error);
        exact.add(difference);
        exact
    }

    /// Adds a number.
    pub fn add(&mut self, value: f64) {
        let mut carry = value;
        let mut kept = 0;
        for index in 0..self.terms.len() {
            let (sum, error) = two_sum(carry, self.terms[index]);
            carry = sum;
            if error != 0.0 {
                self.terms[kept] = error;
                kept += 1;
            }
        }
        self.terms.truncate(kept);
        if carry != 0.0 {
            self.terms.push(carry);
        }
    }

    /// Adds `a * b`.
    pub fn add_product(&mut self, a: &Self, b: &Self) {
        for &left in &a.terms {
            for &right in &b.terms {
                let (product, error) = two_product(left, right);
                self.add(error);
                self.add(product);
            }
        }
    }

    /// The negative.
    #[must_use]
    pub fn negated(&self) -> Self {
        Self { terms: self.terms.iter().map(|term| -term).collect() }
    }

    /// Its sign, as compared with 0.
    #[must_use]
    pub fn sign(&self) -> Ordering {
        self.terms.last().map_or(Ordering::Equal, |largest| largest.total_cmp(&0.0))
    }

    /// The nearest f64, to within an ulp or two.
    #[must_use]
    pub fn estimate(&self) -> f64 {
        self.terms.iter().sum()
    }
}

/// A vector of exact numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExactVector(pub [Expansion; 3]);

impl ExactVector {
    /// Exactly `a - b`.
    #[must_use]
    pub fn difference(a: DVec3, b: DVec3) -> Self {
        Self([Expansion::difference(a.x, b.x), Expansion::difference(a.y, b.y), Expansion::difference(a.z, b.z)])
    }

    /// Exactly `self × other`.
    #[must_use]
    pub fn cross(&self, other: &Self) -> Self {
        let component = |i: usize, j: usize| {
            let mut sum = Expansion::default();
            sum.add_product(&self.0[i], &other.0[j]);
            sum.add_product(&self.0[j].negated(), &other.0[i]);
            sum
        };
        Self([component(1, 2), component(2, 0), component(0, 1)])
    }

    /// Exactly `self · other`.
    #[must_use]
    pub fn dot(&self, other: &Self) -> Expansion {
        let mut sum = Expansion::default();
        for axis in 0..3 {
            sum.add_product(&self.0[axis], &other.0[axis]);
        }
        sum
    }

    /// Whether all components are 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.0.iter().all(|component| component.sign() == Ordering::Equal)
    }

    /// Whether products of four such components stay exact: each part has a size within the limits of
    /// [`tolerance::EXACT_PART_MIN`].
    #[must_use]
    pub fn is_in_range(&self) -> bool {
        self.0.iter().flat_map(|component| &component.terms).all(|&term| is_size(term))
    }
}

/// `(b - a) × (c - a)` of a triangle, each component to within a few roundings of the longest component, however thin the
/// triangle is: what the two differences lose is taken into account to first order, and to all orders where no more is
/// left than that.
#[must_use]
pub fn triangle_cross([a, b, c]: [DVec3; 3]) -> DVec3 {
    let lost = |to: DVec3| DVec3::from_array([0, 1, 2].map(|axis| two_sum(to[axis], -a[axis]).1));
    let (along, across) = (b - a, c - a);
    let cross = exact::cross(along, across) + (along.cross(lost(c)) + lost(b).cross(across));
    let largest = along.abs().max_element() * across.abs().max_element();
    if cross.abs().max_element() > tolerance::SLIVER_CROSS * largest {
        return cross;
    }
    let exact = ExactVector::difference(b, a).cross(&ExactVector::difference(c, a));
    DVec3::from_array(exact.0.map(|component| component.estimate()))
}

/// Whether products of four such components stay exact: each is 0 or of a size within the limits
/// of [`tolerance::EXACT_PART_MIN`].
#[must_use]
pub fn is_in_range(vector: DVec3) -> bool {
    vector.to_array().into_iter().all(|value| value == 0.0 || is_size(value))
}

fn is_size(value: f64) -> bool {
    (tolerance::EXACT_PART_MIN..=tolerance::EXACT_PART_MAX).contains(&value.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sliver_thinner_than_rounding_has_an_area_and_a_line_has_none() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let area = |c: DVec3| {
            let (a, b) = (at(0.1, 0.1), at(0.7, 0.7));
            ExactVector::difference(b, a).cross(&ExactVector::difference(c, a))
        };
        assert!(area(at(0.3, 0.3)).is_zero());
        assert_eq!(area(at(0.3, 0.3_f64.next_up())).0[2].sign(), Ordering::Greater);
        assert_eq!(area(at(0.3, 0.3_f64.next_down())).0[2].sign(), Ordering::Less);
    }

    #[test]
    fn sums_that_cancel_to_the_last_bit_keep_their_sign() {
        let mut sum = Expansion::default();
        for value in [1e16, 1.0, -1e16, -1.0, 1e-30] {
            sum.add(value);
        }
        assert_eq!((sum.sign(), sum.estimate()), (Ordering::Greater, 1e-30));
        sum.add(-1e-30);
        assert_eq!(sum.sign(), Ordering::Equal);
    }
}
