//! The distance of two cores of any kind, with a proof on both sides.
//!
//! # Method
//! The nearest point to the origin of the difference of the cores is sought by corners of that difference: each step adds
//! the support point against the best point so far, looks at all subsets of the at most five points there are, and keeps
//! the nearest. Any such point is an upper bound, the gap along any direction a lower one, so the answer is proved however
//! it was found. 32 digits, and as many steps as it takes.
//!
//! # Limits
//! Linear convergence: about one digit for each step. Cores that overlap are told from those that touch only by the
//! rounding of 32 digits.

use super::{
    double::{Double, Number},
    frame::Pair,
    space::{Vector, vector},
};

/// Bounds of the distance of two cores.
pub(super) struct Apart {
    /// The best gap along a direction; negative if none parts them.
    pub(super) lower: Double,
    /// The least distance of two points; 0 where the cores overlap.
    pub(super) upper: Double,
    /// From `a` to `b`, along which the lower bound is.
    pub(super) normal: Vector<Double>,
}

/// Steps without progress on either side before the search ends, and steps at all.
const IDLE_MAX: usize = 6;
const STEPS_MAX: usize = 400;

/// Bounds nearer to each other than this are not improved any more.
const NARROW: f64 = 1e-27;

/// A subset whose determinant is below this part of its edges' lengths is left to its own subsets.
const FLAT: f64 = 1e-26;

/// Bounds of the distance of the cores.
pub(super) fn distance(pair: &Pair) -> Apart {
    let cores = &pair.exact;
    let one = Double::of(1.0);
    let aside = vector(one, one, one);
    let start = cores.b.support(aside) - cores.a.support(aside);
    let mut simplex: Vec<Vector<Double>> = vec![start];
    let mut nearest = start;
    let mut found = Apart { lower: Double::of(f64::NEG_INFINITY), upper: start.length(), normal: Vector::zero() };
    let mut idle = 0;
    for _ in 0..STEPS_MAX {
        let Some(normal) = nearest.unit() else { break };
        let corner = cores.b.support(-normal) - cores.a.support(normal);
        let lower = corner.dot(normal);
        idle += 1;
        if lower > found.lower {
            (found.lower, found.normal, idle) = (lower, normal, 0);
        }
        if (found.upper - found.lower).nearest() <= NARROW || idle > IDLE_MAX {
            break;
        }
        simplex.push(corner);
        let Some((point, kept)) = nearest_of_hull(&simplex) else { break };
        simplex = kept.iter().map(|&index| simplex[index]).collect();
        nearest = point;
        let length = point.length();
        if length < found.upper {
            (found.upper, idle) = (length, 0);
        }
    }
    found
}

/// The point nearest to the origin of the hull of at most five points, and the at most three that carry it; all four
/// if the origin is inside.
fn nearest_of_hull(points: &[Vector<Double>]) -> Option<(Vector<Double>, Vec<usize>)> {
    let mut best: Option<(Double, Vector<Double>, Vec<usize>)> = None;
    for subset in 1_usize..1 << points.len() {
        let members: Vec<usize> = (0..points.len()).filter(|index| subset >> index & 1 == 1).collect();
        if members.len() > 4 {
            continue;
        }
        let corners: Vec<Vector<Double>> = members.iter().map(|&index| points[index]).collect();
        let Some(point) = foot(&corners) else { continue };
        let square = point.dot(point);
        if best.as_ref().is_none_or(|(least, ..)| square < *least) {
            best = Some((square, point, members));
        }
    }
    best.map(|(_, point, members)| (point, members))
}

/// The point nearest to the origin on the point, line, plane or space through the corners, if it lies between them.
fn foot(corners: &[Vector<Double>]) -> Option<Vector<Double>> {
    let origin = corners[0];
    let edges: Vec<Vector<Double>> = corners[1..].iter().map(|&corner| corner - origin).collect();
    let zero = Double::of(0.0);
    let parts: Vec<Double> = match *edges.as_slice() {
        [] => vec![],
        [u] => {
            let square = u.dot(u);
            (square > zero).then(|| vec![-origin.dot(u) / square])?
        }
        [u, v] => {
            let normal = u.cross(v);
            let square = normal.dot(normal);
            if square.nearest() <= FLAT * FLAT * u.dot(u).nearest() * v.dot(v).nearest() {
                return None;
            }
            let towards = -origin;
            vec![towards.cross(v).dot(normal) / square, u.cross(towards).dot(normal) / square]
        }
        [u, v, w] => {
            let volume = u.cross(v).dot(w);
            let most = u.length().nearest() * v.length().nearest() * w.length().nearest();
            if volume.nearest().abs() <= FLAT * most {
                return None;
            }
            let towards = -origin;
            let parts = [towards.cross(v).dot(w), u.cross(towards).dot(w), u.cross(v).dot(towards)];
            parts.map(|part| part / volume).to_vec()
        }
        _ => return None,
    };
    let rest = parts.iter().fold(Double::of(1.0), |rest, &part| rest - part);
    if rest < zero || parts.iter().any(|&part| part < zero) {
        return None;
    }
    if parts.len() == 3 {
        return Some(Vector::zero());
    }
    Some(edges.iter().zip(&parts).fold(origin, |point, (&edge, &part)| point + edge * part))
}
