//! Faces and edges of the convex hull of points, with exact decisions.
//!
//! # Method
//! Quickhull with conflict lists. Whether a point sees a face is the exact sign of a determinant, so the surface is
//! convex and closed for any input, slivers and nearly flat sets included; distances only choose which point comes
//! next. Points in a face's plane do not see it, so that faces in one plane stay apart by triangulation only and are
//! joined at the end, where the determinant across their common edge is exactly zero.
//!
//! # Source
//! Barber, Dobkin, Huhdanpaa, "The quickhull algorithm for convex hulls" (1996), section 2. Predicates: Shewchuk,
//! "Adaptive precision floating-point arithmetic" (1997), by the crate `robust`.
//!
//! # Limits
//! Exact signs hold while products of three coordinates neither overflow nor underflow, which the limits of sizes
//! ensure.

use std::collections::{BTreeMap, HashSet};

use glam::DVec3;
use robust::{Coord3D, orient3d};

use super::{
    planar::{exact_cross, polygon},
    topology::{Edge, Face, Span, Topology, index_u32},
};

/// The distinct points, each where it first stands; −0 counts as 0.
pub(super) fn distinct(points: &[DVec3]) -> Vec<DVec3> {
    let mut seen = HashSet::with_capacity(points.len());
    let mut kept = Vec::with_capacity(points.len());
    for &point in points {
        let point = point + DVec3::ZERO;
        if seen.insert(point.to_array().map(f64::to_bits)) {
            kept.push(point);
        }
    }
    kept
}

/// Faces and edges of the hull of distinct points, at least one.
pub(super) fn topology(points: &[DVec3]) -> Topology {
    let Some(line) = spanning_segment(points) else {
        return Topology { span: Span::Point, faces: Vec::new(), edges: Vec::new() };
    };
    let Some(apex) = farthest_off_line(points, line) else {
        let [start, end] = line_ends(points, line);
        let edge = Edge { start, end, left: u32::MAX, right: u32::MAX };
        return Topology { span: Span::Segment, faces: Vec::new(), edges: vec![edge] };
    };
    let base = [line[0], line[1], apex];
    match farthest_off_plane(points, base) {
        Some(top) => Builder::new(points, base, top).run(),
        None => polygon(points, base),
    }
}

/// Sign-exact six-fold volume: above 0 where `d` is on the inner side of a face seen counter-clockwise from outside.
fn volume(points: &[DVec3], [a, b, c]: [usize; 3], d: usize) -> f64 {
    let coordinate = |index: usize| Coord3D { x: points[index].x, y: points[index].y, z: points[index].z };
    orient3d(coordinate(a), coordinate(b), coordinate(c), coordinate(d))
}

/// The lexicographically least point and the one farthest from it; none if there is one point only.
fn spanning_segment(points: &[DVec3]) -> Option<[usize; 2]> {
    let least = index_of_max(points, |_, p| -p.x)?;
    let far = index_of_max(points, |_, p| p.distance_squared(points[least]))?;
    (points[least] != points[far]).then_some([least, far])
}

fn index_of_max(points: &[DVec3], mut key: impl FnMut(usize, DVec3) -> f64) -> Option<usize> {
    let mut best: Option<(usize, f64)> = None;
    for (index, &point) in points.iter().enumerate() {
        let value = key(index, point);
        if best.is_none_or(|(_, most)| value > most) {
            best = Some((index, value));
        }
    }
    best.map(|(index, _)| index)
}

fn farthest_off_line(points: &[DVec3], [a, b]: [usize; 2]) -> Option<usize> {
    let off = |p: DVec3| exact_cross(points[a], points[b], p);
    let best = index_of_max(points, |_, p| off(p).length_squared())?;
    if off(points[best]) != DVec3::ZERO {
        return Some(best);
    }
    points.iter().position(|&p| off(p) != DVec3::ZERO)
}

