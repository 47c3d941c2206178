//! Shapes: wire to checked shapes, and those back.

use collision::{
    DVec3,
    math::Pose,
    world::{Mobility, Shape},
};
use wire::v1 as pb;

use super::{
    geometry::{geometry_out, of_shape},
    number::{shape_id, unknown_enum},
    place::{pose, pose_out, position},
};
use crate::{
    geometries::Geometries,
    problem::{Checked, Problem, Reason, Under},
};

/// A shape.
///
/// # Errors
/// What is wrong with it, or not served yet.
pub(crate) fn shape(sent: &pb::Shape, known: &Geometries) -> Checked<Shape> {
    let id = shape_id("id", sent.id)?;
    let like = like(sent, known)?;
    let pose = pose(sent.pose.as_ref(), Pose::IDENTITY).under("pose")?;
    Ok(Shape { id, pose, ..like })
}

/// A shape without regard to its id and pose: what many shapes have in common.
///
/// # Errors
/// What is wrong with it, or not served yet.
pub(crate) fn like(sent: &pb::Shape, known: &Geometries) -> Checked<Shape> {
    let Some(form) = &sent.geometry else {
        let what = "is absent: a shape needs one, such as {\"sphere\": {\"radius\": 1}}";
        return Err(Problem::at("geometry", Reason::Missing, what));
    };
    if sent.time_to_live.is_some() {
        let what = "is not served yet: a later version will remove the shape by itself; leave it out, and remove the \
                    shape with an edit";
        return Err(Problem::at("time_to_live", Reason::NotYet, what));
    }
    Ok(Shape {
        id: collision::world::ShapeId::MIN,
        geometry: of_shape(form, known).under("geometry")?,
        pose: Pose::IDENTITY,
        layers: sent.layers.unwrap_or(1),
        collides_with: sent.collides_with.unwrap_or(u32::MAX),
        mobility: mobility(sent.mobility)?,
        bullet: sent.bullet,
        sensor: sent.sensor,
        group: sent.group,
        user_data: sent.user_data,
        velocity: position(sent.velocity.as_ref(), DVec3::ZERO).under("velocity")?,
        angular_velocity: position(sent.angular_velocity.as_ref(), DVec3::ZERO).under("angular_velocity")?,
    })
}

fn mobility(sent: i32) -> Checked<Mobility> {
    match pb::Mobility::try_from(sent) {
        Ok(pb::Mobility::Unspecified | pb::Mobility::Dynamic) => Ok(Mobility::Dynamic),
        Ok(pb::Mobility::Static) => Ok(Mobility::Static),
        Ok(pb::Mobility::Kinematic) => Ok(Mobility::Kinematic),
        Err(_) => {
            Err(unknown_enum("mobility", sent, "MOBILITY_STATIC (1), MOBILITY_DYNAMIC (2), MOBILITY_KINEMATIC (3)"))
        }
    }
}

/// A shape as it is sent. Fields at their defaults are left out where that says the same.
pub(crate) fn shape_out(shape: &Shape) -> pb::Shape {
    let mobility = match shape.mobility {
        Mobility::Static => pb::Mobility::Static,
        Mobility::Dynamic => pb::Mobility::Dynamic,
        Mobility::Kinematic => pb::Mobility::Kinematic,
    };
    pb::Shape {
        id: shape.id.get(),
        geometry: Some(geometry_out(&shape.geometry)),
        pose: Some(pose_out(&shape.pose)),
        layers: Some(shape.layers),
        collides_with: Some(shape.collides_with),
        mobility: mobility.into(),
        bullet: shape.bullet,
        sensor: shape.sensor,
        user_data: shape.user_data,
        velocity: velocity_out(shape.velocity),
        angular_velocity: velocity_out(shape.angular_velocity),
        time_to_live: None,
        group: shape.group,
    }
}

fn velocity_out(velocity: DVec3) -> Option<pb::Vec3> {
    (velocity != DVec3::ZERO).then_some(pb::Vec3 { x: velocity.x, y: velocity.y, z: velocity.z })
}
