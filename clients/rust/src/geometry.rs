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

/// A cylinder along y about the local origin, `half_height` to each end.
pub fn cylinder(half_height: f64, radius: f64) -> proto::Geometry {
    of(Kind::Cylinder(proto::Cylinder { half_height, radius }))
}

/// A cone along y: its base of `radius` at −`half_height`, its apex at +`half_height`.
pub fn cone(half_height: f64, radius: f64) -> proto::Geometry {
    of(Kind::Cone(proto::Cone { half_height, radius }))
}

/// An ellipsoid about the local origin, given by its half axes along x, y and z.
pub fn ellipsoid(radii: [f64; 3]) -> proto::Geometry {
    of(Kind::Ellipsoid(proto::Ellipsoid { radii: Some(vec3(radii)) }))
}

/// All points `p` with `dot(normal / |normal|, p) <= offset`; `normal` points outwards and may have any length but 0. It
/// can be a shape of the world, or what a question is asked against, but not its subject.
pub fn half_space(normal: [f64; 3], offset: f64) -> proto::Geometry {
    of(Kind::HalfSpace(proto::HalfSpace { normal: Some(vec3(normal)), offset }))
}

/// The same form with all points within `rounding` of it: convex kinds and half spaces only.
///
/// ```
/// use calipers_client::geometry;
/// let dice = geometry::rounded(geometry::cuboid([0.9, 0.9, 0.9]), 0.1);
/// assert_eq!(dice.rounding, 0.1);
/// ```
pub fn rounded(geometry: proto::Geometry, rounding: f64) -> proto::Geometry {
    proto::Geometry { rounding, ..geometry }
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
    mesh_as(proto::MeshMode::TwoSided, vertices, triangles)
}

/// A surface of triangles, felt from their fronts: the sides from which their corners go counter-clockwise.
pub fn one_sided_mesh(
    vertices: impl IntoIterator<Item = [f32; 3]>,
    triangles: impl IntoIterator<Item = [u32; 3]>,
) -> proto::Geometry {
    mesh_as(proto::MeshMode::OneSided, vertices, triangles)
}

/// A body within a closed surface of triangles whose fronts look outwards: what lies inside is in it.
///
/// ```
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let body = calipers_client::geometry::solid_mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
/// # let Some(calipers_client::proto::geometry::Kind::Mesh(mesh)) = body.kind else { panic!() };
/// # assert_eq!((mesh.mode, mesh.indices.len()), (calipers_client::proto::MeshMode::Solid as i32, 12));
/// ```
pub fn solid_mesh(
    vertices: impl IntoIterator<Item = [f32; 3]>,
    triangles: impl IntoIterator<Item = [u32; 3]>,
) -> proto::Geometry {
    mesh_as(proto::MeshMode::Solid, vertices, triangles)
}

fn mesh_as(
    mode: proto::MeshMode,
    vertices: impl IntoIterator<Item = [f32; 3]>,
    triangles: impl IntoIterator<Item = [u32; 3]>,
) -> proto::Geometry {
    of(Kind::Mesh(proto::TriangleMesh {
        vertices: vertices.into_iter().flatten().collect(),
        indices: triangles.into_iter().flatten().collect(),
        mode: mode.into(),
        decompose: None,
    }))
}

/// The same mesh with convex parts, so that two meshes have contacts: the server cuts it once it is registered, with
/// [`Client::create_geometry`](crate::Client::create_geometry), and it can be placed when it is READY, which
/// [`Client::get_geometry`](crate::Client::get_geometry) waits for if told so. At most `max_parts` parts, 1 to 1024, or 0 for 32;
/// they need not be nearer to the mesh than `max_error` metres, or 0 for 1 % of its diagonal. Other forms stay as they are.
///
/// ```
/// use calipers_client::geometry;
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let surface = geometry::mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
/// let parted = geometry::with_parts(surface, 8, 0.01);
/// # let Some(calipers_client::proto::geometry::Kind::Mesh(mesh)) = parted.kind else { panic!() };
/// # assert_eq!(mesh.decompose.map(|asked| (asked.max_parts, asked.max_error)), Some((8, 0.01)));
/// ```
pub fn with_parts(mut geometry: proto::Geometry, max_parts: u32, max_error: f64) -> proto::Geometry {
    if let Some(Kind::Mesh(mesh)) = &mut geometry.kind {
        mesh.decompose = Some(proto::Decompose { max_parts, max_error, max_steps: 0 });
    }
    geometry
}

