//! How a version came from the one before: which shapes changed, and which of them travelled.
//!
//! # Method
//! The record of the tick tells it, by slots; who was in a slot is told by the version itself, and for a past one by what
//! later ticks put in its place. Where no record is held, the two versions are compared, and nothing is known to have
//! travelled.

use std::{collections::HashMap, sync::Arc};

use super::{
    super::{ShapeId, Snapshot, Tick, changed::pose_bits, edit::Motion, snapshot::Content, store::Slot},
    Record,
};

/// How a version came from another.
#[derive(Debug, Default)]
pub(in crate::world) struct Passage {
    /// Every shape that some question about overlaps could tell apart, and perhaps others; by id.
    pub(in crate::world) changed: Vec<ShapeId>,
    /// The shapes that went from where they were to where they are, be it the same place; by id.
    pub(in crate::world) travelled: Vec<ShapeId>,
}

impl Passage {
    /// Whether a shape changed.
    pub(in crate::world) fn changed(&self, id: ShapeId) -> bool {
        self.changed.binary_search(&id).is_ok()
    }

    /// Whether a shape went from where it was to where it is: it is in both versions, and of the same form.
    pub(in crate::world) fn travelled(&self, id: ShapeId) -> bool {
        self.travelled.binary_search(&id).is_ok()
    }
}

impl Snapshot {
    /// How this version came from `old`, which may be any version of any world.
    pub(in crate::world) fn passage_from(&self, old: &Self) -> Passage {
        match self.record_from(old) {
            Some(record) => self.passage_of(record),
            None => Passage { changed: self.changed_since(old), travelled: Vec::new() },
        }
    }

    /// What led here from `old`, if that is the tick before in the same world and it is held.
    fn record_from(&self, old: &Self) -> Option<&Record> {
        let is_next = self.tick.get() == old.tick.get() + 1 && Arc::ptr_eq(&self.kept, &old.kept);
        let are_whole = self.fraction <= 0.0 && old.fraction <= 0.0;
        let is_held = is_next && are_whole && self.tick > self.oldest_tick();
        if is_held { self.history.record(self.tick).map(Arc::as_ref) } else { None }
    }

    fn passage_of(&self, record: &Record) -> Passage {
        let tenants = Tenants::of(self);
        let mut passage = Passage::default();
        for moved in &record.moved {
            let side = tenants.id(moved.slot).and_then(|id| self.find(id));
            let Some((id, pose)) = side.and_then(|side| Some((side.id()?, side.placed.pose))) else { continue };
            if moved.motion == Motion::Travelled {
                passage.travelled.push(id);
            }
            if pose_bits(&moved.pose) != pose_bits(&pose) {
                passage.changed.push(id);
            }
        }
        for (slot, was) in &record.replaced {
            passage.changed.extend(was.iter().map(|shape| shape.id).chain(tenants.id(*slot)));
        }
        passage.changed.sort_unstable();
        passage.changed.dedup();
        passage.travelled.sort_unstable();
        passage
    }
}

/// Who is in which slot.
struct Tenants<'a> {
    /// A version that is no past one.
    newest: &'a Snapshot,
    /// Who was in the slots that were filled anew since.
    earlier: HashMap<Slot, Option<ShapeId>>,
}

impl<'a> Tenants<'a> {
    fn of(snapshot: &'a Snapshot) -> Self {
        let Content::Then(past) = &snapshot.content else {
            return Self { newest: snapshot, earlier: HashMap::new() };
        };
        let newest = past.newest();
        let mut earlier = HashMap::new();
        // The earliest of the later ticks is noted last: it tells what was there before all of them.
        for tick in (snapshot.tick.get() + 1..=newest.tick.get()).rev() {
            let record = Tick::new(tick).and_then(|tick| newest.history.record(tick));
            let replaced = record.into_iter().flat_map(|record| &record.replaced);
            earlier.extend(replaced.map(|(slot, was)| (*slot, was.as_ref().map(|shape| shape.id))));
        }
        Self { newest, earlier }
    }

    fn id(&self, slot: Slot) -> Option<ShapeId> {
        match self.earlier.get(&slot) {
            Some(id) => *id,
            None => self.newest.state().shapes.get(slot).map(|entry| entry.shape().id),
        }
    }
}
