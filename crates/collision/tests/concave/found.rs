//! Pairs with a concave form that broke a law, found by random questions held against an oracle.

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Stop, Verdict},
    math::Pose,
    narrow::{Motion, Placed, impact, overlap, penetration},
    shape::{Geometry, Terrain},
};

use crate::agree::{EXACT, at, work};

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
    let accuracy = Accuracy::of(Tier::Fast);
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
