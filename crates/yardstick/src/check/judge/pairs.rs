//! Signed distances of convex pairs.

use glam::DVec3;

use super::{Case, FaultKind, Limit, Outcome, exceeds};
use crate::{
    check::{Answer, ContactAnswer, Near, Question, Reply, tolerance},
    oracle::{distance_to_surface, separation_along},
    sets::pairs::PairRecord,
};

impl Case for PairRecord {
    fn index(&self) -> u64 {
        self.index
    }

    fn category(&self) -> &str {
        &self.category
    }

    fn questions(&self) -> Vec<Question> {
        let (a, b) = (self.a.clone(), self.b.clone());
        let value = if self.distance > 0.0 {
            Question::Distance { a: a.clone(), b: b.clone() }
        } else {
            // At exact touch the reference itself may be off by a rounding, so a gap of that size is let in.
            let max_gap = self.tolerance();
            Question::Penetration { a: a.clone(), b: b.clone(), max_gap }
        };
        vec![Question::Overlap { a, b }, value]
    }

    fn judge(&self, replies: &[Reply]) -> Outcome {
        let mut outcome = Outcome::default();
        if let Some(Answer::Overlap(verdict, claim)) = outcome.answer("overlap", &replies[0]) {
            if !self.ambiguous {
                outcome.verdict("overlap", *verdict, self.distance <= 0.0);
            }
            if let Some(claim) = claim {
                outcome.hold("overlap", claim, self.distance, self.slack());
            }
        }
        match outcome.answer("value", &replies[1]) {
            Some(Answer::Distance(_, hits)) => match hits.first() {
                Some(near) => self.judge_distance(near, &mut outcome),
                None => outcome.fault(FaultKind::Verdict, "distance finds nothing"),
            },
            Some(Answer::Penetration(verdict, contacts)) => {
                if !self.ambiguous {
                    outcome.verdict("penetration", *verdict, true);
                }
                match contacts.first() {
                    Some(contact) => self.judge_contact(contact, &mut outcome),
                    None => outcome.fault(FaultKind::Verdict, "penetration finds no contact"),
                }
            }
            _ => {}
        }
        outcome
    }
}

impl PairRecord {
    fn tolerance(&self) -> f64 {
        tolerance::DISTANCE * self.scale
    }

    fn slack(&self) -> f64 {
        tolerance::REFERENCE * self.scale
    }

    fn judge_distance(&self, near: &Near, outcome: &mut Outcome) {
        let limit = Limit { tolerance: self.tolerance(), scale: self.scale };
        outcome.compare("distance", near.distance, self.distance, limit);
        outcome.hold("distance", &near.claim, self.distance, self.slack());
        match near.normal_b_to_a {
            Some(normal) => self.judge_normal(-normal, self.distance, outcome),
            None if self.distance > self.tolerance() => outcome.fault(FaultKind::Witness, "distance without a normal"),
            None => {}
        }
        let far = self.a.pose.position.abs().max(self.b.pose.position.abs()).max_element();
        let off = self.tolerance() + tolerance::WORLD_POINT * far;
        let apart = near.point_on_a.distance(near.point_on_b);
        if exceeds((apart - self.distance).abs(), off) {
            outcome.fault(FaultKind::Witness, format!("points are {apart:e} apart, expected {:e}", self.distance));
        }
        for (side, placed, point) in [("a", &self.a, near.point_on_a), ("b", &self.b, near.point_on_b)] {
            let beside = distance_to_surface(placed, point);
            if exceeds(beside, off) {
                outcome.fault(FaultKind::Witness, format!("point on {side} is {beside:.2e} beside its surface"));
            }
        }
    }

    fn judge_contact(&self, contact: &ContactAnswer, outcome: &mut Outcome) {
        let depth = -self.distance;
        let limit = Limit { tolerance: self.tolerance(), scale: self.scale };
        outcome.compare("depth", contact.depth, depth, limit);
        outcome.hold("depth", &contact.claim, depth, self.slack());
        self.judge_normal(-contact.normal_b_to_a, self.distance, outcome);
    }

