//! Extremes of the convex kernels: tiny and far shapes, degenerate ones. The failures of other engines stand in
//! `peers_failures.rs`.

use crate::random::{Body, Noise};
use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Verdict, Work},
    math::Pose,
    narrow::{self, Contact, InitialTouch, Motion},
    shape::Geometry,
};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

fn cube(half: f64, position: DVec3) -> Body {
    Body { geometry: Geometry::cuboid(DVec3::splat(half)).expect("a size"), pose: Pose::at(position) }
}

fn ball(radius: f64, position: DVec3) -> Body {
    Body { geometry: Geometry::sphere(radius).expect("a size"), pose: Pose::at(position) }
}

fn contact(a: &Body, b: &Body) -> Contact {
    let contacts = narrow::penetration(a.placed(), b.placed(), 0.0, &EXACT, &mut Work::default());
    contacts.expect("convex forms").into_iter().next().expect("they overlap")
}

fn distance(a: &Body, b: &Body) -> f64 {
    narrow::distance(a.placed(), b.placed(), f64::INFINITY, &EXACT, &mut Work::default()).expect("no limit").distance
}

#[test]
fn boxes_tilted_by_less_than_an_ulp_keep_their_depth() {
    for tilt in [1e-16, 1e-12, 1e-8] {
        let mut tilted = cube(0.5, DVec3::new(0.1, 0.76, 0.2));
        tilted.pose.rotation = DQuat::from_xyzw(tilt, tilt / 3.0, -tilt, 1.0);
        let depth = contact(&cube(0.5, DVec3::ZERO), &tilted).depth;
        assert!((depth - 0.24).abs() < 4.0 * tilt + 1e-15, "{depth}");
    }
}

#[test]
fn a_crumb_beside_a_mountain_is_decided() {
    let mountain = cube(1e6, DVec3::ZERO);
    let crumb = ball(1e-3, DVec3::new(1e6 + 2e-3, 12.0, -3.0));
    assert!((distance(&mountain, &crumb) - 1e-3).abs() < 1e-8);
    assert_eq!(narrow::overlap(mountain.placed(), crumb.placed(), &EXACT, &mut Work::default()).verdict, Verdict::Miss);
}

#[test]
fn far_from_the_origin_only_the_positions_own_rounding_is_lost() {
    let offset = DVec3::new(1e9, -1e9, 1e9);
    let (here, there) = (cube(0.5, offset), cube(0.5, offset + DVec3::new(1.25, 0.5, 0.0)));
    assert_eq!(distance(&here, &there), 0.25);
}

#[test]
fn flat_straight_and_point_like_forms_answer() {
    let plate = Body { geometry: Geometry::cuboid(DVec3::new(1.0, 0.0, 1.0)).expect("a plate"), pose: Pose::IDENTITY };
    let stick =
        Body { geometry: Geometry::capsule(1.0, 0.0).expect("a segment"), pose: Pose::at(DVec3::new(0.0, 1.5, 0.0)) };
    let point = Body { geometry: Geometry::point(), pose: Pose::at(DVec3::new(0.0, 0.25, 0.0)) };
    assert_eq!(distance(&plate, &stick), 0.5);
    assert_eq!(distance(&plate, &point), 0.25);
    assert_eq!(distance(&stick, &point), 0.25);
    let hull = |points: &[DVec3]| Body { geometry: Geometry::hull(points).expect("points"), pose: Pose::IDENTITY };
    let triangle = hull(&[DVec3::ZERO, DVec3::X, DVec3::Z]);
    assert_eq!(distance(&triangle, &stick.moved(DVec3::new(0.25, 0.0, 0.25))), 0.5);
    let crossing = contact(&triangle, &stick.moved(DVec3::new(0.25, -1.25, 0.25)));
    assert!(crossing.depth > 0.0 && crossing.certificate.verdict == Verdict::Hit, "{crossing:?}");
}

#[test]
fn no_answer_is_ever_nan_at_any_scale() {
    let mut noise = Noise(11);
    for round in 0..4000 {
        let scale = 10f64.powi(round % 13 - 6);
        let mut body = |kind: usize| Body {
            geometry: noise.convex(kind).scaled(scale).expect("within limits"),
            pose: Pose::new(noise.vector() * scale, noise.rotation()),
        };
        let (a, b) = (body(round as usize), body(round as usize / 4));
        let work = &mut Work::default();
        let separation = narrow::distance(a.placed(), b.placed(), f64::INFINITY, &EXACT, work).expect("no limit");
        assert!(separation.certificate.bound.contains(separation.distance));
        assert!(separation.point_on_a.is_finite() && separation.point_on_b.is_finite());
        for contact in narrow::penetration(a.placed(), b.placed(), scale, &EXACT, work).expect("convex forms") {
            assert!(contact.certificate.bound.contains(contact.depth), "{contact:?}");
            assert!((contact.normal_b_to_a.length() - 1.0).abs() < 1e-15);
            assert!(contact.points.iter().all(|point| point.point_on_a.is_finite() && point.point_on_b.is_finite()));
        }
        assert_ne!(
            narrow::overlap(a.placed(), b.placed(), &EXACT, work).verdict,
            Verdict::Undecided,
            "random pairs are not within rounding of a touch"
        );
    }
}

