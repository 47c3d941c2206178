//! Watches of the Rust client go on over breaks of the connection, and whoever takes in their turns knows what there is.

use std::{
    collections::{BTreeMap, BTreeSet},
    net::SocketAddr,
    sync::{Arc, Mutex},
    time::Duration,
};

use calipers_client::Client;
use tokio::{
    net::{TcpListener, TcpStream},
    task::AbortHandle,
};
use tonic::Code;
use wire::v1 as pb;

use crate::harness::{Bench, at, insert, move_to, remove, shape, sphere};

/// A way to the server that can be cut.
struct Wire {
    address: SocketAddr,
    connections: Arc<Mutex<Vec<AbortHandle>>>,
    listening: AbortHandle,
}

impl Wire {
    async fn to(server: SocketAddr) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let address = listener.local_addr().expect("an address");
        let connections = Arc::<Mutex<Vec<AbortHandle>>>::default();
        let held = connections.clone();
        let listening = tokio::spawn(async move {
            while let Ok((mut here, _)) = listener.accept().await {
                let passing = tokio::spawn(async move {
                    let mut there = TcpStream::connect(server).await.expect("the server listens");
                    // It ends when either side does.
                    let _ = tokio::io::copy_bidirectional(&mut here, &mut there).await;
                });
                held.lock().expect("no panic").push(passing.abort_handle());
            }
        });
        Self { address, connections, listening: listening.abort_handle() }
    }

    async fn client(&self) -> Client {
        Client::connect(&format!("http://{}", self.address)).await.expect("it listens")
    }

    /// Cuts all connections; new ones are taken.
    fn cut(&self) {
        self.connections.lock().expect("no panic").drain(..).for_each(|connection| connection.abort());
    }

    /// Takes no new ones either.
    fn remove(&self) {
        self.listening.abort();
        self.cut();
    }
}

/// Ids in region 1 after a turn.
fn take_in(inside: &mut BTreeSet<u64>, turn: &pb::WatchOverlapsResponse) {
    assert!(!turn.more);
    let ids = |pairs: &Option<pb::PairColumns>| pairs.as_ref().map(|pairs| pairs.b.clone()).unwrap_or_default();
    let (entered, left) = (ids(&turn.entered), ids(&turn.left));
    if turn.snapshot {
        inside.clear();
    }
    // What is in both lists is as it was before.
    let both = |id: &u64| entered.contains(id) && left.contains(id);
    for id in left.iter().filter(|id| !both(id)) {
        assert!(inside.remove(id), "{id} left twice");
    }
    for &id in entered.iter().filter(|id| !both(id)) {
        assert!(inside.insert(id), "{id} came twice");
    }
}

