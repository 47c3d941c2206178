//! What is true of a pair of placed convex forms.
//!
//! # Method
//! Cores that have corners only: all directions ([`polytope`]). Others: a distance proved on both sides ([`apart`]), and
//! where the cores overlap, the least width of very many directions ([`inside`]). Against a half space: one support point
//! ([`plane`]). Radii are subtracted last.

use glam::DVec3;

use super::{
    apart::{self, Needed},
    double::{Double, Number},
    form::{PlacedSolid, Solid},
    frame::Pair,
    inside,
    place::Place,
    plane, polytope,
    space::{Vector, times_power_of_two},
};

/// The signed distance of a pair: metres apart, or minus the depth.
#[derive(Clone, Debug)]
pub struct Truth {
    pair: Pair,
    /// Proved bounds, in the frame of the pair.
    lower: Double,
    upper: Double,
    /// The same as `upper` or, where round cores overlap, nearer to `lower`: not proved, see [`inside`].
    likely_upper: Double,
    normal: Vector<Double>,
    /// Whether there is no gap along any other direction: one of the two is a half space.
    is_only_normal: bool,
}

/// How far what is computed to 32 digits may be from the truth, in the frame (the pair is about 1 large).
const ROUNDING: f64 = 1e-27;

/// The same of a depth that was found by trying directions.
const SEARCHED: f64 = 1e-15;

/// How far a direction in f64 may be from the normal of a half space and be taken for it.
const SAME_NORMAL: f64 = 1e-13;

impl Truth {
    /// The signed distance of two placed forms. `hints` are unit vectors from `a` to `b` to look along as well.
    #[must_use]
    pub fn of(a: &PlacedSolid, b: &PlacedSolid, hints: &[DVec3]) -> Self {
        Self::at([(&a.solid, &Place::of(a)), (&b.solid, &Place::of(b))], Double::default(), hints)
    }

    /// The same of forms in motion, at a time of it.
    #[must_use]
    pub fn at(sides: [(&Solid, &Place); 2], time: Double, hints: &[DVec3]) -> Self {
        let pair = Pair::at(sides, time);
        if let Some((gap, normal)) = plane::signed_distance(sides[0].0, sides[1].0, &pair) {
            return Self { is_only_normal: true, ..Self::new(pair, [gap; 3], normal) };
        }
        if let Some((gap, normal)) = polytope::signed_distance(&pair) {
            return Self::new(pair, [gap; 3], normal);
        }
        let apart = apart::distance(&pair, Needed::All);
        if apart.lower.nearest() > ROUNDING || pair.has_many_corners() {
            return Self::new(pair, [apart.lower, apart.upper, apart.upper], apart.normal);
        }
        let hints: Vec<Vector<f64>> = hints.iter().filter_map(|&hint| Vector::of(hint).unit()).collect();
        let (gap, normal) = inside::signed_distance(&pair, &hints);
        let (lower, normal) = if apart.lower > gap { (apart.lower, apart.normal) } else { (gap, normal) };
        let is_inside = apart.upper.nearest() <= ROUNDING;
        let likely_upper = if is_inside { least(lower + Double::of(SEARCHED), apart.upper) } else { apart.upper };
        Self::new(pair, [lower, apart.upper, likely_upper], normal)
    }

    fn new(pair: Pair, [lower, upper, likely_upper]: [Double; 3], normal: Vector<Double>) -> Self {
        let (radius, rounding) = (pair.radius, Double::of(ROUNDING));
        Self {
            lower: lower - radius - rounding,
            upper: upper - radius + rounding,
            likely_upper: likely_upper - radius + rounding,
            pair,
            normal,
            is_only_normal: false,
        }
    }

    fn in_frame(&self, metres: f64) -> Double {
        Double::of(times_power_of_two(metres, self.pair.exponent))
    }

    /// Whether the signed distance is proved to be above this, metres.
    #[must_use]
    pub fn is_above(&self, metres: f64) -> bool {
        self.lower > self.in_frame(metres)
    }

    /// Whether the signed distance is proved to be below this, metres.
    #[must_use]
    pub fn is_below(&self, metres: f64) -> bool {
        self.upper < self.in_frame(metres)
    }

    /// The same, trusting that no depth is less than the one found.
    #[must_use]
    pub fn is_likely_below(&self, metres: f64) -> bool {
        self.likely_upper < self.in_frame(metres)
    }

    /// The signed distance, metres, to 16 digits.
    #[must_use]
    pub fn nearest(&self) -> f64 {
        times_power_of_two(self.lower.nearest(), -self.pair.exponent)
    }

    /// Bounds of the signed distance, metres, rounded outwards.
    #[must_use]
    pub fn bounds(&self) -> [f64; 2] {
        let metres = |value: Double| times_power_of_two(value.nearest(), -self.pair.exponent);
        [metres(self.lower).next_down(), metres(self.upper).next_up()]
    }

    /// How far the bounds are apart that are trusted, metres.
    #[must_use]
    pub fn blur(&self) -> f64 {
        times_power_of_two((self.likely_upper - self.lower).nearest(), -self.pair.exponent)
    }

    /// The unit vector from `a` to `b` along which the signed distance is.
    #[must_use]
    pub fn normal_a_to_b(&self) -> DVec3 {
        self.normal.nearest()
    }

    /// The gap along a direction from `a` to `b`, metres; minus the width along it where they overlap. Against a half space
    /// it is infinite along all directions but one.
    #[must_use]
    pub fn gap_along(&self, a_to_b: DVec3) -> f64 {
        let unit = Vector::of(a_to_b).unit().unwrap_or(self.normal);
        if self.is_only_normal {
            let is_normal = (unit - self.normal).length().nearest() <= SAME_NORMAL;
            return if is_normal { self.nearest() } else { f64::NEG_INFINITY };
        }
        let gap = self.pair.exact.gap_along(unit) - self.pair.radius;
        times_power_of_two(gap.nearest(), -self.pair.exponent)
    }
}

fn least(a: Double, b: Double) -> Double {
    if b < a { b } else { a }
}
