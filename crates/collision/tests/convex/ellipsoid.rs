//! Points and balls beside and inside ellipsoids.

use crate::random::{Body, Noise};
use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Method, Work},
    math::Pose,
    narrow::{self, Depth},
    shape::Geometry,
};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

fn depth(a: &Body, b: &Body) -> Depth {
    let depth = narrow::depth(a.placed(), b.placed(), 1e9, &EXACT, &mut Work::default());
    depth.expect("no limit")
}

fn ellipsoid(radii: DVec3, pose: Pose) -> Body {
    Body { geometry: Geometry::ellipsoid(radii).expect("sizes"), pose }
}

fn point(position: DVec3) -> Body {
    Body { geometry: Geometry::point(), pose: Pose::at(position) }
}

fn ball(radius: f64, position: DVec3) -> Body {
    Body { geometry: Geometry::sphere(radius).expect("a size"), pose: Pose::at(position) }
}

/// The depth is this to within `slack`, and is known that well.
fn assert_depth(found: &Depth, truth: f64, slack: f64) {
    let Bound { lower, upper } = found.certificate.bound;
    assert!(lower - slack <= truth && truth <= upper + slack, "{truth:e}: {found:?}");
    assert!(upper - lower <= 1e-12 + slack, "{found:?}");
    assert_eq!(found.certificate.method, Method::ClosedForm, "{found:?}");
}

/// Radii of any proportions up to 1e6, in any order, some of them equal.
fn radii(noise: &mut Noise, round: usize) -> DVec3 {
    let mut radius = || 10f64.powf(noise.between(-6.0, 0.0));
    let radii = DVec3::new(radius(), radius(), radius());
    match round % 8 {
        0 => DVec3::splat(radii.x),
        1 => DVec3::new(radii.x, radii.y, radii.x),
        2 => DVec3::new(radii.x, radii.x, radii.y),
        _ => radii,
    }
}

#[test]
fn a_point_on_a_normal_is_as_far_as_it_was_moved() {
    let mut noise = Noise(51);
    for round in 0..6000 {
        let radii = radii(&mut noise, round);
        let normal = (noise.vector() * if round % 3 == 0 { radii.recip() } else { DVec3::ONE }).normalize();
        let at_surface = radii * (radii * normal).normalize();
        // Up to where normals of the surface first meet: r0²·|q/r²|.
        let most = radii.min_element().powi(2) * (at_surface / (radii * radii)).length();
        let part = noise.signed();
        let moved = if part < 0.0 { part * most } else { part * 10f64.powf(noise.between(-9.0, 1.0)) };
        let found = depth(&ellipsoid(radii, Pose::IDENTITY), &point(at_surface + normal * moved));
        assert_depth(&found, -moved, 1e-15 * (1.0 + moved.abs()));
        let toward = -found.normal_b_to_a;
        let on_surface = (found.point_on_a / radii).length();
        assert!((on_surface - 1.0).abs() < 1e-9, "{on_surface}");
        let along = (found.point_on_b - found.point_on_a).dot(toward);
        assert!((along - moved).abs() < 1e-13 * (1.0 + moved.abs()), "{along:e} instead of {moved:e}: {found:?}");
    }
}

#[test]
fn the_middle_is_as_deep_as_the_least_radius() {
    let orders = [DVec3::new(3.0, 2.0, 1.0), DVec3::new(1.0, 3.0, 2.0), DVec3::new(2.0, 1.0, 3.0)];
    for radii in orders.into_iter().chain([DVec3::new(1.0, 1.0, 2.0), DVec3::new(2.0, 1.0, 1.0)]) {
        let form = ellipsoid(radii, Pose::new(DVec3::ONE, DQuat::from_xyzw(0.1, 0.7, -0.3, 0.5)));
        let found = depth(&form, &point(DVec3::ONE));
        assert_depth(&found, 1.0, 0.0);
        assert!(((found.point_on_a - DVec3::ONE).length() - 1.0).abs() < 1e-14, "{found:?}");
        assert_depth(&depth(&ball(0.5, DVec3::ONE), &form), 1.5, 0.0);
    }
    let needle = ellipsoid(DVec3::new(1.0, 1e-6, 1e-6), Pose::IDENTITY);
    assert_depth(&depth(&needle, &point(DVec3::ZERO)), 1e-6, 0.0);
}

#[test]
fn points_on_the_axes_know_which_way_is_out() {
    let form = ellipsoid(DVec3::new(4.0, 2.0, 1.0), Pose::IDENTITY);
    // Near the end of the longest axis the end is nearest, from r − r0²/r inwards a ring of least width is.
    assert_depth(&depth(&form, &point(DVec3::X * 3.875)), 0.125, 0.0);
    let x = 1.5;
    let aside = (1.0 - (x * 4.0 / 15.0f64).powi(2)).sqrt();
    let along = 16.0 * x / 15.0 - x;
    assert_depth(&depth(&form, &point(DVec3::X * x)), along.hypot(aside), 1e-15);
    assert_depth(&depth(&form, &point(DVec3::X * -6.0)), -2.0, 0.0);
    assert_depth(&depth(&form, &point(DVec3::Z * -0.75)), 0.25, 0.0);
    assert_depth(&depth(&form, &point(DVec3::Z * 1.5)), -0.5, 0.0);
    assert_depth(&depth(&ball(0.75, DVec3::Z * 1.5), &form), 0.25, 0.0);
}

#[test]
fn a_point_all_but_on_an_axis() {
    let form = ellipsoid(DVec3::new(2.0, 1.0, 0.25), Pose::IDENTITY);
    let on_axis = depth(&form, &point(DVec3::new(0.5, 0.25, 0.0))).depth;
    for exponent in 3..320 {
        let off = 10f64.powi(-exponent);
        let found = depth(&form, &point(DVec3::new(0.5, 0.25, off)));
        assert_depth(&found, on_axis, off);
        assert!(found.normal_b_to_a.z < 0.0, "{off:e}: {found:?}");
    }
}

#[test]
fn an_ellipsoid_of_equal_radii_is_a_ball() {
    let mut noise = Noise(52);
    for _ in 0..500 {
        let (radius, place) = (noise.between(0.1, 1.0), noise.vector());
        let form = ellipsoid(DVec3::splat(radius), Pose::new(DVec3::ZERO, noise.rotation()));
        assert_depth(&depth(&form, &point(place)), radius - place.length(), 1e-15);
        assert_depth(&depth(&ball(0.25, place), &form), radius + 0.25 - place.length(), 1e-15);
    }
}

#[test]
fn swapping_and_scaling_swaps_and_scales_the_answer_bit_by_bit() {
    let mut noise = Noise(53);
    for round in 0..400 {
        let a = ellipsoid(radii(&mut noise, round), Pose::new(noise.vector() * 0.2, noise.rotation()));
        let b = ball(0.1, noise.vector() * 0.6);
        let (there, back) = (depth(&a, &b), depth(&b, &a));
        assert_eq!((there.depth, there.certificate), (back.depth, back.certificate));
        assert_eq!((there.point_on_a, there.point_on_b), (back.point_on_b, back.point_on_a));
        let scale = 2f64.powi(round as i32 % 7 * 2);
        let scaled = |body: &Body| Body {
            geometry: body.geometry.clone().scaled(scale).expect("within limits"),
            pose: Pose::new(body.pose.position * scale, body.pose.rotation),
        };
        let large = depth(&scaled(&a), &scaled(&b));
        assert_eq!((large.depth, large.point_on_a), (there.depth * scale, there.point_on_a * scale));
        assert_eq!(large.normal_b_to_a, there.normal_b_to_a);
    }
}