#[test]
fn huge_hulls_answer_within_bounded_work() {
    let mut noise = Noise(13);
    let points: Vec<DVec3> = (0..20_000).map(|_| noise.vector().normalize()).collect();
    let hull = Body { geometry: Geometry::hull(&points).expect("points"), pose: Pose::IDENTITY };
    let other = hull.moved(DVec3::new(0.9, 0.3, -0.2));
    let contact = contact(&hull, &other);
    let truth = 2.0 - DVec3::new(0.9, 0.3, -0.2).length();
    assert_eq!(contact.certificate.verdict, Verdict::Hit);
    let bound = contact.certificate.bound;
    assert!(
        bound.lower < truth && contact.depth > truth - 0.1 && contact.certificate.iterations <= 4096,
        "{contact:?}"
    );
    assert!(bound.lower > truth - 0.1, "{bound:?}");
    let apart = hull.moved(DVec3::X * 3.0);
    assert!((distance(&hull, &apart) - 1.0).abs() < 0.01);
}

#[test]
fn faces_that_are_all_but_parallel_are_measured_to_the_corner() {
    // The nearest points of these are a corner and a face, farther in by a part in 10^10 than where the first plane that
    // GJK finds is proved.
    let plank = |position: DVec3, rotation: DQuat| Body {
        geometry: Geometry::cuboid(DVec3::new(0.5, 0.25, 1.0)).expect("a size"),
        pose: Pose::new(position, rotation),
    };
    let mut noise = Noise(17);
    for round in 0..500 {
        let tilt = 10f64.powi(-4 - round % 12);
        let rotation = DQuat::from_xyzw(1.0 + tilt * noise.signed(), tilt * noise.signed(), tilt * noise.signed(), 1.0);
        let (a, b) = (
            plank(DVec3::ZERO, DQuat::from_xyzw(1.0, 0.0, 0.0, 1.0)),
            plank(DVec3::new(noise.between(1.01, 1.5), 0.0, 0.0), rotation),
        );
        let answer = narrow::distance(a.placed(), b.placed(), f64::INFINITY, &EXACT, &mut Work::default());
        let bound = answer.expect("no limit").certificate.bound;
        assert!(bound.width() < 1e-12, "tilt {tilt}: {bound:?}");
    }
}

#[test]
fn what_overlaps_at_rest_is_touched_at_the_start_of_any_way() {
    let (a, b) = (cube(0.5, DVec3::ZERO), cube(0.5, DVec3::X * (1.0 - 1e-12)));
    let motion = Motion {
        displacement_a: -DVec3::X * 1e6,
        displacement_b: DVec3::ZERO,
        initial: InitialTouch::Counts,
        ..Motion::default()
    };
    let touch = narrow::impact(a.placed(), b.placed(), &motion, &EXACT, &mut Work::default()).expect("a touch");
    assert_eq!((touch.fraction, touch.initial, touch.certificate.verdict), (0.0, true, Verdict::Hit));
    let ignored = Motion { initial: InitialTouch::IsIgnored, ..motion };
    assert!(narrow::impact(a.placed(), b.placed(), &ignored, &EXACT, &mut Work::default()).is_none());
}

#[test]
fn exact_touch_of_unturned_forms_is_a_hit_and_an_ulp_more_is_a_miss() {
    let verdict = |a: &Body, b: &Body| narrow::overlap(a.placed(), b.placed(), &EXACT, &mut Work::default()).verdict;
    let slab = Geometry::cuboid(DVec3::new(9.0, 0.75, 9.0)).expect("a size");
    let capsule = Body { geometry: Geometry::capsule(0.5, 0.25).expect("sizes"), pose: Pose::IDENTITY };
    for (body, height) in [(cube(0.25, DVec3::ZERO), 0.25), (ball(0.5, DVec3::ZERO), 0.5), (capsule, 0.75)] {
        for top in [0.0, 2.0, 1024.0] {
            let floor = Body { geometry: slab.clone(), pose: Pose::at(DVec3::Y * (top - 0.75)) };
            let at = |y: f64| body.moved(DVec3::new(0.3, y, -8.0));
            let rest = top + height;
            assert_eq!(verdict(&at(rest), &floor), Verdict::Hit);
            assert_eq!(verdict(&at(rest.next_up()), &floor), Verdict::Miss);
            assert_eq!(verdict(&at(rest.next_down()), &floor), Verdict::Hit);
            let separation = narrow::distance(at(rest).placed(), floor.placed(), 1.0, &EXACT, &mut Work::default());
            assert_eq!(separation.expect("near").certificate.bound.upper, 0.0);
            let contact = contact(&at(rest), &floor);
            assert_eq!((contact.certificate.verdict, contact.depth), (Verdict::Hit, 0.0));
        }
    }
    // 3² + 4² = 5²: balls that touch off the axes.
    let (a, b) = (ball(2.0, DVec3::new(1e6, 0.0, 0.0)), ball(3.0, DVec3::new(1e6 + 3.0, 4.0, 0.0)));
    assert_eq!(verdict(&a, &b), Verdict::Hit);
    assert_eq!(verdict(&a, &b.moved(DVec3::Y * 1e-15)), Verdict::Miss);
    let apart = narrow::penetration(a.placed(), b.moved(DVec3::Y * 1e-15).placed(), 0.0, &EXACT, &mut Work::default());
    assert!(apart.expect("convex forms").is_empty());
}

