//! What time a thread has had.

use std::time::Duration;

/// Processor time of this thread, so that what else the machine does is not counted. Where a system does not tell it: the time.
#[cfg(unix)]
pub(super) fn clock() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).unwrap_or_default()
}

/// The time: that of threads is not told here.
#[cfg(not(unix))]
pub(super) fn clock() -> Duration {
    use std::{sync::LazyLock, time::Instant};
    static BEGIN: LazyLock<Instant> = LazyLock::new(Instant::now);
    BEGIN.elapsed()
}
