//! Geometries of every wrong kind, wherever they stand.

use wire::v1::{self as pb, geometry::Kind};

use crate::harness::{Bench, Refusal, assert_invalid, at, cuboid, geometry, insert, shape, sphere, vec3};

fn mesh(vertices: &[f32], indices: &[u32]) -> pb::TriangleMesh {
    pb::TriangleMesh { vertices: vertices.to_vec(), indices: indices.to_vec(), ..pb::TriangleMesh::default() }
}

fn hull(points: Vec<f32>) -> pb::Geometry {
    geometry(Kind::Hull(pb::ConvexHull { points }))
}

fn wrong_numbers() -> Vec<(pb::Geometry, Refusal)> {
    let triangle = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let capsule = |half_height, radius| geometry(Kind::Capsule(pb::Capsule { half_height, radius }));
    vec![
        (pb::Geometry::default(), ("MISSING", "geometry.kind", &["sphere"])),
        (sphere(f64::NAN), ("NOT_FINITE", "geometry.sphere.radius", &["is NaN"])),
        (sphere(-1.0), ("OUT_OF_LIMITS", "geometry.sphere.radius", &["is -1"])),
        (sphere(2e9), ("OUT_OF_LIMITS", "geometry.sphere.radius", &["1e9"])),
        (sphere(1e-10), ("OUT_OF_LIMITS", "geometry.sphere.radius", &["1e-9"])),
        (cuboid(1.0, -1.0, 1.0), ("OUT_OF_LIMITS", "geometry.box.half_extents.y", &["is -1"])),
        (cuboid(1.0, f64::INFINITY, 1.0), ("NOT_FINITE", "geometry.box.half_extents.y", &["is inf"])),
        (capsule(-1.0, 1.0), ("OUT_OF_LIMITS", "geometry.capsule.half_height", &["is -1"])),
        (capsule(1.0, f64::NAN), ("NOT_FINITE", "geometry.capsule.radius", &["is NaN"])),
        (hull(vec![0.0; 4]), ("COLUMN_LENGTH", "geometry.hull.points", &["has 4 numbers", "three"])),
        (hull(vec![0.0, f32::NAN, 0.0]), ("NOT_FINITE", "geometry.hull.points[1]", &["is NaN"])),
        (hull(vec![0.0, 0.0, 2e12]), ("OUT_OF_LIMITS", "", &["geometry.hull.points", "1e12"])),
        (
            geometry(Kind::Mesh(mesh(&triangle, &[0, 1, 3]))),
            ("BAD_GEOMETRY", "geometry.mesh.indices[2]", &["is 3", "3 vertices"]),
        ),
        (
            geometry(Kind::Mesh(mesh(&triangle, &[0, 1]))),
            ("COLUMN_LENGTH", "geometry.mesh.indices", &["has 2 numbers"]),
        ),
        (geometry(Kind::Mesh(mesh(&triangle, &[0, 0, 1]))), ("BAD_GEOMETRY", "geometry.mesh.indices", &["area"])),
    ]
}

fn wrong_round_forms_and_half_spaces() -> Vec<(pb::Geometry, Refusal)> {
    let cylinder = |half_height, radius| geometry(Kind::Cylinder(pb::Cylinder { half_height, radius }));
    let cone = |half_height, radius| geometry(Kind::Cone(pb::Cone { half_height, radius }));
    let ellipsoid = |x: f64, y: f64, z: f64| geometry(Kind::Ellipsoid(pb::Ellipsoid { radii: Some(vec3(x, y, z)) }));
    let half_space =
        |normal: pb::Vec3, offset| geometry(Kind::HalfSpace(pb::HalfSpace { normal: Some(normal), offset }));
    vec![
        (cylinder(1.0, 0.0), ("OUT_OF_LIMITS", "geometry.cylinder.radius", &["is 0", "1e-9", "capsule"])),
        (cylinder(f64::NAN, 1.0), ("NOT_FINITE", "geometry.cylinder.half_height", &["is NaN"])),
        (
            geometry(Kind::Cylinder(pb::Cylinder::default())),
            ("OUT_OF_LIMITS", "geometry.cylinder.half_height", &["is 0"]),
        ),
        (cone(0.0, 1.0), ("OUT_OF_LIMITS", "geometry.cone.half_height", &["is 0", "1e9"])),
        (cone(1.0, f64::INFINITY), ("NOT_FINITE", "geometry.cone.radius", &["is inf"])),
        (ellipsoid(1.0, 0.0, 1.0), ("OUT_OF_LIMITS", "geometry.ellipsoid.radii.y", &["is 0", "1e-9"])),
        (ellipsoid(1.0, 1.0, f64::NAN), ("NOT_FINITE", "geometry.ellipsoid.radii.z", &["is NaN"])),
        (ellipsoid(1e-3, 1.0, 1.1e3), ("BAD_GEOMETRY", "geometry.ellipsoid.radii", &["0.001 to 1100", "1e6"])),
        (
            geometry(Kind::Ellipsoid(pb::Ellipsoid::default())),
            ("OUT_OF_LIMITS", "geometry.ellipsoid.radii.x", &["is 0"]),
        ),
        (half_space(vec3(0.0, 0.0, 0.0), 1.0), ("BAD_GEOMETRY", "geometry.half_space.normal", &["is 0", "direction"])),
        (half_space(vec3(0.0, f64::NAN, 0.0), 1.0), ("NOT_FINITE", "geometry.half_space.normal.y", &["is NaN"])),
        (half_space(vec3(0.0, 1.0, 0.0), 2e12), ("OUT_OF_LIMITS", "geometry.half_space.offset", &["1e12"])),
    ]
}

