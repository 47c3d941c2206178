//! Ways out over the wire: where they end, what is left, what is wrong with them, and batches of them.

use wire::v1::{self as pb, answer::Answer as Kind, question::Question as Asked};

use crate::harness::{
    Bench, Refusal, assert_invalid, assert_refused, at, cuboid, insert, shape, sphere, subject, subject_shape, vec3,
};

/// A floor up to y = 0 and a wall from x = 3 on.
async fn room() -> Bench {
    let mut bench = Bench::start().await;
    let floor = insert(shape(1, cuboid(20.0, 0.5, 20.0), at(0.0, -0.5, 0.0)));
    let wall = insert(shape(2, cuboid(0.5, 5.0, 5.0), at(3.5, 5.0, 0.0)));
    bench.edit(vec![floor, wall]).await.unwrap();
    bench
}

fn crate_at(x: f64, y: f64) -> pb::DepenetrateRequest {
    pb::DepenetrateRequest {
        subject: Some(subject(cuboid(1.0, 1.0, 1.0), at(x, y, 0.0))),
        ..pb::DepenetrateRequest::default()
    }
}

fn is_near(found: Option<pb::Vec3>, x: f64, y: f64) -> bool {
    let found = found.unwrap();
    (found.x - x).abs() < 1e-9 && (found.y - y).abs() < 1e-9 && found.z.abs() < 1e-9
}

#[tokio::test]
async fn a_crate_is_moved_out_of_the_floor_and_the_wall() {
    let mut bench = room().await;
    let out = bench.questions.depenetrate(crate_at(2.5, 0.75)).await.unwrap().into_inner();
    assert!(is_near(out.position, 2.0, 1.0) && is_near(out.translation, -0.5, 0.25), "{out:?}");
    assert_eq!((out.verdict(), out.ids.as_slice(), out.passes), (pb::Verdict::Miss, &[1, 2][..], 1));
    assert!(out.depth.unwrap().upper() <= 0.0 && out.contacts.is_empty());
    assert_eq!(out.info.unwrap().tick, 2);
    // Asked again from there, nothing is left to do.
    let again = pb::DepenetrateRequest {
        subject: Some(subject(cuboid(1.0, 1.0, 1.0), pb::Pose { position: out.position, rotation: None })),
        ..crate_at(0.0, 0.0)
    };
    let again = bench.questions.depenetrate(again).await.unwrap().into_inner();
    assert_eq!((again.translation, again.passes, again.verdict()), (Some(vec3(0.0, 0.0, 0.0)), 0, pb::Verdict::Miss));
    let apart = pb::DepenetrateRequest { gap: 0.125, against: Some(Box::new(subject_shape(1))), ..crate_at(2.5, 0.75) };
    let apart = bench.questions.depenetrate(apart).await.unwrap().into_inner();
    assert!(is_near(apart.position, 2.5, 1.125), "{apart:?}");
    let held = pb::DepenetrateRequest { max_distance: Some(0.125), ..crate_at(0.0, 0.75) };
    let held = bench.questions.depenetrate(held).await.unwrap().into_inner();
    assert_eq!((held.verdict(), held.contacts.len()), (pb::Verdict::Hit, 1));
    assert!(held.depth.unwrap().lower() > 0.2);
}

#[tokio::test]
async fn a_shape_of_the_world_is_asked_in_a_batch_and_stays_where_it_is() {
    let mut bench = room().await;
    bench.edit(vec![insert(shape(7, sphere(1.0), at(0.0, 0.5, 0.0)))]).await.unwrap();
    let request = pb::DepenetrateRequest { subject: Some(subject_shape(7)), ..pb::DepenetrateRequest::default() };
    let out = bench.questions.depenetrate(request.clone()).await.unwrap().into_inner();
    assert!(is_near(out.position, 0.0, 1.0), "{out:?}");
    let question = pb::Question { question: Some(Asked::Depenetrate(Box::new(request))) };
    let batch = pb::BatchRequest { questions: vec![question], ..pb::BatchRequest::default() };
    let answers = bench.questions.batch(batch).await.unwrap().into_inner().answers;
    let Some(Kind::Depenetrate(same)) = &answers[0].answer else { panic!("{answers:?}") };
    assert_eq!((same.position, same.depth), (out.position, out.depth));
    let walk = pb::MoveCharacterRequest {
        subject: Some(subject_shape(7)),
        translation: Some(vec3(-1.0, 0.0, 0.0)),
        max_push: 1.0,
        ..pb::MoveCharacterRequest::default()
    };
    let moved = bench.questions.move_character(walk).await.unwrap().into_inner();
    assert!(is_near(moved.pushed, 0.0, 0.5) && is_near(moved.position, -1.0, 1.0), "{moved:?}");
}

#[tokio::test]
async fn wrong_questions_are_told_what_is_wrong() {
    let mut bench = room().await;
    let wrong: Vec<(pb::DepenetrateRequest, Refusal)> = vec![
        (pb::DepenetrateRequest::default(), ("MISSING", "subject", &["sphere"])),
        (pb::DepenetrateRequest { gap: -1.0, ..crate_at(0.0, 0.0) }, ("OUT_OF_LIMITS", "gap", &["-1"])),
        (
            pb::DepenetrateRequest { max_distance: Some(f64::NAN), ..crate_at(0.0, 0.0) },
            ("NOT_FINITE", "max_distance", &["NaN"]),
        ),
        (pb::DepenetrateRequest { passes: 65, ..crate_at(0.0, 0.0) }, ("OUT_OF_LIMITS", "passes", &["1 to 64"])),
    ];
    for (request, refusal) in wrong {
        assert_invalid(&bench.questions.depenetrate(request).await.unwrap_err(), refusal);
    }
    let gone = pb::DepenetrateRequest { against: Some(Box::new(subject_shape(9))), ..crate_at(0.0, 0.0) };
    let status = bench.questions.depenetrate(gone).await.unwrap_err();
    assert_refused(&status, tonic::Code::NotFound, "SHAPE_NOT_FOUND", "against.id", &["9"]);
}
