//! The depth of two cores that overlap, by an expanding polytope, with proof on both sides.
//!
//! # Method
//! A closed surface of triangles grows inside the Minkowski difference: the triangle nearest to the origin is pushed out to
//! the support point along its normal, until that lies no farther out than the triangle itself. Every normal that is asked
//! gives a width, and each width is a way out: the least of them bounds the depth from above. The ball that the surface
//! leaves free about the origin bounds it from below:
//!
//! ```text
//!        ______ difference        upper: the support plane along the nearest triangle's normal
//!      /.------.\                 lower: the nearest triangle
//!     / |  o   | \
//!     \ '------' /  surface
//!      \________/
//! ```
//!
//! The lower bound needs no convex surface: each triangle lies beyond a plane that has the origin on its inner side by the
//! bound, so the closed surface goes round the origin, and what it holds lies in the hull of its vertices. Nor does it need
//! normals of slivers: each triangle's plane is the best of the triangle's own and the one across its nearest point, and its
//! height is that of its lowest corner, whatever the direction.
//!
//! # Source
//! Van den Bergen, "Proximity queries and penetration depth computation on 3D game objects" (GDC 2001). What was changed:
//! the bounds, the planes of slivers, the start from fewer than four vertices, and that a surface which cannot grow, or does
//! not hold the origin, says so.
//!
//! # Limits
//! Where many directions are equally short ways out (a cylinder in the middle of another, on one axis) the surface must
//! follow all of them: see `inscribed.rs` for a lower bound there. A budget that is spent leaves the bounds as they are.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::{
    frame::Pair,
    gjk, manifold,
    orientation::{Turn, has_origin_inside, orientation},
    simplex::{Simplex, Vertex, nearest_of_triangle},
};
use crate::{
    answer::Stop,
    math::{Norm, exact},
    tolerance::{DEPTH_WIDTH, FACE_HEIGHT, PAIR_ROUNDING, SMALL_AREA, VOLUME_DOUBT},
};

/// What is known of the depth of two cores, in the pair's frame.
pub(super) struct Penetration {
    /// The width along `normal`.
    pub(super) best: f64,
    /// The depth is not below this; negative infinity where nothing is proved.
    pub(super) lower: f64,
    /// The depth is not above this.
    pub(super) upper: f64,
    /// Unit vector from `b` to `a`.
    pub(super) normal: DVec3,
    /// Where the forms are deepest in each other: points of the cores, as far apart as the depth; `None` where it ended before a
    /// triangle was measured.
    pub(super) witnesses: Option<(DVec3, DVec3)>,
    /// Names of the features that `normal` comes from.
    pub(super) features: Option<[u16; 2]>,
    pub(super) iterations: u32,
    pub(super) stop: Stop,
}

/// Measures the depth from a simplex of the difference until `is_enough(lower, upper)`, or until the arithmetic gives no
/// more, or the budget is spent. The depth is known to be no less than `floor`. `None` if the difference has no volume that
/// could be grown.
pub(super) fn depth(
    pair: &Pair<'_>,
    start: &Simplex,
    floor: f64,
    budget: u32,
    is_enough: impl Fn(f64, f64) -> bool,
) -> Option<Penetration> {
    let mut growth = Growth { pair, floor, budget, iterations: 0, lower: f64::NEG_INFINITY, best: Best::NONE };
    let mut stop = tetrahedron(pair, start).map(|start| growth.run(start, &is_enough));
    // A surface that could not grow on was built among vertices too close together: another begins with vertices far apart.
    for toward in [DVec3::X, DVec3::Y, growth.best.normal] {
        if stop.is_none_or(|stop| stop == Stop::Converged && growth.width() > DEPTH_WIDTH) {
            let start = tetrahedron(pair, &Simplex::of(gjk::support(pair, toward)));
            stop = start.map(|start| growth.run(start, &is_enough)).or(stop);
        }
    }
    let stop = stop?;
    let Growth { best, lower, iterations, .. } = growth;
    Some(Penetration {
        best: best.width,
        lower: proved(lower).max(floor),
        upper: best.width + PAIR_ROUNDING,
        normal: DVec3::ZERO - best.normal,
        witnesses: best.witnesses(),
        features: best.face.as_ref().map(|vertices| manifold::names(vertices)),
        iterations,
        stop,
    })
}

