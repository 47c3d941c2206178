//! Whether two geometries touch, told by what stands in for them.

use super::{Climb, Stage, is_tried};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Representation, Stop, Verdict, Work},
    narrow::{Placed, convex},
};

/// A ball proves less than the boxes that every pair is judged by first.
const RUNGS: [Representation; 2] = [Representation::OrientedBox, Representation::SimplifiedHull];

/// As [`crate::narrow::overlap`], if a rung proves a verdict: open ones are for the geometries themselves to settle.
pub(in crate::narrow) fn overlap(
    a: &Placed<'_>,
    b: &Placed<'_>,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Climb<Certificate> {
    if !is_tried(a, b, accuracy) {
        return Climb::ToTheTop;
    }
    for stage in RUNGS.into_iter().filter_map(|rung| Stage::on(a, b, rung)) {
        if let Some(proved) = proved(&stage, accuracy, work) {
            return Climb::Answered(proved);
        }
    }
    Climb::ToTheTop
}

fn proved(stage: &Stage<'_>, accuracy: &Accuracy, work: &mut Work) -> Option<Certificate> {
    let (a, b, outside) = (stage.a.placed(), stage.b.placed(), stage.model.outside);
    let answer = |found: Certificate, verdict, bound| {
        Some(Certificate { verdict, bound, stop: Stop::Tolerance, ..stage.certificate(found) })
    };
    let of_margin = (outside > 0.0).then(|| convex::within(a, b, outside, accuracy, work));
    if let Some(found) = of_margin.filter(|found| found.verdict == Verdict::Miss) {
        let lower = stage.widened(found.bound).lower.max(0.0);
        return answer(found, Verdict::Miss, Bound::new(lower, f64::INFINITY));
    }
    if of_margin.is_some() && !stage.are_convex {
        return None;
    }
    let found = convex::overlap(a, b, accuracy, work);
    let bound = stage.widened(found.bound);
    match found.verdict {
        Verdict::Miss if outside == 0.0 => answer(found, Verdict::Miss, bound),
        Verdict::Hit if stage.are_convex && bound.upper <= 0.0 => answer(found, Verdict::Hit, bound),
        Verdict::Hit | Verdict::Miss | Verdict::Undecided => None,
    }
}
