//! Builds questions.
//!
//! A question is the wire's own request; what these functions leave out has the default that the `.proto` names. More is
//! set on the message itself:
//!
//! ```
//! use calipers_client::{ask, geometry, proto};
//!
//! let mut all = ask::ray([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
//! all.mode = proto::HitMode::All.into();
//! all.max_distance = Some(100.0);
//! all.options = Some(ask::seeing_tick(7));
//!
//! let near = ask::distance(ask::form_at(geometry::sphere(0.5), [0.0, 1.0, 0.0]));
//! assert_eq!(near.max_hits, 0);
//! ```

use crate::proto::{self, question, read_at, subject::Form};
use crate::{quat, vec3};

/// A ray: the closest hit from `origin` along `direction`, which may have any length but 0.
pub fn ray(origin: [f64; 3], direction: [f64; 3]) -> proto::RaycastRequest {
    proto::RaycastRequest {
        origin: Some(vec3(origin)),
        direction: Some(vec3(direction)),
        ..proto::RaycastRequest::default()
    }
}

/// A ray that goes through sensors and shapes on these layers: what it meets up to the first that blocks, and that at the end.
///
/// ```
/// use calipers_client::ask;
///
/// const GLASS: u32 = 0b10;
/// let shot = ask::piercing_ray([0.0; 3], [0.0, 0.0, 1.0], GLASS);
/// assert_eq!(shot.pierce_layers, Some(GLASS));
/// ```
pub fn piercing_ray(origin: [f64; 3], direction: [f64; 3], pierce_layers: u32) -> proto::RaycastRequest {
    proto::RaycastRequest {
        mode: proto::HitMode::Pierce.into(),
        pierce_layers: Some(pierce_layers),
        ..ray(origin, direction)
    }
}

/// Which shapes of the world touch the subject.
pub fn overlap(subject: proto::Subject) -> proto::OverlapRequest {
    proto::OverlapRequest { subject: Some(subject), ..proto::OverlapRequest::default() }
}

/// How deep shapes of the world and the subject overlap.
pub fn penetration(subject: proto::Subject) -> proto::PenetrationRequest {
    proto::PenetrationRequest { subject: Some(subject), ..proto::PenetrationRequest::default() }
}

/// What the subject touches first on its straight way to the position `end`, keeping its rotation.
pub fn time_of_impact(subject: proto::Subject, end: [f64; 3]) -> proto::TimeOfImpactRequest {
    proto::TimeOfImpactRequest {
        subject: Some(subject),
        end: Some(proto::Pose { position: Some(vec3(end)), rotation: None }),
        ..proto::TimeOfImpactRequest::default()
    }
}

/// The shape of the world nearest to the subject.
pub fn distance(subject: proto::Subject) -> proto::DistanceRequest {
    proto::DistanceRequest { subject: Some(subject), ..proto::DistanceRequest::default() }
}

/// The way out of everything that the subject overlaps, ending `gap` metres from it.
pub fn depenetrate(subject: proto::Subject, gap: f64) -> proto::DepenetrateRequest {
    proto::DepenetrateRequest { subject: Some(subject), gap, ..proto::DepenetrateRequest::default() }
}

/// When the subject first touched something of the world, from this tick on, up to the newest.
pub fn first_touch(subject: proto::Subject, from_tick: u64) -> proto::FirstTouchRequest {
    proto::FirstTouchRequest { subject: Some(subject), from_tick, ..proto::FirstTouchRequest::default() }
}

/// Which of its targets' points each eye sees; a target is the list of its points. Positions are relative to `frame_origin` of the
/// request, which is 0 unless it is set.
///
/// ```
/// use calipers_client::ask;
///
/// let (eye, head, feet) = ([0.0, 1.7, 0.0], [9.0, 1.7, 0.0], [9.0, 0.1, 0.0]);
/// let look = ask::line_of_sight(&[eye], &[vec![head, feet], vec![[3.0, 1.0, 4.0]]]);
/// assert_eq!(look.offsets, [0, 2, 3]);
/// ```
pub fn line_of_sight(eyes: &[[f32; 3]], targets: &[Vec<[f32; 3]>]) -> proto::LineOfSightRequest {
    let mut offsets = vec![0];
    let mut points = Vec::new();
    for target in targets {
        points.extend(target.iter().flatten());
        // More than a message has room for is refused by the server.
        offsets.push(u32::try_from(points.len() / 3).unwrap_or(u32::MAX));
    }
    proto::LineOfSightRequest {
        eyes: eyes.iter().flatten().copied().collect(),
        points,
        offsets,
        ..proto::LineOfSightRequest::default()
    }
}

