//! Forms: wire to checked geometries, and those back.

use std::sync::Arc;

use collision::{
    DVec3,
    shape::{Convex, Core, Form, Geometry, GeometryError, HalfSpace, Mesh, MeshMode},
};
use wire::v1::{self as pb, geometry::Kind};

use super::{
    built::{stand_ins_out, structures_out},
    compound, height_field,
    number::unknown_enum,
    parts::result_out,
    place::{aabb_out, column_number},
};
use crate::{
    geometries::{Geometries, id_text},
    problem::{Checked, Problem, Reason, Under},
};

/// A geometry of a shape, written in place or named; equal ones are shared within the session.
///
/// # Errors
/// What is wrong with it; kinds that are not served yet; an id that names nothing.
pub(crate) fn of_shape(sent: &pb::Geometry, known: &Geometries) -> Checked<Arc<Geometry>> {
    match named(sent, known)? {
        Some(named) => Ok(named),
        None => Ok(known.share(made_anew(sent, known, 0)?)),
    }
}

/// A geometry of a question, written in place or named.
///
/// # Errors
/// As [`of_shape`].
pub(crate) fn of_question(sent: &pb::Geometry, known: &Geometries) -> Checked<Arc<Geometry>> {
    match named(sent, known)? {
        Some(named) => Ok(named),
        None => Ok(Arc::new(made_anew(sent, known, 0)?)),
    }
}

/// A geometry in a compound that is in so many others.
///
/// # Errors
/// As [`of_shape`].
pub(super) fn part_of(sent: &pb::Geometry, known: &Geometries, level: u32) -> Checked<Arc<Geometry>> {
    match named(sent, known)? {
        Some(named) => Ok(named),
        None => Ok(Arc::new(made_anew(sent, known, level)?)),
    }
}

/// A geometry that is to be registered.
///
/// # Errors
/// As [`of_shape`].
pub(crate) fn registrable(sent: &pb::Geometry, known: &Geometries) -> Checked<Geometry> {
    made_anew(sent, known, 0)
}

/// A registered geometry that is taken as it is.
fn named(sent: &pb::Geometry, known: &Geometries) -> Checked<Option<Arc<Geometry>>> {
    match &sent.kind {
        Some(Kind::GeometryId(id)) if sent.rounding == 0.0 && sent.scale.is_none_or(is_one) => known.get(id).map(Some),
        _ => Ok(None),
    }
}

/// A geometry made from what was sent, be it from another one; it is in so many compounds.
fn made_anew(sent: &pb::Geometry, known: &Geometries, level: u32) -> Checked<Geometry> {
    match &sent.kind {
        Some(Kind::GeometryId(id)) => dressed(Geometry::clone(&*known.get(id)?), sent),
        Some(Kind::Compound(compound)) => dressed(compound::read(compound, known, level).under("compound")?, sent),
        _ => dressed(bare(sent)?, sent),
    }
}

/// The form without rounding and scale, of a kind that holds no others.
fn bare(sent: &pb::Geometry) -> Checked<Geometry> {
    match &sent.kind {
        None => Err(Problem::at(
            "kind",
            Reason::Missing,
            "is absent: a geometry is a point, sphere, box, capsule, cylinder, cone, ellipsoid, hull, half_space, mesh, \
             height_field, compound or geometry_id, such as {\"sphere\": {\"radius\": 1}}",
        )),
        Some(Kind::Point(pb::Point {})) => Ok(Geometry::point()),
        Some(Kind::Sphere(sphere)) => made("sphere", Geometry::sphere(sphere.radius)),
        Some(Kind::Box(cuboid)) => made("box", Geometry::cuboid(vector(cuboid.half_extents))),
        Some(Kind::Capsule(capsule)) => made("capsule", Geometry::capsule(capsule.half_height, capsule.radius)),
        Some(Kind::Cylinder(cylinder)) => made("cylinder", Geometry::cylinder(cylinder.half_height, cylinder.radius)),
        Some(Kind::Cone(cone)) => made("cone", Geometry::cone(cone.half_height, cone.radius)),
        Some(Kind::Ellipsoid(ellipsoid)) => made("ellipsoid", Geometry::ellipsoid(vector(ellipsoid.radii))),
        Some(Kind::HalfSpace(space)) => {
            let normal = space.normal.map_or(DVec3::Y, |normal| vector(Some(normal)));
            made("half_space", Geometry::half_space(normal, space.offset))
        }
        Some(Kind::Hull(hull)) => {
            let points = points("points", &hull.points).under("hull")?;
            made("hull", Geometry::hull(&points))
        }
        Some(Kind::Mesh(mesh)) => triangles(mesh).under("mesh"),
        Some(Kind::HeightField(field)) => height_field::read(field).under("height_field"),
        Some(Kind::Compound(_) | Kind::GeometryId(_)) => {
            Err(Problem::at("kind", Reason::BadGeometry, "is made of other geometries"))
        }
    }
}

/// A vector whose absence is 0; its numbers are checked by what is made of it.
fn vector(sent: Option<pb::Vec3>) -> DVec3 {
    sent.map_or(DVec3::ZERO, |sent| DVec3::new(sent.x, sent.y, sent.z))
}

