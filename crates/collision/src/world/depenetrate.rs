//! Which way out of everything that it overlaps does the subject have?
//!
//! # Method
//! Each contact is a wall: a subject that goes the upper bound of its depth along its normal is parted from that piece, proved,
//! whatever else it does meanwhile. The shortest way past all walls is taken ([`way_out`]), and what is met there adds its walls
//! to those before, so that two obstacles do not push to and fro for ever. Where no way is past all of them, the walls of this
//! place alone count. Where these leave none either, it goes over the boxes of all that is met here, along an axis, if they are
//! convex; else past the deepest walls first. It ends where nothing is met, where no way is left, or after a number of
//! passes; the answer is the least deep of all places that were seen, the first one included.
//!
//! Whether it is free there is told by an overlap of its own.
//!
//! # Limits
//! The way is the shortest by the contacts, which of concave or many shapes need not be the shortest there is. What is squeezed
//! from both sides by something concave, or by half spaces, may stay so. What stands far inside something larger is led out of its nearest side, be that a wrong one.

mod way_out;

use glam::DVec3;

use self::way_out::{Past, Wall, way_out};
use super::{Contact, Filter, Meter, Overlap, Penetration, QuestionError, ShapeId, Snapshot, Subject, search::Side};
use crate::{
    accuracy::{Accuracy, Tier},
    answer::{Bound, Stop, Verdict},
    math::{Aabb, Norm, Pose},
    narrow::Placed,
    shape::Form,
    tolerance::CLEARANCE,
};

/// Contacts that a pass looks at: the deepest ones.
const CONTACTS_MAX: usize = 256;

/// Contacts that are told at the end: the deepest ones.
const CONTACTS_TOLD: usize = 64;

/// Which way out does the subject have?
#[derive(Clone, Debug)]
pub struct Depenetrate {
    /// What is moved.
    pub subject: Subject,
    /// Only out of this; `None` is the whole world.
    pub against: Option<Subject>,
    /// How far it is to be from everything then, metres.
    pub gap: f64,
    /// Farthest it is moved, metres.
    pub max_distance: f64,
    /// Passes at most.
    pub max_passes: usize,
}

/// Where it is moved, and what is proved of that place.
#[derive(Clone, Debug)]
pub struct Depenetrated {
    /// `Miss` if it is proved to touch nothing there, `Hit` if it surely does.
    pub verdict: Verdict,
    /// Where it is then.
    pub position: DVec3,
    /// From where it was.
    pub translation: DVec3,
    /// Of the deepest overlap that is left, metres; negative is a gap.
    pub depth: Bound,
    /// The shapes that it was moved out of, or away from to keep the gap, by id.
    pub moved_out_of: Vec<ShapeId>,
    /// What it touches there or is within the gap of; deepest first, the first 64.
    pub contacts: Vec<Contact>,
    /// How many times it was moved.
    pub passes: usize,
}

/// What is met at a place.
#[derive(Clone, Debug)]
struct Place {
    translation: DVec3,
    contacts: Vec<Contact>,
    depth: Bound,
}

impl Snapshot {
    /// A translation that moves the subject out of what it overlaps. Sensors are passed over. Where it ends it is never deeper
    /// than where it began.
    ///
    /// # Errors
    /// A shape that is not there, [`QuestionError::NeedsDecomposition`], [`QuestionError::Interrupted`].
    pub fn depenetrate(
        &self,
        question: &Depenetrate,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Depenetrated, QuestionError> {
        let _asking = self.asking().now();
        let subject = self.subject(&question.subject)?;
        let push = Push {
            world: self,
            question,
            subject: subject.placed,
            against: self.against(question.against.as_ref())?,
            filter: &Filter { exclude_sensors: true, ..filter.clone() },
            // Ways out of a stand-in are longer than those out of the shape.
            accuracy: &Accuracy { tier: Tier::Exact, ..*accuracy },
        };
        push.go(meter)
    }
}

/// A subject that is moved.
struct Push<'a> {
    world: &'a Snapshot,
    question: &'a Depenetrate,
    subject: Placed<'a>,
    against: Option<Side<'a>>,
    filter: &'a Filter,
    accuracy: &'a Accuracy,
}