/// The same where the making of the parts that [`with_parts`] asks for ends after about `max_steps` steps, some 100 ns each, with what is
/// made by then: the same parts on every machine. At least 1; a server may allow fewer than are asked, and says so. Forms without
/// parts stay as they are.
///
/// ```
/// use calipers_client::geometry;
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let surface = geometry::mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
/// let soon = geometry::within_steps(geometry::with_parts(surface, 8, 0.01), 10_000_000);
/// # let Some(calipers_client::proto::geometry::Kind::Mesh(mesh)) = soon.kind else { panic!() };
/// # assert_eq!(mesh.decompose.map(|asked| (asked.max_parts, asked.max_steps)), Some((8, 10_000_000)));
/// ```
pub fn within_steps(mut geometry: proto::Geometry, max_steps: u64) -> proto::Geometry {
    if let Some(Kind::Mesh(mesh)) = &mut geometry.kind
        && let Some(asked) = &mut mesh.decompose
    {
        asked.max_steps = max_steps;
    }
    geometry
}

/// A terrain: heights along y over a grid in x and z that begins at the local origin, row by row, each row `columns` long.
/// `spacing` is the distance of samples along x and z and the factor on heights. Matter is below; cells are left open with
/// [`with_holes`].
///
/// ```
/// use calipers_client::geometry;
/// let step = geometry::height_field(2, [0.0, 1.0, 0.0, 1.0, 0.0, 2.0], [0.5, 1.0, 0.5]);
/// # let Some(calipers_client::proto::geometry::Kind::HeightField(field)) = step.kind else { panic!() };
/// # assert_eq!((field.columns, field.rows), (2, 3));
/// ```
pub fn height_field(columns: u32, heights: impl IntoIterator<Item = f32>, spacing: [f64; 3]) -> proto::Geometry {
    let heights: Vec<f32> = heights.into_iter().collect();
    let rows = u32::try_from(heights.len() / columns.max(1) as usize).unwrap_or(u32::MAX);
    let spacing = Some(vec3(spacing));
    of(Kind::HeightField(proto::HeightField { columns, rows, heights, spacing, holes: Vec::new() }))
}

/// The same terrain with cells left open, each `row * (columns - 1) + column`; other forms stay as they are.
pub fn with_holes(mut geometry: proto::Geometry, holes: impl IntoIterator<Item = u32>) -> proto::Geometry {
    if let Some(Kind::HeightField(field)) = &mut geometry.kind {
        field.holes = holes.into_iter().collect();
    }
    geometry
}

/// Several geometries as one, each at a pose in the frame of the whole.
///
/// ```
/// use calipers_client::{geometry, proto};
/// let at = |x| proto::Pose { position: Some(proto::Vec3 { x, y: 0.0, z: 0.0 }), rotation: None };
/// let dumbbell = geometry::compound([(geometry::sphere(0.5), at(-1.0)), (geometry::sphere(0.5), at(1.0))]);
/// # let Some(proto::geometry::Kind::Compound(compound)) = dumbbell.kind else { panic!() };
/// # assert_eq!(compound.parts.len(), 2);
/// ```
pub fn compound(parts: impl IntoIterator<Item = (proto::Geometry, proto::Pose)>) -> proto::Geometry {
    let part = |(geometry, pose)| proto::CompoundPart { geometry: Some(geometry), pose: Some(pose) };
    of(Kind::Compound(proto::Compound { parts: parts.into_iter().map(part).collect() }))
}

/// A registered geometry, by the id that [`Client::create_geometry`](crate::Client::create_geometry) returned.
pub fn registered(geometry_id: impl Into<String>) -> proto::Geometry {
    of(Kind::GeometryId(geometry_id.into()))
}

fn of(kind: Kind) -> proto::Geometry {
    proto::Geometry { kind: Some(kind), rounding: 0.0, scale: None }
}
