//! Two forms at an instant of a motion.
//!
//! # Method
//! Both are placed as they are at that time, and what their poses are off by is counted as blur: a touch that is proved then is a touch of
//! the motion.

use glam::DVec3;

use super::{Ordered, Side, overlap::overlap_of};
use crate::{
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Norm,
    narrow::{Motion, Placed, place::Place},
    shape::{Form, Geometry, MeshMode},
    tolerance::RELATIVE_POSE,
};

/// Both forms at a time of a motion.
pub(super) fn at_instant<'a>(a: Placed<'a>, b: Placed<'a>, motion: &Motion, time: f64) -> [Side<'a>; 2] {
    let (apart, way) = (a.pose.position - b.pose.position, motion.displacement_a - motion.displacement_b);
    let reach = a.geometry.reach() + b.geometry.reach();
    let angle = motion.rotation_a.norm() + motion.rotation_b.norm();
    let blur = RELATIVE_POSE * (apart.norm() + way.norm() + reach) * (1.0 + angle);
    let at = |placed: Placed<'a>, pose| Side::of(placed.geometry, Place { pose, blur, arm: DVec3::ZERO }, None);
    let [pose_a, pose_b] = motion.poses_at([a.pose, b.pose], time);
    [at(a, pose_a), at(b, pose_b)]
}

/// Whether two forms, of which one is concave, surely touch at a time of a motion.
pub(in crate::narrow) fn touch_at(
    [a, b]: [Placed<'_>; 2],
    motion: &Motion,
    time: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> bool {
    let [moved, stood] = match Ordered::new(a, b).is_swapped {
        true => at_instant(b, a, &motion.swapped(), time),
        false => at_instant(a, b, motion, time),
    };
    overlap_of(&moved, &stood, accuracy, work).verdict == Verdict::Hit
}

/// Whether all triangles of a form are felt from both sides, so that whatever overlaps it touches it.
pub(in crate::narrow) fn is_felt_from_both_sides(geometry: &Geometry) -> bool {
    match geometry.form() {
        Form::Mesh(mesh) => mesh.mode() != MeshMode::OneSided,
        // Compounds are few deep.
        Form::Compound(compound) => compound.parts().iter().all(|part| is_felt_from_both_sides(&part.geometry)),
        Form::Convex(_) | Form::HeightField(_) | Form::HalfSpace(_) => true,
    }
}