#[test]
fn a_sliver_proves_no_depth_that_is_not_there() {
    // Found by a random search: the tetrahedron that GJK ends with is a sliver, whose faces once proved 2.12e-9.
    let rotation =
        DQuat::from_xyzw(-0.4172936296098111, -0.5494840163177692, -0.5544662400930893, -0.44097632622170524);
    let points = [
        DVec3::new(4463.260449943172, -154.50876112405496, 3707.9971722455466),
        DVec3::new(6550.4286437559485, 120.8494463987063, -4063.6947759384416),
        DVec3::new(4050.4768615647513, 167.06562659423932, -2458.50464469377),
        DVec3::new(-4807.443491643511, 93.72996092406967, -7244.229747442589),
    ];
    let hull = Body { geometry: Geometry::hull(&points).expect("points"), pose: Pose::new(DVec3::ZERO, rotation) };
    let half = DVec3::new(18.389703386255363, 0.4805769392665279, 0.0020609429094791912);
    let position = DVec3::new(-775.411774039723, 625.3990006233162, -91.01883887484212);
    let plank = Body { geometry: Geometry::cuboid(half).expect("a size"), pose: Pose::new(position, rotation) };
    let bound = contact(&hull, &plank).certificate.bound;
    // The width along one direction, measured by the support functions of the corners as sent.
    assert!(bound.lower <= 2.0055992422385316e-9 && bound.upper >= 2.0055992422385316e-9, "{bound:?}");
}

#[test]
fn a_plate_and_a_crumb_converge_to_a_narrow_distance() {
    // Found by the fuzz target: the search ended after two rounds with an interval of 0.16 m, and said that it converged.
    let p = DVec3::new;
    let hull = |points: &[DVec3], pose: Pose| Body { geometry: Geometry::hull(points).expect("points"), pose };
    let turn = DQuat::from_xyzw(0.0, -1.0, -1.0, -1.0);
    let plate = [p(1.0, -1e9, -1.0), p(1.0, 1e9, -1.0), p(1.0, -1e9, 1.0), p(1.0, 1e9, 1.0)];
    let plate = hull(&plate, Pose::new(p(0.0, -0.6796875, 0.0), turn));
    let crumb = [p(0.0, -1e-9, -1e-9), p(0.0, 1e-9, -1e-9), p(0.0, -1e-9, 1e-9), p(0.0, 1e-9, 1e-9)];
    let crumb = hull(&crumb, Pose::IDENTITY);
    let found = narrow::distance(plate.placed(), crumb.placed(), f64::INFINITY, &EXACT, &mut Work::default());
    let bound = found.expect("no limit").certificate.bound;
    assert!(bound.width() < 1e-12 * 1e9, "{bound:?}");
}

/// Found by the fuzz target of hulls: the height of a subnormal vertex along a short direction has no digits left, so that a vertex
/// of a hull was proved to lie off it, or the bounds of the distance crossed and the kernel panicked.
#[test]
fn no_vertex_of_a_subnormal_hull_lies_off_it() {
    let noise = &mut Noise(89);
    let mut spread = 0;
    for round in 0..4_000_u64 {
        // 2⁻⁹²⁰ to 2⁻¹⁰⁷⁴ m.
        let size = f64::from_bits(1 << (round % 52)) * if round % 3 == 0 { 2.0_f64.powi(102) } else { 1.0 };
        let points: Vec<DVec3> = (0..1 + round % 5).map(|_| noise.vector() * size).chain([DVec3::ZERO]).collect();
        let hull = Body { geometry: Geometry::hull(&points).expect("points"), pose: Pose::IDENTITY };
        spread += u32::from(points[0] != DVec3::ZERO);
        for &point in &points {
            let point = Body { geometry: Geometry::point(), pose: Pose::at(point) };
            let (hull, point) = (hull.placed(), point.placed());
            let work = &mut Work::default();
            let apart = narrow::distance(point, hull, f64::INFINITY, &EXACT, work).expect("no limit").certificate;
            assert!(apart.bound.lower == 0.0 && apart.verdict != Verdict::Miss, "{apart:?}: {points:?}");
            assert_ne!(narrow::overlap(hull, point, &EXACT, work).verdict, Verdict::Miss, "{points:?}");
        }
    }
    assert!(spread > 3_500, "{spread}");
}
