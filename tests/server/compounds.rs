//! Compounds: what is asked of them, read back, told about them, and which part is wrong.

use tonic::Code;
use wire::v1::{self as pb, geometry::Kind};

use crate::harness::{Bench, assert_refused, at, cuboid, geometry, insert, shape, sphere, subject, vec3};

fn part(form: pb::Geometry, pose: pb::Pose) -> pb::CompoundPart {
    pb::CompoundPart { geometry: Some(form), pose: Some(pose) }
}

fn compound(parts: Vec<pb::CompoundPart>) -> pb::Geometry {
    geometry(Kind::Compound(pb::Compound { parts }))
}

/// A plate at y = −1 to +1 with a ball on each side, the second of which is in a compound of its own.
fn table() -> pb::Geometry {
    let leg = compound(vec![part(sphere(1.0), at(0.0, 1.0, 0.0))]);
    compound(vec![
        part(cuboid(4.0, 1.0, 4.0), at(0.0, 0.0, 0.0)),
        part(sphere(1.0), at(-3.0, 2.0, 0.0)),
        part(leg, at(3.0, 1.0, 0.0)),
    ])
}

fn down(x: f64) -> pb::RaycastRequest {
    pb::RaycastRequest {
        origin: Some(vec3(x, 9.0, 0.0)),
        direction: Some(vec3(0.0, -1.0, 0.0)),
        ..pb::RaycastRequest::default()
    }
}

#[tokio::test]
async fn every_question_names_the_part() {
    let mut bench = Bench::start().await;
    bench.edit(vec![insert(shape(1, table(), at(0.0, 0.0, 0.0)))]).await.unwrap();
    for (x, leaf, distance) in [(0.0, 0, 8.0), (-3.0, 1, 6.0), (3.0, 2, 6.0)] {
        let hit = bench.questions.raycast(down(x)).await.unwrap().into_inner().hits.remove(0);
        assert_eq!(hit.feature.and_then(|feature| feature.part), Some(leaf));
        assert!((hit.distance.unwrap() - distance).abs() < 1e-9, "{hit:?}");
        let ball = |y: f64| Some(subject(sphere(0.5), at(x, y, 0.0)));
        let apart = pb::DistanceRequest { subject: ball(10.0 - distance), ..pb::DistanceRequest::default() };
        let hit = bench.questions.distance(apart).await.unwrap().into_inner().hits.remove(0);
        assert!((hit.distance.unwrap() - 0.5).abs() < 1e-5, "{hit:?}");
        let touching = pb::PenetrationRequest { subject: ball(9.25 - distance), ..pb::PenetrationRequest::default() };
        let found = bench.questions.penetration(touching).await.unwrap().into_inner();
        assert_eq!(found.contacts[0].feature.and_then(|feature| feature.part), Some(leaf), "{found:?}");
        let falling = pb::TimeOfImpactRequest {
            subject: ball(9.0),
            end: Some(at(x, -1.0, 0.0)),
            ..pb::TimeOfImpactRequest::default()
        };
        let found = bench.questions.time_of_impact(falling).await.unwrap().into_inner();
        assert!((found.hits[0].fraction.unwrap() - (distance - 0.5) / 10.0).abs() < 1e-9, "{found:?}");
    }
    // As a subject, against a half space and against itself.
    let floor = pb::HalfSpace { normal: None, offset: 0.0 };
    let request = pb::DistanceRequest {
        subject: Some(subject(table(), at(0.0, 3.0, 0.0))),
        against: Some(Box::new(subject(geometry(Kind::HalfSpace(floor)), at(0.0, 0.0, 0.0)))),
        ..pb::DistanceRequest::default()
    };
    let found = bench.questions.distance(request).await.unwrap().into_inner();
    assert!((found.hits[0].distance.unwrap() - 2.0).abs() < 1e-5, "{found:?}");
    let request =
        pb::OverlapRequest { subject: Some(subject(table(), at(0.0, 4.5, 0.0))), ..pb::OverlapRequest::default() };
    assert_eq!(bench.questions.overlap(request).await.unwrap().into_inner().verdict(), pb::Verdict::Miss);
}

