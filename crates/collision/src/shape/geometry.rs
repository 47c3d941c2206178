//! A validated, immutable form with the hash of its content.

use std::sync::{Arc, OnceLock};

use glam::DVec3;

use super::{
    Compound, Convex, Core, HalfSpace, HeightField, Hull, Mesh, MeshMode,
    bounds::{local_bounds, placed_bounds, reach},
    compound::distinct,
    identity::content_hash,
    limits::{
        AXES, GeometryError, Limits, check_coordinates, check_count, check_finite, check_size, check_size_or_zero,
        is_size, out_of_limits,
    },
    mode,
};
use crate::math::{Aabb, Pose};

/// The hash of a geometry's content: equal forms have equal ids, on every machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GeometryId(pub [u8; 32]);

/// What a geometry is.
#[derive(Clone, Debug)]
pub enum Form {
    /// A convex form.
    Convex(Convex),
    /// Triangles, as a surface or a body.
    Mesh(Arc<Mesh>),
    /// Everything on one side of a plane.
    HalfSpace(HalfSpace),
    /// Several geometries as one.
    Compound(Arc<Compound>),
    /// A terrain over a grid, with matter below.
    HeightField(Arc<HeightField>),
}

/// An immutable form in its own local frame. Cheap to clone. Its fields are in this order in memory, those first that
/// kernels read: of a simple form they fill one cache line, together with what counts its owners.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Geometry {
    reach: f64,
    form: Form,
    id: OnceLock<GeometryId>,
}

impl Geometry {
    /// A point: the local origin.
    #[must_use]
    pub fn point() -> Self {
        Self::convex(Core::Point, 0.0)
    }

    /// A sphere of `radius` metres.
    ///
    /// # Errors
    /// `radius` is not finite or not within [`Limits`]; 0 is none (that is [`Geometry::point`]).
    pub fn sphere(radius: f64) -> Result<Self, GeometryError> {
        check_size("radius", radius, "from 1e-9 to 1e9 metres (for a single point, send a point)")?;
        Ok(Self::convex(Core::Point, radius))
    }

    /// A box. One or two components may be 0 (a plate, a stick).
    ///
    /// # Errors
    /// A component is not finite, negative, outside [`Limits`], or all are 0.
    pub fn cuboid(half_extents: DVec3) -> Result<Self, GeometryError> {
        for (axis, value) in half_extents.to_array().into_iter().enumerate() {
            let field = || format!("half_extents.{}", AXES[axis]);
            check_size_or_zero(field, value, "0 or from 1e-9 to 1e9 metres")?;
        }
        if half_extents == DVec3::ZERO {
            return Err(GeometryError::Bad {
                field: "half_extents".into(),
                reason: "all are 0: one or two may be (a plate, a stick); for a single point, send a point".into(),
            });
        }
        let half_extents = half_extents + DVec3::ZERO;
        Ok(Self::convex(Core::Cuboid { half_extents }, 0.0))
    }

    /// A capsule along y. `radius` 0 is a segment, `half_height` 0 a ball (the very form, and id, that
    /// [`Geometry::sphere`] makes); both 0 is an error.
    ///
    /// # Errors
    /// As for the others.
    pub fn capsule(half_height: f64, radius: f64) -> Result<Self, GeometryError> {
        let allowed = "0 or from 1e-9 to 1e9 metres";
        check_size_or_zero(|| "half_height".into(), half_height, allowed)?;
        check_size_or_zero(|| "radius".into(), radius, allowed)?;
        match (half_height == 0.0, radius == 0.0) {
            (true, true) => Err(GeometryError::Bad {
                field: "radius".into(),
                reason: "half_height and radius are both 0: one may be; for a single point, send a point".into(),
            }),
            (true, false) => Ok(Self::convex(Core::Point, radius)),
            (false, _) => Ok(Self::convex(Core::Segment { half_height }, radius + 0.0)),
        }
    }

    /// A cylinder along y about the local origin, `half_height` metres to each end.
    ///
    /// # Errors
    /// A number is not finite or not within [`Limits`].
    pub fn cylinder(half_height: f64, radius: f64) -> Result<Self, GeometryError> {
        check_size("half_height", half_height, "from 1e-9 to 1e9 metres")?;
        check_size("radius", radius, "from 1e-9 to 1e9 metres (for a segment, send a capsule of radius 0)")?;
        Ok(Self::convex(Core::Cylinder { half_height, radius }, 0.0))
    }

