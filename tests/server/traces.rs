//! Who watches a world sees what it is asked: every question once, told or counted, and only the owner.

use tonic::{Code, Streaming};
use wire::v1::{
    self as pb, answer::Answer as Kind, query_stream_request::Request as Streamed, question::Question as Asked,
};

use crate::{
    explain::{ask, questions},
    harness::{Bench, assert_refused, at, insert, shape, sphere, subject, vec3, with_token},
    replays::zoo,
};

async fn watch(bench: &mut Bench) -> Streaming<pb::WatchWorldResponse> {
    let request = pb::WatchWorldRequest { questions: true, max_rate: 120, ..pb::WatchWorldRequest::default() };
    let mut messages = bench.worlds.watch_world(request).await.unwrap().into_inner();
    assert!(messages.message().await.unwrap().unwrap().snapshot);
    messages
}

/// What is told until so many questions are told or counted.
async fn told(messages: &mut Streaming<pb::WatchWorldResponse>, count: u64) -> (Vec<pb::Trace>, u64) {
    let (mut traces, mut skipped_count) = (Vec::new(), 0);
    while traces.len() as u64 + skipped_count < count {
        let message = messages.message().await.unwrap().unwrap();
        assert!(message.traces.len() <= 256);
        skipped_count += message.traces_skipped;
        traces.extend(message.traces);
    }
    assert_eq!(traces.len() as u64 + skipped_count, count, "each once");
    (traces, skipped_count)
}

fn kind(trace: &pb::Trace) -> (Asked, Kind) {
    let asked = trace.question.clone().and_then(|question| question.question).expect("a question");
    (asked, trace.answer.clone().and_then(|answer| answer.answer).expect("an answer"))
}

/// Without what an answer says of itself.
fn bare(answer: Kind) -> pb::Answer {
    calipers::replay::bare(pb::Answer { answer: Some(answer) })
}

#[tokio::test]
async fn questions_are_told_with_their_answers_however_they_are_asked() {
    let mut bench = zoo().await;
    let mut messages = watch(&mut bench).await;
    for asked in questions() {
        let answer = ask(&mut bench, asked.clone()).await;
        let (traces, skipped) = told(&mut messages, 1).await;
        assert_eq!((kind(&traces[0]), skipped), ((asked.clone(), answer.clone()), 0));
        // On a stream.
        let question = pb::Question { question: Some(asked.clone()) };
        let streamed = pb::QueryStreamRequest { request_id: 1, request: Some(Streamed::Question(question)) };
        let mut answers = bench.questions.query_stream(tokio_stream::once(streamed)).await.unwrap().into_inner();
        answers.message().await.unwrap().unwrap();
        let (traces, _) = told(&mut messages, 1).await;
        assert_eq!(kind(&traces[0]).0, asked);
        assert_eq!(bare(kind(&traces[0]).1), bare(answer));
    }
    // By a call of its own, and refused.
    let ray = crate::harness::ray_along_z();
    let answer = bench.questions.raycast(ray.clone()).await.unwrap().into_inner();
    bench.questions.raycast(pb::RaycastRequest::default()).await.unwrap_err();
    let bounced = bench.questions.resolve(pb::ResolveRequest::default()).await.unwrap().into_inner();
    let listed =
        bench.questions.pairs(pb::PairsRequest::default()).await.unwrap().into_inner().message().await.unwrap();
    let (traces, skipped) = told(&mut messages, 4).await;
    assert_eq!(skipped, 0);
    assert_eq!(kind(&traces[2]), (Asked::Resolve(Box::default()), Kind::from(bounced)));
    assert_eq!(kind(&traces[3]), (Asked::Pairs(Box::default()), Kind::from(listed.unwrap())));
    assert_eq!(kind(&traces[0]), (Asked::Raycast(ray), Kind::Raycast(answer)));
    let (_, Kind::Problem(problem)) = kind(&traces[1]) else { panic!("{traces:?}") };
    assert_eq!((problem.reason.as_str(), problem.field.as_str()), ("MISSING", "direction"));
}

