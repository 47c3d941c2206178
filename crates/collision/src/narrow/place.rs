//! Where a form is that may be part of another.
//!
//! # Method
//! The pose of a part is the product of poses, which rounds. What that may move any point of the part by is carried beside it
//! as its `blur`, in metres, and every kernel allows for it. So that it does not grow with the distance from the origin of
//! the world, a question to a compound is asked as seen from where the compound is: there is nothing to round where the
//! difference of the two positions is exact.
//!
//! A part turns about the local origin of the whole: its `arm` says where that is.

use glam::DVec3;

use crate::{
    math::{
        Norm, Pose,
        exact::{exact_difference, two_sum},
    },
    tolerance::{LENGTH_WIDENING, RELATIVE_POSE},
};

/// Where a form is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// As well as it is known.
    pub(super) pose: Pose,
    /// No point of the form is farther than this from where the pose puts it, metres.
    pub(super) blur: f64,
    /// From what it turns about to its local origin, in the axes of the world.
    pub(super) arm: DVec3,
}

impl Place {
    /// Of a form that is part of nothing.
    pub(super) fn of(pose: Pose) -> Self {
        Self { pose, blur: 0.0, arm: DVec3::ZERO }
    }

    /// The same as seen from a point of the world, in the axes of the world.
    pub(super) fn seen_from(pose: &Pose, origin: DVec3) -> Self {
        let (position, lost) = exact_difference(pose.position, origin);
        Self { pose: Pose::new(position, pose.rotation), blur: length_up(lost), arm: DVec3::ZERO }
    }

    /// That of a part of the form, which is at `pose` in it and reaches so far about its own origin.
    pub(super) fn of_part(&self, pose: &Pose, reach: f64) -> Self {
        let (is_turned, turns_itself) = (is_turned(&self.pose), is_turned(pose));
        let offset = if is_turned { self.pose.matrix() * pose.position } else { pose.position };
        let (position, lost) = two_sum(self.pose.position, offset);
        let rotation = match (is_turned, turns_itself) {
            (false, _) => pose.rotation,
            (true, false) => self.pose.rotation,
            (true, true) => self.pose.unit_rotation() * pose.unit_rotation(),
        };
        let turned_place = if is_turned { RELATIVE_POSE * pose.position.norm() } else { 0.0 };
        let turned_form = if is_turned && turns_itself { RELATIVE_POSE * reach } else { 0.0 };
        Self {
            pose: Pose::new(position, rotation),
            blur: self.blur + length_up(lost) + turned_place + turned_form,
            arm: self.arm + offset,
        }
    }
}

/// Any turn but that of a quaternion along w, which is none, exactly.
fn is_turned(pose: &Pose) -> bool {
    pose.rotation.xyz() != DVec3::ZERO
}

fn length_up(vector: DVec3) -> f64 {
    if vector == DVec3::ZERO { 0.0 } else { vector.abs().element_sum() * LENGTH_WIDENING }
}