/// A subject that is a shape of the world, where it stands; it does not see itself.
pub fn shape(id: u64) -> proto::Subject {
    proto::Subject { form: Some(Form::Id(id)), pose: None }
}

/// A subject that is a point.
pub fn point(position: [f64; 3]) -> proto::Subject {
    proto::Subject { form: None, pose: Some(proto::Pose { position: Some(vec3(position)), rotation: None }) }
}

/// A subject that is a form, not in the world, at a position.
pub fn form_at(geometry: proto::Geometry, position: [f64; 3]) -> proto::Subject {
    let pose = proto::Pose { position: Some(vec3(position)), rotation: None };
    proto::Subject { form: Some(Form::Geometry(geometry)), pose: Some(pose) }
}

/// A subject that is a form, not in the world, placed and turned; the rotation is a quaternion `[x, y, z, w]`.
pub fn form_turned(geometry: proto::Geometry, position: [f64; 3], rotation: [f64; 4]) -> proto::Subject {
    let pose = proto::Pose { position: Some(vec3(position)), rotation: Some(quat(rotation)) };
    proto::Subject { form: Some(Form::Geometry(geometry)), pose: Some(pose) }
}

/// Options of a question that reads the newest tick once it is at least `min_tick`: read your own writes.
pub fn seeing_tick(min_tick: u64) -> Box<proto::QueryOptions> {
    let read_at = proto::ReadAt { at: Some(read_at::At::MinTick(min_tick)), tick_fraction: 0.0 };
    Box::new(proto::QueryOptions { read_at: Some(read_at), ..proto::QueryOptions::default() })
}

/// Options of a question that reads exactly this tick, as it was.
pub fn at_tick(tick: u64) -> Box<proto::QueryOptions> {
    between_ticks(tick, 0.0)
}

/// Options of a question that reads the moment between this tick and the next, `fraction` of the way on, from 0 to below 1:
/// poses are interpolated.
///
/// ```
/// use calipers_client::ask;
///
/// let mut ray = ask::ray([0.0; 3], [0.0, 0.0, 1.0]);
/// ray.options = Some(ask::between_ticks(41, 0.5));
/// ```
pub fn between_ticks(tick: u64, fraction: f64) -> Box<proto::QueryOptions> {
    let read_at = proto::ReadAt { at: Some(read_at::At::Tick(tick)), tick_fraction: fraction };
    Box::new(proto::QueryOptions { read_at: Some(read_at), ..proto::QueryOptions::default() })
}

/// Options of a question that reads the state at a time; after the newest tick that is the newest.
pub fn at_time(time: std::time::SystemTime) -> Box<proto::QueryOptions> {
    let read_at = proto::ReadAt { at: Some(read_at::At::Time(time.into())), tick_fraction: 0.0 };
    Box::new(proto::QueryOptions { read_at: Some(read_at), ..proto::QueryOptions::default() })
}

/// Options of a question in the exact tier, which goes on until the interval cannot get narrower.
pub fn exactly() -> Box<proto::QueryOptions> {
    let accuracy = proto::Accuracy { tier: proto::Tier::Exact.into(), ..proto::Accuracy::default() };
    Box::new(proto::QueryOptions { accuracy: Some(accuracy), ..proto::QueryOptions::default() })
}

/// A batch of questions of any kinds, answered on one tick. Their sessions and versions stay empty: those of the batch hold.
///
/// ```
/// use calipers_client::{ask, proto::question::Question};
///
/// let batch = ask::batch([
///     Question::from(ask::ray([0.0; 3], [0.0, 0.0, 1.0])),
///     Question::from(ask::distance(ask::point([0.0; 3]))),
/// ]);
/// assert_eq!(batch.questions.len(), 2);
/// ```
pub fn batch(questions: impl IntoIterator<Item = question::Question>) -> proto::BatchRequest {
    proto::BatchRequest {
        questions: questions.into_iter().map(|question| proto::Question { question: Some(question) }).collect(),
        ..proto::BatchRequest::default()
    }
}
