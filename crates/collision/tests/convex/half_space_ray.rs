//! Rays against half spaces.

use crate::random::Noise;
use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Pose,
    narrow::{self, Placed, Ray, RayTouches},
    shape::Geometry,
};

fn cast(ray: &Ray, normal: DVec3, offset: f64, pose: Pose) -> RayTouches {
    let geometry = Geometry::half_space(normal, offset).expect("a half space");
    narrow::raycast(ray, Placed { geometry: &geometry, pose }, &Accuracy::default(), &mut Work::default())
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, min_distance: 0.0, max_distance: 4e12, hollow: false, faces: narrow::Faces::Both }
}

#[test]
fn a_ray_meets_the_plane_exactly_from_far_away() {
    for height in [1.0, 1e6, 1e12] {
        let down = ray(DVec3::new(5e11, height, -3.0), DVec3::new(0.0, -2e-7, 0.0));
        let touch = cast(&down, DVec3::Y, 0.25, Pose::at(DVec3::Y * 0.5)).certain.expect("a hit");
        assert!((touch.distance - (height - 0.75)).abs() <= 1e-15 * height, "{touch:?}");
        assert!(touch.certificate.bound.width() <= 1e-14 * height && touch.certificate.bound.contains(height - 0.75));
        assert_eq!((touch.point.y, touch.normal, touch.inside), (0.75, Some(DVec3::Y), false));
    }
}

#[test]
fn full_and_hollow_half_spaces_are_seen_from_inside() {
    let up = ray(DVec3::Y * -3.0, DVec3::Y);
    let full = cast(&up, DVec3::Y, 0.0, Pose::IDENTITY).certain.expect("it begins inside");
    assert_eq!((full.distance, full.inside, full.normal), (0.0, true, None));
    let hollow = cast(&Ray { hollow: true, ..up }, DVec3::Y, 0.0, Pose::IDENTITY).certain.expect("the wall");
    assert_eq!((hollow.distance, hollow.inside, hollow.normal), (3.0, false, Some(-DVec3::Y)));
    let deeper = Ray { hollow: true, max_distance: f64::INFINITY, ..ray(DVec3::Y * -3.0, -DVec3::Y) };
    let none = cast(&deeper, DVec3::Y, 0.0, Pose::IDENTITY);
    assert!(none.certain.is_none() && none.undecided.is_none(), "{none:?}");
    let late = cast(&Ray { min_distance: 5.0, ..ray(DVec3::Y * 3.0, -DVec3::Y) }, DVec3::Y, 0.0, Pose::IDENTITY);
    assert!(late.certain.is_some_and(|touch| touch.distance == 5.0 && touch.inside));
}

#[test]
fn a_ray_in_the_plane_is_inside_and_one_just_above_is_not() {
    let along = |height: f64| cast(&ray(DVec3::Y * height, DVec3::X), DVec3::Y, 0.1, Pose::IDENTITY);
    assert!(along(0.1).certain.is_some_and(|touch| touch.distance == 0.0 && touch.inside));
    let above = along(0.1f64.next_up());
    assert!(above.certain.is_none() && above.undecided.is_none(), "{above:?}");
}

#[test]
fn rays_agree_with_the_height_of_their_points() {
    let mut noise = Noise(21);
    let mut hits = 0;
    for round in 0..3000 {
        let far = [1.0, 1e3, 1e9][round % 3];
        let pose = Pose::new(noise.vector() * far, noise.rotation());
        let (normal, offset) = (noise.vector(), noise.signed() * far);
        let ray = Ray { max_distance: 3.0 * far, ..ray(noise.vector() * far, noise.vector()) };
        let touches = cast(&ray, normal, offset, pose);
        assert!(touches.undecided.is_none(), "{touches:?}");
        let unit = (pose.matrix() * normal).normalize();
        let height = |at: f64| unit.dot(ray.origin + ray.direction.normalize() * at - pose.position) - offset;
        let Some(touch) = touches.certain else {
            assert!(height(0.0) > -1e-12 * far && height(3.0 * far) > -1e-12 * far);
            continue;
        };
        hits += 1;
        assert_eq!(touch.certificate.verdict, Verdict::Hit);
        assert!(touch.certificate.bound.contains(touch.distance));
        if touch.inside {
            assert!(touch.distance == 0.0 && height(0.0) <= 1e-12 * far);
        } else {
            assert!(height(touch.distance).abs() < 1e-11 * far, "{touch:?}");
            assert!(touch.normal.is_some_and(|normal| normal.dot(ray.direction) < 0.0));
        }
    }
    assert!((1000..2400).contains(&hits), "{hits} of 3000");
}
