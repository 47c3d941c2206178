//! What a world was during a few ticks, made ready for questions.
//!
//! # Method
//! A span is based on a later state and tells only what was otherwise: a track for each shape that changed between the
//! span and that state. Questions search the trees of that state, where the slots that changed are passed over, and the
//! span's own tree of tracks. Where most of what moves has changed, the rest of what moves is put into the span's own tree
//! too, so that one search serves.

use std::{borrow::Cow, sync::OnceLock};

use super::{
    super::{Shape, ShapeId, Tick, search::Side, state::State, store::Slot},
    Changes,
    track::{Origin, Placement, Track},
};
use crate::{
    broad::StaticTree,
    math::{Aabb, Pose},
    narrow::Placed,
};

/// Which shapes the trees of the base are searched for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rest {
    /// Static ones and moving ones.
    InBothTrees,
    /// Static ones; all that moves is in the span's own tree.
    InStaticTree,
}

/// A moment within a span.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instant {
    /// Ticks after the first of the span.
    pub(super) at: u8,
    /// How far on towards the next, from 0 to below 1.
    pub(super) fraction: f64,
}

/// What a world was during a few ticks.
#[derive(Debug)]
pub(in crate::world) struct Span {
    /// The state that it is based on: that of the same tick or a later one.
    pub(super) base: State,
    pub(super) first: Tick,
    pub(super) rest: Rest,
    /// A bit for each slot of the base that is not to be looked at there.
    pub(super) overridden: Vec<u64>,
    pub(super) tracks: Vec<Track>,
    pub(super) placements: Vec<Placement>,
    /// Shapes that are not in the base, or not as they were.
    pub(super) own: Vec<Shape>,
    /// Leaf numbers are indices of tracks.
    pub(super) tree: StaticTree,
    /// The tracks of shapes that changed, by id; needed only where a shape is named.
    pub(super) by_id: OnceLock<Vec<(ShapeId, u32)>>,
}

impl Span {
    /// Whether a slot of the base is not to be looked at there.
    pub(super) fn is_overridden(&self, slot: Slot) -> bool {
        let word = self.overridden.get(slot.0 as usize / 64);
        word.is_some_and(|word| word >> (slot.0 % 64) & 1 != 0)
    }

