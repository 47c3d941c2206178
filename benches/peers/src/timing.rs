//! How long work takes: thread CPU time, ours and the peer's in turn, the least of all repeats.

use std::{hint::black_box, time::Duration};

use rustix::time::{ClockId, clock_gettime};

/// Ours and the peer's in turn, so that a slow moment of the machine meets both: rounds times repeats in a round.
const REPEATS: u32 = 2 * 5;

/// Repeats of what cannot be done in part, however long it takes.
const REPEATS_MIN: u32 = 2;

/// How long all repeats of one row may take, both sides together. A set that would take longer is timed by its first
/// pairs only.
const ROW_LIMIT: Duration = Duration::from_secs(6);

/// What one operation takes on both sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Times {
    /// Calipers, nanoseconds.
    pub(crate) calipers_ns: f64,
    /// parry3d, nanoseconds.
    pub(crate) parry_ns: f64,
    /// obvhs, nanoseconds, where it does the same.
    pub(crate) obvhs_ns: Option<f64>,
    /// Embree, nanoseconds, where it does the same and is linked.
    pub(crate) embree_ns: Option<f64>,
    /// How many operations each repeat had.
    pub(crate) operations: usize,
}

/// Times `operations` operations on each side, or fewer where they would take too long. Both functions do as many
/// operations as they are told and return the CPU time that took.
pub(crate) fn compare(
    operations: usize,
    mut calipers: impl FnMut(usize) -> Duration,
    mut parry: impl FnMut(usize) -> Duration,
) -> Times {
    // The trial also warms caches and what either side builds when first asked.
    let trial = (calipers(operations) + parry(operations)) * REPEATS;
    let share = (ROW_LIMIT.as_secs_f64() / trial.as_secs_f64()).min(1.0);
    let operations = ((operations as f64 * share) as usize).max(1);
    let (mut least_calipers, mut least_parry) = (Duration::MAX, Duration::MAX);
    for _ in 0..REPEATS {
        least_calipers = least_calipers.min(calipers(operations));
        least_parry = least_parry.min(parry(operations));
    }
    Times::new([least_calipers, least_parry], operations)
}

/// Times work that is one whole on each side, so that it cannot be done in part: `operations` operations each time, fewer
/// times where it takes long. Both functions return the CPU time that it took.
pub(crate) fn compare_whole(
    operations: usize,
    mut calipers: impl FnMut() -> Duration,
    mut parry: impl FnMut() -> Duration,
) -> Times {
    let (mut least_calipers, mut least_parry) = (calipers(), parry());
    let mut spent = least_calipers + least_parry;
    for repeat in 1..=REPEATS {
        if repeat > REPEATS_MIN && spent > ROW_LIMIT {
            break;
        }
        let (time_calipers, time_parry) = (calipers(), parry());
        least_calipers = least_calipers.min(time_calipers);
        least_parry = least_parry.min(time_parry);
        spent += time_calipers + time_parry;
    }
    Times::new([least_calipers, least_parry], operations)
}

impl Times {
    /// Of so many operations, which took both this long.
    fn new([calipers, parry]: [Duration; 2], operations: usize) -> Self {
        let each_ns = |time| each_ns(time, operations);
        Self { calipers_ns: each_ns(calipers), parry_ns: each_ns(parry), obvhs_ns: None, embree_ns: None, operations }
    }

    /// With the time of obvhs, which does as many operations as it is told and returns the CPU time that took.
    pub(crate) fn beside_obvhs(self, obvhs: impl FnMut(usize) -> Duration) -> Self {
        Self { obvhs_ns: Some(self.each_ns(obvhs)), ..self }
    }

    /// As [`Times::beside_obvhs`], with that of Embree.
    #[cfg(feature = "embree")]
    pub(crate) fn beside_embree(self, embree: impl FnMut(usize) -> Duration) -> Self {
        Self { embree_ns: Some(self.each_ns(embree)), ..self }
    }

    fn each_ns(&self, mut peer: impl FnMut(usize) -> Duration) -> f64 {
        let least = (0..REPEATS).map(|_| peer(self.operations)).min().unwrap_or_default();
        each_ns(least, self.operations)
    }
}

fn each_ns(all: Duration, operations: usize) -> f64 {
    all.as_secs_f64() * 1e9 / operations as f64
}

/// CPU time of this thread for some work. What the work returns is dropped when the time is taken.
pub(crate) fn time_of<Made>(work: impl FnOnce() -> Made) -> Duration {
    let start = thread_time();
    let made = black_box(work());
    let time = thread_time() - start;
    drop(made);
    time
}

/// CPU time of this thread for asking one question of each item.
pub(crate) fn spent<Item, Answer>(items: impl Iterator<Item = Item>, mut ask: impl FnMut(Item) -> Answer) -> Duration {
    let start = thread_time();
    for item in items {
        black_box(&ask(item));
    }
    thread_time() - start
}

fn thread_time() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}
