//! A session: one world, its versions, its geometries, its tokens and its lease.

use std::{
    collections::HashSet,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant, SystemTime},
};

use arc_swap::ArcSwap;
use collision::world::{Edit, EditError, EditReport, EditRule, Snapshot, Tick, Time, World};
use parking_lot::Mutex;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, broadcast, watch};
use tokio_util::sync::CancellationToken;

use crate::{
    config::Settings,
    deadline::Deadline,
    geometries::Geometries,
    lease::Lease,
    past,
    problem::{Checked, Problem, Reason},
    token::{Role, Tokens},
    traces::Traces,
    writer::{When, Writer},
};

/// Versions kept for readers of further pages.
const PAGED_VERSIONS: usize = 16;
/// How long they are kept after the last page.
const PAGED_FOR: Duration = Duration::from_secs(60);

/// Versions that a watcher may be behind before it has to look into the history.
const WATCHED_VERSIONS: usize = 16;
/// Watchers of a session at a time.
const WATCHERS: usize = 64;

/// Which version is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ReadAt {
    /// The newest.
    Newest,
    /// Exactly this one, and how far on towards the next.
    Tick(Tick, f64),
    /// The newest, once it is at least this.
    MinTick(Tick),
    /// That of this time.
    Time(Time),
}

/// Who may do what in a session.
#[derive(Debug)]
pub(crate) enum Access {
    /// Everybody may do everything; a token of the session is still held to its role.
    Open(Mutex<Tokens>),
    /// Only who has a token.
    ByToken(Mutex<Tokens>),
}

/// What was done in a session.
#[derive(Debug, Default)]
pub(crate) struct Counters {
    pub(crate) questions: AtomicU64,
    pub(crate) undecided: AtomicU64,
    pub(crate) edits: AtomicU64,
    /// What the last commit took, nanoseconds.
    pub(crate) last_commit_ns: AtomicU64,
}

/// A session.
#[derive(Debug)]
pub(crate) struct Session {
    pub(crate) id: String,
    pub(crate) created: SystemTime,
    pub(crate) lease: Lease,
    pub(crate) geometries: Geometries,
    pub(crate) counters: Counters,
    /// The questions that are asked, for those who watch them.
    pub(crate) traces: Arc<Traces<wire::v1::Trace>>,
    /// The one writer. Whoever waits for it gives way to others meanwhile; large batches hold it on another thread.
    pub(crate) writer: Arc<tokio::sync::Mutex<Writer>>,
    /// Cancelled when the session ends.
    pub(crate) ended: CancellationToken,
    access: Access,
    newest: ArcSwap<Snapshot>,
    newest_tick: watch::Sender<Tick>,
    /// Each version as it is made, for those who watch.
    versions: broadcast::Sender<Arc<Snapshot>>,
    /// Places for those who watch.
    watchers: Arc<Semaphore>,
    paged: Mutex<Vec<(Instant, Arc<Snapshot>)>>,
    shape_quota: usize,
    /// Places for calls that wait for a tick.
    waiting: Arc<Semaphore>,
}

impl Session {
    /// A session with a world and its geometries.
    pub(crate) fn new(
        id: String,
        access: Access,
        lease: Option<Duration>,
        settings: &Settings,
        waiting: Arc<Semaphore>,
        (writer, geometries): (Writer, Geometries),
    ) -> Self {
        let newest = writer.world.newest();
        Self {
            id,
            created: SystemTime::now(),
            lease: Lease::new(lease),
            geometries,
            counters: Counters::default(),
            traces: Arc::default(),
            writer: Arc::new(tokio::sync::Mutex::new(writer)),
            ended: CancellationToken::new(),
            access,
            newest_tick: watch::Sender::new(newest.tick()),
            versions: broadcast::Sender::new(WATCHED_VERSIONS),
            watchers: Arc::new(Semaphore::new(WATCHERS)),
            newest: ArcSwap::new(newest),
            paged: Mutex::default(),
            shape_quota: settings.session_shapes,
            waiting,
        }
    }

    /// What the bearer of `token` may do here.
    ///
    /// # Errors
    /// There is no token, or it is not one of this session.
    pub(crate) fn role_of(&self, token: Option<&str>) -> Checked<Role> {
        match &self.access {
            Access::Open(tokens) => Ok(token.and_then(|token| tokens.lock().role_of(token)).unwrap_or(Role::Owner)),
            Access::ByToken(tokens) => {
                let Some(token) = token else {
                    let what = format!(
                        "session {:?} needs a token: send the one of CreateSession as `authorization: Bearer TOKEN`",
                        self.id
                    );
                    return Err(Problem::new(Reason::NoToken, what));
                };
                tokens.lock().role_of(token).ok_or_else(|| {
                    let what = format!(
                        "the token is not one of session {:?}: send one that CreateSession or CreateToken gave for it",
                        self.id
                    );
                    Problem::new(Reason::NoToken, what)
                })
            }
        }
    }

