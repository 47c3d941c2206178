//! Whether the way of two geometries in motion is free, or when they first touch, told by what stands in for them.
//!
//! # Method
//! Stand-ins grown by what may lie outside of them hold the geometries all the way: where they never touch, nor do the geometries, and
//! these touch no sooner than they do. Lengths never widen times, as a graze is early or late by any time: that two concave geometries
//! have touched by a time is proved by the geometries, as they are then. Where that is soon enough after the touch of the stand-ins, no
//! more is asked.
//!
//! # Limits
//! See [`super::rungs_of_touch`] for which pairs. Of a touch that is told so, point and normal are those of the stand-ins. Between stand-ins that hold two convex forms and others that are parts of them lies the
//! time of their touch, but asking both took two to four times as long as asking the forms, measured with hulls of 64 to 1,024
//! vertices.

use std::borrow::Cow;

use super::{Climb, Side, Stage, is_convex, is_tried, rungs_of_touch};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Stop, Verdict, Work},
    math::Norm,
    narrow::{ImpactTouch, InitialTouch, Motion, Placed, convex, pieces},
};

/// Steps ahead of what is surely free at which a touch is looked for, as parts of the lesser reach. Where the forms that hold them touch,
/// the geometries mostly do so a little later, and part again where they have gone through each other.
const STEPS: [f64; 4] = [1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0];

/// As [`crate::narrow::impact`], if a rung proves that there is no touch up to the fraction `limit` of the motion, or when the first is, as
/// narrowly as was asked.
pub(in crate::narrow) fn impact(
    a: &Placed<'_>,
    b: &Placed<'_>,
    motion: &Motion,
    limit: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Climb<Option<ImpactTouch>> {
    if !is_tried(a, b, accuracy) {
        return Climb::ToTheTop;
    }
    // What touches at the start and is ignored may be the stand-in alone: a proof that the way is free ignores nothing.
    let counted = Motion { initial: InitialTouch::Counts, ..*motion };
    let mut finest = None;
    for stage in rungs_of_touch(a, b).iter().filter_map(|&rung| Stage::on(a, b, rung)) {
        let Some(touch) = stage.grown().first_touch(&counted, accuracy, work) else { return Climb::Answered(None) };
        if touch.certificate.bound.lower > limit {
            return Climb::Answered(None);
        }
        finest = Some((stage, touch));
    }
    match finest.and_then(|(stage, touch)| stage.touch_soon_after(&touch, [a, b], &counted, accuracy, work)) {
        Some(touch) => Climb::Answered(Some(touch)),
        None => Climb::ToTheTop,
    }
}

impl Stage<'_> {
    fn first_touch(&self, motion: &Motion, accuracy: &Accuracy, work: &mut Work) -> Option<ImpactTouch> {
        let arms = [self.a.place.arm, self.b.place.arm];
        convex::impact(self.a.placed(), self.b.placed(), motion, arms, accuracy, work)
    }

    /// The first touch of two concave geometries, if they surely touch so soon after what holds them does that the time is known as narrowly
    /// as was asked.
    fn touch_soon_after(
        &self,
        found: &ImpactTouch,
        [a, b]: [&Placed<'_>; 2],
        motion: &Motion,
        accuracy: &Accuracy,
        work: &mut Work,
    ) -> Option<ImpactTouch> {
        let lower = found.certificate.bound.lower;
        let is_felt = |placed: &Placed<'_>| !is_convex(placed) && pieces::is_felt_from_both_sides(placed.geometry);
        // What begins in touch is told by the geometries, and so is from which side a one-sided mesh is met.
        if lower <= 0.0 || !is_felt(a) || !is_felt(b) {
            return None;
        }
        let [reach_a, reach_b] = [a, b].map(|placed| placed.geometry.reach());
        let way = (motion.displacement_a - motion.displacement_b).norm()
            + (motion.rotation_a.norm() * reach_a + motion.rotation_b.norm() * reach_b);
        let widest = (accuracy.max_error / way).max(accuracy.max_error_relative * lower).min(1.0 - lower);
        for step in STEPS {
            let ahead = step * reach_a.min(reach_b) / way;
            let upper = lower + ahead;
            // NaN, of no way, ends it too.
            if !(ahead > 0.0 && upper - lower <= widest) {
                break;
            }
            if pieces::touch_at([*a, *b], motion, upper, accuracy, work) {
                let bound = Bound::new(lower, upper);
                let certificate = Certificate {
                    verdict: Verdict::Hit,
                    bound,
                    model: self.model,
                    stop: Stop::Tolerance,
                    ..found.certificate
                };
                let fraction = (0.5 * (lower + upper)).clamp(lower, upper);
                return Some(ImpactTouch { fraction, certificate, initial: false, ..*found });
            }
        }
        None
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
