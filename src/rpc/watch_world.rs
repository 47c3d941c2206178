//! `WatchWorld`: the shapes that a viewer sees and how they change, at the rate that it can draw.
//!
//! # Method
//! At each turn the newest version is compared with the one that was told last, however many ticks lie between them. Nothing
//! is noted in between, so a viewer costs the writer nothing, and a slow one is told less often. Questions, if they are
//! watched, wait in a ring of their own, so a viewer costs those who ask no more than a copy.

use std::{
    ops::ControlFlow,
    sync::Arc,
    time::{Duration, Instant},
};

use collision::world::{Snapshot, View};
use prost::Message;
use tokio::sync::OwnedSemaphorePermit;
use tokio_util::sync::CancellationToken;
use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{
    Answers, Caller, Server,
    answers::{Handed, Unread, hand, stream},
};
use crate::{
    compute::{self, Weight},
    convert::view::{self, NODES_OF_A_TREE, Shown},
    deadline::Deadline,
    problem::{Checked, Problem, Reason},
    session::Session,
    token::Role,
    traces::Watching,
};

/// Messages that wait for a reader.
const UNREAD_MESSAGES: usize = 2;
/// What the questions of a message may take: what is shown beside them takes up to 2 MiB.
const TRACES_BYTES: usize = 1 << 20;
/// How often ticks that change nothing in view are told.
const QUIET: Duration = Duration::from_secs(1);

type Sent = Unread<pb::WatchWorldResponse>;

/// Begins to show a world.
///
/// # Errors
/// What is wrong with the request; too many watch.
pub(super) fn open(
    server: &Server,
    request: Request<pb::WatchWorldRequest>,
) -> Result<Response<Answers<pb::WatchWorldResponse>>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    // What others ask is the owner's to know.
    let least = if sent.questions { Role::Owner } else { Role::Reader };
    let session = server.enter(&caller, &sent.session, least)?;
    let (view, rate) = view::view(&sent)?;
    let viewer = Viewer {
        view: Arc::new(view),
        period: Duration::from_secs(1) / rate as u32,
        tree_depth: sent.tree_depth,
        stop: server.drain.clone(),
        deadline: caller.deadline,
        _place: session.watching()?,
        session,
    };
    let questions = sent.questions.then(|| viewer.session.traces.watch());
    let answers = stream(UNREAD_MESSAGES, |answers| async move { Ok(viewer.run(questions, &answers).await?) });
    Ok(Response::new(answers))
}

/// One who looks on.
struct Viewer {
    view: Arc<View>,
    /// From one message to the next.
    period: Duration,
    /// Levels of the trees, if they are shown.
    tree_depth: Option<u32>,
    session: Arc<Session>,
    /// Cancelled when the server stops.
    stop: CancellationToken,
    deadline: Deadline,
    _place: OwnedSemaphorePermit,
}

/// What is told at a time.
struct Turn {
    shown: Shown,
    /// Whether it is worth telling.
    changed: bool,
    /// The trees as they were told last.
    nodes: Option<pb::NodeColumns>,
}

impl Viewer {
    async fn run(&self, mut questions: Option<Watching<pb::Trace>>, answers: &Sent) -> Checked<()> {
        let _lease = self.session.lease.hold();
        let mut ticks = self.session.ticks();
        let mut told: Option<Arc<Snapshot>> = None;
        let mut nodes = None;
        let mut spoken = Instant::now();
        let mut told_count = 0_u64;
        loop {
            let began = Instant::now();
            ticks.mark_unchanged();
            let newest = self.session.newest();
            let turn = self.turn(told.take(), &newest, nodes.take()).await?;
            nodes = turn.nodes;
            let asked = questions.as_mut().map(Told::of).unwrap_or_default();
            if turn.changed || asked.is_some() || spoken.elapsed() >= QUIET {
                if send(answers, (turn.shown, asked), &newest, told_count).await?.is_break() {
                    return Ok(());
                }
                told_count += 1;
                spoken = Instant::now();
            }
            let is_told = spoken >= began;
            told = Some(newest);
            let wait = async {
                tokio::time::sleep_until((began + self.period).into()).await;
                // What was not told for want of changes is told when the time for that has come.
                let quiet = async {
                    match is_told {
                        true => std::future::pending().await,
                        false => tokio::time::sleep_until((spoken + QUIET).into()).await,
                    }
                };
                let question = async {
                    match &mut questions {
                        Some(questions) => questions.come().await,
                        None => std::future::pending().await,
                    }
                };
                tokio::select! {
                    // An error cannot be: the sender lives as long as the session.
                    _ = ticks.changed() => {}
                    () = quiet => {}
                    () = question => {}
                }
            };
            tokio::select! {
                biased;
                () = self.stop.cancelled() => {
                    return Err(Problem::new(Reason::Stopping, "the server is stopping: watch again elsewhere, or later"));
                }
                () = self.session.ended.cancelled() => return Err(self.session.ended_problem()),
                () = answers.closed() => return Ok(()),
                () = self.deadline.passed() => return Err(Deadline::problem()),
                () = wait => {}
            }
        }
    }

