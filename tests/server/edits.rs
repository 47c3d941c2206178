//! Unary edits: all or nothing, retries, expected ticks, times, columns; and reading back what was written.

use tonic::Code;
use wire::v1::{self as pb, edit::Op};

use crate::harness::{
    Bench, assert_refused, at, cuboid, insert, move_to, ray_along_z, remove, settings, shape, sphere, vec3,
};

fn get(id: u64) -> pb::GetShapeRequest {
    pb::GetShapeRequest { id, ..pb::GetShapeRequest::default() }
}

fn clear() -> pb::Edit {
    pb::Edit { op: Some(Op::Clear(pb::Clear {})) }
}

async fn position(bench: &mut Bench, id: u64) -> pb::Vec3 {
    let answer = bench.worlds.get_shape(get(id)).await.unwrap().into_inner();
    answer.shape.unwrap().pose.unwrap().position.unwrap()
}

#[tokio::test]
async fn each_batch_is_one_tick_and_is_read_back_as_written() {
    let mut bench = Bench::start().await;
    let written = pb::Shape {
        layers: Some(6),
        collides_with: Some(0),
        mobility: pb::Mobility::Kinematic.into(),
        sensor: true,
        user_data: u64::MAX,
        velocity: Some(vec3(1.0, 2.0, 3.0)),
        angular_velocity: Some(vec3(0.0, 0.5, 0.0)),
        group: 9,
        pose: Some(pb::Pose {
            position: Some(vec3(1.0, 2.0, 3.0)),
            rotation: Some(pb::Quat { x: 0.0, y: 0.0, z: 3.0, w: 4.0 }),
        }),
        ..shape(7, cuboid(1.0, 2.0, 3.0), at(0.0, 0.0, 0.0))
    };
    assert_eq!(bench.edit(vec![insert(written.clone())]).await.unwrap(), 2);
    let read = bench.worlds.get_shape(get(7)).await.unwrap().into_inner();
    assert_eq!(read.info.unwrap().tick, 2);
    assert_eq!(read.shape.unwrap(), written, "a quaternion comes back as it was sent, of whatever length");
    assert_eq!(bench.edit(Vec::new()).await.unwrap(), 3, "an empty batch is a tick too");
}

#[tokio::test]
async fn an_insert_replaces_whole_and_a_move_only_what_it_names() {
    let mut bench = Bench::start().await;
    let first = pb::Shape { user_data: 5, ..shape(1, sphere(1.0), at(1.0, 2.0, 3.0)) };
    bench.edit(vec![insert(first)]).await.unwrap();
    let turn = pb::Pose { position: None, rotation: Some(pb::Quat { x: 1.0, y: 0.0, z: 0.0, w: 0.0 }) };
    bench.edit(vec![move_to(1, turn)]).await.unwrap();
    let moved = bench.worlds.get_shape(get(1)).await.unwrap().into_inner().shape.unwrap();
    assert_eq!(moved.user_data, 5);
    let pose = moved.pose.unwrap();
    assert_eq!(pose.position, Some(vec3(1.0, 2.0, 3.0)));
    assert_eq!(pose.rotation.unwrap().x, 1.0);
    bench.edit(vec![insert(shape(1, sphere(1.0), at(9.0, 0.0, 0.0)))]).await.unwrap();
    let replaced = bench.worlds.get_shape(get(1)).await.unwrap().into_inner().shape.unwrap();
    assert_eq!((replaced.user_data, replaced.pose.unwrap().rotation), (0, None));
}

#[tokio::test]
async fn one_wrong_edit_and_nothing_changes() {
    let mut bench = Bench::start().await;
    let batch =
        vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0))), insert(shape(2, sphere(1.0), at(0.0, f64::NAN, 5.0)))];
    let status = bench.edit(batch).await.unwrap_err();
    let field = "edits[1].insert.pose.position.y";
    assert_refused(&status, Code::InvalidArgument, "NOT_FINITE", field, &["is NaN", "finite"]);
    let batch = vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0))), move_to(3, at(0.0, 0.0, 0.0))];
    let status = bench.edit(batch).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SHAPE_NOT_FOUND", "edits[1].move.id", &["is 3"]);
    let description = bench.describe().await;
    assert_eq!((description.tick, description.shape_count, description.edit_count), (1, 0, 0));
}

