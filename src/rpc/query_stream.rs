//! `QueryStream`: questions and batches one after the other, answered in order; what fails is answered with a problem.
//!
//! # Method
//! Each message is answered as its unary call would be, on the version that is the newest when its turn comes. Answers wait
//! for their reader in a short queue: a slow one stops the reading of questions, and so, by the flow control of the
//! connection, the client.

use std::sync::Arc;

use tonic::{Request, Status, Streaming};
use wire::v1::{self as pb, query_stream_request::Request as Asked, query_stream_response::Response as Answered};

use super::{
    Answers, Caller, Server,
    answers::{Handed, Unread, hand, stream},
    batch, distance_batch, fitting, line_of_sight, overlap_batch, question, raycast_batch,
    scene::{Asking, Scene},
    time_of_impact_batch,
    turns::Turns,
};
use crate::{
    fence::fenced_async,
    gate::the_api_says,
    problem::{Checked, Problem, Reason, Under},
};

/// Answers that wait for a reader.
const UNREAD_ANSWERS: usize = 256;

/// Answers a stream until its client ends it.
pub(super) fn open(
    server: Arc<Server>,
    request: Request<Streaming<pb::QueryStreamRequest>>,
) -> Answers<pb::QueryStreamResponse> {
    let caller = Caller::of(&request);
    stream(UNREAD_ANSWERS, |answers| async move { run(&server, &caller, request.into_inner(), &answers).await })
}

async fn run(
    server: &Server,
    caller: &Caller,
    mut messages: Streaming<pb::QueryStreamRequest>,
    answers: &Unread<pb::QueryStreamResponse>,
) -> Result<(), Status> {
    let mut turns = Turns::of_stream(caller.deadline);
    loop {
        // Messages first, as asking what else may end the call costs a lock each; a stream that never pauses is asked below.
        let message = tokio::select! {
            biased;
            message = messages.message() => message.map_err(the_api_says)?,
            () = answers.closed() => return Ok(()),
            () = server.drain.cancelled() => None,
        };
        if server.drain.is_cancelled() {
            let what = "the server is stopping: ask again elsewhere, or later, what was not answered";
            return Err(Problem::new(Reason::Stopping, what).into());
        }
        let Some(message) = message else { return Ok(()) };
        turns.next().await?;
        let answer = answer(server, caller, message).await;
        match hand(answers, answer).await {
            Handed::Over => {}
            Handed::Gone => return Ok(()),
            Handed::TooSlow => {
                let what = "the client took no answer for 10 s: read them, and ask again";
                return Err(Problem::new(Reason::Overloaded, what).into());
            }
        }
    }
}

/// The answer of one message, or why there is none.
async fn answer(server: &Server, caller: &Caller, message: pb::QueryStreamRequest) -> pb::QueryStreamResponse {
    let request_id = message.request_id;
    let answered = match fenced_async("answering a question", answer_kind(server, caller, message)).await {
        Ok(answered) => answered,
        Err(problem) => Err(problem),
    };
    let fitted = answered.and_then(|answered| {
        let response = pb::QueryStreamResponse { request_id, response: Some(answered) };
        fitting(response, "ask for fewer hits, columns or items")
    });
    fitted.unwrap_or_else(|problem| pb::QueryStreamResponse {
        request_id,
        response: Some(Answered::Problem(problem.into_wire())),
    })
}

async fn answer_kind(server: &Server, caller: &Caller, message: pb::QueryStreamRequest) -> Checked<Answered> {
    match message.request {
        None => {
            let what = "is absent: it is one of question, batch, raycast_batch, overlap_batch, time_of_impact_batch, \
                        distance_batch, line_of_sight, such as {\"question\": {\"raycast\": {\"direction\": {\"z\": 1}}}}";
            Err(Problem::at("request", Reason::Missing, what))
        }
        Some(Asked::Question(sent)) => answer_question(server, caller, &sent).await.under("question"),
        Some(Asked::Batch(sent)) => many(server, caller, "batch", &sent, batch::answer, Answered::Batch).await,
        Some(Asked::RaycastBatch(sent)) => {
            many(server, caller, "raycast_batch", &sent, raycast_batch::answer, Answered::RaycastBatch).await
        }
        Some(Asked::OverlapBatch(sent)) => {
            many(server, caller, "overlap_batch", &sent, overlap_batch::answer, Answered::OverlapBatch).await
        }
        Some(Asked::TimeOfImpactBatch(sent)) => {
            let answer = time_of_impact_batch::answer;
            many(server, caller, "time_of_impact_batch", &sent, answer, Answered::TimeOfImpactBatch).await
        }
        Some(Asked::DistanceBatch(sent)) => {
            many(server, caller, "distance_batch", &sent, distance_batch::answer, Answered::DistanceBatch).await
        }
        Some(Asked::LineOfSight(sent)) => {
            many(server, caller, "line_of_sight", &sent, line_of_sight::answer, Answered::LineOfSight).await
        }
    }
}

/// Many questions in one message. Boxed, as otherwise a single question would carry the room that they need.
async fn many<Q: Asking, A>(
    server: &Server,
    caller: &Caller,
    name: &'static str,
    sent: &Q,
    answer: impl AsyncFnOnce(&Q, &Scene) -> Checked<A>,
    kind: fn(A) -> Answered,
) -> Checked<Answered> {
    let answered = Box::pin(async {
        let scene = Scene::of(server, caller, sent).await?;
        answer(sent, &scene).await.map(kind)
    });
    answered.await.under(name)
}

/// One question, which names its session and version itself.
async fn answer_question(server: &Server, caller: &Caller, sent: &pb::Question) -> Checked<Answered> {
    let heading = question::heading(sent)?;
    let scene = Scene::enter(server, caller, heading.session, heading.options).await.under(heading.name)?;
    let answer = Some(question::answer(sent, &scene)?);
    Ok(Answered::Answer(pb::Answer { answer }))
}
