//! How far does a character get that slides along what it meets?
//!
//! # Method
//! The character, rounded by a little less than its skin, is swept along its wish up to what it touches first. The pieces that are within the
//! skin at the start of a stride are planes: a stride is the way nearest to the wish that goes into none of them, and what is
//! beyond such a plane stays beyond it, so the sweep passes over it. What is left of the wish makes the next stride. Since a
//! sweep ends where the way is proved free and planes are proved by contacts, the character never ends deeper in a shape than
//! it began, to within rounding.
//!
//! Floors that can be stood on take up what of a wish goes down, so that weight does not make it slide. Slopes that are too
//! steep for that are walls as well: nothing climbs them. A wall that is no higher than a step is climbed by three strides,
//! up, ahead and down, if they end on a floor.
//!
//! # Source
//! Jolt Physics, `CharacterVirtual` (stairs, and sticking to the floor); Quake's `PM_SlideMove` (planes gathered in a corner).
//! Here the nearest way between planes is found among all their shadows and edges, not by clipping in turn.
//!
//! # Limits
//! It is a question: nothing is pushed, and what moves is where it is at the tick that is read.

mod push;
mod slide;
mod step;

use std::sync::Arc;

use glam::{DVec2, DVec3};

use self::slide::Planes;
use super::{
    Contact, Filter, HitMode, Impact, Meter, Penetration, QuestionError, Raycast, Snapshot, Subject, TimeOfImpact,
};
use crate::{
    accuracy::{Accuracy, Tier},
    answer::{Bound, Verdict},
    math::{Norm, Pose, try_unit},
    narrow::{Faces, ImpactTouch, InitialTouch, Ray},
    shape::{Form, Geometry},
    tolerance::{BESIDE_EDGE, SKIN_MARGIN, SKIN_MIN, STRIDE_MIN},
};

/// Contacts that a stride looks at; a character that touches more is caught among the deepest of them.
const CONTACTS_MAX: usize = 256;

/// How far does a character get?
#[derive(Clone, Debug)]
pub struct MoveCharacter {
    /// The character, of a convex geometry.
    pub subject: Subject,
    /// Where it wants to go, metres.
    pub translation: DVec3,
    /// Which way is up, of any length but 0.
    pub up: DVec3,
    /// Steepest floor it can stand on, radians from 0 to π/2.
    pub max_slope: f64,
    /// Highest step it climbs, metres.
    pub step_height: f64,
    /// Farthest it is put down at the end if it began on a floor and does not go up, metres.
    pub snap_distance: f64,
    /// Distance it keeps from everything, metres: 0, or within [`crate::shape::Limits`].
    pub skin: f64,
    /// Strides at most.
    pub max_slides: usize,
    /// Farthest it is moved out of what it overlaps before it goes, metres: see [`super::Depenetrate`].
    pub max_push: f64,
}

/// How far it got.
#[derive(Clone, Debug)]
pub struct MovedCharacter {
    /// `Miss` if it got there untouched, `Hit` if something was in the way, `Undecided` if it stopped short for want of a
    /// proof.
    pub verdict: Verdict,
    /// Where it ends.
    pub position: DVec3,
    /// The most level of what it stands on.
    pub ground: Option<Contact>,
    /// What it touched, in order; the fractions are of the part of the way then left.
    pub hits: Vec<Impact>,
    /// How it was moved out of what it overlapped before it went.
    pub pushed: DVec3,
}

