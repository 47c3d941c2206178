//! Edits of every wrong kind: refused with field and item, and nothing changes.

use wire::v1::{self as pb, edit::Op};

use crate::harness::{Bench, Refusal, assert_invalid, at, insert, remove, shape, sphere, vec3};

fn turned(x: f64, w: f64) -> pb::Pose {
    pb::Pose { position: None, rotation: Some(pb::Quat { x, y: 0.0, z: 0.0, w }) }
}

fn wrong_inserts() -> Vec<(pb::Edit, Refusal)> {
    let good = || shape(1, sphere(1.0), at(0.0, 0.0, 0.0));
    vec![
        (pb::Edit::default(), ("MISSING", "edits[0].op", &["insert"])),
        (insert(pb::Shape { id: 0, ..good() }), ("OUT_OF_LIMITS", "edits[0].insert.id", &["is 0"])),
        (insert(pb::Shape { geometry: None, ..good() }), ("MISSING", "edits[0].insert.geometry", &["sphere"])),
        (
            insert(pb::Shape { pose: Some(at(0.0, 2e12, 0.0)), ..good() }),
            ("OUT_OF_LIMITS", "edits[0].insert.pose.position.y", &["1e12"]),
        ),
        (
            insert(pb::Shape { pose: Some(turned(0.0, 0.0)), ..good() }),
            ("OUT_OF_LIMITS", "edits[0].insert.pose.rotation", &["any length but 0"]),
        ),
        (
            insert(pb::Shape { pose: Some(turned(f64::NAN, 1.0)), ..good() }),
            ("NOT_FINITE", "edits[0].insert.pose.rotation.x", &["is NaN"]),
        ),
        (
            insert(pb::Shape { velocity: Some(vec3(f64::INFINITY, 0.0, 0.0)), ..good() }),
            ("NOT_FINITE", "edits[0].insert.velocity.x", &["is inf"]),
        ),
        (
            insert(pb::Shape { mobility: 77, ..good() }),
            ("OUT_OF_LIMITS", "edits[0].insert.mobility", &["is 77", "MOBILITY_STATIC"]),
        ),
        (
            insert(pb::Shape { time_to_live: Some(prost_types::Duration::default()), ..good() }),
            ("NOT_YET", "edits[0].insert.time_to_live", &["remove the shape with an edit"]),
        ),
    ]
}

fn wrong_others() -> Vec<(pb::Edit, Refusal)> {
    let edit = |op| pb::Edit { op: Some(op) };
    let moves = |ids: &[u64], positions: &[f32]| pb::MoveColumns {
        ids: ids.to_vec(),
        poses: Some(pb::PoseColumns { positions: positions.to_vec(), ..pb::PoseColumns::default() }),
        ..pb::MoveColumns::default()
    };
    vec![
        (edit(Op::Move(pb::Move::default())), ("OUT_OF_LIMITS", "edits[0].move.id", &["is 0"])),
        (
            edit(Op::Move(pb::Move { id: 1, pose: Some(at(f64::NAN, 0.0, 0.0)), ..pb::Move::default() })),
            ("NOT_FINITE", "edits[0].move.pose.position.x", &["is NaN"]),
        ),
        (remove(&[3, 0]), ("OUT_OF_LIMITS", "edits[0].remove.ids[1]", &["is 0"])),
        (
            edit(Op::Inserts(pb::InsertColumns { ids: vec![1], ..pb::InsertColumns::default() })),
            ("MISSING", "edits[0].inserts.like", &["in common"]),
        ),
        (
            edit(Op::Moves(moves(&[1, 2], &[0.0; 5]))),
            ("COLUMN_LENGTH", "edits[0].moves.poses.positions", &["has 5 numbers", "6"]),
        ),
        (
            edit(Op::Moves(moves(&[1, 2], &[0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0]))),
            ("NOT_FINITE", "edits[0].moves.poses.positions[4]", &["is NaN"]),
        ),
        (
            edit(Op::Moves(pb::MoveColumns { ids: vec![1], velocities: vec![0.0; 2], ..pb::MoveColumns::default() })),
            ("COLUMN_LENGTH", "edits[0].moves.velocities", &["has 2 numbers"]),
        ),
        (edit(Op::Moves(moves(&vec![1; 65_537], &[0.0; 3]))), ("TOO_MANY_ITEMS", "edits", &["65537", "65536"])),
    ]
}

#[tokio::test]
async fn wrong_edits_are_refused_and_nothing_changes() {
    let mut bench = Bench::start().await;
    for (wrong, refusal) in wrong_inserts().into_iter().chain(wrong_others()) {
        let status = bench.edit(vec![wrong]).await.unwrap_err();
        assert_invalid(&status, refusal);
    }
    let description = bench.describe().await;
    assert_eq!((description.tick, description.shape_count, description.edit_count), (1, 0, 0));
}
