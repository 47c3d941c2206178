//! One version of a world: its shapes and the trees over them.

use std::{borrow::Cow, num::NonZeroU64, sync::Arc};

use glam::DVec3;

use super::{
    Means, Settings,
    history::{History, Kept, Past},
    search::Side,
    state::State,
};
use crate::{
    math::{Aabb, Pose},
    shape::{Asking, Geometry},
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

/// A geometry placed in a world. Its fields are in this order in memory, those first that most questions read.
#[derive(Clone, Debug)]
#[repr(C)]
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
    /// Fast: the way of each of its moves is swept, and what it touched on it is reported.
    pub bullet: bool,
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
            bullet: false,
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
    /// How far on towards the next tick, for a past moment.
    pub(super) fraction: f64,
    pub(super) time: Time,
    pub(super) content: Content,
    /// What led here, if that is kept.
    pub(super) history: Arc<History>,
    /// What questions to the past had built; shared by all versions of the world.
    pub(super) kept: Arc<Kept>,
    /// The tick at which the dynamic tree got its first shape.
    pub(super) moving_since: Option<Tick>,
    /// The tick at which history was kept first.
    pub(super) history_since: Option<Tick>,
    pub(super) settings: Settings,
    pub(super) means: Means,
}

/// What a snapshot is made of.
#[derive(Debug)]
pub(super) enum Content {
    /// A version as it was published.
    Now(State),
    /// A past moment, told by what was otherwise than in a later version.
    Then(Past),
}

impl Content {
    /// The tick at which the dynamic tree got its first shape, given the one before.
    pub(super) fn moving_since(&self, before: Option<Tick>, tick: Tick) -> Option<Tick> {
        match self {
            Self::Now(state) if !state.moving.is_empty() => before.or(Some(tick)),
            Self::Now(_) | Self::Then(_) => before,
        }
    }
}

impl Snapshot {
    /// Its version.
    #[must_use]
    pub fn tick(&self) -> Tick {
        self.tick
    }

    /// Who asks it, for what its geometries build meanwhile. Its own questions say so themselves.
    #[must_use]
    pub fn asking(&self) -> Asking {
        Asking { tick: Some(self.tick.get()), clock: self.means.clock }
    }

    /// How far on towards the next tick, from 0 to below 1; 0 unless it was asked for by [`Snapshot::at`].
    #[must_use]
    pub fn fraction(&self) -> f64 {
        self.fraction
    }

    /// When it was made; between two ticks, when it would have been.
    #[must_use]
    pub fn time(&self) -> Time {
        self.time
    }

    /// The settings in force when it was made.
    #[must_use]
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// How many shapes it holds.
    #[must_use]
    pub fn len(&self) -> usize {
        self.state().shapes.len()
    }

    /// How many of them are bullets.
    #[must_use]
    pub fn bullet_count(&self) -> usize {
        self.state().bullet_count
    }

    /// Whether it holds none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A shape; that of a past moment is made up when it is asked for.
    #[must_use]
    pub fn shape(&self, id: ShapeId) -> Option<Cow<'_, Shape>> {
        match &self.content {
            Content::Now(state) => state.get(id).map(|entry| Cow::Borrowed(entry.shape())),
            Content::Then(past) => past.shape(id),
        }
    }

    /// Whether it holds a shape.
    #[must_use]
    pub fn contains(&self, id: ShapeId) -> bool {
        self.find(id).is_some()
    }

    /// The canonical box of a shape, rounded outwards, metres.
    #[must_use]
    pub fn bounds_of(&self, id: ShapeId) -> Option<Aabb> {
        self.find(id).map(|side| side.bounds)
    }

    /// Shapes after `after`, by id; all from the first with `None`. At most `most` of them, and only those whose
    /// canonical boxes touch `bounds`, if that is given.
    #[must_use]
    pub fn shapes_after(&self, after: Option<ShapeId>, most: usize, bounds: Option<Aabb>) -> Vec<&Shape> {
        let state = self.state();
        state
            .ids
            .after(after)
            .map(|(_, slot)| state.shapes.entry(slot))
            .filter(|entry| bounds.is_none_or(|bounds| bounds.intersects(entry.bounds)))
            .take(most)
            .map(|entry| entry.shape())
            .collect()
    }

    /// Everything that it holds. For a past moment the first call builds it, which costs what changed since.
    pub(super) fn state(&self) -> &State {
        match &self.content {
            Content::Now(state) => state,
            Content::Then(past) => past.whole(),
        }
    }

    /// A shape where it is.
    pub(super) fn find(&self, id: ShapeId) -> Option<Side<'_>> {
        match &self.content {
            Content::Now(state) => state.get(id).map(Side::of),
            Content::Then(past) => past.find(id),
        }
    }
}
