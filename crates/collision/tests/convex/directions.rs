//! Depths along whole circles of directions that are equally short ways out, or nearly so: the truth is known from geometry.

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Stop, Work},
    math::Pose,
    narrow::{self, Depth},
    shape::{Geometry, GeometryError},
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

/// A stick, a plate or a corner that dips into an ellipsoid by less than any radius of its curvature: the ball about the lowest
/// point closes all ways out but the one it came by.
#[test]
fn what_dips_into_a_leaf_is_as_deep_as_its_lowest_point() {
    let noise = &mut Noise(44);
    for number in 0..400 {
        let radii = DVec3::from_array([1.0; 3].map(|size: f64| size * 10f64.powf(noise.between(-5.0, -0.5))));
        let along = noise.vector().normalize();
        let (lowest, outward) = (radii * along, (along / radii).normalize());
        let depth = noise.between(0.01, 0.9) * radii.min_element().powi(2) / radii.max_element();
        let across = noise.vector().cross(outward).normalize();
        let half = DVec3::new(noise.between(0.1, 1.0), 0.0, noise.between(0.1, 1.0));
        // Its y along the normal, so that it lies across that.
        let lying = DQuat::from_rotation_arc(DVec3::Y, outward);
        let leaning = noise.rotation().normalize();
        let corner = (leaning.inverse() * -outward).signum() * DVec3::new(half.x, 0.5, half.z);
        let (geometry, rotation, tip) = match number % 3 {
            0 => (Geometry::capsule(0.5, 0.0), DQuat::from_rotation_arc(DVec3::Y, across), DVec3::ZERO),
            1 => (Geometry::cuboid(half), lying, DVec3::ZERO),
            _ => (Geometry::cuboid(corner.abs()), leaning, corner),
        };
        let position = lowest - outward * depth - rotation * tip;
        let leaf = Body { geometry: Geometry::ellipsoid(radii).expect("radii"), pose: Pose::IDENTITY };
        let other = Body { geometry: geometry.expect("sizes"), pose: Pose::new(position, rotation) };
        let found = self::depth(&leaf, &other);
        let bound = found.certificate.bound;
        let is_held = bound.lower - 1e-15 <= depth && depth <= bound.upper + 1e-15;
        let is_narrow = bound.width() <= 1e-12 && found.certificate.stop == Stop::Converged;
        assert!(is_held && is_narrow, "{number}: {depth:e} {found:?}, radii {radii}");
    }
}

/// Round forms moved into each other by little along the normal of their gap: the question whether they overlap, which ends as soon
/// as it knows, claims no depth that is not there.
#[test]
fn an_overlap_by_little_is_told_as_no_more() {
    let noise = &mut Noise(45);
    let exact = Accuracy::of(Tier::Exact);
    let sizes = |noise: &mut Noise| [noise.between(0.1, 1.0), noise.between(0.1, 1.0), noise.between(0.1, 1.0)];
    for number in 0..400 {
        let ([p, q, _], radii) = (sizes(noise), DVec3::from_array(sizes(noise)));
        let form = |kind: usize| match kind % 4 {
            0 => Geometry::cuboid(radii),
            1 => Geometry::cone(p, q),
            2 => Geometry::cylinder(q, p),
            _ => Geometry::ellipsoid(radii),
        };
        let mut a = body(form(number), [0.0; 3], noise.rotation().to_array());
        let b = body(form(number / 4 + 1), (noise.vector().normalize() * 4.0).to_array(), noise.rotation().to_array());
        let gap = narrow::distance(a.placed(), b.placed(), 9.0, &exact, &mut Work::default()).expect("near");
        let into = 10f64.powf(noise.between(-11.0, -5.0));
        a.pose.position -= gap.normal_b_to_a.expect("apart") * (gap.distance + into);
        let overlap = narrow::overlap(a.placed(), b.placed(), &exact, &mut Work::default());
        let found = self::depth(&a, &b).certificate.bound;
        let is_told = overlap.bound.lower <= -found.lower && overlap.bound.upper >= -found.upper;
        assert!(is_told && found.upper <= into + 1e-12, "{number}: {into:e} {overlap:?}, depth {found:?}");
    }
}

fn body(geometry: Result<Geometry, GeometryError>, position: [f64; 3], rotation: [f64; 4]) -> Body {
    let pose = Pose::new(DVec3::from_array(position), DQuat::from_array(rotation));
    Body { geometry: geometry.expect("a form"), pose }
}

/// A stick through a leaf of 1e-5 of its length, for which no search over directions ends: the oracle tells the depth to three
/// digits.
#[test]
fn a_depth_that_only_a_ball_proves() {
    let leaf = Geometry::ellipsoid(DVec3::new(0.10068127620871838, 2.587880375411494e-6, 0.0005575982277538124));
    let turn = [0.3673345756292249, -0.19671092927862305, -0.38322416873128307, -0.8243235750297664];
    let a = body(leaf, [0.9657019853155089, -0.18179975412143923, 0.35028537260524867], turn);
    let turn = [-0.7687220876210008, 0.3893692417956749, -0.3955297485467464, 0.3178272542775701];
    let stick = Geometry::capsule(0.186806896815091, 0.0);
    let b = body(stick, [0.964133890076489, -0.22519207297278152, 0.1404790812761747], turn);
    assert_depth(&a, &b, 9.925e-12, "leaf and stick");
}

/// A depth that was known well enough was followed by a search for balls, of which the exact one had no need.
#[test]
fn asking_for_less_takes_no_more_steps() {
    let noise = &mut Noise(44);
    let mut fewer = 0;
    for number in 0..2000 {
        let size = |noise: &mut Noise| noise.between(0.1, 1.0);
        let round = match number % 3 {
            0 => Geometry::cone(size(noise), size(noise)),
            1 => Geometry::cylinder(size(noise), size(noise)),
            _ => Geometry::ellipsoid(DVec3::new(size(noise), size(noise), size(noise))),
        };
        let a = Body { geometry: round.expect("sizes"), pose: Pose::new(DVec3::ZERO, noise.rotation()) };
        let place = noise.vector() * 0.8;
        let b = Body { geometry: noise.convex(number / 3), pose: Pose::new(place, noise.rotation()) };
        let steps = |accuracy: Accuracy| {
            let depth = narrow::depth(a.placed(), b.placed(), 0.0, &accuracy, &mut Work::default());
            depth.map_or(0, |depth| depth.certificate.iterations)
        };
        let exact = Accuracy::of(Tier::Exact);
        let counts =
            [0.0, 1e-9, 1e-6, 1e-3, 0.1, 1.0].map(|max_error_relative| steps(Accuracy { max_error_relative, ..exact }));
        assert!(counts.is_sorted_by(|finer, coarser| finer >= coarser), "{number}: {counts:?} of {a:?} and {b:?}");
        fewer += usize::from(counts[0] > counts[4]);
    }
    assert!(fewer > 100, "vacuous: {fewer}");
}
