//! Balls that fly at meshes, and capsules near them.

use std::{collections::BTreeSet, sync::Arc};

use glam::DVec3;

use super::{Case, FaultKind, Limit, Outcome, exceeds};
use crate::{
    check::{Answer, ImpactAnswer, Near, Question, Reply, Verdict, tolerance},
    oracle::{distance_to_surface, nearest_on_mesh},
    sets::{
        Form, Placed, Pose, TriangleMesh,
        casts::{CapsuleMeshRecord, SphereCastRecord},
        toi::Motion,
    },
};

fn at_origin(mesh: &Arc<TriangleMesh>) -> Placed {
    Placed { form: Form::Mesh(Arc::clone(mesh)), pose: Pose::at(DVec3::ZERO) }
}

impl Case for SphereCastRecord {
    fn index(&self) -> u64 {
        self.index
    }

    fn category(&self) -> &str {
        &self.category
    }

    fn questions(&self) -> Vec<Question> {
        vec![Question::Impact {
            a: Placed { form: Form::Sphere { radius: self.radius }, pose: Pose::at(self.origin) },
            motion_a: Motion { displacement: self.displacement, rotation_vector: DVec3::ZERO },
            b: at_origin(&self.mesh),
            motion_b: Motion::default(),
        }]
    }

    fn judge(&self, replies: &[Reply]) -> Outcome {
        let mut outcome = Outcome::default();
        let Some(Answer::Impact(verdict, hits)) = outcome.answer("cast", &replies[0]) else {
            return outcome;
        };
        if !self.ambiguous {
            outcome.verdict("cast", *verdict, self.time.is_some());
            if hits.iter().any(|hit| hit.claim.verdict == Verdict::Undecided) {
                outcome.fault(FaultKind::Verdict, "cast has an undecided hit");
            }
        }
        if let (Some(time), Some(hit)) = (self.time, hits.first()) {
            if self.start != hit.initial && !self.ambiguous {
                outcome.fault(FaultKind::Verdict, format!("start is {}, expected {}", hit.initial, self.start));
            }
            self.judge_time(hit, time, &mut outcome);
        }
        outcome
    }
}

impl SphereCastRecord {
    /// How far the ball's skin is from the mesh at a time; negative if it is in it. The nearest point comes along.
    fn gap(&self, time: f64) -> (f64, DVec3) {
        let center = self.origin + self.displacement * time;
        let (nearest, distance) = nearest_on_mesh(&self.mesh, &Pose::at(DVec3::ZERO), center);
        (distance - self.radius, nearest - center)
    }

    fn judge_time(&self, hit: &ImpactAnswer, time: f64, outcome: &mut Outcome) {
        if self.start {
            outcome.note_error(hit.fraction.abs());
            if hit.fraction != 0.0 {
                outcome.fault(FaultKind::Value, format!("time {:e}, expected 0", hit.fraction));
            }
            outcome.hold("time", &hit.claim, 0.0, 0.0);
            return;
        }
        let tolerance = tolerance::SPHERE_CAST * self.scale;
        let (gap, _) = self.gap(hit.fraction);
        outcome.compare("gap at the claimed time", gap, 0.0, Limit { tolerance, scale: self.scale });
        // A later touch has no gap either; but on the way there the ball was in the mesh.
        let (between, _) = self.gap(0.5 * (hit.fraction + time));
        if hit.fraction > time && between < -tolerance {
            outcome.fault(FaultKind::Value, format!("time {:e} is after the first touch {time:e}", hit.fraction));
        }
        let (_, to_mesh) = self.gap(time);
        let rate = self.displacement.dot(to_mesh).abs() / to_mesh.length();
        let end = self.origin + self.displacement;
        let moved = tolerance::REFERENCE * (self.scale + self.displacement.length()) + f64::EPSILON * end.length();
        outcome.hold("time", &hit.claim, time, moved / rate);
    }
}

impl Case for CapsuleMeshRecord {
    fn index(&self) -> u64 {
        self.index
    }