/// With the rounding and the scale that were sent.
pub(super) fn dressed(geometry: Geometry, sent: &pb::Geometry) -> Checked<Geometry> {
    let geometry = match sent.rounding == 0.0 {
        true => geometry,
        false => made("", geometry.rounded(sent.rounding))?,
    };
    match sent.scale {
        Some(scale) if !is_one(scale) => made("", geometry.scaled(scale)),
        Some(_) | None => Ok(geometry),
    }
}

/// The same form, larger or smaller.
///
/// # Errors
/// A scale that it does not bear.
pub(crate) fn scaled(geometry: &Geometry, scale: f64) -> Checked<Geometry> {
    made("", geometry.clone().scaled(scale))
}

fn is_one(scale: f64) -> bool {
    (1.0..=1.0).contains(&scale)
}

fn triangles(mesh: &pb::TriangleMesh) -> Checked<Geometry> {
    let mode = mode_of(mesh)?;
    if mesh.decompose.is_some() {
        let what = "is asked of a mesh that is written in place: register it with CreateGeometry, and name its id here";
        return Err(Problem::at("decompose", Reason::BadGeometry, what));
    }
    let vertices = points("vertices", &mesh.vertices)?;
    let (indices, rest) = mesh.indices.as_chunks::<3>();
    if !rest.is_empty() {
        let what = format!("has {} numbers: it must have three for each triangle, such as 0, 1, 2", mesh.indices.len());
        return Err(Problem::at("indices", Reason::ColumnLength, what));
    }
    made("", Geometry::mesh_as(mode, &vertices, indices))
}

/// The mode of a mesh.
///
/// # Errors
/// There is no such mode.
pub(super) fn mode_of(mesh: &pb::TriangleMesh) -> Checked<MeshMode> {
    match pb::MeshMode::try_from(mesh.mode) {
        Ok(pb::MeshMode::Unspecified | pb::MeshMode::TwoSided) => Ok(MeshMode::TwoSided),
        Ok(pb::MeshMode::OneSided) => Ok(MeshMode::OneSided),
        Ok(pb::MeshMode::Solid) => Ok(MeshMode::Solid),
        Err(_) => Err(unknown_enum("mode", mesh.mode, "MESH_MODE_TWO_SIDED (1), ONE_SIDED (2), SOLID (3)")),
    }
}

/// A mode as it was sent.
pub(super) fn mode_out(mode: MeshMode) -> pb::MeshMode {
    match mode {
        MeshMode::TwoSided => pb::MeshMode::TwoSided,
        MeshMode::OneSided => pb::MeshMode::OneSided,
        MeshMode::Solid => pb::MeshMode::Solid,
    }
}

fn points(field: &'static str, numbers: &[f32]) -> Checked<Vec<DVec3>> {
    let (points, rest) = numbers.as_chunks::<3>();
    if !rest.is_empty() {
        let what =
            format!("has {} numbers: it must have three (x, y, z) for each point, such as 0, 0, 0", numbers.len());
        return Err(Problem::at(field, Reason::ColumnLength, what));
    }
    let mut checked = Vec::with_capacity(points.len());
    for (place, &[x, y, z]) in points.iter().enumerate() {
        // Checked here and not only in the domain, so that the place is the number's in the list that was sent.
        let number = |offset: usize, value| column_number(field, 3 * place + offset, value);
        checked.push(DVec3::new(number(0, x)?, number(1, y)?, number(2, z)?));
    }
    Ok(checked)
}

pub(super) fn made(kind: &'static str, result: Result<Geometry, GeometryError>) -> Checked<Geometry> {
    result.map_err(refused).under(kind)
}

fn refused(error: GeometryError) -> Problem {
    match error {
        GeometryError::NotFinite { field, value } => super::number::not_finite(field, value),
        GeometryError::OutOfLimits { field, value, allowed } => {
            Problem::at(field, Reason::OutOfLimits, format!("is {value}: it must be {allowed}"))
        }
        GeometryError::ColumnLength { field, found, expected } => {
            Problem::at(field, Reason::ColumnLength, format!("has {found} numbers: {expected}"))
        }
        GeometryError::TooMany { field, found, most } => {
            let what = format!("has {found} items: at most {most} are allowed, so make several geometries of it");
            Problem::at(field, Reason::TooManyItems, what)
        }
        GeometryError::NotSolid { field, fault } => Problem::at(field, Reason::MeshNotClosed, fault.to_string()),
        GeometryError::Bad { field, reason } if reason.starts_with("is ") => {
            Problem::at(field, Reason::BadGeometry, reason)
        }
        GeometryError::Bad { field, reason } => Problem::at(field, Reason::BadGeometry, format!(": {reason}")),
    }
}

/// Whether a geometry is a half space.
pub(crate) fn is_half_space(geometry: &Geometry) -> bool {
    matches!(geometry.form(), Form::HalfSpace(_))
}

