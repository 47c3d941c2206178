//! Geometries in pieces: what was uploaded is what would have been created, and comes back as it was.

use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Code, Status};
use wire::v1::{self as pb, geometry::Kind, geometry_piece::Piece};

use crate::harness::{Bench, Refusal, assert_refused, at, geometry, get, insert, settings, shape, sphere, with_token};

fn piece(piece: Piece) -> pb::UploadGeometryRequest {
    pb::UploadGeometryRequest { session: String::new(), piece: Some(pb::GeometryPiece { piece: Some(piece) }) }
}

fn header(kind: Kind, value_count: u64, index_count: u64) -> pb::UploadGeometryRequest {
    piece(Piece::Header(pb::GeometryHeader { geometry: Some(geometry(kind)), value_count, index_count }))
}

fn chunk(values: &[f32], indices: &[u32]) -> pb::UploadGeometryRequest {
    piece(Piece::Chunk(pb::GeometryChunk { values: values.to_vec(), indices: indices.to_vec() }))
}

fn empty_mesh() -> Kind {
    Kind::Mesh(pb::TriangleMesh::default())
}

/// A grid of hills with a few triangles without area in it.
fn hills(side: u32) -> (Vec<f32>, Vec<u32>) {
    let height = |column: u32, row: u32| f32::from(u8::try_from(column * row % 7).expect("below 7"));
    let place = |column: u32, row: u32| [column as f32, height(column, row), row as f32];
    let vertices = (0..side).flat_map(|row| (0..side).flat_map(move |column| place(column, row))).collect();
    let mut indices = Vec::new();
    for row in 1..side {
        for column in 1..side {
            let corner = row * side + column;
            indices.extend([corner, corner - 1, corner - side]);
            if column == row {
                indices.extend([corner, corner, corner - 1]);
            }
        }
    }
    (vertices, indices)
}

async fn upload(bench: &mut Bench, messages: Vec<pb::UploadGeometryRequest>) -> Result<pb::GeometryInfo, Status> {
    let response = bench.geometries.upload_geometry(tokio_stream::iter(messages)).await?;
    Ok(response.into_inner().geometry.expect("what was registered"))
}

async fn download(bench: &mut Bench, geometry_id: &str) -> Result<Vec<Piece>, Status> {
    let request = pb::DownloadGeometryRequest { session: String::new(), geometry_id: geometry_id.to_owned() };
    let mut stream = bench.geometries.download_geometry(request).await?.into_inner();
    let mut pieces = Vec::new();
    while let Some(message) = stream.message().await? {
        pieces.push(message.piece.and_then(|piece| piece.piece).expect("each message has a piece"));
    }
    Ok(pieces)
}

/// Sends downloaded pieces up again.
async fn reupload(bench: &mut Bench, pieces: Vec<Piece>) -> Result<pb::GeometryInfo, Status> {
    upload(bench, pieces.into_iter().map(piece).collect()).await
}

#[tokio::test]
async fn an_uploaded_mesh_is_the_created_one_however_it_is_cut() {
    let mut bench = Bench::start().await;
    let (vertices, indices) = hills(12);
    let whole = pb::TriangleMesh { vertices: vertices.clone(), indices: indices.clone(), ..Default::default() };
    let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(geometry(Kind::Mesh(whole))) };
    let created = bench.geometries.create_geometry(request).await.unwrap().into_inner().geometry.unwrap();
    let first = header(empty_mesh(), vertices.len() as u64, indices.len() as u64);
    for cut in [1, 7, 100_000] {
        let mut messages = vec![first.clone()];
        messages.extend(indices.chunks(cut).map(|part| chunk(&[], part)));
        messages.extend(vertices.chunks(cut).map(|part| chunk(part, &[])));
        assert_eq!(upload(&mut bench, messages).await.unwrap(), created, "in pieces of {cut}");
    }
    assert!(created.warnings.join(" ").contains("11 triangles without area"), "{:?}", created.warnings);
}

#[tokio::test]
async fn what_comes_down_goes_up_again_as_the_same_geometry() {
    let mut bench = Bench::start().await;
    let mut other = Bench::start().await;
    let (vertices, indices) = hills(9);
    let mesh = pb::TriangleMesh { vertices: vertices.clone(), indices, ..Default::default() };
    let one_sided = pb::TriangleMesh { mode: pb::MeshMode::OneSided.into(), ..mesh.clone() };
    let hull = pb::Geometry { rounding: 0.25, ..geometry(Kind::Hull(pb::ConvexHull { points: vertices })) };
    for form in [geometry(Kind::Mesh(mesh)), geometry(Kind::Mesh(one_sided)), hull] {
        let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(form) };
        let created = bench.geometries.create_geometry(request).await.unwrap().into_inner().geometry.unwrap();
        let pieces = download(&mut bench, &created.geometry_id).await.unwrap();
        assert!(pieces.len() > 1 && matches!(pieces[0], Piece::Header(_)));
        assert_eq!(reupload(&mut other, pieces).await.unwrap(), created);
    }
}

