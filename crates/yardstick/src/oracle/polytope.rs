//! The signed distance of two cores that have corners only: all directions looked at.
//!
//! # Method
//! For any unit vector the gap along it is a lower bound of the signed distance (for overlaps: minus the width along it, so
//! an upper bound of the depth). The bound is reached along one of finitely many directions: from corner to corner, from
//! corner to edge, across two edges, across a face; all of them are tried, with any two corners of a hull as an edge and
//! any three as a face, since superfluous directions do no harm. A first look in f64 leaves out what is far from the best;
//! what is left is computed to 32 digits.
//!
//! # Limits
//! Cost is cubic in the corners. A direction is made perpendicular to its features a second time, so that it is the exact
//! direction of corners moved by parts of 1e-31: the signed distance then is off by no more than they moved.

use super::{
    double::{Double, Number},
    frame::{Body, Cores, Pair, Wiring},
    space::{Vector, vector},
};

/// Edges and faces of a core, in f64: what is exact is computed where it is wanted.
struct Features {
    /// The corners at both ends of each direction of edges.
    ends: Vec<(usize, usize)>,
    /// Those of a box, which may be flat.
    axes: Option<[Vector<Double>; 3]>,
    /// Its unit vector.
    rough: Vec<Vector<f64>>,
    /// A corner, and the direction of an edge from it.
    lines: Vec<(usize, usize)>,
    /// Two directions across each face.
    faces: Vec<(usize, usize)>,
}

/// Where a direction comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    Corners(usize, usize),
    /// A corner of `a`, an edge of `b`.
    CornerOfA(usize, usize),
    /// An edge of `a`, a corner of `b`.
    CornerOfB(usize, usize),
    Edges(usize, usize),
    /// Of one side, across two of its directions.
    Face(usize, usize, usize),
    /// Of one side, across one of its directions and an axis.
    Across(usize, usize, usize),
    Axis(usize),
}

/// Below this sine, or this length, a direction computed in f64 has too few digits to be looked at.
const ROUGH_MIN: f64 = 1e-3;

/// A direction is left out if in f64 it is worse than the best by more than this. Its error is less than a tenth.
const ROUGH_ERROR: f64 = 1e-11;

impl Features {
    fn of(body: &Body<Double>, corners: &[Vector<Double>], wiring: Wiring) -> Self {
        let (ends, lines, faces) = match wiring {
            Wiring::Box => {
                let is_start = |corner: &usize, axis: usize| corner >> axis & 1 == 0;
                let lines = (0..3).flat_map(|axis| {
                    (0..8_usize).filter(move |corner| is_start(corner, axis)).map(move |corner| (corner, axis))
                });
                (Vec::new(), lines.collect(), vec![(0, 1), (0, 2), (1, 2)])
            }
            Wiring::All => all_features(corners.len()),
        };
        // The difference to 32 digits first, so that short edges have all their digits.
        let axes = (wiring == Wiring::Box).then(|| [0, 1, 2].map(|axis| body.turn.axis(axis)));
        let rough = ends.iter().map(|&(start, end)| {
            let way = (corners[end] - corners[start]).rounded();
            let most = way.x.abs().max(way.y.abs()).max(way.z.abs());
            let way = if most > 0.0 { way * (1.0 / most) } else { way };
            way.unit().unwrap_or(Vector::zero())
        });
        let rough = match &axes {
            Some(axes) => axes.iter().map(|axis| axis.rounded()).collect(),
            None => rough.collect(),
        };
        Self { rough, ends, axes, lines, faces }
    }
}

type Ends = Vec<(usize, usize)>;