/// What growing surfaces have shown so far.
struct Growth<'a> {
    pair: &'a Pair<'a>,
    floor: f64,
    budget: u32,
    iterations: u32,
    /// The greatest height below which one of the surfaces had no triangle.
    lower: f64,
    best: Best,
}

impl Growth<'_> {
    fn width(&self) -> f64 {
        self.best.width - self.lower.max(self.floor)
    }

    /// Grows a surface from a tetrahedron of positive volume.
    fn run(&mut self, start: [Vertex; 4], is_enough: &impl Fn(f64, f64) -> bool) -> Stop {
        let mut surface = Surface::around(start);
        loop {
            let (nearest, lower) = surface.nearest();
            self.lower = self.lower.max(lower);
            // A floor comes with its own rounding, which no surface takes off it.
            if self.width() <= 2.0 * PAIR_ROUNDING || self.best.width - self.floor <= 4.0 * PAIR_ROUNDING {
                return Stop::Converged;
            }
            if is_enough(proved(self.lower).max(self.floor), self.best.width + PAIR_ROUNDING) {
                return Stop::Tolerance;
            }
            if self.iterations >= self.budget {
                return Stop::Budget;
            }
            self.iterations += 1;
            let face = surface.faces[nearest];
            let vertex = gjk::support(self.pair, -face.normal);
            let width = face.normal.dot(vertex.point);
            if width < self.best.width {
                let vertices = face.corners.map(|corner| surface.vertices[corner as usize]);
                self.best = Best { width, normal: face.normal, face: Some(vertices) };
            }
            if width - face.high <= FACE_HEIGHT || !surface.grow(nearest, lower > 0.0, vertex) {
                return Stop::Converged;
            }
        }
    }
}

/// The depth that is proved by triangles no lower than `height`: none unless they surely go round the origin.
fn proved(height: f64) -> f64 {
    if height > PAIR_ROUNDING { height - PAIR_ROUNDING } else { f64::NEG_INFINITY }
}

/// The least width so far, and the triangle it was measured from.
struct Best {
    width: f64,
    /// Outwards.
    normal: DVec3,
    face: Option<[Vertex; 3]>,
}

impl Best {
    const NONE: Self = Self { width: f64::INFINITY, normal: DVec3::X, face: None };

    fn witnesses(&self) -> Option<(DVec3, DVec3)> {
        let vertices = self.face?;
        Simplex::nearest_of(vertices.into_iter()).map(|nearest| nearest.witnesses())
    }
}

/// A triangle of the surface, counter-clockwise from outside.
#[derive(Clone, Copy)]
struct Face {
    corners: [u32; 3],
    /// Across the edge from corner `i` to corner `i + 1`.
    neighbors: [u32; 3],
    /// Unit vector, outwards.
    normal: DVec3,
    /// Height of its highest corner along the normal.
    high: f64,
    is_alive: bool,
}

struct Surface {
    vertices: SmallVec<[Vertex; 24]>,
    faces: SmallVec<[Face; 64]>,
    /// For each face the height of its lowest corner; infinity for those that are gone.
    heights: SmallVec<[f64; 64]>,
    free: SmallVec<[u32; 16]>,
}

impl Surface {
    /// The surface of a tetrahedron of positive volume.
    fn around(vertices: [Vertex; 4]) -> Self {
        let mut surface = Self {
            vertices: SmallVec::from_slice(&vertices),
            faces: SmallVec::new(),
            heights: SmallVec::new(),
            free: SmallVec::new(),
        };
        let corners = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let neighbors = [[3, 2, 1], [0, 2, 3], [0, 3, 1], [0, 1, 2]];
        for (corners, neighbors) in corners.into_iter().zip(neighbors) {
            surface.add(corners, neighbors);
        }
        surface
    }

