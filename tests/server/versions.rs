//! Which version of the world is read: the newest, a named one, one that is waited for.

use std::time::Duration;

use tonic::{Code, Status};
use wire::v1::{self as pb, read_at::At};

use crate::harness::{Bench, assert_refused, ray_along_z, read_at, readme_world};

/// A ray's answer at a version: the tick that was read.
async fn tick_read(bench: &mut Bench, at: Option<At>, tick_fraction: f64) -> Result<u64, Status> {
    let request = pb::RaycastRequest {
        options: Some(pb::QueryOptions {
            read_at: Some(pb::ReadAt { at, tick_fraction }),
            ..pb::QueryOptions::default()
        }),
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
    let far_on = second(9_000_000_000);
    assert_eq!(tick_read(&mut bench, far_on, 0.0).await.unwrap(), 2, "nothing is extrapolated");
    for tick in [1, 3] {
        let status = tick_read(&mut bench, Some(At::Tick(tick)), 0.0).await.unwrap_err();
        let parts = ["oldest and newest are 2"];
        assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "options.read_at.tick", &parts);
    }
    let status = tick_read(&mut bench, Some(At::Tick(2)), 0.5).await.unwrap_err();
    let field = "options.read_at.tick_fraction";
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", field, &["no tick after 2"]);
    let status = tick_read(&mut bench, second(0), 0.0).await.unwrap_err();
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "options.read_at.time", &[]);
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
    let waiting = pb::RaycastRequest { options: Some(read_at(At::MinTick(3))), ..ray_along_z() };
    let mut late = tonic::Request::new(waiting.clone());
    late.set_timeout(Duration::from_millis(100));
    let status = bench.questions.raycast(late).await.unwrap_err();
    assert_eq!(status.code(), Code::DeadlineExceeded, "{status}");
    let mut questions = bench.questions.clone();
    let asked = tokio::spawn(async move { questions.raycast(waiting).await });
    tokio::time::sleep(Duration::from_millis(50)).await;
    assert!(!asked.is_finished());
    bench.edit(Vec::new()).await.unwrap();
    let answer = asked.await.unwrap().unwrap().into_inner();
    assert_eq!(answer.info.unwrap().tick, 3);
}
