//! One version of a world: its shapes and the trees over them.

use std::{num::NonZeroU64, sync::Arc};

use glam::DVec3;

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

/// One version of a world.
#[derive(Debug)]
pub struct Snapshot {}

/// What a version holds, what was built for it and what that costs.
#[derive(Clone, Debug)]
pub struct Description {
    /// The version.
    pub tick: Tick,
    /// When it was made.
    pub time: Time,
    /// Shapes.
    pub shape_count: u64,
    /// Of those, the static ones.
    pub static_count: u64,
    /// Canonical bounds of all shapes; `None` in an empty world.
    pub bounds: Option<Aabb>,
    /// Surface-area cost of the dynamic tree, 1 being that of a fresh one.
    pub tree_cost: f64,
    /// Levels of the dynamic tree.
    pub tree_depth: u32,
    /// What was built.
    pub built: Vec<BuiltStructure>,
    /// All memory the version holds, bytes.
    pub memory_bytes: u64,
}

/// Something that was built because a question or an edit first needed it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BuiltStructure {
    /// `dynamic_tree`, `static_tree`, `mesh_tree`.
    pub name: &'static str,
    /// How many of them.
    pub count: u64,
    /// What they hold in memory, bytes.
    pub memory_bytes: u64,
}

impl Snapshot {
    /// Its version.
    #[must_use]
    pub fn tick(&self) -> Tick {
        todo!()
    }

    /// When it was made.
    #[must_use]
    pub fn time(&self) -> Time {
        todo!()
    }

    /// How many shapes it holds.
    #[must_use]
    pub fn len(&self) -> usize {
        todo!()
    }

    /// Whether it holds none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A shape.
    #[must_use]
    pub fn shape(&self, _id: ShapeId) -> Option<&Shape> {
        todo!()
    }

    /// Shapes after `after`, by id; all from the first with `None`. At most `most` of them, and only those whose
    /// canonical boxes touch `bounds`, if that is given.
    #[must_use]
    pub fn shapes_after(&self, _after: Option<ShapeId>, _most: usize, _bounds: Option<Aabb>) -> Vec<&Shape> {
        todo!()
    }

    /// What it holds and what was built for it. Costs a pass over all shapes.
    #[must_use]
    pub fn describe(&self) -> Description {
        todo!()
    }
}