fn all_features(count: usize) -> (Ends, Ends, Ends) {
    let (mut ends, mut lines, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for start in 0..count {
        let first = ends.len();
        for end in start + 1..count {
            lines.push((start, ends.len()));
            ends.push((start, end));
        }
        for from in first..ends.len() {
            faces.extend((from + 1..ends.len()).map(|to| (from, to)));
        }
    }
    (ends, lines, faces)
}

/// The unit vector across two unit vectors; `None` if they are parallel to within 1e-28.
pub(super) fn perpendicular(u: Vector<Double>, v: Vector<Double>) -> Option<Vector<Double>> {
    let cross = u.cross(v);
    if cross.length().nearest() <= 1e-28 {
        return None;
    }
    cross.unit()?.across(u).unit()
}

/// The direction of a corner from a line, both to 32 digits.
fn from_line(corner: Vector<Double>, on_line: Vector<Double>, along: Vector<Double>) -> Option<Vector<Double>> {
    (corner - on_line).across(along).unit()?.across(along).unit()
}

fn axis_of<T: Number>(axis: usize) -> Vector<T> {
    let part = |index: usize| T::of(if index == axis { 1.0 } else { 0.0 });
    vector(part(0), part(1), part(2))
}

struct Search<'a> {
    cores: &'a Cores<Double>,
    rough: &'a Cores<f64>,
    corners: [&'a [Vector<Double>]; 2],
    rough_corners: [&'a [Vector<f64>]; 2],
    features: [Features; 2],
    /// Gap in f64, and whose it is.
    found: Vec<(f64, Source)>,
    best: f64,
}

/// The signed distance of two cores and the unit vector from `a` to `b` along which it is; `None` if one has more than
/// corners, or too many of them. The value is never above the truth, and below it by no more than rounding.
pub(super) fn signed_distance(pair: &Pair) -> Option<(Double, Vector<Double>)> {
    let (a, b) = (pair.exact.a.corners()?, pair.exact.b.corners()?);
    if pair.has_many_corners() {
        return None;
    }
    let features = [Features::of(&pair.exact.a, a.0, a.1), Features::of(&pair.exact.b, b.0, b.1)];
    let mut search = Search {
        cores: &pair.exact,
        rough: &pair.rough,
        corners: [a.0, b.0],
        rough_corners: [pair.rough.a.corners()?.0, pair.rough.b.corners()?.0],
        features,
        found: Vec::new(),
        best: f64::NEG_INFINITY,
    };
    search.offer_given();
    search.offer_corners();
    search.offer_lines();
    search.offer_edges();
    search.conclude()
}

impl Search<'_> {
    /// Offers a direction computed in f64, or computes it to 32 digits first if that has too few.
    fn offer(&mut self, source: Source, rough: Vector<f64>) {
        let length = rough.length();
        let unit = if length >= ROUGH_MIN {
            rough * (1.0 / length)
        } else {
            let Some(unit) = self.direction(source) else { return };
            unit.rounded()
        };
        let (gap, _) = self.rough.gap_either_way(unit);
        if gap >= self.best - ROUGH_ERROR {
            self.best = self.best.max(gap);
            self.found.push((gap, source));
        }
    }

    /// Faces, and for forms without volume what is across one edge, or any direction.
    fn offer_given(&mut self) {
        (0..3).for_each(|axis| self.offer(Source::Axis(axis), axis_of(axis)));
        for side in [0, 1] {
            for face in 0..self.features[side].faces.len() {
                let (u, v) = self.features[side].faces[face];
                let cross = self.features[side].rough[u].cross(self.features[side].rough[v]);
                self.offer(Source::Face(side, u, v), cross);
            }
            for edge in 0..self.features[side].rough.len() {
                for axis in 0..3 {
                    let cross = self.features[side].rough[edge].cross(axis_of(axis));
                    self.offer(Source::Across(side, edge, axis), cross);
                }
            }
        }
    }

    fn offer_corners(&mut self) {
        for i in 0..self.corners[0].len() {
            for j in 0..self.corners[1].len() {
                let way = self.rough_corners[1][j] - self.rough_corners[0][i];
                self.offer(Source::Corners(i, j), way);
            }
        }
    }

    fn offer_lines(&mut self) {
        for side in [0, 1] {
            for line in 0..self.features[side].lines.len() {
                let (start, direction) = self.features[side].lines[line];
                let along = self.features[side].rough[direction];
                for corner in 0..self.corners[1 - side].len() {
                    let way = self.rough_corners[1 - side][corner] - self.rough_corners[side][start];
                    let source =
                        if side == 0 { Source::CornerOfB(line, corner) } else { Source::CornerOfA(corner, line) };
                    self.offer(source, way.across(along));
                }
            }
        }
    }

    fn offer_edges(&mut self) {
        for i in 0..self.features[0].rough.len() {
            for j in 0..self.features[1].rough.len() {
                let cross = self.features[0].rough[i].cross(self.features[1].rough[j]);
                self.offer(Source::Edges(i, j), cross);
            }
        }
    }

    /// The unit vector along an edge; `None` if its ends coincide.
    fn along(&self, side: usize, edge: usize) -> Option<Vector<Double>> {
        if let Some(axes) = self.features[side].axes {
            return Some(axes[edge]);
        }
        let (start, end) = self.features[side].ends[edge];
        (self.corners[side][end] - self.corners[side][start]).unit()
    }

    /// A direction to 32 digits; `None` if its features coincide or are parallel.
    fn direction(&self, source: Source) -> Option<Vector<Double>> {
        let line = |side: usize, line: usize| {
            let (start, direction) = self.features[side].lines[line];
            Some((self.corners[side][start], self.along(side, direction)?))
        };
        match source {
            Source::Axis(axis) => Some(axis_of(axis)),
            Source::Face(side, u, v) => perpendicular(self.along(side, u)?, self.along(side, v)?),
            Source::Across(side, edge, axis) => perpendicular(self.along(side, edge)?, axis_of(axis)),
            Source::Corners(i, j) => (self.corners[1][j] - self.corners[0][i]).unit(),
            Source::CornerOfA(corner, edge) => {
                let (on_line, along) = line(1, edge)?;
                from_line(self.corners[0][corner], on_line, along)
            }
            Source::CornerOfB(edge, corner) => {
                let (on_line, along) = line(0, edge)?;
                from_line(self.corners[1][corner], on_line, along)
            }
            Source::Edges(i, j) => perpendicular(self.along(0, i)?, self.along(1, j)?),
        }
    }

    fn conclude(self) -> Option<(Double, Vector<Double>)> {
        let near = self.found.iter().filter(|(gap, _)| *gap >= self.best - ROUGH_ERROR);
        let exact = near.filter_map(|(_, source)| Some(self.cores.gap_either_way(self.direction(*source)?)));
        exact.reduce(|best, next| if next.0 > best.0 { next } else { best })
    }
}
