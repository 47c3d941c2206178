//! How deep two convex geometries are in each other, told by what stands in for them.
//!
//! # Method
//! Only the simplified hull: a ball or a box is seldom off by less than the depths that are asked for.

use super::{Climb, Stage, difference_down, farthest, is_tried, is_worth_trying, sum_up};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Representation, Stop, Verdict, Work},
    narrow::{Contacts, Depth, Placed, convex},
};

/// As [`crate::narrow::depth`], if the rung is good enough.
pub(in crate::narrow) fn depth(
    a: &Placed<'_>,
    b: &Placed<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Climb<Option<Depth>> {
    let Some(stage) = stage(a, b, accuracy) else {
        return Climb::ToTheTop;
    };
    let (left, beyond) = (stage.model.left_of(accuracy), stage.model.beyond(max_gap));
    let Some(found) = convex::depth(stage.a.placed(), stage.b.placed(), beyond, &left, work) else {
        return Climb::Answered(None);
    };
    match stage.judged(&found.certificate, accuracy) {
        Some(certificate) => {
            let depth = found.depth.clamp(certificate.bound.lower, certificate.bound.upper);
            Climb::Answered(Some(Depth { depth, certificate, ..found }))
        }
        None => Climb::ToTheTop,
    }
}

/// As [`crate::narrow::penetration`], if the rung is good enough. Nothing is known of the depth of a single point.
pub(in crate::narrow) fn penetration(
    a: &Placed<'_>,
    b: &Placed<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Climb<Contacts> {
    let Some(stage) = stage(a, b, accuracy) else {
        return Climb::ToTheTop;
    };
    let (left, beyond) = (stage.model.left_of(accuracy), stage.model.beyond(max_gap));
    let Some(mut contact) = convex::penetration(stage.a.placed(), stage.b.placed(), beyond, &left, work) else {
        return Climb::Answered(Contacts::new());
    };
    let Some(certificate) = stage.judged(&contact.certificate, accuracy) else {
        return Climb::ToTheTop;
    };
    contact.depth = contact.depth.clamp(certificate.bound.lower, certificate.bound.upper);
    contact.certificate = certificate;
    contact.points.iter_mut().for_each(|point| point.bound = Bound::UNBOUNDED);
    Climb::Answered(std::iter::once(contact).collect())
}

fn stage<'a>(a: &'a Placed<'a>, b: &'a Placed<'a>, accuracy: &Accuracy) -> Option<Stage<'a>> {
    let allowed = accuracy.max_error.max(accuracy.max_error_relative * farthest(a, b));
    if !is_tried(a, b, accuracy) || !is_worth_trying(a, b, allowed) {
        return None;
    }
    let stage = Stage::on(a, b, Representation::SimplifiedHull)?;
    (stage.are_convex && stage.model.outside + stage.model.inside <= allowed).then_some(stage)
}

impl Stage<'_> {
    /// What a depth of the stand-ins says of that of the geometries, if that is narrow enough.
    fn judged(&self, found: &Certificate, accuracy: &Accuracy) -> Option<Certificate> {
        let bound = Bound {
            lower: difference_down(found.bound.lower, self.model.inside),
            upper: sum_up(found.bound.upper, self.model.outside),
        };
        let verdict = Bound::new(-bound.upper, -bound.lower).touch_verdict();
        let is_narrow = bound.width() <= accuracy.max_error
            || verdict != Verdict::Undecided && bound.width() <= accuracy.max_error_relative * bound.lower;
        is_narrow.then(|| Certificate { verdict, bound, stop: Stop::Tolerance, ..self.certificate(*found) })
    }
}
