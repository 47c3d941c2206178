//! Which version of the world is read: the newest, a named one, one that is waited for.

use std::time::Duration;

use tonic::{Code, Status};
use tonic_types::StatusExt;
use wire::v1::{self as pb, edit::Op, read_at::At};

use crate::harness::{Bench, assert_refused, at, insert, ray_along_z, read_at, readme_world, shape, sphere};

/// A ray's answer at a version: the tick that was read.
async fn tick_read(bench: &mut Bench, at: Option<At>, tick_fraction: f64) -> Result<u64, Status> {
    let request = pb::RaycastRequest {
        options: Some(Box::new(pb::QueryOptions {
            read_at: Some(pb::ReadAt { at, tick_fraction }),
            ..pb::QueryOptions::default()
        })),
        ..ray_along_z()
    };
    let answer = bench.questions.raycast(request).await?.into_inner();
    Ok(answer.info.unwrap().tick)
}

fn second(seconds: i64) -> Option<At> {
    Some(At::Time(prost_types::Timestamp { seconds, nanos: 0 }))
}

#[tokio::test]
async fn versions_that_are_not_held_are_refused_with_the_ones_that_are() {
    let mut bench = readme_world().await;
    assert_eq!(tick_read(&mut bench, Some(At::Tick(2)), 0.0).await.unwrap(), 2);
    assert_eq!(tick_read(&mut bench, Some(At::Tick(1)), 0.0).await.unwrap(), 1);
    assert_eq!(tick_read(&mut bench, second(0), 0.0).await.unwrap(), 1, "a world begins in 1970");
    let far_on = second(9_000_000_000);
    assert_eq!(tick_read(&mut bench, far_on, 0.0).await.unwrap(), 2, "nothing is extrapolated");
    let status = tick_read(&mut bench, Some(At::Tick(3)), 0.0).await.unwrap_err();
    let parts = ["not made yet", "oldest is 1, newest 2", "min_tick waits"];
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "options.read_at.tick", &parts);
    let status = tick_read(&mut bench, Some(At::Tick(2)), 0.5).await.unwrap_err();
    let field = "options.read_at.tick_fraction";
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", field, &["no tick after 2"]);
    let status = tick_read(&mut bench, second(-1), 0.0).await.unwrap_err();
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "options.read_at.time", &["oldest is 1"]);
    let settings = Some(pb::WorldSettings { history_ticks: Some(3), margin: None });
    let update = pb::UpdateWorldRequest { settings, ..pb::UpdateWorldRequest::default() };
    bench.worlds.update_world(update).await.unwrap();
    for _ in 0..5 {
        bench.edit(Vec::new()).await.unwrap();
    }
    let status = tick_read(&mut bench, Some(At::Tick(3)), 0.9).await.unwrap_err();
    let parts = ["no longer held", "oldest is 4, newest 7"];
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "options.read_at.tick", &parts);
    let told = status.get_error_details();
    let told = &told.error_info().unwrap().metadata;
    assert_eq!((told["oldest_tick"].as_str(), told["newest_tick"].as_str()), ("4", "7"));
    assert_eq!(tick_read(&mut bench, Some(At::Tick(4)), 0.9).await.unwrap(), 4);
}

/// A sphere that came at tick 2 at z = 5, and went to z = 9 by tick 3, one second later.
async fn moved_world() -> Bench {
    let mut bench = Bench::start().await;
    let edit = |seconds, edits| pb::EditRequest {
        edits,
        time: Some(prost_types::Timestamp { seconds, nanos: 0 }),
        ..pb::EditRequest::default()
    };
    bench.worlds.edit(edit(100, vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0)))])).await.unwrap();
    let to = pb::Move { id: 1, pose: Some(at(0.0, 0.0, 9.0)), ..pb::Move::default() };
    bench.worlds.edit(edit(101, vec![pb::Edit { op: Some(Op::Move(to)) }])).await.unwrap();
    bench
}

#[tokio::test]
async fn the_past_is_read_exactly_between_ticks_and_by_time() {
    let mut bench = moved_world().await;
    let half_past = Some(At::Time(prost_types::Timestamp { seconds: 100, nanos: 500_000_000 }));
    for (read_at, fraction, distance, told) in [
        (Some(At::Tick(1)), 0.5, None, (1, 0.5)),
        (Some(At::Tick(2)), 0.0, Some(4.0), (2, 0.0)),
        (Some(At::Tick(2)), 0.25, Some(5.0), (2, 0.25)),
        (half_past, 0.0, Some(6.0), (2, 0.5)),
        (Some(At::Tick(3)), 0.0, Some(8.0), (3, 0.0)),
        (None, 0.0, Some(8.0), (3, 0.0)),
    ] {
        let options = pb::QueryOptions {
            read_at: Some(pb::ReadAt { at: read_at, tick_fraction: fraction }),
            ..pb::QueryOptions::default()
        };
        let request = pb::RaycastRequest { options: Some(Box::new(options.clone())), ..ray_along_z() };
        let answer = bench.questions.raycast(request).await.unwrap().into_inner();
        let info = answer.info.unwrap();
        assert_eq!((info.tick, info.tick_fraction), told);
        assert_eq!(answer.hits.first().and_then(|hit| hit.distance), distance);
        let questions = vec![pb::Question { question: Some(pb::question::Question::Raycast(ray_along_z())) }];
        let batch = pb::BatchRequest { questions, options: Some(Box::new(options)), ..pb::BatchRequest::default() };
        let batch = bench.questions.batch(batch).await.unwrap().into_inner();
        let info = batch.info.unwrap();
        assert_eq!((info.tick, info.tick_fraction), told);
    }
}

