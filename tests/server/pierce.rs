//! Rays and casts over the wire that go through what only touches.

use wire::v1::{self as pb, answer::Answer, question::Question};

use crate::harness::{Bench, assert_invalid, at, cuboid, insert, ray_along_z, shape, sphere, subject};

const GLASS: u32 = 0b10;

/// A pane of glass at z = 2, a sensor at z = 4, a wall at z = 6 and a ball behind it.
async fn gallery() -> Bench {
    let mut bench = Bench::start().await;
    let pane = pb::Shape { layers: Some(GLASS), ..shape(1, cuboid(1.0, 1.0, 0.0), at(0.0, 0.0, 2.0)) };
    let sensor = pb::Shape { sensor: true, ..shape(2, sphere(0.5), at(0.0, 0.0, 4.0)) };
    let wall = shape(3, cuboid(1.0, 1.0, 0.25), at(0.0, 0.0, 6.25));
    let ball = shape(4, sphere(0.5), at(0.0, 0.0, 9.0));
    bench.edit([pane, sensor, wall, ball].map(insert).to_vec()).await.unwrap();
    bench
}

fn shot() -> pb::RaycastRequest {
    pb::RaycastRequest { mode: pb::HitMode::Pierce.into(), pierce_layers: Some(GLASS), ..ray_along_z() }
}

fn cast() -> pb::TimeOfImpactRequest {
    pb::TimeOfImpactRequest {
        subject: Some(subject(sphere(0.5), at(0.0, 0.0, 0.0))),
        end: Some(at(0.0, 0.0, 16.0)),
        mode: pb::HitMode::Pierce.into(),
        pierce_layers: Some(GLASS),
        ..pb::TimeOfImpactRequest::default()
    }
}

#[tokio::test]
async fn a_shot_lists_what_it_goes_through_and_ends_at_the_wall() {
    let mut bench = gallery().await;
    let found = bench.questions.raycast(shot()).await.unwrap().into_inner();
    let list: Vec<_> = found.hits.iter().map(|hit| (hit.id, hit.distance(), hit.pierced)).collect();
    assert_eq!(list, [(1, 2.0, true), (2, 3.5, true), (3, 6.0, false)]);
    assert_eq!((found.verdict(), found.truncated), (pb::Verdict::Hit, false));
    let cut = pb::RaycastRequest { max_hits: 1, ..shot() };
    let cut = bench.questions.raycast(cut).await.unwrap().into_inner();
    assert_eq!(cut.hits.iter().map(|hit| hit.id).collect::<Vec<_>>(), [1, 3], "the blocker comes on top");
    assert!(cut.truncated);
    let short = pb::RaycastRequest { max_distance: Some(5.0), ..shot() };
    let short = bench.questions.raycast(short).await.unwrap().into_inner();
    assert_eq!((short.verdict(), short.hits.len()), (pb::Verdict::Miss, 2), "nothing blocks");
    let found = bench.questions.time_of_impact(cast()).await.unwrap().into_inner();
    let list: Vec<_> = found.hits.iter().map(|hit| (hit.id, hit.fraction(), hit.pierced)).collect();
    assert_eq!(list, [(1, 0.09375, true), (2, 0.1875, true), (3, 0.34375, false)]);
    // In a batch it is the same answer.
    let question = pb::Question { question: Some(Question::TimeOfImpact(Box::new(cast()))) };
    let batch = pb::BatchRequest { questions: vec![question], ..pb::BatchRequest::default() };
    let answers = bench.questions.batch(batch).await.unwrap().into_inner().answers;
    let Some(Answer::TimeOfImpact(same)) = &answers[0].answer else { panic!("{answers:?}") };
    assert_eq!(same.hits, found.hits);
}

#[tokio::test]
async fn layers_to_pierce_go_with_their_mode_only_and_columns_have_no_room_for_lists() {
    let mut bench = gallery().await;
    let closest = pb::RaycastRequest { mode: 0, ..shot() };
    let refusal = ("OUT_OF_LIMITS", "pierce_layers", &["HIT_MODE_PIERCE"][..]);
    assert_invalid(&bench.questions.raycast(closest).await.unwrap_err(), refusal);
    let closest = pb::TimeOfImpactRequest { mode: 0, ..cast() };
    assert_invalid(&bench.questions.time_of_impact(closest).await.unwrap_err(), refusal);
    let columns = pb::RaycastBatchRequest {
        directions: vec![0.0, 0.0, 1.0],
        mode: pb::HitMode::Pierce.into(),
        ..pb::RaycastBatchRequest::default()
    };
    let refusal = ("OUT_OF_LIMITS", "mode", &["is HIT_MODE_PIERCE", "Batch"][..]);
    assert_invalid(&bench.questions.raycast_batch(columns).await.unwrap_err(), refusal);
}
