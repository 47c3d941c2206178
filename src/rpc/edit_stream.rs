//! `EditStream`: a long stream of edits; each commit makes a tick, and a broken stream can be resumed.
//!
//! # Method
//! What a stream sends is read and checked as it comes and kept until a commit applies it as one batch. What was not
//! committed when the stream breaks is dropped: the first response of the next stream says where to go on. How far a
//! named writer got is kept with the world's writer, under the same lock, so that no tick is ever applied twice.

use std::sync::Arc;

use collision::world::{Edit, EditRule, Swept};
use prost::Message;
use tokio_util::sync::CancellationToken;
use tonic::{Request, Status, Streaming};
use wire::v1 as pb;

use super::{
    Answers, Caller, Server,
    answers::{Handed, Unread, hand, stream},
    edit::{check_durability, when},
};
use crate::{
    compute::{self, Weight},
    convert::{
        answer::sweep_hits,
        edit::{Expanded, Place, expand, fault, refused},
    },
    gate::the_api_says,
    problem::{Checked, Problem, Reason},
    session::Session,
    token::Role,
    writer::{Acked, When, Writer},
};

/// Messages that a writer may have unacknowledged, and so the most that one tick may consist of.
const WINDOW: u32 = 256;
/// Edits that may wait for their commit.
const PENDING_EDITS: usize = 1 << 20;
/// Problems that are told with one commit; of the rest only how many.
const PROBLEMS: usize = 1000;
/// Longest name of a writer.
const NAME_BYTES: usize = 128;
/// Acknowledgements that wait for a reader.
const UNREAD_ANSWERS: usize = 64;

/// Answers a stream; what goes wrong ends it.
pub(super) fn open(
    server: Arc<Server>,
    request: Request<Streaming<pb::EditStreamRequest>>,
) -> Answers<pb::EditStreamResponse> {
    let caller = Caller::of(&request);
    stream(UNREAD_ANSWERS, |answers| async move { run(&server, &caller, request.into_inner(), &answers).await })
}

async fn run(
    server: &Server,
    caller: &Caller,
    mut messages: Streaming<pb::EditStreamRequest>,
    answers: &Unread<pb::EditStreamResponse>,
) -> Result<(), Status> {
    let first = tokio::select! {
        first = messages.message() => first.map_err(the_api_says)?,
        () = server.drain.cancelled() => return Err(stopping().into()),
    };
    let Some(first) = first else { return Ok(()) };
    let session = server.enter(caller, &first.session, Role::Writer)?;
    check_durability(first.durability)?;
    let _lease = session.lease.hold();
    let mut stream = Stream::begin(session.clone(), &first.writer).await?;
    send(answers, stream.acknowledgement(Vec::new())).await?;
    if first.sequence > 0 || !first.edits.is_empty() || first.commit {
        stream.take(first, answers).await?;
    }
    loop {
        let message = tokio::select! {
            biased;
            () = server.drain.cancelled() => return Err(stopping().into()),
            () = session.ended.cancelled() => return Err(session.ended_problem().into()),
            () = stream.current.cancelled() => return Err(stream.replaced().into()),
            () = answers.closed() => return Ok(()),
            message = messages.message() => message.map_err(the_api_says)?,
        };
        let Some(message) = message else { return Ok(()) };
        stream.take(message, answers).await?;
    }
}

/// One stream of a writer.
#[derive(Debug)]
struct Stream {
    session: Arc<Session>,
    /// Empty if nothing is resumed.
    name: String,
    /// Cancelled when a new stream of this writer begins.
    current: CancellationToken,
    acked: Acked,
    /// The last message that came, committed or not.
    last_sequence: u64,
    pending: Pending,
}

/// What waits for a commit.
#[derive(Debug, Default)]
struct Pending {
    edits: Vec<Edit>,
    /// Message and place of each edit.
    origins: Vec<(u64, Place)>,
    problems: Vec<pb::Problem>,
    untold_problem_count: usize,
}