    fn add(&mut self, corners: [u32; 3], neighbors: [u32; 3]) -> u32 {
        let [a, b, c] = corners.map(|corner| self.vertices[corner as usize].point);
        let (normal, low, high) = plane(a, b, c);
        let face = Face { corners, neighbors, normal, high, is_alive: true };
        match self.free.pop() {
            Some(slot) => {
                self.faces[slot as usize] = face;
                self.heights[slot as usize] = low;
                slot
            }
            None => {
                self.faces.push(face);
                self.heights.push(low);
                (self.faces.len() - 1) as u32
            }
        }
    }

    /// The face whose lowest corner is lowest, and that height; of equal ones the first.
    fn nearest(&self) -> (usize, f64) {
        let mut best = (0, f64::INFINITY);
        for (index, &height) in self.heights.iter().enumerate() {
            if height < best.1 {
                best = (index, height);
            }
        }
        best
    }

    /// Puts the surface round `vertex`: what it sees, from `first` on, goes. If the surface `encloses` the origin, so does what
    /// a triangle to the vertex would turn inside out: among vertices that lie closer together than heights can be told the
    /// surface then stays one that the origin sees every part of from within. Says whether all that was possible; if not, the
    /// surface is no longer whole.
    fn grow(&mut self, first: usize, encloses: bool, vertex: Vertex) -> bool {
        let apex = self.vertices.len() as u32;
        let point = vertex.point;
        self.vertices.push(vertex);
        let mut horizon: SmallVec<[(u32, u32); 24]> = SmallVec::new();
        let mut gone: SmallVec<[u32; 24]> = smallvec![first as u32];
        let mut open: SmallVec<[(u32, u32); 24]> = SmallVec::new();
        self.faces[first].is_alive = false;
        for edge in [2, 1, 0] {
            open.push(self.across(first as u32, edge));
        }
        while let Some((index, edge)) = open.pop() {
            let face = &self.faces[index as usize];
            if !face.is_alive {
                continue;
            }
            let [start, end] = [edge + 1, edge].map(|corner| face.corners[corner as usize % 3]);
            let is_seen = face.normal.dot(point) - face.high > FACE_HEIGHT;
            if is_seen || encloses && !self.looks_outwards(start, end, point) {
                self.faces[index as usize].is_alive = false;
                gone.push(index);
                open.push(self.across(index, (edge + 2) % 3));
                open.push(self.across(index, (edge + 1) % 3));
            } else {
                horizon.push((index, edge));
            }
        }
        for &index in &gone {
            self.heights[index as usize] = f64::INFINITY;
        }
        self.free.extend(gone.iter().copied());
        self.fan(&horizon, apex)
    }

    /// The neighbour across an edge, and which of its edges that is.
    fn across(&self, face: u32, edge: u32) -> (u32, u32) {
        let Face { corners, neighbors, .. } = &self.faces[face as usize];
        let (next, end) = (neighbors[edge as usize], corners[(edge as usize + 1) % 3]);
        let back = self.faces[next as usize].corners.iter().position(|&corner| corner == end);
        (next, back.unwrap_or(0) as u32)
    }

    /// Whether the origin surely lies on the inner side of the triangle from an edge to a point.
    fn looks_outwards(&self, start: u32, end: u32, point: DVec3) -> bool {
        let [a, b] = [start, end].map(|corner| self.vertices[corner as usize].point);
        let volume = a.cross(b).dot(point);
        if volume.abs() > VOLUME_DOUBT { volume > 0.0 } else { has_origin_inside(a, b, point) }
    }

    /// Triangles from each edge of the horizon to the apex; `false` if the horizon is not one closed loop.
    fn fan(&mut self, horizon: &[(u32, u32)], apex: u32) -> bool {
        let ends = |surface: &Self, (face, edge): (u32, u32)| {
            let corners = surface.faces[face as usize].corners;
            (corners[(edge as usize + 1) % 3], corners[edge as usize])
        };
        let count = horizon.len();
        let is_closed = (0..count).all(|i| ends(self, horizon[i]).1 == ends(self, horizon[(i + 1) % count]).0);
        if count < 3 || !is_closed {
            return false;
        }
        let mut made: SmallVec<[u32; 24]> = SmallVec::with_capacity(count);
        for &(outer, edge) in horizon {
            let (start, end) = ends(self, (outer, edge));
            let index = self.add([start, end, apex], [outer, 0, 0]);
            self.faces[outer as usize].neighbors[edge as usize] = index;
            made.push(index);
        }
        for i in 0..count {
            let face = &mut self.faces[made[i] as usize];
            face.neighbors[1] = made[(i + 1) % count];
            face.neighbors[2] = made[(i + count - 1) % count];
        }
        true
    }
}

