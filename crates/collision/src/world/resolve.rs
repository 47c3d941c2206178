//! How would bodies in contact bounce and be pushed apart?
//!
//! # Method
//! The contacts of the bodies at this version, by ids and then by pieces, are handed to `response`, with everything that
//! is not among the bodies as something that goes its own way.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{Contact, Filter, Meter, Mobility, Penetration, QuestionError, Shape, ShapeId, Snapshot, Subject};
use crate::{
    accuracy::Accuracy,
    answer::Verdict,
    response::{self, Motion, Touch},
};

/// Contacts of one body that are looked at, the deepest first.
const CONTACTS_MAX: usize = 4096;

/// How would bodies in contact bounce and be pushed apart?
#[derive(Clone, Debug)]
pub struct Resolve {
    /// The bodies, each shape at most once.
    pub bodies: Vec<Body>,
    /// How many times contacts are worked on in turn.
    pub passes: u32,
    /// Depth that is left alone, metres.
    pub allowed_depth: f64,
    /// Part of the rest of the depth that is corrected, 0 to 1.
    pub correction: f64,
}

/// What a shape needs to be pushed.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// The shape. A static or kinematic one lends its friction and restitution, but is not pushed.
    pub id: ShapeId,
    /// Kilograms, above 0.
    pub mass: f64,
    /// Centre of mass in the shape's frame.
    pub center: DVec3,
    /// Moments of inertia about the shape's axes through the centre, kg m², above 0; `None`: it does not turn.
    pub inertia: Option<DVec3>,
    /// Of the centre, before; `None` is what follows from the shape's.
    pub velocity: Option<DVec3>,
    /// Before; `None` is the shape's.
    pub angular_velocity: Option<DVec3>,
    /// 0 is ice. A contact takes the geometric mean of its two, or the only one.
    pub friction: f64,
    /// 0 does not bounce, 1 loses nothing. A contact takes the greater of its two.
    pub restitution: f64,
}

/// What becomes of a body.
#[derive(Clone, Copy, Debug)]
pub struct BodyChange {
    /// The shape.
    pub id: ShapeId,
    /// Of its centre, after.
    pub velocity: DVec3,
    /// After.
    pub angular_velocity: DVec3,
    /// What to add to its position.
    pub translation: DVec3,
}

/// An impulse at a contact point.
#[derive(Clone, Copy, Debug)]
pub struct Impulse {
    /// The body it acts on.
    pub id: ShapeId,
    /// The other shape; if that is a body too, the opposite acts on it.
    pub other_id: ShapeId,
    /// Where.
    pub point: DVec3,
    /// Friction included, newton seconds.
    pub impulse: DVec3,
}

/// What becomes of bodies in contact.
#[derive(Clone, Debug)]
pub struct Resolved {
    /// `Hit` if bodies touch, `Undecided` if that is not proved of any, `Miss` if all are free.
    pub verdict: Verdict,
    /// One for each body, in order.
    pub changes: Vec<BodyChange>,
    /// What acts where, by ids.
    pub impulses: Vec<Impulse>,
}

