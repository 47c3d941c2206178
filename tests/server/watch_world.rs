//! `WatchWorld`: a picture that is told the changes stays that of the world; its rate, its limits, and how it ends.

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

use tonic::{Code, Streaming};
use wire::v1::{self as pb, edit::Op};

use crate::harness::{
    Bench, assert_invalid, assert_refused, at, cuboid, insert, move_to, remove, shape, sphere, vec3, with_token,
};

type Message = pb::WatchWorldResponse;

async fn watch(bench: &mut Bench, request: pb::WatchWorldRequest) -> Streaming<Message> {
    bench.worlds.watch_world(request).await.expect("it watches").into_inner()
}

async fn next(messages: &mut Streaming<Message>) -> Message {
    let message = tokio::time::timeout(Duration::from_secs(20), messages.message()).await;
    message.expect("a message within 20 s").expect("no error").expect("no end")
}

fn tick(message: &Message) -> u64 {
    message.info.as_ref().expect("it says what was read").tick
}

/// Where shapes are drawn.
type Picture = BTreeMap<u64, [f64; 3]>;

fn draw(picture: &mut Picture, message: &Message) {
    if message.snapshot {
        picture.clear();
    }
    for shape in &message.inserted {
        let place = shape.pose.and_then(|pose| pose.position).unwrap_or_default();
        picture.insert(shape.id, [place.x, place.y, place.z]);
    }
    if let Some(moved) = &message.moved {
        let poses = moved.poses.as_ref().expect("where to");
        let origin = poses.frame_origin.expect("relative to what");
        assert_eq!((poses.positions.len(), poses.rotations.len()), (3 * moved.ids.len(), 4 * moved.ids.len()));
        for (id, place) in moved.ids.iter().zip(poses.positions.chunks(3)) {
            let place = [0, 1, 2].map(|axis| f64::from(place[axis]) + [origin.x, origin.y, origin.z][axis]);
            assert!(picture.insert(*id, place).is_some(), "only what is drawn moves");
        }
    }
    for id in &message.removed {
        assert!(picture.remove(id).is_some(), "only what is drawn goes");
    }
}

#[tokio::test]
async fn a_snapshot_comes_first_and_then_what_came_moved_and_went() {
    let mut bench = Bench::start().await;
    let far = shape(2, cuboid(1.0, 1.0, 1.0), at(1e6, 0.5, 0.0));
    bench.edit(vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0))), insert(far)]).await.unwrap();
    let mut messages = watch(&mut bench, pb::WatchWorldRequest::default()).await;
    let first = next(&mut messages).await;
    assert_eq!((first.snapshot, first.more, tick(&first), first.inserted.len()), (true, false, 2, 2));
    // The geometry is an id, which can be downloaded.
    let Some(pb::geometry::Kind::GeometryId(geometry_id)) = first.inserted[1].geometry.clone().unwrap().kind else {
        panic!("an id: {first:?}")
    };
    let download = pb::DownloadGeometryRequest { geometry_id, ..pb::DownloadGeometryRequest::default() };
    let mut pieces = bench.geometries.download_geometry(download).await.expect("it is there").into_inner();
    assert!(pieces.message().await.expect("a piece").is_some());
    let mut picture = Picture::new();
    draw(&mut picture, &first);
    bench.edit(vec![move_to(2, at(1e6, 0.25, 0.0)), insert(shape(3, sphere(0.5), at(0.0, 0.0, 0.0)))]).await.unwrap();
    let second = next(&mut messages).await;
    assert_eq!((second.snapshot, second.inserted.len(), second.moved.clone().unwrap().ids), (false, 1, vec![2]));
    draw(&mut picture, &second);
    bench.edit(vec![remove(&[1])]).await.unwrap();
    let third = next(&mut messages).await;
    assert_eq!((third.removed.clone(), tick(&third)), (vec![1], 4));
    draw(&mut picture, &third);
    assert_eq!(picture, Picture::from([(2, [1e6, 0.25, 0.0]), (3, [0.0; 3])]));
}

#[tokio::test]
async fn only_what_is_in_view_is_told_and_quiet_ticks_now_and_then() {
    let mut bench = Bench::start().await;
    let sensor = pb::Shape { sensor: true, ..shape(2, sphere(1.0), at(0.0, 0.0, 0.0)) };
    bench.edit(vec![insert(shape(1, sphere(1.0), at(5.0, 0.0, 0.0))), insert(sensor)]).await.unwrap();
    let request = pb::WatchWorldRequest {
        bounds: Some(pb::Aabb { min: Some(vec3(-2.0, -2.0, -2.0)), max: Some(vec3(2.0, 2.0, 2.0)) }),
        filter: Some(pb::Filter { exclude_sensors: true, ..pb::Filter::default() }),
        ..pb::WatchWorldRequest::default()
    };
    let mut messages = watch(&mut bench, request).await;
    assert_eq!(next(&mut messages).await.inserted.len(), 0);
    bench.edit(vec![move_to(1, at(2.5, 0.0, 0.0)), move_to(2, at(1.0, 0.0, 0.0))]).await.unwrap();
    let came = next(&mut messages).await;
    assert_eq!((came.inserted.len(), came.inserted[0].id, came.moved.is_none()), (1, 1, true));
    bench.edit(vec![move_to(2, at(0.0, 0.0, 0.0))]).await.unwrap();
    let quiet = next(&mut messages).await;
    assert_eq!((tick(&quiet), quiet.moved.is_none(), quiet.inserted.len()), (4, true, 0));
    bench.edit(vec![move_to(1, at(9.0, 0.0, 0.0))]).await.unwrap();
    assert_eq!(next(&mut messages).await.removed, [1]);
}

