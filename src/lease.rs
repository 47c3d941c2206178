//! A session's lease: how long it outlives its last call.

use std::{
    sync::atomic::{AtomicUsize, Ordering},
    time::{Duration, Instant, SystemTime},
};

use parking_lot::Mutex;

/// A lease that every call and every open stream renews.
#[derive(Debug)]
pub(crate) struct Lease {
    state: Mutex<State>,
    open_streams: AtomicUsize,
}

#[derive(Debug)]
struct State {
    /// How long the session outlives its last call; `None` is for ever.
    length: Option<Duration>,
    last_call: Instant,
}

impl Lease {
    /// A lease that begins now.
    pub(crate) fn new(length: Option<Duration>) -> Self {
        Self { state: Mutex::new(State { length, last_call: Instant::now() }), open_streams: AtomicUsize::new(0) }
    }

    /// Notes a call, with a new length if there is one.
    pub(crate) fn renew(&self, length: Option<Duration>) {
        let mut state = self.state.lock();
        state.last_call = Instant::now();
        if length.is_some() && state.length.is_some() {
            state.length = length;
        }
    }

    /// How long the session outlives its last call; `None` is for ever.
    pub(crate) fn length(&self) -> Option<Duration> {
        self.state.lock().length
    }

    /// When the session ends unless it is renewed; `None` is never.
    pub(crate) fn expires_at(&self) -> Option<SystemTime> {
        let state = self.state.lock();
        let left = state.length?.saturating_sub(state.last_call.elapsed());
        SystemTime::now().checked_add(left)
    }

    /// Whether it is over.
    pub(crate) fn is_over(&self) -> bool {
        if self.open_streams.load(Ordering::Acquire) > 0 {
            return false;
        }
        let state = self.state.lock();
        state.length.is_some_and(|length| state.last_call.elapsed() > length)
    }

    /// Keeps the lease while a stream is open; when that ends, the lease begins anew.
    pub(crate) fn hold(&self) -> Hold<'_> {
        self.open_streams.fetch_add(1, Ordering::AcqRel);
        Hold(self)
    }
}

/// An open stream.
#[derive(Debug)]
pub(crate) struct Hold<'a>(&'a Lease);

impl Drop for Hold<'_> {
    fn drop(&mut self) {
        self.0.renew(None);
        self.0.open_streams.fetch_sub(1, Ordering::AcqRel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lease_ends_unless_a_call_or_an_open_stream_renews_it() {
        let lease = Lease::new(Some(Duration::from_millis(30)));
        assert!(!lease.is_over());
        let hold = lease.hold();
        std::thread::sleep(Duration::from_millis(60));
        assert!(!lease.is_over(), "a stream is open");
        drop(hold);
        assert!(!lease.is_over(), "the end of the stream renews it");
        std::thread::sleep(Duration::from_millis(60));
        assert!(lease.is_over());
        lease.renew(None);
        assert!(!lease.is_over());
    }

    #[test]
    fn a_lease_without_an_end_gets_none_by_renewal() {
        let lease = Lease::new(None);
        lease.renew(Some(Duration::from_secs(1)));
        assert_eq!(lease.length(), None);
        assert_eq!(lease.expires_at(), None);
        assert!(!lease.is_over());
    }
}
