//! A replay holds all that an answer depends on: asked again without its server, it answers the same, byte for byte.

use calipers::replay::{ask_again, bare, info_of};
use prost::Message;
use tonic::Code;
use wire::v1::{self as pb, answer::Answer as Kind, geometry::Kind as Form, question::Question as Asked, read_at::At};

use crate::{
    explain::{ask, options_of, questions},
    harness::{
        Bench, assert_refused, at, cuboid, geometry, insert, move_to, shape, sphere, subject, subject_shape, vec3,
    },
};

/// Every kind of geometry, some of them scaled to numbers that single precision does not hold, within reach of the questions,
/// and twenty balls that are not.
pub(crate) async fn zoo() -> Bench {
    let mut bench = Bench::start().await;
    let corners = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let hull = geometry(Form::Hull(pb::ConvexHull { points: corners.clone() }));
    let indices = vec![0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    let mesh = pb::TriangleMesh { vertices: corners, indices, mode: pb::MeshMode::Solid.into(), ..Default::default() };
    let decomposed = pb::TriangleMesh {
        decompose: Some(pb::Decompose { max_parts: 2, max_error: 0.0, max_steps: 0 }),
        ..mesh.clone()
    };
    let mut ids = Vec::new();
    for form in [hull, geometry(Form::Mesh(mesh)), geometry(Form::Mesh(decomposed))] {
        let request = pb::CreateGeometryRequest { geometry: Some(form), ..pb::CreateGeometryRequest::default() };
        let info = bench.geometries.create_geometry(request).await.unwrap().into_inner().geometry.unwrap();
        let request =
            pb::GetGeometryRequest { geometry_id: info.geometry_id.clone(), wait: true, ..Default::default() };
        let info = bench.geometries.get_geometry(request).await.unwrap().into_inner().geometry.unwrap();
        assert_eq!(info.state(), pb::GeometryState::Ready, "{info:?}");
        ids.push(info.geometry_id);
    }
    let named = |number: usize, scale: f64| pb::Geometry {
        kind: Some(Form::GeometryId(ids[number].clone())),
        scale: Some(scale),
        ..pb::Geometry::default()
    };
    let rounded = pb::Geometry { rounding: 0.1, ..named(0, 0.7) };
    let part = |form: pb::Geometry, x: f64| pb::CompoundPart { geometry: Some(form), pose: Some(at(x, 0.1, 0.0)) };
    let inner = geometry(Form::Compound(pb::Compound { parts: vec![part(rounded, 0.2), part(sphere(0.3), 0.0)] }));
    let parts = vec![part(named(1, 0.9), 0.0), part(inner, 0.5), part(named(0, 1.0), -0.3)];
    let compound = geometry(Form::Compound(pb::Compound { parts }));
    let field = pb::HeightField {
        columns: 3,
        rows: 2,
        spacing: Some(vec3(20.0, 1.0, 20.0)),
        heights: vec![0.1; 6],
        ..Default::default()
    };
    let field = pb::Geometry { scale: Some(1.1), ..geometry(Form::HeightField(field)) };
    let mut edits = vec![
        insert(shape(1, named(0, 1.1), at(4.0, -0.1, 0.0))),
        insert(shape(2, named(1, 1.0), at(5.1, 0.0, 0.0))),
        insert(shape(3, named(1, 1.3), at(6.0, 0.2, 0.1))),
        insert(pb::Shape { group: 3, user_data: 7, ..shape(4, compound, at(5.5, -0.3, 0.2)) }),
        insert(pb::Shape { mobility: pb::Mobility::Static.into(), ..shape(5, field, at(-8.0, -1.3, -8.0)) }),
        insert(shape(6, named(2, 1.0), at(3.4, 0.0, 0.0))),
        insert(shape(7, geometry(Form::HalfSpace(pb::HalfSpace { normal: None, offset: -1.5 })), at(0.0, 0.0, 0.0))),
        insert(shape(8, cuboid(0.3, 0.3, 0.3), at(2.0, 0.2, 0.0))),
    ];
    edits.extend((100..120).map(|id| insert(shape(id, sphere(1.0), at(id as f64, 900.0, 0.0)))));
    bench.edit(edits).await.unwrap();
    bench
}

pub(crate) async fn explain(bench: &mut Bench, asked: Asked) -> pb::Replay {
    let question = Some(pb::Question { question: Some(asked) });
    let request = pb::ExplainRequest { question, ..pb::ExplainRequest::default() };
    bench.worlds.explain(request).await.unwrap().into_inner().replay.unwrap()
}

/// Asks again what went through bytes, and checks that the answer is the same.
pub(crate) fn asked_again(replay: &pb::Replay) -> pb::Answer {
    let kept = pb::Replay::decode(replay.encode_to_vec().as_slice()).unwrap();
    let again = ask_again(&kept).unwrap();
    let then = bare(kept.answer.clone().unwrap());
    assert_eq!(bare(again.clone()).encode_to_vec(), then.encode_to_vec(), "{:?}", kept.question);
    again
}

#[tokio::test]
async fn all_questions_come_out_the_same_without_the_server() {
    let mut bench = zoo().await;
    for asked in questions() {
        let plain = ask(&mut bench, asked.clone()).await;
        let replay = explain(&mut bench, asked.clone()).await;
        let told = bare(replay.answer.clone().unwrap());
        assert_eq!(told, bare(pb::Answer { answer: Some(plain) }), "explaining changes no answer");
        let is_about_all = matches!(asked, Asked::Pairs(_));
        assert!(!replay.shapes.is_empty() && (replay.shapes.len() <= 8 || is_about_all), "{:?}", replay.shapes);
        assert_eq!((replay.tick, replay.shapes_left_out, replay.format), (2, 0, 1));
        let again = asked_again(&replay);
        assert!(!info_of(&again).unwrap().pairs.is_empty());
    }
    // Of shapes of the world, which see neither themselves nor what their masks leave out.
    for id in [1, 3, 4, 6, 8] {
        let subject = Some(subject_shape(id));
        let overlap = pb::OverlapRequest { subject: subject.clone(), ..pb::OverlapRequest::default() };
        let replay = explain(&mut bench, Asked::Overlap(Box::new(overlap))).await;
        assert!(replay.shapes.iter().any(|shape| shape.id == id));
        asked_again(&replay);
        let distance = pb::DistanceRequest { subject, max_hits: 9, ..pb::DistanceRequest::default() };
        asked_again(&explain(&mut bench, Asked::Distance(Box::new(distance))).await);
    }
    let against = pb::DistanceRequest {
        subject: Some(subject_shape(4)),
        against: Some(Box::new(subject_shape(100))),
        ..pb::DistanceRequest::default()
    };
    let replay = explain(&mut bench, Asked::Distance(Box::new(against))).await;
    assert_eq!(replay.shapes.iter().map(|shape| shape.id).collect::<Vec<_>>(), [4, 100]);
    asked_again(&replay);
}

/// A geometry that only the question names is kept too, and so is a moment between two ticks.
#[tokio::test]
async fn what_the_question_names_and_when_it_was_asked_is_kept() {
    let mut bench = zoo().await;
    let infos = bench.geometries.list_geometries(pb::ListGeometriesRequest::default()).await.unwrap().into_inner();
    bench.edit(vec![move_to(1, at(40.0, 0.0, 0.0)), move_to(3, at(5.0, 0.0, 0.0))]).await.unwrap();
    for info in infos.geometries {
        let by_id = pb::Geometry { scale: Some(0.3), ..geometry(Form::GeometryId(info.geometry_id)) };
        for fraction in [0.0, 0.375] {
            let mut asked = Asked::Distance(Box::new(pb::DistanceRequest {
                subject: Some(subject(by_id.clone(), at(5.0, 0.7, 0.0))),
                max_hits: 4,
                ..pb::DistanceRequest::default()
            }));
            let read_at = pb::ReadAt { at: Some(At::Tick(2)), tick_fraction: fraction };
            *options_of(&mut asked) = Some(Box::new(pb::QueryOptions { read_at: Some(read_at), ..Default::default() }));
            let replay = explain(&mut bench, asked).await;
            assert_eq!((replay.tick, replay.tick_fraction), (2, fraction));
            asked_again(&replay);
        }
    }
}

#[tokio::test]
async fn a_question_without_an_answer_is_kept_with_the_reason() {
    let mut bench = zoo().await;
    let deep = pb::PenetrationRequest { subject: Some(subject_shape(2)), ..pb::PenetrationRequest::default() };
    let gone = pb::OverlapRequest { subject: Some(subject_shape(77)), ..pb::OverlapRequest::default() };
    let wrong = pb::RaycastRequest::default();
    for (asked, reason) in [
        (Asked::Penetration(Box::new(deep)), "NEEDS_DECOMPOSITION"),
        (Asked::Overlap(Box::new(gone)), "SHAPE_NOT_FOUND"),
        (Asked::Raycast(wrong), "MISSING"),
    ] {
        let replay = explain(&mut bench, asked).await;
        let Some(Kind::Problem(problem)) = &replay.answer.as_ref().unwrap().answer else { panic!("{replay:?}") };
        assert_eq!(problem.reason, reason);
        asked_again(&replay);
    }
}

/// Were it otherwise, the check would say nothing.
#[tokio::test]
async fn a_replay_whose_world_is_another_answers_otherwise() {
    let mut bench = zoo().await;
    let ray = pb::RaycastRequest {
        origin: Some(vec3(2.0, 9.0, 0.0)),
        direction: Some(vec3(0.0, -1.0, 0.0)),
        ..Default::default()
    };
    let mut replay = explain(&mut bench, Asked::Raycast(ray)).await;
    asked_again(&replay);
    let moved = replay.shapes.iter_mut().find(|shape| shape.id == 8).unwrap();
    moved.pose = Some(at(2.0, 0.25, 0.0));
    let again = ask_again(&replay).unwrap();
    assert_ne!(bare(again), bare(replay.answer.clone().unwrap()));

    replay.format = 3;
    let error = ask_again(&replay).unwrap_err().to_string();
    assert!(error.contains("layout 3") && error.contains("layout 2"), "{error}");
    replay.format = 1;
    replay.geometries.clear();
    replay.shapes.iter_mut().for_each(|shape| shape.geometry = Some(geometry(Form::GeometryId("ab".repeat(32)))));
    let error = ask_again(&replay).unwrap_err().to_string();
    assert!(error.contains("no whole replay") && error.contains("shapes[0].geometry"), "{error}");
}

#[tokio::test]
async fn what_cannot_be_explained_is_refused() {
    let mut bench = zoo().await;
    let status = bench.worlds.explain(pb::ExplainRequest::default()).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "MISSING", "question", &["such as {\"raycast\""]);
    let ray = pb::RaycastRequest { session: "arena".to_owned(), ..crate::harness::ray_along_z() };
    let question = Some(pb::Question { question: Some(Asked::Raycast(ray)) });
    let status = bench.worlds.explain(pb::ExplainRequest { question, ..Default::default() }).await.unwrap_err();
    assert_refused(
        &status,
        Code::InvalidArgument,
        "OUT_OF_LIMITS",
        "question.raycast.session",
        &["beside the question"],
    );
    // 400,000 triangles are more than a message holds.
    let count = 400_000_u32;
    let vertices =
        (0..3 * count).map(|number| (number % 977) as f32 + (number / 977) as f32 * 0.01).collect::<Vec<f32>>();
    let indices =
        (0..count).flat_map(|number| [number, (number + 1) % count, (number + 2) % count]).collect::<Vec<u32>>();
    let header = pb::GeometryHeader {
        geometry: Some(geometry(Form::Mesh(pb::TriangleMesh::default()))),
        value_count: vertices.len() as u64,
        index_count: indices.len() as u64,
    };
    let of_values =
        vertices.chunks(1 << 18).map(|values| pb::GeometryChunk { values: values.to_vec(), indices: vec![] });
    let of_indices =
        indices.chunks(1 << 18).map(|indices| pb::GeometryChunk { values: vec![], indices: indices.to_vec() });
    let chunks = of_values.chain(of_indices).map(pb::geometry_piece::Piece::Chunk);
    let pieces: Vec<_> = std::iter::once(pb::geometry_piece::Piece::Header(header))
        .chain(chunks)
        .map(|piece| pb::UploadGeometryRequest {
            piece: Some(pb::GeometryPiece { piece: Some(piece) }),
            ..pb::UploadGeometryRequest::default()
        })
        .collect();
    let info =
        bench.geometries.upload_geometry(tokio_stream::iter(pieces)).await.unwrap().into_inner().geometry.unwrap();
    bench.edit(vec![insert(shape(50, geometry(Form::GeometryId(info.geometry_id)), at(0.0, 0.0, 0.0)))]).await.unwrap();
    let overlap = pb::OverlapRequest {
        subject: Some(subject(sphere(1.0), at(500.0, 500.0, 500.0))),
        against: Some(Box::new(subject_shape(50))),
        ..pb::OverlapRequest::default()
    };
    let question = Some(pb::Question { question: Some(Asked::Overlap(Box::new(overlap))) });
    let status = bench.worlds.explain(pb::ExplainRequest { question, ..Default::default() }).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["ExportWorld"]);
}
