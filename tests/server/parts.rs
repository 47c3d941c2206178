//! Meshes that are cut into convex parts: in work, ready, called off; and contacts between them.

use std::time::Duration;

use tokio_stream::iter;
use tonic::{Code, Status};
use tonic_types::StatusExt;
use wire::v1::{self as pb, geometry::Kind, geometry_piece::Piece};

use crate::harness::{Bench, assert_refused, at, geometry, insert, settings, shape, subject, with_token};

/// An L of two boxes, closed, whose outline lies in x and y and goes 1 m along z.
fn l_shape() -> pb::TriangleMesh {
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let vertices = [0.0, 1.0].into_iter().flat_map(|z| outline.into_iter().flat_map(move |[x, y]| [x, y, z])).collect();
    let mut indices = Vec::new();
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
        indices.extend([a, c, b, a + 6, b + 6, c + 6]);
    }
    for corner in 0..6 {
        let next = (corner + 1) % 6;
        indices.extend([corner, next, next + 6, corner, next + 6, corner + 6]);
    }
    pb::TriangleMesh { vertices, indices, ..pb::TriangleMesh::default() }
}

/// A field of spikes that no few parts are near to: it takes minutes.
fn spikes() -> pb::TriangleMesh {
    let side = 120_u32;
    let height = |column: u32, row: u32| f32::from(u8::try_from((column * 7 + row * 13) % 5).expect("below 5"));
    let place = |column: u32, row: u32| [column as f32, height(column, row), row as f32];
    let vertices = (0..side).flat_map(|row| (0..side).flat_map(move |column| place(column, row))).collect();
    let corners = (1..side).flat_map(|row| (1..side).map(move |column| row * side + column));
    let indices = corners.flat_map(|at| [at, at - 1, at - side, at - side - 1, at - side, at - 1]).collect();
    pb::TriangleMesh { vertices, indices, ..pb::TriangleMesh::default() }
}

fn cut(mesh: pb::TriangleMesh, max_parts: u32) -> pb::Geometry {
    let decompose = Some(pb::Decompose { max_parts, max_error: 0.0, max_steps: 0 });
    geometry(Kind::Mesh(pb::TriangleMesh { decompose, ..mesh }))
}

fn named(id: &str) -> pb::Geometry {
    geometry(Kind::GeometryId(id.to_owned()))
}

async fn create(bench: &mut Bench, session: &str, geometry: pb::Geometry) -> pb::GeometryInfo {
    let request = pb::CreateGeometryRequest { session: session.to_owned(), geometry: Some(geometry) };
    let created = bench.geometries.create_geometry(request).await.expect("a geometry");
    created.into_inner().geometry.expect("what was registered")
}

async fn get(bench: &mut Bench, id: &str, wait: bool) -> Result<pb::GeometryInfo, Status> {
    let request = pb::GetGeometryRequest { geometry_id: id.to_owned(), wait, ..pb::GetGeometryRequest::default() };
    Ok(bench.geometries.get_geometry(request).await?.into_inner().geometry.expect("how it stands"))
}

async fn delete(bench: &mut Bench, id: &str) {
    let request = pb::DeleteGeometryRequest { session: String::new(), geometry_id: id.to_owned() };
    bench.geometries.delete_geometry(request).await.expect("it is forgotten");
}

