//! Depths along whole circles of directions that are equally short ways out, or nearly so: the truth is known from geometry.

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Stop, Work},
    math::Pose,
    narrow::{self, Depth},
    shape::Geometry,
};

use crate::random::{Body, Noise};

fn depth(a: &Body, b: &Body) -> Depth {
    let depth = narrow::depth(a.placed(), b.placed(), 1e9, &Accuracy::of(Tier::Exact), &mut Work::default());
    depth.expect("no limit")
}

/// The interval holds the truth, is narrow, took a small part of the budget, and its points are as far apart as it says.
fn assert_depth(a: &Body, b: &Body, truth: f64, name: &str) {
    let found = depth(a, b);
    let bound = found.certificate.bound;
    assert!(bound.lower <= truth && truth <= bound.upper, "{name}: {truth:e} is not in {found:?}");
    assert!(bound.width() <= 1e-12, "{name}: {found:?}");
    assert!(found.certificate.stop == Stop::Converged && found.certificate.iterations < 2048, "{name}: {found:?}");
    let apart = (found.point_on_a - found.point_on_b).dot(found.normal_b_to_a);
    assert!((apart + found.depth).abs() <= 1e-9, "{name}: points {apart:e} apart in {found:?}");
}

/// A corner on the axis of a cylinder: all directions across the axis that lead away from the rest of the hull are as short.
#[test]
fn a_corner_on_the_axis_is_as_deep_as_the_radius() {
    let noise = &mut Noise(41);
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let hull = Body { geometry: Geometry::hull(&corners).expect("corners"), pose: Pose::IDENTITY };
    let mut count = 0;
    for _ in 0..60 {
        let rotation = noise.rotation();
        let axis = rotation.normalize() * DVec3::Y;
        // Only an axis of mixed signs has a direction across it that no corner lies ahead of.
        if axis.cmpgt(DVec3::ZERO).all() || axis.cmplt(DVec3::ZERO).all() {
            continue;
        }
        let cylinder = Geometry::cylinder(0.5, 0.3).expect("sizes");
        assert_depth(&Body { geometry: cylinder, pose: Pose::new(DVec3::ZERO, rotation) }, &hull, 0.3, "cylinder");
        count += 1;
    }
    assert!(count > 30, "only {count} axes have a way out");
}

/// A capsule in the middle of an ellipsoid of revolution, turned about the axis they share by rounded numbers.
#[test]
fn a_capsule_on_the_axis_of_an_ellipsoid_is_as_deep_as_both_are_wide() {
    let noise = &mut Noise(42);
    for _ in 0..60 {
        let (radius, length) = (0.2 + 0.3 * noise.signed().abs(), 0.6 + 0.3 * noise.signed().abs());
        let rotation = noise.rotation().normalize();
        let spun = rotation * DQuat::from_xyzw(0.0, noise.signed(), 0.0, 1.0).normalize();
        let ellipsoid = Geometry::ellipsoid(DVec3::new(radius, length, radius)).expect("radii");
        let capsule = Geometry::capsule(0.25, 0.125).expect("sizes");
        let a = Body { geometry: ellipsoid, pose: Pose::new(DVec3::ZERO, rotation) };
        let b = Body { geometry: capsule, pose: Pose::new(DVec3::ZERO, spun) };
        assert_depth(&a, &b, radius + 0.125, "capsule");
    }
}

/// Two ellipsoids on the same axes: the width is `|(rᵢnᵢ)| + |(sᵢnᵢ)| ≥ |((rᵢ + sᵢ)nᵢ)|`, least along an axis, and nearly as small
/// all round where two of the sums nearly agree.
#[test]
fn ellipsoids_about_the_same_axes_are_as_deep_as_their_least_sum() {
    let noise = &mut Noise(43);
    for number in 0..60 {
        let spread = [0.3, 1e-2, 1e-4, 1e-7][number % 4];
        let mut radii = || DVec3::new(noise.signed(), noise.signed(), noise.signed()) * (0.1 * spread) + 0.25;
        let (r, s) = (radii(), radii());
        let rotation = noise.rotation();
        let body = |radii| Body {
            geometry: Geometry::ellipsoid(radii).expect("radii"),
            pose: Pose::new(DVec3::ZERO, rotation),
        };
        assert_depth(&body(r), &body(s), (r + s).min_element(), "ellipsoids");
    }
}