#[tokio::test]
async fn later_edits_of_a_batch_see_earlier_ones_and_removing_what_is_gone_is_no_error() {
    let mut bench = Bench::start().await;
    let batch = vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0))), move_to(1, at(0.0, 0.0, 7.0)), remove(&[2, 3])];
    bench.edit(batch).await.unwrap();
    assert_eq!(position(&mut bench, 1).await, vec3(0.0, 0.0, 7.0));
    bench.edit(vec![remove(&[1])]).await.unwrap();
    let status = bench.worlds.get_shape(get(1)).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SHAPE_NOT_FOUND", "id", &["at tick 3"]);
    bench.edit(vec![insert(shape(4, sphere(1.0), at(0.0, 0.0, 5.0))), clear()]).await.unwrap();
    assert_eq!(bench.describe().await.shape_count, 0);
}

#[tokio::test]
async fn columns_do_what_single_edits_do() {
    let mut bench = Bench::start().await;
    let inserts = pb::InsertColumns {
        like: Some(pb::Shape { user_data: 3, ..shape(0, sphere(1.0), at(99.0, 0.0, 0.0)) }),
        ids: vec![1, 2, 3],
        poses: Some(pb::PoseColumns {
            frame_origin: Some(vec3(100.0, 0.0, 0.0)),
            positions: vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0],
            rotations: vec![0.0, 0.0, 0.0, 1.0],
        }),
    };
    let moves = pb::MoveColumns {
        ids: vec![3, 1],
        poses: Some(pb::PoseColumns { positions: vec![0.0, 3.0, 0.0, 0.0, 1.0, 0.0], ..pb::PoseColumns::default() }),
        velocities: vec![1.0, 2.0, 3.0],
        ..pb::MoveColumns::default()
    };
    let edits = [Op::Inserts(inserts), Op::Moves(moves)].map(|op| pb::Edit { op: Some(op) });
    let request = pb::EditRequest { edits: edits.to_vec(), ..pb::EditRequest::default() };
    let answer = bench.worlds.edit(request).await.unwrap().into_inner();
    assert_eq!(answer.tick, 2);
    assert_eq!(answer.durability(), pb::Durability::Applied);
    assert_eq!(position(&mut bench, 1).await, vec3(0.0, 1.0, 0.0));
    assert_eq!(position(&mut bench, 2).await, vec3(101.0, 0.0, 0.0));
    assert_eq!(position(&mut bench, 3).await, vec3(0.0, 3.0, 0.0));
    let shape = bench.worlds.get_shape(get(3)).await.unwrap().into_inner().shape.unwrap();
    assert_eq!((shape.user_data, shape.velocity), (3, Some(vec3(1.0, 2.0, 3.0))));
}

#[tokio::test]
async fn a_retry_is_answered_with_the_first_tick_and_not_applied_again() {
    let mut bench = Bench::start().await;
    let request = pb::EditRequest {
        edits: vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0)))],
        request_id: "once".to_owned(),
        ..pb::EditRequest::default()
    };
    let first = bench.worlds.edit(request.clone()).await.unwrap().into_inner();
    bench.edit(vec![remove(&[1])]).await.unwrap();
    let second = bench.worlds.edit(request.clone()).await.unwrap().into_inner();
    assert_eq!(first, second);
    assert_eq!(bench.describe().await.tick, 3, "the retry made no tick");
    let other = pb::EditRequest { edits: Vec::new(), ..request };
    let status = bench.worlds.edit(other).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "request_id", &["another request"]);
}