    /// Makes a token.
    ///
    /// # Errors
    /// Too many tokens.
    pub(crate) fn create_token(&self, role: Role) -> Checked<String> {
        match &self.access {
            Access::Open(tokens) | Access::ByToken(tokens) => tokens.lock().create(role),
        }
    }

    /// The newest version.
    pub(crate) fn newest(&self) -> Arc<Snapshot> {
        self.newest.load_full()
    }

    /// The version that a question asks for. Waits, where that is asked, up to the deadline.
    ///
    /// # Errors
    /// A version that is not held, or not there in time; the session ended.
    pub(crate) async fn pin(&self, read_at: ReadAt, deadline: Deadline) -> Checked<Arc<Snapshot>> {
        let newest = match read_at {
            ReadAt::MinTick(tick) => self.wait_for(tick, deadline).await?,
            ReadAt::Newest | ReadAt::Tick(..) | ReadAt::Time(_) => self.newest(),
        };
        past::read(newest, read_at).await
    }

    async fn wait_for(&self, tick: Tick, deadline: Deadline) -> Checked<Arc<Snapshot>> {
        let newest = self.newest();
        if newest.tick() >= tick {
            return Ok(newest);
        }
        let _place = self.waiting.try_acquire().map_err(|_| {
            let what = "too many calls wait for a tick: ask again later, or without min_tick";
            Problem::new(Reason::Overloaded, what).with("quota", "waiting_calls")
        })?;
        let mut ticks = self.newest_tick.subscribe();
        tokio::select! {
            biased;
            // An error cannot be: the sender lives as long as this session.
            _ = ticks.wait_for(|newest| *newest >= tick) => Ok(self.newest()),
            () = self.ended.cancelled() => Err(self.ended_problem()),
            () = deadline.passed() => {
                let what = format!("is {tick}, and the newest tick is still {} at the call's deadline: allow more time, or ask without it", self.newest().tick());
                Err(Problem::at("read_at.min_tick", Reason::Deadline, what))
            }
        }
    }

    /// Applies a batch as one tick and makes it seen.
    ///
    /// # Errors
    /// A quota, or the world is in quarantine; the world's own refusals are the inner error.
    pub(crate) fn commit(
        &self,
        writer: &mut Writer,
        edits: Vec<Edit>,
        when: When,
        rule: EditRule,
    ) -> Checked<Result<EditReport, EditError>> {
        self.check_quotas(&edits)?;
        let begin = Instant::now();
        let applied = writer.apply(edits, when, rule)?;
        if let Ok(report) = &applied {
            let took = u64::try_from(begin.elapsed().as_nanos()).unwrap_or(u64::MAX);
            self.counters.last_commit_ns.store(took, Ordering::Relaxed);
            self.publish(writer);
            self.counters.edits.fetch_add(report.changed_count, Ordering::Relaxed);
        }
        Ok(applied)
    }

    /// Makes the newest version of the world seen.
    fn publish(&self, writer: &Writer) {
        let newest = writer.world.newest();
        self.newest.store(newest.clone());
        self.newest_tick.send_replace(newest.tick());
        // An error says that nobody watches.
        let _ = self.versions.send(newest);
    }

    /// Makes the world another, which came whole from outside, and its geometries those of the session.
    ///
    /// # Errors
    /// As [`Session::check_importable`]; a quota; the world is in quarantine. Nothing is changed then.
    pub(crate) fn import(&self, writer: &mut Writer, world: World, geometries: Geometries) -> Checked<()> {
        let imported = world.newest();
        self.check_importable(imported.tick())?;
        self.check_shape_count(imported.len())?;
        writer.replace(world, || self.geometries.adopt(geometries, imported.len()))?;
        self.publish(writer);
        self.counters.edits.fetch_add(imported.len() as u64, Ordering::Relaxed);
        Ok(())
    }

    /// Checks that a world of this tick may take the place of the session's.
    ///
    /// # Errors
    /// The session's is not empty, or its tick would go back.
    pub(crate) fn check_importable(&self, tick: Tick) -> Checked<()> {
        let newest = self.newest();
        let held = newest.len();
        if held > 0 {
            let what = format!(
                "the world of session {:?} holds {held} shapes, and an import fills an empty one: import into a new session, \
                 made by CreateSession, or clear this one first, by Edit with {{\"edits\": [{{\"clear\": {{}}}}]}}",
                self.id
            );
            return Err(Problem::new(Reason::WorldNotEmpty, what));
        }
        let is_ahead = tick > newest.tick() || newest.tick() == Tick::MIN;
        if !is_ahead {
            let what = format!(
                "the world of session {:?} is at tick {}, and the import at tick {tick}: ticks never go back, so import into a \
                 new session, made by CreateSession",
                self.id,
                newest.tick()
            );
            return Err(Problem::new(Reason::WorldNotEmpty, what));
        }
        Ok(())
    }

