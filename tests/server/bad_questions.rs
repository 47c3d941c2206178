//! Input of every wrong kind: refused with the field, what was found and what would be right; and nothing changes.

use tonic::Code;
use wire::v1::{self as pb};

use crate::harness::{
    Bench, Refusal, assert_invalid, assert_refused, at, ray_along_z, sphere, subject, subject_shape, vec3,
};

fn wrong_rays_themselves() -> Vec<(pb::RaycastRequest, Refusal)> {
    let good = ray_along_z;
    vec![
        (pb::RaycastRequest::default(), ("MISSING", "direction", &["{\"z\": 1}"])),
        (
            pb::RaycastRequest { direction: Some(vec3(0.0, 0.0, 0.0)), ..good() },
            ("OUT_OF_LIMITS", "direction", &["any length but 0"]),
        ),
        (
            pb::RaycastRequest { direction: Some(vec3(0.0, f64::NAN, 0.0)), ..good() },
            ("NOT_FINITE", "direction.y", &["is NaN"]),
        ),
        (
            pb::RaycastRequest { origin: Some(vec3(0.0, 0.0, -2e12)), ..good() },
            ("OUT_OF_LIMITS", "origin.z", &["1e12"]),
        ),
        (pb::RaycastRequest { max_distance: Some(-1.0), ..good() }, ("OUT_OF_LIMITS", "max_distance", &["0 to 4e12"])),
        (
            pb::RaycastRequest { max_distance: Some(f64::INFINITY), ..good() },
            ("NOT_FINITE", "max_distance", &["is inf"]),
        ),
        (
            pb::RaycastRequest { max_distance: Some(1.0), min_distance: 2.0, ..good() },
            ("OUT_OF_LIMITS", "min_distance", &["above max_distance"]),
        ),
        (pb::RaycastRequest { mode: 9, ..good() }, ("OUT_OF_LIMITS", "mode", &["is 9", "HIT_MODE_ALL"])),
        (pb::RaycastRequest { faces: 7, ..good() }, ("OUT_OF_LIMITS", "faces", &["is 7", "RAY_FACES_BACK"])),
        (
            pb::RaycastRequest { mode: pb::HitMode::All.into(), max_hits: 10_001, ..good() },
            ("OUT_OF_LIMITS", "max_hits", &["1 to 10000"]),
        ),
    ]
}

fn wrong_options() -> Vec<(pb::RaycastRequest, Refusal)> {
    let with_options = |options| pb::RaycastRequest { options: Some(options), ..ray_along_z() };
    let exact =
        |accuracy| with_options(Box::new(pb::QueryOptions { accuracy: Some(accuracy), ..pb::QueryOptions::default() }));
    let filtered =
        |filter| with_options(Box::new(pb::QueryOptions { filter: Some(filter), ..pb::QueryOptions::default() }));
    let accuracy = pb::Accuracy::default;
    let filter = pb::Filter::default;
    vec![
        (exact(pb::Accuracy { tier: 9, ..accuracy() }), ("OUT_OF_LIMITS", "options.accuracy.tier", &["TIER_EXACT"])),
        (
            exact(pb::Accuracy { max_error: Some(-1.0), ..accuracy() }),
            ("OUT_OF_LIMITS", "options.accuracy.max_error", &["at least 0"]),
        ),
        (
            exact(pb::Accuracy { max_error_relative: Some(1.5), ..accuracy() }),
            ("OUT_OF_LIMITS", "options.accuracy.max_error_relative", &["0 to 1"]),
        ),
        (
            exact(pb::Accuracy { budget: Some(0), ..accuracy() }),
            ("OUT_OF_LIMITS", "options.accuracy.budget", &["1 to 65536"]),
        ),
        (
            filtered(pb::Filter { exclude_ids: vec![1; 1025], ..filter() }),
            ("TOO_MANY_ITEMS", "options.filter.exclude_ids", &["at most 1024"]),
        ),
        (
            filtered(pb::Filter { exclude_ids: vec![1, 0], ..filter() }),
            ("OUT_OF_LIMITS", "options.filter.exclude_ids[1]", &["is 0"]),
        ),
        (
            filtered(pb::Filter { exclude_groups: vec![1; 65], ..filter() }),
            ("TOO_MANY_ITEMS", "options.filter.exclude_groups", &["at most 64"]),
        ),
    ]
}

