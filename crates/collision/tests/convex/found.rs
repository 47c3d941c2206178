//! Pairs that broke a law, found by the fuzz target for pairs.

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Certificate, Stop, Verdict, Work},
    math::Pose,
    narrow::{self, Depth, InitialTouch, Motion, Placed},
    shape::Geometry,
};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

fn at(geometry: &Geometry, pose: Pose) -> Placed<'_> {
    Placed { geometry, pose }
}

fn depth(a: Placed<'_>, b: Placed<'_>) -> Depth {
    narrow::depth(a, b, 0.0, &EXACT, &mut Work::default()).expect("they overlap")
}

/// Of face against face the points were a corner and its shadow on the plane of the other face, far beside it.
#[test]
fn deepest_points_lie_on_the_forms() {
    let cube = |half: f64| Geometry::cuboid(DVec3::splat(half)).expect("a size");
    for (half, position) in [(0.5, DVec3::X * 1.25), (1e-3, DVec3::ZERO), (1.0, DVec3::new(0.3, -0.2, 0.1))] {
        let (a, b) = (cube(1.0), cube(half));
        let found = depth(at(&a, Pose::IDENTITY), at(&b, Pose::at(position)));
        let in_a = (found.point_on_a.abs() - DVec3::splat(1.0)).max_element();
        let in_b = ((found.point_on_b - position).abs() - DVec3::splat(half)).max_element();
        assert!(in_a <= 1e-14 && in_b <= 1e-14, "{found:?}");
    }
}

/// Between axes that are parallel but for 1e-157 there was one of no unit length, which showed too little depth and points
/// that are no numbers.
#[test]
fn turns_whose_square_vanishes_keep_the_depth_of_boxes() {
    let a = Geometry::cuboid(DVec3::new(0.5, 1.0234375, 1.6953125)).expect("a size");
    let b = Geometry::point();
    for power in (-170..=-130).rev() {
        let turn = DQuat::from_xyzw(1.0, 0.0, 0.0, -7.0563 * 10f64.powi(power));
        let found = depth(at(&a, Pose::new(DVec3::ZERO, turn)), at(&b, Pose::IDENTITY));
        assert!(found.certificate.bound.contains(0.5) && found.point_on_a.is_finite(), "1e{power} {found:?}");
    }
}

/// The square of what parts them is 0.
#[test]
fn points_apart_by_a_length_without_a_square_do_not_touch() {
    let point = Geometry::point();
    let (here, there) = (at(&point, Pose::IDENTITY), at(&point, Pose::at(DVec3::X * 1e-200)));
    let overlap = narrow::overlap(here, there, &EXACT, &mut Work::default());
    assert_ne!(overlap.verdict, Verdict::Hit, "{overlap:?}");
}

/// Where two lines are parallel to within rounding, the crossing of them was 0 / 0.
#[test]
fn segments_all_but_parallel_have_points() {
    for size in [1.0, 1e-9] {
        let ends = [DVec3::new(1.0, 0.0, -2.0), DVec3::new(1.0, -2.0, -2.0)].map(|point| point * size);
        for form in [Geometry::hull(&ends), Geometry::capsule(size, 0.0)].map(|form| form.expect("sizes")) {
            for turn in [DQuat::from_xyzw(0.0, 0.109375, 0.001617431640625, 1.0), DQuat::from_xyzw(0.3, 0.1, -0.7, 0.2)]
            {
                for other in [turn * 2.0, turn * 3.0, DQuat::from_xyzw(turn.x, turn.y, turn.z, turn.w.next_up())] {
                    let (a, b) = (at(&form, Pose::new(DVec3::ZERO, turn)), at(&form, Pose::new(DVec3::ZERO, other)));
                    let contacts = narrow::penetration(a, b, size, &EXACT, &mut Work::default()).expect("convex forms");
                    let mut points = contacts.iter().flat_map(|contact| &contact.points);
                    assert!(
                        points.all(|point| point.point_on_a.is_finite() && point.depth.is_finite()),
                        "{contacts:?}"
                    );
                }
            }
        }
    }
}

