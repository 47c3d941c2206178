//! A stream of questions: answers in order, each as its unary call would be, and what fails is told without an end.

use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Code, Streaming};
use wire::v1::{
    self as pb, answer::Answer as Kind, query_stream_request::Request as Sent,
    query_stream_response::Response as Answered, question::Question as Asked,
};

use crate::harness::{Bench, at, insert, ray_along_z, readme_world, shape, sphere, subject, with_token};

struct Stream {
    sender: mpsc::Sender<pb::QueryStreamRequest>,
    answers: Streaming<pb::QueryStreamResponse>,
}

impl Stream {
    async fn open(bench: &mut Bench) -> Self {
        let (sender, receiver) = mpsc::channel(4096);
        let answers = bench.questions.query_stream(ReceiverStream::new(receiver)).await.unwrap().into_inner();
        Self { sender, answers }
    }

    async fn send(&self, request_id: u64, request: Sent) {
        self.sender.send(pb::QueryStreamRequest { request_id, request: Some(request) }).await.unwrap();
    }

    async fn next(&mut self) -> (u64, Answered) {
        let answer = self.answers.message().await.unwrap().expect("an answer");
        (answer.request_id, answer.response.expect("a response"))
    }
}

fn question(question: Asked) -> Sent {
    Sent::Question(pb::Question { question: Some(question) })
}

fn ray() -> Sent {
    question(Asked::Raycast(ray_along_z()))
}

fn rays(count: usize) -> Sent {
    Sent::RaycastBatch(Box::new(pb::RaycastBatchRequest {
        directions: [0.0, 0.0, 1.0].repeat(count),
        ..Default::default()
    }))
}

#[tokio::test]
async fn every_kind_is_answered_in_order_as_its_unary_call_is() {
    let mut bench = readme_world().await;
    let ball = subject(sphere(1.5), at(0.0, 0.0, 3.0));
    let overlap = pb::OverlapRequest { subject: Some(ball.clone()), ..Default::default() };
    let penetration = pb::PenetrationRequest { subject: Some(ball.clone()), ..Default::default() };
    let distance = pb::DistanceRequest { subject: Some(ball.clone()), ..Default::default() };
    let way = pb::TimeOfImpactRequest { subject: Some(ball), end: Some(at(0.0, 9.0, 3.0)), ..Default::default() };
    let batch = pb::BatchRequest {
        questions: vec![pb::Question { question: Some(Asked::Raycast(ray_along_z())) }],
        ..Default::default()
    };
    let one_place = Some(pb::PoseColumns { positions: vec![0.0, 0.0, 4.0], ..Default::default() });
    let places = pb::OverlapBatchRequest { poses: one_place.clone(), ..Default::default() };
    let near = pb::DistanceBatchRequest { poses: one_place.clone(), ..Default::default() };
    let ways = pb::TimeOfImpactBatchRequest { ends: one_place, ..Default::default() };
    let columns = pb::RaycastBatchRequest { directions: vec![0.0, 0.0, 1.0], ..Default::default() };
    let mut stream = Stream::open(&mut bench).await;
    let asked = [
        ray(),
        question(Asked::Overlap(Box::new(overlap.clone()))),
        question(Asked::Penetration(Box::new(penetration.clone()))),
        question(Asked::Distance(Box::new(distance.clone()))),
        question(Asked::TimeOfImpact(Box::new(way.clone()))),
        Sent::Batch(Box::new(batch.clone())),
        Sent::RaycastBatch(Box::new(columns.clone())),
        Sent::OverlapBatch(Box::new(places.clone())),
        Sent::DistanceBatch(Box::new(near.clone())),
        Sent::TimeOfImpactBatch(Box::new(ways.clone())),
    ];
    for (index, request) in asked.into_iter().enumerate() {
        stream.send(100 + index as u64, request).await;
    }
    let unary = &mut bench.questions;
    let expected = [
        answer(Kind::Raycast(unary.raycast(ray_along_z()).await.unwrap().into_inner())),
        answer(Kind::Overlap(unary.overlap(overlap).await.unwrap().into_inner())),
        answer(Kind::Penetration(unary.penetration(penetration).await.unwrap().into_inner())),
        answer(Kind::Distance(unary.distance(distance).await.unwrap().into_inner())),
        answer(Kind::TimeOfImpact(unary.time_of_impact(way).await.unwrap().into_inner())),
        Answered::Batch(unary.batch(batch).await.unwrap().into_inner()),
        Answered::RaycastBatch(Box::new(unary.raycast_batch(columns).await.unwrap().into_inner())),
        Answered::OverlapBatch(Box::new(unary.overlap_batch(places).await.unwrap().into_inner())),
        Answered::DistanceBatch(Box::new(unary.distance_batch(near).await.unwrap().into_inner())),
        Answered::TimeOfImpactBatch(Box::new(unary.time_of_impact_batch(ways).await.unwrap().into_inner())),
    ];
    for (index, expected) in expected.into_iter().enumerate() {
        assert_eq!(stream.next().await, (100 + index as u64, expected));
    }
    drop(stream.sender);
    assert!(stream.answers.message().await.unwrap().is_none());
}

