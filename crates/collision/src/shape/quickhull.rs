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
//! Points are decided on at the scale of [`super::scale`].

use std::collections::HashSet;

use glam::DVec3;
use robust::{Coord3D, orient3d};

use super::{
    planar::{exact_cross, polygon},
    scale::Scaled,
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
    let mut topology = topology_of_scaled(&Scaled::new(points).points);
    topology.faces.iter_mut().for_each(|face| face.set_offset(points));
    topology
}

fn topology_of_scaled(points: &[DVec3]) -> Topology {
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
pub(super) fn volume(points: &[DVec3], [a, b, c]: [usize; 3], d: usize) -> f64 {
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
    let along = (points[b] - points[a]).abs();
    let axis = along.max_position();
    let ends = [index_of_max(points, |_, p| -p[axis]), index_of_max(points, |_, p| p[axis])];
    ends.map(|end| index_u32(end.unwrap_or(0)))
}

/// The sides of a face in order, each by its tail with what is beyond it.
fn outline(border: &[Side]) -> Vec<(usize, usize)> {
    let mut sides = Vec::with_capacity(border.len());
    let mut at = 0;
    for _ in 0..border.len() {
        let (tail, head, beyond) = border[at];
        sides.push((tail, beyond));
        match border.binary_search_by_key(&head, |&(tail, _, _)| tail) {
            Ok(next) if next != 0 => at = next,
            Ok(_) | Err(_) => break,
        }
    }
    sides
}

/// A triangle of the surface under construction.
struct Triangle {
    corners: [usize; 3],
    /// Across the edge from corner `i` to corner `i + 1`.
    neighbors: [usize; 3],
    /// Points that see it and are not yet on the hull, each with its volume.
    outside: Vec<(usize, f64)>,
    alive: bool,
    /// The last point that was found to see it while a horizon was sought.
    seen_by: usize,
}

impl Triangle {
    fn new(corners: [usize; 3], neighbors: [usize; 3]) -> Self {
        Self { corners, neighbors, outside: Vec::new(), alive: true, seen_by: usize::MAX }
    }
}

/// A solid hull under construction, at a scale at which signs are exact.
pub(super) struct Builder<'a> {
    points: &'a [DVec3],
    triangles: Vec<Triangle>,
    /// By tail: head and triangle beyond, of the horizon now sought.
    rim: Vec<(usize, usize)>,
    /// For each point a triangle that it sees; `usize::MAX` for those inside or on the hull.
    seen: Vec<usize>,
}

/// An edge of a horizon or of a face: tail, head, and what is beyond.
type Side = (usize, usize, usize);

impl<'a> Builder<'a> {
    /// The tetrahedron of three points and a fourth that is not in their plane.
    pub(super) fn new(points: &'a [DVec3], base: [usize; 3], top: usize) -> Self {
        let [a, b, c] = if volume(points, base, top) > 0.0 { base } else { [base[0], base[2], base[1]] };
        let d = top;
        let corners = [[a, b, c], [a, d, b], [b, d, c], [c, d, a]];
        let neighbors = [[1, 2, 3], [3, 2, 0], [1, 3, 0], [2, 1, 0]];
        let triangles = (0..4).map(|i| Triangle::new(corners[i], neighbors[i])).collect();
        let rim = vec![(usize::MAX, usize::MAX); points.len()];
        let mut builder = Self { points, triangles, rim, seen: vec![usize::MAX; points.len()] };
        builder.assign((0..points.len()).filter(|p| ![a, b, c, d].contains(p)), 0);
        builder
    }

    /// Below 0 where `point` sees the triangle.
    fn volume(&self, triangle: usize, point: usize) -> f64 {
        volume(self.points, self.triangles[triangle].corners, point)
    }

