//! What building something costs, and when it was first needed.

use std::sync::atomic::{AtomicU64, Ordering};

use super::Tick;
use crate::shape::Clock;

/// What building something cost in all versions of a world, and when it was first needed.
#[derive(Debug)]
pub(super) struct Ledger {
    clock: Option<Clock>,
    nanoseconds: AtomicU64,
    /// [`u64::MAX`] before.
    first_tick: AtomicU64,
}

impl Default for Ledger {
    fn default() -> Self {
        Self::new(None)
    }
}

impl Ledger {
    /// With the clock that is read, if there is one.
    pub(super) fn new(clock: Option<Clock>) -> Self {
        Self { clock, nanoseconds: AtomicU64::new(0), first_tick: AtomicU64::new(u64::MAX) }
    }

    /// Builds what is needed at a tick, and notes what that takes.
    pub(super) fn time<T>(&self, tick: Tick, build: impl FnOnce() -> T) -> T {
        // Whoever asks an older version may come later.
        self.first_tick.fetch_min(tick.get(), Ordering::Relaxed);
        let Some(clock) = self.clock else { return build() };
        let begin = clock();
        let built = build();
        let took = u64::try_from(clock().saturating_sub(begin)).unwrap_or(0);
        self.nanoseconds.fetch_add(took, Ordering::Relaxed);
        built
    }

    /// What it took so far, nanoseconds; `None` without a clock.
    pub(super) fn nanoseconds(&self) -> Option<u64> {
        self.clock.map(|_| self.nanoseconds.load(Ordering::Relaxed))
    }

    /// When the first was needed.
    pub(super) fn first_tick(&self) -> Option<Tick> {
        Tick::new(self.first_tick.load(Ordering::Relaxed)).filter(|tick| *tick < Tick::MAX)
    }
}
