//! The one writer of a world: batches of edits, each batch one tick.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::{
    Means, Settings, Shape, ShapeId, Snapshot, SweepRule, Swept, Tick, Time,
    history::{Bounds, Changes, Kept},
    ledger::Ledger,
    snapshot::Content,
    state::{READ_TOGETHER, State},
    tracks::Tracks,
};

/// One change.
#[derive(Clone, Debug)]
pub enum Edit {
    /// Inserts a shape; one with the same id is replaced whole.
    Insert(Shape),
    /// Moves a shape; what is `None` stays.
    Move {
        /// Which.
        id: ShapeId,
        /// Where to.
        position: Option<DVec3>,
        /// How turned, of any length but 0.
        rotation: Option<DQuat>,
        /// New velocity, metres a second.
        velocity: Option<DVec3>,
        /// New angular velocity, radians a second.
        angular_velocity: Option<DVec3>,
        /// It did not travel there.
        teleport: bool,
    },
    /// Removes a shape; one that is gone is not an error.
    Remove(ShapeId),
    /// Removes everything.
    Clear,
}

/// What happens to a batch with a wrong edit in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditRule {
    /// Nothing changes and no tick is made.
    AllOrNothing,
    /// The wrong edits are left out, the others make the tick.
    LeaveOutWrong,
}

/// An edit that cannot be applied: so far only a move of a shape that is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no shape {id}")]
pub struct EditFault {
    /// Index of the edit in the batch.
    pub index: usize,
    /// The shape concerned.
    pub id: ShapeId,
}

/// Why a batch was refused whole; nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// An edit that cannot be applied, under [`EditRule::AllOrNothing`].
    #[error(transparent)]
    Fault(#[from] EditFault),
    /// The time of a tick may equal that of the one before, but not precede it; under either rule.
    #[error("time is {found} ns: it must not be before that of the newest tick, {newest} ns", found = .found.0, newest = .newest.0)]
    TimeGoesBack {
        /// When the newest tick was made.
        newest: Time,
        /// What was asked for.
        found: Time,
    },
}

/// What a batch did.
#[derive(Clone, Debug)]
pub struct EditReport {
    /// The version in which it is seen.
    pub tick: Tick,
    /// Shapes inserted, replaced, moved or removed.
    pub changed_count: u64,
    /// What was left out, in order.
    pub faults: Vec<EditFault>,
    /// What bullets touched on their ways.
    pub swept: Swept,
}

/// How a shape came to its new pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// All the way.
    Travelled,
    /// It was put there: how far that is says nothing of how it will move.
    Teleported,
}

/// A world and its writer. Publishing is the caller's: [`World::newest`] after each batch.
#[derive(Debug)]
pub struct World {
    newest: Arc<Snapshot>,
    sweep_rule: SweepRule,
}

impl World {
    /// An empty world at tick 1 that keeps no history.
    #[must_use]
    pub fn new(time: Time) -> Self {
        Self::with(time, Settings::default(), Means::default())
    }

    /// An empty world at tick 1.
    #[must_use]
    pub fn with(time: Time, settings: Settings, means: Means) -> Self {
        Self::of(State::default(), Tick::MIN, time, settings, means)
    }

    /// A world that begins as a copy of a snapshot, at the same tick, and shares its memory until one of them changes. It
    /// has the settings of that world, and none of its history: what was before the copy is asked of the original.
    ///
    /// Costs one reference for each page of 64 shapes; of a past moment, what changed since.
    ///
    /// ```
    /// use collision::world::{Time, World};
    /// let mut world = World::new(Time(0));
    /// world.apply(Vec::new(), Time(7), collision::world::EditRule::AllOrNothing)?;
    /// let mut fork = World::fork(&world.newest());
    /// fork.apply(Vec::new(), Time(9), collision::world::EditRule::AllOrNothing)?;
    /// assert_eq!((world.newest().tick().get(), fork.newest().tick().get()), (2, 3));
    /// # Ok::<(), collision::world::EditError>(())
    /// ```
    #[must_use]
    pub fn fork(snapshot: &Snapshot) -> Self {
        let Snapshot { tick, time, settings, means, .. } = *snapshot;
        Self::of(snapshot.state().clone(), tick, time, settings, means)
    }

    /// A world that holds these shapes at a tick, and nothing of what was before it. Of shapes with the same id the last
    /// stays. The cost is that of inserting them.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use collision::{math::Pose, shape::Geometry, world::{Means, Settings, Shape, ShapeId, Tick, Time, World}};
    /// let ball = Shape::new(ShapeId::MIN, Arc::new(Geometry::sphere(1.0)?), Pose::IDENTITY);
    /// let tick = Tick::new(57).unwrap();
    /// let world = World::holding([ball], tick, Time(9), Settings::default(), Means::default()).newest();
    /// assert_eq!((world.len(), world.tick(), world.oldest_tick()), (1, tick, tick));
    /// # Ok::<(), collision::shape::GeometryError>(())
    /// ```
    #[must_use]
    pub fn holding(
        shapes: impl IntoIterator<Item = Shape>,
        tick: Tick,
        time: Time,
        settings: Settings,
        means: Means,
    ) -> Self {
        let mut state = State::default();
        state.margin = settings.margin;
        let mut changes = Changes::unkept();
        for shape in shapes {
            let inserted = state.apply(Edit::Insert(shape), &mut changes);
            debug_assert!(inserted.is_ok(), "an insert needs no shape to be there");
        }
        state.moving.settle();
        Self::of(state, tick, time, settings, means)
    }

