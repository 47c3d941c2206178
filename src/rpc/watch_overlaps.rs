//! `WatchOverlaps`: what enters and leaves regions and which shapes begin and cease to overlap, tick by tick.
//!
//! # Method
//! The session hands each version on as it is made, and the watcher steps to it, on another thread if the world is large.
//! What it finds waits in one heap until the reader takes it, so a slow reader gets several ticks at once and holds nobody up.
//! A watcher that is late itself steps through what it missed by the world's history; what that no longer holds makes the next
//! message a snapshot.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use collision::world::{Changes, Meter, Moment, PAIRS_MAX, Passed, QuestionError, Snapshot, Tick, Watcher};
use prost::Message;
use tokio::sync::{OwnedSemaphorePermit, broadcast};
use tokio_util::sync::CancellationToken;
use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{
    Answers, Caller, READER_PATIENCE, Server,
    answers::{Unread, stream},
};
use crate::{
    compute::{self, Weight},
    convert::{
        answer,
        watch::{Told, watch},
    },
    deadline::Deadline,
    problem::{Checked, Problem, Reason, quoted},
    session::Session,
    token::Role,
};

/// Overlaps of one message: 16 bytes each, about 1 MiB.
const ROWS_OF_A_MESSAGE: usize = 1 << 16;
/// Messages that wait for a reader.
const UNREAD_MESSAGES: usize = 2;
/// How often ticks without changes are told.
const QUIET: Duration = Duration::from_secs(1);
/// In worlds of more shapes a step is made on another thread: a shape that moved costs about a microsecond.
const STEPPED_AT_ONCE: usize = 500;

type Sent = Unread<pb::WatchOverlapsResponse>;

/// Begins to watch.
///
/// # Errors
/// What is wrong with the request; too many watch.
pub(super) async fn open(
    server: Arc<Server>,
    request: Request<pb::WatchOverlapsRequest>,
) -> Result<Response<Answers<pb::WatchOverlapsResponse>>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Reader)?;
    let resume = Resume::parse(&sent.resume_token)?;
    let fingerprint = fingerprint(&sent, &session);
    let begin = match resume {
        Some(resume) if resume.fingerprint == fingerprint && resume.is_proved => Begin::After(resume.tick),
        Some(_) => Begin::WithAll,
        None if sent.skip_snapshot => Begin::WithNothing,
        None => Begin::WithAll,
    };
    let known = session.clone();
    let weight = Weight::of_message(sent.encoded_len());
    let watch = compute::run(weight, "reading what to watch", move || watch(&sent, &known.geometries)).await?;
    let (versions, place) = (session.versions(), session.watching()?);
    let stop = server.drain.clone();
    let answers = stream(UNREAD_MESSAGES, |answers| async move {
        let watcher = Some(Watcher::new(watch));
        let watching = Watching { watcher, session, stop, deadline: caller.deadline, answers, _place: place };
        Ok(watching.run(versions, begin, &fingerprint).await?)
    });
    Ok(Response::new(answers))
}

/// What the first message is.
#[derive(Clone, Copy, Debug)]
enum Begin {
    /// All there is.
    WithAll,
    /// No overlap.
    WithNothing,
    /// What changed since this tick.
    After(Tick),
}

/// What waits to be told.
#[derive(Debug, Default)]
struct Pending {
    changes: Changes,
    changed_tick_count: u64,
    is_snapshot: bool,
}

/// One who watches.
struct Watching {
    /// `None` only while it is at work on another thread.
    watcher: Option<Watcher>,
    session: Arc<Session>,
    /// Cancelled when the server stops.
    stop: CancellationToken,
    deadline: Deadline,
    answers: Sent,
    _place: OwnedSemaphorePermit,
}