/// A geometry as a shape's: simple forms in place, others by id.
pub(crate) fn geometry_out(geometry: &Geometry) -> pb::Geometry {
    let (kind, rounding) = match geometry.form() {
        Form::Convex(convex) => convex_out(convex).unwrap_or_else(|| (by_id(geometry), 0.0)),
        Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_) => (by_id(geometry), 0.0),
        Form::HalfSpace(space) => (half_space_out(space), 0.0),
    };
    pb::Geometry { kind: Some(kind), rounding, scale: None }
}

fn by_id(geometry: &Geometry) -> Kind {
    Kind::GeometryId(id_text(geometry.id()))
}

fn half_space_out(space: &HalfSpace) -> Kind {
    let normal = Some(vector_out(space.normal));
    Kind::HalfSpace(pb::HalfSpace { normal, offset: space.offset })
}

fn vector_out(vector: DVec3) -> pb::Vec3 {
    pb::Vec3 { x: vector.x, y: vector.y, z: vector.z }
}

fn convex_out(convex: &Convex) -> Option<(Kind, f64)> {
    let radius = convex.radius;
    match &convex.core {
        Core::Point if radius > 0.0 => Some((Kind::Sphere(pb::Sphere { radius }), 0.0)),
        Core::Point => Some((Kind::Point(pb::Point {}), 0.0)),
        &Core::Segment { half_height } => Some((Kind::Capsule(pb::Capsule { half_height, radius }), 0.0)),
        &Core::Cuboid { half_extents } => {
            Some((Kind::Box(pb::Cuboid { half_extents: Some(vector_out(half_extents)) }), radius))
        }
        &Core::Cylinder { half_height, radius } => {
            Some((Kind::Cylinder(pb::Cylinder { half_height, radius }), convex.radius))
        }
        &Core::Cone { half_height, radius } => Some((Kind::Cone(pb::Cone { half_height, radius }), convex.radius)),
        &Core::Ellipsoid { radii } => Some((Kind::Ellipsoid(pb::Ellipsoid { radii: Some(vector_out(radii)) }), radius)),
        Core::Hull(_) | Core::Triangle(_) => None,
    }
}

/// What is said of a registered geometry that `shape_count` shapes use.
///
/// # Errors
/// Its bounds are not finite, which is a fault of the server.
pub(crate) fn info_out(geometry: &Geometry, shape_count: u64) -> Checked<pb::GeometryInfo> {
    let Counts { vertex_count, face_count } = counts(geometry);
    let warnings = if let Form::Mesh(mesh) = geometry.form() { mesh_warnings(mesh) } else { Vec::new() };
    Ok(pb::GeometryInfo {
        geometry_id: id_text(geometry.id()),
        state: pb::GeometryState::Ready.into(),
        progress: 1.0,
        bounds: Some(aabb_out(geometry.local_bounds())?),
        vertex_count,
        face_count,
        decomposition: geometry.parts().map(result_out).transpose()?,
        memory_bytes: geometry.memory_bytes(),
        shape_count,
        warnings,
        problem: None,
        stand_ins: stand_ins_out(geometry)?,
        structures: structures_out(geometry),
    })
}

/// Of vertices, and of triangles or cells.
#[derive(Default)]
pub(super) struct Counts {
    pub(super) vertex_count: u64,
    face_count: u64,
}

/// Those of a compound are the sums of those of its parts.
pub(super) fn counts(geometry: &Geometry) -> Counts {
    let of = |vertices: usize, faces: usize| Counts { vertex_count: vertices as u64, face_count: faces as u64 };
    match geometry.form() {
        Form::Convex(convex) => of(convex_vertex_count(&convex.core), 0),
        Form::Mesh(mesh) => of(mesh.vertices().len(), mesh.triangles().len()),
        Form::HeightField(field) => of(field.heights().len(), field.cell_count() - field.holes().len()),
        Form::HalfSpace(_) => Counts::default(),
        Form::Compound(compound) => {
            compound.parts().iter().map(|part| counts(&part.geometry)).fold(Counts::default(), |sum, part| Counts {
                vertex_count: sum.vertex_count + part.vertex_count,
                face_count: sum.face_count + part.face_count,
            })
        }
    }
}

fn convex_vertex_count(core: &Core) -> usize {
    match core {
        Core::Point => 1,
        Core::Segment { .. } => 2,
        Core::Cuboid { .. } => 8,
        Core::Hull(hull) => hull.vertices().len(),
        Core::Triangle(_) => 3,
        Core::Cylinder { .. } | Core::Cone { .. } | Core::Ellipsoid { .. } => 0,
    }
}

fn mesh_warnings(mesh: &Mesh) -> Vec<String> {
    let report = mesh.report();
    let found = [
        (report.degenerate, "triangles without area were left out"),
        (report.merged_vertices, "vertices were equal to an earlier one and merged with it"),
        (report.open_edges, "edges belong to one triangle only: the surface is open there"),
        (report.non_manifold_edges, "edges belong to more than two triangles"),
        (report.duplicates, "triangles have the same three vertices as an earlier one"),
    ];
    let found = found.into_iter().filter(|(count, _)| *count > 0);
    found.map(|(count, what)| format!("{count} {what}")).collect()
}
