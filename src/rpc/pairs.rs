//! `Pairs`: all pairs of shapes that overlap, in as many messages as it takes.
//!
//! # Method
//! The list is found whole before the first message goes out, so what is refused is refused at once and all messages are
//! of one tick. They are made one by one as the reader takes them.

use std::sync::Arc;

use collision::{
    answer::Verdict,
    world::{Found, Pair, Snapshot, Tick},
};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{
    Answers, Caller, Server,
    account::Account,
    answers::{Handed, hand},
    scene::{Scene, Terms},
};
use crate::{
    compute::{self, Weight},
    convert::answer::{self as found, ListedPair},
    past,
    problem::{Checked, Problem, Reason},
    session::ReadAt,
};

/// Pairs of one message: 17 bytes each, about 1 MiB.
const PAIRS_OF_A_MESSAGE: usize = 1 << 16;
/// Messages that wait for a reader.
const UNREAD_MESSAGES: usize = 2;

/// Answers with a list of pairs.
///
/// # Errors
/// What is wrong with the question, too many pairs, the deadline.
pub(super) async fn answer(
    server: &Server,
    request: Request<pb::PairsRequest>,
) -> Result<Response<Answers<pb::PairsResponse>>, Status> {
    let caller = Caller::of(&request);
    let asked = request.into_inner();
    let scene = Scene::of(server, &caller, &asked).await?;
    let asking = scene.clone();
    let terms = scene.shared.overridden_by(asked.options.as_deref())?.into_owned();
    let agreed = terms.clone();
    let old = match asked.since_tick {
        Some(tick) => Some(since(tick, &scene.snapshot).await?),
        None => None,
    };
    let listing = move || list(&asking, &agreed, old.as_deref());
    let (pairs, account) = compute::run(Weight::Heavy, "finding pairs", listing).await?;
    let (parts, unread) = mpsc::channel(UNREAD_MESSAGES);
    tokio::spawn(async move {
        for part in messages(&pairs, &scene, &terms, account) {
            // A reader that has gone, or takes nothing, lets the list go.
            let Handed::Over = hand(&parts, part).await else { return };
        }
    });
    Ok(Response::new(Box::pin(ReceiverStream::new(unread))))
}

/// The version that changes are told since.
async fn since(tick: u64, world: &Arc<Snapshot>) -> Checked<Arc<Snapshot>> {
    let Some(tick) = Tick::new(tick) else {
        return Err(Problem::at(
            "since_tick",
            Reason::OutOfLimits,
            "is 0: ticks begin at 1; name the tick to compare with",
        ));
    };
    if tick > world.tick() {
        let what = format!("is {tick}, after tick {}, which is read: name an earlier one", world.tick());
        return Err(Problem::at("since_tick", Reason::OutOfLimits, what));
    }
    past::check_held("since_tick", tick, world)?;
    past::read(world.clone(), ReadAt::Tick(tick, 0.0)).await
}

fn list(scene: &Scene, terms: &Terms, old: Option<&Snapshot>) -> Checked<(Vec<ListedPair>, Account)> {
    let (pairs, account) = scene.ask(terms, |meter| {
        let (filter, accuracy) = (&terms.filter, &terms.accuracy);
        let hits = match old {
            None => {
                let pairs = scene.snapshot.pairs(filter, accuracy, meter)?;
                pairs.into_iter().map(|pair| ListedPair { pair, change: None }).collect()
            }
            Some(old) => found::pair_changes(&scene.snapshot.pairs_since(old, filter, accuracy, meter)?),
        };
        let is_undecided = |pair: &Pair| pair.certificate.verdict == Verdict::Undecided;
        let is_open = !hits.is_empty() && hits.iter().all(|listed| is_undecided(&listed.pair));
        let verdict = match (is_open, hits.is_empty()) {
            (true, _) => Verdict::Undecided,
            (false, true) => Verdict::Miss,
            (false, false) => Verdict::Hit,
        };
        Ok(Found { verdict, hits, truncated: false })
    })?;
    Ok((pairs.hits, account))
}

/// The messages of a list: at least one, which says on what tick there is nothing.
fn messages<'a>(
    pairs: &'a [ListedPair],
    scene: &'a Scene,
    terms: &'a Terms,
    mut account: Account,
) -> impl Iterator<Item = pb::PairsResponse> + 'a {
    let count = pairs.len().div_ceil(PAIRS_OF_A_MESSAGE).max(1);
    (0..count).map(move |number| {
        let begin = number * PAIRS_OF_A_MESSAGE;
        let part = &pairs[begin..pairs.len().min(begin + PAIRS_OF_A_MESSAGE)];
        let is_last = number + 1 == count;
        let mut info = scene.info(terms, if is_last { std::mem::take(&mut account) } else { Account::default() });
        if !is_last {
            info.iter_mut().for_each(|info| info.work = None);
        }
        pb::PairsResponse { info, ..found::pairs(part) }
    })
}
