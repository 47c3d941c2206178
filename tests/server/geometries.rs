//! Registered geometries: content ids, uses, what is told about them, and that forgetting one breaks no shape.

use tonic::Code;
use wire::v1::{self as pb, geometry::Kind};

use crate::harness::{Bench, assert_refused, at, cuboid, geometry, insert, ray_along_z, settings, shape, sphere};

fn tetrahedron() -> pb::TriangleMesh {
    pb::TriangleMesh {
        vertices: vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        indices: vec![0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3],
        ..pb::TriangleMesh::default()
    }
}

fn named(id: &str) -> pb::Geometry {
    geometry(Kind::GeometryId(id.to_owned()))
}

async fn create(bench: &mut Bench, geometry: pb::Geometry) -> Result<pb::GeometryInfo, tonic::Status> {
    let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(geometry) };
    let created = bench.geometries.create_geometry(request).await?;
    Ok(created.into_inner().geometry.unwrap())
}

async fn get(bench: &mut Bench, id: &str) -> Result<pb::GeometryInfo, tonic::Status> {
    let request = pb::GetGeometryRequest { geometry_id: id.to_owned(), ..pb::GetGeometryRequest::default() };
    Ok(bench.geometries.get_geometry(request).await?.into_inner().geometry.unwrap())
}

#[tokio::test]
async fn equal_content_has_one_id_however_it_is_written() {
    let mut bench = Bench::start().await;
    let one = create(&mut bench, sphere(2.0)).await.unwrap();
    assert_eq!(one.geometry_id.len(), 64);
    assert_eq!(one.state(), pb::GeometryState::Ready);
    let again = create(&mut bench, sphere(2.0)).await.unwrap();
    let rounded_point = pb::Geometry { rounding: 2.0, ..geometry(Kind::Point(pb::Point {})) };
    let rounded_point = create(&mut bench, rounded_point).await.unwrap();
    let scaled = pb::Geometry { scale: Some(4.0), ..sphere(0.5) };
    let scaled = create(&mut bench, scaled).await.unwrap();
    let other = create(&mut bench, sphere(2.5)).await.unwrap();
    assert_eq!(one.geometry_id, again.geometry_id);
    assert_eq!(one.geometry_id, rounded_point.geometry_id);
    assert_eq!(one.geometry_id, scaled.geometry_id);
    assert_ne!(one.geometry_id, other.geometry_id);
}

#[tokio::test]
async fn a_mesh_says_what_was_found_in_it() {
    let mut bench = Bench::start().await;
    let closed = create(&mut bench, geometry(Kind::Mesh(tetrahedron()))).await.unwrap();
    assert_eq!((closed.vertex_count, closed.face_count), (4, 4));
    assert!(closed.warnings.is_empty(), "{:?}", closed.warnings);
    assert!(closed.memory_bytes > 0);
    let bounds = closed.bounds.unwrap();
    assert!(bounds.min.unwrap().x <= 0.0 && bounds.max.unwrap().x >= 1.0);
    let mut open = tetrahedron();
    open.indices.truncate(9);
    open.indices.extend([1, 1, 2]);
    let open = create(&mut bench, geometry(Kind::Mesh(open))).await.unwrap();
    let warnings = open.warnings.join("; ");
    assert!(warnings.contains("1 triangles without area"), "{warnings}");
    assert!(warnings.contains("3 edges belong to one triangle only"), "{warnings}");
}

#[tokio::test]
async fn a_shape_by_id_is_hit_like_one_in_place_and_counted() {
    let mut bench = Bench::start().await;
    let id = create(&mut bench, sphere(1.0)).await.unwrap().geometry_id;
    let shapes = vec![
        insert(shape(1, named(&id), at(0.0, 0.0, 5.0))),
        insert(shape(2, sphere(1.0), at(0.0, 9.0, 5.0))),
        insert(shape(3, cuboid(1.0, 1.0, 1.0), at(0.0, 20.0, 5.0))),
    ];
    bench.edit(shapes).await.unwrap();
    let answer = bench.questions.raycast(ray_along_z()).await.unwrap().into_inner();
    assert_eq!(answer.hits[0].id, 1);
    assert_eq!(get(&mut bench, &id).await.unwrap().shape_count, 2, "in place or by id, it is the same geometry");
}

