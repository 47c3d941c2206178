//! Which version of the world is read: the newest, a named one, one that is waited for.

use std::time::Duration;

use tonic::Code;
use wire::v1::{self as pb, read_at::At};

use crate::harness::{assert_refused, ray_along_z, read_at, readme_world};

#[tokio::test]
async fn versions_that_are_not_held_are_refused_with_the_ones_that_are() {
    let mut bench = readme_world().await;
    let mut ask = async |at: pb::ReadAt| {
        let request = pb::RaycastRequest {
            options: Some(pb::QueryOptions {
                read_at: Some(at),
                ..pb::QueryOptions::default()
            }),
            ..ray_along_z()
        };
        bench.questions.raycast(request).await
    };
    let whole = |at| pb::ReadAt {
        at: Some(at),
        tick_fraction: 0.0,
    };
    assert_eq!(
        ask(whole(At::Tick(2))).await.unwrap().into_inner().info.unwrap().tick,
        2
    );
    for tick in [1, 3] {
        let status = ask(whole(At::Tick(tick))).await.unwrap_err();
        let parts = ["oldest and newest are 2"];
        assert_refused(
            &status,
            Code::OutOfRange,
            "TICK_NOT_HELD",
            "options.read_at.tick",
            &parts,
        );
    }
    let fraction = pb::ReadAt {
        at: Some(At::Tick(2)),
        tick_fraction: 0.5,
    };
    let status = ask(fraction).await.unwrap_err();
    assert_refused(
        &status,
        Code::OutOfRange,
        "TICK_NOT_HELD",
        "options.read_at.tick_fraction",
        &[],
    );
    let alone = pb::ReadAt {
        at: None,
        tick_fraction: 0.5,
    };
    let status = ask(alone).await.unwrap_err();
    assert_refused(
        &status,
        Code::InvalidArgument,
        "OUT_OF_LIMITS",
        "options.read_at.tick_fraction",
        &[],
    );
    let status = ask(whole(At::Tick(0))).await.unwrap_err();
    assert_refused(
        &status,
        Code::InvalidArgument,
        "OUT_OF_LIMITS",
        "options.read_at.tick",
        &["begin at 1"],
    );
    let long_ago = prost_types::Timestamp { seconds: 0, nanos: 0 };
    let status = ask(whole(At::Time(long_ago))).await.unwrap_err();
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "options.read_at.time", &[]);
    let far_on = prost_types::Timestamp {
        seconds: 9_000_000_000,
        nanos: 0,
    };
    assert_eq!(
        ask(whole(At::Time(far_on)))
            .await
            .unwrap()
            .into_inner()
            .info
            .unwrap()
            .tick,
        2
    );
}

#[tokio::test]
async fn min_tick_waits_for_the_tick_and_not_beyond_the_deadline() {
    let mut bench = readme_world().await;
    let waiting = pb::RaycastRequest {
        options: Some(read_at(At::MinTick(3))),
        ..ray_along_z()
    };
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
