//! Convex hulls: every point lies inside every face, the surface is closed, flat and straight sets keep their span.

use collision::{
    DVec3,
    math::expansion::ExactVector,
    shape::{Hull, Span},
};

use crate::random::Noise;

/// Panics unless `hull` is closed (Euler), convex and around all its points.
fn assert_is_solid_hull(hull: &Hull) {
    let topology = hull.topology();
    assert_eq!(topology.span, Span::Solid);
    let extent = hull.vertices().iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
    // The last bit of what is subnormal is more than a rounding of it.
    let slack = 4.0 * f64::EPSILON * extent + 4.0 * f64::from_bits(1);
    for face in &topology.faces {
        assert!((face.normal.length() - 1.0).abs() < 1e-15);
        for &vertex in hull.vertices() {
            let height = face.normal.dot(vertex) - face.offset;
            assert!(height <= slack, "{vertex} stands out by {height}");
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
    // Found by a random search: ends that are an ulp apart were told apart by rounded products.
    let line = [-3.625, 1.5, 3.5755597248348683, 3.5755597248348687].map(DVec3::splat);
    for points in [line, line.map(|point| -point)] {
        let edge = Hull::new(&points).topology().edges[0];
        assert_eq!((edge.start.min(edge.end), edge.start.max(edge.end)), (0, 3));
    }
}

/// Found by a random search: with rounded differences the sides of these have no area, and their normals were guessed. Rays
/// then touched the first of them 0.8 m off its surface.
#[test]
fn needles_thinner_than_rounding_have_the_normals_of_their_sides() {
    let points = [
        DVec3::new(2.3232803344726563, 0.17334890365600575, 0.4815526008605956),
        DVec3::new(-0.32328033447265636, 1.8266510963439941, 1.5184473991394043),
        DVec3::splat(0.9999999999999999),
        DVec3::new(-1.6465606689453125, 2.6533021926879883, 2.0368947982788086),
        DVec3::new(3.6465606689453125, -0.6533021926879884, -0.036894798278808705),
    ];
    let mut noise = Noise(37);
    let mut needles = vec![points.to_vec()];
    for _ in 0..200 {
        let (start, way) = (noise.vector(), noise.vector());
        needles.push((0..12).map(|_| start + way * noise.signed()).collect());
    }
    let mut solid = 0;
    for points in needles {
        let hull = Hull::new(&points);
        solid += u32::from(hull.topology().span == Span::Solid);
        for face in &hull.topology().faces {
            let corner = |index: usize| hull.vertices()[face.vertices[index] as usize];
            for index in 1..face.vertices.len() {
                let side = ExactVector::difference(corner(index), corner(0));
                let normal = ExactVector::difference(face.normal, DVec3::ZERO);
                let lean = side.dot(&normal).estimate() / (corner(index) - corner(0)).length();
                assert!(lean.abs() < 4.0 * f64::EPSILON, "{face:?} leans by {lean}");
            }
        }
    }
    assert!(solid > 150, "{solid}");
}

/// Found by a random search: points on an edge between two faces were corners of both, and a walk over the edges ended there.
#[test]
fn points_on_edges_are_no_corners_and_hold_no_walk_up() {
    let mut noise = Noise(41);
    for _ in 0..200 {
        let points: Vec<DVec3> = (0..40).map(|_| (noise.vector() * 2.5).round()).collect();
        let hull = Hull::new(&points);
        if hull.topology().span != Span::Solid {
            continue;
        }
        assert_is_solid_hull(&hull);
        for face in &hull.topology().faces {
            let count = face.vertices.len();
            let corner = |index: usize| hull.vertices()[face.vertices[index % count] as usize];
            for index in 0..count {
                let turn = (corner(index + 1) - corner(index)).cross(corner(index + 2) - corner(index + 1));
                assert_ne!(turn, DVec3::ZERO, "{face:?} goes straight on after {index}");
            }
        }
        for axis in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
            let highest = hull.vertices()[hull.farthest(axis) as usize].dot(axis);
            for start in 0..hull.vertices().len() as u32 {
                assert_eq!(hull.vertices()[hull.climb(axis, start) as usize].dot(axis), highest, "{points:?}");
            }
        }
    }
}

/// The faces of a hull by their vertices, whatever the scale was.
fn outlines(points: &[DVec3]) -> Vec<Vec<u32>> {
    Hull::new(points).topology().faces.iter().map(|face| face.vertices.clone()).collect()
}

#[test]
fn signs_are_exact_at_every_size_a_number_can_have() {
    let mut noise = Noise(23);
    let points: Vec<DVec3> = (0..40).map(|_| noise.vector()).collect();
    let whole: Vec<DVec3> = points.iter().map(|&point| (point * 1048576.0).round()).collect();
    for exponent in [-1000, -700, -530, -360, -100, 39] {
        let scale = 2.0_f64.powi(exponent);
        let scaled: Vec<DVec3> = points.iter().map(|&point| point * scale).collect();
        assert_eq!(outlines(&points), outlines(&scaled), "2^{exponent}");
        assert_is_solid_hull(&Hull::new(&scaled));
    }
    // Whole numbers of the least number there is.
    let least: Vec<DVec3> =
        whole.iter().map(|point| DVec3::from(point.to_array().map(|x| x * f64::from_bits(1)))).collect();
    assert_eq!(outlines(&whole), outlines(&least));
    assert_is_solid_hull(&Hull::new(&least));
}

#[test]
fn what_is_far_below_the_largest_coordinate_is_decided_exactly_or_counts_as_nothing() {
    let corner = |thin: f64| [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.3, 0.3, thin)];
    for thin in [1e-16, 1e-100, 1e-120] {
        let hull = Hull::new(&corner(thin));
        assert_is_solid_hull(&hull);
        assert_eq!(hull.topology().faces.len(), 4);
    }
    for thin in [1e-130, 1e-160, 1e-310] {
        assert_eq!(Hull::new(&corner(thin)).topology().span, Span::Polygon);
        let points = [DVec3::X, DVec3::new(1.0, thin, 0.0), DVec3::new(1.0, 0.0, thin)];
        assert_eq!(Hull::new(&points).topology().span, Span::Point);
    }
    // The same thickness far from the origin, where the last bit of a coordinate is 1e-16 of it.
    let lifted: Vec<DVec3> = corner(f64::EPSILON).iter().map(|&point| point + DVec3::Z).collect();
    assert_is_solid_hull(&Hull::new(&lifted));
}

