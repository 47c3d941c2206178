//! On which side of three points a fourth one lies.
//!
//! # Method
//! By volumes, and exactly where rounding might decide: slivers, such as those of a needle and a plate, lose all digits of a volume that
//! is multiplied out.
//!
//! # Source
//! Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates" (1997), by the crate `robust`.
//!
//! # Limits
//! The points are taken as they are given. What they may be off by is allowed for in [`orientation`], not in [`has_origin_inside`].

use glam::DVec3;
use robust::{Coord3D, orient3d};

use crate::{
    math::{Norm, exact},
    tolerance::{CROSS_BLUR, PAIR_ROUNDING},
};

/// How three points go round a fourth.
pub(super) enum Turn {
    /// Counter-clockwise, seen from the far side: the volume that they span is positive.
    Left,
    /// Clockwise.
    Right,
}

/// How the first three of four vertices go round the fourth; `None` if they may lie in one plane.
pub(super) fn orientation([a, b, c, d]: [DVec3; 4]) -> Option<Turn> {
    let (u, v, w) = (b - a, c - a, d - a);
    let turn = |volume: f64| if volume > 0.0 { Turn::Left } else { Turn::Right };
    let volume = u.cross(v).dot(w);
    if volume.abs() > CROSS_BLUR * u.norm() * v.norm() * w.norm() {
        return Some(turn(volume));
    }
    // Each vertex may be off, and the height of a tetrahedron is its volume over the area of a side.
    let sides = [(u, v), (v, w), (w, u), (v - u, w - u)];
    let widest = sides.map(|(u, v)| exact::cross(u, v).norm()).into_iter().fold(0.0, f64::max);
    let volume = -orient3d(coordinate(a), coordinate(b), coordinate(c), coordinate(d));
    (volume.abs() > 4.0 * PAIR_ROUNDING * widest).then(|| turn(volume))
}

/// Whether the origin lies on the inner side of a triangle, exactly; not if it lies in its plane.
pub(super) fn has_origin_inside(a: DVec3, b: DVec3, c: DVec3) -> bool {
    orient3d(coordinate(a), coordinate(b), coordinate(c), coordinate(DVec3::ZERO)) > 0.0
}

fn coordinate(point: DVec3) -> Coord3D<f64> {
    Coord3D { x: point.x, y: point.y, z: point.z }
}
