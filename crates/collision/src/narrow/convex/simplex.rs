//! The point of a simplex that is nearest to the origin.
//!
//! # Method
//! Signed volumes: barycentric coordinates come from sub-volumes projected onto the coordinate plane (or axis) in which
//! the simplex is largest, so nothing is divided by a small number; where the origin lies beyond a face, each face with a
//! wrong sign is tried and the nearest taken. A simplex without volume tries all its faces.
//!
//! # Source
//! Montanari, Petrinic, Barbieri, "Improving the GJK algorithm for faster and more reliable distance queries between
//! convex objects" (2017), section 4.

use glam::DVec3;

use super::frame::Corner;
use crate::tolerance::CROSS_BLUR;

/// A vertex of the Minkowski difference `a − b` and where it comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub(super) point: DVec3,
    pub(super) on_a: Corner,
    pub(super) on_b: Corner,
}

impl Vertex {
    pub(super) fn new(on_a: Corner, on_b: Corner) -> Self {
        Self { point: on_a.point - on_b.point, on_a, on_b }
    }

    fn is_same(&self, other: &Self) -> bool {
        self.on_a.point == other.on_a.point && self.on_b.point == other.on_b.point
    }
}

/// Up to four vertices with weights that sum to 1: a point of the Minkowski difference.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simplex {
    vertices: [Vertex; 4],
    weights: [f64; 4],
    count: usize,
}

impl Simplex {
    pub(super) fn of(vertex: Vertex) -> Self {
        Self { vertices: [vertex; 4], weights: [1.0, 0.0, 0.0, 0.0], count: 1 }
    }

    pub(super) fn vertices(&self) -> &[Vertex] {
        &self.vertices[..self.count]
    }

    pub(super) fn contains(&self, vertex: &Vertex) -> bool {
        self.vertices().iter().any(|held| held.is_same(vertex))
    }

    /// The weighted point of the difference.
    pub(super) fn point(&self) -> DVec3 {
        self.weighted(|vertex| vertex.point)
    }

    /// The weighted points of `a` and of `b`.
    pub(super) fn witnesses(&self) -> (DVec3, DVec3) {
        (self.weighted(|vertex| vertex.on_a.point), self.weighted(|vertex| vertex.on_b.point))
    }

    /// The part of this simplex with `vertex` added that is nearest to the origin.
    pub(super) fn nearest_with(&self, vertex: Vertex) -> Self {
        let mut grown = *self;
        grown.vertices[grown.count] = vertex;
        grown.count += 1;
        grown.nearest()
    }

    /// These vertices and `vertex`; of four those three with `vertex` whose triangle is nearest to the origin.
    pub(super) fn grown_or_swapped(&self, vertex: Vertex) -> Self {
        let mut grown = *self;
        if self.count < 3 {
            grown.vertices[self.count] = vertex;
            grown.count += 1;
            return grown;
        }
        grown.vertices[3] = vertex;
        let mut best = (f64::INFINITY, *self);
        for members in [[0, 1, 3], [0, 2, 3], [1, 2, 3]] {
            let candidate = grown.part(members, [0.0; 3]);
            let distance = candidate.nearest().point().length();
            if distance < best.0 {
                best = (distance, candidate);
            }
        }
        best.1
    }

    /// How far inside a tetrahedron the origin surely lies; `None` if it may not or if this is no tetrahedron. The faces
    /// of a sliver are known less well than its corners: what that may cost is taken off.
    pub(super) fn margin(&self) -> Option<f64> {
        let [a, b, c, d] = self.four()?;
        let inner = |a: DVec3, b: DVec3, c: DVec3, apex: DVec3| {
            let normal = (b - a).cross(c - a);
            let blur = CROSS_BLUR * (b - a).length() * (c - a).length();
            let height = normal.dot(apex - a);
            if height.abs() <= blur * (apex - a).length() {
                return 0.0;
            }
            (-height.signum() * normal.dot(a) - blur * a.length()) / (normal.length() + blur)
        };
        let least = inner(a, b, c, d).min(inner(a, b, d, c)).min(inner(a, c, d, b)).min(inner(b, c, d, a));
        (least > 0.0).then_some(least)
    }