impl Snapshot {
    /// How bodies in contact would bounce and be pushed apart. Sensors push nothing.
    ///
    /// # Errors
    /// A shape that is not there, a body that is a half space, [`QuestionError::NeedsDecomposition`],
    /// [`QuestionError::Interrupted`].
    pub fn resolve(
        &self,
        question: &Resolve,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Resolved, QuestionError> {
        let _asking = self.asking().now();
        let mut scene = Scene::default();
        for body in &question.bodies {
            let shape = self.shape(body.id).ok_or(QuestionError::SubjectNotFound(body.id))?;
            scene.add(&shape, Some(body));
        }
        let filter = Filter { exclude_sensors: true, ..filter.clone() };
        let mut contacts = self.contacts_of(&scene, &question.bodies, &filter, accuracy, meter)?;
        contacts.sort_by_key(|(id, contact)| {
            (*id, contact.id, contact.subject_feature.part, contact.feature.part, contact.feature.face)
        });
        for (_, contact) in &contacts {
            if let Some(shape) = contact.id.and_then(|id| self.shape(id)) {
                scene.add(&shape, None);
            }
        }
        let touches: Vec<Touch> = contacts.iter().filter_map(|(id, contact)| scene.touch(*id, contact)).collect();
        let impulses = response::impulses(&mut scene.motions, &touches, question.passes);
        let translations = response::corrections(
            &scene.motions,
            &touches,
            question.allowed_depth,
            question.correction,
            question.passes,
        );
        let verdicts = contacts.iter().map(|(_, contact)| &contact.certificate);
        Ok(Resolved {
            verdict: super::hits::verdict(verdicts),
            changes: scene.changes(&question.bodies, &translations),
            impulses: impulses
                .iter()
                .map(|point| {
                    let touch = &touches[point.touch];
                    Impulse {
                        id: scene.ids[touch.a],
                        other_id: scene.ids[touch.b],
                        point: point.point,
                        impulse: touch.normal * point.normal_impulse + point.friction_impulse,
                    }
                })
                .collect(),
        })
    }

    /// The contacts of all bodies, each with the body it is of; those of two bodies once, of the lower id.
    fn contacts_of(
        &self,
        scene: &Scene,
        bodies: &[Body],
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Vec<(ShapeId, Contact)>, QuestionError> {
        let mut contacts = Vec::new();
        for body in bodies {
            let subject = Subject::Shape { id: body.id, pose: None };
            let question = Penetration { subject, against: None, max_gap: 0.0, max_contacts: CONTACTS_MAX };
            let found = self.penetration(&question, filter, accuracy, meter)?;
            let is_new = |other: ShapeId| other > body.id || !scene.is_body(other);
            let new = found.hits.into_iter().filter(|contact| contact.id.is_some_and(is_new));
            contacts.extend(new.map(|contact| (body.id, contact)));
        }
        Ok(contacts)
    }
}

/// The shapes that take part.
#[derive(Default)]
struct Scene {
    ids: Vec<ShapeId>,
    motions: Vec<Motion>,
    /// Friction and restitution, of bodies.
    surfaces: Vec<Option<(f64, f64)>>,
    places: BTreeMap<ShapeId, usize>,
}

impl Scene {
    /// Adds a shape, unless it is there.
    fn add(&mut self, shape: &Shape, body: Option<&Body>) {
        if self.places.contains_key(&shape.id) {
            return;
        }
        self.places.insert(shape.id, self.ids.len());
        self.ids.push(shape.id);
        self.surfaces.push(body.map(|body| (body.friction, body.restitution)));
        let motion = match body.filter(|_| shape.mobility == Mobility::Dynamic) {
            None => Motion::unmoved(shape.pose.position, shape.velocity, shape.angular_velocity),
            Some(body) => {
                let mut motion = Motion::of_body(&shape.pose, body.mass, body.center, body.inertia);
                motion.angular_velocity = body.angular_velocity.unwrap_or(shape.angular_velocity);
                let arm = motion.center - shape.pose.position;
                motion.velocity = body.velocity.unwrap_or_else(|| shape.velocity + shape.angular_velocity.cross(arm));
                motion
            }
        };
        self.motions.push(motion);
    }

    fn is_body(&self, id: ShapeId) -> bool {
        self.places.get(&id).is_some_and(|&place| self.surfaces[place].is_some())
    }

    /// A contact as the response sees it: it acts halfway between its two points.
    fn touch(&self, id: ShapeId, contact: &Contact) -> Option<Touch> {
        let (&a, &b) = (self.places.get(&id)?, self.places.get(&contact.id?)?);
        let (friction, restitution) = match (self.surfaces[a], self.surfaces[b]) {
            (Some((first, bounce)), Some((second, other_bounce))) => {
                ((first * second).sqrt(), bounce.max(other_bounce))
            }
            (Some(surface), None) | (None, Some(surface)) => surface,
            (None, None) => return None,
        };
        let points = contact.points.iter().map(|point| point.point_on_a * 0.5 + point.point_on_b * 0.5);
        Some(Touch {
            a,
            b,
            normal: contact.normal,
            depth: contact.depth,
            points: points.collect(),
            friction,
            restitution,
        })
    }

    fn changes(&self, bodies: &[Body], translations: &[DVec3]) -> Vec<BodyChange> {
        let change = |body: &Body| {
            let place = self.places[&body.id];
            let motion = &self.motions[place];
            BodyChange {
                id: body.id,
                velocity: motion.velocity,
                angular_velocity: motion.angular_velocity,
                translation: translations[place],
            }
        };
        bodies.iter().map(change).collect()
    }
}
