//! A hull of few of another's vertices, with a length by which it surely falls short of it at most.
//!
//! # Method
//! Vertices are added one by one, always the one farthest outside what is there: a point, a segment, a polygon, at last a
//! solid. What a vertex adds is a segment, a triangle, or the fan of triangles from it to the horizon; a vertex still left
//! out is then as near to the hull as it was, or as it is to what was added. So each step costs one look at every vertex
//! left out, and each distance is the true one, not that to a plane.
//!
//! ```text
//!          * p        p was as near to edge ab as it is; v adds the triangle avb,
//!        v            and p keeps the lesser of that distance and the one to avb
//!       / \
//!      /   \
//!     a-----b
//! ```
//!
//! The distance from a convex set is convex, so over the whole of the original it is greatest at a vertex. Each distance
//! is that to a point `Σ wᵢvᵢ / Σ wᵢ` with `wᵢ ≥ 0`, which lies in the hull whatever the rounding of the weights was; what is
//! rounded is the length of `Σ wᵢ(p − vᵢ) / Σ wᵢ`, and that goes upwards by [`WITNESS_ROUNDING`].
//!
//! # Source
//! The order is quickhull's (Barber, Dobkin, Huhdanpaa 1996) over all points at once; nearest points of a triangle by its
//! plane and its edges, as in Ericson, "Real-Time Collision Detection" (2005), section 5.1.5, but in axes of the longest
//! edge.
//!
//! # Limits
//! Greedy: not the best hull of so many vertices. The distance stated is above the true one by some 1e-15 of the hull's
//! size.

use glam::DVec3;

use super::{
    Hull,
    planar::{exact_cross, polygon},
    quickhull::{Builder, volume},
    scale::Scaled,
    topology::Span,
};
use crate::{
    math::Norm,
    tolerance::{LENGTH_WIDENING, WITNESS_ROUNDING},
};

/// A hull of some vertices of another, and how far they are apart.
#[derive(Debug)]
pub struct Simplified {
    /// The hull of the vertices kept, in their order in the original.
    pub hull: Hull,
    /// Every point of the original lies within this distance of `hull`, metres, rounded up; 0 if none was left out.
    pub outside: f64,
    /// Every point of `hull` lies within this distance of the original, metres: 0, as it is a part of it.
    pub inside: f64,
}

impl Hull {
    /// The hull of at most `max_vertices` of its vertices (0 counts as 1), or of fewer where those leave no point of the
    /// original farther outside than `max_error` metres (0 or NaN: as many as it takes to leave none).
    ///
    /// Vertices are added farthest first, so that more of them never make `outside` larger. With `max_error` 0, a budget of
    /// all vertices gives the same hull, and one of all corners the hull of those, both with `outside` 0. Costs the
    /// topology and O(n) for each vertex kept: 1,024 vertices to 64 take about 10 ms, 65,536 to 64 about 1 s.
    ///
    /// ```
    /// use collision::{DVec3, shape::Hull};
    /// let disc = |i: u32| f64::from(i) / 100.0 * std::f64::consts::TAU;
    /// let hull = Hull::new(&(0..100).map(|i| DVec3::new(disc(i).cos(), 0.0, disc(i).sin())).collect::<Vec<_>>());
    /// let simplified = hull.simplified(16, 0.0);
    /// assert_eq!(simplified.hull.vertices().len(), 16);
    /// assert!(simplified.outside < 0.05);
    /// ```
    #[must_use]
    pub fn simplified(&self, max_vertices: usize, max_error: f64) -> Simplified {
        let most = max_vertices.max(1);
        let may_leave_out = max_error > 0.0;
        if self.vertices().len() <= most && !may_leave_out {
            return self.with(0..self.vertices().len(), 0.0);
        }
        let scaled = Scaled::new(self.vertices());
        let corners = self.corners();
        let points: Vec<DVec3> = corners.iter().map(|&corner| scaled.points[corner as usize]).collect();
        let blur = 2.0 * scaled.blur;
        let (mut kept, outside) = if points.len() <= most && !may_leave_out {
            ((0..points.len()).collect(), 0.0)
        } else {
            Growth::new(&points).run(most, scaled.length_in(max_error) - blur)
        };
        kept.sort_unstable();
        let kept = kept.into_iter().map(|corner| corners[corner] as usize);
        self.with(kept, scaled.length_out_up(outside + blur))
    }

