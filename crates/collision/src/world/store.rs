//! Where the shapes of a world are kept.

use std::slice::from_ref;

use glam::DVec3;
use prefetch_index::prefetch_index;

use crate::{
    math::Aabb,
    pages::Pages,
    shape::Simple,
    world::{Mobility, Shape},
};

/// Where a shape is kept; used again when the shape is gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Slot(pub(super) u32);

/// A place for a shape, with the shape and what is derived from it while it is taken.
/// In four cache lines, of which questions read the first three: the box, the form, and of the shape what comes first.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Entry {
    /// Its canonical box: the first judge of every question. Nothing touches that of a free place.
    pub(super) bounds: Aabb,
    /// Its form, if that is simple; else its geometry has it.
    pub(super) simple: Option<Simple>,
    /// Looked at by who asks for the shape, so that a place can be fetched before it is known whether it is taken.
    occupant: Occupant,
}

#[derive(Clone, Debug)]
enum Occupant {
    Shape(Shape),
    /// None; the next free place.
    Nobody(Option<u32>),
}

impl Entry {
    /// A shape in a box.
    pub(super) fn new(shape: Shape, bounds: Aabb) -> Self {
        Self { bounds, simple: Simple::of(&shape.geometry), occupant: Occupant::Shape(shape) }
    }

    /// A free place.
    fn free(next: Option<u32>) -> Self {
        Self { bounds: Aabb::new(DVec3::INFINITY, DVec3::NEG_INFINITY), simple: None, occupant: Occupant::Nobody(next) }
    }

    /// The shape.
    ///
    /// # Panics
    /// If the place is free: slots come from the directory and the trees, which hold taken ones only.
    #[inline]
    pub(super) fn shape(&self) -> &Shape {
        match &self.occupant {
            Occupant::Shape(shape) => shape,
            Occupant::Nobody(_) => free_place(),
        }
    }

    /// As [`Entry::shape`], to change it.
    pub(super) fn shape_mut(&mut self) -> &mut Shape {
        match &mut self.occupant {
            Occupant::Shape(shape) => shape,
            Occupant::Nobody(_) => free_place(),
        }
    }

    /// Whether it is in the static tree, not in the dynamic one.
    pub(super) fn is_static(&self) -> bool {
        self.shape().mobility == Mobility::Static
    }

    fn is_taken(&self) -> bool {
        matches!(self.occupant, Occupant::Shape(_))
    }

    /// Reads something of each line of memory that a kernel will want of it; what comes out means nothing.
    pub(super) fn read_ahead(&self) -> u64 {
        let shape = self.shape();
        let form = match self.simple {
            Some(_) => shape.pose.position.x.to_bits(),
            None => shape.geometry.read_ahead(),
        };
        u64::from(shape.group) ^ form
    }
}

#[cold]
fn free_place() -> ! {
    panic!("the place of a shape is free")
}

impl Default for Entry {
    fn default() -> Self {
        Self::free(None)
    }
}

/// The shapes by slot. Clones share pages until one of them writes.
#[derive(Clone, Debug, Default)]
pub(super) struct Store {
    places: Pages<Entry>,
    free: Option<u32>,
    len: usize,
}

impl Store {
    /// How many shapes there are.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// What is in a slot.
    #[inline]
    pub(super) fn entry(&self, slot: Slot) -> &Entry {
        &self.places[slot.0 as usize]
    }

    /// Asks for what questions read of a slot, without waiting for it.
    #[inline]
    pub(super) fn prefetch(&self, slot: Slot) {
        let Entry { bounds, simple, occupant } = self.entry(slot);
        prefetch_index(from_ref(bounds), 0);
        prefetch_index(from_ref(simple), 0);
        prefetch_index(from_ref(occupant), 0);
    }

    /// What is in a slot; `None` if it is free or beyond the last.
    pub(super) fn get(&self, slot: Slot) -> Option<&Entry> {
        self.places.get(slot.0 as usize).filter(|entry| entry.is_taken())
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
        &mut self.places[slot.0 as usize]
    }

    /// Keeps an entry in a slot that was free.
    pub(super) fn insert(&mut self, entry: Entry) -> Slot {
        self.len += 1;
        let Some(slot) = self.free else {
            self.places.push(entry);
            return Slot((self.places.len() - 1) as u32);
        };
        if let Occupant::Nobody(next) = self.places[slot as usize].occupant {
            self.free = next;
        }
        self.places[slot as usize] = entry;
        Slot(slot)
    }

    /// Frees a slot.
    pub(super) fn remove(&mut self, slot: Slot) {
        self.places[slot.0 as usize] = Entry::free(self.free);
        self.free = Some(slot.0);
        self.len -= 1;
    }

    /// All entries that are taken, by slot.
    pub(super) fn iter(&self) -> impl Iterator<Item = (Slot, &Entry)> {
        (0..).map(Slot).zip(self.places.iter()).filter(|(_, entry)| entry.is_taken())
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
