//! The long lists of a geometry, which are sent back in chunks.

use std::ops::Range;

use collision::shape::{Compound, Convex, Core, Form, Geometry, HeightField, Hull, Mesh, Part};
use wire::v1::{self as pb, geometry::Kind};

use super::{
    geometry::{geometry_out, mode_out},
    height_field,
    parts::asked_out,
    place::pose_out,
};

/// How many numbers there are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lists {
    /// Coordinates or heights.
    pub(crate) value_count: usize,
    /// Indices or holes.
    pub(crate) index_count: usize,
}

impl Lists {
    /// The lists of a geometry; those of a kind that one message holds are empty.
    pub(crate) fn of(geometry: &Geometry) -> Self {
        let (value_count, index_count) = match Long::of(geometry) {
            Some(Long::Hull(hull)) => (3 * hull.vertices().len(), 0),
            Some(Long::Mesh(mesh)) => (3 * mesh.vertices().len(), 3 * mesh.sent_count()),
            Some(Long::Field(field)) => (field.heights().len(), field.holes().len()),
            None => (0, 0),
        };
        Self { value_count, index_count }
    }

    /// Some of the coordinates or heights, rounded to single precision: those that were sent are back as they came.
    pub(crate) fn values(self, geometry: &Geometry, range: Range<usize>) -> Vec<f32> {
        let points = match Long::of(geometry) {
            Some(Long::Hull(hull)) => hull.vertices(),
            Some(Long::Mesh(mesh)) => mesh.vertices(),
            Some(Long::Field(field)) => return field.heights()[range].to_vec(),
            None => &[],
        };
        range.map(|number| points[number / 3][number % 3] as f32).collect()
    }

    /// Some of the indices or holes. Triangles that were left out are back as three times the first vertex, so that the others keep
    /// the numbers they were sent with.
    pub(crate) fn indices(self, geometry: &Geometry, range: Range<usize>) -> Vec<u32> {
        let mesh = match Long::of(geometry) {
            Some(Long::Mesh(mesh)) => mesh,
            Some(Long::Field(field)) => return field.holes()[range].to_vec(),
            Some(Long::Hull(_)) | None => return Vec::new(),
        };
        let corner = |number: usize| {
            let kept = u32::try_from(number / 3).ok().and_then(|sent| mesh.kept_number(sent));
            kept.map_or(0, |kept| mesh.triangles()[kept][number % 3])
        };
        range.map(corner).collect()
    }
}

/// What comes before the lists.
pub(crate) fn header_out(geometry: &Geometry, lists: Lists) -> pb::GeometryHeader {
    let form = match geometry.form() {
        Form::Convex(Convex { core: Core::Hull(_), radius }) => {
            let kind = Some(Kind::Hull(pb::ConvexHull { points: Vec::new() }));
            pb::Geometry { kind, rounding: *radius, scale: None }
        }
        Form::Mesh(mesh) => {
            let mode = mode_out(mesh.mode()).into();
            let decompose = mesh.parts().map(asked_out);
            let kind = Some(Kind::Mesh(pb::TriangleMesh { mode, decompose, ..pb::TriangleMesh::default() }));
            pb::Geometry { kind, ..pb::Geometry::default() }
        }
        Form::HeightField(field) => {
            let kind = Some(Kind::HeightField(height_field::header_out(field)));
            pb::Geometry { kind, ..pb::Geometry::default() }
        }
        Form::Compound(compound) => whole_compound(compound),
        Form::Convex(_) | Form::HalfSpace(_) => geometry_out(geometry),
    };
    pb::GeometryHeader {
        geometry: Some(form),
        value_count: lists.value_count as u64,
        index_count: lists.index_count as u64,
    }
}

/// A compound with all that its parts hold.
fn whole_compound(compound: &Compound) -> pb::Geometry {
    let part =
        |part: &Part| pb::CompoundPart { geometry: Some(whole(&part.geometry)), pose: Some(pose_out(&part.pose)) };
    let parts = compound.parts().iter().map(part).collect();
    pb::Geometry { kind: Some(Kind::Compound(pb::Compound { parts })), ..pb::Geometry::default() }
}

/// A geometry with its lists in it.
fn whole(geometry: &Geometry) -> pb::Geometry {
    let lists = Lists::of(geometry);
    let mut form = header_out(geometry, lists).geometry.unwrap_or_default();
    match &mut form.kind {
        Some(Kind::Hull(hull)) => hull.points = lists.values(geometry, 0..lists.value_count),
        Some(Kind::Mesh(mesh)) => {
            mesh.vertices = lists.values(geometry, 0..lists.value_count);
            mesh.indices = lists.indices(geometry, 0..lists.index_count);
        }
        Some(Kind::HeightField(field)) => {
            field.heights = lists.values(geometry, 0..lists.value_count);
            field.holes = lists.indices(geometry, 0..lists.index_count);
        }
        Some(_) | None => {}
    }
    form
}

/// What has long lists.
enum Long<'a> {
    Hull(&'a Hull),
    Mesh(&'a Mesh),
    Field(&'a HeightField),
}

impl<'a> Long<'a> {
    fn of(geometry: &'a Geometry) -> Option<Self> {
        match geometry.form() {
            Form::Convex(Convex { core: Core::Hull(hull), .. }) => Some(Self::Hull(hull)),
            Form::Mesh(mesh) => Some(Self::Mesh(mesh)),
            Form::HeightField(field) => Some(Self::Field(field)),
            Form::Convex(_) | Form::HalfSpace(_) | Form::Compound(_) => None,
        }
    }
}
