//! The spans that were built because somebody asked for the past, shared by all versions of a world.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use super::{
    super::{Tick, ledger::Ledger, state::State},
    History,
    build::build,
    span::Span,
    track::SPAN_TICKS,
};

/// The spans that were built.
#[derive(Debug)]
pub(in crate::world) struct Kept {
    spans: Mutex<Vec<KeptSpan>>,
    /// What they may hold in memory; the one that was built last is kept whatever it holds.
    most_bytes: u64,
    /// What building them costs.
    pub(in crate::world) ledger: Ledger,
}

#[derive(Debug)]
struct KeptSpan {
    first: Tick,
    last: Tick,
    /// Built by whoever comes first; others wait for it.
    cell: Arc<OnceLock<Arc<Span>>>,
}

/// What a reader has to build from: the version that it holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground<'a> {
    pub(super) state: &'a State,
    pub(super) newest: Tick,
    pub(super) history: &'a History,
}

impl Kept {
    /// None yet; they may hold so many bytes together.
    pub(in crate::world) fn new(most_bytes: u64, ledger: Ledger) -> Self {
        Self { spans: Mutex::default(), most_bytes, ledger }
    }

    /// The span that holds a moment between `tick` and `next`, which is `tick` itself for an exact one. Built, if it is
    /// not there, from what the reader holds.
    pub(super) fn span(&self, tick: Tick, next: Tick, ground: Ground<'_>) -> Arc<Span> {
        let begin = tick.get() / SPAN_TICKS * SPAN_TICKS;
        let first = Tick::new(begin).unwrap_or(Tick::MIN).max(ground.history.oldest(ground.newest));
        let last = Tick::new(begin + SPAN_TICKS).unwrap_or(Tick::MIN).min(ground.newest);
        let cell = self.cell(tick, next, (first, last));
        if let Some(span) = cell.get() {
            return Arc::clone(span);
        }
        let mut is_new = false;
        let span = cell.get_or_init(|| {
            is_new = true;
            let made = || build((ground.state, ground.newest), ground.history, first, last);
            Arc::new(self.ledger.time(ground.newest, made))
        });
        if is_new {
            self.keep_within(ground.state);
        }
        Arc::clone(span)
    }

    /// Lets those go that hold nothing from `oldest` on: nobody who reads the newest version can ask for them.
    pub(in crate::world) fn forget_before(&self, oldest: Tick) {
        self.lock().retain(|kept| kept.last > oldest);
    }

    /// Whether the span that holds a moment is built.
    pub(super) fn has(&self, tick: Tick, next: Tick) -> bool {
        self.lock().iter().any(|kept| kept.holds(tick, next) && kept.cell.get().is_some())
    }

    /// How many there are, and what they hold in memory besides what `newest` shares with them, bytes.
    pub(in crate::world) fn holds(&self, newest: &State) -> (u64, u64) {
        let spans = self.lock();
        let built = spans.iter().filter_map(|kept| kept.cell.get());
        built.fold((0, 0), |(count, bytes), span| (count + 1, bytes + span.bytes_beside(newest)))
    }

    /// The place of a span that serves a moment.
    fn cell(&self, tick: Tick, next: Tick, (first, last): (Tick, Tick)) -> Arc<OnceLock<Arc<Span>>> {
        let mut spans = self.lock();
        let serves = |kept: &KeptSpan| {
            // One that is not built yet might be built by this reader, who may hold other records than it needs.
            let is_ready = kept.cell.get().is_some() || (kept.first, kept.last) == (first, last);
            kept.holds(tick, next) && is_ready
        };
        if let Some(place) = spans.iter().position(serves) {
            // The one that was used last is last.
            spans[place..].rotate_left(1);
            return spans.last().map(|kept| Arc::clone(&kept.cell)).unwrap_or_default();
        }
        let cell = Arc::default();
        spans.retain(|kept| kept.number() != tick.get() / SPAN_TICKS || kept.last > last);
        spans.push(KeptSpan { first, last, cell: Arc::clone(&cell) });
        cell
    }

    /// Lets those go that were used longest ago, until the rest is within what they may hold.
    fn keep_within(&self, newest: &State) {
        let mut spans = self.lock();
        let bytes = |kept: &KeptSpan| kept.cell.get().map_or(0, |span| span.bytes_beside(newest));
        while spans.len() > 1 && spans.iter().map(bytes).sum::<u64>() > self.most_bytes {
            spans.remove(0);
        }
    }

    /// A reader that panicked left a list that is whole: it is changed in single steps.
    fn lock(&self) -> MutexGuard<'_, Vec<KeptSpan>> {
        self.spans.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl KeptSpan {
    /// Whether it holds a moment between `tick` and `next`.
    fn holds(&self, tick: Tick, next: Tick) -> bool {
        self.first <= tick && next <= self.last && tick.get() / SPAN_TICKS == self.number()
    }

    /// Which of the spans of all time it is.
    fn number(&self) -> u64 {
        self.first.get() / SPAN_TICKS
    }
}
