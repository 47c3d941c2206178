//! The oracle against closed forms, and against the reference sets where they are.

use std::path::PathBuf;

use glam::{DQuat, DVec3};
use yardstick::{
    oracle::{Core, Place, PlacedSolid, Solid, Truth, look_for_overlap, meeting, scale},
    sets::{Form, HullTable, Placed, pairs},
};

fn place(core: Core, radius: f64, position: DVec3) -> PlacedSolid {
    PlacedSolid { solid: Solid { core, radius }, position, rotation: DQuat::IDENTITY }
}

fn truth(a: &PlacedSolid, b: &PlacedSolid) -> f64 {
    let there = Truth::of(a, b, &[]);
    let back = Truth::of(b, a, &[]);
    let tolerance = 1e-14 * scale(a, b);
    assert!((there.nearest() - back.nearest()).abs() <= tolerance, "{} {}", there.nearest(), back.nearest());
    assert!(there.blur() <= tolerance, "{}", there.blur());
    assert!(!there.is_above(there.nearest() + tolerance) && !there.is_below(there.nearest() - tolerance));
    assert!((there.gap_along(there.normal_a_to_b()) - there.nearest()).abs() <= tolerance);
    there.nearest()
}

#[track_caller]
fn expect(a: &PlacedSolid, b: &PlacedSolid, distance: f64) {
    let found = truth(a, b);
    assert!((found - distance).abs() <= 2e-16 * scale(a, b), "{found} is not {distance}");
}

const CUBE: Core = Core::Cuboid { half_extents: DVec3::ONE };
const CAN: Core = Core::Cylinder { half_height: 2.0, radius: 0.5 };
const CONE: Core = Core::Cone { half_height: 1.0, radius: 1.5 };
const EGG: Core = Core::Ellipsoid { radii: DVec3::new(1.0, 2.0, 3.0) };

#[test]
fn boxes_and_balls_are_as_far_apart_as_they_are() {
    let at = |x: f64, y: f64, z: f64| place(CUBE, 0.0, DVec3::new(x, y, z));
    expect(&at(0.0, 0.0, 0.0), &at(5.0, 6.0, 2.0), 5.0);
    expect(&at(0.0, 0.0, 0.0), &at(2.0, 0.3, 0.1), 0.0);
    expect(&at(0.0, 0.0, 0.0), &at(1.5, 0.3, 0.1), -0.5);
    expect(&at(1e9, 0.0, 0.0), &at(1e9, 0.0, 0.0), -2.0);
    let ball = |radius, x| place(Core::Point, radius, DVec3::X * x);
    expect(&ball(1.0, 0.0), &ball(2.0, 4.5), 1.5);
    expect(&ball(1.0, 0.0), &ball(2.0, 0.0), -3.0);
    expect(&ball(0.0, 0.0), &at(0.0, 0.0, 0.25), -0.75);
    expect(&ball(0.0, 0.0), &ball(0.0, 1e-200), 1e-200);
}

#[test]
fn forms_without_volume_touch_where_they_cross() {
    let stick = |position| place(Core::Segment { half_height: 1.0 }, 0.0, position);
    expect(&stick(DVec3::ZERO), &stick(DVec3::Y), 0.0);
    expect(&stick(DVec3::ZERO), &stick(DVec3::new(3.0, 1.0, 4.0)), 5.0);
    expect(&place(Core::Point, 0.25, DVec3::Y * 0.5), &stick(DVec3::ZERO), -0.25);
    let plate = Core::Hull(vec![DVec3::ZERO, DVec3::X, DVec3::Z, DVec3::X + DVec3::Z]);
    expect(&place(plate.clone(), 0.0, DVec3::ZERO), &place(plate.clone(), 0.0, DVec3::new(0.5, 0.0, 0.5)), 0.0);
    expect(&place(plate.clone(), 0.0, DVec3::ZERO), &place(Core::Point, 0.0, DVec3::new(0.5, -2.0, 0.5)), 2.0);
    expect(&place(plate, 0.0, DVec3::ZERO), &stick(DVec3::new(0.5, 0.75, 0.5)), -0.25);
}

#[test]
fn round_cores_have_closed_forms_along_their_axes() {
    let cube = |x: f64, y: f64, z: f64| place(CUBE, 0.0, DVec3::new(x, y, z));
    expect(&place(CAN, 0.0, DVec3::ZERO), &cube(0.0, 3.5, 0.0), 0.5);
    expect(&place(CAN, 0.25, DVec3::ZERO), &cube(2.5, 0.3, 0.2), 0.75);
    expect(&place(CAN, 0.0, DVec3::ZERO), &cube(1.25, 0.3, 0.2), -0.25);
    expect(&place(CONE, 0.0, DVec3::ZERO), &cube(0.0, 2.5, 0.0), 0.5);
    expect(&place(CONE, 0.0, DVec3::ZERO), &cube(2.25, -0.5, 0.2), -0.25);
    expect(&place(EGG, 0.0, DVec3::ZERO), &place(Core::Point, 0.0, DVec3::Y * 2.5), 0.5);
    expect(&place(EGG, 0.0, DVec3::ZERO), &place(EGG, 0.0, DVec3::ZERO), -2.0);
    expect(&place(EGG, 0.0, DVec3::ZERO), &place(Core::Point, 0.0, DVec3::ZERO), -1.0);
    expect(&place(CAN, 0.0, DVec3::ZERO), &place(CAN, 0.0, DVec3::ZERO), -1.0);
    expect(&place(CAN, 0.0, DVec3::ZERO), &place(CAN, 0.0, DVec3::X * 3.0), 2.0);
    // The side of the cone leans by 3 : 4 here.
    let cone = place(Core::Cone { half_height: 2.0, radius: 3.0 }, 0.0, DVec3::ZERO);
    expect(&cone, &place(Core::Point, 0.0, DVec3::new(0.0, 7.0, 0.0)), 5.0);
    expect(&cone, &place(Core::Point, 0.0, DVec3::new(4.0 + 1.5, 3.0, 0.0)), 5.0);
    expect(&cone, &place(Core::Point, 0.0, DVec3::new(0.0, -0.5, 0.0)), -1.5);
}