    /// A normal is right if the gap along it is the signed distance: it need not be the reference's.
    fn judge_normal(&self, a_to_b: DVec3, signed_distance: f64, outcome: &mut Outcome) {
        if exceeds((a_to_b.length() - 1.0).abs(), tolerance::UNIT) {
            outcome.fault(FaultKind::Witness, format!("the normal has length {:e}", a_to_b.length()));
            return;
        }
        let gap = separation_along(&self.a, &self.b, a_to_b);
        if exceeds((gap - signed_distance).abs(), self.tolerance()) {
            let what = format!("the gap along the normal is {gap:e}, expected {signed_distance:e}");
            outcome.fault(FaultKind::Witness, what);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        check::{Claim, Verdict},
        sets::{Form, Placed, Pose},
    };

    /// Two unit balls along x, `gap` apart.
    fn balls(gap: f64) -> PairRecord {
        let ball = |x: f64| Placed { form: Form::Sphere { radius: 1.0 }, pose: Pose::at(DVec3::X * x) };
        PairRecord {
            index: 0,
            category: "test".to_owned(),
            ambiguous: false,
            a: ball(0.0),
            b: ball(2.0 + gap),
            distance: gap,
            scale: 2.0 + gap,
        }
    }

    fn right_near() -> Near {
        Near {
            distance: 1.0,
            point_on_a: DVec3::X,
            point_on_b: DVec3::X * 2.0,
            normal_b_to_a: Some(DVec3::NEG_X),
            claim: Claim { verdict: Verdict::Hit, lower: 1.0 - 1e-15, upper: 1.0 + 1e-15 },
        }
    }

    fn faults_apart(near: Near) -> Vec<FaultKind> {
        let replies = [Ok(Answer::Overlap(Verdict::Miss, None)), Ok(Answer::Distance(Verdict::Hit, vec![near]))];
        balls(1.0).judge(&replies).faults.iter().map(|fault| fault.kind).collect()
    }

    #[test]
    fn a_right_answer_has_no_fault() {
        assert_eq!(faults_apart(right_near()), vec![]);
    }

    #[test]
    fn each_altered_part_is_its_own_fault() {
        let near = right_near();
        let off = 1e-8;
        assert_eq!(faults_apart(Near { distance: 1.0 + off, ..near }), vec![FaultKind::Value]);
        assert_eq!(faults_apart(Near { distance: f64::NAN, ..near }), vec![FaultKind::Value]);
        let tilted = DVec3::new(-1.0, 1e-3, 0.0).normalize();
        assert_eq!(faults_apart(Near { normal_b_to_a: Some(tilted), ..near }), vec![FaultKind::Witness]);
        assert_eq!(faults_apart(Near { normal_b_to_a: None, ..near }), vec![FaultKind::Witness]);
        let sideways = DVec3::new(1.0, 1e-3, 0.0);
        assert!(faults_apart(Near { point_on_a: sideways, ..near }).iter().all(|kind| *kind == FaultKind::Witness));
        let claim = Claim { lower: 1.0 + off, upper: 2.0, ..near.claim };
        assert_eq!(faults_apart(Near { claim, ..near }), vec![FaultKind::Interval]);
    }

    #[test]
    fn undecided_is_wrong_unless_ambiguous() {
        let contact = ContactAnswer {
            normal_b_to_a: DVec3::NEG_X,
            depth: 0.5,
            face_of_b: None,
            claim: Claim { verdict: Verdict::Hit, lower: 0.5, upper: 0.5 },
        };
        let replies =
            [Ok(Answer::Overlap(Verdict::Undecided, None)), Ok(Answer::Penetration(Verdict::Hit, vec![contact]))];
        let mut record = balls(-0.5);
        assert_eq!(record.judge(&replies).faults[0].kind, FaultKind::Verdict);
        record.ambiguous = true;
        assert!(record.judge(&replies).faults.is_empty());
    }

    #[test]
    fn no_answer_is_a_fault() {
        let replies = [Err("why".to_owned()), Ok(Answer::Distance(Verdict::Miss, vec![]))];
        let faults = balls(1.0).judge(&replies).faults;
        assert_eq!(faults[0].kind, FaultKind::Unanswered);
        assert_eq!(faults[1].kind, FaultKind::Verdict);
    }
}
