//! Convex parts of a mesh, which stand in for it where a surface has no depth: those that it brings along, and those that are made
//! of it for questions that name an error.
//!
//! # Method
//! Questions are as many as there are errors; so that they share parts, these are made in a few steps of fineness, each half as far
//! from the mesh as the one before. Which step a question needs follows from its error and the mesh. A mesh keeps the parts of
//! each step once they are made. Whether they are there yet changes no answer, only whether there is one.
//!
//! # Limits
//! A mesh with parts is another geometry than the same mesh without, or with others: answers depend on them. So its id has what
//! was asked of the parts in it, which the same mesh always answers in the same way.

use std::sync::{Arc, OnceLock};

use super::{Form, Geometry, GeometryError, GeometryId, Mesh, compound::Part, identity::id_with_parts, lazy::Receipt};
use crate::{
    answer::{Bound, Stop},
    math::{Norm, Pose},
};

/// What is asked of the convex parts of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartsAsked {
    /// At most so many.
    pub max_parts: u32,
    /// How near to the mesh they are to be, metres; 0 for the usual.
    pub max_error: f64,
    /// Steps that making them may take.
    pub max_steps: u64,
}

impl PartsAsked {
    /// Steps where nothing is said: minutes.
    pub const STEPS_USUAL: u64 = 1 << 32;
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
    /// Steps that making them took.
    pub steps: u64,
    /// What making them took, and when they were asked for.
    pub receipt: Receipt,
}

/// How near to its mesh parts are that are made for questions: one of a few steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Fineness(u8);

impl Fineness {
    /// How many steps there are.
    const COUNT: u8 = 8;

    /// Parts of the diagonal of the mesh's box that the coarsest step allows: coarser parts are as good as its hull.
    const COARSEST: f64 = 1.0 / 8.0;

    /// The coarsest step whose error for a mesh is within `max_error` metres, or the finest there is, a thousandth of the diagonal.
    ///
    /// ```
    /// use collision::{DVec3, shape::{Fineness, Form, Geometry}};
    /// let corners = [DVec3::ZERO, DVec3::X * 8.0, DVec3::Z];
    /// let geometry = Geometry::mesh(&corners, &[[0, 1, 2]]).unwrap();
    /// let Form::Mesh(mesh) = geometry.form() else { panic!("a mesh") };
    /// let step = Fineness::within(0.3, mesh);
    /// assert!(step.max_error(mesh) <= 0.3 && step.max_error(mesh) > 0.15);
    /// assert_eq!(Fineness::within(0.0, mesh), Fineness::within(1e-9, mesh));
    /// ```
    #[must_use]
    pub fn within(max_error: f64, mesh: &Mesh) -> Self {
        let steps = (0..Self::COUNT).map(Self);
        steps.clone().find(|step| step.max_error(mesh) <= max_error).unwrap_or(Self(Self::COUNT - 1))
    }

    /// How far from the mesh parts of this step are to be at most, metres.
    #[must_use]
    pub fn max_error(self, mesh: &Mesh) -> f64 {
        let bounds = mesh.bounds();
        (bounds.max - bounds.min).norm() * Self::COARSEST / f64::from(1_u32 << self.0)
    }
}

/// The parts of a mesh that were made for questions, step by step.
#[derive(Clone, Debug, Default)]
pub(super) struct MadeParts([OnceLock<Arc<MeshParts>>; Fineness::COUNT as usize]);

impl MadeParts {
    pub(super) fn memory_bytes(&self) -> u64 {
        self.0.iter().filter_map(OnceLock::get).map(|parts| parts.whole.memory_bytes()).sum()
    }
}

impl Mesh {
    /// The parts of a step, once they are made.
    #[must_use]
    pub fn made_parts(&self, step: Fineness) -> Option<&MeshParts> {
        self.made().0[usize::from(step.0)].get().map(Arc::as_ref)
    }

    /// All parts that were made for questions, the coarsest first.
    pub fn all_made_parts(&self) -> impl Iterator<Item = &MeshParts> {
        self.made().0.iter().filter_map(|parts| parts.get().map(Arc::as_ref))
    }

    /// Keeps the parts of a step; those that came first stay.
    pub(crate) fn keep_parts(&self, step: Fineness, parts: MeshParts) {
        self.made().0[usize::from(step.0)].get_or_init(|| Arc::new(parts));
    }
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
