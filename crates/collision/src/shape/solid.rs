//! Whether a mesh encloses a volume, how large that is, and whether a point lies in it.
//!
//! # Method
//! A mesh is closed if each edge is passed as often one way as the other: then it winds round every point off its surface a
//! whole number of times, and the solid is where that number is not 0. It is counted along a ray to the nearest wall of the
//! mesh's box, in an order that no rounding can disturb: whether the ray passes a triangle is told by exact signs of areas
//! seen along it, where a point on the line of an edge counts as moved off it by infinitely little (the same way for all
//! triangles), and on which side of the triangle it begins by the exact sign of a volume.
//!
//! A place that is known but for rounding is where its middle is, if no triangle comes as near to that as the rounding: each
//! triangle near it must be parted from it by its plane or by one of its sides.
//!
//! # Source
//! Moving a point by infinitely little: Edelsbrunner, Mücke, "Simulation of Simplicity" (1990), section 4. Signs: Shewchuk,
//! "Adaptive precision floating-point arithmetic" (1997), by the crate `robust`.
//!
//! # Limits
//! A mesh whose triangles face both ways is not closed, even if no edge is open. Where closed surfaces run through each other
//! the number may be more than 1: that is inside. A surface turned inside out encloses what it encloses, its volume
//! counts as negative.

use std::{convert::Infallible, ops::ControlFlow};

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::Mesh;
use crate::{
    answer::Work,
    broad::{self, ALL_LAYERS, Path, Tree},
    math::{Aabb, Norm, expansion::triangle_cross, try_unit},
    tolerance::{EXACT_PART_MIN, TRIANGLE_PLANE},
};

/// Where a point lies, as to a closed surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Containment {
    /// In the solid, off its surface.
    Inside,
    /// Off the solid.
    Outside,
    /// Exactly on the surface; or the mesh is not closed; or a coordinate other than 0 is below 1e-60 m.
    Undecided,
}