fn farthest_off_plane(points: &[DVec3], base: [usize; 3]) -> Option<usize> {
    let best = index_of_max(points, |index, _| volume(points, base, index).abs())?;
    (volume(points, base, best) != 0.0).then_some(best)
}

/// The two ends of points on a line, by the coordinate in which the line is longest.
fn line_ends(points: &[DVec3], [a, b]: [usize; 2]) -> [u32; 2] {
    let along = points[b] - points[a];
    let ends = [index_of_max(points, |_, p| -p.dot(along)), index_of_max(points, |_, p| p.dot(along))];
    ends.map(|end| index_u32(end.unwrap_or(0)))
}

/// A triangle of the surface under construction.
struct Triangle {
    corners: [usize; 3],
    /// Across the edge from corner `i` to corner `i + 1`.
    neighbors: [usize; 3],
    /// Points that see it and are not yet on the hull.
    outside: Vec<usize>,
    alive: bool,
}

struct Builder<'a> {
    points: &'a [DVec3],
    triangles: Vec<Triangle>,
}

impl<'a> Builder<'a> {
    fn new(points: &'a [DVec3], base: [usize; 3], top: usize) -> Self {
        let [a, b, c] = if volume(points, base, top) > 0.0 { base } else { [base[0], base[2], base[1]] };
        let d = top;
        let corners = [[a, b, c], [a, d, b], [b, d, c], [c, d, a]];
        let neighbors = [[1, 2, 3], [3, 2, 0], [1, 3, 0], [2, 1, 0]];
        let triangles = (0..4)
            .map(|i| Triangle { corners: corners[i], neighbors: neighbors[i], outside: Vec::new(), alive: true })
            .collect();
        let mut builder = Self { points, triangles };
        builder.assign((0..points.len()).filter(|p| ![a, b, c, d].contains(p)).collect(), 0);
        builder
    }

    fn sees(&self, triangle: usize, point: usize) -> bool {
        volume(self.points, self.triangles[triangle].corners, point) < 0.0
    }

    /// Gives each point to the first triangle from `first` on that it sees; a point that sees none is inside.
    fn assign(&mut self, candidates: Vec<usize>, first: usize) {
        for point in candidates {
            if let Some(triangle) = (first..self.triangles.len()).find(|&t| self.sees(t, point)) {
                self.triangles[triangle].outside.push(point);
            }
        }
    }

    fn run(mut self) -> Topology {
        let mut next = 0;
        while next < self.triangles.len() {
            if self.triangles[next].alive && !self.triangles[next].outside.is_empty() {
                self.add_farthest(next);
            }
            next += 1;
        }
        self.solid()
    }

    /// Adds the farthest point that `start` sees: what it sees goes, a fan from the horizon to it comes.
    fn add_farthest(&mut self, start: usize) {
        let corners = self.triangles[start].corners;
        let outside = &self.triangles[start].outside;
        let Some(&point) = outside.iter().max_by(|&&p, &&q| {
            volume(self.points, corners, q).total_cmp(&volume(self.points, corners, p)).then(q.cmp(&p))
        }) else {
            return;
        };
        let (visible, horizon) = self.horizon(start, point);
        let first = self.triangles.len();
        let fan = horizon.len();
        for (i, &(tail, head, across)) in horizon.iter().enumerate() {
            let index = first + i;
            self.triangles.push(Triangle {
                corners: [tail, head, point],
                neighbors: [across, first + (i + 1) % fan, first + (i + fan - 1) % fan],
                outside: Vec::new(),
                alive: true,
            });
            let outer = &mut self.triangles[across];
            if let Some(side) = (0..3).find(|&s| outer.corners[s] == head && outer.corners[(s + 1) % 3] == tail) {
                outer.neighbors[side] = index;
            }
        }
        let mut orphans = Vec::new();
        for &gone in &visible {
            self.triangles[gone].alive = false;
            orphans.append(&mut self.triangles[gone].outside);
        }
        orphans.retain(|&p| p != point);
        orphans.sort_unstable();
        self.assign(orphans, first);
    }

