//! `WatchOverlaps`: snapshots, changes tick by tick and merged, resuming, limits, and how it ends.

use std::{collections::BTreeSet, time::Duration};

use tonic::{Code, Status, Streaming};
use wire::v1::{self as pb, edit::Op};

use crate::harness::{
    Bench, assert_invalid, assert_refused, at, cuboid, insert, move_to, remove, settings, shape, sphere, with_token,
};

type Message = pb::WatchOverlapsResponse;
type Overlaps = Vec<(u64, u64)>;

/// A fence across x = 0, a micrometre thick.
fn fence() -> pb::Region {
    pb::Region { id: 7, geometry: Some(cuboid(5e-7, 1.0, 1.0)), ..pb::Region::default() }
}

fn watching(regions: Vec<pb::Region>) -> pb::WatchOverlapsRequest {
    pb::WatchOverlapsRequest { regions, ..pb::WatchOverlapsRequest::default() }
}

async fn watch(bench: &mut Bench, request: pb::WatchOverlapsRequest) -> Streaming<Message> {
    bench.worlds.watch_overlaps(request).await.expect("it watches").into_inner()
}

async fn next(messages: &mut Streaming<Message>) -> Message {
    let message = tokio::time::timeout(Duration::from_secs(20), messages.message()).await;
    message.expect("a message within 20 s").expect("no error").expect("no end")
}

async fn end(messages: &mut Streaming<Message>) -> Status {
    loop {
        let message = tokio::time::timeout(Duration::from_secs(20), messages.message()).await;
        match message.expect("the end within 20 s") {
            Ok(message) => assert!(message.is_some(), "an end with a status"),
            Err(status) => return status,
        }
    }
}

fn rows(columns: &Option<pb::PairColumns>) -> Overlaps {
    let columns = columns.clone().unwrap_or_default();
    assert_eq!(columns.a.len(), columns.b.len());
    columns.a.into_iter().zip(columns.b).collect()
}

/// Entered, left, began, ended.
fn lists(message: &Message) -> [Overlaps; 4] {
    [&message.entered, &message.left, &message.began, &message.ended].map(rows)
}

fn tick(message: &Message) -> u64 {
    message.info.as_ref().expect("it says what was read").tick
}

/// A small ball on this side of the fence.
async fn ball_at(bench: &mut Bench, x: f64) {
    bench.edit(vec![insert(shape(1, sphere(0.1), at(x, 0.0, 0.0)))]).await.unwrap();
}

#[tokio::test]
async fn a_snapshot_comes_first_and_a_fence_that_is_crossed_in_one_tick_is_told() {
    let mut bench = Bench::start().await;
    ball_at(&mut bench, 0.0).await;
    let mut messages = watch(&mut bench, pb::WatchOverlapsRequest { pairs: true, ..watching(vec![fence()]) }).await;
    let first = next(&mut messages).await;
    assert_eq!((first.snapshot, first.merged_ticks, tick(&first)), (true, 0, 2));
    assert_eq!(lists(&first), [vec![(7, 1)], vec![], vec![], vec![]]);
    bench.edit(vec![move_to(1, at(-50.0, 0.0, 0.0))]).await.unwrap();
    let left = next(&mut messages).await;
    assert_eq!((left.snapshot, left.merged_ticks, tick(&left)), (false, 1, 3));
    assert_eq!(lists(&left), [vec![], vec![(7, 1)], vec![], vec![]]);
    bench.edit(vec![move_to(1, at(50.0, 0.0, 0.0))]).await.unwrap();
    assert_eq!(lists(&next(&mut messages).await), [vec![(7, 1)], vec![(7, 1)], vec![], vec![]]);
    bench.edit(vec![insert(shape(2, sphere(0.1), at(50.1, 0.0, 0.0)))]).await.unwrap();
    assert_eq!(lists(&next(&mut messages).await), [vec![], vec![], vec![(1, 2)], vec![]]);
    bench.edit(vec![remove(&[1])]).await.unwrap();
    let ended = next(&mut messages).await;
    assert_eq!((lists(&ended), ended.more), ([vec![], vec![], vec![], vec![(1, 2)]], false));
}

