//! The one writer of a session's world: applies batches of edits, remembers retries and how far each stream got.

use std::{
    collections::HashMap,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use collision::world::{Edit, EditError, EditReport, EditRule, Tick, Time, World};
use tokio_util::sync::CancellationToken;

use crate::{
    fence::fenced,
    problem::{Checked, Problem, Reason},
    retry::RetryCache,
};

/// Most named stream writers that a session remembers; beyond, the one idle for longest is forgotten.
const NAMED_WRITERS: usize = 4096;

/// When a tick is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum When {
    /// Now, or at the time of the newest tick, should the clock have gone back.
    Now,
    /// At this time.
    At(Time),
}

/// What a unary edit did: what a retry of it is answered with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Committed {
    /// The version in which it is seen.
    pub(crate) tick: Tick,
    /// Shapes inserted, replaced, moved or removed.
    pub(crate) changed_count: u64,
}

/// A world and what its writer has to remember.
#[derive(Debug)]
pub(crate) struct Writer {
    pub(crate) world: World,
    /// Answers of unary edits, for their retries.
    pub(crate) retries: RetryCache<Committed>,
    /// Log id of the panic that left the world in doubt.
    quarantine: Option<Problem>,
    named: HashMap<String, Named>,
    /// What the last commit took.
    pub(crate) last_commit: Duration,
}

/// How far a named stream writer got.
#[derive(Debug)]
struct Named {
    acked: Acked,
    /// Cancelled when a new stream of the same writer begins.
    current: CancellationToken,
    last_used: Instant,
}

/// What is committed of a stream writer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Acked {
    /// All messages up to this are in committed ticks.
    pub(crate) sequence: u64,
    /// The tick that holds them; `None` if there is none.
    pub(crate) tick: Option<Tick>,
}

impl Writer {
    /// The writer of an empty world.
    ///
    /// # Errors
    /// The world cannot be made.
    pub(crate) fn new() -> Checked<Self> {
        Ok(Self {
            world: fenced("making a world", || World::new(now()))?,
            retries: RetryCache::default(),
            quarantine: None,
            named: HashMap::new(),
            last_commit: Duration::ZERO,
        })
    }

    /// Applies a batch as one tick.
    ///
    /// # Errors
    /// The world refuses the batch, or is in quarantine since an earlier one made it panic.
    pub(crate) fn apply(
        &mut self,
        edits: Vec<Edit>,
        when: When,
        rule: EditRule,
    ) -> Checked<Result<EditReport, EditError>> {
        if let Some(problem) = &self.quarantine {
            return Err(problem.clone());
        }
        let begin = Instant::now();
        let newest = self.world.newest().time();
        let time = match when {
            When::Now => now().max(newest),
            When::At(time) => time,
        };
        let world = &mut self.world;
        let applied = fenced("applying edits", || world.apply(edits, time, rule));
        self.last_commit = begin.elapsed();
        applied.inspect_err(|_| {
            tracing::error!("the world is in quarantine: it takes no more edits");
            self.quarantine = Some(Problem::new(
                Reason::WorldQuarantined,
                "this world takes no more edits, because an earlier edit failed inside the server and may be half done; \
                 questions on its last whole tick go on; create a new session to go on editing",
            ));
        })
    }

    /// A new stream of a named writer: ends the one before, and says how far that got.
    pub(crate) fn begin_stream(&mut self, name: &str) -> (Acked, CancellationToken) {
        let current = CancellationToken::new();
        if name.is_empty() {
            return (Acked::default(), current);
        }
        if !self.named.contains_key(name) && self.named.len() >= NAMED_WRITERS {
            self.forget_the_idlest();
        }
        let named = self.named.entry(name.to_owned()).or_insert_with(|| Named {
            acked: Acked::default(),
            current: CancellationToken::new(),
            last_used: Instant::now(),
        });
        named.current.cancel();
        named.current = current.clone();
        named.last_used = Instant::now();
        (named.acked, current)
    }

    /// Notes how far a named writer got.
    pub(crate) fn acknowledge(&mut self, name: &str, acked: Acked) {
        if let Some(named) = self.named.get_mut(name) {
            named.acked = acked;
            named.last_used = Instant::now();
        }
    }

    fn forget_the_idlest(&mut self) {
        let idlest = self.named.iter().min_by_key(|(_, named)| named.last_used);
        if let Some(name) = idlest.map(|(name, _)| name.clone())
            && let Some(named) = self.named.remove(&name)
        {
            named.current.cancel();
        }
    }
}

/// The server's clock.
pub(crate) fn now() -> Time {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Time(i64::try_from(since.as_nanos()).unwrap_or(i64::MAX))
}
