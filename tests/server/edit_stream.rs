//! The edit stream: ticks, acknowledgements, what is left out, order, resuming, and two writers at once.

use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Code, Status, Streaming};
use wire::v1::{self as pb, world_service_client::WorldServiceClient};

use crate::harness::{Bench, assert_refused, at, insert, move_to, shape, sphere};

/// One stream of a writer.
struct Stream {
    messages: mpsc::Sender<pb::EditStreamRequest>,
    answers: Streaming<pb::EditStreamResponse>,
}

impl Stream {
    async fn open(
        worlds: &WorldServiceClient<tonic::transport::Channel>,
        writer: &str,
    ) -> (Self, pb::EditStreamResponse) {
        let (messages, outgoing) = mpsc::channel(1024);
        let hello = pb::EditStreamRequest { writer: writer.to_owned(), ..pb::EditStreamRequest::default() };
        messages.send(hello).await.unwrap();
        let answers = worlds.clone().edit_stream(ReceiverStream::new(outgoing)).await.unwrap().into_inner();
        let mut stream = Self { messages, answers };
        let first = stream.answer().await.unwrap();
        (stream, first)
    }

    async fn send(&self, sequence: u64, edits: Vec<pb::Edit>, commit: bool) {
        let message = pb::EditStreamRequest { sequence, edits, commit, ..pb::EditStreamRequest::default() };
        self.messages.send(message).await.unwrap();
    }

    async fn answer(&mut self) -> Result<pb::EditStreamResponse, Status> {
        self.answers.message().await.map(|answer| answer.expect("the stream goes on"))
    }
}

fn ball(id: u64, z: f64) -> pb::Edit {
    insert(shape(id, sphere(1.0), at(0.0, 0.0, z)))
}

async fn z_of(bench: &mut Bench, id: u64) -> Option<f64> {
    let request = pb::GetShapeRequest { id, ..pb::GetShapeRequest::default() };
    let answer = bench.worlds.get_shape(request).await.ok()?.into_inner();
    Some(answer.shape?.pose?.position?.z)
}

#[tokio::test]
async fn a_tick_is_seen_at_its_commit_and_not_before() {
    let mut bench = Bench::start().await;
    let (mut stream, first) = Stream::open(&bench.worlds, "").await;
    assert_eq!((first.acked_sequence, first.tick), (0, 0));
    assert!(first.window > 0);
    stream.send(1, vec![ball(1, 5.0)], false).await;
    stream.send(2, vec![ball(2, 6.0)], false).await;
    tokio::time::sleep(std::time::Duration::from_millis(50)).await;
    assert_eq!(bench.describe().await.tick, 1);
    stream.send(3, vec![move_to(1, at(0.0, 0.0, 7.0))], true).await;
    let acked = stream.answer().await.unwrap();
    assert_eq!((acked.acked_sequence, acked.tick), (3, 2));
    assert_eq!(acked.durability(), pb::Durability::Applied);
    assert!(acked.problems.is_empty());
    assert_eq!((z_of(&mut bench, 1).await, z_of(&mut bench, 2).await), (Some(7.0), Some(6.0)));
}

#[tokio::test]
async fn wrong_edits_are_told_with_message_and_place_and_the_rest_is_applied() {
    let mut bench = Bench::start().await;
    let (mut stream, _) = Stream::open(&bench.worlds, "").await;
    stream.send(1, vec![ball(1, 5.0), ball(0, 5.0), ball(2, f64::INFINITY)], false).await;
    stream.send(2, vec![move_to(9, at(0.0, 0.0, 0.0)), ball(3, 5.0)], true).await;
    let acked = stream.answer().await.unwrap();
    assert_eq!((acked.acked_sequence, acked.tick), (2, 2));
    let told: Vec<_> = acked
        .problems
        .iter()
        .map(|problem| (problem.sequence, problem.field.as_str(), problem.reason.as_str(), problem.code))
        .collect();
    let (invalid, not_found) = (Code::InvalidArgument as i32, Code::NotFound as i32);
    assert_eq!(
        told,
        [
            (1, "edits[1].insert.id", "OUT_OF_LIMITS", invalid),
            (1, "edits[2].insert.pose.position.z", "NOT_FINITE", invalid),
            (2, "edits[0].move.id", "SHAPE_NOT_FOUND", not_found),
        ]
    );
    assert_eq!(acked.problems[2].shape_id, 9);
    assert_eq!(bench.describe().await.shape_count, 2);
}

