//! How a long call shares its thread: it works for a while, then gives way to others.

use std::time::{Duration, Instant};

use crate::{deadline::Deadline, problem::Checked};

/// How long a call works before it gives way.
const TURN: Duration = Duration::from_micros(100);

/// The turns of one call.
#[derive(Debug)]
pub(super) struct Turns {
    began: Instant,
    deadline: Deadline,
}

impl Turns {
    /// Begins the first.
    pub(super) fn new(deadline: Deadline) -> Self {
        Self { began: Instant::now(), deadline }
    }

    /// Gives way if the turn is over. Here a call that was cancelled ends, and others get their turn.
    ///
    /// # Errors
    /// The deadline has passed.
    pub(super) async fn next(&mut self) -> Checked<()> {
        if self.began.elapsed() <= TURN {
            return Ok(());
        }
        tokio::task::yield_now().await;
        self.began = Instant::now();
        if self.deadline.is_ahead() { Ok(()) } else { Err(Deadline::problem()) }
    }
}