    fn four(&self) -> Option<[DVec3; 4]> {
        (self.count == 4).then(|| self.vertices.map(|vertex| vertex.point))
    }

    fn weighted(&self, of: impl Fn(&Vertex) -> DVec3) -> DVec3 {
        self.vertices().iter().zip(self.weights).map(|(vertex, weight)| of(vertex) * weight).sum()
    }

    fn part<const N: usize>(&self, members: [usize; N], weights: [f64; N]) -> Self {
        let mut part = *self;
        for (slot, (member, weight)) in members.into_iter().zip(weights).enumerate() {
            part.vertices[slot] = self.vertices[member];
            part.weights[slot] = weight;
        }
        part.count = N;
        part
    }

    /// The part of this simplex that is nearest to the origin.
    pub(super) fn nearest(&self) -> Self {
        match self.count {
            1 => self.part([0], [1.0]),
            2 => self.segment([0, 1]),
            3 => self.triangle([0, 1, 2]),
            _ => self.tetrahedron(),
        }
    }

    fn nearer(self, other: Self) -> Self {
        if other.point().length_squared() < self.point().length_squared() { other } else { self }
    }

    fn segment(&self, [i, j]: [usize; 2]) -> Self {
        let (a, b) = (self.vertices[i].point, self.vertices[j].point);
        let along = b - a;
        let (to_b, from_a) = (b.dot(along), -a.dot(along));
        let whole = along.length_squared();
        if from_a > 0.0 && to_b > 0.0 && whole > 0.0 {
            let weight = from_a / whole;
            self.part([i, j], [1.0 - weight, weight])
        } else {
            self.part([i], [1.0]).nearer(self.part([j], [1.0]))
        }
    }

    fn triangle(&self, [i, j, k]: [usize; 3]) -> Self {
        let [a, b, c] = [i, j, k].map(|member| self.vertices[member].point);
        let normal = (b - a).cross(c - a);
        let foot = normal * (normal.dot(a) / normal.length_squared());
        let size = normal.abs();
        let (u, v) = if size.x >= size.y && size.x >= size.z {
            (1, 2)
        } else if size.y >= size.z {
            (2, 0)
        } else {
            (0, 1)
        };
        let area = |p: DVec3, q: DVec3| (p[u] - foot[u]) * (q[v] - foot[v]) - (p[v] - foot[v]) * (q[u] - foot[u]);
        let whole = if size.x >= size.y && size.x >= size.z {
            normal.x
        } else if size.y >= size.z {
            normal.y
        } else {
            normal.z
        };
        let areas = [area(b, c), area(c, a), area(a, b)];
        let inside = areas.map(|part| part * whole.signum() > 0.0);
        if inside == [true; 3] && whole.is_normal() {
            let sum: f64 = areas.iter().sum();
            return self.part([i, j, k], areas.map(|part| part / sum));
        }
        let sides = [[j, k], [k, i], [i, j]];
        let beyond = sides.into_iter().zip(inside).filter(|(_, is_inside)| !is_inside).map(|(side, _)| side);
        beyond.map(|side| self.segment(side)).reduce(Self::nearer).unwrap_or_else(|| self.segment([i, j]))
    }

    fn tetrahedron(&self) -> Self {
        let [a, b, c, d] = self.vertices.map(|vertex| vertex.point);
        let volumes = [-b.cross(c).dot(d), a.cross(c).dot(d), -a.cross(b).dot(d), a.cross(b).dot(c)];
        let whole: f64 = volumes.iter().sum();
        let inside = volumes.map(|part| part * whole.signum() > 0.0);
        if inside == [true; 4] && whole.is_normal() {
            return self.part([0, 1, 2, 3], volumes.map(|part| part / whole));
        }
        let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
        let flat = !whole.is_normal();
        let beyond = faces.into_iter().zip(inside).filter(|(_, is_inside)| flat || !is_inside).map(|(face, _)| face);
        beyond.map(|face| self.triangle(face)).reduce(Self::nearer).unwrap_or_else(|| self.triangle([0, 1, 2]))
    }
}
