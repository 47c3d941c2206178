//! A session's lease: how long it outlives its last call.

use std::{
    sync::atomic::{AtomicU64, AtomicUsize, Ordering},
    time::{Duration, Instant, SystemTime},
};

/// The length of a lease without an end.
const FOR_EVER: u64 = u64::MAX;

/// A lease that every call and every open stream renews. Without a lock, as each question does.
#[derive(Debug)]
pub(crate) struct Lease {
    began: Instant,
    /// How long the session outlives its last call.
    length_ns: AtomicU64,
    /// When that was, since the lease began.
    last_call_ns: AtomicU64,
    open_streams: AtomicUsize,
}

impl Lease {
    /// A lease that begins now; `None` is for ever.
    pub(crate) fn new(length: Option<Duration>) -> Self {
        Self {
            began: Instant::now(),
            length_ns: AtomicU64::new(length.map_or(FOR_EVER, nanoseconds)),
            last_call_ns: AtomicU64::new(0),
            open_streams: AtomicUsize::new(0),
        }
    }

    /// Notes a call, with a new length if there is one.
    pub(crate) fn renew(&self, length: Option<Duration>) {
        self.last_call_ns.store(nanoseconds(self.began.elapsed()), Ordering::Relaxed);
        if let (Some(new), Some(_)) = (length, self.length()) {
            self.length_ns.store(nanoseconds(new), Ordering::Relaxed);
        }
    }

    /// How long the session outlives its last call; `None` is for ever.
    pub(crate) fn length(&self) -> Option<Duration> {
        let length = self.length_ns.load(Ordering::Relaxed);
        (length != FOR_EVER).then_some(Duration::from_nanos(length))
    }

    /// When the session ends unless it is renewed; `None` is never.
    pub(crate) fn expires_at(&self) -> Option<SystemTime> {
        let left = self.length()?.saturating_sub(self.idle());
        SystemTime::now().checked_add(left)
    }

    /// How long ago the last call was.
    fn idle(&self) -> Duration {
        self.began.elapsed().saturating_sub(Duration::from_nanos(self.last_call_ns.load(Ordering::Relaxed)))
    }

    /// Whether it is over.
    pub(crate) fn is_over(&self) -> bool {
        if self.open_streams.load(Ordering::Acquire) > 0 {
            return false;
        }
        self.length().is_some_and(|length| self.idle() > length)
    }

    /// Keeps the lease while a stream is open; when that ends, the lease begins anew.
    pub(crate) fn hold(&self) -> Hold<'_> {
        self.open_streams.fetch_add(1, Ordering::AcqRel);
        Hold(self)
    }
}

/// The longest that fits is centuries, and stays below [`FOR_EVER`].
fn nanoseconds(length: Duration) -> u64 {
    u64::try_from(length.as_nanos()).map_or(FOR_EVER - 1, |length| length.min(FOR_EVER - 1))
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