impl Snapshot {
    /// How far a character gets. Sensors are passed over.
    ///
    /// # Errors
    /// A shape that is not there, a character that is not convex or too large with its skin,
    /// [`QuestionError::NeedsDecomposition`], [`QuestionError::Interrupted`].
    pub fn move_character(
        &self,
        question: &MoveCharacter,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<MovedCharacter, QuestionError> {
        let _asking = self.asking().now();
        let (geometry, pose, filter) = self.character(question, filter)?;
        let margin = (question.skin + geometry.reach() * SKIN_MIN) * SKIN_MARGIN;
        // A skin that a form cannot have is refused, though sweeps take a thinner one.
        let whole = Geometry::clone(&geometry).rounded(question.skin).map_err(QuestionError::Skin)?;
        let skinned = Geometry::clone(&geometry).rounded((question.skin - margin).max(0.0)).unwrap_or(whole);
        // Planes of a stand-in would lead it into the shape, or off it.
        let accuracy = &Accuracy { tier: Tier::Exact, ..*accuracy };
        let mut walk = Walk {
            world: self,
            question,
            up: try_unit(question.up).unwrap_or(DVec3::Y),
            level: DVec2::from_angle(question.max_slope).x,
            filter,
            accuracy,
            meter,
            skinned: Arc::new(skinned),
            margin,
            geometry,
            pose,
            hits: Vec::new(),
        };
        walk.go()
    }

    /// The character's form, where it is, and what it sees: as a shape it sees what that shape sees.
    fn character(
        &self,
        question: &MoveCharacter,
        filter: &Filter,
    ) -> Result<(Arc<Geometry>, Pose, Filter), QuestionError> {
        let mut filter = filter.clone();
        filter.exclude_sensors = true;
        let (geometry, pose, id) = match &question.subject {
            Subject::Geometry { geometry, pose } => (geometry.clone(), *pose, None),
            Subject::Shape { id, pose } => {
                let shape = self.shape(*id).ok_or(QuestionError::SubjectNotFound(*id))?;
                filter.layers = filter.layers.or(Some(shape.layers));
                filter.collides_with = filter.collides_with.or(Some(shape.collides_with));
                filter.exclude_ids.push(*id);
                filter.exclude_groups.extend((shape.group != 0).then_some(shape.group));
                (shape.geometry.clone(), pose.unwrap_or(shape.pose), Some(*id))
            }
        };
        match geometry.form() {
            Form::Convex(_) => Ok((geometry, pose, filter)),
            Form::HalfSpace(_) => Err(QuestionError::SubjectUnbounded(id)),
            Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_) => Err(QuestionError::SubjectNotConvex(id)),
        }
    }
}

/// A character under way.
struct Walk<'a, 'm> {
    world: &'a Snapshot,
    question: &'a MoveCharacter,
    /// Unit.
    up: DVec3,
    /// Floors whose normals have at least this much of `up` can be stood on.
    level: f64,
    filter: Filter,
    accuracy: &'a Accuracy,
    meter: &'a mut Meter<'m>,
    geometry: Arc<Geometry>,
    skinned: Arc<Geometry>,
    /// How much thinner than its skin sweeps are, metres, so that they are clear of what is at the skin's distance.
    margin: f64,
    pose: Pose,
    hits: Vec<Impact>,
}

/// What is within the skin.
struct Near {
    contact: Contact,
    /// It can be stood on.
    is_floor: bool,
}

/// How a stride goes where planes are in its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rule {
    /// Along them.
    Slides,
    /// Not at all.
    IsStraight,
}

/// What became of a stride.
struct Stride {
    /// Where it ends.
    to: DVec3,
    /// What is left of the way.
    left: DVec3,
    /// What ended it.
    touched: Option<Impact>,
}

