//! The hash of a form's content.

use glam::DVec3;

use super::{Compound, Convex, Core, Form, GeometryId, HalfSpace, HeightField, Mesh, MeshMode, PartsAsked};

/// Names the byte form below; another layout takes another name, so that ids of the two never meet.
const LAYOUT: &[u8] = b"calipers geometry 1";

pub(super) fn content_hash(form: &Form) -> GeometryId {
    let mut content = Content(blake3::Hasher::new());
    content.0.update(LAYOUT);
    match form {
        Form::Convex(convex) => content.convex(convex),
        Form::Mesh(mesh) => content.mesh(mesh),
        Form::HalfSpace(half_space) => content.half_space(half_space),
        Form::Compound(compound) => content.compound(compound),
        Form::HeightField(field) => content.height_field(field),
    }
    let bare = GeometryId(*content.0.finalize().as_bytes());
    match form {
        Form::Mesh(mesh) => mesh.parts().map_or(bare, |parts| id_with_parts(bare, &parts.asked)),
        Form::Convex(_) | Form::HalfSpace(_) | Form::Compound(_) | Form::HeightField(_) => bare,
    }
}

/// The id of a mesh, whose own id is `bare`, with the convex parts that it has if so asked.
pub(super) fn id_with_parts(bare: GeometryId, asked: &PartsAsked) -> GeometryId {
    let mut content = Content(blake3::Hasher::new());
    content.0.update(LAYOUT);
    content.kind(20);
    content.0.update(&bare.0);
    content.count(asked.max_parts as usize);
    content.number(asked.max_error);
    // So that what was asked before steps could be named keeps its id.
    if asked.max_steps != PartsAsked::STEPS_USUAL {
        content.0.update(&asked.max_steps.to_le_bytes());
    }
    GeometryId(*content.0.finalize().as_bytes())
}

struct Content(blake3::Hasher);

impl Content {
    fn convex(&mut self, convex: &Convex) {
        match &convex.core {
            Core::Point => self.kind(0),
            Core::Segment { half_height } => {
                self.kind(1);
                self.number(*half_height);
            }
            Core::Cuboid { half_extents } => {
                self.kind(2);
                self.point(*half_extents);
            }
            Core::Hull(hull) => {
                self.kind(3);
                self.count(hull.vertices().len());
                hull.vertices().iter().for_each(|&vertex| self.point(vertex));
            }
            Core::Triangle(corners) => {
                self.kind(4);
                corners.iter().for_each(|&corner| self.point(corner));
            }
            Core::Cylinder { half_height, radius } => {
                self.kind(6);
                self.number(*half_height);
                self.number(*radius);
            }
            Core::Cone { half_height, radius } => {
                self.kind(7);
                self.number(*half_height);
                self.number(*radius);
            }
            Core::Ellipsoid { radii } => {
                self.kind(8);
                self.point(*radii);
            }
        }
        self.number(convex.radius);
    }

    fn mesh(&mut self, mesh: &Mesh) {
        self.kind(5);
        self.count(mesh.vertices().len());
        mesh.vertices().iter().for_each(|&vertex| self.point(vertex));
        self.count(mesh.triangles().len());
        for (index, triangle) in mesh.triangles().iter().enumerate() {
            for number in triangle.iter().chain([&mesh.sent_number(index)]) {
                self.0.update(&number.to_le_bytes());
            }
        }
        // The lists before say how long they are, so one byte more is no other mesh; two-sided ones came first, without it.
        match mesh.mode() {
            MeshMode::TwoSided => {}
            MeshMode::OneSided => self.kind(1),
            MeshMode::Solid => self.kind(2),
        }
    }

    /// The normal counts as it was sent: equal sets whose normals differ in length have different ids.
    fn half_space(&mut self, half_space: &HalfSpace) {
        self.kind(9);
        self.point(half_space.normal);
        self.number(half_space.offset);
    }

    /// Parts count by their ids, in the order sent, and their rotations as they were sent.
    fn compound(&mut self, compound: &Compound) {
        self.kind(10);
        self.count(compound.parts().len());
        for part in compound.parts() {
            self.0.update(&part.geometry.id().0);
            self.point(part.pose.position);
            part.pose.rotation.to_array().into_iter().for_each(|value| self.number(value));
        }
    }

    /// Heights count as they were sent, with the spacing that they are multiplied by.
    fn height_field(&mut self, field: &HeightField) {
        self.kind(11);
        self.count(field.columns());
        self.count(field.rows());
        self.point(field.spacing());
        for height in field.heights() {
            self.0.update(&(height + 0.0).to_le_bytes());
        }
        self.count(field.holes().len());
        for hole in field.holes() {
            self.0.update(&hole.to_le_bytes());
        }
    }

    fn kind(&mut self, kind: u8) {
        self.0.update(&[kind]);
    }

    fn count(&mut self, count: usize) {
        self.0.update(&(count as u64).to_le_bytes());
    }

    fn point(&mut self, point: DVec3) {
        point.to_array().into_iter().for_each(|value| self.number(value));
    }

    fn number(&mut self, value: f64) {
        self.0.update(&(value + 0.0).to_le_bytes());
    }
}
