//! The point of a simplex that is nearest to the origin.
//!
//! # Method
//! Signed volumes: barycentric coordinates are the volumes, areas or lengths that the origin spans with the other corners,
//! as parts of their sum; where the origin lies beyond a face, each face with a wrong sign is tried and the nearest taken. A
//! simplex without volume tries all its faces. A search, which takes in one vertex at a time, needs only the parts that hold
//! it ([`newest`](super::newest)), and all of them only where rounding leaves those open. Weights that are off by rounding
//! still make a point of the simplex, and its distance is off by the square of that only.
//!
//! ```text
//!        c                 inside all three sides: the foot of the origin on the plane
//!       / \                beyond a side:          the nearest point of that side
//!      / x \               beyond an end of it:    the corner
//!     a-----b
//! ```
//!
//! # Source
//! Montanari, Petrinic, Barbieri, "Improving the GJK algorithm for faster and more reliable distance queries between
//! convex objects" (2017), section 4. What was changed: areas are products with the normal instead of projections onto a
//! coordinate plane, which need the foot of the origin, and so a quotient, first.

use glam::DVec3;

use super::{body::Corner, newest::newest_part};
use crate::{
    math::{Norm, exact},
    tolerance::{CROSS_BLUR, SMALL_AREA},
};

/// A vertex of the Minkowski difference `a − b` and where it comes from: `b`'s point is that of `a` less the vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub(super) point: DVec3,
    pub(super) on_a: DVec3,
    /// The numbers of the corners of `a` and `b`.
    pub(super) corners: [u32; 2],
}

impl Vertex {
    #[inline]
    pub(super) fn new(on_a: Corner, on_b: Corner) -> Self {
        Self { point: on_a.point - on_b.point, on_a: on_a.point, corners: [on_a.index, on_b.index] }
    }

    /// Whether both come from the same points of the forms.
    #[inline]
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.corners == other.corners
            && (!self.corners.contains(&Corner::ON_ROUND) || self.point == other.point && self.on_a == other.on_a)
    }
}

/// Up to four vertices with weights that sum to 1: a point of the Minkowski difference.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simplex {
    vertices: [Vertex; 4],
    part: Part,
}

impl Simplex {
    #[inline(always)]
    pub(super) fn of(vertex: Vertex) -> Self {
        let part = Part { members: [0; 4], weights: [1.0, 0.0, 0.0, 0.0], count: 1, point: vertex.point };
        Self { vertices: [vertex; 4], part }
    }

    /// The part nearest to the origin of the hull of one to four vertices.
    pub(super) fn nearest_of(mut vertices: impl Iterator<Item = Vertex>) -> Option<Self> {
        let mut simplex = Self::of(vertices.next()?);
        for vertex in vertices.take(3) {
            simplex.push(vertex);
        }
        Some(simplex.nearest())
    }

    /// Adds a vertex to at most three. The point is not sought anew.
    #[inline(always)]
    pub(super) fn push(&mut self, vertex: Vertex) {
        self.vertices[self.part.count] = vertex;
        self.part.count += 1;
    }

    pub(super) fn vertices(&self) -> &[Vertex] {
        &self.vertices[..self.part.count]
    }

    /// Moves `b` against `way`, and goes to the part of these vertices that is nearest then.
    pub(super) fn go(&mut self, way: DVec3) {
        for vertex in &mut self.vertices[..self.part.count] {
            vertex.point += way;
        }
        self.settle();
    }

    pub(super) fn contains(&self, vertex: &Vertex) -> bool {
        self.vertices().iter().any(|held| held.is_same(vertex))
    }

    /// The weighted point of the difference.
    pub(super) fn point(&self) -> DVec3 {
        self.part.point
    }

    /// The weighted points of `a` and of `b`.
    pub(super) fn witnesses(&self) -> (DVec3, DVec3) {
        let mut on_a = DVec3::ZERO;
        for (vertex, weight) in self.vertices().iter().zip(self.part.weights) {
            on_a += vertex.on_a * weight;
        }
        (on_a, on_a - self.part.point)
    }

    /// Takes `vertex` in and goes to the nearest part, if that brings the point nearer; says whether it did.
    pub(super) fn advance(&mut self, vertex: &Vertex) -> bool {
        let count = self.part.count;
        if count == 4 {
            return false;
        }
        self.vertices[count] = *vertex;
        let points = self.points();
        let far = self.part.point.length_squared();
        let is_nearer = |part: &Part| part.point.length_squared() < far;
        let part = newest_part(&points, count).filter(is_nearer).or_else(|| {
            let part = nearest_part(&points, count + 1);
            is_nearer(&part).then_some(part)
        });
        part.is_some_and(|part| {
            self.take(part);
            true
        })
    }

    /// Takes `vertex` in beside at most three and goes to the nearest part, if that is nearer; says whether it is.
    pub(super) fn take_in(&mut self, vertex: &Vertex) -> bool {
        let count = self.part.count;
        self.vertices[count] = *vertex;
        let part = nearest_part(&self.points(), count + 1);
        let is_nearer = part.point.length_squared() < self.part.point.length_squared();
        if is_nearer {
            self.take(part);
        }
        is_nearer
    }