#[tokio::test]
async fn wrong_rays_are_refused() {
    let mut bench = Bench::start().await;
    for (wrong, refusal) in wrong_rays_themselves().into_iter().chain(wrong_options()) {
        let status = bench.questions.raycast(wrong).await.unwrap_err();
        assert_invalid(&status, refusal);
    }
    assert_eq!(bench.describe().await.question_count, 0);
}

#[tokio::test]
async fn wrong_questions_about_subjects_are_refused() {
    let mut bench = Bench::start().await;
    let status = bench.questions.overlap(pb::OverlapRequest::default()).await.unwrap_err();
    assert_invalid(&status, ("MISSING", "subject", &["geometry"]));
    let nobody = pb::OverlapRequest { subject: Some(subject_shape(0)), ..pb::OverlapRequest::default() };
    let status = bench.questions.overlap(nobody).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "subject.id", &["is 0"]));
    let many =
        pb::OverlapRequest { subject: Some(pb::Subject::default()), max_hits: 65_537, ..pb::OverlapRequest::default() };
    let status = bench.questions.overlap(many).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "max_hits", &["1 to 65536"]));
    let gap = pb::PenetrationRequest {
        subject: Some(pb::Subject::default()),
        max_gap: -1.0,
        ..pb::PenetrationRequest::default()
    };
    let status = bench.questions.penetration(gap).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "max_gap", &["is -1"]));
    let far = pb::DistanceRequest {
        subject: Some(pb::Subject::default()),
        max_distance: Some(5e12),
        ..pb::DistanceRequest::default()
    };
    let status = bench.questions.distance(far).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "max_distance", &["4e12"]));
    let against = pb::DistanceRequest {
        subject: Some(pb::Subject::default()),
        against: Some(Box::new(subject(sphere(0.0), at(0.0, 0.0, 0.0)))),
        ..pb::DistanceRequest::default()
    };
    let status = bench.questions.distance(against).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "against.geometry.sphere.radius", &["is 0"]));
}

#[tokio::test]
async fn wrong_motions_are_refused() {
    let mut bench = Bench::start().await;
    let good = || pb::TimeOfImpactRequest {
        subject: Some(subject(sphere(1.0), at(0.0, 0.0, 0.0))),
        end: Some(at(0.0, 0.0, 9.0)),
        ..pb::TimeOfImpactRequest::default()
    };
    let nowhere = pb::Quat { x: 0.0, y: 0.0, z: 0.0, w: 0.0 };
    let turned = pb::Pose { position: None, rotation: Some(nowhere) };
    let request = pb::TimeOfImpactRequest { end: Some(turned), ..good() };
    let status = bench.questions.time_of_impact(request).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "end.rotation", &["any length but 0"]));
    let request = pb::TimeOfImpactRequest { against_end: Some(at(0.0, 0.0, 0.0)), ..good() };
    let status = bench.questions.time_of_impact(request).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "against_end", &["with against only"]));
    let request = pb::TimeOfImpactRequest { subject: Some(subject_shape(4)), ..good() };
    let status = bench.questions.time_of_impact(request).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SHAPE_NOT_FOUND", "subject.id", &["is 4"]);
}

#[tokio::test]
async fn other_wrong_requests_are_refused() {
    let mut bench = Bench::start().await;
    let status = bench.worlds.get_shape(pb::GetShapeRequest::default()).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "id", &["is 0"]));
    let page = pb::ListShapesRequest { page_size: 10_001, ..pb::ListShapesRequest::default() };
    let status = bench.worlds.list_shapes(page).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "page_size", &["1 to 10000"]));
    let bounds = pb::ListShapesRequest {
        bounds: Some(pb::Aabb { min: Some(vec3(0.0, 1.0, 0.0)), max: Some(vec3(0.0, 0.0, 0.0)) }),
        ..pb::ListShapesRequest::default()
    };
    let status = bench.worlds.list_shapes(bounds).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "bounds.max.y", &["below that of min"]));
    let batch = pb::BatchRequest { questions: vec![pb::Question::default(); 65_537], ..pb::BatchRequest::default() };
    let status = bench.questions.batch(batch).await.unwrap_err();
    assert_invalid(&status, ("TOO_MANY_ITEMS", "questions", &["at most 65536"]));
    let edit = pb::EditRequest { request_id: "x".repeat(129), ..pb::EditRequest::default() };
    let status = bench.worlds.edit(edit).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "request_id", &["128"]));
    let session = pb::GetSessionRequest { session: "nowhere".to_owned() };
    let status = bench.sessions.get_session(session).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SESSION_NOT_FOUND", "session", &["\"nowhere\""]);
}
