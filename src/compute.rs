//! Where work is done: inline, or on another thread if it is long enough to keep other calls waiting; and how many calls are at
//! work inline on each thread.

use std::{
    cell::RefCell,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use crate::{
    fence::{caught, fenced},
    problem::{Checked, Problem, Reason},
};

/// Messages beyond this size are worked on elsewhere: below it, handing over (about 50 µs) would cost more than it saves.
const HEAVY_BYTES: usize = 64 * 1024;

/// Worlds with more bullets than this are edited elsewhere: to sweep a few costs some microseconds, to sweep a crowd may
/// take the whole budget of a tick.
const BULLETS_SWEPT_INLINE: usize = 8;

thread_local! {
    /// The load of this thread.
    static LOAD: RefCell<Load> = RefCell::default();
}

/// How many calls are at work on a thread right now, those included that give way to others for a moment.
#[derive(Clone, Debug, Default)]
pub(crate) struct Load(Arc<AtomicUsize>);

impl Load {
    /// That of this thread.
    pub(crate) fn here() -> Self {
        LOAD.with_borrow(Self::clone)
    }

    /// Begins to be that of this thread.
    pub(crate) fn begin_here(self) {
        LOAD.set(self);
    }

    /// Counts a call.
    pub(crate) fn at_work(&self) -> AtWork {
        self.0.fetch_add(1, Ordering::Relaxed);
        AtWork(self.clone())
    }

    /// Whether a call is at work.
    pub(crate) fn is_any(&self) -> bool {
        self.0.load(Ordering::Relaxed) > 0
    }
}

/// Counts a call among those at work on the thread where it was begun, as long as it lives.
#[derive(Debug)]
pub(crate) struct AtWork(Load);

impl AtWork {
    /// Begins to count.
    pub(crate) fn begin() -> Self {
        Load::here().at_work()
    }
}

impl Drop for AtWork {
    fn drop(&mut self) {
        self.0.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// How much work something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weight {
    /// Done at once.
    Light,
    /// Handed to another thread.
    Heavy,
}

impl Weight {
    /// What a message of this size makes to do.
    pub(crate) fn of_message(bytes: usize) -> Self {
        if bytes > HEAVY_BYTES { Self::Heavy } else { Self::Light }
    }

    /// The same work on a world with this many bullets.
    pub(crate) fn with_bullets(self, bullet_count: usize) -> Self {
        if bullet_count > BULLETS_SWEPT_INLINE { Self::Heavy } else { self }
    }
}

/// Does work where its weight says, behind the fence.
///
/// # Errors
/// The work's own, or it panicked.
pub(crate) async fn run<T: Send + 'static>(
    weight: Weight,
    doing: &'static str,
    work: impl FnOnce() -> Checked<T> + Send + 'static,
) -> Checked<T> {
    match weight {
        Weight::Light => {
            let _at_work = AtWork::begin();
            fenced(doing, work)?
        }
        Weight::Heavy => match tokio::task::spawn_blocking(work).await {
            Ok(done) => done,
            Err(error) if error.is_panic() => Err(caught(doing, error.into_panic().as_ref())),
            Err(_) => Err(Problem::new(Reason::Stopping, "the server is stopping: ask again elsewhere, or later")),
        },
    }
}