#[tokio::test]
async fn ticks_are_merged_to_the_rate_and_large_snapshots_come_in_several_messages() {
    const BALLS: u64 = 5000;
    let mut bench = Bench::start().await;
    let inserts = pb::InsertColumns {
        like: Some(shape(0, sphere(0.1), at(0.0, 0.0, 0.0))),
        ids: (1..=BALLS).collect(),
        poses: None,
    };
    bench.edit(vec![pb::Edit { op: Some(Op::Inserts(inserts)) }]).await.unwrap();
    let mut messages = watch(&mut bench, pb::WatchWorldRequest { max_rate: 10, ..Default::default() }).await;
    let mut picture = Picture::new();
    let mut parts = 0;
    loop {
        let part = next(&mut messages).await;
        draw(&mut picture, &part);
        assert_eq!(part.snapshot, parts == 0);
        parts += 1;
        if !part.more {
            break;
        }
    }
    assert_eq!((parts, picture.len() as u64), (3, BALLS));
    let began = Instant::now();
    for number in 1..=100 {
        bench.edit(vec![move_to(number, at(number as f64, 0.0, 0.0))]).await.unwrap();
    }
    let took = began.elapsed();
    let mut told = 0;
    loop {
        let message = next(&mut messages).await;
        draw(&mut picture, &message);
        told += 1;
        if tick(&message) == 102 {
            break;
        }
    }
    assert!(told <= 2 + took.as_millis() / 100, "{told} messages in {took:?}");
    for number in 1..=BALLS {
        let x = if number <= 100 { number as f64 } else { 0.0 };
        assert_eq!(picture[&number], [x, 0.0, 0.0]);
    }
}

#[tokio::test]
async fn trees_come_down_to_a_level_when_they_change() {
    let mut bench = Bench::start().await;
    let shapes = (1..=40).map(|id| insert(shape(id, sphere(0.4), at(id as f64, 0.0, 0.0))));
    bench.edit(shapes.collect()).await.unwrap();
    let request = pb::WatchWorldRequest { tree_depth: Some(1), ..pb::WatchWorldRequest::default() };
    let mut messages = watch(&mut bench, request).await;
    let nodes = next(&mut messages).await.nodes.expect("a tree");
    assert!(nodes.levels.len() > 2 && nodes.levels.iter().all(|&level| level <= 1), "{nodes:?}");
    assert_eq!((nodes.mins.len(), nodes.maxs.len()), (3 * nodes.levels.len(), 3 * nodes.levels.len()));
    let origin = nodes.frame_origin.expect("relative to what");
    assert!(origin.x <= 0.6 && f64::from(nodes.maxs[0]) + origin.x >= 40.4, "the root holds all: {nodes:?}");
    // What is inserted where nothing moves changes no box of the moving.
    let still = pb::Shape { mobility: pb::Mobility::Static.into(), ..shape(99, sphere(1.0), at(0.0, 0.0, 0.0)) };
    bench.edit(vec![insert(still)]).await.unwrap();
    assert_eq!(next(&mut messages).await.nodes, None);
    bench.edit(vec![move_to(1, at(-100.0, 0.0, 0.0))]).await.unwrap();
    assert!(next(&mut messages).await.nodes.is_some());
}

#[tokio::test]
async fn what_is_wrong_is_named_and_it_ends_with_its_session() {
    let mut bench = Bench::start().await;
    let ok = pb::WatchWorldRequest::default;
    let upside_down = pb::Aabb { min: Some(vec3(1.0, 0.0, 0.0)), max: Some(vec3(0.0, 0.0, 0.0)) };
    let wrong = [
        (pb::WatchWorldRequest { max_rate: 121, ..ok() }, ("OUT_OF_LIMITS", "max_rate", &["120"])),
        (
            pb::WatchWorldRequest { bounds: Some(upside_down), ..ok() },
            ("OUT_OF_LIMITS", "bounds.max.x", &["below that of min"]),
        ),
    ];
    for (request, (reason, field, parts)) in wrong {
        let status = bench.worlds.watch_world(request).await.map(|_| ()).unwrap_err();
        assert_invalid(&status, (reason, field, parts));
    }
    let token = bench.create_session("stage").await.token;
    let request = pb::WatchWorldRequest { session: "stage".to_owned(), ..ok() };
    let mut messages = bench.worlds.watch_world(with_token(&token, request)).await.expect("it watches").into_inner();
    assert!(next(&mut messages).await.snapshot);
    let delete = pb::DeleteSessionRequest { session: "stage".to_owned() };
    bench.sessions.delete_session(with_token(&token, delete)).await.expect("deleted");
    let status = loop {
        if let Err(status) = messages.message().await {
            break status;
        }
    };
    assert_refused(&status, Code::NotFound, "SESSION_NOT_FOUND", "", &["stage"]);
}
