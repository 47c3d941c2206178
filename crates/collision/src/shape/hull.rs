//! Convex hulls of points: their vertices, and their faces and edges once a question needs them.
//!
//! # Limits
//! The vertices are the distinct points as sent, inner ones included: the support function passes over those. Faces are
//! whole polygons (triangles in exactly one plane are one face).

use std::sync::OnceLock;

use glam::DVec3;

use super::quickhull::{self, Solid};

/// The convex hull of points, which may be flat, straight or a single point.
#[derive(Debug)]
pub struct Hull {
    vertices: Vec<DVec3>,
    topology: OnceLock<Topology>,
}

/// How a hull is made up. Lower-dimensional hulls answer every question that solid ones do.
#[derive(Debug)]
pub struct Topology {
    /// How many dimensions it spans.
    pub span: Span,
    /// Its faces: none for a point or a segment, the two sides of a polygon.
    pub faces: Vec<Face>,
    /// Its edges: none for a point, one for a segment.
    pub edges: Vec<Edge>,
}

/// How many dimensions a hull spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Span {
    /// All points are one.
    Point,
    /// All points lie on one line.
    Segment,
    /// All points lie in one plane.
    Polygon,
    /// It has a volume.
    Solid,
}

/// A face: a convex polygon.
#[derive(Clone, Debug)]
pub struct Face {
    /// Unit normal, outwards.
    pub normal: DVec3,
    /// The largest `normal · v` of its vertices, metres.
    pub offset: f64,
    /// Its vertices by index, counter-clockwise from outside.
    pub vertices: Vec<u32>,
}

/// An edge between two vertices, and the faces at its sides.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// One end.
    pub start: u32,
    /// The other.
    pub end: u32,
    /// The face in whose order it goes from start to end; `u32::MAX` for a segment.
    pub left: u32,
    /// The face in whose order it goes from end to start.
    pub right: u32,
}

impl Hull {
    /// The hull of `points`, at least one, all finite. The topology is built when a question first needs it.
    #[must_use]
    pub fn new(points: &[DVec3]) -> Self {
        Self { vertices: quickhull::distinct(points), topology: OnceLock::new() }
    }

    /// The distinct points, in the order they were sent.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Its faces and edges: built on the first call, in O(n log n) for typical points.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        self.topology.get_or_init(|| quickhull::topology(&self.vertices))
    }

    /// Whether the faces and edges are built.
    #[must_use]
    pub fn has_topology(&self) -> bool {
        self.topology.get().is_some()
    }

    /// Bytes it holds in memory now.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        let topology = self.topology.get().map_or(0, |topology| {
            let corners: usize = topology.faces.iter().map(|face| face.vertices.len() * size_of::<u32>()).sum();
            corners + topology.faces.len() * size_of::<Face>() + topology.edges.len() * size_of::<Edge>()
        });
        (size_of::<Self>() + self.vertices.len() * size_of::<DVec3>() + topology) as u64
    }
}

impl From<Solid> for Topology {
    fn from(solid: Solid) -> Self {
        Self { span: Span::Solid, faces: solid.faces, edges: solid.edges }
    }
}
