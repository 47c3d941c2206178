//! Convex hulls of points: their vertices, and their faces and edges once a question needs them.
//!
//! # Limits
//! The vertices are the distinct points as sent, inner ones included: the support function passes over those. Faces are
//! whole polygons (triangles in exactly one plane are one face).

use glam::DVec3;

use super::{
    bounds::{around, farthest},
    built::Structure,
    climb::Slopes,
    farthest::Columns,
    ladder::Ladder,
    lazy::Lazy,
    quickhull,
    topology::{Edge, Face, Topology},
};
use crate::math::{Aabb, Norm};

/// The convex hull of points, which may be flat, straight or a single point.
#[derive(Debug)]
pub struct Hull {
    vertices: Vec<DVec3>,
    columns: Columns,
    reach: f64,
    reach_up: f64,
    center: DVec3,
    bounds: Aabb,
    topology: Lazy<Topology>,
    slopes: Lazy<Slopes>,
    normals: Lazy<Columns>,
    ladder: Ladder,
}

impl Hull {
    /// With more vertices than this, walking over the edges finds a support sooner than looking at all of them.
    /// Measured with random directions, see the module of the walk.
    pub const CLIMB_ABOVE: usize = 64;

    /// From so many vertices on, simpler forms may stand in for it. Below, climbing to 10 % costs no less than asking the hull:
    /// 1.0 µs and 0.9 µs with 128 vertices, 1.1 µs and 1.0 µs with 256, but 1.1 µs and 1.3 µs with 1,024.
    pub const STAND_INS_FROM: usize = 512;

    /// The hull of `points`, at least one, all finite. The topology is built when a question first needs it.
    #[must_use]
    pub fn new(points: &[DVec3]) -> Self {
        let vertices = quickhull::distinct(points);
        Self {
            columns: Columns::new(&vertices),
            reach: vertices.iter().map(|vertex| vertex.length_squared()).fold(0.0, f64::max).sqrt(),
            reach_up: farthest(&vertices),
            center: vertices.iter().sum::<DVec3>() / vertices.len() as f64,
            bounds: around(&vertices),
            vertices,
            topology: Lazy::default(),
            slopes: Lazy::default(),
            normals: Lazy::default(),
            ladder: Ladder::default(),
        }
    }

    /// The distinct points, in the order they were sent.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// One of them by its number, from the memory that [`Hull::farthest`] looks at.
    #[must_use]
    #[inline]
    pub fn vertex(&self, index: u32) -> DVec3 {
        self.columns.point(index)
    }

    /// Largest distance of a vertex from the local origin, metres, to within a few roundings.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The same, rounded up.
    pub(super) fn reach_up(&self) -> f64 {
        self.reach_up
    }

    /// The mean of the vertices: a point inside, to within rounding.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// What may stand in for it, if it is large.
    pub(super) fn ladder(&self) -> Option<&Ladder> {
        (self.vertices.len() >= Self::STAND_INS_FROM).then_some(&self.ladder)
    }

    /// The local box, exact.
    pub(crate) fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The vertex farthest along `direction`, by looking at all: the first of those of greatest `vertex · direction`
    /// (`x·x + y·y + z·z` in this order). `direction` in the local frame, of any length; 0 if it is no number.
    #[must_use]
    #[inline(always)]
    pub fn farthest(&self, direction: DVec3) -> u32 {
        self.columns.farthest(direction)
    }

    /// The vertex farthest along `direction`, as [`Hull::farthest`] for up to [`Hull::CLIMB_ABOVE`] vertices, beyond that
    /// as [`Hull::climb`] from [`Hull::support_start`].
    #[must_use]
    #[inline(always)]
    pub fn support(&self, direction: DVec3) -> u32 {
        if self.vertices.len() <= Self::CLIMB_ABOVE {
            self.farthest(direction)
        } else {
            self.climb(direction, self.support_start(direction))
        }
    }