#[tokio::test]
async fn a_mesh_is_cut_and_says_what_its_parts_are_worth() {
    let mut bench = Bench::start().await;
    let bare = create(&mut bench, "", geometry(Kind::Mesh(l_shape()))).await;
    let created = create(&mut bench, "", cut(l_shape(), 0)).await;
    assert_ne!(created.geometry_id, bare.geometry_id, "answers depend on the parts");
    let ready = get(&mut bench, &created.geometry_id, true).await.expect("it becomes ready");
    assert_eq!((ready.state(), &ready.geometry_id), (pb::GeometryState::Ready, &created.geometry_id));
    assert!((1.0..=1.0).contains(&ready.progress) && ready.face_count == 20);
    let parts = ready.decomposition.expect("it was asked");
    assert_eq!((parts.part_count, parts.stop()), (2, pb::Stop::Tolerance));
    let (outside, inside) = (parts.outside.expect("an interval"), parts.inside.expect("an interval"));
    assert!(outside.upper.expect("a bound") < 1e-9 && inside.upper.expect("a bound") < 1e-9);
    assert!(parts.volume_excess.expect("it is closed").abs() < 1e-9);
    assert!(parts.build_time.is_some() && parts.first_tick == 1, "no tick was made before: {parts:?}");
    // 0 stands for 32, and what is there is not made again.
    let again = create(&mut bench, "", cut(l_shape(), 32)).await;
    assert_eq!((again.state(), &again.geometry_id), (pb::GeometryState::Ready, &created.geometry_id));
    assert_eq!(again.decomposition.expect("as before").part_count, 2);
}

#[tokio::test]
async fn two_meshes_with_parts_have_contacts() {
    let mut bench = Bench::start().await;
    let bare = create(&mut bench, "", geometry(Kind::Mesh(l_shape()))).await.geometry_id;
    let id = create(&mut bench, "", cut(l_shape(), 0)).await.geometry_id;
    get(&mut bench, &id, true).await.expect("it becomes ready");
    let shapes =
        vec![insert(shape(1, named(&id), at(0.0, 0.0, 0.0))), insert(shape(2, named(&bare), at(50.0, 0.0, 0.0)))];
    bench.edit(shapes).await.expect("it can be placed");
    let ask = |id: &str, x: f64| pb::PenetrationRequest {
        subject: Some(subject(named(id), at(x, 0.25, 0.5))),
        ..pb::PenetrationRequest::default()
    };
    let found = bench.questions.penetration(ask(&id, 1.75)).await.expect("both have parts").into_inner();
    assert_eq!(found.verdict(), pb::Verdict::Hit);
    let certificate = found.contacts[0].certificate.expect("each has one");
    assert_eq!(certificate.representation(), pb::Representation::Decomposition);
    assert!(certificate.outside > 0.0 && certificate.outside < 1e-9 && certificate.inside < 1e-9);
    let depth = found.contacts[0].depth.expect("a depth");
    assert!((depth - 0.25).abs() < 1e-9, "{depth}");
    // One with parts is enough; two without are not.
    let found = bench.questions.penetration(ask(&id, 51.75)).await.expect("one has parts").into_inner();
    assert_eq!(found.contacts[0].id, 2);
    let refused = bench.questions.penetration(ask(&bare, 51.75)).await.expect_err("neither has");
    assert_refused(&refused, Code::FailedPrecondition, "NEEDS_DECOMPOSITION", "", &[]);
}

