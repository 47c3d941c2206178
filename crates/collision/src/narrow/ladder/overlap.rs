//! Whether two geometries are clear of each other, told by what stands in for them.
//!
//! # Limits
//! See [`super::rungs_of_touch`] for which pairs. A concave geometry may be hollow, so what touches its stand-in need not touch it:
//! there is no proof of a `Hit`.

use super::{Climb, Stage, is_tried, rungs_of_touch};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Stop, Verdict, Work},
    narrow::{Placed, convex},
};

/// As [`crate::narrow::overlap`], if a rung proves that they do not touch.
pub(in crate::narrow) fn overlap(
    a: &Placed<'_>,
    b: &Placed<'_>,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Climb<Certificate> {
    if !is_tried(a, b, accuracy) {
        return Climb::ToTheTop;
    }
    for stage in rungs_of_touch(a, b).iter().filter_map(|&rung| Stage::on(a, b, rung)) {
        let outside = stage.model.outside;
        let found = match outside > 0.0 {
            true => convex::within(stage.a.placed(), stage.b.placed(), outside, accuracy, work),
            false => convex::overlap(stage.a.placed(), stage.b.placed(), accuracy, work),
        };
        if found.verdict == Verdict::Miss {
            let bound = Bound::new(stage.widened(found.bound).lower.max(0.0), f64::INFINITY);
            let certificate = Certificate { bound, stop: Stop::Tolerance, ..stage.certificate(found) };
            return Climb::Answered(certificate);
        }
    }
    Climb::ToTheTop
}