#[tokio::test]
async fn without_a_snapshot_the_first_message_is_empty_and_quiet_ticks_are_told_now_and_then() {
    let mut bench = Bench::start().await;
    ball_at(&mut bench, 0.0).await;
    let request = pb::WatchOverlapsRequest { skip_snapshot: true, ..watching(vec![fence()]) };
    let mut messages = watch(&mut bench, request).await;
    let first = next(&mut messages).await;
    assert_eq!((first.snapshot, lists(&first), tick(&first)), (false, Default::default(), 2));
    for _ in 0..3 {
        bench.edit(vec![insert(shape(2, sphere(0.1), at(50.0, 0.0, 0.0)))]).await.unwrap();
    }
    let quiet = next(&mut messages).await;
    assert_eq!((quiet.snapshot, quiet.merged_ticks, lists(&quiet)), (false, 0, Default::default()));
    assert_eq!(tick(&quiet), 5);
    bench.edit(vec![remove(&[1])]).await.unwrap();
    assert_eq!(lists(&next(&mut messages).await)[1], [(7, 1)]);
}

#[tokio::test]
async fn a_watcher_resumes_where_it_was_and_begins_anew_if_that_cannot_be() {
    let mut bench = Bench::start().await;
    ball_at(&mut bench, -5.0).await;
    let request = watching(vec![fence()]);
    let mut messages = watch(&mut bench, request.clone()).await;
    let token = next(&mut messages).await.resume_token;
    drop(messages);
    // Over the fence and back, and one more that stays.
    for x in [5.0, -5.0] {
        bench.edit(vec![move_to(1, at(x, 0.0, 0.0))]).await.unwrap();
    }
    bench.edit(vec![insert(shape(2, sphere(0.1), at(0.0, 0.0, 0.0)))]).await.unwrap();
    let again = |token: &str| pb::WatchOverlapsRequest { resume_token: token.to_owned(), ..request.clone() };
    let resumed = next(&mut watch(&mut bench, again(&token)).await).await;
    assert_eq!((resumed.snapshot, resumed.merged_ticks, tick(&resumed)), (false, 3, 5));
    assert_eq!(lists(&resumed), [vec![(7, 1), (7, 2)], vec![(7, 1)], vec![], vec![]]);
    let mut other = watching(vec![fence(), pb::Region { id: 8, ..fence() }]);
    other.resume_token.clone_from(&token);
    let anew = next(&mut watch(&mut bench, other).await).await;
    assert_eq!((anew.snapshot, lists(&anew)[0].clone()), (true, vec![(7, 2), (8, 2)]));
    for _ in 0..70 {
        bench.edit(Vec::new()).await.unwrap();
    }
    let late = next(&mut watch(&mut bench, again(&token)).await).await;
    assert_eq!((late.snapshot, lists(&late)[0].clone(), tick(&late)), (true, vec![(7, 2)], 75));
    let status = bench.worlds.watch_overlaps(again("yesterday")).await.unwrap_err();
    assert_refused(
        &status,
        Code::InvalidArgument,
        "OUT_OF_LIMITS",
        "resume_token",
        &["\"yesterday\"", "leave it empty"],
    );
}

#[tokio::test]
async fn what_the_hysteresis_keeps_is_not_resumed_but_told_anew() {
    let mut bench = Bench::start().await;
    ball_at(&mut bench, 0.0).await;
    let request = pb::WatchOverlapsRequest { hysteresis: 1.0, ..watching(vec![fence()]) };
    let mut messages = watch(&mut bench, request.clone()).await;
    next(&mut messages).await;
    bench.edit(vec![move_to(1, at(0.9, 0.0, 0.0)), insert(shape(2, sphere(0.1), at(0.0, 0.0, 0.0)))]).await.unwrap();
    let kept = next(&mut messages).await;
    assert_eq!(lists(&kept), [vec![(7, 2)], vec![], vec![], vec![]]);
    let again = pb::WatchOverlapsRequest { resume_token: kept.resume_token, ..request };
    let resumed = next(&mut watch(&mut bench, again).await).await;
    assert_eq!((resumed.snapshot, lists(&resumed)[0].clone()), (true, vec![(7, 2)]));
    bench.edit(vec![move_to(1, at(1.2, 0.0, 0.0))]).await.unwrap();
    assert_eq!(lists(&next(&mut messages).await), [vec![], vec![(7, 1)], vec![], vec![]]);
}

