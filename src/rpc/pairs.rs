//! `Pairs`: all pairs of shapes that overlap, in as many messages as it takes; as a question among others, in one.
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
use wire::v1::{self as pb, answer::Answer as Kind};

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
};

/// Pairs of one message: 17 bytes each, about 1 MiB.
const PAIRS_OF_A_MESSAGE: usize = 1 << 16;
/// Messages that wait for a reader.
const UNREAD_MESSAGES: usize = 2;

/// Answers a call with a list of pairs.
///
/// # Errors
/// What is wrong with the question, too many pairs, the deadline.
pub(super) async fn call(
    server: &Server,
    request: Request<pb::PairsRequest>,
) -> Result<Response<Answers<pb::PairsResponse>>, Status> {
    let caller = Caller::of(&request);
    let asked = request.into_inner();
    let scene = Scene::of(server, &caller, &asked).await?;
    let listed = compute::run(Weight::Heavy, "finding pairs", move || {
        let listed = list(&asked, &scene);
        let told = || match &listed {
            Ok(listed) => listed.one_message(&scene).map(Kind::from),
            Err(problem) => Err(problem.clone()),
        };
        scene.tell(|| (asked.into(), told()));
        Ok((listed?, scene))
    });
    let (listed, scene) = listed.await?;
    let (parts, unread) = mpsc::channel(UNREAD_MESSAGES);
    tokio::spawn(async move {
        for part in listed.messages(&scene) {
            // A reader that has gone, or takes nothing, lets the list go.
            let Handed::Over = hand(&parts, part).await else { return };
        }
    });
    Ok(Response::new(Box::pin(ReceiverStream::new(unread))))
}

/// Answers it on the scene's version, in one message.
///
/// # Errors
/// What is wrong with the question, more pairs than a message has, the deadline.
pub(super) fn answer(sent: &pb::PairsRequest, scene: &Scene) -> Checked<pb::PairsResponse> {
    list(sent, scene)?.one_message(scene)
}

/// The version that changes are told since, if they are asked.
///
/// # Errors
/// A tick that is not held, or after the one that is read.
pub(super) fn since(sent: &pb::PairsRequest, world: &Arc<Snapshot>) -> Checked<Option<Arc<Snapshot>>> {
    let Some(tick) = sent.since_tick else { return Ok(None) };
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
    past::at_tick(world, tick).map(Some)
}

fn list(sent: &pb::PairsRequest, scene: &Scene) -> Checked<Listed> {
    let terms = scene.shared.overridden_by(sent.options.as_deref())?.into_owned();
    let old = since(sent, &scene.snapshot)?;
    let (pairs, account) = scene.ask(&terms, |meter| {
        let (filter, accuracy) = (&terms.filter, &terms.accuracy);
        let hits = match old {
            None => {
                let pairs = scene.snapshot.pairs(filter, accuracy, meter)?;
                pairs.into_iter().map(|pair| ListedPair { pair, change: None }).collect()
            }
            Some(old) => found::pair_changes(&scene.snapshot.pairs_since(&old, filter, accuracy, meter)?),
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
    Ok(Listed { pairs: pairs.hits, terms, account })
}

/// A list, and what is said with it.
#[derive(Debug)]
struct Listed {
    pairs: Vec<ListedPair>,
    terms: Terms,
    account: Account,
}

impl Listed {
    /// The only message of it.
    ///
    /// # Errors
    /// There are more pairs than a message has.
    fn one_message(&self, scene: &Scene) -> Checked<pb::PairsResponse> {
        let count = self.pairs.len();
        if count > PAIRS_OF_A_MESSAGE {
            let what = format!(
                "the answer has {count} pairs: at most {PAIRS_OF_A_MESSAGE} are told to a question among others; the call Pairs \
                 answers in parts"
            );
            let problem = Problem::new(Reason::QuotaExceeded, what);
            return Err(problem.with("quota", "pairs").with("limit", PAIRS_OF_A_MESSAGE));
        }
        Ok(self.message(0, scene))
    }

    /// The messages of it: at least one, which says on what tick there is nothing.
    fn messages(&self, scene: &Scene) -> impl Iterator<Item = pb::PairsResponse> {
        (0..self.message_count()).map(|number| self.message(number, scene))
    }

    fn message_count(&self) -> usize {
        self.pairs.len().div_ceil(PAIRS_OF_A_MESSAGE).max(1)
    }

    fn message(&self, number: usize, scene: &Scene) -> pb::PairsResponse {
        let begin = number * PAIRS_OF_A_MESSAGE;
        let part = &self.pairs[begin..self.pairs.len().min(begin + PAIRS_OF_A_MESSAGE)];
        let is_last = number + 1 == self.message_count();
        let mut info = scene.info(&self.terms, if is_last { self.account.clone() } else { Account::default() });
        if !is_last {
            info.iter_mut().for_each(|info| info.work = None);
        }
        pb::PairsResponse { info, ..found::pairs(part) }
    }
}
