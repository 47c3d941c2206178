//! The version of a world that a question asks for, and what is said if it is not held.

use std::sync::Arc;

use collision::world::{HistoryError, Moment, Snapshot, Tick};

use crate::{
    compute::{self, Weight},
    problem::{Checked, Problem, Reason},
    session::ReadAt,
};

/// In worlds of more shapes, the first question to a time is prepared on another thread: that takes up to 0.5 µs a shape.
const PREPARED_AT_ONCE: usize = 500;

/// What a question reads, of a world whose newest version is `newest`.
///
/// # Errors
/// A version that is not held, or not made yet.
pub(crate) async fn read(newest: Arc<Snapshot>, read_at: ReadAt) -> Checked<Arc<Snapshot>> {
    let moment = match read_at {
        ReadAt::Newest | ReadAt::MinTick(_) => return Ok(newest),
        ReadAt::Tick(tick, fraction) if fraction > 0.0 => Moment::Between(tick, fraction),
        ReadAt::Tick(tick, _) => Moment::Tick(tick),
        ReadAt::Time(time) => Moment::Time(time),
    };
    let is_long = newest.len() > PREPARED_AT_ONCE && !newest.is_prepared(moment);
    let weight = if is_long { Weight::Heavy } else { Weight::Light };
    compute::run(weight, "preparing the past", move || newest.at(moment).map_err(|error| refused(&error))).await
}

/// A tick of a world's history.
///
/// # Errors
/// It is not held, or not made yet.
pub(crate) fn at_tick(world: &Arc<Snapshot>, tick: Tick) -> Checked<Arc<Snapshot>> {
    world.at(Moment::Tick(tick)).map_err(|error| refused(&error))
}

/// What is said of a version that cannot be read.
pub(crate) fn refused(error: &HistoryError) -> Problem {
    match *error {
        HistoryError::Gone { asked, oldest, newest } => {
            let what = format!("is {asked}, which is no longer held: {}; name one from there on", held(oldest, newest));
            not_held("read_at.tick", what, oldest, newest)
        }
        HistoryError::NotMade { asked, oldest, newest } => {
            let what = format!("is {asked}, which is not made yet: {}; min_tick waits", held(oldest, newest));
            not_held("read_at.tick", what, oldest, newest)
        }
        HistoryError::TimeGone { oldest, newest } => {
            let what =
                format!("is before the time of the oldest tick held: {}; name a later one", held(oldest, newest));
            not_held("read_at.time", what, oldest, newest)
        }
        HistoryError::NothingAfter { oldest, newest } => {
            let what =
                format!("is above 0: there is no tick after {newest} yet, and nothing is extrapolated; leave it out");
            not_held("read_at.tick_fraction", what, oldest, newest)
        }
        HistoryError::Fraction(fraction) => {
            let what = format!("is {fraction}: it must be from 0 to below 1");
            Problem::at("read_at.tick_fraction", Reason::OutOfLimits, what)
        }
    }
}

/// Checks that a tick is held, which the field `field` names.
///
/// # Errors
/// It is not, or not made yet.
pub(crate) fn check_held(field: &str, tick: Tick, world: &Arc<Snapshot>) -> Checked<()> {
    let (oldest, newest) = (world.oldest_tick(), world.newest_tick());
    if tick < oldest {
        let what = format!("is {tick}, which is no longer held: {}; name one of these", held(oldest, newest));
        return Err(not_held(field, what, oldest, newest));
    }
    if tick > newest {
        let what = format!("is {tick}, which is not made yet: {}; name one of these", held(oldest, newest));
        return Err(not_held(field, what, oldest, newest));
    }
    Ok(())
}

/// Says which versions there are; if it is one, how to have more.
pub(crate) fn held(oldest: Tick, newest: Tick) -> String {
    match oldest == newest {
        true => {
            format!("oldest and newest are {newest}; history_ticks of the world's settings keeps more from then on")
        }
        false => format!("oldest is {oldest}, newest {newest}"),
    }
}

/// The problem of a version that cannot be read.
pub(crate) fn not_held(field: &str, what: String, oldest: Tick, newest: Tick) -> Problem {
    Problem::at(field, Reason::TickNotHeld, what).with("oldest_tick", oldest).with("newest_tick", newest)
}
