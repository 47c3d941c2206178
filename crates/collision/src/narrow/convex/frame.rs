//! The pair's own frame, in which every kernel works.
//!
//! # Method
//! Positions are differenced in f64 and turned into the axes of the first form, so that far from the origin nothing is
//! lost but what the difference itself loses. Then everything is scaled by a power of two (exactly) so that
//! `S = reach_a + reach_b + |p_b − p_a| + path` lies in [1, 2): every tolerance is a plain number.
//!
//! What a pose of a part of something may be off by is a length. It is counted as a path so long that the rounding of a pair
//! of that extent, which every kernel allows for, is larger by just this.
//!
//! # Limits
//! Forms that together extend less than 2⁻⁹⁰⁰ m are measured as if they did as much: they are told apart no better.

use glam::{DMat3, DVec3};

use super::{PlacedConvex, body::Body};
use crate::{
    answer::Bound,
    math::{Norm, Pose},
    shape::{Convex, Core},
    tolerance::{LENGTH_WIDENING, PAIR_ROUNDING, SQUARE_MIN},
};

/// Two cores in one frame.
pub(super) struct Pair<'a> {
    pub(super) a: Body<'a>,
    pub(super) b: Body<'a>,
    /// How far both forms reach from their local origins, radii included; the sum, rounded up.
    pub(super) reach: f64,
    scale: f64,
    /// The reciprocal, as exact as that.
    unscale: f64,
    axes: DMat3,
    origin: DVec3,
}

impl<'a> Pair<'a> {
    /// The frame of a pair whose relative motion covers `path` metres.
    pub(super) fn new(a: PlacedConvex<'a>, b: PlacedConvex<'a>, path: f64) -> Self {
        Self::of([a.convex, b.convex], [a.pose, b.pose], a.blur + b.blur, path)
    }

    /// The same of forms at poses that need not outlive it, with the sum of their blurs.
    pub(super) fn of([a, b]: [&'a Convex; 2], [pose_a, pose_b]: [&Pose; 2], blur: f64, path: f64) -> Self {
        let axes = pose_a.matrix();
        let apart = pose_b.position - pose_a.position;
        let path = path + blur * (1.0 / PAIR_ROUNDING);
        let (reach, extent) = reach_and_extent([a, b], apart, path);
        let scale = power_of_two_below_reciprocal(extent);
        let body = |convex: &'a Convex, is_turned, rotation, position: DVec3| Body {
            core: &convex.core,
            radius: convex.radius * scale,
            rotation,
            is_turned,
            position: position * scale,
            scale,
        };
        // Forms that are turned alike have exactly no relative rotation, and of a point none shows.
        let is_turned = pose_a.rotation != pose_b.rotation && !matches!(b.core, Core::Point);
        let rotation = if is_turned { axes.transpose() * pose_b.matrix() } else { DMat3::IDENTITY };
        Self {
            a: body(a, false, DMat3::IDENTITY, DVec3::ZERO),
            b: body(b, is_turned, rotation, axes.transpose() * apart),
            reach: reach * scale * LENGTH_WIDENING,
            scale,
            unscale: 1.0 / scale,
            axes,
            origin: pose_a.position,
        }
    }

    /// Puts the second form elsewhere, as seen by the first.
    pub(super) fn place_second(&mut self, rotation: DMat3, position: DVec3) {
        self.b.rotation = rotation;
        self.b.is_turned = rotation != DMat3::IDENTITY;
        self.b.position = position;
    }

    /// Sum of the radii around the cores.
    pub(super) fn radius(&self) -> f64 {
        self.a.radius + self.b.radius
    }

    /// A displacement in the world, taken into the frame.
    pub(super) fn displacement_in(&self, world: DVec3) -> DVec3 {
        self.axes.transpose() * world * self.scale
    }

    /// A direction of the world, taken into the frame.
    pub(super) fn direction_in(&self, direction: DVec3) -> DVec3 {
        self.axes.transpose() * direction
    }

    /// A point of the frame in the world.
    pub(super) fn point_out(&self, point: DVec3) -> DVec3 {
        self.axes * (point * self.unscale) + self.origin
    }

    /// A unit vector of the frame in the world.
    pub(super) fn direction_out(&self, direction: DVec3) -> DVec3 {
        (self.axes * direction).try_unit().unwrap_or_default() + DVec3::ZERO
    }

    /// A length of the frame in metres; exact.
    pub(super) fn length_out(&self, length: f64) -> f64 {
        length * self.unscale + 0.0
    }

    /// A length in metres in the frame; exact.
    pub(super) fn length_in(&self, length: f64) -> f64 {
        length * self.scale
    }

    /// Bounds of a length in metres.
    pub(super) fn bound_out(&self, lower: f64, upper: f64) -> Bound {
        Bound::new(self.length_out(lower), self.length_out(upper))
    }
}

/// How far two forms reach and how far the pair extends, to within a few roundings; or, where squares lack digits, up to √3
/// times as much.
fn reach_and_extent([a, b]: [&Convex; 2], apart: DVec3, path: f64) -> (f64, f64) {
    let reach = a.core.reach() + a.radius + b.core.reach() + b.radius;
    let extent = reach + apart.norm() + path;
    if extent * extent >= SQUARE_MIN {
        return (reach, extent);
    }
    let reach = a.reach() + b.reach();
    let extent = reach + apart.abs().element_sum() + path;
    (reach, if extent > 0.0 { extent.max(LEAST_EXTENT) } else { extent })
}

/// 2⁻⁹⁰⁰ m: what extends less is measured as if it did as much. A height is a product of metres and a part of a direction, which in a
/// search may be 2⁻⁵³ long; of what is subnormal the product loses all digits, 2⁻¹⁰²¹ m of the height. What rounding is allowed for at
/// this extent is more by far.
const LEAST_EXTENT: f64 = f64::from_bits((1023 - 900) << 52);

/// 2¹⁰⁰: of two points in one place.
const POINT_SCALE: f64 = f64::from_bits((1023 + 100) << 52);

/// The power of two that takes `extent` into [1, 2); for 0, where there is nothing to scale, one that makes errors of the
/// frame none in the world.
fn power_of_two_below_reciprocal(extent: f64) -> f64 {
    if extent == 0.0 {
        return POINT_SCALE;
    }
    // Sizes and coordinates keep the extent below 1e13, so the exponent field of the result is a normal one.
    let exponent = (extent.to_bits() >> 52) & 0x7FF;
    f64::from_bits((2046 - exponent) << 52)
}

#[cfg(test)]
mod tests {
    use super::power_of_two_below_reciprocal;

    #[test]
    fn the_scaled_extent_lies_in_one_to_two() {
        for extent in [1e-9, 0.3, 1.0, 1.5, 2.0, 3.9999, 7e12] {
            let scaled = extent * power_of_two_below_reciprocal(extent);
            assert!((1.0..2.0).contains(&scaled), "{extent} became {scaled}");
        }
    }
}