fn region() -> pb::WatchOverlapsRequest {
    let region = pb::Region { id: 1, geometry: Some(sphere(10.0)), ..pb::Region::default() };
    pb::WatchOverlapsRequest { regions: vec![region], ..pb::WatchOverlapsRequest::default() }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn overlaps_are_followed_over_breaks_and_nothing_is_missed_or_told_twice() {
    let mut bench = Bench::start().await;
    let wire = Wire::to(bench.server.local_addr()).await;
    let balls = (1..=20).map(|id| insert(shape(id, sphere(0.5), at(if id % 2 == 0 { 0.0 } else { 50.0 }, 0.0, 0.0))));
    bench.edit(balls.collect()).await.unwrap();
    let mut watch = wire.client().await.follow_overlaps(region()).await.unwrap();
    let mut inside = BTreeSet::new();
    take_in(&mut inside, &watch.next().await.unwrap());
    let mut expected: BTreeSet<u64> = (1..=20).filter(|id| id % 2 == 0).collect();
    assert_eq!(inside, expected);
    let mut snapshots = 0;
    for round in 0..12_u64 {
        for step in 0..7 {
            let id = 1 + (round * 7 + step * 3) % 20;
            let is_inside = !expected.remove(&id);
            if is_inside {
                expected.insert(id);
            }
            bench.edit(vec![move_to(id, at(if is_inside { 0.0 } else { 50.0 }, 0.0, 0.0))]).await.unwrap();
            if (round + step) % 4 == 0 {
                wire.cut();
            }
        }
        while inside != expected {
            let turn = tokio::time::timeout(Duration::from_secs(20), watch.next()).await.expect("it comes").unwrap();
            snapshots += usize::from(turn.snapshot);
            take_in(&mut inside, &turn);
        }
    }
    assert!(watch.resumed_count() >= 6, "vacuous: {}", watch.resumed_count());
    assert_eq!(snapshots, 0, "the server held all it needed to go on");
}

/// Without a history the server cannot go on where the watch was, and says what there is.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_cannot_be_resumed_begins_with_a_snapshot_even_if_none_was_wanted() {
    let mut bench = Bench::start().await;
    let settings = Some(pb::WorldSettings { history_ticks: Some(0), margin: None });
    bench.worlds.update_world(pb::UpdateWorldRequest { settings, ..Default::default() }).await.unwrap();
    let wire = Wire::to(bench.server.local_addr()).await;
    let request = pb::WatchOverlapsRequest { skip_snapshot: true, ..region() };
    let mut watch = wire.client().await.follow_overlaps(request).await.unwrap();
    let mut inside = BTreeSet::new();
    take_in(&mut inside, &watch.next().await.unwrap());
    wire.cut();
    bench.edit(vec![insert(shape(3, sphere(0.5), at(0.0, 0.0, 0.0)))]).await.unwrap();
    bench.edit(vec![insert(shape(4, sphere(0.5), at(0.0, 0.0, 0.0)))]).await.unwrap();
    let turn = watch.next().await.unwrap();
    take_in(&mut inside, &turn);
    while inside.len() < 2 {
        take_in(&mut inside, &watch.next().await.unwrap());
    }
    assert_eq!(inside, BTreeSet::from([3, 4]));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_world_is_followed_over_breaks() {
    let mut bench = Bench::start().await;
    let wire = Wire::to(bench.server.local_addr()).await;
    let balls = (1..=30).map(|id| insert(shape(id, sphere(0.5), at(id as f64, 0.0, 0.0))));
    bench.edit(balls.collect()).await.unwrap();
    let request = pb::WatchWorldRequest { max_rate: 120, ..pb::WatchWorldRequest::default() };
    let mut watch = wire.client().await.follow_world(request).await.unwrap();
    let mut shown = BTreeMap::new();
    for round in 1..=4_u64 {
        bench.edit(vec![move_to(round, at(-5.0, 0.0, 0.0)), remove(&[round + 10])]).await.unwrap();
        wire.cut();
        bench.edit(vec![move_to(round, at(round as f64 * 2.0, 0.0, 0.0))]).await.unwrap();
        let is_there = |shown: &BTreeMap<u64, f64>| {
            shown.len() as u64 == 30 - round && shown.get(&round).is_some_and(|x| (x - round as f64 * 2.0).abs() < 1e-5)
        };
        while !is_there(&shown) {
            let turn = tokio::time::timeout(Duration::from_secs(20), watch.next()).await.expect("it comes").unwrap();
            if turn.snapshot {
                shown.clear();
            }
            for shape in turn.inserted {
                shown.insert(shape.id, shape.pose.unwrap().position.unwrap().x);
            }
            if let Some(moved) = turn.moved {
                let poses = moved.poses.unwrap();
                for (place, id) in moved.ids.iter().enumerate() {
                    shown.insert(*id, poses.frame_origin.unwrap().x + f64::from(poses.positions[3 * place]));
                }
            }
            for id in &turn.removed {
                shown.remove(id);
            }
        }
    }
    assert!(watch.resumed_count() >= 2, "vacuous: {}", watch.resumed_count());
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_watch_gives_up_when_its_patience_ends_and_at_once_where_that_is_no_use() {
    let mut bench = Bench::start().await;
    let wire = Wire::to(bench.server.local_addr()).await;
    let client = wire.client().await;
    let mut watch = client.follow_overlaps(region()).await.unwrap().with_patience(Duration::from_millis(300));
    watch.next().await.unwrap();
    wire.remove();
    let error = watch.next().await.unwrap_err();
    assert!(matches!(error, calipers_client::Error::GaveUp { .. }), "{error}");

    // A session that has ended is not waited for.
    let token = bench.create_session("arena").await.token;
    let client = Client::connect(&format!("http://{}", bench.server.local_addr())).await.unwrap();
    let client = client.with_session("arena").with_token(&token).unwrap();
    let mut watch = client.follow_overlaps(region()).await.unwrap();
    watch.next().await.unwrap();
    client.delete_session(pb::DeleteSessionRequest::default()).await.unwrap();
    let error = watch.next().await.unwrap_err();
    assert_eq!(error.code(), Some(Code::NotFound), "{error}");
    let wrong = client.follow_overlaps(pb::WatchOverlapsRequest::default()).await.unwrap_err();
    assert!(wrong.code().is_some(), "{wrong}");
}