fn answer(kind: Kind) -> Answered {
    Answered::Answer(pb::Answer { answer: Some(kind) })
}

#[tokio::test]
async fn what_fails_is_told_in_its_place_and_the_stream_goes_on() {
    let mut bench = readme_world().await;
    let mut stream = Stream::open(&mut bench).await;
    let nowhere = pb::RaycastRequest { session: "nowhere".to_owned(), ..ray_along_z() };
    let flat = pb::RaycastRequest { direction: None, ..ray_along_z() };
    let wrong = pb::RaycastBatchRequest { directions: vec![0.0, 0.0, f32::NAN], ..Default::default() };
    let future = pb::RaycastRequest {
        options: Some(Box::new(crate::harness::read_at(pb::read_at::At::Tick(99)))),
        ..ray_along_z()
    };
    let requests = [
        (question(Asked::Raycast(nowhere)), "SESSION_NOT_FOUND", ""),
        (question(Asked::Raycast(flat)), "MISSING", "question.raycast.direction"),
        (Sent::RaycastBatch(Box::new(wrong)), "NOT_FINITE", "raycast_batch.directions[2]"),
        (question(Asked::Raycast(future)), "TICK_NOT_HELD", ""),
        (Sent::Question(pb::Question::default()), "MISSING", "question.question"),
        (rays(90_000), "", ""),
        (
            Sent::RaycastBatch(Box::new(pb::RaycastBatchRequest {
                directions: [0.0, 0.0, 1.0].repeat(90_000),
                want: Some(pb::ColumnChoice { points: true, normals: true, features: true, intervals: true }),
                ..Default::default()
            })),
            "QUOTA_EXCEEDED",
            "",
        ),
    ];
    for (index, (request, ..)) in requests.iter().enumerate() {
        stream.send(index as u64, request.clone()).await;
        stream.send(1000, ray()).await;
    }
    stream.sender.send(pb::QueryStreamRequest::default()).await.unwrap();
    for (index, (_, reason, field)) in requests.iter().enumerate() {
        let (id, answer) = stream.next().await;
        assert_eq!(id, index as u64);
        match answer {
            Answered::Problem(problem) => {
                assert_eq!(problem.reason, *reason, "{problem:?}");
                assert!(field.is_empty() || problem.field == *field, "{problem:?}");
            }
            _ => assert!(reason.is_empty(), "{index} should have failed"),
        }
        let (id, answer) = stream.next().await;
        assert_eq!(id, 1000);
        assert!(matches!(answer, Answered::Answer(_)), "{answer:?}");
    }
    assert!(matches!(stream.next().await, (0, Answered::Problem(problem)) if problem.field == "request"));
}

#[tokio::test]
async fn each_question_sees_the_newest_tick_of_its_time() {
    let mut bench = readme_world().await;
    let mut stream = Stream::open(&mut bench).await;
    stream.send(1, ray()).await;
    let (_, before) = stream.next().await;
    bench.edit(vec![insert(shape(2, sphere(1.0), at(0.0, 0.0, 3.0)))]).await.unwrap();
    stream.send(2, ray()).await;
    let (_, after) = stream.next().await;
    let hit = |answer: Answered| match answer {
        Answered::Answer(pb::Answer { answer: Some(Kind::Raycast(ray)) }) => (ray.info.unwrap().tick, ray.hits[0].id),
        other => panic!("{other:?}"),
    };
    assert_eq!((hit(before), hit(after)), ((2, 1), (3, 2)));
}

