//! What a world was at earlier ticks: what each tick changed, and how a past moment is asked.
//!
//! # Method
//! Each tick keeps what its changes undid: 64 bytes for a move, the whole shape for one that was removed or replaced. A
//! snapshot holds the records of the ticks before it, which it shares with its neighbours, so readers need no lock and
//! no version waits for another. Nothing else is kept until somebody asks for the past: then the first question builds a
//! [`span::Span`] of a few ticks, which serves all further questions to that time, whichever snapshot they come through.
//!
//! # Limits
//! The oldest records go when there are more than the settings say, or more bytes than the means allow.

mod build;
mod kept;
mod passage;
mod past;
mod record;
mod retold;
mod span;
mod track;

use std::sync::Arc;

pub(super) use self::{
    kept::Kept,
    passage::Passage,
    past::Past,
    record::{Changes, Record},
};
use super::{Tick, Time, state::State};
use crate::pages::Pages;

/// Which moment of a world is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// Exactly this tick.
    Tick(Tick),
    /// Between this tick and the next: how far on, from 0 to below 1.
    Between(Tick, f64),
    /// At this time: between the last tick at or before it and the next, by the time that passed. After the newest tick
    /// it is the newest: nothing is extrapolated.
    Time(Time),
}

/// Why a moment cannot be asked.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum HistoryError {
    /// The tick is no longer held.
    #[error("tick {asked} is no longer held: the oldest is {oldest}, the newest {newest}")]
    Gone {
        /// What was asked for.
        asked: Tick,
        /// The oldest tick that is held.
        oldest: Tick,
        /// The newest tick.
        newest: Tick,
    },
    /// The time is before that of the oldest tick that is held.
    #[error("that time is before the oldest tick held: the oldest is {oldest}, the newest {newest}")]
    TimeGone {
        /// The oldest tick that is held.
        oldest: Tick,
        /// The newest tick.
        newest: Tick,
    },
    /// The tick is not made yet.
    #[error("tick {asked} is not made yet: the oldest is {oldest}, the newest {newest}")]
    NotMade {
        /// What was asked for.
        asked: Tick,
        /// The oldest tick that is held.
        oldest: Tick,
        /// The newest tick.
        newest: Tick,
    },
    /// After the newest tick there is nothing to go on towards.
    #[error("there is no tick after {newest} yet, and nothing is extrapolated: the oldest is {oldest}")]
    NothingAfter {
        /// The oldest tick that is held.
        oldest: Tick,
        /// The newest tick.
        newest: Tick,
    },
    /// The fraction is not from 0 to below 1.
    #[error("fraction is {0}: it must be from 0 to below 1")]
    Fraction(f64),
}

/// How much history is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bounds {
    /// Ticks besides the newest.
    pub(super) ticks: u32,
    /// Bytes of all records.
    pub(super) bytes: u64,
}

/// The records of the ticks before a snapshot. Clones share them.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    /// A ring: what led to tick `k` is in place `k` modulo the length.
    ring: Pages<Option<Arc<Record>>>,
    /// How many records there are.
    len: u64,
    /// What they hold, bytes.
    bytes: u64,
    /// What came since the last whole version among them.
    bytes_since_keyframe: u64,
}

impl History {
    /// The history one tick on, with what led to `newest`, which is `state`.
    pub(super) fn with(&self, newest: Tick, mut record: Record, state: &State, bounds: Bounds) -> Self {
        let mut next = if self.ring.len() == bounds.ticks as usize {
            self.clone()
        } else {
            self.resized(Tick::new(newest.get() - 1).unwrap_or(Tick::MIN), bounds)
        };
        if bounds.ticks > 0 {
            next.bytes_since_keyframe += record.memory_bytes();
            if next.bytes_since_keyframe > 2 * state.memory_bytes() {
                next.bytes_since_keyframe = 0;
                record.keyframe = Some(Box::new(state.clone()));
            }
            next.insert(newest, Arc::new(record));
            next.shorten(newest, bounds.bytes);
        }
        next
    }