fn solid(placed: &Placed) -> PlacedSolid {
    let (core, radius) = match &placed.form {
        Form::Sphere { radius } => (Core::Point, *radius),
        Form::Capsule { half_height, radius } => (Core::Segment { half_height: *half_height }, *radius),
        Form::Cuboid { half_extents } => (Core::Cuboid { half_extents: *half_extents }, 0.0),
        Form::Hull(cloud) => (Core::Hull(cloud.points.clone()), 0.0),
        Form::Mesh(_) => unreachable!("sets of pairs have no meshes"),
    };
    PlacedSolid { solid: Solid { core, radius }, position: placed.pose.position, rotation: placed.pose.rotation }
}

/// Corners of one hull up to which a pair is looked at here: the oracle's time is cubic in them.
const CORNERS_MAX: usize = 12;

#[test]
fn the_reference_agrees() {
    let folder = std::env::var_os("CALIPERS_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    if !folder.is_dir() {
        return;
    }
    let hulls = HullTable::read(&folder.join("hulls.jsonl")).expect("hulls");
    let mut compared = 0;
    for set in ["box_box", "hull_hull", "mixed"] {
        let records = pairs::read(&folder.join(set).with_extension("jsonl"), &hulls).expect("a set");
        for record in records.iter().step_by(if cfg!(debug_assertions) { 10 } else { 1 }) {
            let (a, b) = (solid(&record.a), solid(&record.b));
            let count = |placed: &PlacedSolid| match &placed.solid.core {
                Core::Hull(points) => points.len(),
                _ => 0,
            };
            if count(&a).max(count(&b)) > CORNERS_MAX {
                continue;
            }
            let found = Truth::of(&a, &b, &[]).nearest();
            let error = (found - record.distance).abs() / record.scale;
            assert!(error <= 2e-15, "{set} {} {}: {found} is not {}", record.index, record.category, record.distance);
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn forms_in_motion_meet_when_they_do() {
    let (cube, ball) = (Solid { core: CUBE, radius: 0.0 }, Solid { core: Core::Point, radius: 0.5 });
    let still = Place::of(&place(CUBE, 0.0, DVec3::ZERO));
    let comes = |from: DVec3, displacement: DVec3| Place { position: from, displacement, ..still };
    let meets = |from: DVec3, way: DVec3| meeting([(&cube, &still), (&ball, &comes(from, way))]);
    let ahead = meets(DVec3::X * 4.0, DVec3::X * -5.0);
    assert!((ahead.free_until - 0.5).abs() < 1e-15 && (ahead.touching_at.expect("a touch") - 0.5).abs() < 1e-15);
    assert_eq!(meets(DVec3::X * 4.0, DVec3::X * -1.5).touching_at, None);
    assert_eq!(meets(DVec3::new(4.0, 1.6, 0.0), DVec3::X * -9.0).touching_at, None);
    assert!(meets(DVec3::new(0.5, 0.0, 0.0), DVec3::ZERO).touches_at_start);
    // How they go on from a touch at the start: into each other, along, apart.
    for (way, cosine) in [(DVec3::X * -2.0, 1.0), (DVec3::Y, 0.0), (DVec3::new(-3.0, 4.0, 0.0), 0.6), (DVec3::X, -1.0)]
    {
        let touching = meets(DVec3::X * 1.5, way);
        assert!(touching.touches_at_start && (touching.cosine - cosine).abs() < 1e-15, "{way}: {touching:?}");
    }
}

#[test]
fn an_overlap_in_a_turn_is_seen_and_one_before_it_is_not() {
    // A stick along y that turns about z comes to a ball on its left after a quarter of a turn, less what the ball reaches.
    let (stick, ball) =
        (Solid { core: Core::Segment { half_height: 1.0 }, radius: 0.0 }, Solid { core: Core::Point, radius: 0.1 });
    let turns = |part: Option<(DVec3, DQuat)>| Place {
        position: DVec3::ZERO,
        rotation: DQuat::IDENTITY,
        part,
        displacement: DVec3::ZERO,
        spin: DVec3::Z * std::f64::consts::PI,
    };
    let still = |position: DVec3| Place { position, spin: DVec3::ZERO, ..turns(None) };
    let first = 0.5 - 0.2_f64.asin() / std::f64::consts::PI;
    let left = still(DVec3::X * -0.5);
    let seen = |end: f64| look_for_overlap([(&stick, &turns(None)), (&ball, &left)], end);
    assert!(seen(first - 1e-12).overlap_at.is_none());
    assert!(seen(first + 1e-6).overlap_at.expect("they touch") >= first);
    // As a part that lies off the middle it turns with its arm.
    let arm = turns(Some((DVec3::Y * 3.0, DQuat::IDENTITY)));
    assert!(look_for_overlap([(&stick, &arm), (&ball, &left)], 1.0).overlap_at.is_none());
    assert!(look_for_overlap([(&stick, &arm), (&ball, &still(DVec3::X * -3.0))], 0.5).overlap_at.is_some());
}