    /// A corner of the hull from which a walk to the one farthest along `direction` is short.
    #[must_use]
    pub fn support_start(&self, direction: DVec3) -> u32 {
        self.slopes().start(direction)
    }

    /// The corner farthest along `direction`, by walking from `start` over the edges: exactly a highest one of the
    /// numbers as they are, of exactly equal ones that of least index, whatever the start. Its rounded height may be less
    /// than that of [`Hull::farthest`] by 6 roundings of `reach · |direction|`, as may the true height of that one.
    ///
    /// `start` is any vertex; one that is no corner counts as [`Hull::support_start`]. Points on faces are never found.
    /// Costs the edges on the way; the first call builds the topology.
    #[must_use]
    pub fn climb(&self, direction: DVec3, start: u32) -> u32 {
        let found = self.slopes().climb(&self.vertices, self.reach, direction, start);
        found.unwrap_or_else(|| self.farthest(direction))
    }

    /// Its faces and edges: built on the first call, in O(n log n) for typical points.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        self.topology.get_or_build(|| quickhull::topology(&self.vertices))
    }

    /// The face that looks most along `direction` (local frame), of equal ones the first; `None` if there are none. The
    /// first call builds the topology and the columns of its normals.
    #[must_use]
    pub fn facing(&self, direction: DVec3) -> Option<&Face> {
        let faces = &self.topology().faces;
        if faces.is_empty() {
            return None;
        }
        let columns = || Columns::new(&faces.iter().map(|face| face.normal).collect::<Vec<_>>());
        faces.get(self.normals.get_or_build(columns).farthest(direction) as usize)
    }

    /// Its volume, cubic metres, to within rounding; 0 if it is flat. The first call builds the topology.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.fans().map(|[a, b, c]| a.cross(b).dot(c)).sum::<f64>().max(0.0) / 6.0
    }

    /// The area of its surface, square metres, to within rounding: both sides of a flat one.
    #[must_use]
    pub fn surface_area(&self) -> f64 {
        self.fans().map(|[a, b, c]| (b - a).cross(c - a).norm()).sum::<f64>() / 2.0
    }

    /// Triangles that make up its faces, seen from its middle.
    fn fans(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        self.face_triangles().map(|corners| corners.map(|corner| corner - self.center))
    }

    /// Triangles that make up its faces, counter-clockwise from outside.
    pub(crate) fn face_triangles(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        self.topology().faces.iter().flat_map(|face| {
            let corner = |at: usize| self.vertices[face.vertices[at] as usize];
            (2..face.vertices.len()).map(move |at| [corner(0), corner(at - 1), corner(at)])
        })
    }

    fn slopes(&self) -> &Slopes {
        self.slopes.get_or_build(|| Slopes::new(&self.vertices, self.topology()))
    }

    /// What questions made it build for itself, stand-ins aside.
    pub(super) fn structure(&self) -> Option<Structure> {
        let receipts = [self.topology.receipt(), self.slopes.receipt(), self.normals.receipt()];
        Structure::of("hull_adjacency", self.adjacency_bytes(), receipts)
    }

    fn adjacency_bytes(&self) -> u64 {
        let topology = self.topology.built().map_or(0, |topology| {
            let corners: usize = topology.faces.iter().map(|face| face.vertices.len() * size_of::<u32>()).sum();
            corners + topology.faces.len() * size_of::<Face>() + topology.edges.len() * size_of::<Edge>()
        });
        let slopes = self.slopes.built().map_or(0, Slopes::memory_bytes);
        (topology + slopes + self.normals.built().map_or(0, Columns::memory_bytes)) as u64
    }

    /// Bytes it holds in memory now.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        let points = self.vertices.len() * size_of::<DVec3>() + self.columns.memory_bytes();
        (size_of::<Self>() + points) as u64 + self.adjacency_bytes() + self.ladder.memory_bytes()
    }
}