    /// The hull of at most `most` of some distinct points, with what it leaves out of the hull of all of them. The hull of all is
    /// never made: costs O(n) for each point kept.
    pub(super) fn spanned_by(points: &[DVec3], most: usize) -> Simplified {
        let scaled = Scaled::new(points);
        let (mut kept, outside) = Growth::new(&scaled.points).run(most, 0.0);
        kept.sort_unstable();
        let kept: Vec<DVec3> = kept.into_iter().map(|point| points[point]).collect();
        Simplified { hull: Self::new(&kept), outside: scaled.length_out_up(outside + 2.0 * scaled.blur), inside: 0.0 }
    }

    fn with(&self, kept: impl Iterator<Item = usize>, outside: f64) -> Simplified {
        let points: Vec<DVec3> = kept.map(|vertex| self.vertices()[vertex]).collect();
        Simplified { hull: Self::new(&points), outside, inside: 0.0 }
    }

    /// The vertices that are on its edges, in order; the first one if there is no edge.
    pub(crate) fn corners(&self) -> Vec<u32> {
        let topology = self.topology();
        if topology.span == Span::Point {
            return vec![0];
        }
        let mut corners: Vec<u32> = topology.edges.iter().flat_map(|edge| [edge.start, edge.end]).collect();
        corners.sort_unstable();
        corners.dedup();
        corners
    }
}

/// What the kept points span so far.
enum Kept<'a> {
    Point(usize),
    /// Its ends, the lesser coordinates first.
    Segment([usize; 2]),
    /// Three of its corners that are not on a line.
    Polygon([usize; 3]),
    Solid(Builder<'a>),
}

/// A hull that grows vertex by vertex.
struct Growth<'a> {
    points: &'a [DVec3],
    kept: Vec<usize>,
    form: Kept<'a>,
    /// For each point an upper bound of its distance from the hull of those kept, which are at 0.
    distance: Vec<f64>,
}

impl<'a> Growth<'a> {
    fn new(points: &'a [DVec3]) -> Self {
        let first = (0..points.len()).min_by(|&i, &j| along_line(points[i], points[j])).unwrap_or(0);
        let distance = vec![f64::INFINITY; points.len()];
        let mut growth = Self { points, kept: vec![first], form: Kept::Point(first), distance };
        growth.distance[first] = 0.0;
        growth.measure([first; 3]);
        growth
    }

    /// Grows until there are `most` points or none is farther out than `allowed`: the points, and the farthest distance.
    fn run(mut self, most: usize, allowed: f64) -> (Vec<usize>, f64) {
        loop {
            let (mut farthest, mut distance) = (0, 0.0);
            for (point, &found) in self.distance.iter().enumerate() {
                if found > distance {
                    (farthest, distance) = (point, found);
                }
            }
            if distance == 0.0 || distance <= allowed || self.kept.len() >= most {
                return (self.kept, distance);
            }
            self.kept.push(farthest);
            self.distance[farthest] = 0.0;
            self.extend(farthest);
        }
    }

    fn extend(&mut self, point: usize) {
        let points = self.points;
        match &mut self.form {
            &mut Kept::Point(first) => {
                self.form = Kept::Segment(sorted_ends(points, [first, point]));
                self.measure([first, point, point]);
            }
            &mut Kept::Segment([a, b]) if exact_cross(points[a], points[b], points[point]) == DVec3::ZERO => {
                let [start, _] = sorted_ends(points, [a, point]);
                let [_, end] = sorted_ends(points, [b, point]);
                self.form = Kept::Segment([start, end]);
                self.measure([start, end, end]);
            }
            &mut Kept::Segment([a, b]) => {
                self.form = Kept::Polygon([a, b, point]);
                self.measure([a, b, point]);
            }
            &mut Kept::Polygon(base) if volume(points, base, point) == 0.0 => self.extend_polygon(base, point),
            &mut Kept::Polygon(base) => {
                let mut solid = Builder::new(points, base, point);
                for &kept in &self.kept {
                    solid.add(kept);
                }
                measure_faces(points, &mut self.distance, &solid, 0, point);
                self.form = Kept::Solid(solid);
            }
            Kept::Solid(solid) => {
                if let Some(first) = solid.add(point) {
                    measure_faces(points, &mut self.distance, solid, first, point);
                }
            }
        }
    }

    /// What a point adds to a polygon lies in the triangle with its two neighbours.
    fn extend_polygon(&mut self, base: [usize; 3], point: usize) {
        // The base comes first: it tells in which coordinates the polygon is seen.
        let others = self.kept.iter().copied().filter(|kept| !base.contains(kept));
        let order: Vec<usize> = base.into_iter().chain(others).collect();
        let flat: Vec<DVec3> = order.iter().map(|&kept| self.points[kept]).collect();
        let topology = polygon(&flat, [0, 1, 2]);
        let outline = &topology.faces[0].vertices;
        let corner = |at: usize| order[outline[at % outline.len()] as usize];
        if let Some(at) = (0..outline.len()).find(|&at| corner(at) == point) {
            self.measure([corner(at + outline.len() - 1), point, corner(at + 1)]);
        }
    }