    /// These vertices, at most three, and `vertex`. The point is not sought anew.
    fn with(&self, vertex: &Vertex) -> Self {
        let mut grown = *self;
        if grown.part.count < 4 {
            grown.push(*vertex);
        }
        grown
    }

    /// These vertices and `vertex`; of four those three with `vertex` whose triangle is nearest to the origin. The point is
    /// not sought anew.
    pub(super) fn grown_or_swapped(&self, vertex: &Vertex) -> Self {
        if self.part.count < 3 {
            return self.with(vertex);
        }
        let mut grown = *self;
        let p = [self.vertices[0].point, self.vertices[1].point, self.vertices[2].point, vertex.point];
        let mut best = (f64::INFINITY, [0, 1, 2]);
        for members in [[0, 1, 3], [0, 2, 3], [1, 2, 3]] {
            let distance_sq = triangle(&p, members).point.length_squared();
            if distance_sq < best.0 {
                best = (distance_sq, members);
            }
        }
        grown.vertices[3] = *vertex;
        grown.vertices = [best.1[0], best.1[1], best.1[2], 3].map(|member| grown.vertices[member]);
        grown.part.count = 3;
        grown
    }

    /// Goes to the nearest part of what the corners on one side make with the corner of `vertex` on the other, if that is nearer:
    /// where a plane stands on an edge or a face, any of its corners may be the one that `vertex` has.
    pub(super) fn cross(&mut self, vertex: &Vertex) {
        let on_b = vertex.on_a - vertex.point;
        let with_b = |held: &Vertex| {
            let corners = [held.corners[0], vertex.corners[1]];
            Vertex { point: held.on_a - on_b, on_a: held.on_a, corners }
        };
        let with_a = |held: &Vertex| {
            let held_on_b = held.on_a - held.point;
            let corners = [vertex.corners[0], held.corners[1]];
            Vertex { point: vertex.on_a - held_on_b, on_a: vertex.on_a, corners }
        };
        let held = *self;
        for crossed in [
            Self::nearest_of(held.vertices().iter().map(with_b).chain([*vertex])),
            Self::nearest_of(held.vertices().iter().map(with_a).chain([*vertex])),
        ] {
            if let Some(crossed) = crossed
                && crossed.point().length_squared() < self.point().length_squared()
            {
                *self = crossed;
            }
        }
    }

    /// The part of these vertices that is nearest to the origin.
    pub(super) fn nearest(mut self) -> Self {
        self.settle();
        self
    }

    /// Goes to the part of these vertices that is nearest to the origin.
    #[inline(always)]
    pub(super) fn settle(&mut self) {
        self.take(nearest_part(&self.points(), self.part.count));
    }

    /// Goes to the nearest side of a tetrahedron, if that is nearer than its point: that of a sliver, which would be the origin, is
    /// known less well than those of its sides.
    pub(super) fn flatten(&mut self) {
        if self.part.count == 4 {
            self.take(self.part.nearer(nearest_side(&self.points(), [false; 4])));
        }
    }

    /// How far inside a tetrahedron the origin surely lies; `None` if it may not or if this is no tetrahedron.
    pub(super) fn margin(&self) -> Option<f64> {
        if self.part.count < 4 { None } else { margin(&self.points()) }
    }

    fn points(&self) -> [DVec3; 4] {
        [self.vertices[0].point, self.vertices[1].point, self.vertices[2].point, self.vertices[3].point]
    }

    /// Goes to a part of these vertices. Nothing of it is looked up by a number that is not known beforehand, so that it
    /// stays in registers; memory that is written in small pieces and read back in large ones makes a processor wait.
    #[inline(always)]
    fn take(&mut self, part: Part) {
        // Members are in rising order, so that none is overwritten before it is moved.
        let [first, second, third, _] = part.members;
        if first != 0 {
            self.vertices[0] = self.vertices[first];
        }
        if part.count > 1 && second != 1 {
            self.vertices[1] = self.vertices[second];
        }
        if part.count > 2 && third != 2 {
            self.vertices[2] = self.vertices[third];
        }
        self.part = part;
    }
}

/// How far inside a tetrahedron the origin surely lies; `None` if it may not. The faces of a sliver are known less well than
/// its corners: what that may cost is taken off, as if all edges were as long as the longest one and all corners as far away
/// as the farthest one.
pub(super) fn margin(&[a, b, c, d]: &[DVec3; 4]) -> Option<f64> {
    let [ab, ac, ad, bc, bd] = [b - a, c - a, d - a, c - b, d - b];
    let longest_sq = [ac, ad, bc, bd, d - c].into_iter().map(DVec3::length_squared).fold(ab.length_squared(), f64::max);
    let farthest_sq = [b, c, d].into_iter().map(DVec3::length_squared).fold(a.length_squared(), f64::max);
    let blur = CROSS_BLUR * longest_sq;
    let flattest = blur * longest_sq.sqrt();
    let doubt = blur * farthest_sq.sqrt();
    let inner = |normal: DVec3, corner: DVec3, to_apex: DVec3| {
        let height = normal.dot(to_apex);
        let inside = (if height > 0.0 { -normal.dot(corner) } else { normal.dot(corner) }) - doubt;
        if height.abs() > flattest { inside / (normal.norm() + blur) } else { 0.0 }
    };
    let least = inner(ab.cross(ac), a, ad).min(inner(ab.cross(ad), a, ac)).min(inner(ac.cross(ad), a, ab)).min(inner(
        bc.cross(bd),
        b,
        -ab,
    ));
    (least > 0.0).then_some(least)
}

