//! Questions as they are told to those who watch them; an item of a call with columns as the single question that it stands for.

use collision::{math::Pose, narrow::Ray, world::ShapeId};
use prost::Message;
use wire::v1::{self as pb, answer::Answer as Kind, question::Question as Asked, subject::Form};

use super::place::pose_out;
use crate::problem::Checked;

/// Larger questions and answers are not told: those who watch get 256 in a message.
const LARGEST_BYTES: usize = 16 * 1024;

/// A question and its answer, or why there is none; `None` if it is too large to be told.
pub(crate) fn trace(asked: Asked, answered: Checked<Kind>) -> Option<pb::Trace> {
    let kind = answered.unwrap_or_else(|problem| Kind::Problem(problem.into_wire()));
    let trace = pb::Trace {
        question: Some(pb::Question { question: Some(asked) }),
        answer: Some(pb::Answer { answer: Some(kind) }),
    };
    (trace.encoded_len() <= LARGEST_BYTES).then_some(trace)
}

/// A ray of a batch, which does not see a shape.
pub(crate) fn ray(sent: &pb::RaycastBatchRequest, ray: &Ray, ignored: Option<ShapeId>) -> Asked {
    Asked::from(pb::RaycastRequest {
        mode: sent.mode,
        hollow: sent.hollow,
        faces: sent.faces,
        options: past(sent.options.clone(), ignored),
        ..along(ray)
    })
}

/// How an eye looks at a point, past what both are: what is hit hides the point.
pub(crate) fn sight(sent: &pb::LineOfSightRequest, ray: &Ray, own: impl IntoIterator<Item = ShapeId>) -> Asked {
    let mut options = past(sent.options.clone(), own).unwrap_or_default();
    options.filter.get_or_insert_default().exclude_sensors = true;
    Asked::from(pb::RaycastRequest { mode: pb::HitMode::Any.into(), options: Some(options), ..along(ray) })
}

fn along(ray: &Ray) -> pb::RaycastRequest {
    let vector = |vector: collision::DVec3| Some(pb::Vec3 { x: vector.x, y: vector.y, z: vector.z });
    pb::RaycastRequest {
        origin: vector(ray.origin),
        direction: vector(ray.direction),
        max_distance: Some(ray.max_distance),
        ..pb::RaycastRequest::default()
    }
}

/// Options that leave out these shapes too.
fn past(
    options: Option<Box<pb::QueryOptions>>,
    ignored: impl IntoIterator<Item = ShapeId>,
) -> Option<Box<pb::QueryOptions>> {
    let mut ignored = ignored.into_iter().map(ShapeId::get).peekable();
    if ignored.peek().is_none() {
        return options;
    }
    let mut options = options.unwrap_or_default();
    options.filter.get_or_insert_default().exclude_ids.extend(ignored);
    Some(options)
}

/// A place of a batch: what touches the geometry there?
pub(crate) fn overlap(sent: &pb::OverlapBatchRequest, index: usize, pose: &Pose) -> Asked {
    let mut subject = subject(sent.geometry.as_ref(), pose);
    let scale = if sent.scales.len() == 1 { sent.scales.first() } else { sent.scales.get(index) };
    if let (Some(Form::Geometry(geometry)), Some(&scale)) = (&mut subject.form, scale) {
        geometry.scale = Some(geometry.scale.unwrap_or(1.0) * f64::from(scale));
    }
    Asked::from(pb::OverlapRequest {
        subject: Some(subject),
        max_hits: if sent.max_hits_each == 0 { 32 } else { sent.max_hits_each },
        options: sent.options.clone(),
        ..pb::OverlapRequest::default()
    })
}

/// A place of a batch: what is nearest to the geometry there?
pub(crate) fn distance(sent: &pb::DistanceBatchRequest, pose: &Pose, max_distance: f64) -> Asked {
    Asked::from(pb::DistanceRequest {
        subject: Some(subject(sent.geometry.as_ref(), pose)),
        max_distance: Some(max_distance),
        options: sent.options.clone(),
        ..pb::DistanceRequest::default()
    })
}

/// A way of a batch.
pub(crate) fn time_of_impact(sent: &pb::TimeOfImpactBatchRequest, start: &Pose, end: &Pose) -> Asked {
    Asked::from(pb::TimeOfImpactRequest {
        subject: Some(subject(sent.geometry.as_ref(), start)),
        end: Some(pose_out(end)),
        ignore_initial: sent.ignore_initial,
        options: sent.options.clone(),
        ..pb::TimeOfImpactRequest::default()
    })
}

/// Without a geometry it is a point.
fn subject(geometry: Option<&pb::Geometry>, pose: &Pose) -> pb::Subject {
    pb::Subject { form: geometry.cloned().map(Form::Geometry), pose: Some(pose_out(pose)) }
}