/// Balls 1 to `count` at x.
fn balls(count: u64, x: f64) -> pb::Edit {
    let ids: Vec<u64> = (1..=count).collect();
    let positions = ids.iter().flat_map(|_| [x as f32, 0.0, 0.0]).collect();
    let poses = Some(pb::PoseColumns { positions, ..pb::PoseColumns::default() });
    pb::Edit { op: Some(Op::Moves(pb::MoveColumns { ids, poses, ..pb::MoveColumns::default() })) }
}

fn many(count: u64) -> pb::Edit {
    let like = Some(shape(0, sphere(0.1), at(0.0, 0.0, 0.0)));
    pb::Edit { op: Some(Op::Inserts(pb::InsertColumns { like, ids: (1..=count).collect(), poses: None })) }
}

#[tokio::test]
async fn a_slow_reader_gets_several_ticks_at_once_and_loses_nothing() {
    const BALLS: u64 = 6000;
    let mut bench = Bench::start().await;
    bench.edit(vec![many(BALLS), balls(BALLS, -9.0)]).await.unwrap();
    let mut messages = watch(&mut bench, watching(vec![fence()])).await;
    assert!(next(&mut messages).await.snapshot);
    // Nobody reads while they cross the fence, one more each time on the other side for good.
    let mut crossed = 0;
    for round in 1..=40_u64 {
        let x = if round % 2 == 1 { 9.0 } else { -9.0 };
        bench.edit(vec![balls(BALLS, x)]).await.unwrap();
        crossed += 1;
    }
    bench.edit(vec![move_to(3, at(0.0, 0.0, 0.0))]).await.unwrap();
    crossed += 1;
    let (mut ticks, mut most, mut inside) = (0, 0, BTreeSet::new());
    while ticks < crossed {
        let message = next(&mut messages).await;
        assert!(!message.snapshot && !message.more);
        ticks += u64::from(message.merged_ticks);
        most = most.max(message.merged_ticks);
        let [entered, left, ..] = lists(&message).map(BTreeSet::from_iter);
        assert!(left.is_subset(&entered), "nothing is inside before the last tick");
        if tick(&message) < 2 + crossed {
            assert_eq!(entered.len() as u64, BALLS);
        }
        inside.extend(entered.difference(&left).copied());
    }
    assert_eq!((ticks, inside), (crossed, BTreeSet::from([(7, 3)])));
    assert!(most > 1, "vacuous: the reader was never slow");
}

#[tokio::test]
async fn what_is_too_large_for_a_message_comes_in_several() {
    let mut bench = Bench::start().await;
    bench.edit(vec![many(400)]).await.unwrap();
    let pairs = pb::WatchOverlapsRequest { pairs: true, ..pb::WatchOverlapsRequest::default() };
    let mut messages = watch(&mut bench, pairs).await;
    let (first, second) = (next(&mut messages).await, next(&mut messages).await);
    assert_eq!((first.more, second.more), (true, false));
    assert!(first.snapshot && !second.snapshot && first.resume_token.is_empty() && !second.resume_token.is_empty());
    let all: Overlaps = [first, second].iter().flat_map(|message| rows(&message.began)).collect();
    assert_eq!(all.len(), 400 * 399 / 2);
    assert!(all.is_sorted());
    let some = pb::WatchOverlapsRequest { pairs: true, pair_ids: vec![9], ..pb::WatchOverlapsRequest::default() };
    assert_eq!(rows(&next(&mut watch(&mut bench, some).await).await.began).len(), 399);
    bench.edit(vec![many(3000)]).await.unwrap();
    let status = end(&mut messages).await;
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["4194304", "pair_ids"]);
}

#[tokio::test]
async fn the_rust_client_watches_its_own_session() {
    let mut bench = Bench::start().await;
    let token = bench.create_session("yard").await.token;
    let client = calipers_client::Client::from_channel(bench.server.connect_in_process());
    let client = client.with_session("yard").with_token(&token).expect("a token is ASCII");
    let mut messages = client.watch_overlaps(watching(vec![fence()])).await.expect("it watches");
    assert!(next(&mut messages).await.snapshot);
    let mut drawn = client.watch_world(pb::WatchWorldRequest::default()).await.expect("it watches");
    assert!(drawn.message().await.expect("no error").expect("no end").snapshot);
    client.edit([insert(shape(1, sphere(0.1), at(0.0, 0.0, 0.0)))]).await.expect("a tick");
    assert_eq!(lists(&next(&mut messages).await)[0], [(7, 1)]);
    assert_eq!(drawn.message().await.expect("no error").expect("no end").inserted.len(), 1);
}

