//! What a session is asked, for those who watch that.
//!
//! # Method
//! While nobody watches, a question costs one look at a counter. What is told goes into a ring that each watcher reads at its
//! own pace: who is too slow misses the oldest and learns how many.

use std::sync::{
    Arc, OnceLock,
    atomic::{AtomicUsize, Ordering},
};

use tokio::sync::broadcast::{
    self,
    error::{RecvError, TryRecvError},
};

/// What is kept for a watcher that does not look.
pub(crate) const KEPT: usize = 256;

/// Where questions are told.
#[derive(Debug)]
pub(crate) struct Traces<T> {
    watcher_count: AtomicUsize,
    /// Made when somebody watches first. `None` in it is what was too large to be told.
    ring: OnceLock<broadcast::Sender<Option<Arc<T>>>>,
}

impl<T> Default for Traces<T> {
    fn default() -> Self {
        Self { watcher_count: AtomicUsize::new(0), ring: OnceLock::new() }
    }
}

impl<T: Clone> Traces<T> {
    /// Tells those who watch; if nobody does, `trace` is not called. What it gives `None` for is counted.
    #[inline]
    pub(crate) fn tell(&self, trace: impl FnOnce() -> Option<T>) {
        if self.watcher_count.load(Ordering::Relaxed) == 0 {
            return;
        }
        if let Some(ring) = self.ring.get() {
            // An error says that who watched has just gone.
            let _ = ring.send(trace().map(Arc::new));
        }
    }

    /// Begins to watch what is asked from now on.
    pub(crate) fn watch(self: &Arc<Self>) -> Watching<T> {
        let ring = self.ring.get_or_init(|| broadcast::Sender::new(KEPT));
        let unseen = ring.subscribe();
        self.watcher_count.fetch_add(1, Ordering::Relaxed);
        Watching { traces: self.clone(), unseen, seen: Vec::new(), missed_count: 0 }
    }
}

/// One who watches.
#[derive(Debug)]
pub(crate) struct Watching<T> {
    traces: Arc<Traces<T>>,
    unseen: broadcast::Receiver<Option<Arc<T>>>,
    seen: Vec<Arc<T>>,
    missed_count: u64,
}

impl<T> Drop for Watching<T> {
    fn drop(&mut self) {
        self.traces.watcher_count.fetch_sub(1, Ordering::Relaxed);
    }
}

impl<T: Clone> Watching<T> {
    /// Waits until there is something that was not taken yet.
    pub(crate) async fn come(&mut self) {
        match self.unseen.recv().await {
            Ok(trace) => self.see(trace),
            Err(RecvError::Lagged(count)) => self.missed_count += count,
            // The ring lives as long as this.
            Err(RecvError::Closed) => std::future::pending().await,
        }
    }

    /// All since the last time, the newest [`KEPT`] at most, oldest first; and how many were missed.
    pub(crate) fn take(&mut self) -> (Vec<Arc<T>>, u64) {
        loop {
            match self.unseen.try_recv() {
                Ok(trace) => self.see(trace),
                Err(TryRecvError::Lagged(count)) => self.missed_count += count,
                Err(TryRecvError::Empty | TryRecvError::Closed) => break,
            }
        }
        let too_many = self.seen.len().saturating_sub(KEPT);
        self.seen.drain(..too_many);
        (std::mem::take(&mut self.seen), std::mem::take(&mut self.missed_count) + too_many as u64)
    }

    fn see(&mut self, trace: Option<Arc<T>>) {
        match trace {
            Some(trace) => self.seen.push(trace),
            None => self.missed_count += 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn nothing_is_made_for_nobody_and_the_newest_are_kept() {
        let traces = Arc::new(Traces::<usize>::default());
        traces.tell(|| panic!("nobody watches"));
        let mut watching = traces.watch();
        for number in 0..KEPT + 44 {
            traces.tell(|| Some(number));
        }
        traces.tell(|| None);
        watching.come().await;
        let (seen, missed) = watching.take();
        assert_eq!(*seen[seen.len() - 1], KEPT + 43);
        assert_eq!(seen.len() as u64 + missed, KEPT as u64 + 45);
        assert!(seen.len() >= KEPT - 1 && seen.windows(2).all(|pair| *pair[0] + 1 == *pair[1]), "{seen:?}");
        assert!(watching.take().0.is_empty());
        drop(watching);
        traces.tell(|| panic!("nobody watches any more"));
    }
}