    /// Each version that is made from now on.
    pub(crate) fn versions(&self) -> broadcast::Receiver<Arc<Snapshot>> {
        self.versions.subscribe()
    }

    /// The newest tick, and each that becomes it.
    pub(crate) fn ticks(&self) -> watch::Receiver<Tick> {
        self.newest_tick.subscribe()
    }

    /// A place among those who watch, until it is dropped.
    ///
    /// # Errors
    /// Too many watch.
    pub(crate) fn watching(&self) -> Checked<OwnedSemaphorePermit> {
        Arc::clone(&self.watchers).try_acquire_owned().map_err(|_| {
            let what = format!("{WATCHERS} streams watch session {:?}, which is the most: end one first", self.id);
            Problem::new(Reason::QuotaExceeded, what).with("quota", "session_watchers").with("limit", WATCHERS)
        })
    }

    /// Changes the settings of the world.
    ///
    /// # Errors
    /// The world is in quarantine.
    pub(crate) fn set(&self, writer: &mut Writer, settings: collision::world::Settings) -> Checked<()> {
        writer.set(settings)?;
        self.newest.store(writer.world.newest());
        Ok(())
    }

    /// Keeps a version for a while, so that further pages are of the same tick.
    pub(crate) fn keep_for_paging(&self, snapshot: &Arc<Snapshot>) {
        let now = Instant::now();
        let mut paged = self.paged.lock();
        let is_same = |kept: &Snapshot| is_of(kept, snapshot.tick(), snapshot.fraction());
        paged.retain(|(used, kept)| !is_same(kept) && now.duration_since(*used) < PAGED_FOR);
        if paged.len() >= PAGED_VERSIONS {
            paged.remove(0);
        }
        paged.push((now, snapshot.clone()));
    }

    /// A version that is the newest or was kept for paging.
    ///
    /// # Errors
    /// It is no longer held.
    pub(crate) fn paged(&self, tick: Tick, fraction: f64) -> Checked<Arc<Snapshot>> {
        let newest = self.newest();
        if is_of(&newest, tick, fraction) {
            return Ok(newest);
        }
        let kept = self.paged.lock().iter().find(|(_, kept)| is_of(kept, tick, fraction)).map(|(_, kept)| kept.clone());
        kept.ok_or_else(|| {
            let (oldest, newest) = (newest.oldest_tick(), newest.tick());
            let what = format!(
                "is of tick {tick}, whose pages are no longer held: {}; begin again without page_token (pages are kept for \
                 60 s)",
                past::held(oldest, newest)
            );
            past::not_held("page_token", what, oldest, newest)
        })
    }

    /// What is done now and then: lets versions go that nobody read a further page of, and counts the geometries'
    /// memory anew, which grows when questions make them build their trees.
    pub(crate) fn sweep(&self) {
        let now = Instant::now();
        self.paged.lock().retain(|(used, _)| now.duration_since(*used) < PAGED_FOR);
        self.memory_bytes();
    }

    /// Memory that it holds, bytes: that of its geometries and of its past, and an estimate for its shapes.
    pub(crate) fn memory_bytes(&self) -> u64 {
        let newest = self.newest();
        self.geometries.memory_bytes(newest.len()) + newest.past_memory_bytes()
    }

    /// What callers of a session are told that has ended meanwhile.
    pub(crate) fn ended_problem(&self) -> Problem {
        Problem::new(Reason::SessionNotFound, format!("session {:?} has ended: CreateSession makes another", self.id))
    }

    fn check_quotas(&self, edits: &[Edit]) -> Checked<()> {
        let newest = self.newest();
        let inserted = edits.iter().filter_map(|edit| match edit {
            Edit::Insert(shape) => Some(shape.id),
            Edit::Move { .. } | Edit::Remove(_) | Edit::Clear => None,
        });
        let most_new = inserted.clone().count();
        if most_new == 0 {
            return Ok(());
        }
        let mut shape_count = newest.len() + most_new;
        if shape_count > self.shape_quota {
            let new: HashSet<_> = inserted.filter(|&id| !newest.contains(id)).collect();
            shape_count = newest.len() + new.len();
        }
        self.check_shape_count(shape_count)?;
        self.geometries.check_room(shape_count)
    }

    /// Checks that a world may hold so many shapes.
    ///
    /// # Errors
    /// It may not.
    pub(crate) fn check_shape_count(&self, shape_count: usize) -> Checked<()> {
        let limit = self.shape_quota;
        if shape_count <= limit {
            return Ok(());
        }
        let what = format!("the world would hold {shape_count} shapes and may hold {limit}: remove some first");
        Err(Problem::new(Reason::QuotaExceeded, what).with("quota", "session_shapes").with("limit", limit))
    }
}

/// Whether a version is that of a tick and a fraction.
fn is_of(snapshot: &Snapshot, tick: Tick, fraction: f64) -> bool {
    snapshot.tick() == tick && snapshot.fraction().total_cmp(&fraction).is_eq()
}
