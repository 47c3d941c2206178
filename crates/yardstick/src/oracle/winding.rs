//! How often a closed surface winds around a point.
//!
//! # Method
//! The sum of the solid angles of its triangles, each by the formula of van Oosterom and Strackee, "The solid angle of a plane
//! triangle" (1983).
//!
//! # Limits
//! In f64, so only for points off the surface.

use std::f64::consts::PI;

use glam::DVec3;

/// How often triangles that are closed together wind around a point: 1 inside of what is wound outwards, 0 outside.
#[must_use]
pub fn winding_number(triangles: &[[DVec3; 3]], point: DVec3) -> i64 {
    let angles = triangles.iter().map(|corners| {
        let [a, b, c] = corners.map(|corner| (corner - point).normalize_or_zero());
        let volume = a.dot(b.cross(c));
        2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    });
    #[allow(clippy::cast_possible_truncation, reason = "a small whole number")]
    let turns = (angles.sum::<f64>() / (4.0 * PI)).round() as i64;
    turns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_winds_around_what_is_in_it() {
        let corner = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|face: [usize; 3]| face.map(|k| corner[k]));
        assert_eq!(winding_number(&faces, DVec3::splat(0.1)), 1);
        assert_eq!(winding_number(&faces, DVec3::splat(0.4)), 0);
        assert_eq!(winding_number(&faces, DVec3::new(-0.1, 0.2, 0.2)), 0);
    }
}
