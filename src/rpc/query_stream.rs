//! `QueryStream`: questions and batches one after the other, answered in order; what fails is answered with a problem.
//!
//! # Method
//! Each message is answered as its unary call would be, on the version that is the newest when its turn comes. Answers wait
//! for their reader in a short queue: a slow one stops the reading of questions, and so, by the flow control of the
//! connection, the client. To wake the reader for each answer would cost as much as a ray does. So answers are handed over when no
//! further message is there, when the next one is none of the quick kinds, after some, or after some time, whatever comes first. Rays of
//! one session that are there together are asked together.

use std::sync::Arc;

use futures_util::FutureExt;
use tonic::{Request, Status, Streaming};
use wire::v1::{
    self as pb, query_stream_request::Request as Asked, query_stream_response::Response as Answered, question::Question,
};

use super::{
    Answers, Caller, Server,
    answering::ANSWERING,
    answers::{Handed, Unread, hand, stream_of_lists},
    batch, distance_batch, fits, line_of_sight, overlap_batch, question, raycast, raycast_batch,
    scene::{Asking, Patience, Scene},
    time_of_impact_batch,
    turns::Turns,
};
use crate::{
    fence::fenced_async,
    gate::the_api_says,
    problem::{Checked, Problem, Reason, Under},
};

/// Answers that are handed over at a time, at most.
const TOGETHER: usize = 32;
/// Rays of a batch that are answered in less than a short turn.
const QUICK_RAYS: usize = 128;
/// Lists of answers that wait for a reader.
const UNREAD_LISTS: usize = 16;

/// Answers a stream until its client ends it.
pub(super) fn open(
    server: Arc<Server>,
    request: Request<Streaming<pb::QueryStreamRequest>>,
) -> Answers<pb::QueryStreamResponse> {
    let caller = Caller::of(&request);
    stream_of_lists(UNREAD_LISTS, |answers| async move { run(&server, &caller, request.into_inner(), &answers).await })
}

async fn run(
    server: &Server,
    caller: &Caller,
    mut messages: Streaming<pb::QueryStreamRequest>,
    answers: &Unread<Vec<pb::QueryStreamResponse>>,
) -> Result<(), Status> {
    let mut turns = Turns::begun(caller.deadline);
    let (mut ready, mut held) = (Vec::new(), None);
    loop {
        // What is there already is taken at once: asking what else may end the call costs a lock each, so a stream that never
        // pauses is asked once a turn.
        let came = match held.take().or_else(|| messages.message().now_or_never()) {
            Some(came) => came,
            None => {
                if hand_over(answers, &mut ready).await? == Handed::Gone {
                    return Ok(());
                }
                turns.pause();
                let came = tokio::select! {
                    biased;
                    came = messages.message() => came,
                    () = answers.closed() => return Ok(()),
                    () = server.drain.cancelled() => Ok(None),
                };
                turns.resume();
                came
            }
        };
        let is_over = turns.is_over();
        let is_quick = matches!(&came, Ok(Some(message)) if is_quick(message));
        if (!is_quick || is_over || ready.len() >= TOGETHER) && hand_over(answers, &mut ready).await? == Handed::Gone {
            return Ok(());
        }
        let message = came.map_err(the_api_says)?;
        if (!is_quick || is_over) && server.drain.is_cancelled() {
            let what = "the server is stopping: ask again elsewhere, or later, what was not answered";
            return Err(Problem::new(Reason::Stopping, what).into());
        }
        let Some(message) = message else { return Ok(()) };
        turns.next().await?;
        if plain_ray(&message).is_some() {
            let rays = gather(message, &mut messages, &mut held);
            ready.extend(answer_rays(server, caller, &rays).await);
            continue;
        }
        // Batches have turns of their own; those of quick ones are not worth a pause of these.
        let has_turns = !is_quick && !matches!(message.request, Some(Asked::Question(_)));
        if has_turns {
            turns.pause();
        }
        ready.push(answer(server, caller, &message).await);
        if has_turns {
            turns.resume();
        }
    }
}

/// Whether a message is answered within a short turn, most often, so that answers before it can wait for it.
fn is_quick(message: &pb::QueryStreamRequest) -> bool {
    match &message.request {
        Some(Asked::Question(asked)) => {
            matches!(asked.question, Some(Question::Raycast(_) | Question::Overlap(_) | Question::Distance(_)))
        }
        Some(Asked::RaycastBatch(rays)) => rays.directions.len() <= 3 * QUICK_RAYS,
        _ => false,
    }
}

fn plain_ray(message: &pb::QueryStreamRequest) -> Option<&pb::RaycastRequest> {
    match &message.request {
        Some(Asked::Question(asked)) => raycast::plain(asked),
        _ => None,
    }
}

/// What came from a stream.
type Came = Result<Option<pb::QueryStreamRequest>, Status>;

/// A plain ray and those of the same session that came right after it; what else came then is held.
fn gather(
    first: pb::QueryStreamRequest,
    messages: &mut Streaming<pb::QueryStreamRequest>,
    held: &mut Option<Came>,
) -> Vec<pb::QueryStreamRequest> {
    fn session(message: &pb::QueryStreamRequest) -> Option<&str> {
        plain_ray(message).map(|ray| ray.session.as_str())
    }
    let mut rays = vec![first];
    while rays.len() < TOGETHER {
        match messages.message().now_or_never() {
            Some(Ok(Some(next))) if session(&next) == session(&rays[0]) => rays.push(next),
            came => {
                *held = came;
                break;
            }
        }
    }
    rays
}