impl Walk<'_, '_> {
    fn go(&mut self) -> Result<MovedCharacter, QuestionError> {
        let pushed = self.push()?;
        let mut contacts = self.contacts(self.pose.position)?;
        let began_on_floor = self.floor(&contacts).is_some();
        let mut left = self.question.translation;
        let enough = left.norm() * STRIDE_MIN;
        self.note_what_is_in_the_way(&contacts, left);
        for _ in 0..self.question.max_slides {
            if left.norm() <= enough {
                break;
            }
            let from = self.pose.position;
            let stride = self.stride(from, left, &contacts, Rule::Slides)?;
            let is_wall = stride.touched.as_ref().is_some_and(|touch| !self.is_level(touch.touch.normal_b_to_a));
            let is_stuck = stride.to == from;
            // A step is climbed with all that the wish has left, not with what a wall leaves of it.
            let rest = left - (stride.to - from);
            self.hits.extend(stride.touched);
            (self.pose.position, left) = (stride.to, stride.left);
            if (is_stuck || is_wall)
                && let Some(stepped) = self.step(rest, began_on_floor)?
            {
                self.hits.extend(stepped.touched);
                (self.pose.position, left) = (stepped.to, stepped.left);
            } else if is_stuck {
                break;
            }
            contacts = self.contacts(self.pose.position)?;
        }
        if began_on_floor && self.floor(&contacts).is_none() && self.question.translation.dot(self.up) <= 0.0 {
            contacts = self.put_down(contacts)?;
        }
        let ground = self.floor(&contacts).cloned();
        let certain = self.hits.iter().any(|hit| hit.touch.certificate.verdict == Verdict::Hit);
        let verdict = match (self.hits.is_empty(), certain) {
            (true, _) => Verdict::Miss,
            (false, true) => Verdict::Hit,
            (false, false) => Verdict::Undecided,
        };
        let hits = std::mem::take(&mut self.hits);
        Ok(MovedCharacter { verdict, position: self.pose.position, ground, hits, pushed })
    }

    /// One way from a place where these are the contacts.
    fn stride(&mut self, from: DVec3, wish: DVec3, contacts: &[Near], rule: Rule) -> Result<Stride, QuestionError> {
        let way = match rule {
            Rule::Slides => self.slide(wish, contacts),
            Rule::IsStraight => match contacts.iter().find(|near| near.contact.normal.dot(wish) < 0.0) {
                Some(near) => return Ok(Stride { to: from, left: wish, touched: Some(at_the_start(&near.contact)) }),
                None => wish,
            },
        };
        if way == DVec3::ZERO {
            return Ok(Stride { to: from, left: way, touched: None });
        }
        let pose = Pose { position: from, ..self.pose };
        let question = TimeOfImpact {
            subject: Subject::Geometry { geometry: self.skinned.clone(), pose },
            displacement: way,
            rotation: DVec3::ZERO,
            against: None,
            against_displacement: DVec3::ZERO,
            against_rotation: DVec3::ZERO,
            initial: InitialTouch::IsIgnored,
            mode: HitMode::Closest,
        };
        let found = self.world.time_of_impact(&question, &self.filter, self.accuracy, self.meter)?;
        let first = found.hits.into_iter().min_by(|a, b| {
            let lower = |hit: &Impact| hit.touch.certificate.bound.lower;
            lower(a).total_cmp(&lower(b))
        });
        Ok(match first {
            None => Stride { to: from + way, left: DVec3::ZERO, touched: None },
            Some(mut hit) => {
                // It stops where its whole skin would touch: from there, ways along what it touched are proved to be free.
                let touch = &mut hit.touch;
                let closing = touch.normal_b_to_a.map_or(0.0, |normal| -way.dot(normal)).max(0.0);
                let early = if closing > 0.0 { self.margin / closing } else { 1.0 };
                let earlier = |fraction: f64| (fraction - early).clamp(0.0, 1.0);
                let bound = &mut touch.certificate.bound;
                (bound.lower, touch.fraction) = (earlier(bound.lower), earlier(touch.fraction));
                if closing > 0.0 {
                    bound.upper = earlier(bound.upper);
                }
                let free = bound.lower;
                Stride { to: from + way * free, left: way * (1.0 - free), touched: Some(hit) }
            }
        })
    }