    /// What a leaf of the own tree was at an instant; `None` if it was not there.
    pub(super) fn side(&self, leaf: u32, instant: Instant) -> Option<Side<'_>> {
        let track = &self.tracks[leaf as usize];
        if let Origin::Still(slot) = track.origin {
            return Some(Side::of(self.base.shapes.entry(slot)));
        }
        if !track.is_there(instant.at) {
            return None;
        }
        let shape = self.shape(track);
        let pose = track.pose(instant.at, instant.fraction, &self.placements);
        let placed = Placed { geometry: &shape.geometry, pose };
        Some(Side { placed, simple: None, shape: Some(shape), bounds: shape.geometry.bounds(&pose) })
    }

    /// A shape at an instant, by its id.
    pub(super) fn find(&self, id: ShapeId, instant: Instant) -> Option<Side<'_>> {
        if let Some(leaf) = self.track_of(id, instant) {
            return self.side(leaf, instant);
        }
        let slot = self.base.ids.get(id).filter(|&slot| !self.is_overridden(slot))?;
        Some(Side::of(self.base.shapes.entry(slot)))
    }

    /// A shape at the tick of an instant, by its id, and where it went from there by the next one; `None` there if it stood, or
    /// if the instant is that tick.
    pub(super) fn way(&self, id: ShapeId, instant: Instant) -> Option<(Side<'_>, Option<Pose>)> {
        let side = self.find(id, Instant { fraction: 0.0, ..instant })?;
        let track = self.track_of(id, instant).filter(|_| instant.fraction > 0.0);
        let end = track.and_then(|leaf| self.tracks[leaf as usize].end(instant.at, &self.placements));
        Some((side, end))
    }

    /// A shape at an instant, by its id, with its velocities.
    pub(super) fn find_shape(&self, id: ShapeId, instant: Instant) -> Option<Cow<'_, Shape>> {
        if let Some(leaf) = self.track_of(id, instant) {
            return Some(Cow::Owned(self.shape_at(&self.tracks[leaf as usize], instant)));
        }
        let slot = self.base.ids.get(id).filter(|&slot| !self.is_overridden(slot))?;
        Some(Cow::Borrowed(self.base.shapes.entry(slot).shape()))
    }

    /// The whole state at an instant. Costs what changed up to the base.
    pub(super) fn whole(&self, instant: Instant) -> State {
        let mut state = self.base.clone();
        let slots = (0..).zip(&self.overridden).flat_map(|(word, bits)| {
            (0..64).filter(move |bit| bits >> bit & 1 != 0).map(move |bit| Slot(word * 64 + bit))
        });
        for slot in slots {
            if let Some(entry) = self.base.shapes.get(slot) {
                state.remove(entry.shape().id, &mut Changes::unkept());
            }
        }
        for track in self.tracks.iter().filter(|track| !matches!(track.origin, Origin::Still(_))) {
            if track.is_there(instant.at) {
                state.insert(self.shape_at(track, instant), &mut Changes::unkept());
            }
        }
        state.moving.settle();
        state
    }

    /// Bytes it holds in memory besides its base.
    pub(super) fn memory_bytes(&self) -> u64 {
        let lists = self.overridden.capacity() * size_of::<u64>()
            + self.tracks.capacity() * size_of::<Track>()
            + self.placements.capacity() * size_of::<Placement>()
            + self.own.capacity() * size_of::<Shape>()
            + self.by_id.get().map_or(0, |by_id| by_id.capacity() * size_of::<(ShapeId, u32)>());
        (size_of::<Self>() + lists) as u64 + self.tree.memory_bytes()
    }

    /// The same, with what its base holds that `newest` does not share.
    pub(super) fn bytes_beside(&self, newest: &State) -> u64 {
        self.memory_bytes() + self.base.bytes_beside(newest)
    }

    /// All about the shape of a track but its placement.
    fn shape(&self, track: &Track) -> &Shape {
        match track.origin {
            Origin::Base(slot) | Origin::Still(slot) => self.base.shapes.entry(slot).shape(),
            Origin::Own(index) => &self.own[index as usize],
        }
    }

    /// The box of a track over the whole span.
    pub(super) fn bounds(&self, track: &Track) -> Aabb {
        match track.origin {
            Origin::Still(slot) => self.base.shapes.entry(slot).bounds,
            Origin::Base(_) | Origin::Own(_) => track.bounds(&self.shape(track).geometry, &self.placements),
        }
    }

    /// The layers of a track.
    pub(super) fn layers(&self, track: &Track) -> u32 {
        self.shape(track).layers
    }

    fn shape_at(&self, track: &Track, instant: Instant) -> Shape {
        let Placement { velocity, angular_velocity, .. } = *track.placement(instant.at, &self.placements);
        let pose = track.pose(instant.at, instant.fraction, &self.placements);
        Shape { pose, velocity, angular_velocity, ..self.shape(track).clone() }
    }

    /// The track of a shape that changed and was there.
    fn track_of(&self, id: ShapeId, instant: Instant) -> Option<u32> {
        let by_id = self.by_id.get_or_init(|| {
            let changed = (0..).zip(&self.tracks).filter(|(_, track)| !matches!(track.origin, Origin::Still(_)));
            let mut by_id: Vec<_> = changed.map(|(leaf, track)| (self.shape(track).id, leaf)).collect();
            by_id.sort_unstable();
            by_id
        });
        let from = by_id.partition_point(|(other, _)| *other < id);
        let same = by_id[from..].iter().take_while(|(other, _)| *other == id);
        same.map(|(_, leaf)| *leaf).find(|&leaf| self.tracks[leaf as usize].is_there(instant.at))
    }
}