/// Of a plate seen along its plane the sides without length cut nothing off, and points lay beside it.
#[test]
fn points_of_plates_edge_on_lie_on_them() {
    let half = [DVec3::new(1.0, 0.01, 2.5), DVec3::new(0.125, 1.0, 0.0), DVec3::new(0.0, 1.0, 0.0)];
    let boxes = half.map(|half| Geometry::cuboid(half).expect("a size"));
    for other in [1, 2] {
        for shift in [DVec3::ZERO, DVec3::new(0.3, 0.2, -0.4)] {
            let (a, b) = (at(&boxes[0], Pose::IDENTITY), at(&boxes[other], Pose::at(shift)));
            let found = depth(a, b);
            let contacts = narrow::penetration(a, b, 0.0, &EXACT, &mut Work::default()).expect("convex forms");
            let points = contacts.iter().flat_map(|contact| &contact.points);
            let points = points.map(|point| (point.point_on_a, point.point_on_b));
            for (on_a, on_b) in points.chain([(found.point_on_a, found.point_on_b)]) {
                let out = (on_a.abs() - half[0]).max_element().max(((on_b - shift).abs() - half[other]).max_element());
                assert!(out <= 1e-13, "{on_a} {on_b} {found:?}");
            }
        }
    }
}

/// Plates that cross edge on, each with its edge in the other: their faces are lines.
#[test]
fn points_of_plates_that_cross_lie_on_both() {
    let half = DVec3::new(0.0, 1e3, 1.0);
    let plate = Geometry::cuboid(half).expect("a plate");
    let turn = Pose::new(DVec3::ZERO, DQuat::from_xyzw(-4.5, -1.0, 0.0, 0.0));
    let (a, b) = (at(&plate, Pose::at(DVec3::splat(-1.0))), at(&plate, turn));
    let found = depth(a, b);
    let out_of_a = ((found.point_on_a + 1.0).abs() - half).max_element();
    let out_of_b = ((turn.unit_rotation().conjugate() * found.point_on_b).abs() - half).max_element();
    assert!(out_of_a <= 1e-9 && out_of_b <= 1e-9, "{found:?}");
}

/// The far side of a flat form is as near as the side that a point lies over.
#[test]
fn a_point_outside_of_a_flat_round_body_is_outside() {
    let point = Geometry::point();
    let cone = Geometry::cone(1e-9, 1e9).expect("sizes");
    let (a, b) = (at(&point, Pose::at(DVec3::Y * -4e7)), at(&cone, Pose::IDENTITY));
    assert_eq!(narrow::overlap(a, b, &EXACT, &mut Work::default()).verdict, Verdict::Miss);
    let apart = narrow::distance(a, b, f64::INFINITY, &EXACT, &mut Work::default()).expect("no limit");
    assert!(apart.certificate.bound.contains(4e7 - 1e-9), "{apart:?}");
    let disc = Geometry::cylinder(1e-9, 1e9).expect("sizes");
    let pose = Pose::new(DVec3::splat(-580958708.3720613), DQuat::from_xyzw(0.0, 0.0, 1.0, 1.0));
    let (a, b) = (at(&point, Pose::IDENTITY), at(&disc, pose));
    assert_eq!(narrow::overlap(a, b, &EXACT, &mut Work::default()).verdict, Verdict::Miss);
    assert!(narrow::depth(a, b, 0.0, &EXACT, &mut Work::default()).is_none());
}

