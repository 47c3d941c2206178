//! First touches of the past over the wire: when they were, what is out of range, and batches of them.

use tonic::Code;
use wire::v1::{self as pb, answer::Answer as Kind, question::Question as Asked};

use crate::harness::{
    Bench, assert_invalid, assert_refused, at, insert, move_to, remove, shape, sphere, subject, subject_shape,
};

/// Ball 1 flies by ball 2 at tick 3 to 4 and through ball 3 at tick 4 to 5.
pub(crate) async fn flight() -> Bench {
    let mut bench = Bench::start().await;
    let ball = |id, x| insert(shape(id, sphere(0.5), at(x, 0.0, 0.0)));
    bench.edit(vec![ball(1, 0.0), ball(2, 3.0), ball(3, 13.0)]).await.unwrap();
    bench.edit(vec![move_to(2, at(3.0, 5.0, 0.0))]).await.unwrap();
    bench.edit(vec![move_to(1, at(8.0, 0.0, 0.0))]).await.unwrap();
    bench.edit(vec![move_to(1, at(16.0, 0.0, 0.0))]).await.unwrap();
    bench.edit(vec![remove(&[3])]).await.unwrap();
    bench
}

pub(crate) fn since(from_tick: u64) -> pb::FirstTouchRequest {
    pb::FirstTouchRequest { subject: Some(subject_shape(1)), from_tick, ..pb::FirstTouchRequest::default() }
}

#[tokio::test]
async fn a_touch_between_two_ticks_is_found_in_the_past() {
    let mut bench = flight().await;
    let found = bench.questions.first_touch(since(2)).await.unwrap().into_inner();
    let impact = found.hits[0].impact.unwrap();
    assert_eq!((found.verdict(), found.hits.len(), found.hits[0].tick), (pb::Verdict::Hit, 1, 4));
    assert_eq!((impact.id, impact.fraction, impact.initial), (3, Some(0.5), false));
    assert_eq!(found.info.unwrap().tick, 6);
    // Ball 3 is not there any more, but was at tick 4.
    let pair = pb::FirstTouchRequest { against: Some(Box::new(subject_shape(3))), ..since(2) };
    assert_eq!(bench.questions.first_touch(pair.clone()).await.unwrap().into_inner().hits, found.hits);
    let other = pb::FirstTouchRequest { against: Some(Box::new(subject_shape(2))), ..since(2) };
    let missed = bench.questions.first_touch(other).await.unwrap().into_inner();
    assert_eq!((missed.verdict(), missed.hits.len()), (pb::Verdict::Miss, 0));
    let early = pb::FirstTouchRequest { to_tick: 4, ..since(2) };
    assert_eq!(bench.questions.first_touch(early).await.unwrap().into_inner().verdict(), pb::Verdict::Miss);
    // A place on the way: who came through first, and when.
    let gate = Some(subject(sphere(0.5), at(5.0, 0.0, 0.0)));
    let gate = pb::FirstTouchRequest { subject: gate, ..since(2) };
    let came = bench.questions.first_touch(gate).await.unwrap().into_inner();
    let impact = came.hits[0].impact.unwrap();
    assert_eq!((came.hits[0].tick, impact.id, impact.fraction), (3, 1, Some(0.5)));
    // The shooter's own body is left out, at its id now.
    let exclude = |ids: &[u64]| {
        let filter = pb::Filter { exclude_ids: ids.to_vec(), ..pb::Filter::default() };
        Some(Box::new(pb::QueryOptions { filter: Some(filter), ..pb::QueryOptions::default() }))
    };
    let without = pb::FirstTouchRequest { options: exclude(&[3]), ..since(2) };
    assert_eq!(bench.questions.first_touch(without).await.unwrap().into_inner().verdict(), pb::Verdict::Miss);
    let question = pb::Question { question: Some(Asked::FirstTouch(Box::new(pair))) };
    let batch = pb::BatchRequest { questions: vec![question], ..pb::BatchRequest::default() };
    let answers = bench.questions.batch(batch).await.unwrap().into_inner().answers;
    let Some(Kind::FirstTouch(same)) = &answers[0].answer else { panic!("{answers:?}") };
    assert_eq!(same.hits, found.hits);
}

#[tokio::test]
async fn ticks_out_of_range_and_shapes_that_never_were_are_told() {
    let mut bench = flight().await;
    let invalid = bench.questions.first_touch(since(0)).await.unwrap_err();
    assert_invalid(&invalid, ("OUT_OF_LIMITS", "from_tick", &["ticks begin at 1"]));
    let turned = pb::FirstTouchRequest { to_tick: 2, ..since(4) };
    let turned = bench.questions.first_touch(turned).await.unwrap_err();
    assert_invalid(&turned, ("OUT_OF_LIMITS", "to_tick", &["before from_tick, 4"]));
    let unmade = pb::FirstTouchRequest { to_tick: 9, ..since(2) };
    let unmade = bench.questions.first_touch(unmade).await.unwrap_err();
    assert_refused(&unmade, Code::OutOfRange, "TICK_NOT_HELD", "to_tick", &["is 9", "newest 6"]);
    let never = pb::FirstTouchRequest { against: Some(Box::new(subject_shape(9))), ..since(2) };
    let never = bench.questions.first_touch(never).await.unwrap_err();
    assert_refused(&never, Code::NotFound, "SHAPE_NOT_FOUND", "against.id", &["9"]);
    let settings = pb::WorldSettings { history_ticks: Some(1), ..pb::WorldSettings::default() };
    let shorter = pb::UpdateWorldRequest { settings: Some(settings), ..pb::UpdateWorldRequest::default() };
    bench.worlds.update_world(shorter).await.unwrap();
    let gone = bench.questions.first_touch(since(2)).await.unwrap_err();
    assert_refused(&gone, Code::OutOfRange, "TICK_NOT_HELD", "from_tick", &["is 2", "oldest is 5"]);
}