    /// A cone along y: its base of `radius` metres at −`half_height`, its apex at +`half_height`.
    ///
    /// # Errors
    /// A number is not finite or not within [`Limits`].
    pub fn cone(half_height: f64, radius: f64) -> Result<Self, GeometryError> {
        check_size("half_height", half_height, "from 1e-9 to 1e9 metres")?;
        check_size("radius", radius, "from 1e-9 to 1e9 metres (for a segment, send a capsule of radius 0)")?;
        Ok(Self::convex(Core::Cone { half_height, radius }, 0.0))
    }

    /// An ellipsoid about the local origin. Equal half axes make a ball: the very form, and id, of [`Geometry::sphere`].
    ///
    /// # Errors
    /// A half axis is not finite or not within [`Limits`], or they are more than [`Limits::ELLIPSOID_RATIO`] apart.
    pub fn ellipsoid(radii: DVec3) -> Result<Self, GeometryError> {
        for (axis, value) in radii.to_array().into_iter().enumerate() {
            check_size(&format!("radii.{}", AXES[axis]), value, "from 1e-9 to 1e9 metres")?;
        }
        let (least, most) = (radii.min_element(), radii.max_element());
        if most > least * Limits::ELLIPSOID_RATIO {
            return Err(GeometryError::Bad {
                field: "radii".into(),
                reason: format!(
                    "is {least} to {most} metres: at most 1e6 apart in ratio (for a flat one, send a cylinder)"
                ),
            });
        }
        if least.total_cmp(&most).is_eq() {
            return Ok(Self::convex(Core::Point, least));
        }
        Ok(Self::convex(Core::Ellipsoid { radii }, 0.0))
    }

    /// All points `p` with `dot(normal / |normal|, p) <= offset`: `normal` points outwards and may have any length but 0,
    /// `offset` is in metres along the unit normal.
    ///
    /// # Errors
    /// A number is not finite, `normal` is 0, or `offset` is beyond [`Limits::COORDINATE`].
    ///
    /// ```
    /// use collision::{DVec3, accuracy::Accuracy, answer::Work, math::Pose, narrow, shape::Geometry};
    /// let floor = Geometry::half_space(DVec3::Y * 3.0, 0.5).unwrap();
    /// let ball = Geometry::sphere(0.25).unwrap();
    /// let floor = narrow::Placed { geometry: &floor, pose: Pose::IDENTITY };
    /// let ball = narrow::Placed { geometry: &ball, pose: Pose::at(DVec3::Y * 2.0) };
    /// let apart = narrow::distance(ball, floor, 4e12, &Accuracy::default(), &mut Work::default()).unwrap();
    /// assert_eq!((apart.distance, apart.normal_b_to_a), (1.25, Some(DVec3::Y)));
    /// ```
    pub fn half_space(normal: DVec3, offset: f64) -> Result<Self, GeometryError> {
        Ok(Self::of(Form::HalfSpace(HalfSpace::new(normal, offset)?)))
    }

    /// The convex hull of points: 1 to 65,536, in any order, inner ones allowed, flat or straight sets too.
    ///
    /// # Errors
    /// Not finite, out of limits, none or too many.
    pub fn hull(points: &[DVec3]) -> Result<Self, GeometryError> {
        check_count("points", points.len(), Limits::HULL_POINTS, "a hull needs 1 to 65536 points")?;
        check_coordinates("points", points)?;
        Ok(Self::convex(Core::Hull(Arc::new(Hull::new(points))), 0.0))
    }

    /// A hull that has been made already, of points within the limits.
    pub(crate) fn of_hull(hull: Arc<Hull>) -> Self {
        Self::convex(Core::Hull(hull), 0.0)
    }

    /// A surface of triangles, felt from both sides. Degenerate triangles are left out and counted in the report.
    ///
    /// # Errors
    /// Not finite, out of limits, an index that names no vertex, no triangle at all.
    pub fn mesh(vertices: &[DVec3], indices: &[[u32; 3]]) -> Result<Self, GeometryError> {
        Self::mesh_as(MeshMode::TwoSided, vertices, indices)
    }