    /// Gives each point to the first triangle from `first` on that it sees; a point that sees none is inside.
    fn assign(&mut self, candidates: impl IntoIterator<Item = usize>, first: usize) {
        for point in candidates {
            self.seen[point] = usize::MAX;
            for triangle in first..self.triangles.len() {
                let volume = self.volume(triangle, point);
                if volume < 0.0 {
                    self.triangles[triangle].outside.push((point, volume));
                    self.seen[point] = triangle;
                    break;
                }
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

    /// Adds the farthest point that `start` sees.
    fn add_farthest(&mut self, start: usize) {
        let outside = self.triangles[start].outside.iter();
        let Some(&(point, _)) = outside.max_by(|(p, high), (q, low)| low.total_cmp(high).then(q.cmp(p))) else {
            return;
        };
        self.insert(start, point);
    }

    /// Whether a point is neither inside nor on the hull.
    pub(super) fn is_outside(&self, point: usize) -> bool {
        self.seen[point] != usize::MAX
    }

    /// Adds a point, if it is outside: the number of the first triangle that is new.
    pub(super) fn add(&mut self, point: usize) -> Option<usize> {
        let first = self.triangles.len();
        self.is_outside(point).then(|| self.insert(self.seen[point], point)).map(|()| first)
    }

    /// The corners of the triangles from `first` on.
    pub(super) fn faces(&self, first: usize) -> impl Iterator<Item = [usize; 3]> {
        self.triangles[first..].iter().filter(|triangle| triangle.alive).map(|triangle| triangle.corners)
    }

    /// Adds a point that sees `start`: what it sees goes, a fan from the horizon to it comes.
    fn insert(&mut self, start: usize, point: usize) {
        self.seen[point] = usize::MAX;
        let (visible, horizon) = self.horizon(start, point);
        let first = self.triangles.len();
        let fan = horizon.len();
        for (i, &(tail, head, across)) in horizon.iter().enumerate() {
            let neighbors = [across, first + (i + 1) % fan, first + (i + fan - 1) % fan];
            self.triangles.push(Triangle::new([tail, head, point], neighbors));
            let outer = &mut self.triangles[across];
            if let Some(side) = (0..3).find(|&s| outer.corners[s] == head && outer.corners[(s + 1) % 3] == tail) {
                outer.neighbors[side] = first + i;
            }
        }
        let mut orphans = Vec::new();
        for &gone in &visible {
            self.triangles[gone].alive = false;
            let outside = std::mem::take(&mut self.triangles[gone].outside);
            orphans.extend(outside.into_iter().map(|(orphan, _)| orphan).filter(|&orphan| orphan != point));
        }
        orphans.sort_unstable();
        self.assign(orphans, first);
    }

    /// What `point` sees, beginning with `start`, and the edges round it in order, from that of the least tail on.
    fn horizon(&mut self, start: usize, point: usize) -> (Vec<usize>, Vec<Side>) {
        let mut visible = vec![start];
        self.triangles[start].seen_by = point;
        let mut first = usize::MAX;
        let mut count = 0;
        let mut next = 0;
        while next < visible.len() {
            let Triangle { corners, neighbors, .. } = self.triangles[visible[next]];
            for side in 0..3 {
                let across = neighbors[side];
                if self.triangles[across].seen_by == point {
                    continue;
                }
                if self.volume(across, point) < 0.0 {
                    self.triangles[across].seen_by = point;
                    visible.push(across);
                } else {
                    self.rim[corners[side]] = (corners[(side + 1) % 3], across);
                    first = first.min(corners[side]);
                    count += 1;
                }
            }
            next += 1;
        }
        let mut ordered = Vec::with_capacity(count);
        let mut tail = first;
        for _ in 0..count {
            let (head, across) = self.rim[tail];
            ordered.push((tail, head, across));
            tail = head;
        }
        debug_assert!(tail == first, "exact signs make the horizon one closed loop");
        (visible, ordered)
    }

    /// Joins triangles in one plane to faces and collects the edges between faces.
    fn solid(&self) -> Topology {
        let group = self.coplanar_groups();
        let mut face_of_group: Vec<u32> = vec![u32::MAX; self.triangles.len()];
        let mut borders: Vec<Vec<Side>> = Vec::new();
        for (index, triangle) in self.triangles.iter().enumerate().filter(|(_, t)| t.alive) {
            let face = &mut face_of_group[group[index]];
            if *face == u32::MAX {
                *face = index_u32(borders.len());
                borders.push(Vec::with_capacity(3));
            }
            for side in 0..3 {
                let beyond = group[triangle.neighbors[side]];
                if beyond != group[index] {
                    let [tail, head] = [side, (side + 1) % 3].map(|corner| triangle.corners[corner]);
                    borders[*face as usize].push((tail, head, beyond));
                }
            }
        }
        let mut faces = Vec::with_capacity(borders.len());
        let mut edges = Vec::with_capacity(borders.iter().map(Vec::len).sum::<usize>() / 2);
        for (left, border) in borders.iter_mut().enumerate() {
            border.sort_unstable();
            let left = index_u32(left);
            let sides = outline(border);
            // Between two sides with one face beyond them lies a point of an edge, which is no corner: the two planes meet in
            // a line.
            let corners: Vec<(usize, usize)> = (0..sides.len())
                .filter(|&i| sides[i].1 != sides[(i + sides.len() - 1) % sides.len()].1)
                .map(|i| sides[i])
                .collect();
            for (i, &(tail, beyond)) in corners.iter().enumerate() {
                let (head, _) = corners[(i + 1) % corners.len()];
                let right = face_of_group[beyond];
                if left < right {
                    edges.push(Edge { start: index_u32(tail), end: index_u32(head), left, right });
                }
            }
            let outline = corners.into_iter().map(|(corner, _)| index_u32(corner)).collect();
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
                        let plane = self.triangles[start].corners;
                        let is_in_plane = |corner| plane.contains(&corner) || self.volume(start, corner) == 0.0;
                        self.triangles[across].corners.into_iter().all(is_in_plane)
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
