//! Copies of a world to try something out, and other settings of a world.

use std::time::SystemTime;

use calipers_client::{Client, ask};
use tonic::Code;
use wire::v1::{self as pb, read_at::At};

use crate::harness::{Bench, assert_refused, at, insert, ray, readme_world, shape, sphere, with_token};

fn fork(request: pb::ForkSessionRequest) -> pb::ForkSessionRequest {
    pb::ForkSessionRequest { fork: "try".to_owned(), ..request }
}

fn at_tick(tick: u64) -> Option<pb::ReadAt> {
    Some(pb::ReadAt { at: Some(At::Tick(tick)), tick_fraction: 0.0 })
}

async fn insert_into(bench: &mut Bench, session: &str, token: &str, id: u64, z: f64) -> u64 {
    let request = pb::EditRequest {
        session: session.to_owned(),
        edits: vec![insert(shape(id, sphere(1.0), at(0.0, 0.0, z)))],
        ..pb::EditRequest::default()
    };
    bench.worlds.edit(with_token(token, request)).await.unwrap().into_inner().tick
}

async fn hit_in(bench: &mut Bench, session: &str, token: &str) -> u64 {
    let answer = bench.questions.raycast(with_token(token, ray(session))).await.unwrap().into_inner();
    answer.hits.first().map_or(0, |hit| hit.id)
}

#[tokio::test]
async fn a_copy_goes_its_own_way_from_the_same_tick() {
    let mut bench = readme_world().await;
    let made = bench.sessions.fork_session(fork(pb::ForkSessionRequest::default())).await.unwrap().into_inner();
    let copy = made.session.unwrap();
    assert_eq!((copy.session.as_str(), copy.tick), ("try", 2));
    assert_eq!(hit_in(&mut bench, "try", &made.token).await, 1);
    assert_eq!(insert_into(&mut bench, "try", &made.token, 7, 3.0).await, 3);
    assert_eq!(hit_in(&mut bench, "try", &made.token).await, 7);
    assert_eq!(hit_in(&mut bench, "", "").await, 1, "the original does not see it");
    let describe = pb::DescribeWorldRequest { session: "try".to_owned() };
    let description = bench.worlds.describe_world(with_token(&made.token, describe)).await.unwrap().into_inner();
    assert_eq!((description.oldest_tick, description.shape_count), (2, 2), "history does not come along");
}

#[tokio::test]
async fn a_copy_may_begin_at_a_past_tick_but_not_between_two() {
    let mut bench = readme_world().await;
    bench.edit(vec![insert(shape(7, sphere(1.0), at(0.0, 0.0, 3.0)))]).await.unwrap();
    let request = fork(pb::ForkSessionRequest { read_at: at_tick(2), ..pb::ForkSessionRequest::default() });
    let made = bench.sessions.fork_session(request).await.unwrap().into_inner();
    assert_eq!(made.session.unwrap().tick, 2);
    assert_eq!(hit_in(&mut bench, "try", &made.token).await, 1);
    let between = Some(pb::ReadAt { at: Some(At::Tick(2)), tick_fraction: 0.5 });
    let request = pb::ForkSessionRequest { read_at: between, ..pb::ForkSessionRequest::default() };
    let status = bench.sessions.fork_session(request).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "read_at.tick_fraction", &["begins at a tick"]);
    let between = Some(At::Time(prost_types::Timestamp { seconds: 9, nanos: 0 }));
    let read_at = Some(pb::ReadAt { at: between, tick_fraction: 0.0 });
    let request = pb::ForkSessionRequest { read_at, ..pb::ForkSessionRequest::default() };
    let status = bench.sessions.fork_session(request).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "read_at.time", &["name a tick"]);
    let request = pb::ForkSessionRequest { read_at: at_tick(9), ..pb::ForkSessionRequest::default() };
    let status = bench.sessions.fork_session(request).await.unwrap_err();
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "read_at.tick", &["newest 3"]);
}

