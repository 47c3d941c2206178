//! What other engines get wrong about rays ("Failures of the peers" of the design), each as a test that we pass.

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::Work,
    math::Pose,
    narrow::{Faces, Placed, Ray, RayTouches, raycast},
    shape::{Geometry, GeometryError},
};

fn cast_with(accuracy: &Accuracy, geometry: &Geometry, pose: Pose, origin: DVec3, direction: DVec3) -> RayTouches {
    let ray = Ray { origin, direction, min_distance: 0.0, max_distance: 4e12, hollow: false, faces: Faces::Both };
    raycast(&ray, Placed { geometry, pose }, accuracy, &mut Work::default())
}

fn cast(geometry: &Geometry, origin: DVec3, direction: DVec3) -> RayTouches {
    cast_with(&Accuracy::default(), geometry, Pose::IDENTITY, origin, direction)
}

/// Surely hit at `expected`, as exactly as the way there allows, and nothing of it left open.
#[track_caller]
fn assert_hit_at(touches: RayTouches, expected: f64, scale: f64) {
    assert!(touches.undecided.is_none(), "{touches:?}");
    let touch = touches.certain.unwrap_or_else(|| panic!("no hit at {expected}"));
    assert!((touch.distance - expected).abs() <= 4e-16 * scale, "{} is not {expected}", touch.distance);
    let bound = touch.certificate.bound;
    assert!(bound.contains(expected) && bound.width() <= 2e-13 * scale, "{bound:?} for {expected}");
}

/// All forms with a wall at x = −1, met head on.
fn forms() -> Vec<(&'static str, Geometry)> {
    let corners = [-1.0, 1.0].map(|x| [-1.0, 1.0].map(|y| [-1.0, 1.0].map(|z| DVec3::new(x, y, z))));
    let corners = corners.as_flattened().as_flattened();
    let wall = [DVec3::new(-1.0, -3.0, -3.0), DVec3::new(-1.0, 5.0, -3.0), DVec3::new(-1.0, 0.0, 6.0)];
    let half = DVec3::splat(0.5);
    let forms = [
        ("ball", Geometry::sphere(1.0)),
        ("capsule", Geometry::capsule(2.0, 1.0)),
        ("box", Geometry::cuboid(DVec3::ONE)),
        ("hull", Geometry::hull(corners)),
        ("cylinder", Geometry::cylinder(3.0, 1.0)),
        ("ellipsoid", Geometry::ellipsoid(DVec3::new(1.0, 2.0, 0.5))),
        ("rounded box", Geometry::cuboid(half).and_then(|form| form.rounded(0.5))),
        ("rounded cylinder", Geometry::cylinder(0.5, 0.5).and_then(|form| form.rounded(0.5))),
        ("mesh", Geometry::mesh(&wall, &[[0, 1, 2]])),
    ];
    forms.map(|(name, form): (_, Result<Geometry, GeometryError>)| (name, form.expect(name))).into()
}

/// parry, f32: a ray at a unit ball from 10 km is 1 m off.
#[test]
fn a_ray_from_far_away_is_exact() {
    for (name, form) in forms() {
        for way in [1.0, 1e4, 1e6, 1e9] {
            let touches = cast(&form, DVec3::X * -(1.0 + way), DVec3::X * 0.3);
            eprintln!("{name} from {way} m");
            assert_hit_at(touches, way, way + 8.0);
        }
    }
}

/// The same with everything far from the origin of the world, where an f32 has steps of 64 m.
#[test]
fn a_ray_far_out_in_the_world_is_exact() {
    let out = DVec3::new(1e9, -3e8, 7e8);
    for (name, form) in forms() {
        let accuracy = Accuracy::default();
        let touches = cast_with(&accuracy, &form, Pose::at(out), out - DVec3::X * 5.0, DVec3::X);
        eprintln!("{name}");
        assert_hit_at(touches, 4.0, 16.0);
    }
}

/// parry, f32: a ball cast down on a box of 1 to 5 km is up to 0.49 m late; a moving ball is a ray at the rounded box.
#[test]
fn a_ray_at_a_rounded_slab_of_kilometres_is_exact() {
    for half in [1e3, 2e3, 5e3] {
        let slab = Geometry::cuboid(DVec3::new(half, 1.0, half)).and_then(|slab| slab.rounded(0.5)).expect("a slab");
        for x in [0.0, 0.3, 0.9] {
            let touches = cast(&slab, DVec3::new(x * half, 50.0, -0.7 * half), -DVec3::Y);
            assert_hit_at(touches, 48.5, 4.0 * half);
        }
    }
}