    /// Measures all points against a triangle of the hull, which may be a segment or a point.
    fn measure(&mut self, triangle: [usize; 3]) {
        let corners = triangle.map(|corner| self.points[corner]);
        for (&point, distance) in self.points.iter().zip(&mut self.distance) {
            if *distance > 0.0 {
                *distance = distance.min(distance_up(point, corners));
            }
        }
    }
}

/// Measures points against the faces of a solid from `first` on, all of which `apex` is a corner of unless `first` is 0.
/// Those that see none are inside.
fn measure_faces(points: &[DVec3], distances: &mut [f64], solid: &Builder<'_>, first: usize, apex: usize) {
    let faces: Vec<_> = solid.faces(first).collect();
    let from_apex = |corner: usize| points[corner].distance(points[apex]);
    let size = faces.iter().flatten().map(|&corner| from_apex(corner)).fold(0.0, f64::max);
    for (point, distance) in distances.iter_mut().enumerate() {
        if !solid.is_outside(point) {
            *distance = 0.0;
        } else if first == 0 || from_apex(point) <= *distance + size {
            // The nearest point lies on a face that is seen. By exact signs: of a nearly flat hull others tell nothing.
            for &face in faces.iter().filter(|&&face| volume(points, face, point) < 0.0) {
                *distance = distance.min(distance_up(points[point], face.map(|corner| points[corner])));
            }
        }
    }
}

/// The order of points on a line: that of their coordinates, x first.
fn along_line(a: DVec3, b: DVec3) -> std::cmp::Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
}

fn sorted_ends(points: &[DVec3], [a, b]: [usize; 2]) -> [usize; 2] {
    if along_line(points[a], points[b]).is_gt() { [b, a] } else { [a, b] }
}

/// The distance of a point from a triangle, rounded up. The triangle may be a segment or a point.
fn distance_up(point: DVec3, corners: [DVec3; 3]) -> f64 {
    let to = corners.map(|corner| point - corner);
    let mut least = foot_on_plane(to, corners).map_or(f64::INFINITY, |weights| witness_up(to, weights));
    for [from, onto] in [[0, 1], [1, 2], [2, 0]] {
        let edge = corners[onto] - corners[from];
        let share = to[from].dot(edge) / edge.length_squared();
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        let mut weights = [0.0; 3];
        weights[from] = 1.0 - share;
        weights[onto] += share;
        least = least.min(witness_up(to, weights));
    }
    least
}

/// The weights of the foot on the triangle's plane, if it lies in the triangle. Seen from the longest edge and the height
/// on it: in those axes needles lose no digits, while the Gram matrix of two edges loses all of theirs.
fn foot_on_plane(to: [DVec3; 3], corners: [DVec3; 3]) -> Option<[f64; 3]> {
    let length = |at: usize| corners[(at + 1) % 3].distance_squared(corners[at]);
    let longest = if length(0) >= length(1).max(length(2)) { 0 } else { 1 + usize::from(length(2) > length(1)) };
    let [from, onto, third] = [longest, (longest + 1) % 3, (longest + 2) % 3];
    let edge = corners[onto] - corners[from];
    let side = corners[third] - corners[from];
    let height = side - edge * (side.dot(edge) / edge.length_squared());
    let (mut along, mut up) = (0.0, 0.0);
    // The second round takes back what the first lost because the height is not quite across the edge.
    for _ in 0..2 {
        let rest = |along: f64, up: f64| to[from] - side * up - edge * along;
        up += rest(along, up).dot(height) / height.length_squared();
        along += rest(along, up).dot(edge) / edge.length_squared();
    }
    let mut weights = [0.0; 3];
    (weights[from], weights[onto], weights[third]) = (1.0 - along - up, along, up);
    weights.iter().all(|&weight| weight > 0.0).then_some(weights)
}

/// The length of `Σ wᵢ tᵢ / Σ wᵢ`, rounded up, for weights of at least 0, not all 0, and differences of one rounding.
fn witness_up(to: [DVec3; 3], weights: [f64; 3]) -> f64 {
    let total = weights[0] + weights[1] + weights[2];
    let [a, b, c] = weights.map(|weight| weight / total);
    let way = to[0] * a + to[1] * b + to[2] * c;
    let size = to[0].norm() * a + to[1].norm() * b + to[2].norm() * c;
    way.norm() * LENGTH_WIDENING + size * WITNESS_ROUNDING
}
