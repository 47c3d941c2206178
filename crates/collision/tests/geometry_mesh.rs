//! What is kept of a mesh as sent.

use collision::{
    DVec3,
    shape::{Form, Geometry, Mesh},
};

fn mesh_of(geometry: &Geometry) -> &Mesh {
    match geometry.form() {
        Form::Mesh(mesh) => mesh,
        _ => panic!("a mesh was made"),
    }
}

/// A closed tetrahedron, its corners sent three times over, as stl readers do.
fn soup() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let vertices = faces.iter().flatten().map(|&corner: &usize| corners[corner]).collect();
    (vertices, (0..4).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect())
}

#[test]
fn equal_vertices_are_one_and_neighbours_are_found() {
    let (vertices, triangles) = soup();
    let geometry = Geometry::mesh(&vertices, &triangles).expect("a tetrahedron");
    let report = mesh_of(&geometry).report();
    assert_eq!((report.triangles_sent, report.degenerate, report.merged_vertices), (4, 0, 8));
    assert_eq!((report.open_edges, report.non_manifold_edges), (0, 0));
    let adjacency = mesh_of(&geometry).adjacency();
    for triangle in 0..4 {
        let mut neighbours: Vec<usize> =
            (0..3).flat_map(|side| adjacency.across(triangle, side)).map(|(other, _)| other).collect();
        neighbours.sort_unstable();
        let others: Vec<usize> = (0..4).filter(|&other| other != triangle).collect();
        assert_eq!(neighbours, others);
    }
}

#[test]
fn open_and_many_sided_edges_are_counted() {
    let (mut vertices, mut triangles) = soup();
    triangles.pop();
    let open = Geometry::mesh(&vertices, &triangles).expect("three faces");
    assert_eq!(mesh_of(&open).report().open_edges, 3);
    vertices.extend([DVec3::ZERO, DVec3::X, DVec3::new(0.0, -1.0, -1.0)]);
    triangles.push([12, 13, 14]);
    let fin = Geometry::mesh(&vertices, &triangles).expect("four faces");
    assert_eq!(mesh_of(&fin).report().non_manifold_edges, 1);
}

#[test]
fn triangles_without_area_are_left_out_and_numbers_stay_as_sent() {
    let third = 1.0 / 3.0;
    let vertices = [DVec3::ZERO, DVec3::splat(third), DVec3::splat(third * 2.0), DVec3::X, DVec3::ZERO];
    let triangles = [[0, 1, 2], [0, 3, 1], [0, 4, 3], [3, 2, 0]];
    let geometry = Geometry::mesh(&vertices, &triangles).expect("two faces");
    let mesh = mesh_of(&geometry);
    assert_eq!(mesh.report().degenerate, 2);
    assert_eq!([mesh.sent_number(0), mesh.sent_number(1)], [1, 3]);
    let larger = geometry.clone().scaled(4.0).expect("four times as large");
    assert_eq!([mesh_of(&larger).sent_number(0), mesh_of(&larger).sent_number(1)], [1, 3]);
    assert_eq!(mesh_of(&larger).report().triangles_sent, 4);
    assert_eq!(larger.local_bounds().max, geometry.local_bounds().max * 4.0);
}

#[test]
fn slivers_are_kept_down_to_the_last_bit() {
    let at = |x: f64, y: f64| DVec3::new(x, y, 1e6);
    let line = [at(0.1, 0.1), at(0.7, 0.7), at(0.3, 0.3)];
    assert!(Geometry::mesh(&line, &[[0, 1, 2]]).is_err());
    for y in [0.3_f64.next_up(), 0.3_f64.next_down()] {
        assert!(Geometry::mesh(&[line[0], line[1], at(0.3, y)], &[[0, 1, 2]]).is_ok());
    }
}

#[test]
fn lines_whose_rounded_differences_span_an_area_are_left_out() {
    let along = DVec3::new(3.0, 5.0, 7.0) / f64::from(1 << 20);
    let at = |steps: i64| along * steps as f64;
    let points = [at(-(1 << 50) - 1), at((1 << 50) + 2), at(-5)];
    assert_ne!((points[1] - points[0]).cross(points[2] - points[0]), DVec3::ZERO, "rounding shows");
    assert!(Geometry::mesh(&points, &[[0, 1, 2]]).is_err());
}

#[test]
fn vertices_that_no_triangle_uses_do_not_widen_the_box() {
    let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::splat(1e6)];
    let geometry = Geometry::mesh(&vertices, &[[0, 1, 2]]).expect("a face");
    assert_eq!(geometry.local_bounds().max, DVec3::new(1.0, 1.0, 0.0));
    assert!(geometry.reach() <= 1.0 + 1e-15);
}

/// Few vertices, so that edges have many triangles and some triangles are there twice: what is told of neighbours is what looking
/// at all pairs tells.
#[test]
fn neighbours_are_those_that_share_two_vertices() {
    let mut state = 0x2545_F491_u64;
    let mut below = |bound: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % bound
    };
    let mut duplicates = 0;
    for round in 0..40 {
        let vertices: Vec<DVec3> = (0..12).map(|k| DVec3::new(k as f64, (k * k) as f64, (k * k * k) as f64)).collect();
        let mut sent = Vec::new();
        while sent.len() < 6 + round {
            let triangle = [(); 3].map(|()| below(12) as u32);
            if triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0] {
                sent.push(triangle);
            }
        }
        let geometry = Geometry::mesh(&vertices, &sent).expect("triangles with an area");
        let mesh = mesh_of(&geometry);
        let bytes = geometry.memory_bytes();
        let report = mesh.report();
        assert_eq!(geometry.memory_bytes(), bytes, "counting keeps nothing");
        let triangles = mesh.triangles();
        let ends = |(triangle, k): (usize, usize)| {
            let (a, b) = (triangles[triangle][k], triangles[triangle][(k + 1) % 3]);
            (a.min(b), a.max(b))
        };
        let sides: Vec<(usize, usize)> = (0..triangles.len()).flat_map(|at| (0..3).map(move |k| (at, k))).collect();
        let (mut open, mut crowded) = (0.0, 0.0);
        let mut is_closed = true;
        for &side in &sides {
            let others: Vec<_> = sides.iter().copied().filter(|&other| ends(other) == ends(side)).collect();
            let found: Vec<_> = mesh.adjacency().across(side.0, side.1).collect();
            let expected: Vec<_> = others.iter().copied().filter(|&other| other != side).collect();
            assert_eq!(found, expected, "rising");
            open += f64::from(others.len() == 1);
            crowded += f64::from(others.len() > 2) / others.len() as f64;
            let ups = others.iter().filter(|&&(at, k)| triangles[at][k] < triangles[at][(k + 1) % 3]).count();
            is_closed &= 2 * ups == others.len();
        }
        let sets = triangles.iter().map(|triangle| {
            let mut set = *triangle;
            set.sort_unstable();
            set
        });
        let different: std::collections::BTreeSet<[u32; 3]> = sets.collect();
        assert_eq!(report.open_edges, open as usize);
        assert_eq!(report.non_manifold_edges, f64::round(crowded) as usize);
        assert_eq!(report.duplicates, triangles.len() - different.len());
        assert_eq!(mesh.is_closed(), is_closed);
        duplicates += report.duplicates;
    }
    assert!(duplicates > 20, "{duplicates}");
}