/// Answers plain rays of one session, together if they can be.
async fn answer_rays(
    server: &Server,
    caller: &Caller,
    messages: &[pb::QueryStreamRequest],
) -> Vec<pb::QueryStreamResponse> {
    if let Some(told) = answer_together(server, caller, messages).await {
        let told = told.into_iter().map(|told| pb::Answer { answer: Some(told.into()) });
        return messages.iter().zip(told).map(|(message, told)| response(message, told.into())).collect();
    }
    let mut responses = Vec::with_capacity(messages.len());
    for message in messages {
        responses.push(answer(server, caller, message).await);
    }
    responses
}

async fn answer_together(
    server: &Server,
    caller: &Caller,
    messages: &[pb::QueryStreamRequest],
) -> Option<Vec<pb::RaycastResponse>> {
    let rays: Vec<&pb::RaycastRequest> = messages.iter().filter_map(plain_ray).collect();
    let [first, _, ..] = rays.as_slice() else { return None };
    let scene = Scene::enter(server, caller, &first.session, None).await.ok()?;
    raycast::answer_together(&rays, &Scene { patience: Patience::Short, ..scene })
}

/// Hands over what is ready.
///
/// # Errors
/// The reader makes no room.
async fn hand_over(
    answers: &Unread<Vec<pb::QueryStreamResponse>>,
    ready: &mut Vec<pb::QueryStreamResponse>,
) -> Result<Handed, Status> {
    if ready.is_empty() {
        return Ok(Handed::Over);
    }
    match hand(answers, std::mem::take(ready)).await {
        Handed::TooSlow => {
            let what = "the client took no answer for 10 s: read them, and ask again";
            Err(Problem::new(Reason::Overloaded, what).into())
        }
        handed => Ok(handed),
    }
}

/// The answer of one message, or why there is none. What is large is handed on by reference: a copy of every message at every step
/// would cost more than the answers of columns do.
async fn answer(server: &Server, caller: &Caller, message: &pb::QueryStreamRequest) -> pb::QueryStreamResponse {
    let answered = fenced_async(ANSWERING, answer_kind(server, caller, message)).await;
    let answered = answered.unwrap_or_else(Err).unwrap_or_else(|problem| problem.into_wire().into());
    response(message, answered)
}

/// The message that answers another, or says that it would not fit.
fn response(message: &pb::QueryStreamRequest, answered: Answered) -> pb::QueryStreamResponse {
    let request_id = message.request_id;
    let response = pb::QueryStreamResponse { request_id, response: Some(answered) };
    match fits(&response, "ask for fewer hits, columns or items") {
        Ok(()) => response,
        Err(problem) => pb::QueryStreamResponse { request_id, response: Some(problem.into_wire().into()) },
    }
}

async fn answer_kind(server: &Server, caller: &Caller, message: &pb::QueryStreamRequest) -> Checked<Answered> {
    match &message.request {
        None => {
            let what = "is absent: it is one of question, batch, raycast_batch, overlap_batch, time_of_impact_batch, \
                        distance_batch, line_of_sight, such as {\"question\": {\"raycast\": {\"direction\": {\"z\": 1}}}}";
            Err(Problem::at("request", Reason::Missing, what))
        }
        Some(Asked::Question(sent)) => answer_question(server, caller, sent).await.under("question"),
        Some(Asked::Batch(sent)) => many(server, caller, "batch", &**sent, batch::answer).await,
        Some(Asked::RaycastBatch(sent)) => many(server, caller, "raycast_batch", &**sent, raycast_batch::answer).await,
        Some(Asked::OverlapBatch(sent)) => many(server, caller, "overlap_batch", &**sent, overlap_batch::answer).await,
        Some(Asked::TimeOfImpactBatch(sent)) => {
            many(server, caller, "time_of_impact_batch", &**sent, time_of_impact_batch::answer).await
        }
        Some(Asked::DistanceBatch(sent)) => {
            many(server, caller, "distance_batch", &**sent, distance_batch::answer).await
        }
        Some(Asked::LineOfSight(sent)) => many(server, caller, "line_of_sight", &**sent, line_of_sight::answer).await,
    }
}

/// Many questions in one message. Boxed, as otherwise a single question would carry the room that they need.
async fn many<Q: Asking, A: Into<Answered>>(
    server: &Server,
    caller: &Caller,
    name: &'static str,
    sent: &Q,
    answer: impl AsyncFnOnce(&Q, &Scene) -> Checked<A>,
) -> Checked<Answered> {
    let answered = Box::pin(async {
        let scene = Scene::of(server, caller, sent).await?;
        answer(sent, &scene).await.map(Into::into)
    });
    answered.await.under(name)
}

/// One question, which names its session and version itself.
async fn answer_question(server: &Server, caller: &Caller, sent: &pb::Question) -> Checked<Answered> {
    let heading = question::heading(sent)?;
    let scene = Scene::enter(server, caller, heading.session, heading.options).await.under(heading.name)?;
    let scene = Scene { patience: Patience::Short, ..scene };
    let answer = Some(question::answer_anywhere(&heading, sent, &scene).await?);
    Ok(Answered::Answer(pb::Answer { answer }))
}