impl Pending {
    fn add_problem(&mut self, sequence: u64, problem: Problem) {
        if self.problems.len() < PROBLEMS {
            let mut problem = problem.into_wire();
            problem.sequence = sequence;
            self.problems.push(problem);
        } else {
            self.untold_problem_count += 1;
        }
    }

    fn add(&mut self, sequence: u64, expanded: Expanded) {
        self.edits.extend(expanded.edits);
        self.origins.extend(expanded.places.into_iter().map(|place| (sequence, place)));
        for problem in expanded.problems {
            self.add_problem(sequence, problem);
        }
    }

    /// The problems to tell, with a last one for those that found no room.
    fn into_problems(self) -> Vec<pb::Problem> {
        let mut problems = self.problems;
        if self.untold_problem_count > 0 {
            let what = format!("{} more edits were left out, too many to tell", self.untold_problem_count);
            problems.push(Problem::new(Reason::TooManyItems, what).into_wire());
        }
        problems
    }
}

impl Stream {
    async fn begin(session: Arc<Session>, name: &str) -> Checked<Self> {
        if name.len() > NAME_BYTES {
            let what = format!("has {} bytes: at most {NAME_BYTES} are allowed, so choose a shorter one", name.len());
            return Err(Problem::at("writer", Reason::OutOfLimits, what));
        }
        let (acked, current) = session.writer.lock().await.begin_stream(name);
        Ok(Self {
            session,
            name: name.to_owned(),
            current,
            last_sequence: acked.sequence,
            acked,
            pending: Pending::default(),
        })
    }

    /// Takes one message in, and acknowledges it if it is a commit.
    async fn take(
        &mut self,
        message: pb::EditStreamRequest,
        answers: &Unread<pb::EditStreamResponse>,
    ) -> Result<(), Status> {
        let sequence = message.sequence;
        if sequence == 0 {
            let what = "is 0: messages are numbered 1, 2, 3, … by their writer; only a first message without edits may \
                        leave it out";
            return Err(Problem::at("sequence", Reason::OutOfLimits, what).into());
        }
        if sequence <= self.last_sequence {
            // Known and dropped. A commit is acknowledged again: its first acknowledgement may have been lost.
            if message.commit && sequence <= self.acked.sequence {
                send(answers, self.acknowledgement(Vec::new())).await?;
            }
            return Ok(());
        }
        self.check_order(sequence)?;
        self.last_sequence = sequence;
        let when = match when(message.time.as_ref()) {
            Ok(when) => when,
            Err(problem) => {
                self.pending.add_problem(sequence, problem);
                When::Now
            }
        };
        let is_commit = message.commit;
        let weight = Weight::of_message(message.encoded_len());
        self.read(message, weight).await?;
        if is_commit {
            let (problems, swept) = self.commit(sequence, when, weight).await?;
            let acknowledgement = pb::EditStreamResponse {
                sweep_hits: sweep_hits(&swept)?,
                sweep_hits_truncated: swept.truncated,
                ..self.acknowledgement(problems)
            };
            send(answers, acknowledgement).await?;
        }
        Ok(())
    }

    fn check_order(&self, sequence: u64) -> Checked<()> {
        let expected = self.last_sequence + 1;
        if sequence != expected {
            let what =
                format!("is {sequence}, and {expected} was expected: send again whatever came after acked_sequence");
            let problem = Problem::at("sequence", Reason::SequenceGap, what);
            return Err(problem.with("expected_sequence", expected));
        }
        if sequence - self.acked.sequence > u64::from(WINDOW) {
            let what = format!(
                "is {sequence}, and only {} is acknowledged: keep at most {WINDOW} messages unacknowledged, \
                 so a tick has at most so many",
                self.acked.sequence
            );
            return Err(Problem::at("sequence", Reason::QuotaExceeded, what)
                .with("quota", "window")
                .with("limit", WINDOW));
        }
        Ok(())
    }