#[tokio::test]
async fn a_question_that_names_an_error_has_parts_made_and_is_answered_once_they_are() {
    let mut bench = Bench::start().await;
    let id = create(&mut bench, "", geometry(Kind::Mesh(l_shape()))).await.geometry_id;
    let compound =
        pb::Compound { parts: vec![pb::CompoundPart { geometry: Some(named(&id)), ..pb::CompoundPart::default() }] };
    bench.edit(vec![insert(shape(1, geometry(Kind::Compound(compound)), at(0.0, 0.0, 0.0)))]).await.expect("it fits");
    let ask = |max_error: f64| pb::PenetrationRequest {
        subject: Some(subject(named(&id), at(1.75, 0.25, 0.5))),
        options: Some(Box::new(pb::QueryOptions {
            accuracy: Some(pb::Accuracy { max_error: Some(max_error), ..pb::Accuracy::default() }),
            ..pb::QueryOptions::default()
        })),
        ..pb::PenetrationRequest::default()
    };
    let refused = bench.questions.penetration(ask(0.0)).await.expect_err("no error is named");
    assert_refused(&refused, Code::FailedPrecondition, "NEEDS_DECOMPOSITION", "", &["max_error", "decompose"]);
    let mut in_place = ask(0.1);
    in_place.subject = Some(subject(geometry(Kind::Mesh(l_shape())), at(1.75, 0.25, 0.5)));
    let refused = bench.questions.penetration(in_place).await.expect_err("it is gone with the question");
    assert_refused(&refused, Code::FailedPrecondition, "NEEDS_DECOMPOSITION", "", &["sent with", "CreateGeometry"]);
    let mut told = -1.0_f32;
    let found = loop {
        match bench.questions.penetration(ask(0.1)).await {
            Ok(found) => break found.into_inner(),
            Err(status) => {
                assert_refused(
                    &status,
                    Code::FailedPrecondition,
                    "GEOMETRY_NOT_READY",
                    "",
                    &["of 1 mesh", "ask again"],
                );
                let details = status.get_error_details();
                let progress = &details.error_info().expect("a reason").metadata["progress"];
                let progress: f32 = progress.parse().expect("a number");
                assert!((0.0..=1.0).contains(&progress) && progress >= told, "{progress} after {told}");
                told = progress;
                tokio::time::sleep(Duration::from_millis(5)).await;
            }
        }
    };
    assert!(told >= 0.0, "the first question is refused");
    let certificate = found.contacts[0].certificate.expect("each has one");
    assert_eq!(certificate.representation(), pb::Representation::Decomposition);
    assert!(certificate.outside + certificate.inside <= 0.1, "{certificate:?}");
    let depth = found.contacts[0].depth.expect("a depth");
    assert!((depth - 0.25).abs() <= 0.1, "{depth}");
    // Nothing is left to make for an error that is nearly the same, and batches have the same answer.
    let again = bench.questions.penetration(ask(0.101)).await.expect("they are there").into_inner();
    assert_eq!(again.contacts, found.contacts);
    let made = get(&mut bench, &id, false).await.expect("it is known").stand_ins;
    let made: Vec<_> = made.iter().filter(|it| it.representation() == pb::Representation::Decomposition).collect();
    assert!(made.len() == 1 && made[0].vertex_count == 16 && made[0].inside + made[0].outside <= 0.05, "{made:?}");
}

#[tokio::test]
async fn what_is_in_work_waits_its_turn_and_can_be_called_off() {
    let mut bench = Bench::start().await;
    let slow = create(&mut bench, "", cut(spikes(), 1024)).await;
    let next = create(&mut bench, "", cut(l_shape(), 5)).await;
    assert_eq!((slow.state(), next.state()), (pb::GeometryState::Building, pb::GeometryState::Building));
    let (slow, next) = (slow.geometry_id, next.geometry_id);
    let refused = bench.edit(vec![insert(shape(1, named(&slow), at(0.0, 0.0, 0.0)))]).await.expect_err("it is in work");
    assert_refused(&refused, Code::FailedPrecondition, "GEOMETRY_NOT_READY", "", &["still being cut", "wait"]);
    let listed = bench.geometries.list_geometries(pb::ListGeometriesRequest::default()).await.expect("a list");
    let listed = listed.into_inner().geometries;
    assert!(listed.len() == 2 && listed.iter().all(|info| info.state() == pb::GeometryState::Building));
    assert_eq!(get(&mut bench, &next, false).await.expect("it is known").state(), pb::GeometryState::Building);
    // Who waits for what is deleted is told so, and the worker is free for the next.
    let mut waiting = bench.geometries.clone();
    let request = pb::GetGeometryRequest { geometry_id: slow.clone(), wait: true, ..pb::GetGeometryRequest::default() };
    let waiting = tokio::spawn(async move { waiting.get_geometry(request).await });
    delete(&mut bench, &slow).await;
    let told = waiting.await.expect("it ends").expect_err("it is gone");
    assert_refused(&told, Code::NotFound, "GEOMETRY_NOT_FOUND", "geometry_id", &[]);
    let ready = get(&mut bench, &next, true).await.expect("its turn comes");
    assert_eq!(ready.state(), pb::GeometryState::Ready);
    bench.edit(vec![insert(shape(1, named(&next), at(0.0, 0.0, 0.0)))]).await.expect("it can be placed");
}

