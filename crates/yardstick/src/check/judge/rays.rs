//! Rays at meshes.

use super::{Case, FaultKind, Limit, Outcome};
use crate::{
    check::{Answer, Question, RayAnswer, Reply, Verdict, tolerance},
    sets::rays::{RayRecord, RayTruth},
};

impl Case for RayRecord {
    fn index(&self) -> u64 {
        self.index
    }

    fn category(&self) -> &str {
        &self.category
    }

    fn questions(&self) -> Vec<Question> {
        vec![Question::Raycast {
            origin: self.origin,
            direction: self.direction,
            max_distance: self.max_t * self.direction.length(),
            target: self.target.clone(),
        }]
    }

    fn judge(&self, replies: &[Reply]) -> Outcome {
        let mut outcome = Outcome::default();
        let Some(Answer::Ray(verdict, hits)) = outcome.answer("ray", &replies[0]) else {
            return outcome;
        };
        if !self.ambiguous {
            outcome.verdict("ray", *verdict, self.hit.is_some());
            if hits.iter().any(|hit| hit.claim.verdict == Verdict::Undecided) {
                outcome.fault(FaultKind::Verdict, "ray has an undecided hit");
            }
        }
        if let Some(truth) = &self.hit {
            self.judge_hit(truth, hits, &mut outcome);
        }
        outcome
    }
}

impl RayRecord {
    /// Of an ambiguous ray some hit must be the expected one, if any is said; of the others it must be the first.
    fn judge_hit(&self, truth: &RayTruth, hits: &[RayAnswer], outcome: &mut Outcome) {
        let distance = truth.t * self.direction.length();
        let error = |hit: &RayAnswer| (hit.distance - distance).abs();
        let nearest = hits.iter().min_by(|a, b| error(a).total_cmp(&error(b)));
        let Some(hit) = (if self.ambiguous { nearest } else { hits.first() }) else {
            return;
        };
        let tolerance = tolerance::RAY * self.scale / truth.cos.max(tolerance::RAY_COS_MIN);
        outcome.compare("ray", hit.distance, distance, Limit { tolerance, scale: self.scale });
        let slack = tolerance::REFERENCE * self.scale / truth.cos.max(tolerance::RAY_COS_MIN);
        outcome.hold("ray", &hit.claim, distance, slack);
        if !self.ambiguous && !hit.face.is_some_and(|face| truth.faces.contains(&face)) {
            let what = format!("ray meets face {:?}, expected one of {:?}", hit.face, truth.faces);
            outcome.fault(FaultKind::Witness, what);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;

    use super::*;
    use crate::{
        check::Claim,
        sets::{Form, Placed, Pose, parse_obj},
    };

    fn record() -> RayRecord {
        let mesh = Arc::new(parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a mesh"));
        RayRecord {
            index: 0,
            category: "test".to_owned(),
            ambiguous: false,
            target: Placed { form: Form::Mesh(mesh), pose: Pose::at(DVec3::ZERO) },
            origin: DVec3::new(0.25, 0.25, 2.0),
            direction: DVec3::NEG_Z * 4.0,
            max_t: f64::INFINITY,
            hit: Some(RayTruth { t: 0.5, faces: vec![0], cos: 1.0 }),
            scale: 3.0,
        }
    }

    fn answer(distance: f64, face: u32) -> RayAnswer {
        let claim = Claim { verdict: Verdict::Hit, lower: distance - 1e-15, upper: distance + 1e-15 };
        RayAnswer { distance, face: Some(face), claim }
    }

    fn faults(verdict: Verdict, hits: Vec<RayAnswer>) -> Vec<FaultKind> {
        record().judge(&[Ok(Answer::Ray(verdict, hits))]).faults.iter().map(|fault| fault.kind).collect()
    }

    #[test]
    fn only_the_right_answer_is_right() {
        assert_eq!(faults(Verdict::Hit, vec![answer(2.0, 0)]), vec![]);
        assert_eq!(faults(Verdict::Hit, vec![answer(2.0, 1)]), vec![FaultKind::Witness]);
        assert_eq!(faults(Verdict::Hit, vec![answer(2.0 + 1e-10, 0)]), vec![FaultKind::Value, FaultKind::Interval]);
        assert_eq!(faults(Verdict::Miss, vec![]), vec![FaultKind::Verdict]);
        assert_eq!(faults(Verdict::Undecided, vec![]), vec![FaultKind::Verdict]);
    }
}
