//! What enters and leaves regions, and which shapes begin and cease to overlap, from version to version.
//!
//! # Method
//! An overlap begins when it is proved and ends when the contrary is proved; while it is undecided it stays what it was.
//! Only what changed is asked again: the shapes that changed find the regions near them in a tree over the regions, the
//! regions that moved find shapes in the trees of the world ([`regions`]); pairs are asked again of the shapes that changed
//! ([`pairs`]). Between two ticks the ways are swept, so that what passes right through is seen.
//!
//! # Limits
//! [`REGIONS_MAX`] regions and [`super::PAIRS_MAX`] overlaps of each kind. What passes through within one tick is seen where
//! the record of that tick is held: worlds that keep no history have none. A form that goes along with a shape goes straight
//! from where it was to where it is, as shapes do. Of what left and came back within one tick nothing is said.

mod changes;
mod judge;
mod pairs;
mod regions;

use std::{num::NonZeroU64, sync::Arc};

pub use changes::{Change, Changes};

use self::{judge::Terms, pairs::Pairs, regions::Regions};
use super::{Filter, HistoryError, Meter, Moment, QuestionError, ShapeId, Snapshot, Tick, history::Passage};
use crate::{accuracy::Accuracy, math::Pose, shape::Geometry};

/// Regions of one watcher at most.
pub const REGIONS_MAX: usize = 4096;

/// The id of a region; never 0.
pub type RegionId = NonZeroU64;

/// A form that watches, without being in the world.
#[derive(Clone, Debug)]
pub struct Region {
    /// Its id, unique among the regions of a watcher.
    pub id: RegionId,
    /// Its form; half spaces and meshes too.
    pub geometry: Arc<Geometry>,
    /// Where it is; relative to the shape that it follows, if it follows one.
    pub pose: Pose,
    /// Goes along with this shape, and does not see it. While that shape is gone, the region is empty.
    pub follow: Option<ShapeId>,
}

/// Which pairs of shapes are watched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WatchedPairs {
    /// None.
    Nothing,
    /// All that [`Snapshot::pairs`] lists without a filter.
    All,
    /// Of those, the ones with at least one of these shapes.
    Of(Vec<ShapeId>),
}

/// What is watched.
#[derive(Clone, Debug)]
pub struct Watch {
    /// Regions, at most [`REGIONS_MAX`].
    pub regions: Vec<Region>,
    /// Which shapes the regions see.
    pub filter: Filter,
    /// Which pairs of shapes.
    pub pairs: WatchedPairs,
    /// How exact; narrower intervals leave fewer touches undecided.
    pub accuracy: Accuracy,
    /// An overlap ends only when the two are proved to be farther apart than this, metres, at least 0.
    pub hysteresis: f64,
}

/// Follows a world from version to version. It keeps the version that it saw last alive, and for each overlap about 100
/// bytes.
///
/// ```
/// use std::sync::Arc;
/// use collision::{DVec3, accuracy::Accuracy, math::Pose, shape::Geometry, world::*};
///
/// let gate = Region {
///     id: RegionId::MIN,
///     geometry: Arc::new(Geometry::cuboid(DVec3::new(0.01, 2.0, 2.0))?),
///     pose: Pose::IDENTITY,
///     follow: None,
/// };
/// let (filter, accuracy) = (Filter::default(), Accuracy::default());
/// let mut watcher = Watcher::new(Watch {
///     regions: vec![gate], filter, pairs: WatchedPairs::Nothing, accuracy, hysteresis: 0.0,
/// });
/// let car = Shape::new(ShapeId::MIN, Arc::new(Geometry::sphere(0.5)?), Pose::at(DVec3::X * -9.0));
/// let mut world = World::with(Time(0), Settings { history_ticks: 1, ..Settings::default() }, Means::default());
/// world.apply(vec![Edit::Insert(car)], Time(0), EditRule::AllOrNothing)?;
/// let mut go_on = || true;
/// assert!(watcher.step(&world.newest(), &mut Meter::new(&mut go_on))?.is_empty());
/// let there = Edit::Move {
///     id: ShapeId::MIN, position: Some(DVec3::X * 9.0), rotation: None, velocity: None, angular_velocity: None,
///     teleport: false,
/// };
/// world.apply(vec![there], Time(0), EditRule::AllOrNothing)?;
/// let changes = watcher.step(&world.newest(), &mut Meter::new(&mut go_on))?;
/// assert_eq!(changes.regions[&(RegionId::MIN, ShapeId::MIN)], Change::CameAndWent);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Watcher {
    terms: Terms,
    regions: Regions,
    pairs: Option<Pairs>,
    seen: Option<Arc<Snapshot>>,
}

