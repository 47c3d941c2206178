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

/// How well a distance must be known.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Needed {
    /// As well as it can be.
    All,
    /// To a thousandth of it.
    Roughly,
}

/// What is enough roughly, as a part of the distance.
const ROUGHLY: f64 = 1e-3;

/// Bounds of the distance of the cores.
pub(super) fn distance(pair: &Pair, needed: Needed) -> Apart {
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
        let width = (found.upper - found.lower).nearest();
        let is_enough = needed == Needed::Roughly && width <= ROUGHLY * (found.lower - pair.radius).nearest();
        if width <= NARROW || idle > IDLE_MAX || is_enough {
            break;
        }
        simplex.push(corner);
        let Some((point, kept)) = nearest_of_hull(&simplex, if idle > 1 { Look::AtAll } else { Look::AtTheBest })
        else {
            break;
        };
        simplex = kept.iter().map(|&index| simplex[index]).collect();
        nearest = point;
        let length = point.length();
        if length < found.upper {
            (found.upper, idle) = (length, 0);
        }
    }
    found
}

/// Which subsets are computed to 32 digits.
#[derive(Clone, Copy, PartialEq)]
enum Look {
    /// The two that in f64 are best.
    AtTheBest,
    AtAll,
}

type Nearest = (Vector<Double>, Vec<usize>);

/// The point nearest to the origin of the hull of at most five points, and the at most three that carry it; all four
/// if the origin is inside.
fn nearest_of_hull(points: &[Vector<Double>], look: Look) -> Option<Nearest> {
    let mut subsets: Vec<(f64, u32)> = (1_u32..1 << points.len())
        .filter(|subset| subset.count_ones() <= 4)
        .map(|subset| (rough_square(points, subset), subset))
        .collect();
    if look == Look::AtTheBest {
        subsets.retain(|(square, _)| square.is_finite());
        subsets.sort_by(|a, b| a.0.total_cmp(&b.0));
        subsets.truncate(2);
    }
    let mut best: Option<(Double, Nearest)> = None;
    for (_, subset) in subsets {
        let members: Vec<usize> = (0..points.len()).filter(|index| subset >> index & 1 == 1).collect();
        let corners: Vec<Vector<Double>> = members.iter().map(|&index| points[index]).collect();
        let Some(point) = foot(&corners, FLAT) else { continue };
        let square = point.dot(point);
        if best.as_ref().is_none_or(|(least, _)| square < *least) {
            best = Some((square, (point, members)));
        }
    }
    match best {
        // In f64 none looked right.
        None if look == Look::AtTheBest => nearest_of_hull(points, Look::AtAll),
        best => best.map(|(_, nearest)| nearest),
    }
}

/// Below this part of its edges' lengths a determinant in f64 has no digits.
const ROUGHLY_FLAT: f64 = 1e-13;

/// The square of the distance of the foot in a subset, in f64; infinite if the foot is not between its corners.
fn rough_square(points: &[Vector<Double>], subset: u32) -> f64 {
    let mut corners = [Vector::<f64>::zero(); 4];
    let mut count = 0;
    let mut first: Option<Vector<Double>> = None;
    for (index, point) in points.iter().enumerate() {
        if subset >> index & 1 == 1 {
            // As seen from the first, so that points near to each other keep their digits.
            let from = *first.get_or_insert(*point);
            corners[count] = if count == 0 { point.rounded() } else { (*point - from).rounded() };
            count += 1;
        }
    }
    let edges = &corners[1..count.max(1)];
    foot_by(corners[0], edges, ROUGHLY_FLAT).map_or(f64::INFINITY, |point| point.dot(point))
}

/// The point nearest to the origin on the point, line, plane or space through the corners, if it lies between them.
fn foot(corners: &[Vector<Double>], flat: f64) -> Option<Vector<Double>> {
    let origin = corners[0];
    let edges: Vec<Vector<Double>> = corners[1..].iter().map(|&corner| corner - origin).collect();
    foot_by(origin, &edges, flat)
}

/// The same by one corner and the edges from it.
fn foot_by<T: Number>(origin: Vector<T>, edges: &[Vector<T>], flat: f64) -> Option<Vector<T>> {
    let (zero, one) = (T::of(0.0), T::of(1.0));
    let mut parts = [zero; 3];
    let towards = -origin;
    match *edges {
        [] => {}
        [u] => {
            let square = u.dot(u);
            parts[0] = (square > zero).then(|| towards.dot(u) / square)?;
        }
        [u, v] => {
            let normal = u.cross(v);
            let square = normal.dot(normal);
            if square.nearest() <= flat * flat * u.dot(u).nearest() * v.dot(v).nearest() {
                return None;
            }
            parts[0] = towards.cross(v).dot(normal) / square;
            parts[1] = u.cross(towards).dot(normal) / square;
        }
        [u, v, w] => {
            let volume = u.cross(v).dot(w);
            let most = u.length().nearest() * v.length().nearest() * w.length().nearest();
            if volume.nearest().abs() <= flat * most {
                return None;
            }
            parts = [towards.cross(v).dot(w), u.cross(towards).dot(w), u.cross(v).dot(towards)];
            parts = parts.map(|part| part / volume);
        }
        _ => return None,
    }
    let parts = &parts[..edges.len()];
    let rest = parts.iter().fold(one, |rest, &part| rest - part);
    if rest < zero || parts.iter().any(|&part| part < zero) {
        return None;
    }
    if parts.len() == 3 {
        return Some(Vector::zero());
    }
    Some(edges.iter().zip(parts).fold(origin, |point, (&edge, &part)| point + edge * part))
}