#[tokio::test]
async fn a_gap_ends_the_stream_and_a_known_message_is_dropped() {
    let mut bench = Bench::start().await;
    let (mut stream, _) = Stream::open(&bench.worlds, "writer").await;
    stream.send(1, vec![ball(1, 5.0)], true).await;
    assert_eq!(stream.answer().await.unwrap().tick, 2);
    stream.send(1, vec![ball(1, 99.0)], true).await;
    let again = stream.answer().await.unwrap();
    assert_eq!((again.acked_sequence, again.tick), (1, 2), "a known commit is acknowledged and not applied");
    assert_eq!(z_of(&mut bench, 1).await, Some(5.0));
    stream.send(3, Vec::new(), true).await;
    let status = stream.answer().await.unwrap_err();
    assert_refused(&status, Code::Aborted, "SEQUENCE_GAP", "", &["is 3, and 2 was expected"]);
}

#[tokio::test]
async fn after_a_break_a_writer_goes_on_after_what_is_acknowledged() {
    let mut bench = Bench::start().await;
    let (mut stream, _) = Stream::open(&bench.worlds, "arm").await;
    stream.send(1, vec![ball(1, 5.0)], true).await;
    stream.answer().await.unwrap();
    stream.send(2, vec![ball(2, 5.0)], false).await;
    // The connection breaks: what was not committed is gone.
    drop(stream);
    let (mut stream, first) = Stream::open(&bench.worlds, "arm").await;
    assert_eq!((first.acked_sequence, first.tick), (1, 2));
    // Everything is sent again; the first message is known.
    stream.send(1, vec![ball(1, 77.0)], true).await;
    assert_eq!(stream.answer().await.unwrap().acked_sequence, 1);
    stream.send(2, vec![ball(2, 6.0)], false).await;
    stream.send(3, vec![ball(3, 7.0)], true).await;
    let acked = stream.answer().await.unwrap();
    assert_eq!((acked.acked_sequence, acked.tick), (3, 3));
    let found = [z_of(&mut bench, 1).await, z_of(&mut bench, 2).await, z_of(&mut bench, 3).await];
    assert_eq!(found, [Some(5.0), Some(6.0), Some(7.0)]);
    let (_other, first) = Stream::open(&bench.worlds, "leg").await;
    assert_eq!(first.acked_sequence, 0, "each writer has its own sequence");
    let (_nameless, first) = Stream::open(&bench.worlds, "").await;
    assert_eq!(first.acked_sequence, 0, "without a name nothing is resumed");
}

#[tokio::test]
async fn a_new_stream_of_a_writer_ends_the_old_one() {
    let bench = Bench::start().await;
    let (mut old, _) = Stream::open(&bench.worlds, "arm").await;
    old.send(1, vec![ball(1, 5.0)], true).await;
    old.answer().await.unwrap();
    let (mut new, first) = Stream::open(&bench.worlds, "arm").await;
    assert_eq!(first.acked_sequence, 1);
    let status = old.answer().await.unwrap_err();
    assert_refused(&status, Code::Aborted, "WRITER_REPLACED", "", &["\"arm\""]);
    new.send(2, Vec::new(), true).await;
    assert_eq!(new.answer().await.unwrap().acked_sequence, 2);
}