/// Asked on its own, the first item has the answer that was told.
#[tokio::test]
async fn of_a_batch_with_columns_the_first_item_is_told() {
    let mut bench = zoo().await;
    let mut messages = watch(&mut bench).await;
    let poses = |positions: &[f32]| {
        let frame_origin = Some(vec3(1.0, 0.0, 0.0));
        Some(pb::PoseColumns { frame_origin, positions: positions.to_vec(), ..pb::PoseColumns::default() })
    };
    let rays = pb::RaycastBatchRequest {
        frame_origin: Some(vec3(-3.0, 0.0, 0.0)),
        directions: vec![1.0, 0.05, 0.0, 0.0, -1.0, 0.0],
        max_distances: vec![30.0],
        ..pb::RaycastBatchRequest::default()
    };
    bench.questions.raycast_batch(rays).await.unwrap();
    let places = pb::OverlapBatchRequest {
        geometry: Some(sphere(0.6)),
        poses: poses(&[4.0, 0.0, 0.0, 80.0, 0.0, 0.0]),
        scales: vec![2.0, 1.0],
        ..pb::OverlapBatchRequest::default()
    };
    bench.questions.overlap_batch(places).await.unwrap();
    let near = pb::DistanceBatchRequest { poses: poses(&[0.0, 0.3, 0.0, 1.0, 1.0, 1.0]), ..Default::default() };
    bench.questions.distance_batch(near).await.unwrap();
    let ways = pb::TimeOfImpactBatchRequest {
        geometry: Some(sphere(0.2)),
        starts: poses(&[-4.0, 0.2, 0.0]),
        ends: poses(&[9.0, 0.2, 0.0, 0.0, 9.0, 0.0]),
        ..pb::TimeOfImpactBatchRequest::default()
    };
    bench.questions.time_of_impact_batch(ways).await.unwrap();
    let (traces, _) = told(&mut messages, 4).await;
    for trace in &traces {
        let (asked, answer) = kind(trace);
        assert_eq!(bare(ask(&mut bench, asked.clone()).await), bare(answer.clone()), "{asked:?}");
        let is_hit = format!("{answer:?}").contains("id: ");
        assert!(is_hit, "vacuous: {asked:?} {answer:?}");
    }
}

#[tokio::test]
async fn who_cannot_keep_up_learns_how_many_were_left_out() {
    let mut bench = Bench::start().await;
    let balls = (1..=600).map(|id| insert(shape(id, sphere(1.0), at(0.0, 0.0, 0.0))));
    bench.edit(balls.collect()).await.unwrap();
    let request = pb::WatchWorldRequest { questions: true, max_rate: 1, ..pb::WatchWorldRequest::default() };
    let mut messages = bench.worlds.watch_world(request).await.unwrap().into_inner();
    assert!(messages.message().await.unwrap().unwrap().snapshot);
    let far = || pb::Question {
        question: Some(Asked::Raycast(pb::RaycastRequest {
            origin: Some(vec3(9.0, 9.0, 9.0)),
            direction: Some(vec3(0.0, 1.0, 0.0)),
            ..pb::RaycastRequest::default()
        })),
    };
    let request = pb::BatchRequest { questions: (0..1000).map(|_| far()).collect(), ..pb::BatchRequest::default() };
    bench.questions.batch(request).await.unwrap();
    let (traces, skipped) = told(&mut messages, 1000).await;
    assert!(traces.len() >= 200 && skipped >= 700, "{} and {skipped}", traces.len());
    // Six hundred hits are more than is told of one question.
    let large =
        pb::OverlapRequest { subject: Some(subject(sphere(1.0), at(0.0, 0.0, 0.0))), ..pb::OverlapRequest::default() };
    bench.questions.overlap(large).await.unwrap();
    assert_eq!(told(&mut messages, 1).await.1, 1);
}

#[tokio::test]
async fn only_the_owner_may_watch_what_is_asked() {
    let mut bench = Bench::start().await;
    let owner = bench.create_session("arena").await.token;
    let request = pb::CreateTokenRequest { session: "arena".to_owned(), role: pb::Role::Writer.into() };
    let writer = bench.sessions.create_token(with_token(&owner, request)).await.unwrap().into_inner().token;
    let watching = |questions| pb::WatchWorldRequest { session: "arena".to_owned(), questions, ..Default::default() };
    let status = bench.worlds.watch_world(with_token(&writer, watching(true))).await.map(|_| ()).unwrap_err();
    assert_refused(&status, Code::PermissionDenied, "ROLE_TOO_LOW", "", &["owner"]);
    bench.worlds.watch_world(with_token(&writer, watching(false))).await.unwrap();
    bench.worlds.watch_world(with_token(&owner, watching(true))).await.unwrap();
}
