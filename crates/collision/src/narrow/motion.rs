//! How two geometries move, for questions about their first touch.

use glam::DVec3;

use crate::math::Pose;

/// How two geometries move over the time from 0 to 1: each from its pose in a straight line, and turning about its local
/// origin at a constant speed. At the time `t` a form that is turned by `q` at the start is turned by `exp(t·rotation) q`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// How far `a` goes, metres.
    pub displacement_a: DVec3,
    /// How far `b` goes, metres.
    pub displacement_b: DVec3,
    /// How `a` turns: the axis times the angle, radians, in the axes of the world; several turns if it is long.
    pub rotation_a: DVec3,
    /// How `b` turns.
    pub rotation_b: DVec3,
    /// What becomes of a touch at the start.
    pub initial: InitialTouch,
}

impl Motion {
    /// Whether one of the two turns.
    #[must_use]
    pub fn turns(&self) -> bool {
        self.rotation_a != DVec3::ZERO || self.rotation_b != DVec3::ZERO
    }

    /// Where two that are in these poses at the start are at a time, seen from where `b` begins and with it, so that what is far from
    /// the origin loses nothing.
    pub(crate) fn poses_at(&self, [a, b]: [Pose; 2], time: f64) -> [Pose; 2] {
        let way = self.displacement_a - self.displacement_b;
        let position = a.position - b.position + way * time;
        [
            Pose::new(position, a.rotation_after(self.rotation_a, time)),
            Pose::new(DVec3::ZERO, b.rotation_after(self.rotation_b, time)),
        ]
    }

    /// The beginning of the motion, up to a part of it, as a whole one.
    pub(super) fn until(&self, part: f64) -> Self {
        Self {
            displacement_a: self.displacement_a * part,
            displacement_b: self.displacement_b * part,
            rotation_a: self.rotation_a * part,
            rotation_b: self.rotation_b * part,
            initial: self.initial,
        }
    }

    /// The same motion with the two geometries swapped.
    pub(super) fn swapped(&self) -> Self {
        Self {
            displacement_a: self.displacement_b,
            displacement_b: self.displacement_a,
            rotation_a: self.rotation_b,
            rotation_b: self.rotation_a,
            initial: self.initial,
        }
    }
}

/// What becomes of pieces that touch at the start of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InitialTouch {
    /// It is the first touch, at time 0.
    #[default]
    Counts,
    /// It is passed over until they are clear of each other. Convex pieces then stay clear, unless one of them turns.
    IsIgnored,
}