    /// Reads a message's edits; what is wrong with one leaves out that one.
    async fn read(&mut self, message: pb::EditStreamRequest, weight: Weight) -> Checked<()> {
        let sequence = message.sequence;
        let session = self.session.clone();
        let reading = compute::run(weight, "reading edits", move || expand(&message.edits, &session.geometries));
        match reading.await {
            Ok(expanded) => self.pending.add(sequence, expanded),
            Err(problem) => self.pending.add_problem(sequence, problem),
        }
        let waiting = self.pending.edits.len();
        if waiting <= PENDING_EDITS {
            return Ok(());
        }
        let what = format!("has {waiting} edits in the open tick, which may have {PENDING_EDITS}: commit more often");
        Err(Problem::new(Reason::QuotaExceeded, format!("the stream {what}"))
            .with("quota", "pending_edits")
            .with("limit", PENDING_EDITS))
    }

    /// Makes a tick of what waits; returns what was left out of it, and what bullets touched in it.
    async fn commit(&mut self, sequence: u64, when: When, weight: Weight) -> Checked<(Vec<pb::Problem>, Swept)> {
        let mut pending = std::mem::take(&mut self.pending);
        let session = self.session.clone();
        let writer = session.writer.clone().lock_owned().await;
        // Under the lock: from here on no new stream of this writer can have been told what is committed.
        if self.current.is_cancelled() {
            return Err(self.replaced());
        }
        if session.ended.is_cancelled() {
            return Err(session.ended_problem());
        }
        let name = self.name.clone();
        let weight = weight.with_bullets(session.newest().bullet_count());
        let (acked, told) = compute::run(weight, "applying edits", move || {
            let mut writer = writer;
            let when = not_before_the_newest(when, sequence, &writer, &mut pending);
            let edits = std::mem::take(&mut pending.edits);
            let applied = session.commit(&mut writer, edits, when, EditRule::LeaveOutWrong)?;
            // Only a time that goes back is refused under this rule, and that was seen to.
            let report = applied.map_err(|error| refused(error, &[]))?;
            for left_out in &report.faults {
                if let Some(&(sequence, place)) = pending.origins.get(left_out.index) {
                    pending.add_problem(sequence, fault(*left_out, place));
                }
            }
            let acked = Acked { sequence, tick: Some(report.tick) };
            writer.acknowledge(&name, acked);
            Ok((acked, (pending.into_problems(), report.swept)))
        })
        .await?;
        self.acked = acked;
        Ok(told)
    }

    fn acknowledgement(&self, problems: Vec<pb::Problem>) -> pb::EditStreamResponse {
        pb::EditStreamResponse {
            acked_sequence: self.acked.sequence,
            tick: self.acked.tick.map_or(0, |tick| tick.get()),
            window: WINDOW,
            durability: pb::Durability::Applied.into(),
            problems,
            sweep_hits: Vec::new(),
            sweep_hits_truncated: false,
        }
    }

    fn replaced(&self) -> Problem {
        let what = format!(
            "a new stream of writer {:?} has begun, which ends this one: give each writer a name of its own",
            self.name
        );
        Problem::new(Reason::WriterReplaced, what)
    }
}

/// The time of a tick, or that of the newest if it would go back: the tick itself is not left out for it.
fn not_before_the_newest(when: When, sequence: u64, writer: &Writer, pending: &mut Pending) -> When {
    let newest = writer.world.newest().time();
    match when {
        When::At(time) if time < newest => {
            let what = "is before that of the newest tick, whose time was taken instead: a tick's time never goes back; leave it out for the server's clock";
            pending.add_problem(sequence, Problem::at("time", Reason::OutOfLimits, what));
            When::At(newest)
        }
        When::At(_) | When::Now => when,
    }
}

async fn send(answers: &Unread<pb::EditStreamResponse>, answer: pb::EditStreamResponse) -> Result<(), Status> {
    match hand(answers, answer).await {
        Handed::Over => Ok(()),
        Handed::Gone => Err(Status::cancelled("the client has gone")),
        Handed::TooSlow => {
            let what = "the client took no acknowledgement for 10 s: read them, and resume";
            Err(Problem::new(Reason::Overloaded, what).into())
        }
    }
}

fn stopping() -> Problem {
    Problem::new(
        Reason::Stopping,
        "the server is stopping: send again elsewhere, or later, whatever came after acked_sequence",
    )
}