/// Members of a simplex, in rising order, with weights that sum to 1, and the point they make.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) members: [usize; 4],
    pub(super) weights: [f64; 4],
    pub(super) count: usize,
    pub(super) point: DVec3,
}

impl Part {
    pub(super) fn one(p: &[DVec3; 4], i: usize) -> Self {
        Self { members: [i, 0, 0, 0], weights: [1.0, 0.0, 0.0, 0.0], count: 1, point: p[i] }
    }

    fn nearer(self, other: Self) -> Self {
        if other.point.length_squared() < self.point.length_squared() { other } else { self }
    }
}

pub(super) fn nearest_part(p: &[DVec3; 4], count: usize) -> Part {
    match count {
        1 => Part::one(p, 0),
        2 => segment(p, [0, 1]),
        3 => triangle(p, [0, 1, 2]),
        _ => tetrahedron(p),
    }
}

fn segment(p: &[DVec3; 4], [i, j]: [usize; 2]) -> Part {
    let (a, b) = (p[i], p[j]);
    let along = b - a;
    let (to_b, from_a) = (b.dot(along), -a.dot(along));
    let whole = along.length_squared();
    if from_a > 0.0 && to_b > 0.0 && whole > 0.0 {
        let weight = from_a / whole;
        let weights = [1.0 - weight, weight, 0.0, 0.0];
        return Part { members: [i, j, 0, 0], weights, count: 2, point: a * weights[0] + b * weight };
    }
    Part::one(p, i).nearer(Part::one(p, j))
}

fn triangle(p: &[DVec3; 4], [i, j, k]: [usize; 3]) -> Part {
    let [a, b, c] = [p[i], p[j], p[k]];
    let (along_b, along_c) = (b - a, c - a);
    let plain = along_b.cross(along_c);
    // Of slivers no digit may be lost: beside a narrow gap the point would lie aside by more than the gap.
    let is_small = plain.length_squared() <= SMALL_AREA * SMALL_AREA;
    // What a corner weighs is the area that the foot of the origin spans with the side across from it. The foot itself is not
    // needed: it lies along the normal, where it adds nothing to these products.
    let areas = if is_small {
        let normal = exact::cross(along_b, along_c);
        [(b, c), (c, a), (a, b)].map(|(u, v)| exact::cross(u, v).dot(normal))
    } else {
        [b.cross(c).dot(plain), c.cross(a).dot(plain), a.cross(b).dot(plain)]
    };
    let inside = areas.map(|part| part > 0.0);
    let sum = areas[0] + areas[1] + areas[2];
    if inside == [true; 3] && sum.is_normal() {
        let [u, v, w] = areas.map(|part| part / sum);
        return Part { members: [i, j, k, 0], weights: [u, v, w, 0.0], count: 3, point: a * u + b * v + c * w };
    }
    let mut best: Option<Part> = None;
    for (side, is_inside) in [[j, k], [i, k], [i, j]].into_iter().zip(inside) {
        if !is_inside {
            let part = segment(p, side);
            best = Some(best.map_or(part, |best| best.nearer(part)));
        }
    }
    best.unwrap_or_else(|| segment(p, [i, j]))
}

fn tetrahedron(p: &[DVec3; 4]) -> Part {
    let [a, b, c, d] = *p;
    let (ab, cd) = (a.cross(b), c.cross(d));
    let volumes = [-b.dot(cd), a.dot(cd), -ab.dot(d), ab.dot(c)];
    let whole = (volumes[0] + volumes[1]) + (volumes[2] + volumes[3]);
    let sign = whole.signum();
    let inside = volumes.map(|part| part * sign > 0.0);
    if inside == [true; 4] && whole.is_normal() {
        let weights = volumes.map(|part| part / whole);
        let point = a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3];
        return Part { members: [0, 1, 2, 3], weights, count: 4, point };
    }
    nearest_side(p, if whole.is_normal() { inside } else { [false; 4] })
}

/// The nearest of the sides of a tetrahedron that do not have the origin on their inner side.
fn nearest_side(p: &[DVec3; 4], inside: [bool; 4]) -> Part {
    let mut best: Option<Part> = None;
    for (face, is_inside) in [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].into_iter().zip(inside) {
        if !is_inside {
            let part = triangle(p, face);
            best = Some(best.map_or(part, |best| best.nearer(part)));
        }
    }
    best.unwrap_or_else(|| triangle(p, [0, 1, 2]))
}

/// The point of a triangle that is nearest to the origin.
pub(super) fn nearest_of_triangle(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    triangle(&[a, b, c, a], [0, 1, 2]).point
}
