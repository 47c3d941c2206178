//! A box on its way into a tree.
//!
//! # Method
//! While a tree is built its boxes are moved about once a level, so they are packed: the number of the leaf and the layers stand in
//! the fourth components of the corners, which searches for nearest and farthest corners may take along as they are.

use glam::{Vec3A, Vec4};

use super::local::LocalBox;

/// A box that is to become a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) corners: Corners,
}

/// Two corners of a box, with a fourth component each, which counts for nothing here.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners {
    pub(super) low: Vec4,
    pub(super) high: Vec4,
}

/// Leaf numbers are below 2²⁸. With this bit they are floats that are finite and normal, which no arithmetic is slow with.
const NORMAL: u32 = 1 << 30;

impl Item {
    pub(super) fn new(bounds: LocalBox, leaf: u32, layers: u32) -> Self {
        let (low, high) = (bounds.min.extend(f32::from_bits(leaf | NORMAL)), bounds.max.extend(f32::from_bits(layers)));
        Self { corners: Corners { low, high } }
    }

    pub(super) fn bounds(&self) -> LocalBox {
        self.corners.bounds()
    }

    /// Twice the middle, along an axis.
    #[inline]
    pub(super) fn center_doubled(&self, axis: usize) -> f32 {
        let (low, high): (&[f32; 4], &[f32; 4]) = (self.corners.low.as_ref(), self.corners.high.as_ref());
        low[axis] + high[axis]
    }

    pub(super) fn leaf(&self) -> u32 {
        self.corners.low.w.to_bits() & !NORMAL
    }

    pub(super) fn layers(&self) -> u32 {
        self.corners.high.w.to_bits()
    }
}

impl Corners {
    /// Of no box; changes none that it is united with.
    pub(super) const NOTHING: Self = Self { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    #[inline]
    pub(super) fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    #[inline]
    pub(super) fn bounds(&self) -> LocalBox {
        LocalBox { min: Vec3A::from_vec4(self.low), max: Vec3A::from_vec4(self.high) }
    }
}
