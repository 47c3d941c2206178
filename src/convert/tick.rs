//! What became of shapes in a tick, as it is kept: as edits of single shapes.

use std::sync::Arc;

use collision::{DQuat, DVec3, shape::Geometry, world::Edit};
use wire::v1::{self as pb, edit::Op};

use super::shape::shape_out;

/// A tick.
pub(crate) fn tick_out(edits: &[Edit]) -> pb::ReplayTick {
    pb::ReplayTick { edits: edits.iter().map(|edit| pb::Edit { op: Some(op_out(edit)) }).collect() }
}

/// The geometry that an edit brings.
pub(crate) fn geometry(edit: &Edit) -> Option<&Arc<Geometry>> {
    match edit {
        Edit::Insert(shape) => Some(&shape.geometry),
        Edit::Move { .. } | Edit::Remove(_) | Edit::Clear => None,
    }
}

fn op_out(edit: &Edit) -> Op {
    let vector = |DVec3 { x, y, z }: DVec3| pb::Vec3 { x, y, z };
    match edit {
        Edit::Insert(shape) => Op::Insert(shape_out(shape)),
        Edit::Move { id, position, rotation, velocity, angular_velocity, teleport } => Op::Move(pb::Move {
            id: id.get(),
            pose: Some(pb::Pose {
                position: position.map(vector),
                rotation: rotation.map(|DQuat { x, y, z, w }| pb::Quat { x, y, z, w }),
            }),
            velocity: velocity.map(vector),
            angular_velocity: angular_velocity.map(vector),
            teleport: *teleport,
        }),
        Edit::Remove(id) => Op::Remove(pb::Remove { ids: vec![id.get()] }),
        Edit::Clear => Op::Clear(pb::Clear {}),
    }
}
