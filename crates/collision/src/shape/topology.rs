//! Faces and edges of a convex hull.

use glam::DVec3;

use crate::math::{expansion, try_unit};

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

impl Face {
    /// The face round an outline, counter-clockwise from outside.
    pub(super) fn of(points: &[DVec3], outline: Vec<u32>) -> Self {
        Self::with_normal(points, polygon_normal(points, &outline), outline)
    }

    /// The other side of a flat hull.
    pub(super) fn turned_over(&self, points: &[DVec3]) -> Self {
        Self::with_normal(points, -self.normal, self.vertices.iter().rev().copied().collect())
    }

    fn with_normal(points: &[DVec3], normal: DVec3, vertices: Vec<u32>) -> Self {
        let mut face = Self { normal, offset: 0.0, vertices };
        face.set_offset(points);
        face
    }

    /// The same face of the same points at another scale.
    pub(super) fn set_offset(&mut self, points: &[DVec3]) {
        let heights = self.vertices.iter().map(|&vertex| self.normal.dot(points[vertex as usize]));
        self.offset = heights.fold(f64::NEG_INFINITY, f64::max);
    }
}

/// The unit normal from the corner triple of largest area that begins at the first vertex or is a run of three.
fn polygon_normal(points: &[DVec3], outline: &[u32]) -> DVec3 {
    let corner = |i: usize| points[outline[i % outline.len()] as usize];
    let count = outline.len();
    let third = (count / 3).max(1);
    let candidates = (0..count).flat_map(|i| [[i, i + 1, i + 2], [i, i + third, i + 2 * third]]);
    let largest = candidates.map(|[i, j, k]| expansion::triangle_cross([corner(i), corner(j), corner(k)])).fold(
        DVec3::ZERO,
        |best, normal| {
            if normal.length_squared() > best.length_squared() { normal } else { best }
        },
    );
    try_unit(largest).unwrap_or(DVec3::X)
}

/// Hulls have at most [`Limits::HULL_POINTS`](super::Limits::HULL_POINTS) points, so every index fits.
pub(super) fn index_u32(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