#[tokio::test]
async fn a_mesh_beyond_one_message_arrives_and_answers() {
    let mut bench = Bench::start().await;
    let (vertices, indices) = hills(700);
    assert!(4 * (vertices.len() + indices.len()) > 4 << 20);
    let mut messages = vec![header(empty_mesh(), vertices.len() as u64, indices.len() as u64)];
    messages.extend(vertices.chunks(1 << 18).map(|part| chunk(part, &[])));
    messages.extend(indices.chunks(1 << 18).map(|part| chunk(&[], part)));
    let info = upload(&mut bench, messages).await.unwrap();
    assert_eq!(info.face_count, 699 * 699);
    let named = geometry(Kind::GeometryId(info.geometry_id.clone()));
    bench.edit(vec![insert(shape(1, named, at(0.0, 0.0, 0.0)))]).await.unwrap();
    let down = pb::RaycastRequest {
        origin: Some(crate::harness::vec3(349.5, 100.0, 349.75)),
        direction: Some(crate::harness::vec3(0.0, -1.0, 0.0)),
        ..pb::RaycastRequest::default()
    };
    assert_eq!(bench.questions.raycast(down).await.unwrap().into_inner().hits[0].id, 1);
    let pieces = download(&mut bench, &info.geometry_id).await.unwrap();
    let numbers: usize = pieces
        .iter()
        .map(|piece| match piece {
            Piece::Header(_) => 0,
            Piece::Chunk(chunk) => {
                assert!(chunk.values.len() + chunk.indices.len() <= 1 << 18);
                chunk.values.len() + chunk.indices.len()
            }
            Piece::Exact(_) => panic!("a download has chunks"),
        })
        .sum();
    // No triangle uses the first vertex.
    assert_eq!(numbers, vertices.len() - 3 + indices.len());
}

#[tokio::test]
async fn a_kind_without_lists_comes_down_as_a_header_alone() {
    let mut bench = Bench::start().await;
    let form = pb::Geometry { rounding: 0.5, ..crate::harness::cuboid(1.0, 2.0, 3.0) };
    let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(form.clone()) };
    let id = bench.geometries.create_geometry(request).await.unwrap().into_inner().geometry.unwrap().geometry_id;
    let pieces = download(&mut bench, &id).await.unwrap();
    let alone = pb::GeometryHeader { geometry: Some(form), value_count: 0, index_count: 0 };
    assert_eq!(pieces, [Piece::Header(alone)]);
    let status = download(&mut bench, &id.replace(|digit| digit != '0', "0")).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "GEOMETRY_NOT_FOUND", "geometry_id", &["CreateGeometry"]);
}

#[tokio::test]
async fn a_compound_comes_down_with_all_its_parts_hold() {
    let mut bench = Bench::start().await;
    let mut other = Bench::start().await;
    let (vertices, indices) = hills(4);
    let mesh = geometry(Kind::Mesh(pb::TriangleMesh { vertices: vertices.clone(), indices, ..Default::default() }));
    let part = |geometry, pose| pb::CompoundPart { geometry: Some(geometry), pose: Some(pose) };
    let inner = geometry(Kind::Compound(pb::Compound { parts: vec![part(sphere(0.5), at(1.0, 0.0, 0.0))] }));
    let hull = geometry(Kind::Hull(pb::ConvexHull { points: vertices }));
    let parts = vec![part(mesh, at(0.0, 1.0, 0.0)), part(inner, at(0.0, 0.0, 1.0)), part(hull, at(2.0, 0.0, 0.0))];
    let form = geometry(Kind::Compound(pb::Compound { parts }));
    let request = |form| pb::CreateGeometryRequest { session: String::new(), geometry: Some(form) };
    let created = bench.geometries.create_geometry(request(form)).await.unwrap().into_inner().geometry.unwrap();
    let pieces = download(&mut bench, &created.geometry_id).await.unwrap();
    let [Piece::Header(header)] = pieces.as_slice() else { panic!("{pieces:?}") };
    let form = header.geometry.clone().unwrap();
    let again = other.geometries.create_geometry(request(form)).await.unwrap().into_inner().geometry.unwrap();
    assert_eq!(again.geometry_id, created.geometry_id);
}

