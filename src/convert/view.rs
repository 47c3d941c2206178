//! What a viewer is to see: wire to a checked view; what it sees, back.

use collision::{
    DVec3,
    broad::NodeBox,
    world::{Shape, View, ViewChanges},
};
use wire::v1::{self as pb, geometry::Kind};

use super::{
    number::count,
    place::{aabb, vec3_out},
    question::filter,
    shape::shape_out,
};
use crate::{
    geometries::id_text,
    problem::{Checked, Under},
};

/// Messages a second at most, and if nothing is said.
const RATE_MAX: usize = 120;
const RATE: usize = 30;
/// Boxes of nodes of one tree: 28 bytes each.
pub(crate) const NODES_OF_A_TREE: usize = 16_384;
/// Rows of one message: about 300 bytes each, 80, and 8.
const INSERTED: usize = 2048;
const MOVED: usize = 8192;
const REMOVED: usize = 16_384;

/// What a viewer is to see, and how many messages a second.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn view(sent: &pb::WatchWorldRequest) -> Checked<(View, usize)> {
    let bounds = sent.bounds.as_ref().map(aabb).transpose().under("bounds")?;
    let filter = filter(sent.filter.as_ref()).under("filter")?;
    Ok((View { bounds, filter }, count("max_rate", sent.max_rate, RATE, RATE_MAX)?))
}

/// What is shown at a time, in as many messages as it takes.
#[derive(Debug)]
pub(crate) struct Shown {
    changes: ViewChanges,
    nodes: Option<pb::NodeColumns>,
    number: usize,
}

impl Shown {
    /// What changed, and the trees if they did.
    pub(crate) fn new(changes: ViewChanges, nodes: Option<pb::NodeColumns>) -> Self {
        Self { changes, nodes, number: 0 }
    }

    /// The next message: the last one does not say that more follow.
    ///
    /// # Errors
    /// A number is not finite, which is a fault of the server.
    pub(crate) fn next(&mut self) -> Checked<pb::WatchWorldResponse> {
        let ViewChanges { inserted, moved, removed } = &self.changes;
        let counts = [(inserted.len(), INSERTED), (moved.len(), MOVED), (removed.len(), REMOVED)];
        let number = self.number;
        self.number += 1;
        Ok(pb::WatchWorldResponse {
            more: counts.into_iter().any(|(count, most)| count > self.number * most),
            inserted: part(inserted, number, INSERTED).iter().map(inserted_out).collect(),
            moved: moved_out(part(moved, number, MOVED))?,
            removed: part(removed, number, REMOVED).iter().map(|id| id.get()).collect(),
            nodes: self.nodes.take(),
            ..pb::WatchWorldResponse::default()
        })
    }
}

fn part<T>(all: &[T], number: usize, most: usize) -> &[T] {
    let begin = all.len().min(number * most);
    &all[begin..all.len().min(begin + most)]
}

fn inserted_out(shape: &Shape) -> pb::Shape {
    let kind = Some(Kind::GeometryId(id_text(shape.geometry.id())));
    pb::Shape { geometry: Some(pb::Geometry { kind, ..pb::Geometry::default() }), ..shape_out(shape) }
}

/// Positions are relative to that of the first.
fn moved_out(moved: &[Shape]) -> Checked<Option<pb::MoveColumns>> {
    let Some(first) = moved.first() else { return Ok(None) };
    let origin = first.pose.position;
    let near = moved.iter().map(|shape| shape.pose.position - origin);
    let rotations = moved.iter().flat_map(|shape| shape.pose.unit_rotation().to_array());
    let poses = pb::PoseColumns {
        frame_origin: Some(vec3_out(origin)?),
        positions: column(near),
        rotations: rotations.map(|value| value as f32).collect(),
    };
    Ok(Some(pb::MoveColumns {
        ids: moved.iter().map(|shape| shape.id.get()).collect(),
        poses: Some(poses),
        velocities: column(moved.iter().map(|shape| shape.velocity)),
        angular_velocities: column(moved.iter().map(|shape| shape.angular_velocity)),
        teleport: false,
    }))
}

fn column(vectors: impl Iterator<Item = DVec3>) -> Vec<f32> {
    vectors.flat_map(|vector| vector.to_array()).map(|value| value as f32).collect()
}

/// Boxes of nodes, relative to the lower corner of the first.
///
/// # Errors
/// As [`Shown::next`].
pub(crate) fn nodes(boxes: &[NodeBox]) -> Checked<pb::NodeColumns> {
    let origin = boxes.first().map_or(DVec3::ZERO, |found| found.bounds.min);
    Ok(pb::NodeColumns {
        frame_origin: Some(vec3_out(origin)?),
        mins: column(boxes.iter().map(|found| found.bounds.min - origin)),
        maxs: column(boxes.iter().map(|found| found.bounds.max - origin)),
        levels: boxes.iter().map(|found| found.level).collect(),
    })
}
