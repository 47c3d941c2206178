//! `Edit`: a batch of edits as one tick, all or nothing.

use std::{sync::Arc, time::Instant};

use collision::world::{EditRule, Tick};
use prost::Message;
use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Caller, Server};
use crate::{
    compute::{self, Weight},
    convert::{
        answer::sweep_hits,
        edit::{Expanded, expand, refused},
        number::{time, unknown_enum},
    },
    problem::{Checked, Problem, Reason},
    retry::RetryKey,
    session::Session,
    token::Role,
    writer::{Committed, When},
};

/// Applies the edits of a request.
///
/// # Errors
/// What is wrong with them; nothing has changed then.
pub(super) async fn answer(
    server: &Server,
    request: Request<pb::EditRequest>,
) -> Result<Response<pb::EditResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Writer)?;
    check_durability(sent.durability)?;
    let retry = RetryKey::of(&sent.request_id, &sent)?;
    if retry.is_some() {
        // Before anything is looked at: what the first request named, such as a geometry, may be gone by now.
        let first = session.writer.lock().await.retries.find(retry.as_ref(), Instant::now())?;
        if let Some(first) = first {
            return Ok(Response::new(response(&first)?));
        }
    }
    let when = when(sent.time.as_ref())?;
    let expected = sent.expected_tick;
    let weight = Weight::of_message(sent.encoded_len());
    let expanding = session.clone();
    let batch = compute::run(weight, "reading edits", move || checked(&sent, &expanding)).await?;
    let mut writer = session.writer.clone().lock_owned().await;
    let weight = weight.with_bullets(session.newest().bullet_count());
    let committed = compute::run(weight, "applying edits", move || {
        if let Some(first) = writer.retries.find(retry.as_ref(), Instant::now())? {
            return Ok(first);
        }
        check_expected(expected, &session)?;
        let Expanded { edits, places, .. } = batch;
        let applied = session.commit(&mut writer, edits, when, EditRule::AllOrNothing)?;
        let report = applied.map_err(|error| refused(error, &places))?;
        let swept = Arc::new(report.swept);
        let committed = Committed { tick: report.tick, changed_count: report.changed_count, swept };
        let hit_count = committed.swept.hits.len();
        writer.retries.keep_items(retry, &committed, hit_count, Instant::now());
        Ok(committed)
    });
    Ok(Response::new(response(&committed.await?)?))
}

/// The time of a tick.
///
/// # Errors
/// It is out of range.
pub(super) fn when(sent: Option<&prost_types::Timestamp>) -> Checked<When> {
    match sent {
        None => Ok(When::Now),
        Some(sent) => time("time", sent).map(When::At),
    }
}

/// Checks that the durability that was asked for is offered.
///
/// # Errors
/// It is not.
pub(super) fn check_durability(sent: i32) -> Checked<()> {
    let name = match pb::Durability::try_from(sent) {
        Ok(pb::Durability::Unspecified | pb::Durability::Applied) => return Ok(()),
        Ok(pb::Durability::Local) => "LOCAL",
        Ok(pb::Durability::Replicated) => "REPLICATED",
        Err(_) => {
            let names = "DURABILITY_APPLIED (1), DURABILITY_LOCAL (2), DURABILITY_REPLICATED (3)";
            return Err(unknown_enum("durability", sent, names));
        }
    };
    let what = format!("is {name}, which this server cannot give: it keeps worlds in memory only, so use APPLIED");
    Err(Problem::at("durability", Reason::DurabilityNotOffered, what))
}

/// All edits of the request, if none is wrong.
fn checked(sent: &pb::EditRequest, session: &Arc<Session>) -> Checked<Expanded> {
    let mut expanded = expand(&sent.edits, &session.geometries)?;
    match expanded.problems.is_empty() {
        true => Ok(expanded),
        false => Err(expanded.problems.swap_remove(0)),
    }
}

fn check_expected(expected: Option<u64>, session: &Session) -> Checked<()> {
    let newest = session.newest().tick();
    match expected {
        Some(expected) if Tick::new(expected) != Some(newest) => {
            let what = format!("is {expected}, and the newest tick is {newest}: read it again and decide anew");
            Err(Problem::at("expected_tick", Reason::TickChanged, what).with("newest_tick", newest))
        }
        Some(_) | None => Ok(()),
    }
}

fn response(committed: &Committed) -> Checked<pb::EditResponse> {
    Ok(pb::EditResponse {
        tick: committed.tick.get(),
        changed_count: committed.changed_count,
        durability: pb::Durability::Applied.into(),
        sweep_hits: sweep_hits(&committed.swept)?,
        sweep_hits_truncated: committed.swept.truncated,
    })
}