#[tokio::test]
async fn a_wrong_upload_is_told_what_is_wrong_and_registers_nothing() {
    let mut bench = Bench::start().await;
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let full = Kind::Mesh(pb::TriangleMesh { vertices: corners.to_vec(), ..Default::default() });
    let good = header(empty_mesh(), 9, 3);
    let sphere = header(sphere(1.0).kind.unwrap(), 0, 0);
    let nan = [0.0, 0.0, f32::NAN, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let invalid = |messages, refusal: Refusal| (messages, Code::InvalidArgument, refusal);
    let incomplete = |messages, parts: &'static [&'static str]| {
        (messages, Code::FailedPrecondition, ("UPLOAD_INCOMPLETE", "", parts))
    };
    let wrong: Vec<(_, _, Refusal)> = vec![
        invalid(vec![], ("MISSING", "piece.header", &["no message came", "value_count"])),
        invalid(vec![chunk(&corners, &[])], ("MISSING", "piece.header", &["has a chunk"])),
        invalid(vec![Default::default()], ("MISSING", "piece.header", &["has none"])),
        invalid(vec![sphere], ("BAD_GEOMETRY", "piece.header.geometry", &["CreateGeometry"])),
        invalid(vec![header(full, 9, 3)], ("BAD_GEOMETRY", "piece.header.geometry", &["9 numbers"])),
        invalid(vec![header(empty_mesh(), 1 << 40, 3)], ("TOO_MANY_ITEMS", "piece.header.value_count", &[])),
        incomplete(vec![good.clone()], &["0 of 9 values", "0 of 3 indices"]),
        incomplete(vec![good.clone(), chunk(&corners, &[0, 1])], &["9 of 9 values", "2 of 3 indices"]),
        invalid(
            vec![good.clone(), chunk(&corners, &[]), chunk(&[2.0], &[])],
            ("TOO_MANY_ITEMS", "piece.chunk.values", &["to 10", "said 9"]),
        ),
        invalid(vec![good.clone(), good.clone()], ("BAD_GEOMETRY", "piece.header", &["second time"])),
        invalid(vec![good.clone(), Default::default()], ("MISSING", "piece", &["chunk"])),
        invalid(vec![good.clone(), chunk(&nan, &[0, 1, 2])], ("NOT_FINITE", "geometry.mesh.vertices[2]", &["is NaN"])),
        invalid(vec![good, chunk(&corners, &[0, 1, 3])], ("BAD_GEOMETRY", "geometry.mesh.indices[2]", &["3 vertices"])),
    ];
    for (messages, code, (reason, field, parts)) in wrong {
        let status = upload(&mut bench, messages).await.unwrap_err();
        assert_refused(&status, code, reason, field, parts);
    }
    let listed = bench.geometries.list_geometries(pb::ListGeometriesRequest::default()).await.unwrap().into_inner();
    assert!(listed.geometries.is_empty(), "{listed:?}");
}

#[tokio::test]
async fn promises_count_to_the_quota_until_the_upload_ends() {
    let mut settings = settings();
    settings.session_memory_bytes = 100_000;
    let mut bench = Bench::start_with(settings).await;
    let status = upload(&mut bench, vec![header(empty_mesh(), 30_000, 3)]).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["session_memory_bytes"]);
    let (sender, receiver) = mpsc::channel(4);
    sender.send(header(empty_mesh(), 15_000, 3)).await.unwrap();
    let mut geometries = bench.geometries.clone();
    let under_way = tokio::spawn(async move { geometries.upload_geometry(ReceiverStream::new(receiver)).await });
    // The first is held open until the second has been refused for it.
    let second = loop {
        match upload(&mut bench, vec![header(empty_mesh(), 15_000, 3)]).await.unwrap_err() {
            status if status.code() == Code::FailedPrecondition => tokio::task::yield_now().await,
            status => break status,
        }
    };
    assert_refused(&second, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["session_memory_bytes"]);
    drop(sender);
    let status = under_way.await.unwrap().unwrap_err();
    assert_refused(&status, Code::FailedPrecondition, "UPLOAD_INCOMPLETE", "", &[]);
    let status = upload(&mut bench, vec![header(empty_mesh(), 15_000, 3)]).await.unwrap_err();
    assert_refused(&status, Code::FailedPrecondition, "UPLOAD_INCOMPLETE", "", &[]);
}

#[tokio::test]
async fn an_upload_ends_with_its_session_and_needs_its_right() {
    let mut bench = Bench::start().await;
    let made = bench.create_session("arena").await;
    let first = |session: &str| pb::UploadGeometryRequest { session: session.to_owned(), ..header(empty_mesh(), 9, 3) };
    let status = upload(&mut bench, vec![first("arena")]).await.unwrap_err();
    assert_eq!(status.code(), Code::Unauthenticated, "{status}");
    let (sender, receiver) = mpsc::channel(4);
    sender.send(first("arena")).await.unwrap();
    let mut geometries = bench.geometries.clone();
    let request = with_token(&made.token, ReceiverStream::new(receiver));
    let under_way = tokio::spawn(async move { geometries.upload_geometry(request).await });
    let delete = pb::DeleteSessionRequest { session: "arena".to_owned() };
    bench.sessions.delete_session(with_token(&made.token, delete)).await.unwrap();
    let status = under_way.await.unwrap().unwrap_err();
    assert_refused(&status, Code::NotFound, "SESSION_NOT_FOUND", "", &[]);
    let status = bench.sessions.get_session(with_token(&made.token, get("arena"))).await.unwrap_err();
    assert_eq!(status.code(), Code::NotFound);
    drop(sender);
}
