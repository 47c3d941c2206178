//! The pairs of a world, kept from version to version.

use std::{collections::BTreeMap, sync::Arc};

use super::{PAIRS_MAX, Pair, PairChanges};
use crate::{
    accuracy::Accuracy,
    answer::Certificate,
    world::{Filter, Meter, QuestionError, ShapeId, Snapshot},
};

/// The pairs of the version that it was last shown. A step costs what changed since: it is [`Snapshot::pairs_since`] without
/// asking the old version again, and returns the same, bit by bit.
///
/// It keeps the version alive, and for each pair about 100 bytes.
#[derive(Clone, Debug)]
pub struct PairKeeper {
    filter: Filter,
    accuracy: Accuracy,
    seen: Option<Arc<Snapshot>>,
    /// Each pair under both orders of its ids, so that the partners of a shape lie together.
    partners: BTreeMap<(ShapeId, ShapeId), Certificate>,
}

impl PairKeeper {
    /// Has seen no version yet.
    #[must_use]
    pub fn new(filter: Filter, accuracy: Accuracy) -> Self {
        Self { filter, accuracy, seen: None, partners: BTreeMap::new() }
    }

    /// Goes on to another version and says how its pairs came from those of the one before. At the first step all pairs
    /// begin. After an error it is still at the version before.
    ///
    /// # Errors
    /// As [`Snapshot::pairs`].
    pub fn step(&mut self, new: &Arc<Snapshot>, meter: &mut Meter<'_>) -> Result<PairChanges, QuestionError> {
        let Some(old) = &self.seen else {
            let began = new.pairs(&self.filter, &self.accuracy, meter)?;
            let changes = PairChanges { began, ..PairChanges::default() };
            self.take(new, &changes);
            return Ok(changes);
        };
        let changed = new.changed_since(old);
        let after = new.pairs_of(&changed, &self.filter, &self.accuracy, |_, _| true, meter)?;
        let changes = PairChanges::between(&self.pairs_of(&changed), &after);
        if self.len() + changes.began.len() - changes.ended.len() > PAIRS_MAX {
            return Err(QuestionError::TooManyPairs);
        }
        self.take(new, &changes);
        Ok(changes)
    }

    /// The pairs of the version that was seen last, as [`Snapshot::pairs`] lists them.
    pub fn pairs(&self) -> impl Iterator<Item = Pair> {
        let once = self.partners.iter().filter(|((a, b), _)| a < b);
        once.map(|(&(a, b), &certificate)| Pair { a, b, certificate })
    }

    /// How many pairs there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.partners.len() / 2
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.partners.is_empty()
    }

    /// The kept pairs that have one of `ids`.
    fn pairs_of(&self, ids: &[ShapeId]) -> Vec<Pair> {
        let mut pairs = Vec::new();
        for &id in ids {
            let own = self.partners.range((id, ShapeId::MIN)..=(id, ShapeId::MAX));
            pairs.extend(own.map(|(&(own, other), &certificate)| Pair {
                a: own.min(other),
                b: own.max(other),
                certificate,
            }));
        }
        pairs.sort_unstable_by_key(Pair::ids);
        pairs.dedup_by_key(|pair| pair.ids());
        pairs
    }

    fn take(&mut self, new: &Arc<Snapshot>, changes: &PairChanges) {
        for &Pair { a, b, .. } in &changes.ended {
            self.partners.remove(&(a, b));
            self.partners.remove(&(b, a));
        }
        let present = changes.began.iter().chain(changes.persisted.iter().map(|persisted| &persisted.pair));
        for &Pair { a, b, certificate } in present {
            self.partners.insert((a, b), certificate);
            self.partners.insert((b, a), certificate);
        }
        self.seen = Some(Arc::clone(new));
    }
}
