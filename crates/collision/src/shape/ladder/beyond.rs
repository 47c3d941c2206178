//! How far the surface of a stand-in lies from the geometry at most: a maximum with its proof.
//!
//! # Method
//! Distances change by no more than the way. So over a triangle the distance from the geometry is at most that of its middle
//! and how far its corners are from there. The triangle of the greatest such bound is halved until the bound is near to the
//! greatest distance found, or a number of steps is spent: whenever it ends, the bound holds.
//!
//! The distance from a convex form is convex, so over a box it is greatest at a corner. There it is measured to a point within
//! the hull, which steps towards it.
//!
//! # Source
//! Branch and bound by the Lipschitz constant (Piyavskii 1972, Shubert 1972); Gilbert, "An iterative procedure for computing
//! the minimum of a quadratic form on a convex set" (1966).

use glam::DVec3;

use crate::{
    math::Norm,
    shape::Hull,
    tolerance::{LENGTH_WIDENING, SQUARE_MIN, STAND_IN_ROUNDING},
};

/// Triangles measured at most, beyond those that are there at the start. More narrow the bound by less than landmarks leave.
const STEPS_MAX: usize = 256;

/// A bound that is nearer than this part of it to a distance found is near enough.
const NEAR_ENOUGH: f64 = 1.0 / 16.0;

/// Steps towards a corner at most.
const APPROACHES_MAX: usize = 32;

struct Cell {
    corners: [DVec3; 3],
    /// No point of it is farther from the landmarks.
    upper: f64,
}

/// How far a surface is from points of a geometry that reaches so far, at most, metres.
pub(super) fn beyond_landmarks(surface: &[[DVec3; 3]], landmarks: &[DVec3], reach: f64) -> f64 {
    let mut found: f64 = 0.0;
    let mut measured = |corners: [DVec3; 3]| {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let nearest = landmarks.iter().map(|landmark| landmark.distance_squared(middle)).fold(f64::INFINITY, f64::min);
        let (distance, radius) =
            (nearest.sqrt(), corners.map(|corner| (corner - middle).norm()).into_iter().fold(0.0, f64::max));
        found = found.max(distance);
        (Cell { corners, upper: distance + radius }, found)
    };
    let mut cells: Vec<Cell> = surface.iter().map(|&corners| measured(corners).0).collect();
    for _ in 0..STEPS_MAX {
        let Some(widest) = (0..cells.len()).max_by(|&i, &j| cells[i].upper.total_cmp(&cells[j].upper)) else { break };
        let halves = halves(cells[widest].corners);
        let [(first, _), (second, found)] = halves.map(&mut measured);
        if cells[widest].upper - found <= cells[widest].upper * NEAR_ENOUGH {
            break;
        }
        cells[widest] = first;
        cells.push(second);
    }
    let upper = cells.iter().map(|cell| cell.upper).fold(0.0, f64::max);
    upward(upper, reach)
}

/// A triangle cut across its longest edge.
fn halves(corners: [DVec3; 3]) -> [[DVec3; 3]; 2] {
    let length = |at: usize| corners[(at + 1) % 3].distance_squared(corners[at]);
    let longest = if length(0) >= length(1).max(length(2)) { 0 } else { 1 + usize::from(length(2) > length(1)) };
    let [from, onto, apex] = [longest, (longest + 1) % 3, (longest + 2) % 3].map(|at| corners[at]);
    let middle = 0.5 * from + 0.5 * onto;
    [[from, middle, apex], [middle, onto, apex]]
}

/// How far the hull of points is from another at most, metres.
pub(super) fn beyond_hull(points: &[DVec3], hull: &Hull) -> f64 {
    let farthest = points.iter().map(|&point| distance_up(point, hull)).fold(0.0, f64::max);
    upward(farthest, hull.reach() + farthest)
}

/// Rounded up, what squares cannot tell included.
fn upward(length: f64, reach: f64) -> f64 {
    length * LENGTH_WIDENING + reach * STAND_IN_ROUNDING + SQUARE_MIN.sqrt()
}

/// The distance of a point from a point of the hull that is near to it.
fn distance_up(point: DVec3, hull: &Hull) -> f64 {
    let mut near = hull.vertex(hull.farthest(point - hull.center()));
    for _ in 0..APPROACHES_MAX {
        let rest = point - near;
        let step = hull.vertex(hull.farthest(rest)) - near;
        let (gain, square) = (step.dot(rest), step.length_squared());
        // NaN, which squares beyond the range give, ends it too.
        if !(gain > rest.length_squared() * NEAR_ENOUGH && square > 0.0) {
            break;
        }
        near += step * (gain / square).min(1.0);
    }
    (point - near).norm()
}
