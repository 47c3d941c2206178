//! Rays that broke a law, found by the fuzz target for rays.

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::Work,
    math::Pose,
    narrow::{Faces, Placed, Ray, RayTouches, raycast},
    shape::Geometry,
};

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, min_distance: 0.0, max_distance: 4e12, hollow: false, faces: Faces::Both }
}

fn cast(ray: &Ray, geometry: &Geometry, pose: Pose) -> RayTouches {
    raycast(ray, Placed { geometry, pose }, &Accuracy::of(Tier::Exact), &mut Work::default())
}

/// The normal was 0.
#[test]
fn a_ray_through_a_point_sees_it_from_where_it_comes() {
    let point = Geometry::point();
    for (origin, direction) in [(DVec3::X * -64.0, DVec3::X * 3.0), (DVec3::ZERO, DVec3::new(0.0, -1.0, 0.0))] {
        for rotation in [DQuat::IDENTITY, DQuat::from_xyzw(0.1, -0.3, 0.2, 0.4)] {
            let touches = cast(&ray(origin, direction), &point, Pose::new(DVec3::ZERO, rotation));
            let touch = touches.certain.or(touches.undecided).expect("it is met or open");
            let normal = touch.normal.expect("not inside");
            let towards_asker = -normal.dot(direction.normalize());
            assert!((normal.length() - 1.0).abs() < 1e-15 && towards_asker > 0.99, "{touch:?}");
        }
    }
}

/// Distance and point were infinite and NaN.
#[test]
fn an_endless_ray_in_the_plane_of_a_polygon_stays_open_within_its_reach() {
    let polygon = Geometry::hull(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.7, 0.8, 0.0)]).expect("points");
    let pose = Pose::at(DVec3::new(0.0, 0.0, 1e9));
    let endless = Ray { max_distance: f64::INFINITY, ..ray(DVec3::new(0.0, 0.25, 1e9), DVec3::NEG_X) };
    for ray in [endless, Ray { direction: DVec3::new(1.0, 1e-17, 1e-17), ..endless }] {
        let touch = cast(&ray, &polygon, pose).undecided.expect("in its plane nothing is sure");
        assert!(touch.point.is_finite() && touch.certificate.bound.upper < 10.0, "{touch:?}");
    }
}

/// These panicked: bounds became no number where a speed had no square.
#[test]
fn a_ray_that_hardly_leaves_the_plane_of_a_half_space_is_answered() {
    for (normal, direction) in [
        (DVec3::Z, DVec3::new(-1e-288, -1e-288, -4e-323)),
        (DVec3::new(-1.0, 0.0, 3.944304526105059e-31), DVec3::new(0.0, 0.0, -1e-288)),
    ] {
        let space = Geometry::half_space(normal, -1e-7).expect("a normal");
        for origin in [DVec3::ZERO, DVec3::splat(-1e-7), DVec3::new(-1e12, -1e12, 0.0)] {
            let touches = cast(&ray(origin, direction), &space, Pose::IDENTITY);
            for touch in touches.certain.into_iter().chain(touches.undecided) {
                assert!(touch.certificate.bound.contains(touch.distance), "{touch:?}");
            }
        }
    }
}

/// Its error of 1e-330 was 0, so that rays were inside of it wherever they began.
#[test]
fn a_hull_too_small_for_its_own_rounding_is_not_hit_from_afar() {
    let corner = |i: i32| DVec3::from([i & 1, i >> 1 & 1, i >> 2].map(|bit| f64::from(2 * bit - 1) * 5e-322));
    let tiny = Geometry::hull(&(0..8).map(corner).collect::<Vec<_>>()).expect("points");
    let late = Ray { min_distance: 4e12, ..ray(DVec3::ONE, DVec3::X) };
    let touches = cast(&late, &tiny, Pose::at(DVec3::ONE));
    assert!(touches.certain.is_none(), "{touches:?}");
}

/// Found by fuzzing a world, which said so, beside the kernel, which touched where the ray would begin.
#[test]
fn a_ray_that_ends_before_it_begins_touches_nothing() {
    let ball = Geometry::sphere(1.0).expect("a ball");
    let ground = Geometry::half_space(DVec3::Y, 0.5).expect("a half space");
    let corners = [DVec3::new(-9.0, 0.0, -9.0), DVec3::new(9.0, 0.0, -9.0), DVec3::new(0.0, 0.0, 9.0)];
    let sheet = Geometry::mesh(&corners, &[[0, 1, 2]]).expect("a mesh");
    for geometry in [&ball, &ground, &sheet] {
        let down = ray(DVec3::Y * 0.25, -DVec3::Y);
        assert!(cast(&down, geometry, Pose::IDENTITY).certain.is_some());
        let none = cast(&Ray { min_distance: 0.3, max_distance: 0.29, ..down }, geometry, Pose::IDENTITY);
        assert!(none.certain.is_none() && none.undecided.is_none(), "{none:?}");
    }
}
