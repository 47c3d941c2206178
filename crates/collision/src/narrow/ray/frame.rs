//! A ray in the frame of its target, with a bound on what the way there cost.
//!
//! # Method
//! Positions are differenced in the world and turned into the target's axes. Distances are then counted from the foot:
//! the point of the line nearest to the target's centre, so that a far origin costs its own rounding and no more.

use glam::{DMat3, DVec3};

use super::Ray;
use crate::{
    math::{Norm, Pose, exact::two_sum, expansion, scaled_by_power_of_two},
    shape::Geometry,
    tolerance,
};

/// Where the target lies in its own frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// The middle of it, local frame.
    pub center: DVec3,
    /// All of it lies within this of the centre.
    pub radius: f64,
    /// All of it lies within this of the local origin.
    pub reach: f64,
}

impl Target {
    /// Seen from the local origin: right for forms that lie about it.
    pub(super) fn about_origin(geometry: &Geometry) -> Self {
        Self { center: DVec3::ZERO, radius: geometry.reach(), reach: geometry.reach() }
    }

    /// Seen from the middle of its box.
    pub(super) fn about_center(geometry: &Geometry) -> Self {
        let bounds = geometry.local_bounds();
        let center = bounds.center();
        let half = (bounds.max - center).max(center - bounds.min);
        Self { center, radius: half.norm() * tolerance::LENGTH_WIDENING, reach: geometry.reach() }
    }
}

/// A ray in the target's axes, relative to the target's centre.
#[derive(Clone, Debug)]
pub(super) struct LocalRay {
    /// The point of the line nearest to the centre.
    pub foot: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    /// Metres along the ray of the foot; negative if it lies behind the origin.
    pub shift: f64,
    /// Wherever it may touch, the true ray is within this of the computed one at equal distances, and the rounding of
    /// the kernels moves a surface by less. Metres.
    pub error: f64,
    /// `direction` is off by less than this.
    pub direction_error: f64,
    /// Touches lie within this of the foot along the ray. Metres.
    pub extent: f64,
    /// Touches nearer than this do not count. Metres along the ray.
    pub first: f64,
    /// Nor do touches farther than this, a distance that touches surely do not reach where the ray is endless.
    pub last: f64,
    /// The ray without any rounding, where the target is not turned and the difference of positions is exact.
    pub exact: Option<ExactRay>,
    /// For each axis: the ray does not move along it, and its coordinate is exact.
    pub still: [bool; 3],
    center: DVec3,
    /// From the target's axes to the world's; `None` if it is not turned.
    axes: Option<DMat3>,
}

/// A ray in the target's frame as sent, exactly.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExactRay {
    /// Where it begins.
    pub origin: DVec3,
    /// Its direction times a power of two.
    pub direction: DVec3,
}

impl LocalRay {
    pub(super) fn new(ray: &Ray, pose: &Pose, target: Target) -> Self {
        let scaled = scaled_by_power_of_two(ray.direction);
        let unit = scaled / scaled.norm();
        let (difference, lost) = exact_difference(ray.origin, pose.position);
        let turned = pose.rotation.xyz() != DVec3::ZERO;
        let axes = turned.then(|| pose.matrix());
        let (origin, direction, frame_error, direction_error) = match axes {
            Some(axes) => {
                let to_local = axes.transpose();
                let error = tolerance::RAY_TURNED_FRAME * (difference.norm() + target.reach);
                (to_local * difference, to_local * unit, error, tolerance::RAY_TURNED_DIRECTION)
            }
            None => {
                let error = lost.norm() * tolerance::LENGTH_WIDENING;
                (difference, unit, error, tolerance::RAY_DIRECTION)
            }
        };
        let from_center = origin - target.center;
        let shift = -from_center.dot(direction);
        let extent = from_center.norm() + target.radius;
        let exact = ExactRay { origin, direction: scaled };
        let is_still = |axis: usize| !turned && scaled[axis] == 0.0 && lost[axis] == 0.0 && target.center[axis] == 0.0;
        Self {
            foot: from_center + direction * shift,
            direction,
            shift,
            // What is subnormal has rounding that is no part of it.
            error: frame_error + tolerance::RAY_KERNEL * extent + f64::MIN_POSITIVE,
            direction_error,
            extent,
            first: ray.min_distance,
            last: ray.max_distance.min((shift + 2.0 * extent).max(ray.min_distance)),
            exact: (!turned && lost == DVec3::ZERO && exact.is_in_range()).then_some(exact),
            still: [0, 1, 2].map(is_still),
            center: target.center,
            axes,
        }
    }

    /// Whether it surely passes a ball about the centre.
    pub(super) fn passes_ball(&self, radius: f64) -> bool {
        self.foot.norm() * tolerance::SLAB_NARROWING > radius + self.error
    }

    /// The local point at a distance along the ray.
    pub(super) fn point_at(&self, distance: f64) -> DVec3 {
        self.center + (self.foot + self.direction * (distance - self.shift))
    }

    /// Takes a local point into the world.
    pub(super) fn to_world(&self, pose: &Pose, local: DVec3) -> DVec3 {
        let turned = self.axes.map_or(local, |axes| axes * local);
        turned + pose.position + DVec3::ZERO
    }

    /// Takes a local vector into the world as a unit vector; one of no length, as that of a point on the very ray, becomes
    /// that towards where the ray comes from.
    pub(super) fn normal_to_world(&self, normal: DVec3) -> DVec3 {
        let unit = normal.try_unit().unwrap_or(-self.direction);
        let turned = self.axes.map_or(unit, |axes| axes * unit);
        turned.try_unit().unwrap_or(unit) + DVec3::ZERO
    }
}

impl ExactRay {
    fn is_in_range(&self) -> bool {
        expansion::is_in_range(self.origin) && expansion::is_in_range(self.direction)
    }
}

fn exact_difference(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    let parts = [0, 1, 2].map(|axis| two_sum(a[axis], -b[axis]));
    (DVec3::from_array(parts.map(|(difference, _)| difference)), DVec3::from_array(parts.map(|(_, lost)| lost)))
}