#[tokio::test]
async fn parts_go_down_and_up_again_and_serve_other_sessions() {
    let mut bench = Bench::start().await;
    let id = create(&mut bench, "", cut(l_shape(), 7)).await.geometry_id;
    get(&mut bench, &id, true).await.expect("it becomes ready");
    let request = pb::DownloadGeometryRequest { session: String::new(), geometry_id: id.clone() };
    let mut stream = bench.geometries.download_geometry(request).await.expect("it is known").into_inner();
    let mut messages = Vec::new();
    while let Some(message) = stream.message().await.expect("a piece") {
        messages.push(pb::UploadGeometryRequest { session: String::new(), piece: message.piece });
    }
    let Some(Piece::Header(header)) = messages[0].piece.as_ref().and_then(|piece| piece.piece.as_ref()) else {
        panic!("a header comes first")
    };
    let Some(Kind::Mesh(mesh)) = header.geometry.as_ref().and_then(|geometry| geometry.kind.as_ref()) else {
        panic!("a mesh")
    };
    assert_eq!(mesh.decompose.map(|asked| asked.max_parts), Some(7));
    let mut other = Bench::start().await;
    let uploaded = other.geometries.upload_geometry(iter(messages)).await.expect("it is taken").into_inner();
    let uploaded = uploaded.geometry.expect("what was registered").geometry_id;
    assert_eq!(uploaded, id);
    assert_eq!(get(&mut other, &id, true).await.expect("it is cut here").state(), pb::GeometryState::Ready);
}

#[tokio::test]
async fn in_place_no_parts_are_asked() {
    let mut bench = Bench::start().await;
    let refused = bench.edit(vec![insert(shape(1, cut(l_shape(), 0), at(0.0, 0.0, 0.0)))]).await.expect_err("in place");
    assert_refused(&refused, Code::InvalidArgument, "BAD_GEOMETRY", "", &["mesh.decompose", "CreateGeometry"]);
    let request = |decompose| pb::CreateGeometryRequest {
        session: String::new(),
        geometry: Some(geometry(Kind::Mesh(pb::TriangleMesh { decompose: Some(decompose), ..l_shape() }))),
    };
    let many = request(pb::Decompose { max_parts: 1025, max_error: 0.0, max_steps: 0 });
    let refused = bench.geometries.create_geometry(many).await.expect_err("too many");
    assert!(refused.message().contains("max_parts") && refused.code() == Code::InvalidArgument, "{refused}");
    let below = request(pb::Decompose { max_parts: 0, max_error: -1.0, max_steps: 0 });
    let refused = bench.geometries.create_geometry(below).await.expect_err("below 0");
    assert_refused(&refused, Code::InvalidArgument, "OUT_OF_LIMITS", "geometry.mesh.decompose.max_error", &["is -1"]);
    let nan = request(pb::Decompose { max_parts: 0, max_error: f64::NAN, max_steps: 0 });
    let refused = bench.geometries.create_geometry(nan).await.expect_err("no number");
    assert_refused(&refused, Code::InvalidArgument, "NOT_FINITE", "geometry.mesh.decompose.max_error", &[]);
}

#[tokio::test]
async fn a_copy_of_a_session_gets_what_is_in_work_too() {
    let mut bench = Bench::start().await;
    let slow = create(&mut bench, "", cut(spikes(), 1024)).await.geometry_id;
    let next = create(&mut bench, "", cut(l_shape(), 9)).await.geometry_id;
    let request = pb::ForkSessionRequest { fork: "copy".to_owned(), ..pb::ForkSessionRequest::default() };
    let made = bench.sessions.fork_session(request).await.expect("a copy").into_inner();
    let ask = |id: &str, wait: bool| {
        let request = pb::GetGeometryRequest { session: "copy".to_owned(), geometry_id: id.to_owned(), wait };
        with_token(&made.token, request)
    };
    let known = bench.geometries.get_geometry(ask(&next, false)).await.expect("it is known").into_inner();
    assert_eq!(known.geometry.expect("how it stands").state(), pb::GeometryState::Building);
    // Both sessions let the worker go on before the next one's turn comes.
    delete(&mut bench, &slow).await;
    let request = pb::DeleteGeometryRequest { session: "copy".to_owned(), geometry_id: slow };
    bench.geometries.delete_geometry(with_token(&made.token, request)).await.expect("it is forgotten");
    let ready = bench.geometries.get_geometry(ask(&next, true)).await.expect("its turn comes").into_inner();
    assert_eq!(ready.geometry.expect("how it stands").state(), pb::GeometryState::Ready);
}

