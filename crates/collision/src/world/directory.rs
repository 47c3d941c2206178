//! Which shape is in which slot, in the order of ids.
//!
//! # Method
//! Sorted chunks of up to 128 ids, which clones share until one of them writes. It is sorted rather than hashed because
//! listing by id comes for nothing, the order is the same everywhere, and clients, who choose the ids, cannot choose
//! them so that they collide.

use std::sync::Arc;

use super::{ShapeId, store::Slot};

/// Ids in a chunk at most.
const CHUNK_MAX: usize = 128;
/// Neighbouring chunks that hold this many together become one.
const CHUNK_MERGE: usize = CHUNK_MAX / 2;

/// The slots of ids, by id. Cloning it shares everything.
#[derive(Clone, Debug, Default)]
pub(super) struct Directory {
    chunks: Arc<Vec<Chunk>>,
}

/// Never empty.
#[derive(Clone, Debug)]
struct Chunk {
    /// The lowest id, kept here so that a search over chunks stays in one piece of memory.
    first: ShapeId,
    items: Arc<Vec<(ShapeId, Slot)>>,
}

impl Chunk {
    fn new(items: Vec<(ShapeId, Slot)>) -> Self {
        Self { first: items[0].0, items: Arc::new(items) }
    }
}

impl Directory {
    /// The slot of an id.
    pub(super) fn get(&self, id: ShapeId) -> Option<Slot> {
        let chunk = &self.chunks[self.chunk_of(id)?];
        let position = chunk.items.binary_search_by_key(&id, |item| item.0).ok()?;
        Some(chunk.items[position].1)
    }

    /// Adds an id that is not in it.
    pub(super) fn insert(&mut self, id: ShapeId, slot: Slot) {
        let chunk_count = self.chunks.len();
        let at = self.chunk_of(id).unwrap_or(0);
        let chunks = Arc::make_mut(&mut self.chunks);
        let Some(chunk) = chunks.get_mut(at) else {
            chunks.push(Chunk::new(vec![(id, slot)]));
            return;
        };
        let position = chunk.items.partition_point(|item| item.0 < id);
        if chunk.items.len() < CHUNK_MAX {
            Arc::make_mut(&mut chunk.items).insert(position, (id, slot));
            chunk.first = chunk.items[0].0;
        } else if at + 1 == chunk_count && position == chunk.items.len() {
            // Ids that come in rising order fill chunks to the brim.
            chunks.push(Chunk::new(vec![(id, slot)]));
        } else {
            let mut low = chunk.items.to_vec();
            low.insert(position, (id, slot));
            let high = low.split_off(low.len() / 2);
            *chunk = Chunk::new(low);
            chunks.insert(at + 1, Chunk::new(high));
        }
    }

    /// Takes out an id; `None` if it is not in it.
    pub(super) fn remove(&mut self, id: ShapeId) -> Option<Slot> {
        let at = self.chunk_of(id)?;
        let position = self.chunks[at].items.binary_search_by_key(&id, |item| item.0).ok()?;
        let chunks = Arc::make_mut(&mut self.chunks);
        let items = Arc::make_mut(&mut chunks[at].items);
        let (_, slot) = items.remove(position);
        if items.is_empty() {
            chunks.remove(at);
            return Some(slot);
        }
        chunks[at].first = chunks[at].items[0].0;
        if let Some(next) = chunks.get(at + 1)
            && chunks[at].items.len() + next.items.len() <= CHUNK_MERGE
        {
            let next = chunks.remove(at + 1);
            Arc::make_mut(&mut chunks[at].items).extend_from_slice(&next.items);
        }
        Some(slot)
    }

    /// What comes after `after`, by id; all with `None`.
    pub(super) fn after(&self, after: Option<ShapeId>) -> impl Iterator<Item = (ShapeId, Slot)> {
        let at = after.and_then(|id| self.chunk_of(id)).unwrap_or(0);
        self.chunks[at..]
            .iter()
            .flat_map(|chunk| chunk.items.iter().copied())
            .skip_while(move |(id, _)| Some(*id) <= after)
    }

    /// Bytes it holds in memory, what it shares with its clones included.
    pub(super) fn memory_bytes(&self) -> u64 {
        let items: usize = self.chunks.iter().map(|chunk| chunk.items.capacity()).sum();
        (items * size_of::<(ShapeId, Slot)>() + self.chunks.capacity() * (size_of::<Chunk>() + 40)) as u64
    }

    /// Bytes it holds in memory that `other` does not share.
    pub(super) fn bytes_beside(&self, other: &Self) -> u64 {
        if Arc::ptr_eq(&self.chunks, &other.chunks) { 0 } else { self.memory_bytes() }
    }

    /// The chunk that holds `id` if any does: the last one that begins at or before it. `None` if `id` precedes all.
    fn chunk_of(&self, id: ShapeId) -> Option<usize> {
        self.chunks.partition_point(|chunk| chunk.first <= id).checked_sub(1)
    }
}