    /// What `point` sees, beginning with `start`, and the edges round it in order: tail, head, triangle beyond.
    fn horizon(&self, start: usize, point: usize) -> (Vec<usize>, Vec<(usize, usize, usize)>) {
        let mut visible = vec![start];
        let mut is_visible: HashSet<usize> = HashSet::from([start]);
        let mut rim: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
        let mut next = 0;
        while next < visible.len() {
            let triangle = &self.triangles[visible[next]];
            for side in 0..3 {
                let across = triangle.neighbors[side];
                if is_visible.contains(&across) {
                    continue;
                }
                if self.sees(across, point) {
                    is_visible.insert(across);
                    visible.push(across);
                } else {
                    rim.insert(triangle.corners[side], (triangle.corners[(side + 1) % 3], across));
                }
            }
            next += 1;
        }
        let mut ordered = Vec::with_capacity(rim.len());
        let first = rim.keys().next().copied().unwrap_or(0);
        let mut tail = first;
        while let Some((head, across)) = rim.remove(&tail) {
            ordered.push((tail, head, across));
            tail = head;
        }
        debug_assert!(rim.is_empty() && tail == first, "exact signs make the horizon one closed loop");
        (visible, ordered)
    }

    /// Joins triangles in one plane to faces and collects the edges between faces.
    fn solid(&self) -> Topology {
        let group = self.coplanar_groups();
        let mut face_of_group: BTreeMap<usize, u32> = BTreeMap::new();
        let mut borders: Vec<BTreeMap<usize, (usize, usize)>> = Vec::new();
        for (index, triangle) in self.triangles.iter().enumerate().filter(|(_, t)| t.alive) {
            let face = *face_of_group.entry(group[index]).or_insert_with(|| {
                borders.push(BTreeMap::new());
                index_u32(borders.len() - 1)
            });
            for side in 0..3 {
                let across = triangle.neighbors[side];
                if group[across] != group[index] {
                    borders[face as usize]
                        .insert(triangle.corners[side], (triangle.corners[(side + 1) % 3], group[across]));
                }
            }
        }
        let mut faces = Vec::with_capacity(borders.len());
        let mut edges = Vec::new();
        for (left, border) in borders.iter().enumerate() {
            let mut outline = Vec::with_capacity(border.len());
            let first = border.keys().next().copied().unwrap_or(0);
            let mut tail = first;
            while let Some(&(head, beyond)) = border.get(&tail) {
                outline.push(index_u32(tail));
                let right = face_of_group[&beyond];
                let left = index_u32(left);
                if left < right {
                    let [start, end] = [tail, head].map(index_u32);
                    edges.push(Edge { start, end, left, right });
                }
                tail = head;
                if tail == first {
                    break;
                }
            }
            faces.push(Face::of(self.points, outline));
        }
        Topology { span: Span::Solid, faces, edges }
    }

    /// For each triangle the least triangle that lies in the same plane and hangs together with it.
    fn coplanar_groups(&self) -> Vec<usize> {
        let mut group: Vec<usize> = vec![usize::MAX; self.triangles.len()];
        for start in (0..self.triangles.len()).filter(|&t| self.triangles[t].alive) {
            if group[start] != usize::MAX {
                continue;
            }
            group[start] = start;
            let mut queue = vec![start];
            while let Some(index) = queue.pop() {
                for &across in &self.triangles[index].neighbors {
                    let joined = group[across] == usize::MAX && {
                        let corners = self.triangles[across].corners;
                        corners.iter().all(|&corner| volume(self.points, self.triangles[start].corners, corner) == 0.0)
                    };
                    if joined {
                        group[across] = start;
                        queue.push(across);
                    }
                }
            }
        }
        group
    }
}
