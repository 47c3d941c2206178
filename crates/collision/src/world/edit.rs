//! The one writer of a world: batches of edits, each batch one tick.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::{Shape, ShapeId, Snapshot, Tick, Time, state::State};

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
}

impl World {
    /// An empty world at tick 1.
    #[must_use]
    pub fn new(time: Time) -> Self {
        Self { newest: Arc::new(Snapshot { tick: Tick::MIN, time, state: State::default() }) }
    }

    /// The newest version.
    #[must_use]
    pub fn newest(&self) -> Arc<Snapshot> {
        Arc::clone(&self.newest)
    }

    /// Applies a batch as one tick. Later edits see earlier ones of the batch. Versions that were handed out stay as
    /// they are. An empty batch makes a tick too.
    ///
    /// The cost is that of the edits, of copying the pages they touch, and of one reference for each page of 64 shapes.
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
        let mut state = self.newest.state.clone();
        let mut changed_count = 0;
        let mut faults = Vec::new();
        for (index, edit) in edits.into_iter().enumerate() {
            match state.apply(edit) {
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
        self.newest = Arc::new(Snapshot { tick, time, state });
        Ok(EditReport { tick, changed_count, faults })
    }
}
