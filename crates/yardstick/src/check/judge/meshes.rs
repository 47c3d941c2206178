//! Distances of mesh surfaces.

use super::{Case, FaultKind, Limit, Outcome, exceeds};
use crate::{
    check::{Answer, Near, Question, Reply, tolerance},
    oracle::distance_to_surface,
    sets::meshes::MeshPairRecord,
};

impl Case for MeshPairRecord {
    fn index(&self) -> u64 {
        self.index
    }

    fn category(&self) -> &str {
        &self.category
    }

    fn questions(&self) -> Vec<Question> {
        let (a, b) = (self.a.clone(), self.b.clone());
        vec![Question::Overlap { a: a.clone(), b: b.clone() }, Question::Distance { a, b }]
    }

    fn judge(&self, replies: &[Reply]) -> Outcome {
        let mut outcome = Outcome::default();
        if let Some(answer) = outcome.answer("overlap", &replies[0])
            && !self.ambiguous
        {
            outcome.verdict("overlap", answer.verdict(), self.crossing_count > 0 || self.distance <= 0.0);
        }
        if let Some(Answer::Distance(_, hits)) = outcome.answer("distance", &replies[1]) {
            match hits.first() {
                Some(near) => self.judge_distance(near, &mut outcome),
                None => outcome.fault(FaultKind::Verdict, "distance finds nothing"),
            }
        }
        outcome
    }
}

impl MeshPairRecord {
    fn judge_distance(&self, near: &Near, outcome: &mut Outcome) {
        let limit = Limit { tolerance: tolerance::MESH * self.scale + self.pose_error, scale: self.scale };
        outcome.compare("distance", near.distance, self.distance, limit);
        outcome.hold("distance", &near.claim, self.distance, tolerance::REFERENCE * self.scale + self.pose_error);
        if self.distance <= 0.0 {
            return;
        }
        let apart = near.point_on_a.distance(near.point_on_b);
        if exceeds((apart - self.distance).abs(), limit.tolerance) {
            outcome.fault(FaultKind::Witness, format!("points are {apart:e} apart, expected {:e}", self.distance));
        }
        for (side, placed, point) in [("a", &self.a, near.point_on_a), ("b", &self.b, near.point_on_b)] {
            let beside = distance_to_surface(placed, point);
            if exceeds(beside, limit.tolerance) {
                outcome.fault(FaultKind::Witness, format!("point on {side} is {beside:.2e} beside its surface"));
            }
        }
    }
}