#[tokio::test]
async fn what_is_wrong_is_named() {
    let mut bench = Bench::start().await;
    let ok = fence;
    let two = |second| watching(vec![ok(), second]);
    let wrong = [
        (watching(vec![]), ("MISSING", "regions", &["pairs is not set"][..])),
        (two(ok()), ("OUT_OF_LIMITS", "regions[1].id", &["is 7", "regions[0]"])),
        (two(pb::Region { id: 0, ..ok() }), ("OUT_OF_LIMITS", "regions[1].id", &["is 0"])),
        (two(pb::Region { id: 8, geometry: None, ..ok() }), ("MISSING", "regions[1].geometry", &["sphere"])),
        (
            two(pb::Region { id: 8, geometry: Some(sphere(-1.0)), ..ok() }),
            ("OUT_OF_LIMITS", "regions[1].geometry.sphere.radius", &["is -1"]),
        ),
        (
            two(pb::Region { id: 8, pose: Some(at(f64::NAN, 0.0, 0.0)), ..ok() }),
            ("NOT_FINITE", "regions[1].pose.position.x", &["NaN"]),
        ),
        (watching(vec![ok(); 4097]), ("TOO_MANY_ITEMS", "regions", &["4096"])),
        (
            pb::WatchOverlapsRequest { pair_ids: vec![1], ..two(pb::Region { id: 8, ..ok() }) },
            ("OUT_OF_LIMITS", "pair_ids", &["pairs is not set"]),
        ),
        (
            pb::WatchOverlapsRequest { pairs: true, pair_ids: vec![1, 0], ..watching(vec![]) },
            ("OUT_OF_LIMITS", "pair_ids[1]", &["is 0"]),
        ),
        (
            pb::WatchOverlapsRequest { hysteresis: -1.0, ..watching(vec![ok()]) },
            ("OUT_OF_LIMITS", "hysteresis", &["is -1"]),
        ),
    ];
    for (request, refusal) in wrong {
        let status = bench.worlds.watch_overlaps(request).await.map(|_| ()).unwrap_err();
        assert_invalid(&status, refusal);
    }
}

#[tokio::test]
async fn it_ends_with_its_session_and_its_server_and_there_are_not_too_many() {
    let mut bench = Bench::start_with(settings()).await;
    let token = bench.create_session("gates").await.token;
    let request = pb::WatchOverlapsRequest { session: "gates".to_owned(), ..watching(vec![fence()]) };
    let status = bench.worlds.watch_overlaps(request.clone()).await.map(|_| ()).unwrap_err();
    assert_refused(&status, Code::Unauthenticated, "NO_TOKEN", "", &["gates"]);
    let mut messages = bench.worlds.watch_overlaps(with_token(&token, request)).await.expect("it watches").into_inner();
    assert!(next(&mut messages).await.snapshot);
    let delete = pb::DeleteSessionRequest { session: "gates".to_owned() };
    bench.sessions.delete_session(with_token(&token, delete)).await.expect("deleted");
    assert_refused(&end(&mut messages).await, Code::NotFound, "SESSION_NOT_FOUND", "", &["gates"]);
    let mut all = Vec::new();
    for _ in 0..64 {
        all.push(watch(&mut bench, watching(vec![fence()])).await);
    }
    let status = bench.worlds.watch_overlaps(watching(vec![fence()])).await.map(|_| ()).unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["64"]);
    all.truncate(1);
    let mut hurried = tonic::Request::new(watching(vec![fence()]));
    hurried.set_timeout(Duration::from_millis(300));
    // A place is free soon after its stream is dropped.
    tokio::time::sleep(Duration::from_millis(200)).await;
    let mut hurried = bench.worlds.watch_overlaps(hurried).await.expect("it watches").into_inner();
    assert!(matches!(end(&mut hurried).await.code(), Code::DeadlineExceeded | Code::Cancelled));
    tokio::spawn(bench.server.stop());
    assert_refused(&end(&mut all[0]).await, Code::Unavailable, "STOPPING", "", &["resume_token"]);
}