#[tokio::test]
async fn shapes_are_read_where_they_were() {
    let mut bench = moved_world().await;
    bench.edit(vec![insert(shape(2, sphere(1.0), at(7.0, 0.0, 0.0)))]).await.unwrap();
    let half_way = Some(pb::ReadAt { at: Some(At::Tick(2)), tick_fraction: 0.5 });
    let request = pb::GetShapeRequest { id: 1, read_at: half_way, ..pb::GetShapeRequest::default() };
    let answer = bench.worlds.get_shape(request).await.unwrap().into_inner();
    assert_eq!(answer.shape.unwrap().pose.unwrap().position.unwrap().z, 7.0);
    assert_eq!(answer.info.unwrap().tick_fraction, 0.5);
    let list = pb::ListShapesRequest { read_at: half_way, ..pb::ListShapesRequest::default() };
    let listed = bench.worlds.list_shapes(list).await.unwrap().into_inner();
    assert_eq!(listed.shapes.iter().map(|shape| shape.id).collect::<Vec<_>>(), [1], "the second was not there yet");
    let between = Some(pb::ReadAt { at: Some(At::Tick(3)), tick_fraction: 0.25 });
    bench.edit(Vec::new()).await.unwrap();
    let mut list = pb::ListShapesRequest { page_size: 1, ..pb::ListShapesRequest::default() };
    let newest = Some(pb::ReadAt { at: Some(At::Tick(4)), tick_fraction: 0.25 });
    list.read_at = newest;
    let first = bench.worlds.list_shapes(list.clone()).await.unwrap().into_inner();
    list.page_token = first.next_page_token;
    let second = bench.worlds.list_shapes(list).await.unwrap().into_inner();
    assert_eq!((first.shapes[0].id, second.shapes[0].id), (1, 2));
    let info = second.info.unwrap();
    assert_eq!((info.tick, info.tick_fraction), (4, 0.25), "pages are of one moment");
    let request = pb::GetShapeRequest { id: 2, read_at: between, ..pb::GetShapeRequest::default() };
    let status = bench.worlds.get_shape(request).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SHAPE_NOT_FOUND", "id", &["tick 3"]);
}

#[tokio::test]
async fn versions_that_cannot_be_are_refused() {
    let mut bench = readme_world().await;
    let field = "options.read_at.tick_fraction";
    for (at, fraction) in [(None, 0.5), (second(9), 0.5), (Some(At::Tick(2)), 1.0), (Some(At::Tick(2)), -0.1)] {
        let status = tick_read(&mut bench, at, fraction).await.unwrap_err();
        assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", field, &[]);
    }
    let status = tick_read(&mut bench, Some(At::Tick(2)), f64::NAN).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "NOT_FINITE", field, &["is NaN"]);
    for (at, field) in [(At::Tick(0), "options.read_at.tick"), (At::MinTick(0), "options.read_at.min_tick")] {
        let status = tick_read(&mut bench, Some(at), 0.0).await.unwrap_err();
        assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", field, &["begin at 1"]);
    }
}

#[tokio::test]
async fn min_tick_waits_for_the_tick_and_not_beyond_the_deadline() {
    let mut bench = readme_world().await;
    let waiting = pb::RaycastRequest { options: Some(Box::new(read_at(At::MinTick(3)))), ..ray_along_z() };
    let mut late = tonic::Request::new(waiting.clone());
    late.set_timeout(Duration::from_millis(100));
    let status = bench.questions.raycast(late).await.unwrap_err();
    // On a busy machine the client's own clock may run out first.
    let is_over = matches!(status.code(), Code::DeadlineExceeded | Code::Cancelled);
    assert!(is_over, "{status}");
    let mut questions = bench.questions.clone();
    let asked = tokio::spawn(async move { questions.raycast(waiting).await });
    tokio::time::sleep(Duration::from_millis(50)).await;
    assert!(!asked.is_finished());
    bench.edit(Vec::new()).await.unwrap();
    let answer = asked.await.unwrap().unwrap().into_inner();
    assert_eq!(answer.info.unwrap().tick, 3);
}
