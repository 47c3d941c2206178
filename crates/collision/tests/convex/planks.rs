//! Motions that turn at half spaces: planks that turn above a floor, and floors that tilt.

use std::f64::consts::TAU;

use crate::{
    random::Body,
    turning::{EXACT, impact, moved},
};
use collision::{
    DVec3,
    answer::{Verdict, Work},
    math::Pose,
    narrow::{self, InitialTouch, Motion},
    shape::Geometry,
};

#[test]
fn a_plank_meets_a_plane_at_the_angle_that_geometry_says() {
    // Its lowest corner is as far below its middle as the sine of the angle and a fifth of its cosine.
    let truth = (0.8f64 / 1.04f64.sqrt()).asin() - 0.2f64.atan();
    let half = DVec3::new(1.0, 0.2, 0.2);
    let corners: Vec<DVec3> = (0..8)
        .map(|corner| half * DVec3::from_array([0, 1, 2].map(|bit| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 })))
        .collect();
    let faces = [[0, 1, 2], [1, 3, 2], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 3, 6], [3, 7, 6]];
    let forms = [
        Geometry::cuboid(half).expect("sizes"),
        Geometry::mesh(&corners, &faces).expect("a mesh"),
        Geometry::cuboid(half - 0.1).and_then(|core| core.rounded(0.1)).expect("sizes"),
    ];
    let floor = Body {
        geometry: Geometry::half_space(DVec3::Y, 0.5).expect("a half space"),
        pose: Pose::at(DVec3::new(7.0, 1.5, -3.0)),
    };
    for (round, geometry) in forms.into_iter().enumerate() {
        let plank = Body { geometry, pose: Pose::at(DVec3::new(7.0, 2.8, -3.0)) };
        for turn in [DVec3::Z * 2.0, DVec3::Z * -2.0] {
            let motion = Motion { rotation_a: turn, ..Motion::default() };
            let touch = impact(&plank, &floor, &motion, &EXACT).expect("it meets the floor");
            let bound = touch.certificate.bound;
            assert_eq!((touch.certificate.verdict, touch.initial), (Verdict::Hit, false), "{touch:?}");
            assert!(bound.width() < 1e-10, "{bound:?}");
            assert_eq!(touch.normal_b_to_a, Some(DVec3::Y));
            if round < 2 {
                let slack = 1e-15;
                assert!(bound.lower * 2.0 <= truth + slack && truth <= bound.upper * 2.0 + slack, "{bound:?} {truth}");
            }
            let back = Motion { rotation_b: turn, ..Motion::default() };
            let back = impact(&floor, &plank, &back, &EXACT).expect("as the other way round");
            assert_eq!((back.fraction, back.certificate), (touch.fraction, touch.certificate));
            assert_eq!(back.normal_b_to_a, Some(DVec3::NEG_Y));
            let ignored = Motion { initial: InitialTouch::IsIgnored, ..motion };
            let again = impact(&plank, &floor, &ignored, &EXACT).expect("nothing to ignore").certificate.bound;
            assert!(again.lower <= bound.upper && bound.lower <= again.upper, "{again:?} {bound:?}");
            // The floor tilts towards a plank that hangs over its local origin.
            let tilting = Motion { rotation_b: turn, ..Motion::default() };
            let tilted = impact(&plank, &floor, &tilting, &EXACT).expect("the floor comes up");
            let at = |time: f64| {
                let floor = moved(&floor, DVec3::ZERO, turn, time);
                narrow::overlap(plank.placed(), floor.placed(), &EXACT, &mut Work::default()).verdict
            };
            let bound = tilted.certificate.bound;
            assert_eq!(at(bound.upper + 1e-14), Verdict::Hit);
            assert!((0..100).all(|step| at(bound.lower * f64::from(step) / 100.0) == Verdict::Miss));
        }
    }
}

#[test]
fn a_plank_that_stands_on_a_plane_is_ignored_until_it_lifts() {
    let floor = Body { geometry: Geometry::half_space(DVec3::Y, 0.0).expect("a half space"), pose: Pose::IDENTITY };
    let plank =
        Body { geometry: Geometry::cuboid(DVec3::new(1.0, 0.2, 0.2)).expect("sizes"), pose: Pose::at(DVec3::Y * 0.1) };
    let lifting = Motion {
        displacement_a: DVec3::Y,
        rotation_a: DVec3::Z * 2.0,
        initial: InitialTouch::IsIgnored,
        ..Motion::default()
    };
    // Its end sinks by the sine of the angle faster than its middle rises, and comes up again a quarter turn on.
    assert!(impact(&plank, &floor, &lifting, &EXACT).is_none());
    let hop = Motion { displacement_a: DVec3::Y * 0.5, rotation_a: DVec3::X * TAU, ..lifting };
    let touch = impact(&plank, &floor, &hop, &EXACT);
    let at = |time: f64| {
        let plank = moved(&plank, hop.displacement_a, hop.rotation_a, time);
        narrow::overlap(plank.placed(), floor.placed(), &EXACT, &mut Work::default()).verdict
    };
    // Whatever was parted and met again is told.
    let verdicts: Vec<Verdict> = (0..=2000).map(|step| at(f64::from(step) / 2000.0)).collect();
    let parted = verdicts.iter().position(|&verdict| verdict == Verdict::Miss);
    let again = parted.is_some_and(|from| verdicts[from..].contains(&Verdict::Hit));
    assert_eq!(touch.is_some(), again, "{touch:?}");
}
