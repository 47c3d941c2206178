//! The one writer of a session's world: applies batches of edits, remembers retries and how far each stream got.

use std::{
    collections::HashMap,
    sync::Arc,
    time::{Instant, SystemTime, UNIX_EPOCH},
};

use collision::world::{Edit, EditError, EditReport, EditRule, Means, Settings, Snapshot, Swept, Tick, Time, World};
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

/// The time of an empty world's first tick: before that of any clock, so that simulations may bring their own.
const BEGINNING: Time = Time(0);

/// What a unary edit did: what a retry of it is answered with.
#[derive(Clone, Debug)]
pub(crate) struct Committed {
    /// The version in which it is seen.
    pub(crate) tick: Tick,
    /// Shapes inserted, replaced, moved or removed.
    pub(crate) changed_count: u64,
    /// What bullets touched.
    pub(crate) swept: Arc<Swept>,
}

/// A world and what its writer has to remember.
#[derive(Debug)]
pub(crate) struct Writer {
    pub(crate) world: World,
    /// Answers of unary edits, for their retries.
    pub(crate) retries: RetryCache<Committed>,
    /// Said to every writer since a panic left the world in doubt.
    quarantine: Option<Problem>,
    named: HashMap<String, Named>,
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
    pub(crate) fn new(settings: Settings, means: Means) -> Checked<Self> {
        Ok(Self::of(fenced("making a world", || World::with(BEGINNING, settings, means))?))
    }

    /// The writer of a world that begins as a copy of a snapshot.
    ///
    /// # Errors
    /// The world cannot be made.
    pub(crate) fn fork(snapshot: &Snapshot) -> Checked<Self> {
        Ok(Self::of(fenced("copying a world", || World::fork(snapshot))?))
    }

    /// The writer of a world.
    pub(crate) fn of(world: World) -> Self {
        Self { world, retries: RetryCache::default(), quarantine: None, named: HashMap::new() }
    }

    /// Changes the settings of the world.
    ///
    /// # Errors
    /// The world is in quarantine.
    pub(crate) fn set(&mut self, settings: Settings) -> Checked<()> {
        self.guarded(|world| world.set(settings))
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
        let newest = self.world.newest().time();
        let time = match when {
            When::Now => now().max(newest),
            When::At(time) => time,
        };
        self.guarded(|world| world.apply(edits, time, rule))
    }

    /// Puts another world in the place of this one, if `prepare` has nothing against it.
    ///
    /// # Errors
    /// Those of `prepare`; the world is in quarantine.
    pub(crate) fn replace(&mut self, world: World, prepare: impl FnOnce() -> Checked<()>) -> Checked<()> {
        self.guarded(|_| {})?;
        prepare()?;
        self.guarded(|held| *held = world)
    }

    /// Changes the world, unless it is in quarantine; a panic puts it there.
    fn guarded<T>(&mut self, change: impl FnOnce(&mut World) -> T) -> Checked<T> {
        if let Some(problem) = &self.quarantine {
            return Err(problem.clone());
        }
        let world = &mut self.world;
        let changed = fenced("applying edits", || change(world));
        changed.inspect_err(|_| {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_during_an_edit_puts_the_world_in_quarantine() {
        let mut writer = Writer::new(Settings::default(), Means::default()).unwrap();
        let apply = |writer: &mut Writer| writer.apply(Vec::new(), When::Now, EditRule::AllOrNothing);
        apply(&mut writer).unwrap().unwrap();
        let last_whole = writer.world.newest().tick();
        let problem = writer.guarded::<()>(|_| panic!("half done")).unwrap_err();
        assert!(problem.is(Reason::Internal), "{problem}");
        let problem = apply(&mut writer).unwrap_err();
        assert!(problem.is(Reason::WorldQuarantined), "{problem}");
        assert!(problem.to_string().contains("questions on its last whole tick go on"), "{problem}");
        assert_eq!(writer.world.newest().tick(), last_whole);
    }

    #[test]
    fn a_new_stream_of_a_writer_cancels_the_old_and_learns_what_is_committed() {
        let mut writer = Writer::new(Settings::default(), Means::default()).unwrap();
        let (first, old) = writer.begin_stream("arm");
        assert_eq!(first, Acked::default());
        let acked = Acked { sequence: 3, tick: Some(Tick::MIN) };
        writer.acknowledge("arm", acked);
        let (second, new) = writer.begin_stream("arm");
        assert_eq!(second, acked);
        assert!(old.is_cancelled() && !new.is_cancelled());
    }

    #[test]
    fn the_idlest_writer_is_forgotten_when_there_are_too_many() {
        let mut writer = Writer::new(Settings::default(), Means::default()).unwrap();
        let (_, idlest) = writer.begin_stream("idlest");
        for number in 0..NAMED_WRITERS {
            writer.begin_stream(&number.to_string());
        }
        assert!(idlest.is_cancelled());
        assert_eq!(writer.named.len(), NAMED_WRITERS);
    }
}