    /// As [`Geometry::mesh`], with a mode. Open edges, edges of more than two triangles and triangles that are there twice are
    /// taken (and counted in the report) unless it is [`MeshMode::Solid`].
    ///
    /// # Errors
    /// As [`Geometry::mesh`]; a solid mesh that is not closed or not wound outwards ([`GeometryError::NotSolid`]).
    ///
    /// ```
    /// use collision::{DVec3, shape::{Geometry, GeometryError, MeshMode, SolidFault}};
    /// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let mut faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    /// assert!(Geometry::mesh_as(MeshMode::Solid, &corners, &faces).is_ok());
    /// faces.pop();
    /// let fault = SolidFault::OpenEdge { vertices: [2, 1], triangle: 0 };
    /// let open = Geometry::mesh_as(MeshMode::Solid, &corners, &faces).unwrap_err();
    /// assert_eq!(open, GeometryError::NotSolid { field: "indices".into(), fault });
    /// ```
    pub fn mesh_as(mode: MeshMode, vertices: &[DVec3], indices: &[[u32; 3]]) -> Result<Self, GeometryError> {
        let hint = "a mesh needs 1 to 4000000 triangles, three numbers each";
        check_count("indices", indices.len(), Limits::MESH_TRIANGLES, hint)?;
        let most = 3 * Limits::MESH_TRIANGLES;
        check_count("vertices", vertices.len(), most, "a mesh needs at least 3 vertices")?;
        check_coordinates("vertices", vertices)?;
        let is_beyond = |&index: &u32| index as usize >= vertices.len();
        if let Some(position) = indices.as_flattened().iter().position(is_beyond) {
            return Err(GeometryError::Bad {
                field: format!("indices[{position}]"),
                reason: format!(
                    "is {}: there are {} vertices, so it must be below that",
                    indices.as_flattened()[position],
                    vertices.len()
                ),
            });
        }
        Self::of_mesh(Mesh::new(vertices, indices, mode), "indices", |triangle, k| indices[triangle as usize][k])
    }