#[tokio::test]
async fn an_expected_tick_guards_against_other_writers() {
    let mut bench = Bench::start().await;
    let guarded = |expected_tick| pb::EditRequest { expected_tick: Some(expected_tick), ..pb::EditRequest::default() };
    assert_eq!(bench.worlds.edit(guarded(1)).await.unwrap().into_inner().tick, 2);
    for wrong in [0, 1, 3] {
        let status = bench.worlds.edit(guarded(wrong)).await.unwrap_err();
        assert_refused(&status, Code::Aborted, "TICK_CHANGED", "expected_tick", &["newest tick is 2"]);
    }
}

#[tokio::test]
async fn times_go_on_and_never_back_and_durability_is_not_pretended() {
    let mut bench = Bench::start().await;
    let timed = |seconds| pb::EditRequest {
        time: Some(prost_types::Timestamp { seconds, nanos: 0 }),
        ..pb::EditRequest::default()
    };
    bench.worlds.edit(timed(5)).await.expect("the clock of a simulation may begin anywhere");
    bench.worlds.edit(timed(9_000_000_000)).await.unwrap();
    assert_eq!(bench.describe().await.time.unwrap().seconds, 9_000_000_000);
    let status = bench.worlds.edit(timed(8_999_999_999)).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "time", &["never goes back"]);
    bench.edit(Vec::new()).await.unwrap();
    assert_eq!(bench.describe().await.time.unwrap().seconds, 9_000_000_000, "nor does the server's clock");
    let durable = pb::EditRequest { durability: pb::Durability::Local.into(), ..pb::EditRequest::default() };
    let status = bench.worlds.edit(durable).await.unwrap_err();
    assert_refused(&status, Code::FailedPrecondition, "DURABILITY_NOT_OFFERED", "durability", &["APPLIED"]);
}

#[tokio::test]
async fn there_is_a_most_of_shapes_and_replacing_is_not_adding() {
    let mut settings = settings();
    settings.session_shapes = 2;
    let mut bench = Bench::start_with(settings).await;
    let batch = |ids: std::ops::RangeInclusive<u64>| {
        ids.map(|id| insert(shape(id, sphere(1.0), at(0.0, 0.0, 5.0)))).collect::<Vec<_>>()
    };
    bench.edit(batch(1..=2)).await.unwrap();
    bench.edit(batch(1..=2)).await.unwrap();
    let status = bench.edit(batch(2..=3)).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["3 shapes", "may hold 2"]);
    assert_eq!(bench.describe().await.tick, 3);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_answer_shows_half_a_tick() {
    let mut bench = Bench::start().await;
    let place = |z| (1..=64).map(|id| insert(shape(id, sphere(0.5), at(0.0, 0.0, z)))).collect::<Vec<_>>();
    bench.edit(place(5.0)).await.unwrap();
    let mut worlds = bench.worlds.clone();
    let writer = tokio::spawn(async move {
        for tick in 0..200 {
            let z = if tick % 2 == 0 { 9.0 } else { 5.0 };
            let request = pb::EditRequest { edits: place(z), ..pb::EditRequest::default() };
            worlds.edit(request).await.unwrap();
        }
    });
    let mut seen = std::collections::BTreeSet::new();
    while !writer.is_finished() {
        let request = pb::RaycastRequest { mode: pb::HitMode::All.into(), ..ray_along_z() };
        let answer = bench.questions.raycast(request).await.unwrap().into_inner();
        assert_eq!(answer.hits.len(), 64);
        let tick = answer.info.unwrap().tick;
        let expected = if tick % 2 == 0 { 4.5 } else { 8.5 };
        assert!(
            answer.hits.iter().all(|hit| (hit.distance.unwrap() - expected).abs() < 1e-9),
            "tick {tick} shows shapes of another tick"
        );
        seen.insert(tick);
    }
    writer.await.unwrap();
    assert!(seen.len() > 3, "the reader saw {} ticks only", seen.len());
}
