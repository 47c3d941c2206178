//! Characters over the wire: their defaults, what is wrong with them, and batches of them.

use wire::v1::{self as pb, answer::Answer as Kind, geometry::Kind as Form, question::Question as Asked};

use crate::harness::{
    Bench, Refusal, assert_invalid, at, cuboid, geometry, insert, shape, sphere, subject, subject_shape, vec3,
};

fn capsule() -> pb::Geometry {
    geometry(Form::Capsule(pb::Capsule { half_height: 0.5, radius: 0.4 }))
}

fn walk(x: f64, y: f64) -> pb::MoveCharacterRequest {
    pb::MoveCharacterRequest {
        subject: Some(subject(capsule(), at(0.0, 0.91, 0.0))),
        translation: Some(vec3(x, y, 0.0)),
        ..pb::MoveCharacterRequest::default()
    }
}

/// A floor at y = 0 with a wall at x = 3 and a step of 0.25 m before it, from x = 1.
async fn room() -> Bench {
    let mut bench = Bench::start().await;
    let shapes = vec![
        insert(shape(1, cuboid(20.0, 0.5, 20.0), at(0.0, -0.5, 0.0))),
        insert(shape(2, cuboid(0.5, 5.0, 5.0), at(3.5, 5.0, 0.0))),
        insert(shape(3, cuboid(1.0, 0.125, 5.0), at(2.0, 0.125, 0.0))),
    ];
    bench.edit(shapes).await.unwrap();
    bench
}

#[tokio::test]
async fn a_character_walks_up_a_step_to_a_wall_and_stands() {
    let mut bench = room().await;
    let request = pb::MoveCharacterRequest { step_height: 0.3, snap_distance: 0.1, ..walk(9.0, -0.5) };
    let moved = bench.questions.move_character(request.clone()).await.unwrap().into_inner();
    let position = moved.position.unwrap();
    assert!((position.x - 2.59).abs() < 2e-4 && (position.y - 1.16).abs() < 2e-4, "{position:?}");
    assert_eq!(moved.verdict(), pb::Verdict::Hit);
    assert_eq!(moved.ground.unwrap().id, 3);
    assert!(moved.hits.iter().any(|hit| hit.id == 2), "{:?}", moved.hits);
    assert_eq!(moved.info.unwrap().tick, 2);
    // Without a step height it stops before the step.
    let stopped = bench.questions.move_character(walk(9.0, -0.5)).await.unwrap().into_inner();
    assert!(stopped.position.unwrap().x < 1.0);
    assert_eq!(stopped.ground.unwrap().id, 1);
    // In a batch it is the same answer.
    let question = pb::Question { question: Some(Asked::MoveCharacter(Box::new(request.clone()))) };
    let batch = pb::BatchRequest { questions: vec![question], ..pb::BatchRequest::default() };
    let answers = bench.questions.batch(batch).await.unwrap().into_inner().answers;
    let Some(Kind::MoveCharacter(moved)) = &answers[0].answer else { panic!("{answers:?}") };
    assert_eq!(moved.position, Some(position));
}

#[tokio::test]
async fn a_shape_of_the_world_walks_from_where_it_is() {
    let mut bench = room().await;
    bench.edit(vec![insert(shape(7, capsule(), at(0.0, 0.91, 0.0)))]).await.unwrap();
    let request = pb::MoveCharacterRequest { subject: Some(subject_shape(7)), ..walk(-1.0, 0.0) };
    let moved = bench.questions.move_character(request).await.unwrap().into_inner();
    assert_eq!((moved.verdict(), moved.position), (pb::Verdict::Miss, Some(vec3(-1.0, 0.91, 0.0))));
}

#[tokio::test]
async fn a_wrong_character_is_told_what_is_wrong() {
    let mut bench = room().await;
    let open = geometry(Form::Mesh(pb::TriangleMesh {
        vertices: vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        indices: vec![0, 1, 2],
        ..pb::TriangleMesh::default()
    }));
    let of = |geometry| Some(subject(geometry, at(0.0, 5.0, 0.0)));
    let wrong: Vec<(pb::MoveCharacterRequest, Refusal)> = vec![
        (pb::MoveCharacterRequest { subject: None, ..walk(1.0, 0.0) }, ("MISSING", "subject", &["sphere"])),
        (
            pb::MoveCharacterRequest { subject: of(open), ..walk(1.0, 0.0) },
            ("BAD_GEOMETRY", "subject.geometry", &["not convex", "capsule"]),
        ),
        (pb::MoveCharacterRequest { skin: Some(-0.1), ..walk(1.0, 0.0) }, ("OUT_OF_LIMITS", "skin", &["-0.1"])),
        (
            pb::MoveCharacterRequest { skin: Some(1e9), subject: of(sphere(1e9)), ..walk(1.0, 0.0) },
            ("OUT_OF_LIMITS", "skin", &["1e9"]),
        ),
        (
            pb::MoveCharacterRequest { max_slope: Some(2.0), ..walk(1.0, 0.0) },
            ("OUT_OF_LIMITS", "max_slope", &["pi/2"]),
        ),
        (
            pb::MoveCharacterRequest { up: Some(vec3(0.0, 0.0, 0.0)), ..walk(1.0, 0.0) },
            ("OUT_OF_LIMITS", "up", &["any length but 0"]),
        ),
        (pb::MoveCharacterRequest { step_height: f64::NAN, ..walk(1.0, 0.0) }, ("NOT_FINITE", "step_height", &[])),
        (pb::MoveCharacterRequest { max_slides: 33, ..walk(1.0, 0.0) }, ("OUT_OF_LIMITS", "max_slides", &["1 to 32"])),
        (walk(f64::INFINITY, 0.0), ("NOT_FINITE", "translation.x", &["is inf"])),
    ];
    for (request, refusal) in wrong {
        assert_invalid(&bench.questions.move_character(request).await.unwrap_err(), refusal);
    }
}
