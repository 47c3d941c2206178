//! When two geometries in motion touch first, told by what stands in for them.
//!
//! # Method
//! Stand-ins grown by what may lie outside of them hold the geometries all the way: they touch no later, and where they never
//! touch, nor do the geometries. Stand-ins that are parts of the geometries touch no earlier. Lengths never widen times: a
//! graze is early or late by any time.

use std::borrow::Cow;

use super::{Climb, Side, Stage, is_tried};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Representation, Stop, Verdict, Work},
    math::Norm,
    narrow::{ImpactTouch, InitialTouch, Motion, Placed, advance::Width, convex},
};

const RUNGS: [Representation; 2] = [Representation::OrientedBox, Representation::SimplifiedHull];

/// As [`crate::narrow::impact`], if a rung is good enough.
pub(in crate::narrow) fn impact(
    a: &Placed<'_>,
    b: &Placed<'_>,
    motion: &Motion,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Climb<Option<ImpactTouch>> {
    if !is_tried(a, b, accuracy) {
        return Climb::ToTheTop;
    }
    // What touches at the start and is ignored may be the stand-in alone: a proof that the way is free ignores nothing.
    let counted = Motion { initial: InitialTouch::Counts, ..*motion };
    let turns = motion.rotation_a.norm() * a.geometry.reach() + motion.rotation_b.norm() * b.geometry.reach();
    let way = (motion.displacement_a - motion.displacement_b).norm() + turns;
    for stage in RUNGS.into_iter().filter_map(|rung| Stage::on(a, b, rung)) {
        let Some(first) = stage.grown().first_touch(&counted, accuracy, work) else {
            return Climb::Answered(None);
        };
        let is_part = stage.are_convex && stage.model.inside == 0.0;
        // Grown ones touch earlier by as long as it takes to go so far, at least.
        let fits = stage.model.outside <= accuracy.max_error.max(accuracy.max_error_relative * way);
        if !is_part || !fits || first.initial || motion.initial != InitialTouch::Counts {
            continue;
        }
        let Some(last) = stage.first_touch(&counted, accuracy, work) else { continue };
        let bound = Bound::new(first.certificate.bound.lower, last.certificate.bound.upper);
        let is_narrow = bound.width() <= Width::of(accuracy, way).at(bound.lower);
        if is_narrow && last.certificate.verdict == Verdict::Hit && !last.initial {
            let certificate = Certificate { bound, stop: Stop::Tolerance, ..stage.certificate(last.certificate) };
            return Climb::Answered(Some(ImpactTouch { certificate, ..last }));
        }
    }
    Climb::ToTheTop
}

impl Stage<'_> {
    fn first_touch(&self, motion: &Motion, accuracy: &Accuracy, work: &mut Work) -> Option<ImpactTouch> {
        let arms = [self.a.place.arm, self.b.place.arm];
        convex::impact(self.a.placed(), self.b.placed(), motion, arms, accuracy, work)
    }

    /// The same with stand-ins that hold the geometries.
    fn grown(&self) -> Self {
        let grown = |side: &Side<'_>| {
            let mut convex = side.convex.clone().into_owned();
            if side.outside > 0.0 {
                convex.radius = (convex.radius + side.outside).next_up();
            }
            Side { convex: Cow::Owned(convex), ..*side }
        };
        Stage { a: grown(&self.a), b: grown(&self.b), ..*self }
    }
}
