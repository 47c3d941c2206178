//! Shapes that a search by a box offers, looked at several at a time.
//!
//! # Method
//! Shapes that are near each other lie anywhere in memory. Taken one by one, each has a question wait twice: for the entry
//! of the shape, and then for the geometry that the entry leads to. Taken together, the boxes of all are read first, then
//! of each that is left something of every line of memory that a kernel will want, and only then is the first kernel
//! asked: what is waited for is all on its way at once.
//!
//! # Limits
//! It pays where a question looks at all that it is offered. Where what is found first excludes the rest, as along a ray,
//! shapes are taken one by one.

use std::hint::black_box;

use smallvec::SmallVec;

use super::{outline::Outline, store::Entry};

/// Shapes looked at together. More than a processor can wait for at once gain nothing.
const BATCH: usize = 32;

/// Shapes that wait to be looked at.
#[derive(Debug, Default)]
pub(super) struct Batch<'a> {
    entries: SmallVec<[&'a Entry; BATCH]>,
}

impl<'a> Batch<'a> {
    /// Adds a shape to those that wait.
    pub(super) fn add(&mut self, entry: &'a Entry) {
        self.entries.push(entry);
    }

    /// Whether those that wait should be looked at before another comes.
    pub(super) fn is_full(&self) -> bool {
        self.entries.len() == BATCH
    }

    /// Visits those of them whose canonical boxes do not prove that they are clear of the outline; none wait any more.
    pub(super) fn visit_near<E>(
        &mut self,
        outline: &Outline,
        visit: impl FnMut(&'a Entry) -> Result<(), E>,
    ) -> Result<(), E> {
        // Without a branch: one that is foreseen wrongly would make the others wait.
        let mut near = 0;
        for at in 0..self.entries.len() {
            let entry = self.entries[at];
            self.entries[near] = entry;
            near += usize::from(outline.may_touch(&entry.bounds));
        }
        self.entries.truncate(near);
        black_box(self.entries.iter().fold(0, |all, entry| all ^ entry.read_ahead()));
        self.entries.drain(..).try_for_each(visit)
    }
}