#[tokio::test]
async fn a_session_that_ends_frees_the_worker() {
    let mut bench = Bench::start().await;
    let token = bench.create_session("ends").await.token;
    let request = pb::CreateGeometryRequest { session: "ends".to_owned(), geometry: Some(cut(spikes(), 1024)) };
    let slow = bench.geometries.create_geometry(with_token(&token, request)).await.expect("it is taken").into_inner();
    assert_eq!(slow.geometry.expect("how it stands").state(), pb::GeometryState::Building);
    let next = create(&mut bench, "", cut(l_shape(), 3)).await;
    assert_eq!(next.state(), pb::GeometryState::Building);
    let request = pb::DeleteSessionRequest { session: "ends".to_owned() };
    bench.sessions.delete_session(with_token(&token, request)).await.expect("it ends");
    let ready = get(&mut bench, &next.geometry_id, true).await.expect("its turn comes");
    assert_eq!(ready.state(), pb::GeometryState::Ready);
}

/// The L with so many steps to cut it.
fn cut_within(max_steps: u64) -> pb::Geometry {
    let decompose = Some(pb::Decompose { max_parts: 0, max_error: 0.0, max_steps });
    geometry(Kind::Mesh(pb::TriangleMesh { decompose, ..l_shape() }))
}

async fn parts_within(bench: &mut Bench, max_steps: u64) -> (String, pb::DecomposeResult) {
    let id = create(bench, "", cut_within(max_steps)).await.geometry_id;
    let ready = get(bench, &id, true).await.expect("it becomes ready");
    assert_eq!(ready.state(), pb::GeometryState::Ready, "{ready:?}");
    let result = ready.decomposition.expect("it was asked");
    (id, pb::DecomposeResult { build_time: None, first_tick: 0, ..result })
}

#[tokio::test]
async fn steps_end_the_work_with_what_is_made_by_then() {
    let (mut bench, mut other) = (Bench::start().await, Bench::start().await);
    let (whole, enough) = parts_within(&mut bench, 0).await;
    assert!(enough.stop() == pb::Stop::Tolerance && enough.part_count == 2 && enough.steps > 0, "{enough:?}");
    let (hull, one) = parts_within(&mut bench, 1).await;
    assert!(one.stop() == pb::Stop::Budget && one.part_count == 1 && one.steps < enough.steps, "{one:?}");
    let inside = one.inside.expect("an interval");
    let (lower, upper) = (inside.lower.expect("a bound"), inside.upper.expect("a bound"));
    // The middle of the hull's slope is as far from either side of the hollow.
    assert!(lower <= 0.5 && (0.5..=3.0).contains(&upper), "{inside:?}");
    assert_ne!(hull, whole, "other parts are another geometry");
    assert_eq!(parts_within(&mut other, 1).await, (hull, one), "the same on every server");
    let (named, _) = parts_within(&mut bench, 1 << 32).await;
    assert_eq!(named, whole, "0 stands for it");
}

#[tokio::test]
async fn more_steps_than_the_server_allows_are_refused() {
    let settings = calipers::config::Settings { decompose_steps: 1_000_000, ..settings() };
    let mut bench = Bench::start_with(settings).await;
    let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(cut_within(1_000_001)) };
    let refused = bench.geometries.create_geometry(request).await.expect_err("too many");
    let field = "geometry.mesh.decompose.max_steps";
    assert_refused(
        &refused,
        Code::ResourceExhausted,
        "QUOTA_EXCEEDED",
        field,
        &["1000001", "1000000", "decompose_steps"],
    );
    let (usual, _) = parts_within(&mut bench, 0).await;
    assert_eq!(parts_within(&mut bench, 1_000_000).await.0, usual, "0 is what the server allows");
}