    /// What it may use.
    #[must_use]
    pub fn means(&self) -> Means {
        self.newest.means
    }

    fn of(mut state: State, tick: Tick, time: Time, settings: Settings, means: Means) -> Self {
        state.margin = settings.margin;
        state.fixed_ledger = Arc::new(Ledger::new(means.clock));
        let content = Content::Now(state);
        Self {
            newest: Arc::new(Snapshot {
                tick,
                fraction: 0.0,
                time,
                moving_since: content.moving_since(None, tick),
                content,
                history: Arc::default(),
                history_since: None,
                kept: Arc::new(Kept::new(means.past_bytes, Ledger::new(means.clock))),
                settings,
                means,
            }),
            sweep_rule: SweepRule::default(),
        }
    }

    /// Which moves are swept from now on; at first those of bullets.
    pub fn set_sweep_rule(&mut self, rule: SweepRule) {
        self.sweep_rule = rule;
    }

    /// The settings in force.
    #[must_use]
    pub fn settings(&self) -> Settings {
        self.newest.settings
    }

    /// Changes the settings from the next tick on; history beyond the new bound goes at once. The newest version stays the
    /// same version, but is another snapshot: readers who should see that the history is shorter need
    /// [`World::newest`] anew.
    ///
    /// # Panics
    /// If there is more history asked for than [`Settings::HISTORY_TICKS_MAX`], or a margin that is not a number of at
    /// least 0: what a caller sends must be checked before.
    pub fn set(&mut self, settings: Settings) {
        assert!(settings.history_ticks <= Settings::HISTORY_TICKS_MAX, "so much history is not kept");
        assert!(settings.margin.is_none_or(|margin| margin >= 0.0 && margin.is_finite()), "a margin is a length");
        let newest = &self.newest;
        let mut state = newest.state().clone();
        state.margin = settings.margin;
        let history = if settings.history_ticks == newest.settings.history_ticks {
            Arc::clone(&newest.history)
        } else {
            Arc::new(newest.history.resized(newest.tick, bounds(settings, newest.means)))
        };
        newest.kept.forget_before(history.oldest(newest.tick));
        self.newest = Arc::new(Snapshot {
            content: Content::Now(state),
            history,
            kept: Arc::clone(&newest.kept),
            settings,
            ..**newest
        });
    }

    /// The newest version.
    #[must_use]
    pub fn newest(&self) -> Arc<Snapshot> {
        Arc::clone(&self.newest)
    }

    /// Applies a batch as one tick. Later edits see earlier ones of the batch. Versions that were handed out stay as
    /// they are. An empty batch makes a tick too.
    ///
    /// The cost is that of the edits, of copying the pages they touch, and of one reference for each page of 64 shapes;
    /// where bullets travelled, also that of their sweeps.
    ///
    /// # Errors
    /// With [`EditRule::AllOrNothing`], the first fault; with either rule, a `time` before that of the newest version.
    /// Nothing has changed then.
    pub fn apply(&mut self, edits: Vec<Edit>, time: Time, rule: EditRule) -> Result<EditReport, EditError> {
        let newest = self.newest.time;
        if time < newest {
            return Err(EditError::TimeGoesBack { newest, found: time });
        }
        // A draft that shares all pages with the newest version: if it is dropped, nothing has happened.
        let mut state = self.newest.state().clone();
        let is_kept = self.newest.settings.history_ticks > 0;
        let mut changes = if is_kept { Changes::kept() } else { Changes::unkept() };
        let mut tracks = Tracks::after(&state, self.sweep_rule);
        let mut changed_count = 0;
        let mut faults = Vec::new();
        let mut edits = edits.into_iter();
        for index in 0.. {
            if index % READ_TOGETHER == 0 {
                let next = edits.as_slice();
                state.read_ahead(&next[..next.len().min(READ_TOGETHER)]);
            }
            let Some(edit) = edits.next() else {
                break;
            };
            if let Some(tracks) = &mut tracks {
                tracks.note(&edit, &state);
            }
            match state.apply(edit, &mut changes) {
                Ok(count) => changed_count += count,
                Err(id) => {
                    let fault = EditFault { index, id };
                    match rule {
                        EditRule::AllOrNothing => return Err(fault.into()),
                        EditRule::LeaveOutWrong => faults.push(fault),
                    }
                }
            }
        }
        state.moving.settle();
        let tick = self.newest.tick.saturating_add(1);
        let old = self.newest();
        self.publish(tick, time, state, changes);
        let swept = tracks.map_or_else(Swept::default, |tracks| tracks.sweep(&old, &self.newest));
        Ok(EditReport { tick, changed_count, faults, swept })
    }

    fn publish(&mut self, tick: Tick, time: Time, state: State, changes: Changes) {
        let before = &self.newest;
        let history = match changes.into_record(before.time) {
            Some(record) => {
                let bounds = bounds(before.settings, before.means);
                Arc::new(before.history.with(tick, record, &state, bounds))
            }
            None => Arc::clone(&before.history),
        };
        before.kept.forget_before(history.oldest(tick));
        let content = Content::Now(state);
        self.newest = Arc::new(Snapshot {
            tick,
            time,
            moving_since: content.moving_since(before.moving_since, tick),
            history_since: before.history_since.or((history.len() > 0).then_some(tick)),
            content,
            history,
            kept: Arc::clone(&before.kept),
            ..**before
        });
    }
}

fn bounds(settings: Settings, means: Means) -> Bounds {
    Bounds { ticks: settings.history_ticks, bytes: means.history_bytes }
}
