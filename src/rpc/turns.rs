//! How a long call shares its thread: it works for a while, then gives way to others.
//!
//! # Method
//! A call that gives way is taken over by another thread, which goes on with cold caches: at a millisecond of work a turn that cost a
//! fifth of all work, for nothing where that other thread was free to serve whoever comes. So a call keeps its thread while fewer
//! calls are at work than there are threads, and gives way after the short turn only where all threads are taken.
//!
//! A free thread serves nobody while it sleeps: of the threads of the runtime one waits for the sockets, and if just that one took
//! up this call, the others sleep until somebody wakes them. So a call that keeps its thread wakes another now and then, which finds
//! nothing to do and goes to wait for the sockets. Without that a small question beside batches of 10 ms waited for their end. Not
//! sooner than after a millisecond: who waits for the sockets takes up the next call of the same client too, with cold caches.
//!
//! What the count does not know (a single question of a stream that takes long) is why there is a long turn at all.

use std::time::{Duration, Instant};

use tokio::runtime::Handle;

use crate::{compute::AtWork, deadline::Deadline, problem::Checked};

/// How long a call works before it gives way where every thread is taken.
const SHORT_TURN: Duration = Duration::from_micros(100);

/// How long it works where a thread is free.
const LONG_TURN: Duration = Duration::from_millis(10);

/// For how long a thread that was woken is taken to be awake, or waiting for the sockets.
const AWAKE: Duration = Duration::from_millis(1);

/// The turns of one call.
#[derive(Debug)]
pub(super) struct Turns {
    began: Instant,
    /// When it was seen to that others are served.
    looked: Instant,
    /// When another thread was woken, or could wait for the sockets by itself.
    woke: Instant,
    deadline: Deadline,
    thread_count: usize,
    at_work: Option<AtWork>,
}

impl Turns {
    /// Begins the first turn of a call that works from now on.
    pub(super) fn begun(deadline: Deadline) -> Self {
        let now = Instant::now();
        let thread_count = Handle::current().metrics().num_workers();
        Self { began: now, looked: now, woke: now, deadline, thread_count, at_work: Some(AtWork::begin()) }
    }

    /// Pauses: the call waits, or hands its work to who has turns of its own.
    pub(super) fn pause(&mut self) {
        self.at_work = None;
    }

    /// Begins a turn after a pause, in which others had theirs.
    pub(super) fn resume(&mut self) {
        self.at_work.get_or_insert_with(AtWork::begin);
        self.begin();
    }

    fn begin(&mut self) {
        let now = Instant::now();
        (self.began, self.looked, self.woke) = (now, now, now);
    }

    /// Gives way if the turn is over. Here a call that was cancelled ends, and others get their turn.
    ///
    /// # Errors
    /// The deadline has passed.
    pub(super) async fn next(&mut self) -> Checked<()> {
        if self.is_over() { self.give_way().await } else { Ok(()) }
    }

    /// Whether the short turn is over.
    pub(super) fn is_over(&self) -> bool {
        self.looked.elapsed() > SHORT_TURN
    }

    async fn give_way(&mut self) -> Checked<()> {
        let now = Instant::now();
        self.looked = now;
        if now - self.began > LONG_TURN || AtWork::count() >= self.thread_count {
            tokio::task::yield_now().await;
            self.begin();
        } else if now - self.woke > AWAKE {
            self.woke = now;
            wake_a_thread();
        }
        if self.deadline.is_ahead() { Ok(()) } else { Err(Deadline::problem()) }
    }
}

/// Wakes a thread of the runtime that sleeps, if there is one. Two tasks, as the last one that a thread makes is kept for itself, and
/// nobody is woken for that.
fn wake_a_thread() {
    for _ in 0..2 {
        drop(tokio::spawn(async {}));
    }
}