#[tokio::test]
async fn a_stream_has_the_rights_of_its_token_and_ends_with_the_server() {
    let mut bench = readme_world().await;
    let made = bench.create_session("arena").await;
    let inside = question(Asked::Raycast(pb::RaycastRequest { session: "arena".to_owned(), ..ray_along_z() }));
    let mut stream = Stream::open(&mut bench).await;
    stream.send(1, inside.clone()).await;
    assert!(matches!(stream.next().await.1, Answered::Problem(problem) if problem.reason == "NO_TOKEN"));
    let (sender, receiver) = mpsc::channel(4);
    let request = with_token(&made.token, ReceiverStream::new(receiver));
    let answers = bench.questions.query_stream(request).await.unwrap().into_inner();
    let mut inner = Stream { sender, answers };
    inner.send(1, inside).await;
    assert!(matches!(inner.next().await.1, Answered::Answer(_)));
    bench.server.stop().await;
    let status = inner.answers.message().await.unwrap_err();
    assert_eq!(status.code(), Code::Unavailable, "{status}");
}

#[tokio::test]
async fn many_questions_wait_in_the_pipe_for_a_slow_reader_and_none_is_lost() {
    let mut bench = readme_world().await;
    let mut stream = Stream::open(&mut bench).await;
    let sender = stream.sender.clone();
    let sending = tokio::spawn(async move {
        for request_id in 0..20_000 {
            sender.send(pb::QueryStreamRequest { request_id, request: Some(ray()) }).await.unwrap();
        }
    });
    tokio::time::sleep(std::time::Duration::from_millis(100)).await;
    for expected in 0..20_000 {
        assert_eq!(stream.next().await.0, expected);
    }
    sending.await.unwrap();
}

#[tokio::test]
async fn a_pipelined_client_answers_each_of_many_tasks_its_own() {
    let mut bench = readme_world().await;
    let address = bench.server.local_addr().to_string();
    let client = calipers_client::Client::connect(&address).await.unwrap();
    let pipelined = client.clone().pipelined();
    let asked = |place: u32| {
        let origin = [f64::from(place) * 0.01 - 5.0, 0.0, 0.0];
        calipers_client::ask::ray(origin, [0.0, 0.0, 1.0])
    };
    let tasks: Vec<_> = (0..1000)
        .map(|place| {
            let client = pipelined.clone();
            tokio::spawn(async move { client.raycast(asked(place)).await })
        })
        .collect();
    let mut hits = 0;
    for (place, task) in (0..).zip(tasks) {
        let answer = task.await.unwrap().unwrap();
        assert_eq!(answer, client.raycast(asked(place)).await.unwrap());
        hits += answer.hits.len();
    }
    assert!((150..250).contains(&hits), "{hits}");
    // What is wrong is told as a call would tell it.
    let wrong = || pb::RaycastRequest { direction: None, ..ray_along_z() };
    let (piped, called) = (pipelined.raycast(wrong()).await.unwrap_err(), client.raycast(wrong()).await.unwrap_err());
    assert_eq!((piped.code(), piped.reason()), (called.code(), called.reason()));
    assert!(piped.to_string().ends_with("direction is absent: a direction is required, such as {\"z\": 1}"), "{piped}");
    // Another session's questions go on the stream of its own token.
    let made = bench.create_session("arena").await;
    let arena = pipelined.clone().with_session("arena");
    assert_eq!(arena.raycast(ray_along_z()).await.unwrap_err().code(), Some(Code::Unauthenticated));
    let arena = arena.with_token(&made.token).unwrap();
    assert!(arena.raycast(ray_along_z()).await.unwrap().hits.is_empty());
    // A stream that ends fails what is asked of it, and says so.
    bench.server.stop().await;
    assert!(pipelined.raycast(ray_along_z()).await.unwrap_err().is_passing());
}
