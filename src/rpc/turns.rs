//! How a long call shares its thread: it works for a while, then gives way to others.
//!
//! # Method
//! A call that gives way wakes another thread, which takes the call over and goes on with cold caches: at 100 µs of work a turn that
//! costs a sixth of all work, for nothing where that other thread was free to serve whoever comes. So a call keeps its thread while
//! there are fewer calls at work than threads, and gives way after the short turn only where all threads are taken. What this count
//! does not know (a single question that takes long, an edit) is why there is a long turn at all, not none.

use std::{
    sync::atomic::{AtomicUsize, Ordering},
    time::{Duration, Instant},
};

use tokio::runtime::Handle;

use crate::{deadline::Deadline, problem::Checked};

/// How long a call works before it gives way where every thread is taken.
const SHORT_TURN: Duration = Duration::from_micros(100);

/// How long it works where a thread is free.
const LONG_TURN: Duration = Duration::from_millis(1);

/// Calls that work through a list of items right now, in this process.
static AT_WORK: AtomicUsize = AtomicUsize::new(0);

/// Counts a call among those at work as long as it lives.
#[derive(Debug)]
struct AtWork;

impl AtWork {
    fn begin() -> Self {
        AT_WORK.fetch_add(1, Ordering::Relaxed);
        Self
    }
}

impl Drop for AtWork {
    fn drop(&mut self) {
        AT_WORK.fetch_sub(1, Ordering::Relaxed);
    }
}

/// The turns of one call.
#[derive(Debug)]
pub(super) struct Turns {
    began: Instant,
    deadline: Deadline,
    thread_count: usize,
    at_work: Option<AtWork>,
}

impl Turns {
    /// Begins the first turn of a call that works from now on without a pause.
    pub(super) fn at_work(deadline: Deadline) -> Self {
        Self { at_work: Some(AtWork::begin()), ..Self::of_stream(deadline) }
    }

    /// Begins the first turn of a call that waits for its items, and is not counted, so that idle streams take no thread.
    pub(super) fn of_stream(deadline: Deadline) -> Self {
        let thread_count = Handle::current().metrics().num_workers();
        Self { began: Instant::now(), deadline, thread_count, at_work: None }
    }

    /// Gives way if the turn is over. Here a call that was cancelled ends, and others get their turn.
    ///
    /// # Errors
    /// The deadline has passed.
    pub(super) async fn next(&mut self) -> Checked<()> {
        let worked = self.began.elapsed();
        if worked <= SHORT_TURN {
            return Ok(());
        }
        if worked > LONG_TURN || !self.leaves_a_thread() {
            tokio::task::yield_now().await;
            self.began = Instant::now();
        }
        if self.deadline.is_ahead() { Ok(()) } else { Err(Deadline::problem()) }
    }

    fn leaves_a_thread(&self) -> bool {
        let this = usize::from(self.at_work.is_none());
        AT_WORK.load(Ordering::Relaxed) + this < self.thread_count
    }
}