impl Push<'_> {
    fn go(&self, meter: &mut Meter<'_>) -> Result<Depenetrated, QuestionError> {
        let mut walls: Vec<Wall> = Vec::new();
        let mut moved_out_of = Vec::new();
        let mut here = self.look(DVec3::ZERO, meter)?;
        let mut best = here.clone();
        let mut passes = 0;
        while !self.is_clear(&here) && passes < self.question.max_passes {
            moved_out_of.extend(here.contacts.iter().filter_map(|contact| contact.id));
            let next = self.next(&mut walls, &here);
            if next == here.translation {
                break;
            }
            passes += 1;
            here = self.look(next, meter)?;
            if here.depth.upper < best.depth.upper {
                best = here.clone();
            }
        }
        moved_out_of.sort_unstable();
        moved_out_of.dedup();
        let Place { translation, mut contacts, depth } = best;
        let (verdict, depth) = self.judge(translation, depth, meter)?;
        contacts.truncate(CONTACTS_TOLD);
        let position = self.pose_at(translation).position;
        Ok(Depenetrated { verdict, position, translation, depth, moved_out_of, contacts, passes })
    }

    /// The way from the beginning to the next place.
    fn next(&self, walls: &mut Vec<Wall>, here: &Place) -> DVec3 {
        let new = self.walls(here);
        walls.extend(&new);
        let longest = self.question.max_distance;
        let found = way_out(walls, longest);
        if found.past == Past::All {
            return found.way;
        }
        walls.clone_from(&new);
        let found = way_out(&new, longest);
        if found.past == Past::All {
            return found.way;
        }
        let is_farther = |wall: &Wall| wall.normal.dot(found.way) > wall.normal.dot(here.translation);
        let partly = if new.iter().any(is_farther) { found.way } else { here.translation };
        self.over(here).unwrap_or(partly)
    }

    /// The way to the nearest place that is beyond the boxes of all that is met here, along one axis; `None` if something there
    /// is concave, whose box says nothing of the way out of a part of it, or if it is too far.
    fn over(&self, here: &Place) -> Option<DVec3> {
        let own = self.subject.geometry.bounds(&self.pose_at(here.translation));
        let mut beyond: Option<Aabb> = None;
        for contact in &here.contacts {
            let other = match &self.against {
                Some(against) => *against,
                None => self.world.find(contact.id?)?,
            };
            let Form::Convex(_) = other.placed.geometry.form() else { return None };
            beyond = Some(beyond.map_or(other.bounds, |all| all.union(other.bounds)));
        }
        let beyond = beyond?;
        let clearance = (own.min.abs().max(own.max.abs()).max_element() + self.subject.geometry.reach()) * CLEARANCE;
        let margin = self.question.gap + clearance;
        let (up, down) = (beyond.max - own.min + margin, own.max - beyond.min + margin);
        let axes = DVec3::AXES;
        let ways = axes.iter().flat_map(|&axis| [axis * up.dot(axis), axis * -down.dot(axis)]);
        let ways = ways.map(|way| here.translation + way).filter(|way| way.norm() <= self.question.max_distance);
        ways.min_by(|a, b| a.norm().total_cmp(&b.norm()))
    }

    /// Whether it is proved to be as far from everything as it should.
    fn is_clear(&self, place: &Place) -> bool {
        place.depth.upper < 0.0 && place.depth.upper <= -self.question.gap
    }

    /// What must be passed to leave a place; deepest first.
    fn walls(&self, place: &Place) -> Vec<Wall> {
        let coordinates = self.pose_at(place.translation).position.abs().max_element();
        let wall = |contact: &Contact| {
            let bound = contact.certificate.bound;
            // At best the gap is proved to within the interval that is left there, which is rounding.
            let rounding = if contact.certificate.stop == Stop::Converged { bound.width() } else { 0.0 };
            let clearance = (coordinates + self.subject.geometry.reach() + contact.depth.abs()) * CLEARANCE + rounding;
            let least = contact.normal.dot(place.translation) + bound.upper + self.question.gap + clearance;
            least.is_finite().then_some(Wall { normal: contact.normal, least })
        };
        place.contacts.iter().filter_map(wall).collect()
    }

    fn look(&self, translation: DVec3, meter: &mut Meter<'_>) -> Result<Place, QuestionError> {
        let max_gap = self.question.gap;
        let question = Penetration {
            subject: self.subject_at(translation),
            against: self.question.against.clone(),
            max_gap,
            max_contacts: CONTACTS_MAX,
        };
        let contacts = self.world.penetration(&question, self.filter, self.accuracy, meter)?.hits;
        let bounds = contacts.iter().map(|contact| contact.certificate.bound);
        // What has no contact is proved to be farther than the gap.
        let beyond = Bound::new(f64::NEG_INFINITY, (-max_gap).next_down());
        let depth =
            bounds.fold(beyond, |all, bound| Bound::new(all.lower.max(bound.lower), all.upper.max(bound.upper)));
        Ok(Place { translation, contacts, depth })
    }

    fn pose_at(&self, translation: DVec3) -> Pose {
        Pose { position: self.subject.pose.position + translation, ..self.subject.pose }
    }

    fn subject_at(&self, translation: DVec3) -> Subject {
        let place = self.pose_at(translation);
        match &self.question.subject {
            Subject::Shape { id, .. } => Subject::Shape { id: *id, pose: Some(place) },
            Subject::Geometry { geometry, .. } => Subject::Geometry { geometry: geometry.clone(), pose: place },
        }
    }

    /// What an overlap says of a place, and what that makes of the depth there.
    fn judge(
        &self,
        translation: DVec3,
        depth: Bound,
        meter: &mut Meter<'_>,
    ) -> Result<(Verdict, Bound), QuestionError> {
        let (subject, against) = (self.subject_at(translation), self.question.against.clone());
        let overlap = Overlap { subject, against, max_hits: CONTACTS_MAX };
        let verdict = self.world.overlap(&overlap, self.filter, self.accuracy, meter)?.verdict;
        let depth = if verdict == Verdict::Miss {
            // Beyond a gap of 0 is the next number below it, which nobody cares to read.
            let upper = if depth.upper > -f64::MIN_POSITIVE { 0.0 } else { depth.upper };
            Bound::new(depth.lower, upper)
        } else if depth.upper < 0.0 {
            // What touches without a contact, such as the back of a one-sided mesh, has no depth that is known.
            Bound::new(0.0, f64::INFINITY)
        } else {
            depth
        };
        Ok((verdict, depth))
    }
}
