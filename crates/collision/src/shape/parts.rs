//! A mesh that brings convex parts along, which stand in for it where a surface has no depth.
//!
//! # Limits
//! A mesh with parts is another geometry than the same mesh without, or with others: answers depend on them. So its id has what
//! was asked of the parts in it, which the same mesh always answers in the same way.

use std::sync::Arc;

use super::{Form, Geometry, GeometryError, GeometryId, compound::Part, identity::id_with_parts};
use crate::{
    answer::{Bound, Stop},
    math::Pose,
};

/// What is asked of the convex parts of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartsAsked {
    /// At most so many.
    pub max_parts: u32,
    /// How near to the mesh they are to be, metres; 0 for the usual.
    pub max_error: f64,
}

/// The convex parts of a mesh, and what they are worth.
#[derive(Clone, Debug)]
pub struct MeshParts {
    /// What was asked of them.
    pub asked: PartsAsked,
    /// All of them: a compound of hulls in the mesh's frame.
    pub whole: Geometry,
    /// How many there are.
    pub part_count: u32,
    /// The greatest distance of a point of the mesh from the nearest part, metres.
    pub outside: Bound,
    /// The greatest distance of a point of a part from the mesh, metres.
    pub inside: Bound,
    /// Volume of the parts beyond that of the mesh, as a part of it; `None` unless the mesh is closed.
    pub volume_excess: Option<f64>,
    /// Why they were made no finer.
    pub stop: Stop,
}

impl Geometry {
    /// The same mesh with its convex parts.
    ///
    /// # Errors
    /// It is no mesh, or the parts are no compound.
    pub fn with_parts(&self, parts: MeshParts) -> Result<Self, GeometryError> {
        let Form::Mesh(mesh) = self.form() else {
            return Err(no_mesh());
        };
        let made = Self::of(Form::Mesh(Arc::new(mesh.with_parts(parts))));
        Ok(made)
    }

    /// The id of the same mesh with the convex parts that it has if so asked.
    #[must_use]
    pub fn id_with_parts(&self, asked: &PartsAsked) -> GeometryId {
        id_with_parts(self.id(), asked)
    }

    /// The convex parts that it brings along, if it is a mesh that does.
    #[must_use]
    pub fn parts(&self) -> Option<&MeshParts> {
        match self.form() {
            Form::Mesh(mesh) => mesh.parts(),
            Form::Convex(_) | Form::HalfSpace(_) | Form::Compound(_) | Form::HeightField(_) => None,
        }
    }

    /// Hulls in one frame, as one geometry.
    ///
    /// # Errors
    /// There are none, or too many.
    pub(crate) fn of_hulls(hulls: impl Iterator<Item = Self>) -> Result<Self, GeometryError> {
        let part = |hull| Part { geometry: Arc::new(hull), pose: Pose::IDENTITY };
        Self::compound(hulls.map(part).collect())
    }
}

fn no_mesh() -> GeometryError {
    GeometryError::Bad { field: "geometry".into(), reason: "is no mesh: only meshes are cut into convex parts".into() }
}