/// Each instant that was tried for a proof of overlap asked all separating axes: 2.2 million iterations for a budget of 128.
#[test]
fn an_impact_of_flat_hulls_keeps_its_budget() {
    let golden = 2.399_963_229_728_653;
    let disc = (0..108).map(|i| {
        let height = 1.0 - f64::from(2 * i + 1) / 108.0;
        let ring = (1.0 - height * height).sqrt();
        let turn = golden * f64::from(i);
        DVec3::new(turn.cos() * ring * 1e-18, height, turn.sin() * ring)
    });
    let hull = Geometry::hull(&disc.collect::<Vec<_>>()).expect("a hull");
    let (a, b) = (at(&hull, Pose::IDENTITY), at(&hull, Pose::at(DVec3::Z * -1.0)));
    let motion = Motion { displacement_a: DVec3::new(0.0, -100.0, -0.7), ..Motion::default() };
    let accuracy = Accuracy::default();
    let found = narrow::impact(a, b, &motion, &accuracy, &mut Work::default()).expect("they touch at the start");
    // The way, what is at the start, and the proof have the budget each.
    assert!(found.certificate.iterations <= 3 * accuracy.budget + 64, "{found:?}");
}

/// Of a motion whose touch at the start is ignored, a budget that was spent before that touch was told counted as one.
#[test]
fn a_start_that_a_budget_leaves_open_is_not_passed_over() {
    let egg =
        Geometry::ellipsoid(DVec3::new(0.2589875074356257, 0.602149471929991, 0.24802526202749933)).expect("sizes");
    let cone =
        Geometry::cone(0.5223130383766871, 0.2758040947161228).and_then(|cone| cone.rounded(0.00018878605149055472));
    let cone = cone.expect("sizes");
    let turn = DQuat::from_xyzw(-0.013939865452926812, 0.596855672647896, 0.8006173601816013, -0.05080185779108874);
    let a = at(&egg, Pose::new(DVec3::new(0.7041178168596847, 0.5468300397950485, -0.4529845555408012), turn));
    let turn = DQuat::from_xyzw(-0.005332159085032253, 0.22830416903503967, 0.30624536132510183, -0.019432295710387393);
    let b = at(&cone, Pose::new(DVec3::new(0.7157308244920146, 0.9556590155132794, -0.11377390717076033), turn));
    let motion = Motion {
        displacement_a: DVec3::new(-4.971235105039601e-7, 5.432396394507209e-7, -7.665248674011533e-7),
        displacement_b: DVec3::new(2.815033374329646e-7, -3.076172586893578e-7, 4.3405573029535174e-7),
        initial: InitialTouch::IsIgnored,
        ..Motion::default()
    };
    for tier in [Tier::Fast, Tier::Standard, Tier::Exact] {
        let touch = narrow::impact(a, b, &motion, &Accuracy::of(tier), &mut Work::default());
        let bound = touch.expect("they meet").certificate.bound;
        assert!(bound.contains(0.2278335367138472), "{tier:?}: {bound:?}");
    }
}

/// An interval that rounding leaves wide said that it was as narrow as was asked.
#[test]
fn a_touch_in_doubt_does_not_say_that_it_is_as_narrow_as_was_asked() {
    let floor = Geometry::half_space(DVec3::new(0.0, 0.0, -0.5), 0.0).expect("a normal");
    let can = Geometry::cylinder(0.625, 0.875).expect("sizes");
    let a = at(&floor, Pose::at(DVec3::new(-0.125, 0.5, -0.875)));
    let b = at(&can, Pose::at(DVec3::new(-0.375, 0.625, -1.75)));
    let motion = Motion {
        displacement_a: DVec3::new(6128.868943723879, 734.5871110451372, 2018.8274826066208),
        displacement_b: DVec3::new(-72588.30420588935, -8700.20768462889, -23910.32746698284),
        rotation_a: DVec3::new(-3.90642992363751, 210.28237912688195, 53.61244301937273),
        rotation_b: DVec3::new(58.52230105532901, -16.004519190154145, 37.30952329062552),
        ..Motion::default()
    };
    let accuracy = Accuracy::default();
    let touch = narrow::impact(a, b, &motion, &accuracy, &mut Work::default()).expect("they touch at the start");
    let Certificate { bound, stop, .. } = touch.certificate;
    let is_narrow = bound.width() <= accuracy.max_error_relative * bound.upper;
    assert!(stop != Stop::Tolerance || is_narrow, "{touch:?}");
}