fn flat() -> pb::HeightField {
    pb::HeightField { columns: 3, rows: 2, heights: vec![0.0; 6], ..pb::HeightField::default() }
}

fn unserved_and_dressed() -> Vec<(pb::Geometry, Refusal)> {
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let triangle = &corners[..9];
    vec![
        (
            geometry(Kind::Mesh(pb::TriangleMesh { mode: pb::MeshMode::Solid.into(), ..mesh(triangle, &[0, 1, 2]) })),
            (
                "MESH_NOT_CLOSED",
                "geometry.mesh.indices",
                &["edge between vertices 0 and 1", "triangle 0 only", "two-sided"],
            ),
        ),
        (
            geometry(Kind::Mesh(pb::TriangleMesh {
                mode: pb::MeshMode::Solid.into(),
                ..mesh(&corners, &[0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2])
            })),
            ("MESH_NOT_CLOSED", "geometry.mesh.indices", &["wound inwards", "-0.1666", "swap two corners"]),
        ),
        (
            geometry(Kind::Mesh(pb::TriangleMesh { mode: 7, ..mesh(triangle, &[0, 1, 2]) })),
            ("OUT_OF_LIMITS", "geometry.mesh.mode", &["SOLID (3)"]),
        ),
        (pb::Geometry { rounding: -0.5, ..sphere(1.0) }, ("OUT_OF_LIMITS", "geometry.rounding", &["is -0.5"])),
        (
            pb::Geometry { rounding: 0.5, ..geometry(Kind::Mesh(mesh(triangle, &[0, 1, 2]))) },
            ("BAD_GEOMETRY", "geometry.rounding", &["mesh"]),
        ),
        (pb::Geometry { scale: Some(0.0), ..sphere(1.0) }, ("OUT_OF_LIMITS", "geometry.scale", &["above 0"])),
        (geometry(Kind::GeometryId("beef".to_owned())), ("GEOMETRY_NOT_FOUND", "geometry.geometry_id", &["\"beef\""])),
        (
            geometry(Kind::HeightField(pb::HeightField::default())),
            ("BAD_GEOMETRY", "geometry.height_field.columns", &["is 0", "2 samples"]),
        ),
        (
            geometry(Kind::HeightField(pb::HeightField { heights: vec![0.0; 5], ..flat() })),
            ("COLUMN_LENGTH", "geometry.height_field.heights", &["5 numbers", "3 columns of 2 rows need 6"]),
        ),
        (
            geometry(Kind::HeightField(pb::HeightField {
                heights: [[0.0; 5].as_slice(), &[f32::NAN]].concat(),
                ..flat()
            })),
            ("NOT_FINITE", "geometry.height_field.heights[5]", &["NaN"]),
        ),
        (
            geometry(Kind::HeightField(pb::HeightField { holes: vec![0, 2], ..flat() })),
            ("BAD_GEOMETRY", "geometry.height_field.holes[1]", &["is 2", "2 cells"]),
        ),
        (
            geometry(Kind::HeightField(pb::HeightField { spacing: Some(vec3(1.0, 0.0, 1.0)), ..flat() })),
            ("OUT_OF_LIMITS", "geometry.height_field.spacing.y", &["is 0"]),
        ),
        (
            pb::Geometry { rounding: 0.5, ..geometry(Kind::HeightField(flat())) },
            ("BAD_GEOMETRY", "geometry.rounding", &["height field"]),
        ),
    ]
}

#[tokio::test]
async fn wrong_geometries_are_refused_wherever_they_stand() {
    let mut bench = Bench::start().await;
    for (wrong, refusal) in
        wrong_numbers().into_iter().chain(wrong_round_forms_and_half_spaces()).chain(unserved_and_dressed())
    {
        let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(wrong.clone()) };
        let status = bench.geometries.create_geometry(request).await.unwrap_err();
        assert_invalid(&status, refusal);
        let status = bench.edit(vec![insert(shape(1, wrong, at(0.0, 0.0, 0.0)))]).await.unwrap_err();
        let (reason, field, parts) = refusal;
        let field = if field.is_empty() { String::new() } else { format!("edits[0].insert.{field}") };
        assert!(status.message().starts_with(&field), "{status}");
        assert!(parts.iter().all(|part| status.message().contains(part)), "{reason}: {status}");
    }
    let status = bench.geometries.create_geometry(pb::CreateGeometryRequest::default()).await.unwrap_err();
    assert_invalid(&status, ("MISSING", "geometry", &["sphere"]));
    let description = bench.describe().await;
    assert_eq!((description.tick, description.shape_count), (1, 0));
    let listed = bench.geometries.list_geometries(pb::ListGeometriesRequest::default()).await.unwrap();
    assert!(listed.into_inner().geometries.is_empty());
}
