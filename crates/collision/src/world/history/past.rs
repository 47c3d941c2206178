//! A past moment of a world: what a snapshot of it is made of.

use std::{
    borrow::Cow,
    sync::{Arc, OnceLock},
};

use super::{
    super::{
        Shape, ShapeId, Snapshot, Tick,
        search::Side,
        snapshot::Content,
        state::State,
        store::{Entry, Slot},
    },
    HistoryError, Moment,
    kept::Ground,
    span::{Instant, Rest, Span},
};
use crate::{broad::StaticTree, math::Pose};

/// A past moment of a world.
#[derive(Debug)]
pub(in crate::world) struct Past {
    span: Arc<Span>,
    instant: Instant,
    /// The version that it was asked of.
    newest: Arc<Snapshot>,
    /// Everything as it was, for what is no question: built when first needed.
    whole: OnceLock<State>,
}

impl Past {
    /// The version that it was asked of.
    pub(super) fn newest(&self) -> &Snapshot {
        &self.newest
    }

    /// The state whose trees are searched, less the slots that are overridden.
    pub(in crate::world) fn base(&self) -> &State {
        &self.span.base
    }

    /// Whether the tree over what moves in the base is to be searched too.
    pub(in crate::world) fn searches_moving(&self) -> bool {
        self.span.rest == Rest::InBothTrees
    }

    /// What is in a slot of the base, unless it was something else then.
    pub(in crate::world) fn entry_in(&self, slot: Slot) -> Option<&Entry> {
        (!self.span.is_overridden(slot)).then(|| self.base().shapes.entry(slot))
    }

    /// The tree over what was otherwise.
    pub(in crate::world) fn tree(&self) -> &StaticTree {
        &self.span.tree
    }

    /// What a leaf of that tree was; `None` if it was not there.
    pub(in crate::world) fn side_of(&self, leaf: u32) -> Option<Side<'_>> {
        self.span.side(leaf, self.instant)
    }

    /// A shape.
    pub(in crate::world) fn find(&self, id: ShapeId) -> Option<Side<'_>> {
        self.span.find(id, self.instant)
    }

    /// A shape at the tick at or before, and where it went from there.
    fn way(&self, id: ShapeId) -> Option<(Side<'_>, Option<Pose>)> {
        self.span.way(id, self.instant)
    }

    /// A shape, with its velocities.
    pub(in crate::world) fn shape(&self, id: ShapeId) -> Option<Cow<'_, Shape>> {
        self.span.find_shape(id, self.instant)
    }

    /// Everything as it was. The first call costs what changed since.
    pub(in crate::world) fn whole(&self) -> &State {
        self.whole.get_or_init(|| self.span.whole(self.instant))
    }
}

impl Snapshot {
    /// The world at an earlier moment, as a snapshot that answers all questions: as it was answered when that tick was the
    /// newest, bit by bit, and between two ticks with interpolated poses. Of a shape that was inserted, replaced or
    /// teleported by the later tick, and of everything but poses, what was at the earlier tick holds. Asked of a past
    /// moment it is the same as asked of the snapshot that it came from.
    ///
    /// The first question to a time prepares a span of a few ticks, about 0.5 µs for each shape that changed since; what
    /// comes after costs next to nothing.
    ///
    /// # Errors
    /// A moment that is not held, or not made yet.
    pub fn at(self: &Arc<Self>, moment: Moment) -> Result<Arc<Self>, HistoryError> {
        let state = match &self.content {
            Content::Now(state) => state,
            Content::Then(past) => return past.newest.at(moment),
        };
        let (tick, fraction) = self.tick_of(moment)?;
        if tick == self.tick {
            return Ok(Arc::clone(self));
        }
        let next = if fraction > 0.0 { tick.saturating_add(1) } else { tick };
        let ground = Ground { state, newest: self.tick, history: &self.history };
        let span = self.kept.span(tick, next, ground);
        let instant = Instant { at: (tick.get() - span.first.get()) as u8, fraction };
        let time = self.history.time_between(tick, fraction, (self.tick, self.time));
        let past = Past { span, instant, newest: Arc::clone(self), whole: OnceLock::new() };
        Ok(Arc::new(Self {
            tick,
            fraction,
            time,
            content: Content::Then(past),
            history: Arc::clone(&self.history),
            kept: Arc::clone(&self.kept),
            moving_since: self.moving_since,
            history_since: self.history_since,
            settings: self.settings,
            means: self.means,
        }))
    }

    /// Whether [`Snapshot::at`] gives a moment without preparing anything.
    #[must_use]
    pub fn is_prepared(&self, moment: Moment) -> bool {
        match (&self.content, self.tick_of(moment)) {
            (Content::Then(past), _) => past.newest.is_prepared(moment),
            (Content::Now(_), Err(_)) => true,
            (Content::Now(_), Ok((tick, fraction))) => {
                let next = if fraction > 0.0 { tick.saturating_add(1) } else { tick };
                tick == self.tick || self.kept.has(tick, next)
            }
        }
    }

    /// A shape at the tick at or before this moment, and where it went from there by the next tick; `None` there if it stood until
    /// then, or if this moment is that tick.
    pub(in crate::world) fn way(&self, id: ShapeId) -> Option<(Side<'_>, Option<Pose>)> {
        match &self.content {
            Content::Now(_) => self.find(id).map(|side| (side, None)),
            Content::Then(past) => past.way(id),
        }
    }

    /// The oldest tick that [`Snapshot::at`] can give.
    #[must_use]
    pub fn oldest_tick(&self) -> Tick {
        match &self.content {
            Content::Now(_) => self.history.oldest(self.tick),
            Content::Then(past) => past.newest.oldest_tick(),
        }
    }

    /// The newest tick that [`Snapshot::at`] can give.
    #[must_use]
    pub fn newest_tick(&self) -> Tick {
        match &self.content {
            Content::Now(_) => self.tick,
            Content::Then(past) => past.newest.tick,
        }
    }

    fn tick_of(&self, moment: Moment) -> Result<(Tick, f64), HistoryError> {
        let (oldest, newest) = (self.history.oldest(self.tick), self.tick);
        let (tick, fraction) = match moment {
            Moment::Tick(tick) => (tick, 0.0),
            Moment::Between(tick, fraction) => (tick, fraction),
            Moment::Time(time) => {
                let found = self.history.at_time(time, (newest, self.time));
                return found.ok_or(HistoryError::TimeGone { oldest, newest });
            }
        };
        if !(0.0..1.0).contains(&fraction) {
            Err(HistoryError::Fraction(fraction))
        } else if tick < oldest {
            Err(HistoryError::Gone { asked: tick, oldest, newest })
        } else if tick > newest {
            Err(HistoryError::NotMade { asked: tick, oldest, newest })
        } else if tick == newest && fraction > 0.0 {
            Err(HistoryError::NothingAfter { oldest, newest })
        } else {
            Ok((tick, fraction))
        }
    }
}
