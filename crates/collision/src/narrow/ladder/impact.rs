//! Whether the way of two geometries in motion is free, told by what stands in for them.
//!
//! # Method
//! Stand-ins grown by what may lie outside of them hold the geometries all the way: where they never touch, nor do the geometries.
//! Lengths never widen times, as a graze is early or late by any time: what may touch is asked of the geometries.
//!
//! # Limits
//! See [`super::rungs_of_touch`] for which pairs. Between stand-ins that hold two convex forms and others that are parts of them lies the
//! time of their touch, but asking both took two to four times as long as asking the forms, measured with hulls of 64 to 1,024
//! vertices.

use std::borrow::Cow;

use super::{Climb, Side, Stage, is_tried, rungs_of_touch};
use crate::{
    accuracy::Accuracy,
    answer::Work,
    narrow::{ImpactTouch, InitialTouch, Motion, Placed, convex},
};

/// As [`crate::narrow::impact`], if a rung proves that the way is free.
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
    for stage in rungs_of_touch(a, b).iter().filter_map(|&rung| Stage::on(a, b, rung)) {
        if stage.grown().first_touch(&counted, accuracy, work).is_none() {
            return Climb::Answered(None);
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