/// What a watcher passed on its way to a version.
#[derive(Clone, Debug, Default)]
pub struct Passed {
    /// What changed on the way.
    pub changes: Changes,
    /// Ticks in which something changed.
    pub changed_tick_count: u64,
    /// Some ticks on the way are no longer held: what came and went in them was not seen. Whatever is so now is told.
    pub missed: bool,
}

/// From one version to the next.
struct Step<'a> {
    /// `None` at the first.
    old: Option<&'a Snapshot>,
    new: &'a Snapshot,
    passage: Passage,
}

impl Watcher {
    /// Has seen no version yet.
    ///
    /// # Panics
    /// If there are more regions than [`REGIONS_MAX`], or two of one id.
    #[must_use]
    pub fn new(watch: Watch) -> Self {
        let Watch { regions, filter, pairs, accuracy, hysteresis } = watch;
        Self {
            terms: Terms { accuracy, hysteresis },
            regions: Regions::new(regions, filter),
            pairs: Pairs::new(pairs),
            seen: None,
        }
    }

    /// Goes on to another version, usually the next, and says what changed. At the first step all that is proved to overlap
    /// comes. After an error it is still at the version before. Costs what changed since.
    ///
    /// # Errors
    /// [`QuestionError::TooManyPairs`], [`QuestionError::Interrupted`], [`QuestionError::TooLong`].
    pub fn step(&mut self, new: &Arc<Snapshot>, meter: &mut Meter<'_>) -> Result<Changes, QuestionError> {
        let _asking = new.asking().now();
        let old = self.seen.as_deref();
        let passage = old.map(|old| new.passage_from(old)).unwrap_or_default();
        let step = Step { old, new, passage };
        let regions = self.regions.look(&step, &self.terms, meter)?;
        let pairs = match &self.pairs {
            Some(pairs) => pairs.look(&step, &self.terms, meter)?,
            None => judge::Outcomes::default(),
        };
        let changes = Changes { regions: self.regions.take(regions), pairs: pairs::take(&mut self.pairs, pairs) };
        self.seen = Some(Arc::clone(new));
        Ok(changes)
    }

    /// Goes on to a later version of the same world tick by tick, as far as the ticks in between are held, and says what
    /// changed on the way. After an error it is at some version on the way, and what it passed is lost.
    ///
    /// # Errors
    /// As [`Watcher::step`].
    pub fn go_on(&mut self, newest: &Arc<Snapshot>, meter: &mut Meter<'_>) -> Result<Passed, QuestionError> {
        let mut passed = Passed::default();
        while let Some(next) = self.tick().map(|tick| tick.saturating_add(1)).filter(|next| *next < newest.tick()) {
            let version = match newest.at(Moment::Tick(next)) {
                Ok(version) => version,
                Err(HistoryError::Gone { oldest, .. }) => {
                    passed.missed = true;
                    match newest.at(Moment::Tick(oldest)) {
                        Ok(version) => version,
                        Err(_) => break,
                    }
                }
                Err(_) => break,
            };
            passed.add(self.step(&version, meter)?);
        }
        passed.add(self.step(newest, meter)?);
        Ok(passed)
    }

    /// All that overlaps, as if it had just come.
    #[must_use]
    pub fn all(&self) -> Changes {
        Changes { regions: self.regions.all(), pairs: self.pairs.as_ref().map(Pairs::all).unwrap_or_default() }
    }

    /// The version that it saw last.
    #[must_use]
    pub fn tick(&self) -> Option<Tick> {
        self.seen.as_ref().map(|seen| seen.tick())
    }

    /// Whether all that it says to overlap is proved by the version that it saw last alone: nothing is undecided or kept by
    /// the hysteresis. Then a new watcher that begins at that version goes on in the same way.
    #[must_use]
    pub fn is_proved(&self) -> bool {
        self.regions.is_proved() && self.pairs.as_ref().is_none_or(Pairs::is_proved)
    }
}

impl Passed {
    fn add(&mut self, changes: Changes) {
        self.changed_tick_count += u64::from(!changes.is_empty());
        self.changes.merge(changes);
    }
}
