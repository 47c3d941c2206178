//! What a decomposition has cost so far, and whether it may go on.

use std::ops::ControlFlow;

use super::{Cancelled, Progress};
use crate::answer::Work;

/// Steps between two calls of the caller's function.
const STEPS_BETWEEN: u64 = 16_384;

/// Counts steps, tells the caller how it stands, and says when the budget is spent.
pub(super) struct Meter<'a> {
    pub(super) work: Work,
    /// Steps at which this stage ends.
    limit: u64,
    next_call: u64,
    pub(super) state: Progress,
    tell: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
}

impl<'a> Meter<'a> {
    pub(super) fn new(budget: u64, state: Progress, tell: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        Self { work: Work::default(), limit: budget, next_call: 0, state, tell }
    }

    /// Sets at how many steps in all the budget is spent.
    pub(super) fn set_limit(&mut self, steps: u64) {
        self.limit = steps;
    }

    /// Counts `steps` that no tree has counted.
    pub(super) fn add(&mut self, steps: usize) {
        self.work.iterations += steps as u64;
    }

    /// Whether no more may be done.
    pub(super) fn is_spent(&self) -> bool {
        self.work.steps() >= self.limit
    }

    /// Every so often calls the caller's function.
    ///
    /// # Errors
    /// It said to stop.
    pub(super) fn pass(&mut self) -> Result<(), Cancelled> {
        let steps = self.work.steps();
        if steps < self.next_call {
            return Ok(());
        }
        self.next_call = steps + STEPS_BETWEEN;
        self.state.steps = steps;
        match (self.tell)(self.state) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Cancelled),
        }
    }
}
