//! One version of a world: its shapes and the trees over them.

use std::{num::NonZeroU64, sync::Arc};

use glam::DVec3;

use super::state::State;
use crate::{
    math::{Aabb, Pose},
    shape::Geometry,
};

/// The id of a shape, chosen by the client; never 0.
pub type ShapeId = NonZeroU64;

/// The version number of a world; the first is 1.
pub type Tick = NonZeroU64;

/// When a tick was made, as nanoseconds since 1970 that the caller read from its clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Time(pub i64);

/// How a shape takes part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mobility {
    /// Seldom moves: kept in the static tree.
    Static,
    /// Moves: kept in the dynamic tree.
    #[default]
    Dynamic,
    /// Moves by a will of its own: kept in the dynamic tree.
    Kinematic,
}

/// A geometry placed in a world.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Its id.
    pub id: ShapeId,
    /// Its form.
    pub geometry: Arc<Geometry>,
    /// Where it is.
    pub pose: Pose,
    /// Layers it is on, a bit for each.
    pub layers: u32,
    /// Layers it overlaps with.
    pub collides_with: u32,
    /// How it takes part.
    pub mobility: Mobility,
    /// Overlaps are reported, but it blocks nothing.
    pub sensor: bool,
    /// Shapes of the same group are never a pair; 0 is none.
    pub group: u32,
    /// The client's.
    pub user_data: u64,
    /// Metres a second.
    pub velocity: DVec3,
    /// Radians a second about the world's axes.
    pub angular_velocity: DVec3,
}

impl Shape {
    /// A dynamic shape on the first layer that wants all others.
    #[must_use]
    pub fn new(id: ShapeId, geometry: Arc<Geometry>, pose: Pose) -> Self {
        Self {
            id,
            geometry,
            pose,
            layers: 1,
            collides_with: u32::MAX,
            mobility: Mobility::Dynamic,
            sensor: false,
            group: 0,
            user_data: 0,
            velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
        }
    }
}

/// One version of a world. It never changes; any number of readers question it at once without waiting.
#[derive(Debug)]
pub struct Snapshot {
    pub(super) tick: Tick,
    pub(super) time: Time,
    pub(super) state: State,
}

impl Snapshot {
    /// Its version.
    #[must_use]
    pub fn tick(&self) -> Tick {
        self.tick
    }

    /// When it was made.
    #[must_use]
    pub fn time(&self) -> Time {
        self.time
    }

    /// How many shapes it holds.
    #[must_use]
    pub fn len(&self) -> usize {
        self.state.shapes.len()
    }

    /// Whether it holds none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A shape.
    #[must_use]
    pub fn shape(&self, id: ShapeId) -> Option<&Shape> {
        self.state.get(id).map(|entry| &entry.shape)
    }

    /// The canonical box of a shape, rounded outwards, metres.
    #[must_use]
    pub fn bounds_of(&self, id: ShapeId) -> Option<Aabb> {
        self.state.get(id).map(|entry| entry.bounds)
    }

    /// Shapes after `after`, by id; all from the first with `None`. At most `most` of them, and only those whose
    /// canonical boxes touch `bounds`, if that is given.
    #[must_use]
    pub fn shapes_after(&self, after: Option<ShapeId>, most: usize, bounds: Option<Aabb>) -> Vec<&Shape> {
        self.state
            .ids
            .after(after)
            .map(|(_, slot)| self.state.shapes.entry(slot))
            .filter(|entry| bounds.is_none_or(|bounds| bounds.intersects(entry.bounds)))
            .take(most)
            .map(|entry| &entry.shape)
            .collect()
    }
}