#[tokio::test]
async fn copies_are_made_by_owners_once_and_under_a_free_name() {
    let mut bench = readme_world().await;
    let request = fork(pb::ForkSessionRequest { request_id: "once".to_owned(), ..pb::ForkSessionRequest::default() });
    let first = bench.sessions.fork_session(request.clone()).await.unwrap().into_inner();
    let again = bench.sessions.fork_session(request).await.unwrap().into_inner();
    assert_eq!(first.token, again.token, "a retry gives the first answer");
    let status = bench.sessions.fork_session(fork(pb::ForkSessionRequest::default())).await.unwrap_err();
    assert_refused(&status, Code::AlreadyExists, "SESSION_EXISTS", "fork", &["taken"]);
    let request = pb::ForkSessionRequest { fork: "7up".to_owned(), ..pb::ForkSessionRequest::default() };
    let status = bench.sessions.fork_session(request).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "fork", &["arena-7"]);
    let writer = pb::CreateTokenRequest { session: "try".to_owned(), role: pb::Role::Writer.into() };
    let writer = bench.sessions.create_token(with_token(&first.token, writer)).await.unwrap().into_inner().token;
    let request = pb::ForkSessionRequest { session: "try".to_owned(), ..pb::ForkSessionRequest::default() };
    let status = bench.sessions.fork_session(with_token(&writer, request)).await.unwrap_err();
    assert_refused(&status, Code::PermissionDenied, "ROLE_TOO_LOW", "", &["owner"]);
}

#[tokio::test]
async fn a_copy_knows_the_geometries_and_may_forget_them() {
    let mut bench = readme_world().await;
    let create = pb::CreateGeometryRequest { geometry: Some(sphere(0.25)), ..pb::CreateGeometryRequest::default() };
    let id = bench.geometries.create_geometry(create).await.unwrap().into_inner().geometry.unwrap().geometry_id;
    let made = bench.sessions.fork_session(fork(pb::ForkSessionRequest::default())).await.unwrap().into_inner();
    let get = pb::GetGeometryRequest { session: "try".to_owned(), geometry_id: id.clone(), wait: false };
    bench.geometries.get_geometry(with_token(&made.token, get)).await.unwrap();
    let forget = pb::DeleteGeometryRequest { session: "try".to_owned(), geometry_id: id.clone() };
    bench.geometries.delete_geometry(with_token(&made.token, forget)).await.unwrap();
    let get = pb::GetGeometryRequest { session: String::new(), geometry_id: id, wait: false };
    bench.geometries.get_geometry(get).await.unwrap();
}

#[tokio::test]
async fn settings_that_are_left_out_stay() {
    let mut bench = readme_world().await;
    let mut update = async |history_ticks, margin| {
        let settings = Some(pb::WorldSettings { history_ticks, margin });
        let request = pb::UpdateWorldRequest { settings, ..pb::UpdateWorldRequest::default() };
        bench.worlds.update_world(request).await.unwrap().into_inner().settings.unwrap()
    };
    let settings = |history_ticks, margin| pb::WorldSettings { history_ticks: Some(history_ticks), margin };
    assert_eq!(update(None, None).await, settings(64, None));
    assert_eq!(update(None, Some(0.5)).await, settings(64, Some(0.5)));
    assert_eq!(update(Some(0), None).await, settings(0, Some(0.5)));
    let description = bench.describe().await;
    assert_eq!((description.settings.unwrap(), description.oldest_tick), (settings(0, Some(0.5)), 2));
    let made = pb::CreateSessionRequest { settings: Some(settings(5, None)), ..pb::CreateSessionRequest::default() };
    let made = bench.sessions.create_session(made).await.unwrap().into_inner();
    let describe = pb::DescribeWorldRequest { session: made.session.unwrap().session };
    let described = bench.worlds.describe_world(with_token(&made.token, describe)).await.unwrap().into_inner();
    assert_eq!(described.settings.unwrap(), settings(5, None));
}

#[tokio::test]
async fn the_client_forks_and_reads_the_past() {
    let bench = readme_world().await;
    let client = Client::connect(&bench.server.local_addr().to_string()).await.unwrap();
    let what_if = client.fork(pb::ForkSessionRequest::default()).await.unwrap();
    what_if.edit([calipers_client::shape::sphere(9, 0.5).insert()]).await.unwrap();
    let mut ray = ask::ray([0.0; 3], [0.0, 0.0, 1.0]);
    let mut first = async |options| {
        ray.options = Some(options);
        what_if.raycast(ray.clone()).await.unwrap().hits[0].id
    };
    assert_eq!(first(ask::at_tick(2)).await, 1);
    assert_eq!(first(ask::between_ticks(2, 0.5)).await, 1);
    assert_eq!(first(ask::at_tick(3)).await, 9);
    assert_eq!(first(ask::at_time(SystemTime::now())).await, 9);
    what_if.delete_session(pb::DeleteSessionRequest::default()).await.unwrap();
}