    /// What is to be told of a version, on another thread: a pass over what changed, at first over all shapes.
    async fn turn(
        &self,
        told: Option<Arc<Snapshot>>,
        newest: &Arc<Snapshot>,
        nodes: Option<pb::NodeColumns>,
    ) -> Checked<Turn> {
        let (view, newest, tree_depth) = (self.view.clone(), newest.clone(), self.tree_depth);
        compute::run(Weight::Heavy, "showing a world", move || {
            let changes = match &told {
                Some(told) => newest.view_since(told, &view),
                None => newest.view(&view),
            };
            let boxes = tree_depth.map(|depth| newest.tree_boxes(depth, NODES_OF_A_TREE));
            let found = boxes.map(|boxes| view::nodes(&boxes)).transpose()?;
            let changed_nodes = found.clone().filter(|found| nodes.as_ref() != Some(found));
            let changed = told.is_none() || !changes.is_empty() || changed_nodes.is_some();
            Ok(Turn { shown: Shown::new(changes, changed_nodes), changed, nodes: found })
        })
        .await
    }
}

/// The questions that are told at a time.
#[derive(Default)]
struct Told {
    traces: Vec<pb::Trace>,
    skipped_count: u64,
}

impl Told {
    /// All since the last time, the newest that a message has room for.
    fn of(questions: &mut Watching<pb::Trace>) -> Self {
        let (seen, missed_count) = questions.take();
        let mut room = TRACES_BYTES;
        let fits = |trace: &&Arc<pb::Trace>| {
            let bytes = trace.encoded_len();
            room = room.saturating_sub(bytes);
            room > 0
        };
        let kept_count = seen.iter().rev().take_while(fits).count();
        let left_out = seen.len() - kept_count;
        Self {
            traces: seen[left_out..].iter().map(|trace| pb::Trace::clone(trace)).collect(),
            skipped_count: missed_count + left_out as u64,
        }
    }

    /// Whether there is anything to tell.
    fn is_some(&self) -> bool {
        !self.traces.is_empty() || self.skipped_count > 0
    }
}

/// Sends all messages of a turn; breaks if nobody reads any more. The first turn is the snapshot.
///
/// # Errors
/// The reader takes none.
async fn send(
    answers: &Sent,
    (mut shown, asked): (Shown, Told),
    newest: &Snapshot,
    told_count: u64,
) -> Checked<ControlFlow<()>> {
    let info = Some(pb::AnswerInfo { tick: newest.tick().get(), ..pb::AnswerInfo::default() });
    let mut snapshot = told_count == 0;
    let Told { mut traces, skipped_count: mut traces_skipped } = asked;
    loop {
        let message = pb::WatchWorldResponse { info: info.clone(), snapshot, traces, traces_skipped, ..shown.next()? };
        (traces, traces_skipped) = (Vec::new(), 0);
        snapshot = false;
        let more = message.more;
        match hand(answers, message).await {
            Handed::Over if more => {}
            Handed::Over => return Ok(ControlFlow::Continue(())),
            Handed::Gone => return Ok(ControlFlow::Break(())),
            Handed::TooSlow => {
                let what = "the client took no message for 10 s: read them, and watch again";
                return Err(Problem::new(Reason::Overloaded, what));
            }
        }
    }
}
