//! A ray in the frame of its target, with a bound on what the way there cost.
//!
//! # Method
//! Positions are differenced in the world and turned into the target's axes. Distances are then counted from the foot:
//! the point of the line nearest to the target's centre, so that a far origin costs its own rounding and no more.

use std::ops::RangeInclusive;

use glam::{DMat3, DVec3};

use super::{Ray, sieve::Sieve};
use crate::{
    broad::Path,
    math::{Ball, Norm, Pose, exact::exact_difference, expansion, larger, scaled_by_power_of_two, smaller},
    shape::Geometry,
    tolerance,
};

/// Where a form is that may be part of another.
#[derive(Clone, Copy)]
pub(super) struct Spot<'a> {
    /// As well as it is known.
    pub pose: &'a Pose,
    /// No point of the form is farther than this from where the pose puts it, metres.
    pub blur: f64,
}

/// Where the target lies in its own frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// The middle of it, local frame.
    pub center: DVec3,
    /// All of it lies within this of the centre.
    pub radius: f64,
    /// All of it lies within this of the local origin.
    pub reach: f64,
    /// No point of it is farther than this from where its pose puts it.
    pub blur: f64,
}

impl Target {
    /// Seen from the local origin: right for forms that lie about it.
    pub(super) fn about_origin(reach: f64, blur: f64) -> Self {
        Self { center: DVec3::ZERO, radius: reach, reach, blur }
    }

    /// Seen from the middle of its box.
    pub(super) fn about_center(geometry: &Geometry, blur: f64) -> Self {
        Self::within(geometry.local_bounds().ball(), geometry.reach(), blur)
    }

    /// Seen from the middle of a ball that holds it.
    #[inline]
    pub(super) fn within(Ball { center, radius }: Ball, reach: f64, blur: f64) -> Self {
        Self { center, radius, reach, blur }
    }
}

/// A direction whose largest component is in here is divided by its length as it is.
const NEAR_ONE: RangeInclusive<f64> = 1.0 / 1024.0..=1024.0;

/// A ray with what of it is the same for all targets.
pub(crate) struct Aim<'a> {
    pub(super) ray: &'a Ray,
    /// Its direction times a power of two.
    scaled: DVec3,
    /// The same as a unit vector.
    unit: DVec3,
}

impl<'a> Aim<'a> {
    /// Makes a ray ready.
    #[inline]
    pub(crate) fn new(ray: &'a Ray) -> Self {
        // Times 1, which need not be waited for, where that does.
        let is_near_one = NEAR_ONE.contains(&ray.direction.abs().max_element());
        let scaled = if is_near_one { ray.direction } else { scaled_by_power_of_two(ray.direction) };
        Self { ray, scaled, unit: scaled / scaled.norm() }
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
    sent: Sent,
    center: DVec3,
    /// From the target's axes to the world's; `None` if it is not turned.
    axes: Option<DMat3>,
}

/// A ray as sent, in the axes of the world.
#[derive(Clone, Copy, Debug)]
struct Sent {
    /// Where it begins, seen from the target's position, and what that lost by rounding.
    origin: DVec3,
    lost: DVec3,
    /// Its direction times a power of two.
    direction: DVec3,
    /// Whether the target is neither turned nor blurred, so that these axes are its own.
    is_in_frame: bool,
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
    #[inline(always)]
    pub(super) fn new(aim: &Aim<'_>, pose: &Pose, target: Target) -> Self {
        let Aim { ray, scaled, unit } = *aim;
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
                let error = if lost == DVec3::ZERO { 0.0 } else { lost.norm() * tolerance::LENGTH_WIDENING };
                (difference, unit, error, tolerance::RAY_DIRECTION)
            }
        };
        let from_center = origin - target.center;
        let shift = -from_center.dot(direction);
        let extent = from_center.norm() + target.radius;
        let is_blurred = target.blur > 0.0;
        let lean = if is_blurred { tolerance::PART_LEAN } else { 0.0 };
        Self {
            foot: from_center + direction * shift,
            direction,
            shift,
            // What is subnormal has rounding that is no part of it.
            error: frame_error + target.blur + tolerance::RAY_KERNEL * extent + f64::MIN_POSITIVE,
            direction_error: direction_error + lean,
            extent,
            first: ray.min_distance,
            last: smaller(ray.max_distance, larger(shift + 2.0 * extent, ray.min_distance)),
            sent: Sent { origin: difference, lost, direction: scaled, is_in_frame: !turned && !is_blurred },
            center: target.center,
            axes,
        }
    }

    /// The ray without any rounding, where the target is not turned and the difference of positions is exact.
    pub(super) fn exact(&self) -> Option<ExactRay> {
        let Sent { origin, lost, direction, is_in_frame } = self.sent;
        let exact = ExactRay { origin, direction };
        (is_in_frame && lost == DVec3::ZERO && exact.is_in_range()).then_some(exact)
    }

    /// Whether the ray does not move along an axis, and its coordinate is exact.
    pub(super) fn is_still(&self, axis: usize) -> bool {
        let Sent { lost, direction, is_in_frame, .. } = self.sent;
        is_in_frame && direction[axis] == 0.0 && lost[axis] == 0.0 && self.center[axis] == 0.0
    }

    /// Whether it surely passes a ball about the centre.
    pub(super) fn passes_ball(&self, radius: f64) -> bool {
        let closest = radius + self.error;
        // Beside a normal number the rounding of squares that are subnormal is nothing.
        let foot_sq = self.foot.length_squared() * (tolerance::SLAB_NARROWING * tolerance::SLAB_NARROWING);
        foot_sq > closest * closest + f64::MIN_POSITIVE
    }

    /// Tells triangles that it passes by, of a target whose ball it comes within; with two unit vectors at right angles to it.
    #[inline]
    pub(super) fn sieve(&self, target: &Target, across: [DVec3; 2]) -> Sieve {
        let reach = 2.0 * (target.radius + self.error);
        // The foot and the corners, seen from the local origin, are rounded as well.
        let lost = (self.center.abs().max_element() + reach) * tolerance::SLAB_SLACK;
        Sieve::new(self.center + self.foot, across, reach, self.error + lost)
    }

    /// The part of it within a ball about the centre, and between where touches count; `None` if there is none.
    #[inline]
    pub(super) fn stretch(&self, radius: f64) -> Option<Stretch> {
        if self.passes_ball(radius) {
            return None;
        }
        let around = radius + 2.0 * self.error;
        let begin = larger(self.first - self.shift, -around);
        let end = smaller(self.last - self.shift, around);
        let path = Path {
            origin: self.center + (self.foot + self.direction * begin),
            direction: self.direction,
            reach: DVec3::splat(2.0 * self.error),
        };
        let before = self.shift + begin - 2.0 * self.error;
        (begin <= end).then_some(Stretch { path, length: end - begin, before })
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
        let turned = |axes: DMat3| (axes * unit).try_unit().unwrap_or(unit);
        self.axes.map_or(unit, turned) + DVec3::ZERO
    }
}

/// A part of a ray as a path in the target's frame.
pub(super) struct Stretch {
    pub path: Path,
    /// Metres.
    pub length: f64,
    /// How far along the ray it begins, less what that may be off by.
    pub before: f64,
}

impl Stretch {
    /// How far along the path a touch may lie that is no farther along the ray than this.
    pub(super) fn limit(&self, distance: f64) -> f64 {
        distance - self.before
    }
}

impl ExactRay {
    fn is_in_range(&self) -> bool {
        expansion::is_in_range(self.origin) && expansion::is_in_range(self.direction)
    }
}
