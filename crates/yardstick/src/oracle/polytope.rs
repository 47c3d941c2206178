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

/// Edges and faces of a core, all of length 1.
struct Features {
    directions: Vec<Vector<Double>>,
    rough: Vec<Vector<f64>>,
    /// A corner, and the direction of an edge from it.
    lines: Vec<(usize, usize)>,
    faces: Vec<Vector<Double>>,
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
    Given(Vector<Double>),
}

/// Below this sine, or this length, a direction computed in f64 has too few digits to be looked at.
const ROUGH_MIN: f64 = 1e-3;

/// A direction is left out if in f64 it is worse than the best by more than this. Its error is less than a tenth.
const ROUGH_ERROR: f64 = 1e-11;

impl Features {
    fn of(body: &Body<Double>, corners: &[Vector<Double>], wiring: Wiring) -> Self {
        let (directions, lines, faces) = match wiring {
            Wiring::Box => {
                let axes = [0, 1, 2].map(|axis| body.turn.axis(axis));
                let is_start = |corner: &usize, axis: usize| corner >> axis & 1 == 0;
                let lines = (0..3).flat_map(|axis| {
                    (0..8_usize).filter(move |corner| is_start(corner, axis)).map(move |corner| (corner, axis))
                });
                (axes.to_vec(), lines.collect(), axes.to_vec())
            }
            Wiring::All => all_features(corners),
        };
        let rough = directions.iter().map(|direction| direction.rounded()).collect();
        Self { directions, rough, lines, faces }
    }
}

type Lines = Vec<(usize, usize)>;

fn all_features(corners: &[Vector<Double>]) -> (Vec<Vector<Double>>, Lines, Vec<Vector<Double>>) {
    let (mut directions, mut lines, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for (i, &start) in corners.iter().enumerate() {
        let first = directions.len();
        for &end in &corners[i + 1..] {
            if let Some(direction) = (end - start).unit() {
                lines.push((i, directions.len()));
                directions.push(direction);
            }
        }
        for (from, &u) in directions.iter().enumerate().skip(first) {
            faces.extend(directions[from + 1..].iter().filter_map(|&v| perpendicular(u, v)));
        }
    }
    (directions, lines, faces)
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
/// corners. The value is never above the truth, and below it by no more than rounding.
pub(super) fn signed_distance(pair: &Pair) -> Option<(Double, Vector<Double>)> {
    let (a, b) = (pair.exact.a.corners()?, pair.exact.b.corners()?);
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
        let one = |x: f64, y: f64, z: f64| vector(Double::of(x), Double::of(y), Double::of(z));
        let axes = [one(1.0, 0.0, 0.0), one(0.0, 1.0, 0.0), one(0.0, 0.0, 1.0)];
        let mut given = axes.to_vec();
        for features in &self.features {
            given.extend(&features.faces);
            let across = |edge: &Vector<Double>| axes.map(|axis| perpendicular(*edge, axis));
            given.extend(features.directions.iter().flat_map(across).flatten());
        }
        for direction in given {
            self.offer(Source::Given(direction), direction.rounded());
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

    /// A direction to 32 digits; `None` if its features coincide or are parallel.
    fn direction(&self, source: Source) -> Option<Vector<Double>> {
        let line = |side: usize, line: usize| {
            let (start, direction) = self.features[side].lines[line];
            (self.corners[side][start], self.features[side].directions[direction])
        };
        match source {
            Source::Given(direction) => Some(direction),
            Source::Corners(i, j) => (self.corners[1][j] - self.corners[0][i]).unit(),
            Source::CornerOfA(corner, edge) => {
                let (on_line, along) = line(1, edge);
                from_line(self.corners[0][corner], on_line, along)
            }
            Source::CornerOfB(edge, corner) => {
                let (on_line, along) = line(0, edge);
                from_line(self.corners[1][corner], on_line, along)
            }
            Source::Edges(i, j) => perpendicular(self.features[0].directions[i], self.features[1].directions[j]),
        }
    }

    fn conclude(self) -> Option<(Double, Vector<Double>)> {
        let near = self.found.iter().filter(|(gap, _)| *gap >= self.best - ROUGH_ERROR);
        let exact = near.filter_map(|(_, source)| Some(self.cores.gap_either_way(self.direction(*source)?)));
        exact.reduce(|best, next| if next.0 > best.0 { next } else { best })
    }
}