#[tokio::test]
async fn a_named_geometry_can_be_rounded_and_scaled() {
    let mut bench = Bench::start().await;
    let id = create(&mut bench, sphere(1.0)).await.unwrap().geometry_id;
    let twice = pb::Geometry { scale: Some(2.0), ..named(&id) };
    bench.edit(vec![insert(shape(1, twice, at(0.0, 0.0, 5.0)))]).await.unwrap();
    let answer = bench.questions.raycast(ray_along_z()).await.unwrap().into_inner();
    assert!((answer.hits[0].distance.unwrap() - 3.0).abs() < 1e-9);
}

#[tokio::test]
async fn a_forgotten_geometry_cannot_be_named_and_its_shapes_stay() {
    let mut bench = Bench::start().await;
    let id = create(&mut bench, sphere(1.0)).await.unwrap().geometry_id;
    bench.edit(vec![insert(shape(1, named(&id), at(0.0, 0.0, 5.0)))]).await.unwrap();
    let request = pb::DeleteGeometryRequest { session: String::new(), geometry_id: id.clone() };
    bench.geometries.delete_geometry(request.clone()).await.unwrap();
    bench.geometries.delete_geometry(request).await.unwrap();
    let status = get(&mut bench, &id).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "GEOMETRY_NOT_FOUND", "geometry_id", &["CreateGeometry"]);
    let status = bench.edit(vec![insert(shape(2, named(&id), at(0.0, 0.0, 9.0)))]).await.unwrap_err();
    let field = "edits[0].insert.geometry.geometry_id";
    assert_refused(&status, Code::NotFound, "GEOMETRY_NOT_FOUND", field, &[]);
    let answer = bench.questions.raycast(ray_along_z()).await.unwrap().into_inner();
    assert_eq!(answer.hits[0].id, 1);
}

#[tokio::test]
async fn geometries_are_listed_by_id_page_by_page() {
    let mut bench = Bench::start().await;
    let mut made = Vec::new();
    for radius in 1..=5 {
        made.push(create(&mut bench, sphere(f64::from(radius))).await.unwrap().geometry_id);
    }
    made.sort();
    let mut listed = Vec::new();
    let mut request = pb::ListGeometriesRequest { page_size: 2, ..pb::ListGeometriesRequest::default() };
    loop {
        let page = bench.geometries.list_geometries(request.clone()).await.unwrap().into_inner();
        assert!(page.geometries.len() <= 2);
        listed.extend(page.geometries.into_iter().map(|info| info.geometry_id));
        request.page_token = page.next_page_token;
        if request.page_token.is_empty() {
            break;
        }
    }
    assert_eq!(listed, made);
    // A long text of the caller's own is cut in the message, which travels in a header.
    request.page_token = "nonsense".repeat(100_000);
    let status = bench.geometries.list_geometries(request).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "page_token", &["leave it empty"]);
}

#[tokio::test]
async fn beyond_the_memory_quota_nothing_grows_and_questions_go_on() {
    let mut settings = settings();
    settings.session_memory_bytes = 20_000;
    let mut bench = Bench::start_with(settings).await;
    let vertex = |index: u16| [f32::from(index), f32::from(index % 31), f32::from(index % 7)];
    let large = geometry(Kind::Mesh(pb::TriangleMesh {
        vertices: (0..1000).flat_map(vertex).collect(),
        indices: (0..998).flat_map(|first| [first, first + 1, first + 2]).collect(),
        ..pb::TriangleMesh::default()
    }));
    let status = create(&mut bench, large).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["session_memory_bytes"]);
    let shapes = |count: u64| (1..=count).map(|id| insert(shape(id, sphere(1.0), at(0.0, 0.0, 5.0)))).collect();
    bench.edit(shapes(10)).await.unwrap();
    let status = bench.edit(shapes(100)).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["session_memory_bytes"]);
    assert_eq!(bench.describe().await.shape_count, 10);
    assert_eq!(bench.questions.raycast(ray_along_z()).await.unwrap().into_inner().verdict(), pb::Verdict::Hit);
}
