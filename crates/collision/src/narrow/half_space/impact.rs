//! The first touch of a form and a half space that move without turning.
//!
//! # Method
//! The height of the form is linear in time: it is met at height over closing speed, each within its bounds. Where that
//! leaves open whether the motion ends before or after, exact sums decide where the form ends.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    Above, Body, Low, Signed,
    plane::{Plane, Vector, difference},
    sides::Felt,
};
use crate::{
    answer::{Bound, Feature, Stop, Verdict},
    narrow::{ImpactTouch, InitialTouch},
    tolerance::{ROUNDING, STEP_SHORTENING},
};

/// When a falling height reaches 0.
pub(super) struct Meeting {
    best: f64,
    bound: Bound,
    verdict: Verdict,
    is_initial: bool,
}

impl Above<'_> {
    /// The first touch as the form and the half space go these ways.
    pub(super) fn impact(&self, ways: [DVec3; 2], initial: InitialTouch) -> Option<ImpactTouch> {
        match Felt::in_motion(self.body, initial) {
            Felt::All => self.impact_of(&self.lowest(), ways, initial),
            Felt::Fronts | Felt::FrontsAhead(_) => self.impact_of_fronts(ways, initial),
        }
    }

    fn impact_of(&self, low: &Low, ways: [DVec3; 2], initial: InitialTouch) -> Option<ImpactTouch> {
        let start = self.signed(self.body, low);
        if start.verdict != Verdict::Miss && initial == InitialTouch::IsIgnored {
            return match self.body {
                // Convex pieces that leave a plane do not come back.
                Body::Convex(_) => None,
                Body::Mesh(_) | Body::Field(_) => self.impact_of_clear_triangles(ways),
            };
        }
        let at_end = || self.exact_sign(self.body, low, ways);
        Some(self.touch(low, start, &meeting(start, closing(&self.plane, ways), at_end)?, ways))
    }

    /// The first touch of those triangles that are felt from their front: at the start it does not matter where they go.
    fn impact_of_fronts(&self, ways: [DVec3; 2], initial: InitialTouch) -> Option<ImpactTouch> {
        let at_start = self.feeling(Felt::Fronts);
        let low = at_start.lowest_of_triangles(|_| true)?;
        let touches = at_start.signed(self.body, &low).verdict != Verdict::Miss;
        if touches && initial != InitialTouch::IsIgnored {
            return at_start.impact_of(&low, ways, initial);
        }
        let [way, way_of_space] = ways;
        let ahead = self.feeling(Felt::FrontsAhead(self.pose.matrix().transpose() * (way_of_space - way)));
        if touches {
            return ahead.impact_of_clear_triangles(ways);
        }
        ahead.impact_of(&ahead.lowest_of_triangles(|_| true)?, ways, initial)
    }

    /// The first touch of those triangles that are clear of the half space at the start.
    fn impact_of_clear_triangles(&self, ways: [DVec3; 2]) -> Option<ImpactTouch> {
        let is_clear = |corners: [DVec3; 3]| {
            let lowest = corners.map(|corner| self.height(corner, 0.0)).into_iter().fold(f64::MAX, f64::min);
            lowest > self.error_at(lowest)
        };
        let low = self.lowest_of_triangles(is_clear)?;
        let best = self.height(low.point, 0.0);
        let error = self.error_at(best);
        let start = Signed::new(best - error, best, best + error);
        Some(self.touch(&low, start, &meeting(start, closing(&self.plane, ways), || None)?, ways))
    }

    fn touch(&self, low: &Low, start: Signed, meeting: &Meeting, [way, _]: [DVec3; 2]) -> ImpactTouch {
        let point = self.point_out(low.point, low.radius) + way * meeting.best + DVec3::ZERO;
        meeting.touch(start, point, self.plane.normal)
    }
}

impl Meeting {
    /// The best value of when it is.
    pub(super) fn best(&self) -> f64 {
        self.best
    }

    /// The touch at `point`, where the plane's normal is `normal`.
    pub(super) fn touch(&self, start: Signed, point: DVec3, normal: DVec3) -> ImpactTouch {
        ImpactTouch {
            fraction: self.best + 0.0,
            point,
            normal_b_to_a: (start.upper >= 0.0).then_some(normal),
            initial: self.is_initial,
            feature_b: Feature::default(),
            certificate: Signed {
                lower: self.bound.lower,
                best: self.best,
                upper: self.bound.upper,
                verdict: self.verdict,
            }
            .certificate(self.verdict, Stop::Converged),
        }
    }
}

/// When a height falls to 0 that is `start` at first and closes at a speed within bounds; `None` if it surely stays above.
/// `at_end` gives its exact sign at the end, if that can be had.
pub(super) fn meeting(
    start: Signed,
    [slow, closing, fast]: [f64; 3],
    at_end: impl Fn() -> Option<Ordering>,
) -> Option<Meeting> {
    let at = |best: f64, bound: Bound, verdict: Verdict| {
        let best = best.clamp(bound.lower, bound.upper);
        Some(Meeting { best, bound, verdict, is_initial: start.verdict != Verdict::Miss })
    };
    if start.verdict == Verdict::Hit {
        return at(0.0, Bound::new(0.0, 0.0), Verdict::Hit);
    }
    if fast <= 0.0 {
        // It goes away, or stays: if it touches at all, it does so at the start.
        let is_clear = start.verdict == Verdict::Miss;
        return if is_clear { None } else { at(0.0, Bound::new(0.0, 0.0), Verdict::Undecided) };
    }
    let lower = (start.lower / fast).max(0.0) * STEP_SHORTENING;
    if lower > 1.0 {
        return None;
    }
    let upper = if slow > 0.0 { start.upper / slow * (2.0 - STEP_SHORTENING) } else { f64::INFINITY };
    let best = if closing > 0.0 { start.best / closing } else { 1.0 };
    if upper <= 1.0 {
        return at(best, Bound::new(lower, upper.max(lower)), Verdict::Hit);
    }
    let bound = Bound::new(lower, 1.0);
    match at_end() {
        Some(Ordering::Greater) if start.verdict == Verdict::Miss => None,
        Some(Ordering::Less | Ordering::Equal) => at(best, bound, Verdict::Hit),
        Some(Ordering::Greater) | None => at(best, bound, Verdict::Undecided),
    }
}

/// How fast the height falls: no slower than, about, and no faster than this.
pub(super) fn closing(plane: &Plane, [way, way_of_space]: [DVec3; 2]) -> [f64; 3] {
    let relative: Vector = difference(way_of_space, way);
    let along = plane.along(&relative);
    let closing = along.value.high;
    let error = along.error + ROUNDING * closing.abs();
    [closing - error, closing, closing + error]
}