#[tokio::test]
async fn it_is_registered_described_and_read_back_by_its_id() {
    let mut bench = Bench::start().await;
    let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(table()) };
    let info = bench.geometries.create_geometry(request).await.unwrap().into_inner().geometry.unwrap();
    assert_eq!(info.state(), pb::GeometryState::Ready);
    assert_eq!((info.vertex_count, info.face_count), (10, 0));
    let bounds = info.bounds.unwrap();
    assert!((bounds.max.unwrap().y - 3.0).abs() < 1e-9 && (bounds.min.unwrap().x + 4.0).abs() < 1e-9);
    bench.edit(vec![insert(shape(1, table(), at(0.0, 0.0, 0.0)))]).await.unwrap();
    let request = pb::GetShapeRequest { id: 1, ..pb::GetShapeRequest::default() };
    let read = bench.worlds.get_shape(request).await.unwrap().into_inner().shape.unwrap();
    assert_eq!(read.geometry.unwrap().kind, Some(Kind::GeometryId(info.geometry_id.clone())));
    let built = |world: &pb::DescribeWorldResponse| world.built.iter().any(|built| built.name == "compound_tree");
    assert!(!built(&bench.describe().await), "nobody has asked yet");
    bench.questions.raycast(down(0.0)).await.unwrap();
    assert!(built(&bench.describe().await));
    // Registered ones can be parts, and a scale is for all of it.
    let named = geometry(Kind::GeometryId(info.geometry_id));
    let twice = pb::Geometry { scale: Some(2.0), ..compound(vec![part(named, at(0.0, 0.0, 0.0))]) };
    bench.edit(vec![insert(shape(2, twice, at(100.0, 0.0, 0.0)))]).await.unwrap();
    let hit = bench.questions.raycast(down(106.0)).await.unwrap().into_inner().hits.remove(0);
    assert_eq!((hit.id, hit.feature.and_then(|feature| feature.part)), (2, Some(2)));
    assert!((hit.distance.unwrap() - 3.0).abs() < 1e-9, "{hit:?}");
}

#[tokio::test]
async fn refusals_say_which_part_of_which_part() {
    let mut bench = Bench::start().await;
    let here = || at(0.0, 0.0, 0.0);
    let half_space = geometry(Kind::HalfSpace(pb::HalfSpace::default()));
    let nested = |form: pb::Geometry| compound(vec![part(sphere(1.0), here()), part(form, here())]);
    let mut deep = sphere(1.0);
    for _ in 0..5 {
        deep = compound(vec![part(deep, here())]);
    }
    let inner = "geometry.compound.parts[0]";
    let too_deep = format!("{}.geometry.compound.parts", [inner; 4].join("."));
    let cases = [
        (compound(vec![]), "BAD_GEOMETRY", "geometry.compound.parts", "is empty"),
        (nested(half_space), "BAD_GEOMETRY", "geometry.compound.parts[1].geometry", "half space"),
        (nested(sphere(-1.0)), "OUT_OF_LIMITS", "geometry.compound.parts[1].geometry.sphere.radius", "-1"),
        (
            nested(nested(sphere(0.0))),
            "OUT_OF_LIMITS",
            "geometry.compound.parts[1].geometry.compound.parts[1].geometry.sphere.radius",
            "is 0",
        ),
        (
            compound(vec![part(sphere(1.0), at(f64::NAN, 0.0, 0.0))]),
            "NOT_FINITE",
            "geometry.compound.parts[0].pose.position.x",
            "NaN",
        ),
        (compound(vec![pb::CompoundPart::default()]), "MISSING", "geometry.compound.parts[0].geometry", "needs a form"),
        (deep, "BAD_GEOMETRY", too_deep.as_str(), "4 deep"),
        (pb::Geometry { rounding: 0.5, ..nested(sphere(1.0)) }, "BAD_GEOMETRY", "geometry.rounding", "compound"),
    ];
    for (wrong, reason, field, part) in cases {
        let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(wrong) };
        let status = bench.geometries.create_geometry(request).await.unwrap_err();
        assert_refused(&status, Code::InvalidArgument, reason, field, &[part]);
    }
}
