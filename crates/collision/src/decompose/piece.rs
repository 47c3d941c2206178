//! Pieces of a mesh's surface, and how a plane cuts one in two.
//!
//! # Method
//! A piece is a list of convex polygons, each a part of a triangle. A plane cuts polygon by polygon; an edge that two of them
//! share is cut at one point for both. A closed piece is closed again by a *lid*: what of the plane lies in it. Of a lid only its
//! border is kept, directed edges of the surface and of other lids; where a plane cuts that, the points on the common line are
//! joined two by two, in order along it. So corners within the volume, where three planes meet, become points of the pieces,
//! and the hulls of all pieces cover surface and volume.
//!
//! That they do, whatever the rounding: the polygons of a closed piece and its lids, each filled where its border winds round, wind
//! round each point a whole number of times. The numbers of both halves add up to that of the whole, but for points nearer to the
//! plane of a cut than its border strays from it, as what fills a lid may differ only there. What is wound round lies in the
//! hull. So a point of the volume that is not covered lies in such a slab, and as slabs cannot cover a ball that is wider than
//! they are together, a covered one, or one of the surface, is within the sum of their widths.
//!
//! # Source
//! Slabs and balls: Bang, "A solution of the plank problem" (1951).

use glam::DVec3;
use smallvec::SmallVec;

use super::split::Split;
use crate::{math::Norm, shape::Mesh};

/// A convex polygon, by the numbers of its piece's points.
pub(super) type Polygon = SmallVec<[u32; 6]>;

/// A plane: all points `p` with `normal · p = offset`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Of length 1.
    pub(super) normal: DVec3,
    pub(super) offset: f64,
}

/// Where polygons go that lie in the plane of a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InPlane {
    /// To the side that they have behind them.
    Behind,
    /// To the side that the plane's normal points to.
    Ahead,
}

/// How to cut: where, what counts as in the plane, and what becomes of that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) plane: Plane,
    /// Points within this of the plane are in it, metres.
    pub(super) snap: f64,
    pub(super) in_plane: InPlane,
}

/// A part of a mesh's surface.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) points: Vec<DVec3>,
    polygons: Vec<Polygon>,
    /// The borders of lids, if it is closed by any: directed edges, each lid's surface to their left as seen from outside.
    lids: Vec<Vec<[u32; 2]>>,
    /// Both ends of each edge, the lesser first; in order.
    edges: Vec<[u32; 2]>,
}

/// Whether a piece encloses a volume, and is to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum IsClosed {
    Yes,
    No,
}

pub(super) const AHEAD: u8 = 1;
const BEHIND: u8 = 2;

/// What a cut makes of points and edges.
pub(super) struct Marks {
    /// −1, 0 or 1 for each point: behind the plane, in it, ahead.
    pub(super) sides: Vec<i8>,
    /// For each polygon to which sides it goes.
    polygons: Vec<u8>,
    /// For each point to which sides it goes, or has polygons that do.
    points: Vec<u8>,
}

impl Piece {
    /// All of a mesh.
    pub(super) fn whole(mesh: &Mesh) -> Self {
        let polygons = mesh.triangles().iter().map(|triangle| Polygon::from_slice(triangle)).collect();
        Self::of(mesh.vertices().to_vec(), polygons, Vec::new())
    }

    pub(super) fn of(points: Vec<DVec3>, polygons: Vec<Polygon>, lids: Vec<Vec<[u32; 2]>>) -> Self {
        let mut edges = Vec::with_capacity(polygons.len() * 2);
        for [tail, head] in polygons.iter().flat_map(sides_of).chain(lids.iter().flatten().copied()) {
            edges.push([tail.min(head), tail.max(head)]);
        }
        edges.sort_unstable();
        edges.dedup();
        Self { points, polygons, lids, edges }
    }

    /// The points of both sides of a cut; `None` if all are on one.
    pub(super) fn points_of_sides(&self, cut: &Cut) -> Option<[Vec<DVec3>; 2]> {
        let marks = self.marks(cut);
        let on = |side: u8| -> Vec<DVec3> {
            let points = self.points.iter().zip(&marks.points);
            points.filter(|&(_, mark)| mark & side != 0).map(|(&point, _)| point).collect()
        };
        let mut sides = [on(BEHIND), on(AHEAD)];
        if sides.iter().any(Vec::is_empty) {
            return None;
        }
        for &edge in self.edges.iter().filter(|&&edge| marks.is_cut(edge)) {
            let point = self.cut_point(edge, cut);
            sides.iter_mut().for_each(|side| side.push(point));
        }
        Some(sides)
    }

