//! Which pairs began, went on and ended between two versions.
//!
//! # Method
//! A pair of two shapes that did not change is what it was. So the shapes that changed are asked again in both versions,
//! with all their partners, and the two lists are compared.

use std::cmp::Ordering;

use super::{Judge, Pair, candidates::id_of};
use crate::{
    accuracy::Accuracy,
    answer::Certificate,
    world::{Filter, Meter, QuestionError, ShapeId, Snapshot, filter::Sieve},
};

/// Above this share of all shapes, the changed ones do not ask one by one: all pairs are enumerated and the others left
/// out, which enumerates the same pairs.
const SHARE_ASKED_TOGETHER: usize = 4;

/// A pair of the old and of the new version.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Persisted {
    /// As it is.
    pub pair: Pair,
    /// What was known in the old version.
    pub before: Certificate,
}

/// How the pairs of one version came from those of another. All lists ascend by ids. What is `Undecided` counts as a pair,
/// as in [`Snapshot::pairs`]; whoever follows proofs only reads the certificates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PairChanges {
    /// Pairs of the new version only.
    pub began: Vec<Pair>,
    /// Pairs of both versions of which at least one shape changed. Those of two unchanged shapes persist too, bit by bit,
    /// and are not listed.
    pub persisted: Vec<Persisted>,
    /// Pairs of the old version only, as they were there.
    pub ended: Vec<Pair>,
}

impl PairChanges {
    /// Compares the pairs of the changed shapes, before and after; both ascend by ids.
    pub(super) fn between(before: &[Pair], after: &[Pair]) -> Self {
        let mut changes = Self::default();
        let (mut before, mut after) = (before.iter().peekable(), after.iter().peekable());
        loop {
            let order = match (before.peek(), after.peek()) {
                (None, None) => return changes,
                (Some(_), None) => Ordering::Less,
                (None, Some(_)) => Ordering::Greater,
                (Some(old), Some(new)) => old.ids().cmp(&new.ids()),
            };
            let old = if order.is_le() { before.next() } else { None };
            let new = if order.is_ge() { after.next() } else { None };
            match (old, new) {
                (Some(old), Some(new)) => {
                    changes.persisted.push(Persisted { pair: *new, before: old.certificate });
                }
                (old, new) => {
                    changes.ended.extend(old);
                    changes.began.extend(new);
                }
            }
        }
    }
}

impl Snapshot {
    /// How the pairs of this version came from those of `old`, which may be any version of any world: the answer depends on
    /// the two alone. The cost is that of the pages and shapes that differ, in both versions.
    ///
    /// # Errors
    /// [`QuestionError::TooManyPairs`], of the changed shapes in one of the versions; [`QuestionError::Interrupted`].
    pub fn pairs_since(
        &self,
        old: &Self,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<PairChanges, QuestionError> {
        let changed = self.changed_since(old);
        let before = old.pairs_of(&changed, filter, accuracy, |_, _| true, meter)?;
        let after = self.pairs_of(&changed, filter, accuracy, |_, _| true, meter)?;
        Ok(PairChanges::between(&before, &after))
    }

    /// The pairs that have one of `ids`, which ascend, and that are wanted, as [`Snapshot::pairs`] lists them. Ids that are
    /// not there have none.
    pub(in crate::world) fn pairs_of(
        &self,
        ids: &[ShapeId],
        filter: &Filter,
        accuracy: &Accuracy,
        is_wanted: impl Fn(ShapeId, ShapeId) -> bool,
        meter: &mut Meter<'_>,
    ) -> Result<Vec<Pair>, QuestionError> {
        let _asking = self.asking().now();
        let is_asked = |id: ShapeId| ids.binary_search(&id).is_ok();
        let mut judge = Judge::new(accuracy, meter);
        if ids.len() * SHARE_ASKED_TOGETHER > self.len() {
            self.each_box_pair(filter, meter, |meter, a, b| {
                let (id_a, id_b) = (id_of(&a), id_of(&b));
                if (is_asked(id_a) || is_asked(id_b)) && is_wanted(id_a, id_b) {
                    judge.take(&a, &b, meter)
                } else {
                    Ok(())
                }
            })?;
            return Ok(judge.into_sorted());
        }
        let sieve = Sieve::new(filter, None);
        for &id in ids {
            self.each_partner(id, &sieve, meter, |meter, a, b| {
                // Of two that are asked both find the pair.
                let is_found_twice = is_asked(id_of(&b));
                let is_first = !is_found_twice || id < id_of(&b);
                if is_first && is_wanted(id, id_of(&b)) { judge.take(&a, &b, meter) } else { Ok(()) }
            })?;
        }
        Ok(judge.into_sorted())
    }
}
