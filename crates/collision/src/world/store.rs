//! Where the shapes of a world are kept.

use crate::{
    math::Aabb,
    pages::Pages,
    shape::Simple,
    world::{Mobility, Shape},
};

/// Where a shape is kept; used again when the shape is gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Slot(pub(super) u32);

/// A shape and what is derived from it.
/// In four cache lines, of which questions read the first three: the box, the form, and of the shape what comes first.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Entry {
    /// Its canonical box: the first judge of every question.
    pub(super) bounds: Aabb,
    /// Its form, if that is simple; else its geometry has it.
    pub(super) simple: Option<Simple>,
    /// The shape.
    pub(super) shape: Shape,
}

impl Entry {
    /// A shape in a box.
    pub(super) fn new(shape: Shape, bounds: Aabb) -> Self {
        Self { bounds, simple: Simple::of(&shape.geometry), shape }
    }

    /// Whether it is in the static tree, not in the dynamic one.
    pub(super) fn is_static(&self) -> bool {
        self.shape.mobility == Mobility::Static
    }

    /// Reads something of each line of memory that a kernel will want of it; what comes out means nothing.
    pub(super) fn read_ahead(&self) -> u64 {
        let form = match self.simple {
            Some(_) => self.shape.pose.position.x.to_bits(),
            None => self.shape.geometry.read_ahead(),
        };
        u64::from(self.shape.group) ^ form
    }
}

#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all places are taken, and an entry apart would be waited for twice"
)]
enum Place {
    Taken(Entry),
    /// Free; the next free one.
    Free(Option<u32>),
}

impl Default for Place {
    fn default() -> Self {
        Self::Free(None)
    }
}

/// The shapes by slot. Clones share pages until one of them writes.
#[derive(Clone, Debug, Default)]
pub(super) struct Store {
    places: Pages<Place>,
    free: Option<u32>,
    len: usize,
}

impl Store {
    /// How many shapes there are.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// What is in a slot.
    ///
    /// # Panics
    /// If the slot is free: slots come from the directory and the trees, which hold taken ones only.
    pub(super) fn entry(&self, slot: Slot) -> &Entry {
        match &self.places[slot.0 as usize] {
            Place::Taken(entry) => entry,
            Place::Free(_) => panic!("slot {} is free", slot.0),
        }
    }

    /// What is in a slot; `None` if it is free or beyond the last.
    pub(super) fn get(&self, slot: Slot) -> Option<&Entry> {
        match self.places.get(slot.0 as usize)? {
            Place::Taken(entry) => Some(entry),
            Place::Free(_) => None,
        }
    }

    /// The slots, free or not, that may hold something else than in `other`: those of the pages not shared with it.
    pub(super) fn unshared_slots(&self, other: &Self) -> impl Iterator<Item = Slot> {
        self.places.unshared(&other.places).map(|index| Slot(index as u32))
    }

    /// How many slots there are, free ones included.
    pub(super) fn slot_count(&self) -> usize {
        self.places.len()
    }

    /// As [`Store::entry`], to change it.
    pub(super) fn entry_mut(&mut self, slot: Slot) -> &mut Entry {
        match &mut self.places[slot.0 as usize] {
            Place::Taken(entry) => entry,
            Place::Free(_) => panic!("slot {} is free", slot.0),
        }
    }

    /// Keeps an entry in a slot that was free.
    pub(super) fn insert(&mut self, entry: Entry) -> Slot {
        self.len += 1;
        let Some(slot) = self.free else {
            self.places.push(Place::Taken(entry));
            return Slot((self.places.len() - 1) as u32);
        };
        if let Place::Free(next) = self.places[slot as usize] {
            self.free = next;
        }
        self.places[slot as usize] = Place::Taken(entry);
        Slot(slot)
    }

    /// Frees a slot.
    pub(super) fn remove(&mut self, slot: Slot) {
        self.places[slot.0 as usize] = Place::Free(self.free);
        self.free = Some(slot.0);
        self.len -= 1;
    }

    /// All entries, by slot.
    pub(super) fn iter(&self) -> impl Iterator<Item = (Slot, &Entry)> {
        (0..).zip(self.places.iter()).filter_map(|(slot, place)| match place {
            Place::Taken(entry) => Some((Slot(slot), entry)),
            Place::Free(_) => None,
        })
    }

    /// Bytes it holds in memory that `other` does not share, geometries not.
    pub(super) fn bytes_beside(&self, other: &Self) -> u64 {
        self.places.bytes_beside(&other.places)
    }

    /// Bytes it holds in memory, what it shares with its clones included, geometries not.
    pub(super) fn memory_bytes(&self) -> u64 {
        self.places.memory_bytes()
    }
}
