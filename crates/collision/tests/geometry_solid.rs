//! Closed meshes: what encloses a volume, how large that is, and which points lie in it.

mod cubes;

use collision::{
    DVec3,
    answer::Work,
    shape::{Containment, Form, Geometry, Mesh},
};
use cubes::{Cubes, Noise, SIZE};

fn mesh_of(geometry: &Geometry) -> &Mesh {
    let Form::Mesh(mesh) = geometry.form() else { panic!("a mesh") };
    mesh
}

/// Rays from points of a grid run through corners and along edges and faces, and many cubes meet in an edge or a corner only.
#[test]
fn points_of_a_grid_lie_where_the_cubes_say() {
    let mut noise = Noise(0x9E37_79B9_7F4A_7C15);
    let mut counts = [0; 3];
    for _ in 0..20 {
        let cubes = Cubes::random(&mut noise);
        let (vertices, triangles) = cubes.surface();
        let geometry = Geometry::mesh(&vertices, &triangles).expect("a mesh");
        let turned: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let inside_out = Geometry::mesh(&vertices, &turned).expect("a mesh");
        let (mesh, inside_out) = (mesh_of(&geometry), mesh_of(&inside_out));
        assert!(mesh.is_closed() && inside_out.is_closed());
        let volume = cubes.volume() as f64;
        assert!((mesh.volume().expect("closed") - volume).abs() < 1e-12 * volume);
        assert!((inside_out.volume().expect("closed") + volume).abs() < 1e-12 * volume);
        for _ in 0..500 {
            let quarters = [0; 3].map(|_| noise.below(4 * SIZE as u64 + 5) as i64 - 2);
            let point = DVec3::from_array(quarters.map(|at| at as f64 / 4.0));
            let expected = cubes.side(quarters);
            assert_eq!(mesh.contains(point, &mut Work::default()), expected, "{point}");
            assert_eq!(inside_out.contains(point, &mut Work::default()), expected, "{point}");
            counts[expected as usize] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 1000), "{counts:?}");
}

/// Of a surface whose corners are no round numbers, points a rounding off a corner along the diagonal are told apart.
#[test]
fn a_rounding_off_the_surface_is_told() {
    let cubes = Cubes(vec![true; (SIZE * SIZE * SIZE) as usize]);
    let (vertices, triangles) = cubes.surface();
    let vertices: Vec<DVec3> = vertices.iter().map(|&vertex| vertex / 3.0 + 1.0 / 7.0).collect();
    let geometry = Geometry::mesh(&vertices, &triangles).expect("a mesh");
    let mesh = mesh_of(&geometry);
    let (low, high) = (vertices[0].min_element(), vertices.iter().fold(0.0, |most: f64, v| most.max(v.max_element())));
    let side = |at: f64| mesh.contains(DVec3::splat(at), &mut Work::default());
    assert_eq!([side(low), side(high)], [Containment::Undecided; 2]);
    assert_eq!([side(low.next_up()), side(high.next_down())], [Containment::Inside; 2]);
    assert_eq!([side(low.next_down()), side(high.next_up())], [Containment::Outside; 2]);
}

#[test]
fn what_is_open_or_faces_both_ways_encloses_nothing() {
    let mut noise = Noise(77);
    let (vertices, triangles) = Cubes::random(&mut noise).surface();
    let open = Geometry::mesh(&vertices, &triangles[1..]).expect("a mesh");
    let mut turned = triangles;
    turned[5].swap(0, 1);
    let turned = Geometry::mesh(&vertices, &turned).expect("a mesh");
    for geometry in [open, turned] {
        let mesh = mesh_of(&geometry);
        assert!(!mesh.is_closed());
        assert_eq!(mesh.volume(), None);
        assert_eq!(mesh.contains(DVec3::splat(0.3), &mut Work::default()), Containment::Undecided);
    }
}
