//! Every kind of form as a shape of a world: asked, read back, rounded, refused as a subject.

use tonic::Code;
use wire::v1::{self as pb, geometry::Kind};

use crate::harness::{
    Bench, assert_refused, at, cuboid, geometry, insert, shape, sphere, subject, subject_shape, vec3,
};

/// What stands at the origin, and how high it reaches above it along y.
fn forms() -> Vec<(pb::Geometry, f64)> {
    let cylinder = pb::Cylinder { half_height: 2.0, radius: 1.0 };
    let cone = pb::Cone { half_height: 2.0, radius: 1.0 };
    let ellipsoid = pb::Ellipsoid { radii: Some(vec3(1.0, 2.0, 3.0)) };
    let half_space = pb::HalfSpace { normal: Some(vec3(0.0, 5.0, 0.0)), offset: 2.0 };
    vec![
        (geometry(Kind::Cylinder(cylinder)), 2.0),
        (geometry(Kind::Cone(cone)), 2.0),
        (geometry(Kind::Ellipsoid(ellipsoid)), 2.0),
        (geometry(Kind::HalfSpace(half_space)), 2.0),
    ]
}

/// A bound around `truth` no wider than `width`.
#[track_caller]
fn assert_holds(certificate: Option<&pb::Certificate>, truth: f64, width: f64) {
    let bound = certificate.and_then(|certificate| certificate.interval).expect("a bound");
    let (lower, upper) = (bound.lower.expect("a lower side"), bound.upper.expect("an upper side"));
    assert!(lower <= truth && truth <= upper && upper - lower <= width, "{truth} in {bound:?}");
}

async fn world_of(form: pb::Geometry) -> Bench {
    let mut bench = Bench::start().await;
    bench.edit(vec![insert(shape(1, form, at(0.0, 0.0, 0.0)))]).await.unwrap();
    bench
}

async fn ask_from_above(bench: &mut Bench, top: f64) {
    let down = pb::RaycastRequest {
        origin: Some(vec3(0.0, 9.0, 0.0)),
        direction: Some(vec3(0.0, -1.0, 0.0)),
        ..pb::RaycastRequest::default()
    };
    let answer = bench.questions.raycast(down).await.unwrap().into_inner();
    assert_eq!(answer.hits[0].id, 1);
    assert_holds(answer.hits[0].certificate.as_ref(), 9.0 - top, 9.0);
    let ball = |y: f64| Some(subject(sphere(0.5), at(0.0, y, 0.0)));
    let request = pb::DistanceRequest { subject: ball(top + 2.0), ..pb::DistanceRequest::default() };
    let answer = bench.questions.distance(request).await.unwrap().into_inner();
    assert_holds(answer.hits[0].certificate.as_ref(), 1.5, 1e-5);
    for (height, verdict) in [(0.25, pb::Verdict::Hit), (0.75, pb::Verdict::Miss)] {
        let request = pb::OverlapRequest { subject: ball(top + height), ..pb::OverlapRequest::default() };
        assert_eq!(bench.questions.overlap(request).await.unwrap().into_inner().verdict(), verdict);
    }
    let request = pb::PenetrationRequest { subject: ball(top + 0.25), ..pb::PenetrationRequest::default() };
    let answer = bench.questions.penetration(request).await.unwrap().into_inner();
    assert_eq!(answer.verdict(), pb::Verdict::Hit);
    assert!((1..=4).contains(&answer.contacts[0].points.len()));
}

#[tokio::test]
async fn round_forms_and_half_spaces_answer_every_question() {
    for (form, top) in forms() {
        let mut bench = world_of(form.clone()).await;
        ask_from_above(&mut bench, top).await;
        let request = pb::TimeOfImpactRequest {
            subject: Some(subject(cuboid(0.5, 0.5, 0.5), at(0.0, top + 4.5, 0.0))),
            end: Some(at(0.0, top - 3.5, 0.0)),
            ..pb::TimeOfImpactRequest::default()
        };
        let answer = bench.questions.time_of_impact(request).await.unwrap().into_inner();
        assert_eq!(answer.verdict(), pb::Verdict::Hit, "{form:?}");
        assert_holds(answer.hits[0].certificate.as_ref(), 0.5, 0.6);
        // Rounded and scaled: (2 + 0.25) * 2 metres high.
        let dressed = pb::Geometry { rounding: 0.25, scale: Some(2.0), ..form };
        ask_from_above(&mut world_of(dressed).await, 4.5).await;
    }
}

#[tokio::test]
async fn they_are_read_back_as_they_were_sent() {
    for (form, _) in forms() {
        let mut bench = world_of(form.clone()).await;
        let request = pb::GetShapeRequest { id: 1, ..pb::GetShapeRequest::default() };
        let read = bench.worlds.get_shape(request).await.unwrap().into_inner();
        assert_eq!(read.shape.and_then(|shape| shape.geometry).as_ref(), Some(&form));
        let rounded = pb::Geometry { rounding: 0.5, ..form.clone() };
        let mut bench = world_of(rounded.clone()).await;
        let request = pb::GetShapeRequest { id: 1, ..pb::GetShapeRequest::default() };
        let read = bench.worlds.get_shape(request).await.unwrap().into_inner().shape.and_then(|shape| shape.geometry);
        let expected = match form.kind {
            // The plane itself has moved.
            Some(Kind::HalfSpace(space)) => geometry(Kind::HalfSpace(pb::HalfSpace { offset: 2.5, ..space })),
            _ => rounded,
        };
        assert_eq!(read, Some(expected));
        let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(form) };
        let info = bench.geometries.create_geometry(request).await.unwrap().into_inner().geometry.unwrap();
        assert_eq!((info.state(), info.vertex_count, info.face_count), (pb::GeometryState::Ready, 0, 0));
        assert!(info.bounds.and_then(|bounds| bounds.max).is_some_and(|max| max.y >= 2.0 && max.y < 2.1));
    }
}

#[tokio::test]
async fn a_half_space_is_asked_against_but_never_the_subject() {
    let floor = || geometry(Kind::HalfSpace(pb::HalfSpace { normal: None, offset: -1.0 }));
    let mut bench = world_of(floor()).await;
    let request = pb::DistanceRequest {
        subject: Some(subject(sphere(0.5), at(0.0, 3.0, 0.0))),
        against: Some(Box::new(subject(floor(), at(0.0, -1.0, 0.0)))),
        ..pb::DistanceRequest::default()
    };
    let answer = bench.questions.distance(request).await.unwrap().into_inner();
    assert_eq!(answer.hits[0].distance, Some(4.5), "without a normal it is +y");
    let overlap = |subject| pb::OverlapRequest { subject: Some(subject), ..pb::OverlapRequest::default() };
    let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(floor()) };
    let info = bench.geometries.create_geometry(request).await.unwrap().into_inner().geometry.unwrap();
    let cases = [
        (subject(floor(), at(0.0, 0.0, 0.0)), "subject.geometry.half_space"),
        (subject(geometry(Kind::GeometryId(info.geometry_id)), at(0.0, 0.0, 0.0)), "subject.geometry.geometry_id"),
        (subject_shape(1), "subject.id"),
    ];
    for (subject, field) in cases {
        let status = bench.questions.overlap(overlap(subject)).await.unwrap_err();
        assert_refused(&status, Code::InvalidArgument, "BAD_GEOMETRY", field, &["is a half space", "against"]);
    }
}