    /// What a wish becomes on floors and between walls.
    fn slide(&self, wish: DVec3, contacts: &[Near]) -> DVec3 {
        let mut planes = Planes::default();
        let rise = wish.dot(self.up);
        let mut stands = false;
        for Near { contact, is_floor } in contacts {
            planes.add(contact.normal);
            let steepness = contact.normal.dot(self.up);
            stands |= is_floor & (contact.normal.dot(wish) < 0.0);
            if rise <= 0.0
                && steepness > 0.0
                && steepness < self.level
                && let Some(wall) = try_unit(contact.normal - self.up * steepness)
            {
                planes.add(wall);
            }
        }
        let wish = if stands && rise < 0.0 { wish - self.up * rise } else { wish };
        planes.slide(wish)
    }

    /// What is within the skin at a place.
    fn contacts(&mut self, position: DVec3) -> Result<Vec<Near>, QuestionError> {
        let pose = Pose { position, ..self.pose };
        let question = Penetration {
            subject: Subject::Geometry { geometry: self.geometry.clone(), pose },
            against: None,
            max_gap: self.question.skin + 2.0 * self.margin,
            max_contacts: CONTACTS_MAX,
        };
        let contacts = self.world.penetration(&question, &self.filter, self.accuracy, self.meter)?.hits;
        let near = contacts.into_iter().map(|contact| {
            let is_floor = self.is_floor(&contact)?;
            Ok(Near { contact, is_floor })
        });
        near.collect()
    }

    /// Whether a contact can be stood on: it is level, or on the edge of what is.
    fn is_floor(&mut self, contact: &Contact) -> Result<bool, QuestionError> {
        let steepness = contact.normal.dot(self.up);
        let (Some(point), true) = (contact.points.first(), steepness > 0.0) else { return Ok(false) };
        if steepness >= self.level {
            return Ok(true);
        }
        let Some(outwards) = try_unit(contact.normal - self.up * steepness) else { return Ok(false) };
        let aside = self.geometry.reach() * BESIDE_EDGE;
        let ray = Ray {
            origin: point.point_on_b + (self.up - outwards) * aside,
            direction: -self.up,
            min_distance: 0.0,
            max_distance: 2.0 * aside,
            hollow: true,
            faces: Faces::Both,
        };
        let question = Raycast { ray, mode: HitMode::Closest };
        let found = self.world.raycast(&question, &self.filter, self.accuracy, self.meter)?;
        Ok(found.hits.iter().any(|hit| hit.touch.normal.is_some_and(|normal| normal.dot(self.up) >= self.level)))
    }

    /// The most level of the contacts that can be stood on; of equal ones the deepest.
    fn floor<'c>(&self, contacts: &'c [Near]) -> Option<&'c Contact> {
        let level = |contact: &Contact| contact.normal.dot(self.up);
        let floors = contacts.iter().filter(|near| near.is_floor).map(|near| &near.contact);
        floors.reduce(|best, contact| if level(contact) > level(best) { contact } else { best })
    }

    fn is_level(&self, normal: Option<DVec3>) -> bool {
        normal.is_some_and(|normal| normal.dot(self.up) >= self.level)
    }

    /// What is within the skin from the first counts as touched if the wish goes into it.
    fn note_what_is_in_the_way(&mut self, contacts: &[Near], wish: DVec3) {
        let contacts = contacts.iter().map(|near| &near.contact);
        let in_the_way = contacts.filter(|contact| contact.normal.dot(wish) < 0.0);
        self.hits.extend(in_the_way.map(at_the_start));
    }
}

/// A contact as a touch at the start of a stride.
fn at_the_start(contact: &Contact) -> Impact {
    let mut certificate = contact.certificate;
    certificate.verdict = Verdict::Hit;
    certificate.bound = Bound::new(0.0, 0.0);
    Impact {
        id: contact.id,
        user_data: contact.user_data,
        pierced: false,
        touch: ImpactTouch {
            fraction: 0.0,
            point: contact.points.first().map_or(DVec3::ZERO, |point| point.point_on_b),
            normal_b_to_a: Some(contact.normal),
            initial: true,
            feature_b: contact.feature,
            certificate,
        },
    }
}
