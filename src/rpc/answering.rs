//! Where a single question is answered: where it came in, or on a thread of its own.
//!
//! # Method
//! Most questions take microseconds, less than handing them over does. What surely takes long is handed over at once: what reads many
//! ticks or all shapes, comes in a large message, or is about a form of many pieces. Any other that turns out to take long is begun
//! again there: questions change nothing. So who shares a thread with long questions waits for a few milliseconds at most.
//!
//! # Limits
//! Whether a question takes long is looked at between pairs of shapes. The pieces of one pair, such as a large box and a mesh, are tested
//! at one go.

use collision::{
    shape::{Form, Geometry},
    world::ShapeId,
};
use wire::v1::{self as pb, geometry::Kind, subject};

use super::scene::{Asking, Patience, Scene};
use crate::{
    compute::{self, AtWork, Weight},
    fence::fenced,
    problem::{Checked, Reason},
};

/// Questions about forms of more pieces are handed over.
const PIECES: usize = 1024;
/// What a question is said to do where it panics.
pub(super) const ANSWERING: &str = "answering a question";

/// What tells how long a question takes before it is asked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hint<'a> {
    weight: Weight,
    subject: Option<&'a pb::Subject>,
}

impl<'a> Hint<'a> {
    /// What the kind of a question tells, and what it is about.
    pub(super) fn of<Q: Asking>(asked: &'a Q) -> Self {
        Self { weight: Q::WEIGHT, subject: asked.subject() }
    }

    /// And its size.
    pub(super) fn of_message<Q: Asking>(asked: &'a Q) -> Self {
        let hint = Self::of(asked);
        if Q::WEIGHT == Weight::Heavy { hint } else { Self { weight: Weight::of_message(asked.encoded_len()), ..hint } }
    }

    fn is_long(&self, scene: &Scene) -> bool {
        self.weight == Weight::Heavy || self.subject.is_some_and(|subject| is_large(subject, scene))
    }
}

/// Answers a question, behind the fence.
///
/// # Errors
/// The question's own, or it panicked.
pub(super) async fn answered<Q: Clone + Send + 'static, A: Send + 'static>(
    hint: &Hint<'_>,
    asked: &Q,
    scene: &Scene,
    answer: fn(&Q, &Scene) -> Checked<A>,
) -> Checked<A> {
    if !hint.is_long(scene) {
        let _at_work = AtWork::begin();
        let answered = fenced(ANSWERING, || answer(asked, scene))?;
        match answered {
            // It was interrupted before its deadline: its thread is needed.
            Err(problem) if problem.is(Reason::Deadline) && scene.deadline.is_ahead() => {}
            answered => return answered,
        }
    }
    let (asked, scene) = (asked.clone(), Scene { patience: Patience::Endless, ..scene.clone() });
    // Boxed, as otherwise every question would carry the room that this needs.
    Box::pin(compute::run(Weight::Heavy, ANSWERING, move || answer(&asked, &scene))).await
}

fn is_large(subject: &pb::Subject, scene: &Scene) -> bool {
    match &subject.form {
        Some(subject::Form::Id(id)) => {
            let shape = ShapeId::new(*id).and_then(|id| scene.snapshot.shape(id));
            shape.is_some_and(|shape| pieces(&shape.geometry) > PIECES)
        }
        Some(subject::Form::Geometry(pb::Geometry { kind: Some(Kind::GeometryId(id)), .. })) => {
            scene.session.geometries.get(id).is_ok_and(|geometry| pieces(&geometry) > PIECES)
        }
        // What is sent along is as large as its message.
        Some(subject::Form::Geometry(_)) | None => false,
    }
}

fn pieces(geometry: &Geometry) -> usize {
    match geometry.form() {
        Form::Convex(_) | Form::HalfSpace(_) => 1,
        Form::Mesh(mesh) => mesh.sent_count(),
        Form::Compound(compound) => compound.leaf_count() as usize,
        Form::HeightField(field) => field.cell_count(),
    }
}

#[cfg(test)]
mod tests {
    use std::{sync::Arc, thread};

    use collision::{
        DVec3,
        math::Pose,
        world::{Means, Settings as WorldSettings, Shape, Tick, Time, World},
    };

    use super::*;
    use crate::{
        geometries::{Geometries, Quotas},
        rpc::overlap,
    };

    /// Balls in one place.
    fn scene(count: u64) -> Scene {
        let ball = Arc::new(Geometry::sphere(1.0).unwrap());
        let ids = (1..=count).filter_map(ShapeId::new);
        let balls = ids.map(|id| Shape::new(id, Arc::clone(&ball), Pose::at(DVec3::X * 1e-6 * id.get() as f64)));
        let world = World::holding(balls, Tick::MIN, Time(0), WorldSettings::default(), Means::default());
        Scene { patience: Patience::Short, ..Scene::alone(world, Geometries::new(Quotas::NONE)) }
    }

    /// What touches a ball there, and the name of the thread that found it.
    fn touching(asked: &pb::OverlapRequest, scene: &Scene) -> Checked<(usize, Option<String>)> {
        Ok((overlap::answer(asked, scene)?.hits.len(), thread::current().name().map(ToOwned::to_owned)))
    }

    async fn ask(scene: &Scene) -> (usize, bool) {
        let geometry = pb::Geometry { kind: Some(Kind::Sphere(pb::Sphere { radius: 1.0 })), ..pb::Geometry::default() };
        let form = Some(subject::Form::Geometry(geometry));
        let subject = Some(pb::Subject { form, ..pb::Subject::default() });
        let asked = pb::OverlapRequest { subject, max_hits: 65_536, ..pb::OverlapRequest::default() };
        let (count, name) = answered(&Hint::of(&asked), &asked, scene, touching).await.unwrap();
        (count, name == thread::current().name().map(ToOwned::to_owned))
    }

    #[tokio::test]
    async fn what_takes_long_is_answered_elsewhere_and_counted_once() {
        let few = scene(100);
        assert_eq!(ask(&few).await, (100, true));
        let many = scene(10_000);
        assert_eq!(ask(&many).await, (10_000, false));
        assert_eq!(many.session.counters.questions.load(std::sync::atomic::Ordering::Relaxed), 1);
    }
}
