//! Height fields: asked, uploaded, described, read back.

use wire::v1::{self as pb, geometry::Kind, geometry_piece::Piece};

use crate::harness::{Bench, at, geometry, insert, shape, sphere, subject, vec3};

/// 4 × 4 cells of 2 m, the surface at 2 m, with a hole in one of them.
fn terrain() -> pb::HeightField {
    pb::HeightField { columns: 5, rows: 5, heights: vec![4.0; 25], spacing: Some(vec3(2.0, 0.5, 2.0)), holes: vec![10] }
}

async fn world() -> Bench {
    let mut bench = Bench::start().await;
    bench.edit(vec![insert(shape(1, geometry(Kind::HeightField(terrain())), at(0.0, 0.0, 0.0)))]).await.unwrap();
    bench
}

fn ray(origin: pb::Vec3, direction: pb::Vec3) -> pb::RaycastRequest {
    pb::RaycastRequest { origin: Some(origin), direction: Some(direction), ..pb::RaycastRequest::default() }
}

#[tokio::test]
async fn every_question_feels_the_surface_and_what_is_below() {
    let mut bench = world().await;
    let down = || vec3(0.0, -1.0, 0.0);
    let hit = bench.questions.raycast(ray(vec3(3.0, 9.0, 1.0), down())).await.unwrap().into_inner().hits.remove(0);
    assert_eq!((hit.distance, hit.feature.and_then(|feature| feature.face)), (Some(7.0), Some(1)));
    let through = bench.questions.raycast(ray(vec3(5.0, 9.0, 5.0), down())).await.unwrap().into_inner();
    assert_eq!(through.verdict(), pb::Verdict::Miss, "the hole");
    let inside = bench.questions.raycast(ray(vec3(3.0, 0.0, 1.0), down())).await.unwrap().into_inner().hits.remove(0);
    assert!(inside.inside && inside.distance == Some(0.0), "{inside:?}");
    let ball = |x: f64, y: f64, z: f64| Some(subject(sphere(0.5), at(x, y, z)));
    for (y, verdict) in
        [(2.75, pb::Verdict::Miss), (2.25, pb::Verdict::Hit), (-3.0, pb::Verdict::Hit), (-9.0, pb::Verdict::Miss)]
    {
        let request = pb::OverlapRequest { subject: ball(3.0, y, 1.0), ..pb::OverlapRequest::default() };
        assert_eq!(bench.questions.overlap(request).await.unwrap().into_inner().verdict(), verdict, "{y}");
    }
    let request = pb::DistanceRequest { subject: ball(3.0, 3.0, 1.0), ..pb::DistanceRequest::default() };
    let hit = bench.questions.distance(request).await.unwrap().into_inner().hits.remove(0);
    assert!((hit.distance.unwrap() - 0.5).abs() < 1e-6, "{hit:?}");
    let request = pb::PenetrationRequest { subject: ball(3.0, -1.0, 1.0), ..pb::PenetrationRequest::default() };
    let found = bench.questions.penetration(request).await.unwrap().into_inner().contacts.remove(0);
    assert!((found.depth.unwrap() - 3.5).abs() < 1e-9 && found.normal.unwrap().y > 0.999, "{found:?}");
    let falling = pb::TimeOfImpactRequest {
        subject: ball(3.0, 6.5, 1.0),
        end: Some(at(3.0, -1.5, 1.0)),
        ..pb::TimeOfImpactRequest::default()
    };
    let found = bench.questions.time_of_impact(falling).await.unwrap().into_inner();
    assert!((found.hits[0].fraction.unwrap() - 0.5).abs() < 1e-9, "{found:?}");
}

#[tokio::test]
async fn it_goes_up_and_comes_down_in_pieces_and_is_described() {
    let mut bench = world().await;
    let created =
        pb::CreateGeometryRequest { session: String::new(), geometry: Some(geometry(Kind::HeightField(terrain()))) };
    let created = bench.geometries.create_geometry(created).await.unwrap().into_inner().geometry.unwrap();
    assert_eq!((created.vertex_count, created.face_count, created.shape_count), (25, 15, 1));
    let bounds = created.bounds.unwrap();
    assert_eq!((bounds.max.unwrap(), bounds.min.unwrap()), (vec3(8.0, 2.0, 8.0), vec3(0.0, -6.0, 0.0)));
    let request = pb::GetShapeRequest { id: 1, ..pb::GetShapeRequest::default() };
    let read = bench.worlds.get_shape(request).await.unwrap().into_inner().shape.unwrap();
    assert_eq!(read.geometry.unwrap().kind, Some(Kind::GeometryId(created.geometry_id.clone())));
    let request = pb::DownloadGeometryRequest { geometry_id: created.geometry_id.clone(), ..Default::default() };
    let mut stream = bench.geometries.download_geometry(request).await.unwrap().into_inner();
    let mut pieces = Vec::new();
    while let Some(message) = stream.message().await.unwrap() {
        pieces.push(message.piece.and_then(|piece| piece.piece).expect("a piece"));
    }
    let Some(Piece::Header(header)) = pieces.first() else { panic!("a header") };
    assert_eq!((header.value_count, header.index_count), (25, 1));
    let again = pieces.into_iter().map(|piece| pb::UploadGeometryRequest {
        session: String::new(),
        piece: Some(pb::GeometryPiece { piece: Some(piece) }),
    });
    let again: Vec<_> = again.collect();
    let again = bench.geometries.upload_geometry(tokio_stream::iter(again)).await.unwrap().into_inner();
    assert_eq!(again.geometry.unwrap().geometry_id, created.geometry_id);
    let built = |world: &pb::DescribeWorldResponse| world.built.iter().any(|built| built.name == "height_pyramid");
    assert!(!built(&bench.describe().await), "nobody has asked yet");
    bench.questions.raycast(ray(vec3(3.0, 9.0, 1.0), vec3(0.0, -1.0, 0.0))).await.unwrap();
    assert!(built(&bench.describe().await));
}
