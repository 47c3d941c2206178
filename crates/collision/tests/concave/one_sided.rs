//! What moves past a one-sided mesh: what its documentation says of compounds and of what turns.

use std::sync::Arc;

use collision::{
    DVec3,
    answer::Verdict,
    math::Pose,
    narrow::{ImpactTouch, Motion, Placed, impact},
    shape::{Geometry, MeshMode, Part},
};

use crate::{
    agree::{EXACT, at, convex, work},
    whole::Numbers,
};

fn triangle(mode: MeshMode, corners: &[DVec3; 3]) -> Geometry {
    Geometry::mesh_as(mode, corners, &[[0, 1, 2]]).expect("a triangle")
}

fn first_touch(moving: &Geometry, place: DVec3, mesh: &Geometry, motion: &Motion) -> Option<ImpactTouch> {
    impact(at(moving, Pose::at(place)), at(mesh, Pose::IDENTITY), motion, &EXACT, &mut work())
}

/// A triangle that one part passes from its back is felt by the next part that comes to its front: a compound is met where the
/// first of its parts is.
#[test]
fn each_part_passes_a_back_for_itself() {
    let mut numbers = Numbers::new(601);
    let (mut met, mut free, mut behind_another) = (0, 0, 0);
    for _ in 0..12_000 {
        let corners = [numbers.shares(), numbers.shares(), numbers.shares()];
        let [one_sided, two_sided] = [MeshMode::OneSided, MeshMode::TwoSided].map(|mode| triangle(mode, &corners));
        let away = numbers.shares().normalize() * 4.0;
        let motion = Motion { displacement_a: numbers.shares() * 0.5 - away * 2.0, ..Motion::default() };
        let parts: Vec<Part> = (0..3)
            .map(|_| Part { geometry: Arc::new(convex(&mut numbers)), pose: Pose::at(numbers.shares() * 1.5) })
            .collect();
        let alone = |mesh: &Geometry| -> Vec<Option<ImpactTouch>> {
            let touch = |part: &Part| first_touch(&part.geometry, away + part.pose.position, mesh, &motion);
            parts.iter().map(touch).collect()
        };
        let (fronts, both) = (alone(&one_sided), alone(&two_sided));
        let compound = Geometry::compound(parts.clone()).expect("a compound");
        let whole = first_touch(&compound, away, &one_sided, &motion);
        let is_certain = |touch: &ImpactTouch| touch.certificate.verdict == Verdict::Hit;
        if !fronts.iter().chain(&both).chain([&whole]).flatten().all(is_certain) {
            continue;
        }
        let first = fronts.iter().flatten().min_by(|a, b| a.fraction.total_cmp(&b.fraction));
        assert_eq!(whole.is_some(), first.is_some(), "{whole:?} {first:?} {corners:?}");
        let (Some(whole), Some(first)) = (whole, first) else {
            free += 1;
            continue;
        };
        met += 1;
        assert!((whole.fraction - first.fraction).abs() <= 1e-12, "{whole:?} {first:?} {corners:?}");
        let went_before = |(front, both): (&Option<ImpactTouch>, &Option<ImpactTouch>)| {
            front.is_none() && both.is_some_and(|touch| touch.fraction < whole.fraction - 1e-9)
        };
        behind_another += u32::from(fronts.iter().zip(&both).any(went_before));
    }
    assert!(met > 500 && free > 500 && behind_another > 20, "{met} met, {free} free, {behind_another} behind another");
}

/// A ball that goes up past an edge, which it meets from the front, is felt if it spins: then the side alone tells.
#[test]
fn what_turns_is_felt_by_the_side_of_the_touch_alone() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let mesh = triangle(MeshMode::OneSided, &corners);
    let ball = Geometry::sphere(0.2).expect("a size");
    let spin = DVec3::Y * 0.5;
    let rising = Motion { displacement_a: DVec3::new(2.0, 0.0, 0.2), ..Motion::default() };
    for (height, felt) in [(-0.03, true), (-0.2, false)] {
        let from = Placed { geometry: &ball, pose: Pose::at(DVec3::new(-1.0, 0.3, height)) };
        let ask = |motion: &Motion| impact(from, at(&mesh, Pose::IDENTITY), motion, &EXACT, &mut work());
        assert!(ask(&rising).is_none(), "what goes away from the front is not felt, from {height}");
        let touch = ask(&Motion { rotation_a: spin, ..rising });
        assert_eq!(touch.is_some(), felt, "from {height}: {touch:?}");
        assert!(touch.is_none_or(|touch| touch.normal_b_to_a.is_some_and(|normal| normal.z > 0.0)), "{touch:?}");
    }
}
