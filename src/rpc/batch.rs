//! `Batch`: questions of any kinds, answered on one tick; each fails by itself.

use std::time::{Duration, Instant};

use tonic::{Request, Response, Status};
use wire::v1::{self as pb, answer::Answer as Kind, question::Question as Asked};

use super::{
    Caller, Server, distance, fitting, later, overlap, penetration, raycast,
    scene::{Asking, Naming, Scene, Terms},
    time_of_impact,
};
use crate::{
    convert::{number::at_most, question as convert},
    deadline::Deadline,
    fence::fenced,
    problem::{Checked, Problem, Reason, Under},
    token::Role,
};

/// Most questions of a batch.
const QUESTIONS: usize = 65_536;
/// How long a batch works before it gives way to other calls.
const TURN: Duration = Duration::from_micros(100);

/// Answers a batch.
///
/// # Errors
/// What is wrong with the batch itself; the deadline.
pub(super) async fn answer(
    server: &Server,
    request: Request<pb::BatchRequest>,
) -> Result<Response<pb::BatchResponse>, Status> {
    let caller = Caller::of(&request);
    let batch = request.into_inner();
    let session = server.enter(&caller, &batch.session, Role::Reader)?;
    at_most("questions", batch.questions.len(), QUESTIONS)?;
    let options = batch.options.as_ref();
    let shared = Terms::default().overridden_by(options)?;
    let read_at = options.and_then(|options| options.read_at.as_ref());
    let read_at = convert::read_at(read_at).under("options.read_at")?;
    let scene = Scene {
        snapshot: session.pin(read_at, caller.deadline).await.under("options")?,
        session,
        deadline: caller.deadline,
        shared,
        naming: Naming::Nothing,
    };
    let mut answers = Vec::with_capacity(batch.questions.len());
    let mut turn_began = Instant::now();
    for (index, question) in batch.questions.iter().enumerate() {
        if turn_began.elapsed() > TURN {
            // Here a call that was cancelled ends, and others get their turn.
            tokio::task::yield_now().await;
            turn_began = Instant::now();
            if !caller.deadline.is_ahead() {
                return Err(Deadline::problem().into());
            }
        }
        answers.push(answer_one(question, &scene, index));
    }
    let (tick, tick_fraction) = (scene.snapshot.tick().get(), scene.snapshot.fraction());
    let info = pb::AnswerInfo { tick, tick_fraction, work: None };
    let response = pb::BatchResponse { answers, info: Some(info) };
    Ok(Response::new(fitting(response, "ask for fewer hits, or in several batches")?))
}

fn answer_one(question: &pb::Question, scene: &Scene, index: usize) -> pb::Answer {
    let answered = fenced("answering a question", || answer_kind(question, scene)).and_then(|answered| answered);
    let kind = answered.under_item("questions", index).unwrap_or_else(|problem| Kind::Problem(problem.into_wire()));
    pb::Answer { answer: Some(kind) }
}

fn answer_kind(asked: &pb::Question, scene: &Scene) -> Checked<Kind> {
    match &asked.question {
        None => Err(Problem::at(
            "question",
            Reason::Missing,
            "is absent: it is one of raycast, overlap, penetration, time_of_impact, distance",
        )),
        Some(Asked::Raycast(sent)) => item(sent, scene, raycast::answer, Kind::Raycast).under("raycast"),
        Some(Asked::Overlap(sent)) => item(sent, scene, overlap::answer, Kind::Overlap).under("overlap"),
        Some(Asked::Penetration(sent)) => {
            item(sent, scene, penetration::answer, Kind::Penetration).under("penetration")
        }
        Some(Asked::TimeOfImpact(sent)) => {
            item(sent, scene, time_of_impact::answer, Kind::TimeOfImpact).under("time_of_impact")
        }
        Some(Asked::Distance(sent)) => item(sent, scene, distance::answer, Kind::Distance).under("distance"),
        Some(Asked::MoveCharacter(_)) => Err(later::MOVE_CHARACTER.into()),
    }
}

fn item<Q: Asking, A>(
    sent: &Q,
    scene: &Scene,
    answer: fn(&Q, &Scene) -> Checked<A>,
    kind: fn(A) -> Kind,
) -> Checked<Kind> {
    if !sent.session().is_empty() {
        let what = "must be empty in a batch: the batch's own holds for all its questions";
        return Err(Problem::at("session", Reason::OutOfLimits, what));
    }
    if sent.options().is_some_and(|options| options.read_at.is_some()) {
        let what = "must be absent in a batch: the batch's own holds for all its questions";
        return Err(Problem::at("options.read_at", Reason::OutOfLimits, what));
    }
    answer(sent, scene).map(kind)
}
