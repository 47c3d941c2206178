//! How far apart two geometries are, told by what stands in for them.

use super::{ByParts, Climb, Stage, farthest, farthest_by_balls, is_tried, is_worth_trying};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Model, Representation, Stop, Verdict, Work},
    narrow::{Placed, Separation, convex, pieces},
};

const RUNGS: [Representation; 4] =
    [Representation::Ball, Representation::OrientedBox, Representation::SimplifiedHull, Representation::Decomposition];

/// As [`crate::narrow::distance`], if a rung is good enough.
pub(in crate::narrow) fn distance(
    a: &Placed<'_>,
    b: &Placed<'_>,
    limit: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Climb<Option<Separation>> {
    let allowed = |farthest: f64| accuracy.max_error.max(accuracy.max_error_relative * farthest);
    let mut farthest = farthest(a, b);
    if !is_tried(a, b, accuracy) || !is_worth_trying(a, b, allowed(farthest)) {
        return Climb::ToTheTop;
    }
    let [gap, by_balls] = farthest_by_balls(a, b);
    farthest = farthest.min(by_balls);
    for rung in RUNGS {
        // What is surely too wide need not be asked; of the balls it is known already how far apart they are.
        let spare = allowed(if rung == Representation::Ball { gap } else { farthest });
        let Some(found) = told_by(rung, [a, b], limit, spare, accuracy, work) else { continue };
        let Some(found) = found else { return Climb::Answered(None) };
        let Certificate { verdict, bound, .. } = found.certificate;
        let is_narrow = bound.width() <= accuracy.max_error
            || verdict == Verdict::Hit && bound.width() <= accuracy.max_error_relative * bound.lower;
        if is_narrow {
            let certificate = Certificate { stop: Stop::Tolerance, ..found.certificate };
            return Climb::Answered(Some(Separation { certificate, ..found }));
        }
        farthest = farthest.min(bound.upper);
    }
    Climb::ToTheTop
}

/// How far apart two geometries are, as one rung tells it, however wide the interval; its upper side is infinite where concave
/// geometries may overlap. `None` if no stand-in is that coarse, or that is proved to be beyond `limit` metres.
pub fn distance_on(
    representation: Representation,
    a: Placed<'_>,
    b: Placed<'_>,
    limit: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Separation> {
    told_by(representation, [&a, &b], limit, f64::INFINITY, accuracy, work).flatten()
}

/// What a rung says, whose errors are no more than `allowed` metres; `None` if there is none, and a `None` within if it proves
/// that the geometries are farther apart than `limit` metres.
fn told_by(
    representation: Representation,
    [a, b]: [&Placed<'_>; 2],
    limit: f64,
    allowed: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Option<Separation>> {
    let fits = |model: &Model| model.outside + model.inside <= allowed;
    if representation == Representation::Decomposition {
        let parts = ByParts::of(a, b).filter(|parts| fits(&parts.model))?;
        return Some(parts.distance(limit, accuracy, work));
    }
    let stage = Stage::on(a, b, representation).filter(|stage| fits(&stage.model))?;
    Some(stage.distance(limit, accuracy, work))
}

impl Stage<'_> {
    /// `None` if the geometries are proved to be farther apart than `limit` metres.
    fn distance(&self, limit: f64, accuracy: &Accuracy, work: &mut Work) -> Option<Separation> {
        let (left, beyond) = (self.model.left_of(accuracy), self.model.beyond(limit));
        let found = convex::distance(self.a.placed(), self.b.placed(), beyond, &left, work)?;
        Some(of_geometries(found, &self.model, self.widened(found.certificate.bound), limit))
    }
}

impl ByParts<'_> {
    /// As that of a stage.
    fn distance(&self, limit: f64, accuracy: &Accuracy, work: &mut Work) -> Option<Separation> {
        let (left, beyond) = (self.model.left_of(accuracy), self.model.beyond(limit));
        let found = pieces::distance(self.a, self.b, beyond, &left, work)?;
        Some(of_geometries(found, &self.model, self.widened(found.certificate.bound), limit))
    }
}

fn of_geometries(found: Separation, model: &Model, widened: Bound, limit: f64) -> Separation {
    let bound = Bound::new(widened.lower.max(0.0), widened.upper);
    let verdict = if bound.upper <= limit { Verdict::Hit } else { Verdict::Undecided };
    let certificate = Certificate { verdict, bound, model: *model, ..found.certificate };
    Separation { distance: found.distance.clamp(bound.lower, bound.upper), certificate, ..found }
}
