//! What one tick changed, told by what was before it.
//!
//! # Method
//! While edits are applied, each note is put down as it comes. At the end of the tick only the first one of each slot
//! counts, since that is what the version before held; the rest happened within the tick and nobody saw it.

use glam::DVec3;

use super::super::{Shape, Time, edit::Motion, state::State, store::Slot};
use crate::math::Pose;

/// What led from one tick to the next.
#[derive(Debug)]
pub(in crate::world) struct Record {
    /// When the tick before was made.
    pub(super) time_before: Time,
    /// The shapes that moved, by slot.
    pub(super) moved: Box<[Moved]>,
    /// Of those, the ones whose velocities changed, by slot.
    pub(super) sped: Box<[Sped]>,
    /// The slots whose shape came, went or was replaced, by slot, with what they held before. Never those of `moved`.
    pub(super) replaced: Box<[(Slot, Option<Box<Shape>>)]>,
    /// The whole version after the tick, now and then: see [`super::build`].
    pub(super) keyframe: Option<Box<State>>,
}

/// A shape that moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moved {
    pub(super) slot: Slot,
    pub(super) motion: Motion,
    /// Where it was.
    pub(super) pose: Pose,
}

/// A shape whose velocities changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sped {
    pub(super) slot: Slot,
    /// What it had.
    pub(super) velocity: DVec3,
    pub(super) angular_velocity: DVec3,
}

impl Record {
    /// Bytes it holds in memory, geometries not.
    pub(super) fn memory_bytes(&self) -> u64 {
        let lists = size_of_val(&*self.moved) + size_of_val(&*self.sped) + size_of_val(&*self.replaced);
        let shapes = self.replaced.iter().filter(|(_, was)| was.is_some()).count() * size_of::<Shape>();
        let keyframe = self.keyframe.as_ref().map_or(0, |state| state.memory_bytes());
        (size_of::<Self>() + lists + shapes) as u64 + keyframe
    }
}

/// The notes of a tick that is being made, or none if no history is kept.
#[derive(Debug, Default)]
pub(in crate::world) struct Changes {
    notes: Option<Box<Notes>>,
}

/// What happened, in order; `order` counts the moves before.
#[derive(Debug, Default)]
struct Notes {
    moved: Vec<Moved>,
    sped: Vec<(usize, Sped)>,
    replaced: Vec<Replaced>,
}

#[derive(Debug)]
struct Replaced {
    order: usize,
    slot: Slot,
    was: Option<Box<Shape>>,
}

impl Changes {
    /// Keeps notes.
    pub(in crate::world) fn kept() -> Self {
        Self { notes: Some(Box::default()) }
    }

    /// Keeps nothing.
    pub(in crate::world) fn unkept() -> Self {
        Self::default()
    }

    /// A shape is about to be moved and to get these velocities.
    pub(in crate::world) fn moves(&mut self, slot: Slot, shape: &Shape, speed: [DVec3; 2], motion: Motion) {
        let Some(notes) = &mut self.notes else { return };
        let Shape { velocity, angular_velocity, pose, .. } = *shape;
        if speed != [velocity, angular_velocity] {
            notes.sped.push((notes.moved.len(), Sped { slot, velocity, angular_velocity }));
        }
        notes.moved.push(Moved { slot, motion, pose });
    }

    /// A slot is about to hold no shape any more.
    pub(in crate::world) fn empties(&mut self, slot: Slot, shape: &Shape) {
        self.replaces(slot, || Some(Box::new(shape.clone())));
    }

    /// A slot that was empty holds a shape now.
    pub(in crate::world) fn fills(&mut self, slot: Slot) {
        self.replaces(slot, || None);
    }

    fn replaces(&mut self, slot: Slot, was: impl FnOnce() -> Option<Box<Shape>>) {
        if let Some(notes) = &mut self.notes {
            notes.replaced.push(Replaced { order: notes.moved.len(), slot, was: was() });
        }
    }

    /// The record of the tick, if notes were kept.
    pub(in crate::world) fn into_record(self, time_before: Time) -> Option<Record> {
        let Notes { moved, sped, mut replaced } = *self.notes?;
        replaced.sort_by_key(|replaced| replaced.slot);
        replaced.dedup_by_key(|replaced| replaced.slot);
        let mut moved: Vec<(usize, Moved)> = moved.into_iter().enumerate().collect();
        moved.sort_by_key(|(_, moved)| moved.slot);
        moved.dedup_by(|(_, later), (_, first)| {
            let is_same = later.slot == first.slot;
            if is_same && later.motion == Motion::Teleported {
                first.motion = Motion::Teleported;
            }
            is_same
        });
        let mut sped = sped;
        sped.sort_by_key(|(_, sped)| sped.slot);
        sped.dedup_by_key(|(_, sped)| sped.slot);
        // What was replaced after it had moved was kept as it was then: it gets back what it had before the tick.
        moved.retain(|(order, moved)| !give_back(&mut replaced, moved.slot, *order, |shape| shape.pose = moved.pose));
        sped.retain(|(order, sped)| {
            !give_back(&mut replaced, sped.slot, *order, |shape| {
                (shape.velocity, shape.angular_velocity) = (sped.velocity, sped.angular_velocity);
            })
        });
        Some(Record {
            time_before,
            moved: moved.into_iter().map(|(_, moved)| moved).collect(),
            sped: sped.into_iter().map(|(_, sped)| sped).collect(),
            replaced: replaced.into_iter().map(|replaced| (replaced.slot, replaced.was)).collect(),
            keyframe: None,
        })
    }
}

/// Whether a slot was replaced in the tick; if it was so after the note of that order, what it held gets back what it had.
fn give_back(replaced: &mut [Replaced], slot: Slot, order: usize, back: impl FnOnce(&mut Shape)) -> bool {
    let Ok(place) = replaced.binary_search_by_key(&slot, |replaced| replaced.slot) else {
        return false;
    };
    let replaced = &mut replaced[place];
    if order < replaced.order
        && let Some(shape) = &mut replaced.was
    {
        back(shape);
    }
    true
}