    /// The same form with all points within `rounding` of it; convex forms and half spaces only.
    ///
    /// # Errors
    /// `rounding` is not finite, negative or out of limits, or the form is neither convex nor a half space.
    pub fn rounded(self, rounding: f64) -> Result<Self, GeometryError> {
        let allowed = "0 or from 1e-9 to 1e9 metres, the form's own radius included";
        check_size_or_zero(|| "rounding".into(), rounding, allowed)?;
        match self.form {
            Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_) if rounding == 0.0 => Ok(self),
            Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_) => Err(GeometryError::Bad {
                field: "rounding".into(),
                reason:
                    "is above 0: a mesh, compound or height field takes none, only convex forms do, so leave it out"
                        .into(),
            }),
            Form::HalfSpace(half_space) => Ok(Self::of(Form::HalfSpace(half_space.grown(rounding)?))),
            Form::Convex(Convex { core, radius }) => {
                check_size_or_zero(|| "rounding".into(), radius + rounding, allowed)?;
                Ok(Self::convex(core, radius + rounding))
            }
        }
    }

    /// The same form, `scale` times as large, rounding included. Each number is multiplied and rounded to nearest, so
    /// powers of two are exact.
    ///
    /// # Errors
    /// `scale` is not finite or not above 0, or a size leaves the limits.
    pub fn scaled(self, scale: f64) -> Result<Self, GeometryError> {
        check_finite(|| "scale".into(), scale)?;
        let fail = |allowed| out_of_limits("scale".into(), scale, allowed);
        if scale <= 0.0 {
            return Err(fail("above 0"));
        }
        let size = |value: f64| {
            let fits = value == 0.0 || is_size(value * scale);
            fits.then_some(value * scale).ok_or_else(|| fail("such that sizes stay from 1e-9 to 1e9 metres"))
        };
        let (is_bounded, bounds) = (!matches!(self.form, Form::HalfSpace(_)), self.local_bounds());
        let fits = bounds.min.abs().max(bounds.max.abs()).max_element() * scale;
        if is_bounded && fits > Limits::COORDINATE {
            return Err(fail("such that coordinates stay within 1e12 metres"));
        }
        let (core, radius) = match self.form {
            Form::Mesh(mesh) if mesh.parts().is_some() => {
                return Err(GeometryError::Bad {
                    field: "scale".into(),
                    reason: "is given: a mesh with convex parts takes none, so scale the mesh that is decomposed"
                        .into(),
                });
            }
            Form::Mesh(mesh) => {
                let vertex = |triangle, k| mesh.kept_number(triangle).map_or(0, |kept| mesh.triangles()[kept][k]);
                return Self::of_mesh(mesh.scaled(scale), "scale", vertex);
            }
            Form::HalfSpace(half_space) => return Ok(Self::of(Form::HalfSpace(half_space.scaled(scale)?))),
            Form::Compound(compound) => return Self::of_compound(compound.scaled(scale)?, "scale"),
            Form::HeightField(field) => return field.scaled(scale),
            Form::Convex(Convex { core, radius }) => (core, size(radius)?),
        };
        let core = match core {
            Core::Point => Core::Point,
            Core::Segment { half_height } => Core::Segment { half_height: size(half_height)? },
            Core::Cuboid { half_extents: h } => {
                Core::Cuboid { half_extents: DVec3::new(size(h.x)?, size(h.y)?, size(h.z)?) }
            }
            Core::Hull(hull) => {
                let points: Vec<DVec3> = hull.vertices().iter().map(|&vertex| vertex * scale).collect();
                Core::Hull(Arc::new(Hull::new(&points)))
            }
            Core::Triangle(corners) => Core::Triangle(corners.map(|corner| corner * scale)),
            Core::Cylinder { half_height, radius } => {
                Core::Cylinder { half_height: size(half_height)?, radius: size(radius)? }
            }
            Core::Cone { half_height, radius } => Core::Cone { half_height: size(half_height)?, radius: size(radius)? },
            Core::Ellipsoid { radii: r } => Core::Ellipsoid { radii: DVec3::new(size(r.x)?, size(r.y)?, size(r.z)?) },
        };
        Ok(Self::convex(core, radius))
    }

    /// What it is.
    #[must_use]
    pub fn form(&self) -> &Form {
        &self.form
    }

    /// The hash of its content, computed when first asked: blake3 over the kind and its numbers as little-endian f64
    /// (−0 as +0). A hull counts by its distinct points in the order sent; a mesh by its distinct vertices in the order
    /// of their first use, its kept triangles with the numbers they were sent with, and its mode; a compound by the ids and poses of its
    /// parts; a height field by what was sent, its holes in order.
    #[must_use]
    pub fn id(&self) -> GeometryId {
        *self.id.get_or_init(|| content_hash(&self.form))
    }

    /// Its local bounds, rounded outwards; those of a half space end at [`Limits::HALF_SPACE_BOX`].
    #[must_use]
    pub fn local_bounds(&self) -> Aabb {
        local_bounds(&self.form)
    }

    /// The canonical box of this form at a pose: rounded outwards, so that it surely holds every point of the shape.
    /// It is tight for convex forms; that of a turned mesh is the box of its turned local box. Costs a pass over the
    /// points of a hull. That of a half space ends at [`Limits::HALF_SPACE_BOX`], and at its plane if that is along the axes.
    #[must_use]
    pub fn bounds(&self, pose: &Pose) -> Aabb {
        placed_bounds(self, pose)
    }

    /// Radius about the local origin, rounded up; of a half space, that of its box.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Reads something of the memory that a kernel will want of it; what comes out means nothing.
    pub(crate) fn read_ahead(&self) -> u64 {
        self.reach.to_bits()
    }

    /// Bytes it holds in memory now, lazily built structures included, and parts of a compound, each once.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        let Form::Compound(compound) = &self.form else { return self.own_bytes() };
        let parts = distinct(compound.parts().iter().map(|part| &part.geometry));
        self.own_bytes() + parts.into_iter().map(|part| part.own_bytes()).sum::<u64>()
    }

    /// The same without the parts of a compound: what several geometries hold together is the sum over all that are
    /// [`distinct`].
    #[must_use]
    pub fn own_bytes(&self) -> u64 {
        let shared = match &self.form {
            Form::Mesh(mesh) => mesh.memory_bytes(),
            Form::Compound(compound) => compound.own_bytes(),
            Form::HeightField(field) => field.memory_bytes(),
            Form::HalfSpace(_) => 0,
            Form::Convex(convex) => match &convex.core {
                Core::Hull(hull) => hull.memory_bytes(),
                Core::Point
                | Core::Segment { .. }
                | Core::Cuboid { .. }
                | Core::Triangle(_)
                | Core::Cylinder { .. }
                | Core::Cone { .. }
                | Core::Ellipsoid { .. } => 0,
            },
        };
        size_of::<Self>() as u64 + shared
    }

    fn convex(core: Core, radius: f64) -> Self {
        Self::of(Form::Convex(Convex { core, radius }))
    }

    fn of_mesh(mesh: Mesh, field: &str, vertex_as_sent: impl Fn(u32, usize) -> u32) -> Result<Self, GeometryError> {
        if mesh.triangles().is_empty() {
            return Err(GeometryError::Bad {
                field: field.into(),
                reason: "no triangle has an area: at least one must have some".into(),
            });
        }
        mode::check(&mesh, field, vertex_as_sent)?;
        Ok(Self::of(Form::Mesh(Arc::new(mesh))))
    }

    pub(super) fn of(form: Form) -> Self {
        Self { reach: reach(&form), form, id: OnceLock::new() }
    }
}
