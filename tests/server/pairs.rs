//! `Pairs`: the list in columns, its order, its versions, what it refuses, and lists of several messages.

use std::time::Duration;

use tonic::Code;
use wire::v1::{self as pb, edit::Op, read_at::At};

use crate::harness::{Bench, assert_invalid, assert_refused, at, insert, move_to, read_at, shape, sphere};

/// All messages of an answer.
async fn ask(bench: &mut Bench, request: pb::PairsRequest) -> Result<Vec<pb::PairsResponse>, tonic::Status> {
    let mut stream = bench.questions.pairs(request).await?.into_inner();
    let mut parts = Vec::new();
    while let Some(part) = stream.message().await? {
        parts.push(part);
    }
    Ok(parts)
}

fn ids(part: &pb::PairsResponse) -> Vec<(u64, u64)> {
    let columns = part.pairs.clone().unwrap_or_default();
    assert_eq!((columns.a.len(), part.verdicts.len()), (columns.b.len(), columns.b.len()));
    columns.a.into_iter().zip(columns.b).collect()
}

/// Spheres of radius 1 in a row, 1.5 m apart; the last stands alone.
async fn row() -> Bench {
    let mut bench = Bench::start().await;
    let places = [(3, 0.0), (1, 1.5), (2, 3.0), (4, 9.0)];
    bench.edit(places.map(|(id, x)| insert(shape(id, sphere(1.0), at(x, 0.0, 0.0)))).to_vec()).await.unwrap();
    bench
}

#[tokio::test]
async fn they_ascend_and_say_what_was_read() {
    let mut bench = row().await;
    let options = pb::QueryOptions { explain: true, ..pb::QueryOptions::default() };
    let request = pb::PairsRequest { options: Some(Box::new(options)), ..pb::PairsRequest::default() };
    let parts = ask(&mut bench, request).await.unwrap();
    assert_eq!(parts.len(), 1);
    assert_eq!(ids(&parts[0]), [(1, 2), (1, 3)]);
    assert!(parts[0].verdicts.iter().all(|&verdict| verdict == i32::from(pb::Verdict::Hit)));
    let info = parts[0].info.clone().unwrap();
    assert_eq!((info.tick, info.work.unwrap().shapes_tested), (2, 2));
    assert_eq!(bench.describe().await.question_count, 1);
}

#[tokio::test]
async fn the_filter_holds_for_both_shapes_and_an_empty_list_names_its_tick() {
    let mut bench = row().await;
    let without = |id| {
        let filter = pb::Filter { exclude_ids: vec![id], ..pb::Filter::default() };
        let options = pb::QueryOptions { filter: Some(filter), ..read_at(At::MinTick(2)) };
        pb::PairsRequest { options: Some(Box::new(options)), ..pb::PairsRequest::default() }
    };
    assert_eq!(ids(&ask(&mut bench, without(3)).await.unwrap()[0]), [(1, 2)]);
    let parts = ask(&mut bench, without(1)).await.unwrap();
    assert_eq!((parts.len(), ids(&parts[0]).len(), parts[0].info.as_ref().unwrap().tick), (1, 0, 2));
}

#[tokio::test]
async fn what_is_wrong_is_refused_before_the_first_message() {
    let mut bench = row().await;
    let unknown = pb::PairsRequest { session: "nowhere".to_owned(), ..pb::PairsRequest::default() };
    let status = ask(&mut bench, unknown).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SESSION_NOT_FOUND", "", &["nowhere"]);
    let later = pb::PairsRequest { options: Some(Box::new(read_at(At::Tick(99)))), ..pb::PairsRequest::default() };
    let status = ask(&mut bench, later).await.unwrap_err();
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "options.read_at.tick", &["99"]);
}

#[tokio::test]
async fn a_long_list_comes_in_several_messages_and_one_that_is_too_long_is_refused() {
    let mut bench = Bench::start().await;
    let heap = |count| pb::Edit {
        op: Some(Op::Inserts(pb::InsertColumns {
            like: Some(shape(0, sphere(1.0), at(0.0, 0.0, 0.0))),
            ids: (1..=count).collect(),
            poses: None,
        })),
    };
    bench.edit(vec![heap(400)]).await.unwrap();
    let parts = ask(&mut bench, pb::PairsRequest::default()).await.unwrap();
    assert_eq!(parts.len(), 2);
    let pairs: Vec<_> = parts.iter().flat_map(ids).collect();
    assert_eq!(pairs.len(), 400 * 399 / 2);
    assert!(pairs.is_sorted() && pairs.iter().all(|(a, b)| a < b));
    assert!(parts.iter().all(|part| part.info.as_ref().unwrap().tick == 2));
    bench.edit(vec![heap(3000)]).await.unwrap();
    let status = ask(&mut bench, pb::PairsRequest::default()).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["4194304", "options.filter"]);
    let mut hurried = tonic::Request::new(pb::PairsRequest::default());
    hurried.set_timeout(Duration::from_millis(20));
    let status = bench.questions.pairs(hurried).await.map(|_| ()).unwrap_err();
    assert!(matches!(status.code(), Code::DeadlineExceeded | Code::Cancelled), "{status:?}");
}

#[tokio::test]
async fn what_changed_since_a_tick_is_told_pair_by_pair() {
    use pb::PairChange::{Began, Ended, Persisted};
    let mut bench = row().await;
    // Shape 2 leaves shape 1 for shape 4, and shape 3 moves a little.
    bench.edit(vec![move_to(2, at(7.5, 0.0, 0.0)), move_to(3, at(0.25, 0.0, 0.0))]).await.unwrap();
    let since = |tick| pb::PairsRequest { since_tick: Some(tick), ..pb::PairsRequest::default() };
    let parts = ask(&mut bench, since(2)).await.unwrap();
    assert_eq!(ids(&parts[0]), [(1, 2), (1, 3), (2, 4)]);
    assert_eq!(parts[0].changes, [Ended, Persisted, Began].map(i32::from));
    assert_eq!(parts[0].info.as_ref().unwrap().tick, 3);
    assert_eq!(ids(&ask(&mut bench, since(3)).await.unwrap()[0]), [], "nothing since now");
    assert_eq!(ids(&ask(&mut bench, since(1)).await.unwrap()[0]), [(1, 3), (2, 4)]);
    let then = pb::PairsRequest { options: Some(Box::new(read_at(At::Tick(2)))), ..since(1) };
    let then = ask(&mut bench, then).await.unwrap();
    assert_eq!((ids(&then[0]), then[0].info.as_ref().unwrap().tick), (vec![(1, 2), (1, 3)], 2));
    assert!(ask(&mut bench, pb::PairsRequest::default()).await.unwrap()[0].changes.is_empty());
    let late = pb::PairsRequest { options: Some(Box::new(read_at(At::Tick(2)))), ..since(3) };
    assert_invalid(&ask(&mut bench, late).await.unwrap_err(), ("OUT_OF_LIMITS", "since_tick", &["after tick 2"]));
    assert_invalid(&ask(&mut bench, since(0)).await.unwrap_err(), ("OUT_OF_LIMITS", "since_tick", &["begin at 1"]));
    let settings = pb::WorldSettings { history_ticks: Some(0), ..pb::WorldSettings::default() };
    let none = pb::UpdateWorldRequest { settings: Some(settings), ..pb::UpdateWorldRequest::default() };
    bench.worlds.update_world(none).await.unwrap();
    let gone = ask(&mut bench, since(2)).await.unwrap_err();
    assert_refused(&gone, Code::OutOfRange, "TICK_NOT_HELD", "since_tick", &["is 2"]);
}
