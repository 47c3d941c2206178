//! A validated, immutable form with the hash of its content.

use std::sync::{Arc, OnceLock};

use glam::DVec3;

use super::{Convex, Core, Hull, Mesh};
use crate::math::{Aabb, Pose};

/// The hash of a geometry's content: equal forms have equal ids, on every machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GeometryId(pub [u8; 32]);

/// What a geometry is.
#[derive(Clone, Debug)]
pub enum Form {
    /// A convex form.
    Convex(Convex),
    /// A surface of triangles, felt from both sides.
    Mesh(Arc<Mesh>),
}

/// An immutable form in its own local frame. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Geometry {
    form: Form,
    id: OnceLock<GeometryId>,
}

/// The limits within which numbers are accepted.
#[derive(Debug)]
pub struct Limits;

impl Limits {
    /// Coordinates lie within this of 0, metres.
    pub const COORDINATE: f64 = 1e12;
    /// Sizes are at least this, metres, or 0 where that is a form.
    pub const SIZE_MIN: f64 = 1e-9;
    /// Sizes are at most this, metres.
    pub const SIZE_MAX: f64 = 1e9;
    /// Most points of a hull.
    pub const HULL_POINTS: usize = 65_536;
    /// Most triangles of a mesh.
    pub const MESH_TRIANGLES: usize = 4_000_000;
}

/// Why a form is refused. `field` names it as the API does, such as `half_extents.y` or `points[7]`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GeometryError {
    /// NaN or infinite.
    #[error("{field} is {value}: it must be a finite number")]
    NotFinite {
        /// Which number.
        field: String,
        /// What was found.
        value: f64,
    },
    /// Outside the limits.
    #[error("{field} is {value}: it must be {allowed}")]
    OutOfLimits {
        /// Which number.
        field: String,
        /// What was found.
        value: f64,
        /// What would be right.
        allowed: &'static str,
    },
    /// The length of a list is wrong.
    #[error("{field} has {found} numbers: {expected}")]
    ColumnLength {
        /// Which list.
        field: String,
        /// How many there were.
        found: usize,
        /// What would be right.
        expected: String,
    },
    /// Too many items.
    #[error("{field} has {found} items: at most {most} are allowed")]
    TooMany {
        /// Which list.
        field: String,
        /// How many there were.
        found: usize,
        /// How many may be.
        most: usize,
    },
    /// An index that names nothing, or a form that is none.
    #[error("{field}: {reason}")]
    Bad {
        /// Which part.
        field: String,
        /// What is wrong and what would be right.
        reason: String,
    },
}

impl Geometry {
    /// A point: the local origin.
    #[must_use]
    pub fn point() -> Self {
        Self::of(Form::Convex(Convex {
            core: Core::Point,
            radius: 0.0,
        }))
    }

    /// A sphere of `radius` metres.
    ///
    /// # Errors
    /// `radius` is not finite or not within [`Limits`]; 0 is none (that is [`Geometry::point`]).
    pub fn sphere(_radius: f64) -> Result<Self, GeometryError> {
        todo!()
    }

    /// A box. One or two components may be 0 (a plate, a stick).
    ///
    /// # Errors
    /// A component is not finite, negative, outside [`Limits`], or all are 0.
    pub fn cuboid(_half_extents: DVec3) -> Result<Self, GeometryError> {
        todo!()
    }

    /// A capsule along y. `radius` 0 is a segment, `half_height` 0 a ball; both 0 is an error.
    ///
    /// # Errors
    /// As for the others.
    pub fn capsule(_half_height: f64, _radius: f64) -> Result<Self, GeometryError> {
        todo!()
    }

    /// The convex hull of points: 1 to 65,536, in any order, inner ones allowed, flat or straight sets too.
    ///
    /// # Errors
    /// Not finite, out of limits, none or too many.
    pub fn hull(_points: &[DVec3]) -> Result<Self, GeometryError> {
        todo!()
    }

    /// A surface of triangles, felt from both sides. Degenerate triangles are left out and counted in the report.
    ///
    /// # Errors
    /// Not finite, out of limits, an index that names no vertex, no triangle at all.
    pub fn mesh(_vertices: &[DVec3], _indices: &[[u32; 3]]) -> Result<Self, GeometryError> {
        todo!()
    }

    /// The same form with all points within `rounding` of it; convex forms only.
    ///
    /// # Errors
    /// `rounding` is not finite, negative or out of limits, or the form is a mesh.
    pub fn rounded(self, _rounding: f64) -> Result<Self, GeometryError> {
        todo!()
    }

    /// The same form, `scale` times as large, rounding included.
    ///
    /// # Errors
    /// `scale` is not finite or not above 0, or a size leaves the limits.
    pub fn scaled(self, _scale: f64) -> Result<Self, GeometryError> {
        todo!()
    }

    /// What it is.
    #[must_use]
    pub fn form(&self) -> &Form {
        &self.form
    }

    /// The hash of its content, computed when first asked.
    #[must_use]
    pub fn id(&self) -> GeometryId {
        todo!()
    }

    /// Its local bounds.
    #[must_use]
    pub fn local_bounds(&self) -> Aabb {
        todo!()
    }

    /// The canonical box of this form at a pose: rounded outwards, so that it surely holds every point of the shape.
    #[must_use]
    pub fn bounds(&self, _pose: &Pose) -> Aabb {
        todo!()
    }

    /// Radius about the local origin, rounded up.
    #[must_use]
    pub fn reach(&self) -> f64 {
        todo!()
    }

    /// Bytes it holds in memory now, lazily built structures included.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        todo!()
    }

    fn of(form: Form) -> Self {
        Self {
            form,
            id: OnceLock::new(),
        }
    }
}