    /// The newest of the records, as many as `bounds` allow from now on.
    pub(super) fn resized(&self, newest: Tick, bounds: Bounds) -> Self {
        let mut resized = Self::default();
        for _ in 0..bounds.ticks {
            resized.ring.push(None);
        }
        for back in (0..self.len.min(u64::from(bounds.ticks))).rev() {
            if let Some(tick) = Tick::new(newest.get() - back)
                && let Some(record) = self.record(tick)
            {
                resized.insert(tick, Arc::clone(record));
            }
        }
        resized.shorten(newest, bounds.bytes);
        resized
    }

    /// What led to `tick` from the one before, if that is held. A tick after the newest is nobody's to ask.
    pub(super) fn record(&self, tick: Tick) -> Option<&Arc<Record>> {
        let place = self.place(tick)?;
        self.ring[place].as_ref()
    }

    /// The oldest tick that can be asked.
    pub(super) fn oldest(&self, newest: Tick) -> Tick {
        Tick::new(newest.get() - self.len).unwrap_or(Tick::MIN)
    }

    /// How many ticks it holds besides the newest.
    pub(super) fn len(&self) -> u64 {
        self.len
    }

    /// Bytes it holds in memory, what it shares included.
    pub(super) fn memory_bytes(&self) -> u64 {
        self.bytes + self.ring.memory_bytes()
    }

    /// The time between a held tick and the next, the later ones of equal names being those of `newest`.
    pub(super) fn time_between(&self, tick: Tick, fraction: f64, newest: (Tick, Time)) -> Time {
        let time = |tick: Tick| if tick >= newest.0 { newest.1 } else { self.time_of(tick).unwrap_or(newest.1) };
        let begin = time(tick);
        if fraction <= 0.0 {
            return begin;
        }
        Time(begin.0 + ((time(tick.saturating_add(1)).0 - begin.0) as f64 * fraction) as i64)
    }

    /// When a tick before the newest was made.
    fn time_of(&self, tick: Tick) -> Option<Time> {
        self.record(tick.saturating_add(1)).map(|record| record.time_before)
    }

    /// The tick and the fraction of a time, from `oldest` to `newest`; `None` if it is before all that is held.
    pub(super) fn at_time(&self, time: Time, newest: (Tick, Time)) -> Option<(Tick, f64)> {
        let (newest, newest_time) = newest;
        if time >= newest_time {
            return Some((newest, 0.0));
        }
        let (mut low, mut low_time) = (self.oldest(newest), self.time_of(self.oldest(newest))?);
        let (mut high, mut high_time) = (newest, newest_time);
        if low_time > time {
            return None;
        }
        // The last tick at or before the time.
        while high.get() - low.get() > 1 {
            let middle = low.saturating_add((high.get() - low.get()) / 2);
            let found = self.time_of(middle)?;
            if found <= time {
                (low, low_time) = (middle, found);
            } else {
                (high, high_time) = (middle, found);
            }
        }
        let (passed, whole) =
            (i128::from(time.0) - i128::from(low_time.0), i128::from(high_time.0) - i128::from(low_time.0));
        // Many years round; the next tick has its own name.
        Some((low, (passed as f64 / whole as f64).min(1.0_f64.next_down())))
    }

    fn place(&self, tick: Tick) -> Option<usize> {
        (self.len > 0 || self.ring.len() > 0).then(|| (tick.get() % (self.ring.len() as u64).max(1)) as usize)
    }

    /// Puts a record where the oldest was, if the ring is full.
    fn insert(&mut self, tick: Tick, record: Arc<Record>) {
        let Some(place) = self.place(tick) else { return };
        self.bytes += record.memory_bytes();
        self.len += 1;
        if let Some(oldest) = self.ring[place].replace(record) {
            self.bytes -= oldest.memory_bytes();
            self.len -= 1;
        }
    }

    /// Lets the oldest go until the rest holds at most so many bytes.
    fn shorten(&mut self, newest: Tick, most_bytes: u64) {
        while self.bytes > most_bytes && self.len > 0 {
            let oldest = self.oldest(newest).saturating_add(1);
            if let Some(place) = self.place(oldest)
                && let Some(record) = self.ring[place].take()
            {
                self.bytes -= record.memory_bytes();
            }
            self.len -= 1;
        }
    }
}
