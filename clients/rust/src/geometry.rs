//! Builds geometries: forms in their own local frame, sizes in metres.
//!
//! The server validates; these functions only write the message.

use crate::proto::{self, geometry::Kind};
use crate::vec3;

/// A sphere about the local origin.
pub fn sphere(radius: f64) -> proto::Geometry {
    of(Kind::Sphere(proto::Sphere { radius }))
}

/// A box about the local origin, given by half of each edge.
pub fn cuboid(half_extents: [f64; 3]) -> proto::Geometry {
    of(Kind::Box(proto::Cuboid { half_extents: Some(vec3(half_extents)) }))
}

/// All points within `radius` of a segment along y that reaches `half_height` up and down from the local origin.
pub fn capsule(half_height: f64, radius: f64) -> proto::Geometry {
    of(Kind::Capsule(proto::Capsule { half_height, radius }))
}

/// The convex hull of points.
///
/// ```
/// let corner = calipers_client::geometry::hull([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
/// # let Some(calipers_client::proto::geometry::Kind::Hull(hull)) = corner.kind else { panic!() };
/// # assert_eq!(hull.points.len(), 12);
/// ```
pub fn hull(points: impl IntoIterator<Item = [f32; 3]>) -> proto::Geometry {
    of(Kind::Hull(proto::ConvexHull { points: points.into_iter().flatten().collect() }))
}

/// A surface of triangles, felt from both sides; each triangle is three vertex numbers.
pub fn mesh(
    vertices: impl IntoIterator<Item = [f32; 3]>,
    triangles: impl IntoIterator<Item = [u32; 3]>,
) -> proto::Geometry {
    of(Kind::Mesh(proto::TriangleMesh {
        vertices: vertices.into_iter().flatten().collect(),
        indices: triangles.into_iter().flatten().collect(),
        mode: proto::MeshMode::TwoSided.into(),
        decompose: None,
    }))
}

/// A registered geometry, by the id that [`Client::create_geometry`](crate::Client::create_geometry) returned.
pub fn registered(geometry_id: impl Into<String>) -> proto::Geometry {
    of(Kind::GeometryId(geometry_id.into()))
}

fn of(kind: Kind) -> proto::Geometry {
    proto::Geometry { kind: Some(kind), rounding: 0.0, scale: None }
}
