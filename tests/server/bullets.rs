//! Bullets: what an edit says they touched, in calls, retries and streams, and where the list ends.

use prost::Message;
use tokio_stream::StreamExt;
use wire::v1::{self as pb, edit::Op};

use crate::harness::{Bench, at, cuboid, insert, move_to, shape, sphere};

fn bullet(id: u64, pose: pb::Pose) -> pb::Edit {
    insert(pb::Shape { bullet: true, ..shape(id, sphere(0.25), pose) })
}

/// A bullet before a thin fence, and a sensor behind it.
async fn range() -> Bench {
    let mut bench = Bench::start().await;
    let fence = insert(shape(2, cuboid(0.25, 4.0, 4.0), at(0.0, 0.0, 0.0)));
    let gate = insert(pb::Shape { sensor: true, ..shape(3, cuboid(0.25, 4.0, 4.0), at(2.0, 0.0, 0.0)) });
    bench.edit(vec![bullet(1, at(-4.0, 0.0, 0.0)), fence, gate]).await.unwrap();
    bench
}

fn told(hits: &[pb::SweepHit]) -> Vec<(u64, u64, f64)> {
    let of = |hit: &pb::SweepHit| {
        let impact = hit.impact.unwrap();
        let certificate = impact.certificate.unwrap();
        assert_eq!(certificate.verdict(), pb::Verdict::Hit);
        let interval = certificate.interval.unwrap();
        let fraction = impact.fraction.unwrap();
        assert!(interval.lower.unwrap() <= fraction && fraction <= interval.upper.unwrap());
        (hit.bullet_id, impact.id, fraction)
    };
    hits.iter().map(of).collect()
}

#[tokio::test]
async fn an_edit_says_what_bullets_touched_and_so_does_its_retry() {
    let mut bench = range().await;
    let flight = pb::EditRequest {
        edits: vec![move_to(1, at(4.0, 0.0, 0.0))],
        request_id: "shot".to_owned(),
        ..pb::EditRequest::default()
    };
    let first = bench.worlds.edit(flight.clone()).await.unwrap().into_inner();
    assert_eq!(told(&first.sweep_hits), [(1, 2, 3.5 / 8.0), (1, 3, 5.5 / 8.0)]);
    assert!(!first.sweep_hits_truncated);
    assert_eq!(bench.worlds.edit(flight).await.unwrap().into_inner(), first);
    let request = pb::GetShapeRequest { id: 1, ..pb::GetShapeRequest::default() };
    assert!(bench.worlds.get_shape(request).await.unwrap().into_inner().shape.unwrap().bullet);
    let back = pb::Move { id: 1, pose: Some(at(-4.0, 0.0, 0.0)), teleport: true, ..pb::Move::default() };
    let request = pb::EditRequest { edits: vec![pb::Edit { op: Some(Op::Move(back)) }], ..pb::EditRequest::default() };
    assert!(bench.worlds.edit(request).await.unwrap().into_inner().sweep_hits.is_empty());
}

#[tokio::test]
async fn a_stream_says_it_with_the_commit_of_the_tick() {
    let bench = range().await;
    let message =
        |sequence, edits, commit| pb::EditStreamRequest { sequence, edits, commit, ..pb::EditStreamRequest::default() };
    let messages = [
        message(1, vec![move_to(1, at(0.0, 9.0, 0.0))], false),
        message(2, vec![move_to(1, at(4.0, 0.0, 0.0))], true),
        message(3, vec![], true),
    ];
    let answers = bench.worlds.clone().edit_stream(tokio_stream::iter(messages)).await.unwrap().into_inner();
    let answers: Vec<_> = answers.collect::<Result<_, _>>().await.unwrap();
    let hits: Vec<_> = answers.iter().map(|answer| told(&answer.sweep_hits)).collect();
    // From the pose of the tick before straight to that of this tick, whatever was sent between.
    assert_eq!(hits, [vec![], vec![(1, 2, 3.5 / 8.0), (1, 3, 5.5 / 8.0)], vec![]]);
}

#[tokio::test]
async fn the_longest_list_is_cut_says_so_and_fits_into_a_message() {
    let mut bench = Bench::start().await;
    let heap = pb::Edit {
        op: Some(Op::Inserts(pb::InsertColumns {
            like: Some(pb::Shape { bullet: true, user_data: u64::MAX, ..shape(0, sphere(1.0), at(0.0, 0.0, 0.0)) }),
            ids: (u64::MAX - 299..=u64::MAX).collect(),
            poses: None,
        })),
    };
    bench.edit(vec![heap]).await.unwrap();
    let moves = pb::Edit {
        op: Some(Op::Moves(pb::MoveColumns {
            ids: (u64::MAX - 299..=u64::MAX).collect(),
            poses: Some(pb::PoseColumns { positions: vec![0.0, 3.0, 0.1], ..pb::PoseColumns::default() }),
            ..pb::MoveColumns::default()
        })),
    };
    let request = pb::EditRequest { edits: vec![moves], ..pb::EditRequest::default() };
    let response = bench.worlds.edit(request).await.unwrap().into_inner();
    assert!(response.sweep_hits_truncated);
    assert_eq!(response.sweep_hits.len(), 16_384);
    assert!(response.encoded_len() < 3 << 20, "{} bytes", response.encoded_len());
    assert!(response.sweep_hits.is_sorted_by_key(|hit| hit.bullet_id));
}