    /// Both sides of a cut, closed by lids if it is said that this is; `None` if all is on one.
    pub(super) fn halves(&self, cut: &Cut, is_closed: IsClosed) -> Option<[Self; 2]> {
        let marks = self.marks(cut);
        let split = Split::new(self, &marks, cut);
        let polygons = [BEHIND, AHEAD].map(|side| {
            let of_side = self.polygons.iter().zip(&marks.polygons).filter(|&(_, mark)| mark & side != 0);
            of_side.map(|(polygon, _)| split.clipped(polygon, side)).collect::<Vec<Polygon>>()
        });
        let mut lids = [Vec::new(), Vec::new()];
        if is_closed == IsClosed::Yes {
            for lid in &self.lids {
                let [behind, ahead] = split.lid_halves(lid);
                lids[0].extend(behind);
                lids[1].extend(ahead);
            }
            let border = split.open_border(&polygons[1], &lids[1]);
            if !border.is_empty() {
                lids[0].push(border.clone());
                lids[1].push(border.into_iter().map(|[tail, head]| [head, tail]).collect());
            }
        }
        // What lies wholly within the volume has lids only.
        if (0..2).any(|side| polygons[side].is_empty() && lids[side].is_empty()) {
            return None;
        }
        let [behind, ahead] = polygons;
        let [lids_behind, lids_ahead] = lids;
        Some([split.piece(behind, lids_behind), split.piece(ahead, lids_ahead)])
    }

    /// Both ends of each edge, the lesser first; in order.
    pub(super) fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    fn marks(&self, cut: &Cut) -> Marks {
        let side = |&point: &DVec3| {
            let height = cut.plane.normal.dot(point) - cut.plane.offset;
            i8::from(height > cut.snap) - i8::from(height < -cut.snap)
        };
        let sides: Vec<i8> = self.points.iter().map(side).collect();
        let mut points = vec![0; self.points.len()];
        let mut mark_polygon = |polygon: &Polygon| {
            let has = |sign: i8| polygon.iter().any(|&point| sides[point as usize] == sign);
            let mut mark = if has(1) { AHEAD } else { 0 } | if has(-1) { BEHIND } else { 0 };
            if mark == 0 {
                let looks_ahead = self.normal(polygon).dot(cut.plane.normal) > 0.0;
                mark = if cut.in_plane == InPlane::Behind && looks_ahead { BEHIND } else { AHEAD };
            }
            for &point in polygon {
                let is_of = |mark: u8, side: i8| if mark != 0 && sides[point as usize] != side { mark } else { 0 };
                points[point as usize] |= is_of(mark & AHEAD, -1) | is_of(mark & BEHIND, 1);
            }
            mark
        };
        let polygons = self.polygons.iter().map(&mut mark_polygon).collect();
        for &[tail, head] in self.lids.iter().flatten() {
            // Corners of lids alone, within the volume, have no polygon.
            for (point, other) in [(tail, head), (head, tail)] {
                let (own, other) = (sides[point as usize], sides[other as usize]);
                let strict = if own == 0 { other } else { own };
                points[point as usize] |= [BEHIND, 0, AHEAD][(strict + 1) as usize];
            }
        }
        Marks { sides, polygons, points }
    }

    /// Where a plane cuts an edge whose ends lie on both sides of it: a point within rounding of the edge.
    pub(super) fn cut_point(&self, edge: [u32; 2], cut: &Cut) -> DVec3 {
        let [a, b] = edge.map(|end| self.points[end as usize]);
        let [below, above] = [a, b].map(|end| cut.plane.normal.dot(end) - cut.plane.offset);
        let share = (below / (below - above)).clamp(0.0, 1.0);
        let between = a + (b - a) * share;
        between.clamp(a.min(b), a.max(b))
    }

    /// Along the normal of a polygon; of any length.
    fn normal(&self, polygon: &Polygon) -> DVec3 {
        let corner = |at: usize| self.points[polygon[at] as usize];
        (2..polygon.len()).map(|at| (corner(at - 1) - corner(0)).cross(corner(at) - corner(0))).sum()
    }
}

impl Marks {
    pub(super) fn is_cut(&self, edge: [u32; 2]) -> bool {
        let [a, b] = edge.map(|end| self.sides[end as usize]);
        a * b < 0
    }
}

impl Plane {
    /// The plane through a point across a direction of any length; `None` if that is 0.
    pub(super) fn through(point: DVec3, normal: DVec3) -> Option<Self> {
        let normal = normal.try_unit()?;
        Some(Self { normal, offset: normal.dot(point) })
    }
}

pub(super) fn sides_of(polygon: &Polygon) -> impl Iterator<Item = [u32; 2]> + '_ {
    polygon.iter().enumerate().map(|(at, &tail)| [tail, polygon[(at + 1) % polygon.len()]])
}
