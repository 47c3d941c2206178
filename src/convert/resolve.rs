//! Bodies in contact: what is given of them, and what becomes of them.

use collision::{
    DVec3,
    world::{Body, Impulse, Resolve, Resolved, ShapeId, Snapshot},
};
use wire::v1 as pb;

use super::{
    number::{FROM_ZERO_TO_REACH, REACH, at_most, count, finite, shape_id, within},
    place::{position, vec3_out},
    question::shape_not_found,
};
use crate::problem::{Checked, Problem, Reason, Under};

/// Most bodies of a question.
const BODIES: usize = 1024;
/// Largest mass, moment, speed and factor.
const MOST: f64 = 1e15;

/// A question about bodies, which are there at the version that is read.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn resolve(sent: &pb::ResolveRequest, world: &Snapshot) -> Checked<Resolve> {
    at_most("bodies", sent.bodies.len(), BODIES)?;
    let mut bodies: Vec<Body> = Vec::with_capacity(sent.bodies.len());
    let mut ids: Vec<ShapeId> = Vec::with_capacity(sent.bodies.len());
    for (index, sent) in sent.bodies.iter().enumerate() {
        let body = body(sent, world).under_item("bodies", index)?;
        ids.push(body.id);
        bodies.push(body);
    }
    ids.sort_unstable();
    if let Some(twice) = ids.windows(2).find(|pair| pair[0] == pair[1]) {
        let what = format!("holds shape {} twice: each body counts once, so leave one out", twice[0]);
        return Err(Problem::at("bodies", Reason::OutOfLimits, what).with_shape(twice[0].get()));
    }
    Ok(Resolve {
        bodies,
        passes: count("passes", sent.passes, 8, 64)? as u32,
        allowed_depth: within("allowed_depth", sent.allowed_depth, 0.0..=REACH, FROM_ZERO_TO_REACH)?,
        correction: within("correction", sent.correction.unwrap_or(1.0), 0.0..=1.0, "0 to 1")?,
    })
}

fn body(sent: &pb::Body, world: &Snapshot) -> Checked<Body> {
    let id = shape_id("id", sent.id)?;
    if world.shape(id).is_none() {
        return Err(shape_not_found("id", id.get(), world.tick()));
    }
    let positive = |field, value: f64| match (1.0 / MOST..=MOST).contains(&finite(field, value)?) {
        true => Ok(value),
        false => Err(Problem::at(field, Reason::OutOfLimits, format!("is {value}: it must be above 0, 1e-15 to 1e15"))),
    };
    let inertia =
        |sent: &pb::Vec3| Ok(DVec3::new(positive("x", sent.x)?, positive("y", sent.y)?, positive("z", sent.z)?));
    let speed = |field, sent: Option<&pb::Vec3>| match sent {
        Some(_) => position(sent, DVec3::ZERO).under(field).map(Some),
        None => Ok(None),
    };
    Ok(Body {
        id,
        mass: positive("mass", sent.mass)?,
        center: position(sent.center.as_ref(), DVec3::ZERO).under("center")?,
        inertia: sent.inertia.as_ref().map(inertia).transpose().under("inertia")?,
        velocity: speed("velocity", sent.velocity.as_ref())?,
        angular_velocity: speed("angular_velocity", sent.angular_velocity.as_ref())?,
        friction: within("friction", sent.friction, 0.0..=MOST, "0 to 1e15")?,
        restitution: within("restitution", sent.restitution, 0.0..=1.0, "0 to 1")?,
    })
}

/// What becomes of bodies; who sends it adds what was read.
///
/// # Errors
/// A number is not finite, which is a fault of the server.
pub(crate) fn resolved(resolved: &Resolved) -> Checked<pb::ResolveResponse> {
    let changes = resolved.changes.iter().map(|change| {
        Ok(pb::BodyChange {
            id: change.id.get(),
            velocity: Some(vec3_out(change.velocity)?),
            angular_velocity: Some(vec3_out(change.angular_velocity)?),
            translation: Some(vec3_out(change.translation)?),
        })
    });
    let impulse = |impulse: &Impulse| {
        Ok(pb::Impulse {
            id: impulse.id.get(),
            other_id: impulse.other_id.get(),
            point: Some(vec3_out(impulse.point)?),
            impulse: Some(vec3_out(impulse.impulse)?),
        })
    };
    Ok(pb::ResolveResponse {
        changes: changes.collect::<Checked<_>>()?,
        impulses: resolved.impulses.iter().map(impulse).collect::<Checked<_>>()?,
        info: None,
    })
}
