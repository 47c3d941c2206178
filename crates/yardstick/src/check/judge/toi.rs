//! First times of touch of convex pairs.

use glam::{DQuat, DVec3};

use super::{Case, FaultKind, Outcome, exceeds};
use crate::{
    check::{Answer, ImpactAnswer, Question, Reply, Verdict, tolerance},
    oracle::separation_along,
    sets::{
        Placed, Pose,
        toi::{Motion, ToiRecord},
    },
};

impl Case for ToiRecord {
    fn index(&self) -> u64 {
        self.index
    }

    fn category(&self) -> &str {
        &self.category
    }

    fn questions(&self) -> Vec<Question> {
        vec![Question::Impact {
            a: self.a.clone(),
            motion_a: self.motion_a,
            b: self.b.clone(),
            motion_b: self.motion_b,
        }]
    }

    fn judge(&self, replies: &[Reply]) -> Outcome {
        let mut outcome = Outcome::default();
        let Some(Answer::Impact(verdict, hits)) = outcome.answer("impact", &replies[0]) else {
            return outcome;
        };
        if !self.ambiguous {
            outcome.verdict("impact", *verdict, self.time.is_some());
            if hits.iter().any(|hit| hit.claim.verdict == Verdict::Undecided) {
                outcome.fault(FaultKind::Verdict, "impact has an undecided hit");
            }
        }
        let (Some(time), Some(hit)) = (self.time, hits.first()) else {
            return outcome;
        };
        if self.start {
            self.judge_start(hit, &mut outcome);
        } else {
            self.judge_time(hit, time, &mut outcome);
        }
        outcome
    }
}

impl ToiRecord {
    fn turns(&self) -> bool {
        self.motion_a.turns() || self.motion_b.turns()
    }

    /// How far apart the forms may be at the claimed time, metres.
    fn tolerance(&self) -> f64 {
        if self.turns() {
            tolerance::ROTATING * self.scale
        } else {
            tolerance::DISTANCE * self.scale + tolerance::SPEED * self.speed
        }
    }

    fn judge_start(&self, hit: &ImpactAnswer, outcome: &mut Outcome) {
        outcome.note_error(hit.fraction.abs());
        if hit.fraction != 0.0 {
            outcome.fault(FaultKind::Value, format!("time {:e}, expected 0: they overlap at the start", hit.fraction));
        }
        if !hit.initial {
            outcome.fault(FaultKind::Witness, "they overlap at the start, which is not said");
        }
        outcome.hold("time", &hit.claim, 0.0, 0.0);
    }

    fn judge_time(&self, hit: &ImpactAnswer, time: f64, outcome: &mut Outcome) {
        if let Some(normal) = hit.normal_b_to_a {
            self.judge_normal(-normal, hit.fraction, outcome);
        }
        // Turning pairs have no rate. Their fastest point tells how far a time may be off without a second look; beyond
        // that the gap at the claimed time, which the normal shows, is what the format judges.
        let rate = self.rate.unwrap_or_else(|| self.fastest());
        let way = (hit.fraction - time).abs() * rate;
        outcome.note_error(way / self.scale);
        let excused = self.turns() && hit.normal_b_to_a.is_some();
        if exceeds(way, self.tolerance()) && !excused {
            let what =
                format!("time {:e}, expected {time:e}: {way:.2e} of way > {:.2e}", hit.fraction, self.tolerance());
            outcome.fault(FaultKind::Value, what);
        }
        let reference = if self.turns() { tolerance::ROTATING } else { tolerance::REFERENCE };
        let gap = reference * (self.scale + self.speed) + tolerance::REFERENCE_IMPACT_GAP + self.end_rounding();
        let slack = gap / rate;
        outcome.hold("time", &hit.claim, time, slack);
    }

    fn fastest(&self) -> f64 {
        let turning = self.motion_a.rotation_vector.length() + self.motion_b.rotation_vector.length();
        self.speed + turning * self.scale
    }

    /// On the wire a motion is told by where it ends. Where start plus displacement is no f64, what is asked is that much
    /// beside the record.
    fn end_rounding(&self) -> f64 {
        let rounding = |pose: &Pose, motion: &Motion| {
            let end = pose.position + motion.displacement;
            if end - pose.position == motion.displacement { 0.0 } else { f64::EPSILON * end.length() }
        };
        rounding(&self.a.pose, &self.motion_a) + rounding(&self.b.pose, &self.motion_b)
    }

    fn judge_normal(&self, a_to_b: DVec3, time: f64, outcome: &mut Outcome) {
        let gap =
            separation_along(&moved(&self.a, &self.motion_a, time), &moved(&self.b, &self.motion_b, time), a_to_b);
        let unit_error = (a_to_b.length() - 1.0).abs();
        let allowed = tolerance::IMPACT_NORMAL * self.scale + tolerance::SPEED * self.speed;
        if exceeds(unit_error, tolerance::UNIT) || exceeds(gap.abs(), allowed) {
            outcome.fault(FaultKind::Witness, format!("the gap along the normal at the touch is {gap:e}"));
        }
    }
}

/// Where a form is at a time of its motion.
fn moved(placed: &Placed, motion: &Motion, time: f64) -> Placed {
    let angle = motion.rotation_vector.length() * time;
    let turn =
        motion.rotation_vector.try_normalize().map_or(DQuat::IDENTITY, |axis| DQuat::from_axis_angle(axis, angle));
    let pose =
        Pose { position: placed.pose.position + motion.displacement * time, rotation: turn * placed.pose.rotation };
    Placed { form: placed.form.clone(), pose }
}