impl Watching {
    async fn run(
        mut self,
        mut versions: broadcast::Receiver<Arc<Snapshot>>,
        begin: Begin,
        fingerprint: &str,
    ) -> Checked<()> {
        let (session, answers, stop, deadline) =
            (self.session.clone(), self.answers.clone(), self.stop.clone(), self.deadline);
        let _lease = session.lease.hold();
        let mut pending = Some(self.first(begin).await?);
        let mut messages: Option<Messages> = None;
        let mut taken = Instant::now();
        let mut told = None;
        loop {
            if messages.is_none()
                && let Some(pending) = pending.take()
            {
                // All that was seen up to here is in it, also that nothing changed in the last ticks.
                (taken, told) = (Instant::now(), self.tick());
                messages = Some(Messages::of(&pending, told, self.token(fingerprint)));
            }
            tokio::select! {
                biased;
                () = stop.cancelled() => {
                    let what = "the server is stopping: watch again elsewhere, or later, with the last resume_token";
                    return Err(Problem::new(Reason::Stopping, what));
                }
                () = session.ended.cancelled() => return Err(session.ended_problem()),
                () = answers.closed() => return Ok(()),
                () = deadline.passed() => return Err(Deadline::problem()),
                permit = answers.reserve(), if messages.is_some() => {
                    let Ok(permit) = permit else { return Ok(()) };
                    if let Some(response) = messages.as_mut().map(Messages::next) {
                        taken = Instant::now();
                        messages = messages.filter(|_| response.more);
                        permit.send(Ok(response));
                    }
                }
                version = versions.recv() => match version {
                    Ok(version) => self.follow(version, &mut pending).await?,
                    // What was dropped is in the history of the next.
                    Err(broadcast::error::RecvError::Lagged(_)) => {}
                    Err(broadcast::error::RecvError::Closed) => return Err(session.ended_problem()),
                },
                () = tokio::time::sleep_until((taken + READER_PATIENCE).into()), if messages.is_some() => {
                    return Err(Problem::new(Reason::Overloaded, "the client took no message for 10 s: read them, and watch again with the last resume_token"));
                }
                () = tokio::time::sleep_until((taken + QUIET).into()), if messages.is_none() => {
                    taken = Instant::now();
                    pending = pending.or_else(|| (self.tick() > told).then(Pending::default));
                }
            }
        }
    }

    /// What is told first.
    async fn first(&mut self, begin: Begin) -> Checked<Pending> {
        let newest = self.session.newest();
        let passed = match begin {
            Begin::WithAll | Begin::WithNothing => self.work(Weight::Heavy, newest, Watcher::go_on).await?,
            Begin::After(tick) => {
                self.work(Weight::Heavy, newest, move |watcher, newest, meter| match newest.at(Moment::Tick(tick)) {
                    Ok(then) => {
                        watcher.step(&then, meter)?;
                        watcher.go_on(newest, meter)
                    }
                    Err(_) => watcher.go_on(newest, meter).map(|passed| Passed { missed: true, ..passed }),
                })
                .await?
            }
        };
        Ok(match begin {
            Begin::WithAll => self.all(),
            Begin::WithNothing => Pending::default(),
            Begin::After(_) if passed.missed => self.all(),
            Begin::After(_) => Pending::of(passed),
        })
    }

    /// Goes on to a version and adds what changed to what waits.
    async fn follow(&mut self, version: Arc<Snapshot>, pending: &mut Option<Pending>) -> Checked<()> {
        if self.tick().is_some_and(|seen| seen >= version.tick()) {
            return Ok(());
        }
        let weight = if version.len() > STEPPED_AT_ONCE { Weight::Heavy } else { Weight::Light };
        let passed = self.work(weight, version, Watcher::go_on).await?;
        let is_too_much =
            pending.as_ref().is_some_and(|pending| pending.changes.len() + passed.changes.len() > PAIRS_MAX);
        let is_whole = pending.as_ref().is_some_and(|pending| pending.is_snapshot);
        if passed.missed || is_too_much || is_whole {
            *pending = Some(self.all());
        } else if !passed.changes.is_empty() {
            match pending {
                Some(pending) => pending.add(passed),
                None => *pending = Some(Pending::of(passed)),
            }
        }
        Ok(())
    }

