//! An axis-aligned box in f64.

use glam::DVec3;

use super::Norm;
use crate::tolerance::LENGTH_WIDENING;

/// An axis-aligned box: closed, `min <= max` in each component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner, metres.
    pub min: DVec3,
    /// Upper corner, metres.
    pub max: DVec3,
}

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its middle, metres.
    pub center: DVec3,
    /// What it stands for lies within this of the middle, metres.
    pub radius: f64,
}

impl Aabb {
    /// From corner to corner.
    #[must_use]
    pub const fn new(min: DVec3, max: DVec3) -> Self {
        Self { min, max }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether they have a point in common; touching counts.
    #[must_use]
    pub fn intersects(self, other: Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// Whether `other` lies wholly inside.
    #[must_use]
    pub fn contains(self, other: Self) -> bool {
        self.min.cmple(other.min).all() && other.max.cmple(self.max).all()
    }

    /// Larger by `margin` on each side.
    #[must_use]
    pub fn inflated(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// The middle, free of overflow.
    #[must_use]
    pub fn center(self) -> DVec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// The ball around it.
    #[inline]
    #[must_use]
    pub fn ball(self) -> Ball {
        let center = self.center();
        let half = (self.max - center).max(center - self.min);
        Ball { center, radius: half.norm() * LENGTH_WIDENING }
    }

    /// Half of the surface area: what the surface-area heuristic compares.
    #[must_use]
    pub fn half_area(self) -> f64 {
        let d = self.max - self.min;
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    /// Distance from the nearest point of one box to the nearest of the other, squared; 0 where they meet.
    #[must_use]
    pub fn distance_sq(self, other: Self) -> f64 {
        let gap = (other.min - self.max).max(self.min - other.max).max(DVec3::ZERO);
        gap.length_squared()
    }
}
