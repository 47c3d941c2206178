//! Which pairs of shapes overlap.
//!
//! # Method
//! The shapes that changed are asked again with all their partners; what was a pair of one of them and is not found so has
//! ended. What bullets touched on their ways is swept as when the tick was made.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    Change, Step, WatchedPairs,
    judge::{Hold, Outcome, Outcomes, Passing, Terms},
};
use crate::{
    answer::Verdict,
    world::{Filter, Meter, PAIRS_MAX, QuestionError, ShapeId, pairs::want_each_other, tracks::Tracks},
};

/// The pairs of a watcher.
#[derive(Debug)]
pub(super) struct Pairs {
    /// Only pairs with one of these, by id; `None` is all.
    only: Option<Vec<ShapeId>>,
    /// Each pair under both orders of its ids, so that the partners of a shape lie together.
    partners: BTreeMap<(ShapeId, ShapeId), Hold>,
    /// How many are kept without a proof.
    kept_count: usize,
}

impl Pairs {
    /// `None` if no pairs are watched.
    pub(super) fn new(watched: WatchedPairs) -> Option<Self> {
        let only = match watched {
            WatchedPairs::Nothing => return None,
            WatchedPairs::All => None,
            WatchedPairs::Of(mut ids) => {
                ids.sort_unstable();
                ids.dedup();
                Some(ids)
            }
        };
        Some(Self { only, partners: BTreeMap::new(), kept_count: 0 })
    }

    /// What becomes of all that the step may have changed.
    pub(super) fn look(
        &self,
        step: &Step<'_>,
        terms: &Terms,
        meter: &mut Meter<'_>,
    ) -> Result<Outcomes<ShapeId>, QuestionError> {
        let (new, filter, accuracy) = (step.new, Filter::default(), &terms.accuracy);
        let wants = |a: ShapeId, b: ShapeId| self.wants(a, b);
        let found = match (step.old, &self.only) {
            (None, None) => new.pairs(&filter, accuracy, meter)?,
            (None, Some(only)) => new.pairs_of(only, &filter, accuracy, wants, meter)?,
            (Some(_), _) => new.pairs_of(&step.passage.changed, &filter, accuracy, wants, meter)?,
        };
        let passed = self.passed(step);
        let found: BTreeMap<_, _> = found.iter().map(|pair| ((pair.a, pair.b), pair.certificate.verdict)).collect();
        let keys: BTreeSet<_> = found.keys().chain(&passed).copied().chain(self.of_changed(step)).collect();
        let mut outcomes = Outcomes::default();
        for key in keys {
            let passing = if passed.contains(&key) { Passing::Seen } else { Passing::NotSeen };
            let verdict = found.get(&key).copied().unwrap_or(Verdict::Miss);
            outcomes.insert(key, self.judge(key, passing, verdict, (step, terms), meter)?);
        }
        let grown = outcomes.values().filter(|outcome| outcome.change == Some(Change::Came)).count();
        if self.partners.len() / 2 + grown > PAIRS_MAX { Err(QuestionError::TooManyPairs) } else { Ok(outcomes) }
    }

    /// All pairs.
    pub(super) fn all(&self) -> BTreeMap<(ShapeId, ShapeId), Change> {
        let once = self.partners.keys().filter(|(a, b)| a < b);
        once.map(|key| (*key, Change::Came)).collect()
    }

    /// Whether all pairs are proved to be.
    pub(super) fn is_proved(&self) -> bool {
        self.kept_count == 0
    }

    fn wants(&self, a: ShapeId, b: ShapeId) -> bool {
        let Some(only) = &self.only else { return true };
        [a, b].iter().any(|id| only.binary_search(id).is_ok())
    }

    /// The pairs that a bullet of them touched on its way, proved.
    fn passed(&self, step: &Step<'_>) -> BTreeSet<(ShapeId, ShapeId)> {
        let Some(old) = step.old.filter(|old| old.bullet_count() > 0) else { return BTreeSet::new() };
        let swept = Tracks::of(&step.passage).sweep(old, step.new);
        let hits = swept.hits.iter().filter(|hit| hit.impact.touch.certificate.verdict == Verdict::Hit);
        let pairs = hits.filter_map(|hit| Some((hit.bullet, hit.impact.id?)));
        // Of two that stayed where they were nothing is found anew.
        let is_asked =
            |&(a, b): &(ShapeId, ShapeId)| self.wants(a, b) && (step.passage.changed(a) || step.passage.changed(b));
        pairs.map(|(a, b)| (a.min(b), a.max(b))).filter(is_asked).collect()
    }

    /// The pairs that there were of shapes that changed.
    fn of_changed(&self, step: &Step<'_>) -> impl Iterator<Item = (ShapeId, ShapeId)> {
        let of = |&id: &ShapeId| self.partners.range((id, ShapeId::MIN)..=(id, ShapeId::MAX));
        step.passage.changed.iter().flat_map(of).map(|(&(a, b), _)| (a.min(b), a.max(b)))
    }

    fn judge(
        &self,
        (a, b): (ShapeId, ShapeId),
        passing: Passing,
        verdict: Verdict,
        (step, terms): (&Step<'_>, &Terms),
        meter: &mut Meter<'_>,
    ) -> Result<Outcome, QuestionError> {
        let was = self.partners.get(&(a, b)).copied();
        let ends = step.new.find(a).zip(step.new.find(b));
        let is_pair = |a, b| Some(want_each_other(a, b));
        match ends.filter(|(a, b)| a.shape.zip(b.shape).and_then(|(a, b)| is_pair(a, b)) == Some(true)) {
            Some((a, b)) => terms.settle(was, passing, verdict, [&a, &b], meter),
            None => Ok(Outcome::gone(was)),
        }
    }

    fn take(&mut self, outcomes: Outcomes<ShapeId>) -> BTreeMap<(ShapeId, ShapeId), Change> {
        let mut changes = BTreeMap::new();
        for ((a, b), Outcome { hold, change }) in outcomes {
            let mut was = None;
            for key in [(a, b), (b, a)] {
                was = match hold {
                    Some(hold) => self.partners.insert(key, hold),
                    None => self.partners.remove(&key),
                };
            }
            self.kept_count += usize::from(hold == Some(Hold::Kept));
            self.kept_count -= usize::from(was == Some(Hold::Kept));
            changes.extend(change.map(|change| ((a, b), change)));
        }
        changes
    }
}

/// Takes what was found for true, and says what changed.
pub(super) fn take(pairs: &mut Option<Pairs>, outcomes: Outcomes<ShapeId>) -> BTreeMap<(ShapeId, ShapeId), Change> {
    pairs.as_mut().map(|pairs| pairs.take(outcomes)).unwrap_or_default()
}
