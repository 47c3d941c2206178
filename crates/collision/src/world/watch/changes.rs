//! What changed between two looks, and how the changes of several ticks become one.

use std::collections::BTreeMap;

use super::RegionId;
use crate::world::ShapeId;

/// What became of one overlap between two looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// It was not and is.
    Came,
    /// It was and is not.
    Went,
    /// It is what it was, but was otherwise in between: it came and went, or went and came.
    CameAndWent,
}

impl Change {
    /// What became of it after both.
    fn then(self, next: Self) -> Self {
        match (self, next) {
            (Self::CameAndWent, next) => next,
            (first, Self::CameAndWent) => first,
            _ => Self::CameAndWent,
        }
    }
}

/// What began and ended between two looks, by ids.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Shapes in regions.
    pub regions: BTreeMap<(RegionId, ShapeId), Change>,
    /// Pairs of shapes, the lower id first.
    pub pairs: BTreeMap<(ShapeId, ShapeId), Change>,
}

impl Changes {
    /// Whether nothing changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.regions.is_empty() && self.pairs.is_empty()
    }

    /// How much changed.
    #[must_use]
    pub fn len(&self) -> usize {
        self.regions.len() + self.pairs.len()
    }

    /// Adds what changed after these changes. Nothing is lost: what came and went again is told as that.
    ///
    /// ```
    /// use collision::world::{Change, Changes, RegionId, ShapeId};
    /// let (gate, car) = (RegionId::MIN, ShapeId::MIN);
    /// let seen = |change| Changes { regions: [((gate, car), change)].into(), ..Changes::default() };
    /// let mut changes = seen(Change::Came);
    /// changes.merge(seen(Change::Went));
    /// assert_eq!(changes, seen(Change::CameAndWent));
    /// changes.merge(seen(Change::Came));
    /// assert_eq!(changes, seen(Change::Came));
    /// ```
    pub fn merge(&mut self, next: Self) {
        merge(&mut self.regions, next.regions);
        merge(&mut self.pairs, next.pairs);
    }
}

fn merge<K: Ord>(all: &mut BTreeMap<K, Change>, next: BTreeMap<K, Change>) {
    if all.is_empty() {
        *all = next;
        return;
    }
    for (key, change) in next {
        all.entry(key).and_modify(|first| *first = first.then(change)).or_insert(change);
    }
}
