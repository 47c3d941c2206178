//! Pairs with a concave form that broke a law, found by random questions held against an oracle.

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Stop, Verdict},
    math::Pose,
    narrow::{Motion, Placed, impact, overlap, penetration},
    shape::{Geometry, Terrain},
};

use crate::{
    agree::{EXACT, at, rotation, work},
    whole::Numbers,
};

fn flat_land() -> Geometry {
    let heights = [0.0; 9];
    let terrain = Terrain { columns: 3, rows: 3, heights: &heights, spacing: DVec3::ONE, holes: &[0] };
    Geometry::height_field(&terrain).expect("a terrain")
}

/// A form beside a terrain was told to be in it, by a piece of the skin around the corner.
#[test]
fn a_form_beside_a_terrain_has_no_contact_that_touches() {
    let land = flat_land();
    let cube = Geometry::cuboid(DVec3::splat(0.1)).expect("a size");
    // Above the ground, beside the outer wall, in the hole and above its rim.
    for position in [[1.5, 0.3, 1.5], [2.3, 0.3, 1.0], [2.3, -0.5, 1.0], [0.5, -0.5, 0.5], [0.8, 0.15, 0.8]] {
        let position = DVec3::from_array(position);
        let (a, b) = (at(&cube, Pose::at(position)), at(&land, Pose::IDENTITY));
        assert_eq!(overlap(a, b, &EXACT, &mut work()).verdict, Verdict::Miss);
        let contacts = penetration(a, b, 0.6, &EXACT, &mut work()).expect("one is convex");
        assert!(!contacts.is_empty(), "{position}");
        let misses = contacts.iter().all(|contact| contact.certificate.verdict == Verdict::Miss && contact.depth < 0.0);
        assert!(misses, "{position}: {contacts:?}");
    }
    // Below ground it has one, however far it looks.
    let buried = at(&cube, Pose::at(DVec3::new(1.5, -0.5, 1.5)));
    let contacts = penetration(buried, at(&land, Pose::IDENTITY), 0.6, &EXACT, &mut work()).expect("one is convex");
    assert!(contacts.iter().any(|contact| contact.certificate.verdict == Verdict::Hit), "{contacts:?}");
}

/// Points and plates prove no overlap with a triangle, so what they fell on was left open for the rest of the way.
#[test]
fn points_and_plates_fall_on_a_terrain() {
    let land = flat_land();
    let plate =
        Geometry::hull(&[DVec3::X, DVec3::Z, -DVec3::X, -DVec3::Z].map(|corner| corner * 0.1)).expect("a plate");
    for (form, turn) in [(Geometry::point(), DQuat::IDENTITY), (plate, DQuat::from_xyzw(0.3, 0.0, 0.1, 1.0))] {
        let from = Placed { geometry: &form, pose: Pose::new(DVec3::new(1.4, 1.0, 1.7), turn) };
        let motion = Motion { displacement_a: DVec3::Y * -2.0, ..Motion::default() };
        let touch = impact(from, at(&land, Pose::IDENTITY), &motion, &EXACT, &mut work()).expect("it falls");
        assert_eq!(touch.certificate.verdict, Verdict::Hit, "{touch:?}");
        assert!(touch.certificate.bound.lower <= 0.5 && touch.certificate.bound.lower > 0.4, "{touch:?}");
    }
}

/// Of two pieces that are first within rounding, one that its budget left open made the interval wide, and the stop was that of
/// the other.
#[test]
fn what_makes_an_interval_wide_says_why_it_ended() {
    let land = flat_land();
    let stick = Geometry::capsule(0.7, 0.01).expect("sizes");
    let accuracy = Accuracy { budget: 16, ..Accuracy::of(Tier::Fast) };
    let mut wide = 0;
    for step in 0..400 {
        let tilt = f64::from(step) * 0.01;
        let a = at(&stick, Pose::new(DVec3::new(1.2 + 0.3 * tilt.sin(), 1.1, 1.3), DQuat::from_rotation_z(tilt)));
        let motion = Motion {
            displacement_a: DVec3::new(0.1, -1.5, 0.1),
            rotation_a: DVec3::new(tilt.cos(), 2.0, tilt.sin()) * 2.0,
            ..Motion::default()
        };
        let Some(touch) = impact(a, at(&land, Pose::IDENTITY), &motion, &accuracy, &mut work()) else { continue };
        let bound = touch.certificate.bound;
        let is_narrow = bound.width() <= accuracy.max_error_relative * bound.upper * 1.000_001;
        wide += usize::from(!is_narrow);
        assert!(is_narrow || touch.certificate.stop != Stop::Tolerance, "{step}: {touch:?}");
    }
    assert!(wide > 0, "the law was not put to the test");
}

/// Of a form beside a terrain, a contact that the budget of the fast tier left open was told as a touch, since the form is below the
/// plane of a piece of skin.
#[test]
fn what_a_budget_leaves_open_is_no_touch_of_a_terrain() {
    let heights = [-0.2945317, -0.27769175, 0.08775261, 0.29984364, -0.124887176, -0.0350419, 0.21821088, 0.004837382];
    let spacing = DVec3::new(0.3500012106640288, 1.0, 0.32838195786990104);
    let land = Geometry::height_field(&Terrain { columns: 4, rows: 2, heights: &heights, spacing, holes: &[1] });
    let (land, egg) = (
        land.expect("a terrain"),
        Geometry::ellipsoid(DVec3::new(0.7273968472353712, 0.5770494891529094, 0.6373196759431823)).expect("sizes"),
    );
    let turn = DQuat::from_xyzw(0.6702392323272917, 0.18486366274350458, -0.6638257062275273, 0.2755725483387329);
    let a = at(&egg, Pose::new(DVec3::new(-1.082658677329967, 0.3339571229426267, -0.13717107077390267), turn));
    let b = at(&land, Pose::at(DVec3::new(-0.8773748807618494, -0.0876871243808704, -0.471724799884365)));
    assert_ne!(overlap(a, b, &EXACT, &mut work()).verdict, Verdict::Hit);
    let contacts = penetration(a, b, 0.0, &Accuracy::of(Tier::Fast), &mut work()).expect("one is convex");
    assert!(contacts.iter().all(|contact| contact.certificate.verdict != Verdict::Hit), "{contacts:?}");
}

/// Ridges a thousand metres high on cells of a micrometre: needles whose normals lost their digits, so that the points on their
/// planes lay off them.
#[test]
fn no_point_of_a_contact_of_needles_is_deeper_than_the_contact() {
    let heights = [-1e12, 1.0, -1e12, 0.0, 1.0, 0.0, 1e12, 0.0, 1.0, 0.0, 0.0, 0.0, -1e-5, 1e-6, 1.0];
    let spacing = DVec3::new(1.0 / 1_048_576.0, 1e-9, 1e-9);
    let terrain = Terrain { columns: 3, rows: 5, heights: &heights, spacing, holes: &[7, 2] };
    let land = Geometry::height_field(&terrain).expect("a terrain");
    let mut points = 0;
    for round in 0..400 {
        let mut numbers = Numbers::new(211 + round);
        let place = numbers.shares() * 1e-6;
        let there = Pose::new(place, rotation(&mut numbers));
        for contact in
            penetration(at(&land, Pose::IDENTITY), at(&land, there), 0.0, &EXACT, &mut work()).unwrap_or_default()
        {
            for point in &contact.points {
                points += 1;
                let beyond = point.bound.lower - contact.certificate.bound.upper;
                assert!(beyond <= 1e-12 * 4e3, "round {round}: {beyond:e} m deeper: {contact:?}");
            }
        }
    }
    assert!(points > 100, "{points}");
}
