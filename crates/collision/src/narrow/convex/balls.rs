//! Where two forms in motion can touch at the earliest: when the balls around them do.
//!
//! # Method
//! Each form lies in the ball about its local origin that reaches as far as it does, however it is turned, so until the
//! balls touch the forms are apart. That time is the root of a quadratic. Whatever rounding did to it, how near the
//! centres come up to then is measured along the way itself.

use glam::DVec3;

use crate::{math::Norm, tolerance::BEND_WIDENING};

/// The time up to which the balls around two forms, which have the radii `reach` together, are free, if the second goes by
/// `-way` from `start`, as seen by the first, over the time from 0 to 1; `None` if they are so all the time. 0 where
/// `rounding`, which a distance may be off by, leaves that open.
pub(super) fn entry(start: DVec3, reach: f64, way: DVec3, rounding: f64) -> Option<f64> {
    let wider = reach * BEND_WIDENING;
    let (speed_sq, toward) = (way.length_squared(), start.dot(way));
    let excess = start.length_squared() - wider * wider;
    if excess <= 0.0 {
        return Some(0.0);
    }
    let root = toward * toward - speed_sq * excess;
    let time = if toward > 0.0 && root > 0.0 { (excess / (toward + root.sqrt())).min(1.0) } else { 1.0 };
    let nearest = if speed_sq > 0.0 { (toward / speed_sq).clamp(0.0, time) } else { 0.0 };
    let is_free = (start - way * nearest).norm() - reach > rounding;
    match (is_free, time < 1.0) {
        (true, true) => Some(time),
        (true, false) => None,
        (false, _) => Some(0.0),
    }
}