/// A direction in which a triangle (counter-clockwise from outside) looks, and the least and the greatest height of its
/// corners along it. Whatever the direction, the triangle has no point below the least; above 0 is given only where the origin
/// surely lies on the triangle's inner side.
fn plane(a: DVec3, b: DVec3, c: DVec3) -> (DVec3, f64, f64) {
    let heights = |normal: DVec3| {
        let [p, q, r] = [normal.dot(a), normal.dot(b), normal.dot(c)];
        (normal, p.min(q).min(r), p.max(q).max(r))
    };
    let (u, v) = (b - a, c - a);
    let normal = u.cross(v);
    if normal.length_squared() > SMALL_AREA * SMALL_AREA
        && let Some((normal, low, high)) = normal.try_unit().map(heights)
        && high - low <= FACE_HEIGHT
    {
        return (normal, low, high);
    }
    let own = exact::cross(u, v).try_unit().map(heights);
    // A sliver or a crumb: its own plane leans, though its corners lie in it if no digit of the product is lost; the direction
    // to its nearest point is known well, and the sign of the volume that it spans with the origin exactly.
    let toward = nearest_of_triangle(a, b, c).try_unit().map(heights);
    let is_inside = has_origin_inside(a, b, c);
    match (own, toward) {
        (_, Some(toward)) if is_inside && own.is_none_or(|own| toward.1 > own.1) => toward,
        (Some((normal, low, high)), _) => (normal, if is_inside { low } else { low.min(0.0) }, high),
        (None, Some((normal, _, high))) => (normal, 0.0, high),
        (None, None) => (DVec3::X, 0.0, 0.0),
    }
}

/// Four vertices of the difference with a positive volume, grown from those of a simplex; `None` if the difference has none.
fn tetrahedron(pair: &Pair<'_>, start: &Simplex) -> Option<[Vertex; 4]> {
    let mut vertices: SmallVec<[Vertex; 4]> = SmallVec::from_slice(start.vertices());
    let add_off = |vertices: &mut SmallVec<[Vertex; 4]>, directions: &[DVec3]| {
        let base = vertices[0].point;
        let off = |vertex: &Vertex, direction: DVec3| direction.dot(vertex.point - base).abs();
        let found = directions.iter().flat_map(|&direction| {
            [direction, -direction].map(|d| gjk::support(pair, d)).map(|vertex| (off(&vertex, direction), vertex))
        });
        let best = found.fold(None, |best: Option<(f64, Vertex)>, next| match best {
            Some(best) if best.0 >= next.0 => Some(best),
            _ => Some(next),
        })?;
        (best.0 > FACE_HEIGHT).then(|| vertices.push(best.1))
    };
    if vertices.len() == 1 {
        add_off(&mut vertices, &[DVec3::X, DVec3::Y, DVec3::Z])?;
    }
    if vertices.len() == 2 {
        let along = (vertices[1].point - vertices[0].point).try_unit()?;
        let (u, v) = along.any_orthonormal_pair();
        add_off(&mut vertices, &[u, v])?;
    }
    if vertices.len() == 3 {
        let [a, b, c] = [vertices[0].point, vertices[1].point, vertices[2].point];
        add_off(&mut vertices, &[(b - a).cross(c - a).try_unit()?])?;
    }
    let [a, b, c, d] = [vertices[0], vertices[1], vertices[2], vertices[3]];
    match orientation([a, b, c, d].map(|vertex| vertex.point))? {
        Turn::Left => Some([a, b, c, d]),
        Turn::Right => Some([a, c, b, d]),
    }
}