    /// Lets the watcher look at a version.
    async fn work(
        &mut self,
        weight: Weight,
        version: Arc<Snapshot>,
        look: impl FnOnce(&mut Watcher, &Arc<Snapshot>, &mut Meter<'_>) -> Result<Passed, QuestionError> + Send + 'static,
    ) -> Checked<Passed> {
        let Some(mut watcher) = self.watcher.take() else {
            return Err(Problem::new(Reason::Internal, "a watcher was lost, which is a fault of the server"));
        };
        let (answers, stop, session) = (self.answers.clone(), self.stop.clone(), self.session.clone());
        let looked = compute::run(weight, "watching", move || {
            let mut keep_going = || !answers.is_closed() && !stop.is_cancelled() && !session.ended.is_cancelled();
            let looked = look(&mut watcher, &version, &mut Meter::new(&mut keep_going));
            Ok((looked.map_err(|error| (error, version.tick())), watcher))
        });
        let (looked, watcher) = looked.await?;
        self.watcher = Some(watcher);
        looked.map_err(|(error, tick)| self.refused(&error, tick))
    }

    fn refused(&self, error: &QuestionError, tick: Tick) -> Problem {
        match error {
            QuestionError::Interrupted if self.session.ended.is_cancelled() => self.session.ended_problem(),
            QuestionError::Interrupted => {
                Problem::new(Reason::Stopping, "the server is stopping: watch again elsewhere, or later")
            }
            QuestionError::TooManyPairs => {
                let what = format!("{error}: watch fewer regions, name pair_ids, or leave shapes out with filter");
                Problem::new(Reason::QuotaExceeded, what).with("quota", "pairs").with("limit", PAIRS_MAX)
            }
            error => answer::refused(error, tick),
        }
    }

    fn tick(&self) -> Option<Tick> {
        self.watcher.as_ref().and_then(Watcher::tick)
    }

    fn all(&self) -> Pending {
        let changes = self.watcher.as_ref().map(Watcher::all).unwrap_or_default();
        Pending { changes, changed_tick_count: 0, is_snapshot: true }
    }

    /// Where to resume. What was kept without a proof a new watcher could not know.
    fn token(&self, fingerprint: &str) -> String {
        let is_proved = self.watcher.as_ref().is_some_and(Watcher::is_proved);
        self.tick().map(|tick| format!("{tick}-{fingerprint}-{}", u8::from(is_proved))).unwrap_or_default()
    }
}

impl Pending {
    fn of(passed: Passed) -> Self {
        let Passed { changes, changed_tick_count, .. } = passed;
        Self { changes, changed_tick_count, is_snapshot: false }
    }

    fn add(&mut self, passed: Passed) {
        self.changes.merge(passed.changes);
        self.changed_tick_count += passed.changed_tick_count;
    }
}

/// The messages of what is told at a time.
struct Messages {
    told: Told,
    /// What all have in common.
    like: pb::WatchOverlapsResponse,
    token: String,
}

impl Messages {
    fn of(pending: &Pending, tick: Option<Tick>, token: String) -> Self {
        let like = pb::WatchOverlapsResponse {
            info: Some(pb::AnswerInfo { tick: tick.map_or(0, Tick::get), ..pb::AnswerInfo::default() }),
            snapshot: pending.is_snapshot,
            merged_ticks: u32::try_from(pending.changed_tick_count).unwrap_or(u32::MAX),
            ..pb::WatchOverlapsResponse::default()
        };
        Self { told: Told::of(&pending.changes), like, token }
    }

    fn next(&mut self) -> pb::WatchOverlapsResponse {
        let pb::WatchOverlapsResponse { ref info, snapshot, merged_ticks, .. } = self.like;
        let info = info.clone();
        // A reader forgets what it knows once, at the first.
        self.like.snapshot = false;
        let lists = self.told.next(ROWS_OF_A_MESSAGE);
        match lists.more {
            true => pb::WatchOverlapsResponse { info, snapshot, ..lists },
            false => {
                let resume_token = std::mem::take(&mut self.token);
                pb::WatchOverlapsResponse { info, snapshot, merged_ticks, resume_token, ..lists }
            }
        }
    }
}

/// Where an earlier call ended.
#[derive(Debug)]
struct Resume {
    tick: Tick,
    fingerprint: String,
    is_proved: bool,
}

impl Resume {
    /// `None` if the token is empty.
    fn parse(token: &str) -> Checked<Option<Self>> {
        if token.is_empty() {
            return Ok(None);
        }
        let parsed = token.split_once('-').and_then(|(tick, rest)| {
            let (fingerprint, is_proved) = rest.split_once('-')?;
            let is_proved = matches!(is_proved, "0" | "1").then_some(is_proved == "1")?;
            Some(Self { tick: tick.parse().ok()?, fingerprint: fingerprint.to_owned(), is_proved })
        });
        parsed.map(Some).ok_or_else(|| {
            let what = format!("is {}, which no response gave: leave it empty to begin", quoted(token));
            Problem::at("resume_token", Reason::OutOfLimits, what)
        })
    }
}

/// Tells a request and the session that it watches from others.
fn fingerprint(sent: &pb::WatchOverlapsRequest, session: &Session) -> String {
    let mut hasher = blake3::Hasher::new();
    let asked = pb::WatchOverlapsRequest {
        session: format!("{} {:?}", session.id, session.created),
        resume_token: String::new(),
        skip_snapshot: false,
        ..sent.clone()
    };
    hasher.update(&asked.encode_to_vec());
    hasher.finalize().to_hex()[..16].to_owned()
}