/// coal: boxes of 1e-7 m are −inf apart. Box3D: hulls of 1e-5 m are none, nor are slabs of 1 µm.
#[test]
fn small_and_thin_bodies_are_hit_where_they_are() {
    for half in [1e-5, 1e-7, 1e-9] {
        let corners: Vec<DVec3> = (0..8_u32)
            .map(|bits| DVec3::new(f64::from(bits & 1), f64::from(bits >> 1 & 1), f64::from(bits >> 2)) - 0.5)
            .map(|corner| corner * 2.0 * half)
            .collect();
        let cuboid = Geometry::cuboid(DVec3::splat(half)).expect("a box");
        let hull = Geometry::hull(&corners).expect("a hull");
        let cone = Geometry::cone(half, half).expect("a cone");
        let origin = DVec3::new(0.25 * half, -3.0 * half, 0.125 * half);
        for form in [&cuboid, &hull, &cone] {
            assert_hit_at(cast(form, origin, DVec3::Y), 2.0 * half, 8.0 * half);
        }
    }
    let slab = DVec3::new(0.5, 0.5e-6, 0.5);
    let corners: Vec<DVec3> = (0..8_u32)
        .map(|bits| DVec3::new(f64::from(bits & 1), f64::from(bits >> 1 & 1), f64::from(bits >> 2)) * 2.0 - 1.0)
        .map(|corner| corner * slab)
        .collect();
    for form in [Geometry::cuboid(slab), Geometry::hull(&corners), Geometry::cylinder(0.5e-6, 0.5)] {
        let touches = cast(&form.expect("a slab"), DVec3::new(0.1, -1.0, 0.2), DVec3::Y);
        assert_hit_at(touches, 1.0 - 0.5e-6, 4.0);
    }
}

/// parry: what a limit of iterations leaves open is "no intersection".
#[test]
fn a_spent_budget_is_no_miss() {
    let accuracy = Accuracy { budget: 1, ..Accuracy::default() };
    let points: Vec<DVec3> = (0..40)
        .map(|k| f64::from(k) * 0.7)
        .map(|angle| DVec3::new(angle.cos(), (1.7 * angle).sin(), (angle * 0.3).sin()))
        .collect();
    let hull = Geometry::hull(&points).and_then(|form| form.rounded(0.1)).expect("a hull");
    let cone = Geometry::cone(1.0, 1.0).and_then(|form| form.rounded(0.1)).expect("a cone");
    for form in [hull, cone] {
        for k in 0..50 {
            let angle = f64::from(k);
            let origin = DVec3::new(angle.cos(), 0.4 * angle.sin(), angle.sin()) * 9.0;
            let touches = cast_with(&accuracy, &form, Pose::IDENTITY, origin, -origin);
            let touch = touches.certain.or(touches.undecided).expect("it goes through the middle");
            let exact = cast(&form, origin, -origin).certain.expect("it goes through the middle");
            assert!(touch.certificate.bound.contains(exact.distance), "{touch:?}, {exact:?}");
        }
    }
}

/// Box3D: when the stack of a traversal is full, children are dropped without a word.
#[test]
fn no_triangle_of_a_crowd_is_dropped() {
    let count = 3_000_u32;
    // All boxes hold one point, so that no tree can tell them apart; one of them is met first.
    let vertices: Vec<DVec3> = (0..count)
        .flat_map(|k| {
            let z = f64::from((k * 1_103) % count) * 1e-3;
            [DVec3::new(-9.0, -9.0, z), DVec3::new(9.0, -9.0, z), DVec3::new(0.0, 9.0, z)]
        })
        .collect();
    let triangles: Vec<[u32; 3]> = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mesh = Geometry::mesh(&vertices, &triangles).expect("a mesh");
    for k in (0..count).step_by(97) {
        let z = vertices[3 * k as usize].z;
        let touches = cast(&mesh, DVec3::new(0.1, 0.2, z + 4e-4), -DVec3::Z);
        assert_hit_at(touches, z + 4e-4 - z, 20.0);
        assert_eq!(touches.certain.and_then(|touch| touch.feature.face), Some(k));
    }
}

/// coal: concentric ellipsoids are 5.6 % off; a ray from the middle of one leaves it at its half axes.
#[test]
fn a_ray_from_the_middle_of_an_ellipsoid_leaves_at_its_half_axes() {
    let radii = DVec3::new(1e-3, 2.0, 1e3);
    let ellipsoid = Geometry::ellipsoid(radii).expect("an ellipsoid");
    for (axis, way) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
        let ray = Ray {
            origin: DVec3::ZERO,
            direction: way,
            min_distance: 0.0,
            max_distance: 4e12,
            hollow: true,
            faces: Faces::Both,
        };
        let target = Placed { geometry: &ellipsoid, pose: Pose::IDENTITY };
        let touches = raycast(&ray, target, &Accuracy::default(), &mut Work::default());
        assert_hit_at(touches, radii[axis], 1e3);
    }
}