#[tokio::test]
async fn two_writers_interleave_and_every_tick_is_one_of_theirs() {
    let mut bench = Bench::start().await;
    let mut tasks = Vec::new();
    for writer in 1..=2_u64 {
        let worlds = bench.worlds.clone();
        tasks.push(tokio::spawn(async move {
            let (mut stream, _) = Stream::open(&worlds, &format!("writer-{writer}")).await;
            let mut ticks = Vec::new();
            for sequence in 1..=50 {
                stream.send(sequence, vec![ball(writer, sequence as f64)], true).await;
                let acked = stream.answer().await.unwrap();
                assert_eq!(acked.acked_sequence, sequence);
                ticks.push(acked.tick);
            }
            ticks
        }));
    }
    let mut ticks = Vec::new();
    for task in tasks {
        let of_one = task.await.unwrap();
        assert!(of_one.is_sorted());
        ticks.extend(of_one);
    }
    ticks.sort_unstable();
    assert_eq!(ticks, (2..=101).collect::<Vec<_>>());
    assert_eq!((z_of(&mut bench, 1).await, z_of(&mut bench, 2).await), (Some(50.0), Some(50.0)));
}

#[tokio::test]
async fn a_time_that_goes_back_is_told_and_the_tick_still_made() {
    let bench = Bench::start().await;
    let (mut stream, _) = Stream::open(&bench.worlds, "").await;
    for (sequence, seconds) in [(1, 9_000_000_000), (2, 1)] {
        let message = pb::EditStreamRequest {
            sequence,
            commit: true,
            time: Some(prost_types::Timestamp { seconds, nanos: 0 }),
            ..pb::EditStreamRequest::default()
        };
        stream.messages.send(message).await.unwrap();
    }
    assert!(stream.answer().await.unwrap().problems.is_empty());
    let acked = stream.answer().await.unwrap();
    assert_eq!((acked.acked_sequence, acked.tick), (2, 3));
    let problem = &acked.problems[0];
    assert_eq!((problem.field.as_str(), problem.sequence), ("time", 2));
}

#[tokio::test]
async fn more_than_the_window_unacknowledged_ends_the_stream() {
    let bench = Bench::start().await;
    let (mut stream, first) = Stream::open(&bench.worlds, "").await;
    for sequence in 1..=u64::from(first.window) + 1 {
        stream.send(sequence, Vec::new(), false).await;
    }
    let status = stream.answer().await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["unacknowledged"]);
}

#[tokio::test]
async fn what_cannot_begin_a_stream_is_refused() {
    let mut bench = Bench::start().await;
    let mut refuse = async |message: pb::EditStreamRequest, answers_before: usize| {
        let stream = bench.worlds.edit_stream(tokio_stream::once(message)).await;
        let mut answers = stream.unwrap().into_inner();
        for _ in 0..answers_before {
            answers.message().await.unwrap();
        }
        answers.message().await.unwrap_err()
    };
    let nowhere = pb::EditStreamRequest { session: "nowhere".to_owned(), ..pb::EditStreamRequest::default() };
    let status = refuse(nowhere, 0).await;
    assert_refused(&status, Code::NotFound, "SESSION_NOT_FOUND", "session", &[]);
    let durable =
        pb::EditStreamRequest { durability: pb::Durability::Local.into(), ..pb::EditStreamRequest::default() };
    let status = refuse(durable, 0).await;
    assert_refused(&status, Code::FailedPrecondition, "DURABILITY_NOT_OFFERED", "durability", &[]);
    let unnumbered = pb::EditStreamRequest { edits: vec![ball(1, 5.0)], ..pb::EditStreamRequest::default() };
    let status = refuse(unnumbered, 1).await;
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "sequence", &["1, 2, 3"]);
    let long_name = pb::EditStreamRequest { writer: "x".repeat(129), ..pb::EditStreamRequest::default() };
    let status = refuse(long_name, 0).await;
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "writer", &["128"]);
}

#[tokio::test]
async fn a_stream_ends_with_its_session() {
    let mut bench = Bench::start().await;
    let (mut stream, _) = Stream::open(&bench.worlds, "arm").await;
    bench.sessions.delete_session(pb::DeleteSessionRequest::default()).await.unwrap();
    let status = stream.answer().await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SESSION_NOT_FOUND", "", &["has ended"]);
}
