//! Convex hulls: every point lies inside every face, the surface is closed, flat and straight sets keep their span.

use collision::{
    DVec3,
    shape::{Hull, Span},
};

use crate::random::Noise;

/// Panics unless `hull` is closed (Euler), convex and around all its points.
fn assert_is_solid_hull(hull: &Hull) {
    let topology = hull.topology();
    assert_eq!(topology.span, Span::Solid);
    let extent = hull.vertices().iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
    for face in &topology.faces {
        assert!((face.normal.length() - 1.0).abs() < 1e-15);
        for &vertex in hull.vertices() {
            let height = face.normal.dot(vertex) - face.offset;
            assert!(height <= 4.0 * f64::EPSILON * extent, "{vertex} stands out by {height}");
        }
    }
    let mut corners: Vec<u32> = topology.faces.iter().flat_map(|face| face.vertices.clone()).collect();
    corners.sort_unstable();
    corners.dedup();
    assert_eq!(corners.len() + topology.faces.len(), topology.edges.len() + 2, "Euler's formula");
    assert_eq!(topology.faces.iter().map(|face| face.vertices.len()).sum::<usize>(), 2 * topology.edges.len());
}

#[test]
fn a_cube_with_inner_and_face_points_has_six_square_faces() {
    let mut points = Vec::new();
    for i in 0..125 {
        points.push(DVec3::new(f64::from(i % 5), f64::from(i / 5 % 5), f64::from(i / 25)) - 2.0);
    }
    let hull = Hull::new(&points);
    assert_is_solid_hull(&hull);
    assert_eq!(hull.topology().faces.len(), 6);
}

#[test]
fn random_points_on_and_in_a_sphere() {
    let mut noise = Noise(0x9E37_79B9_7F4A_7C15);
    for count in [4, 5, 8, 32, 128, 1000] {
        for scale in [1e-6, 1.0, 1e6] {
            let on_sphere: Vec<DVec3> = (0..count).map(|_| noise.vector().normalize() * scale).collect();
            assert_is_solid_hull(&Hull::new(&on_sphere));
            let inside: Vec<DVec3> = (0..count).map(|_| noise.vector() * scale).collect();
            assert_is_solid_hull(&Hull::new(&inside));
        }
    }
}

#[test]
fn slivers_and_nearly_flat_points_stay_solid() {
    let mut noise = Noise(7);
    for flatness in [1e-3, 1e-7, 1e-11, 1e-15] {
        let points: Vec<DVec3> = (0..60).map(|_| noise.vector() * DVec3::new(1.0, flatness, 1.0)).collect();
        assert_is_solid_hull(&Hull::new(&points));
    }
}

#[test]
fn lower_dimensional_points_are_typed_hulls() {
    let span = |points: &[DVec3]| Hull::new(points).topology().span;
    assert_eq!(span(&[DVec3::ONE, DVec3::ONE]), Span::Point);
    assert_eq!(span(&[DVec3::ZERO, DVec3::ONE, DVec3::splat(0.25), DVec3::splat(-0.5)]), Span::Segment);
    let square: Vec<DVec3> = (0..9).map(|i| DVec3::new(f64::from(i % 3), 0.5, f64::from(i / 3))).collect();
    let hull = Hull::new(&square);
    assert_eq!(hull.topology().span, Span::Polygon);
    assert_eq!(hull.topology().edges.len(), 4);
    assert_eq!(hull.topology().faces.len(), 2);
    assert_eq!(hull.topology().faces[0].normal, -hull.topology().faces[1].normal);
}

#[test]
fn a_segment_ends_at_its_outermost_points() {
    let hull = Hull::new(&[DVec3::ZERO, DVec3::ONE, DVec3::splat(0.25), DVec3::splat(-0.5)]);
    let edge = hull.topology().edges[0];
    let mut ends = [hull.vertices()[edge.start as usize].x, hull.vertices()[edge.end as usize].x];
    ends.sort_by(f64::total_cmp);
    assert_eq!(ends, [-0.5, 1.0]);
}