impl Mesh {
    /// Whether it encloses a volume: each edge is passed as often one way as the other by the triangles at it. The first call
    /// sorts all edges.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.adjacency().is_closed()
    }

    /// The volume that it encloses, cubic metres, to within rounding; below 0 if its triangles face inwards. What it winds
    /// round several times counts as often. `None` if it is not closed. Costs a pass over the triangles.
    #[must_use]
    pub fn volume(&self) -> Option<f64> {
        let middle = self.bounds().center();
        let six_fold = |index: usize| {
            let [a, b, c] = self.corners(index).map(|corner| corner - middle);
            a.cross(b).dot(c)
        };
        self.is_closed().then(|| (0..self.triangles().len()).map(six_fold).sum::<f64>() / 6.0)
    }

    /// Where a point (in the mesh's frame) lies, decided exactly for the numbers as they are. Costs the triangles on the way to
    /// the nearest wall of the mesh's box.
    ///
    /// ```
    /// use collision::{DVec3, answer::Work, shape::{Containment, Form, Geometry}};
    /// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let geometry = Geometry::mesh(&corners, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
    /// let Form::Mesh(mesh) = geometry.form() else { panic!("a mesh") };
    /// let side = |x: f64| mesh.contains(DVec3::splat(x), &mut Work::default());
    /// assert_eq!((side(0.25), side(0.5)), (Containment::Inside, Containment::Outside));
    /// assert_eq!(side(0.0), Containment::Undecided);
    /// assert_eq!(mesh.volume(), Some(1.0 / 6.0));
    /// ```
    #[must_use]
    pub fn contains(&self, point: DVec3, work: &mut Work) -> Containment {
        let Some(bounds) = self.tree().bounds().filter(|_| self.is_closed() && is_exact(point)) else {
            return Containment::Undecided;
        };
        if !bounds.contains(Aabb::new(point, point)) {
            return Containment::Outside;
        }
        let line = Line::to_nearest_wall(point, bounds);
        let mut windings = Some(0);
        let Ok(()) = self.tree().visit_ray(&broad::Line::new(&line.path()), line.limit, ALL_LAYERS, work, |_, leaf| {
            let corners = self.corners(leaf as usize);
            windings = windings.and_then(|sum: i64| Some(sum + line.passes(corners)?));
            Ok::<f64, Infallible>(if windings.is_none() { f64::NEG_INFINITY } else { line.limit })
        });
        match windings {
            None => Containment::Undecided,
            Some(0) => Containment::Outside,
            Some(_) => Containment::Inside,
        }
    }

    /// Where all points within `radius` metres of a point lie; undecided unless they all are proved to lie alike. Costs as
    /// [`Mesh::contains`], and the triangles near the point.
    #[must_use]
    pub fn contains_ball(&self, center: DVec3, radius: f64, work: &mut Work) -> Containment {
        let side = self.contains(center, work);
        if side == Containment::Undecided || radius == 0.0 {
            return side;
        }
        let mut is_clear = true;
        self.near_box(Aabb::new(center - radius, center + radius), work, |triangle| {
            is_clear = is_clear && is_beyond(self.corners(triangle), center, radius);
            if is_clear { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        if is_clear { side } else { Containment::Undecided }
    }

    /// Calls `visit` with each triangle that may meet a box, until it breaks.
    pub(crate) fn near_box(&self, bounds: Aabb, work: &mut Work, mut visit: impl FnMut(usize) -> ControlFlow<()>) {
        let Ok(()) =
            self.tree().visit_box(bounds, ALL_LAYERS, work, |_, leaf| Ok::<_, Infallible>(visit(leaf as usize)));
    }
}

/// Whether a triangle is proved to be farther from a point than `radius`.
fn is_beyond([a, b, c]: [DVec3; 3], point: DVec3, radius: f64) -> bool {
    let parted_by = |normal: DVec3, corner: DVec3| {
        let apart = point - corner;
        normal.dot(apart) > radius + TRIANGLE_PLANE * (apart.norm() + radius)
    };
    let Some(front) = try_unit(triangle_cross([a, b, c])) else { return false };
    let by_side = |from: DVec3, to: DVec3| {
        try_unit((to - from).cross(front)).is_some_and(|outwards| parted_by(outwards, from) && parted_by(outwards, to))
    };
    parted_by(front, a) || parted_by(-front, a) || by_side(a, b) || by_side(b, c) || by_side(c, a)
}

/// A ray along an axis.
struct Line {
    start: DVec3,
    axis: usize,
    /// 1 along the axis, −1 against it.
    way: f64,
    limit: f64,
}

impl Line {
    fn to_nearest_wall(point: DVec3, bounds: Aabb) -> Self {
        let (mut axis, mut way, mut least) = (0, 1.0, f64::INFINITY);
        for candidate in 0..3 {
            let (below, above) = (point[candidate] - bounds.min[candidate], bounds.max[candidate] - point[candidate]);
            for (length, sign) in [(above, 1.0), (below, -1.0)] {
                if length < least {
                    (axis, way, least) = (candidate, sign, length);
                }
            }
        }
        // Twice the way to the wall is surely beyond it; where that is 0, so is the box's extent or the point is on a wall.
        let limit = 2.0 * least + (bounds.max - bounds.min).max_element();
        Self { start: point, axis, way, limit }
    }

    fn path(&self) -> Path {
        let mut direction = DVec3::ZERO;
        direction[self.axis] = self.way;
        Path { origin: self.start, direction, reach: DVec3::ZERO }
    }

    /// How often the ray leaves the solid through a triangle less how often it enters; `None` if it begins on it, or if the
    /// numbers are too small to tell.
    fn passes(&self, [a, b, c]: [DVec3; 3]) -> Option<i64> {
        if !(is_exact(a) && is_exact(b) && is_exact(c)) {
            return None;
        }
        let holds_start =
            |corner: DVec3| -> [bool; 2] { [corner.cmple(self.start).all(), corner.cmpge(self.start).all()] };
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let may_hold = holds_start(low)[0] && holds_start(high)[1];
        let turns = [self.turn(a, b), self.turn(b, c), self.turn(c, a)];
        let is_passed = turns[0] != 0.0 && turns[0] == turns[1] && turns[1] == turns[2];
        if !is_passed && !may_hold {
            return Some(0);
        }
        let side = orient3d(coordinates(a), coordinates(b), coordinates(c), coordinates(self.start));
        if side == 0.0 && (is_passed || is_in_closed([a, b, c], self.start)) {
            return None;
        }
        // Seen along the axis, a triangle that turns left faces that way; `side` is above 0 behind it.
        let is_ahead = is_passed && (side > 0.0) == (turns[0] * self.way > 0.0);
        Some(if is_ahead { (turns[0] * self.way) as i64 } else { 0 })
    }

    /// Which way a side turns round the start as seen against the axis: 1 or −1, and 0 only if it is seen as a point.
    fn turn(&self, from: DVec3, onto: DVec3) -> f64 {
        let (u, v) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let area = area_sign(from, onto, self.start, u, v);
        if area != 0.0 {
            return area.signum();
        }
        // The start moved by ε along u, and by ε² along v.
        let moved = if from[v] == onto[v] { onto[u] - from[u] } else { from[v] - onto[v] };
        if moved == 0.0 { 0.0 } else { moved.signum() }
    }
}

/// Exact sign of the area of a triangle seen along the axis that is neither of two.
fn area_sign(a: DVec3, b: DVec3, c: DVec3, u: usize, v: usize) -> f64 {
    let seen = |point: DVec3| Coord { x: point[u], y: point[v] };
    orient2d(seen(a), seen(b), seen(c))
}

/// Whether a point in a triangle's plane lies in it or on its border.
fn is_in_closed([a, b, c]: [DVec3; 3], point: DVec3) -> bool {
    (0..3).any(|axis| {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let whole = area_sign(a, b, c, u, v);
        let parts = [area_sign(a, b, point, u, v), area_sign(b, c, point, u, v), area_sign(c, a, point, u, v)];
        whole != 0.0 && parts.iter().all(|&part| part == 0.0 || (part > 0.0) == (whole > 0.0))
    })
}

fn coordinates(point: DVec3) -> Coord3D<f64> {
    Coord3D { x: point.x, y: point.y, z: point.z }
}

/// Whether signs of areas and volumes are exact for such a point: no product leaves the range of f64.
fn is_exact(point: DVec3) -> bool {
    point.to_array().iter().all(|&value| value == 0.0 || value.abs() >= EXACT_PART_MIN)
}