    fn category(&self) -> &str {
        &self.category
    }

    fn questions(&self) -> Vec<Question> {
        let (a, b) = (self.capsule(), at_origin(&self.mesh));
        let overlap = Question::Overlap { a: a.clone(), b: b.clone() };
        if self.distance > 0.0 {
            return vec![overlap, Question::Distance { a, b }];
        }
        let axis = Question::Distance { a: self.axis(), b: b.clone() };
        let max_gap = 0.0;
        vec![overlap, Question::Penetration { a, b, max_gap }, axis]
    }

    fn judge(&self, replies: &[Reply]) -> Outcome {
        let mut outcome = Outcome::default();
        if let Some(answer) = outcome.answer("overlap", &replies[0])
            && !self.ambiguous
        {
            outcome.verdict("overlap", answer.verdict(), self.overlap);
        }
        match outcome.answer("value", &replies[1]) {
            Some(Answer::Distance(_, hits)) => match hits.first() {
                Some(near) => self.judge_distance(near, &mut outcome),
                None => outcome.fault(FaultKind::Verdict, "distance finds nothing"),
            },
            Some(Answer::Penetration(_, contacts)) => {
                self.judge_faces(contacts.iter().filter_map(|contact| contact.face_of_b).collect(), &mut outcome);
            }
            _ => {}
        }
        if let Some(reply) = replies.get(2) {
            self.judge_axis(reply, &mut outcome);
        }
        outcome
    }
}

impl CapsuleMeshRecord {
    /// The capsule without its radius.
    fn axis(&self) -> Placed {
        let half_height = self.half_height;
        Placed { form: Form::Capsule { half_height, radius: 0.0 }, pose: self.pose }
    }

    /// Where the capsule touches, the record still says how far its segment is from the surface.
    fn judge_axis(&self, reply: &Reply, outcome: &mut Outcome) {
        let Some(Answer::Distance(_, hits)) = outcome.answer("distance of the axis", reply) else {
            return;
        };
        let Some(near) = hits.first() else {
            outcome.fault(FaultKind::Verdict, "distance of the axis finds nothing");
            return;
        };
        let truth = self.distance + self.radius;
        let limit = Limit { tolerance: tolerance::DISTANCE * self.scale, scale: self.scale };
        outcome.compare("distance of the axis", near.distance, truth, limit);
        let slack = tolerance::REFERENCE * self.scale;
        outcome.hold("distance of the axis", &near.claim, truth, slack);
    }

    fn capsule(&self) -> Placed {
        Placed { form: Form::Capsule { half_height: self.half_height, radius: self.radius }, pose: self.pose }
    }

    fn judge_distance(&self, near: &Near, outcome: &mut Outcome) {
        let limit = Limit { tolerance: tolerance::DISTANCE * self.scale, scale: self.scale };
        outcome.compare("distance", near.distance, self.distance, limit);
        outcome.hold("distance", &near.claim, self.distance, tolerance::REFERENCE * self.scale);
        let sides = [("capsule", self.capsule(), near.point_on_a), ("mesh", at_origin(&self.mesh), near.point_on_b)];
        for (side, placed, point) in sides {
            let beside = distance_to_surface(&placed, point);
            if exceeds(beside, limit.tolerance) {
                outcome.fault(FaultKind::Witness, format!("point on {side} is {beside:.2e} beside its surface"));
            }
        }
    }

    /// All triangles that are surely touched must be among the contacts, and none that surely is not.
    fn judge_faces(&self, found: BTreeSet<u32>, outcome: &mut Outcome) {
        let missing: Vec<u32> = self.faces.iter().copied().filter(|face| !found.contains(face)).collect();
        let allowed = |face: &u32| self.faces.contains(face) || self.maybe.contains(face);
        let extra: Vec<u32> = found.iter().copied().filter(|face| !allowed(face)).collect();
        if !missing.is_empty() || !extra.is_empty() {
            outcome.fault(FaultKind::Witness, format!("contacts lack faces {missing:?}, and have {extra:?} too many"));
        }
    }
}