#[test]
fn duplicates_and_points_within_a_rounding_of_each_other_change_no_span() {
    let mut noise = Noise(29);
    for flatness in [DVec3::ONE, DVec3::new(1.0, 1e-16, 1.0)] {
        let mut points: Vec<DVec3> = (0..20).map(|_| noise.vector() * flatness).collect();
        for i in 0..40 {
            let point = points[i % 20];
            points.push(if i % 2 == 0 { point } else { point + noise.vector() * 2e-16 * flatness });
        }
        assert_is_solid_hull(&Hull::new(&points));
    }
    let line: Vec<DVec3> = (0..50).map(|i| DVec3::new(1.0, 2.0, -3.0) * f64::from(i % 7)).collect();
    assert_eq!(Hull::new(&line).topology().span, Span::Segment);
}

#[test]
fn large_grids_and_spheres_are_built_without_a_quadratic_cost() {
    let grid: Vec<DVec3> =
        (0..64_000).map(|i| DVec3::from([i % 40, i / 40 % 40, i / 1600].map(f64::from)) * 0.1).collect();
    assert_eq!(Hull::new(&grid).topology().faces.len(), 6);
    let mut noise = Noise(31);
    let sphere: Vec<DVec3> = (0..65_536).map(|_| noise.vector().normalize()).collect();
    let hull = Hull::new(&sphere);
    assert_eq!(hull.topology().faces.len() + hull.vertices().len(), hull.topology().edges.len() + 2);
    // Two arcs that cross at right angles: each corner of one sees each of the other.
    let arcs: Vec<DVec3> = (0..8192)
        .map(|i| {
            let (sine, cosine) = (f64::from(i / 2) / 4096.0 - 0.5).sin_cos();
            if i % 2 == 0 { DVec3::new(sine, 0.0, cosine) } else { DVec3::new(0.0, sine, -cosine) }
        })
        .collect();
    assert_eq!(Hull::new(&arcs).topology().span, Span::Solid);
}
