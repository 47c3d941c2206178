//! Touches in the past: what is asked, and when they were.

use std::sync::Arc;

use collision::world::{FirstTouch, Found, PastTouch, Snapshot, Tick};
use wire::v1 as pb;

use super::{
    answer::{all_out, impact, verdict},
    question::{against, subject},
};
use crate::{
    geometries::Geometries,
    past,
    problem::{Checked, Problem, Reason},
};

/// The question of a first touch; the version says which ticks are held.
///
/// # Errors
/// What is wrong with it, a tick that is not held.
pub(crate) fn first_touch(
    sent: &pb::FirstTouchRequest,
    known: &Geometries,
    world: &Arc<Snapshot>,
) -> Checked<FirstTouch> {
    let Some(from) = Tick::new(sent.from_tick) else {
        let what = "is 0: ticks begin at 1; say from which tick on to look, such as 1";
        return Err(Problem::at("from_tick", Reason::OutOfLimits, what));
    };
    let to = Tick::new(sent.to_tick).unwrap_or(world.tick());
    past::check_held("from_tick", from, world)?;
    past::check_held("to_tick", to, world)?;
    if to < from {
        let what = format!("is {to}, before from_tick, {from}; leave it out for the newest tick");
        return Err(Problem::at("to_tick", Reason::OutOfLimits, what));
    }
    Ok(FirstTouch {
        subject: subject(sent.subject.as_ref(), known)?,
        against: against(sent.against.as_deref(), known)?,
        from,
        to,
    })
}

/// The answer; who sends it adds what was read.
///
/// # Errors
/// A number is not finite, which is a fault of the server.
pub(crate) fn touched(found: &Found<PastTouch>) -> Checked<pb::FirstTouchResponse> {
    let hit = |hit: &PastTouch| Ok(pb::PastTouch { tick: hit.tick.get(), impact: Some(impact(&hit.impact)?) });
    Ok(pb::FirstTouchResponse {
        verdict: verdict(found.verdict).into(),
        hits: all_out(&found.hits, hit)?,
        truncated: found.truncated,
        info: None,
    })
}
