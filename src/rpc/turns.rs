//! How a long call shares its thread: it works for a while, then gives way to others.
//!
//! # Method
//! Each thread looks at the sockets of its connections itself ([`crate::workers`]), so a call that gives way lets whoever has come have
//! a turn, and goes on where it was.

use std::time::{Duration, Instant};

use crate::{compute::AtWork, deadline::Deadline, problem::Checked};

/// How long a call works before it gives way. Longer keeps small questions waiting; shorter looks at the sockets more often, which takes
/// a microsecond.
const TURN: Duration = Duration::from_micros(100);

/// The turns of one call.
#[derive(Debug)]
pub(super) struct Turns {
    began: Instant,
    deadline: Deadline,
    at_work: Option<AtWork>,
}

impl Turns {
    /// Begins the first turn of a call that works from now on.
    pub(super) fn begun(deadline: Deadline) -> Self {
        Self { began: Instant::now(), deadline, at_work: Some(AtWork::begin()) }
    }

    /// Pauses: the call waits, or hands its work to who has turns of its own.
    pub(super) fn pause(&mut self) {
        self.at_work = None;
    }

    /// Begins a turn after a pause, in which others had theirs.
    pub(super) fn resume(&mut self) {
        self.at_work.get_or_insert_with(AtWork::begin);
        self.began = Instant::now();
    }

    /// Gives way if the turn is over. Here a call that was cancelled ends, and others get their turn.
    ///
    /// # Errors
    /// The deadline has passed.
    pub(super) async fn next(&mut self) -> Checked<()> {
        if self.is_over() { self.give_way().await } else { Ok(()) }
    }

    /// Whether the turn is over.
    pub(super) fn is_over(&self) -> bool {
        self.began.elapsed() > TURN
    }

    async fn give_way(&mut self) -> Checked<()> {
        tokio::task::yield_now().await;
        self.began = Instant::now();
        if self.deadline.is_ahead() { Ok(()) } else { Err(Deadline::problem()) }
    }
}
