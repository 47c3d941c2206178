//! A solid mesh answers as the body that it encloses.

mod cubes;
mod meshes;
mod whole;

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Verdict, Work},
    math::Pose,
    narrow::{
        Contacts, Faces, ImpactTouch, InitialTouch, Motion, NeedsDecomposition, Placed, Ray, distance, impact, overlap,
        penetration, raycast,
    },
    shape::{Geometry, MeshMode, Part, Terrain},
};
use cubes::{Cubes, Noise, SIZE};
use meshes::{CUBE, Tally, box_corners, convex, pose, ray, solid_box};
use whole::Numbers;

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

fn at(geometry: &Geometry, pose: Pose) -> Placed<'_> {
    Placed { geometry, pose }
}

fn work() -> Work {
    Work::default()
}

fn do_meet(a: Bound, b: Bound) -> bool {
    a.lower <= b.upper && b.lower <= a.upper
}

/// The two answers to one question may not contradict each other.
fn agree(a: Verdict, b: Verdict) -> bool {
    a == b || a == Verdict::Undecided || b == Verdict::Undecided
}

#[test]
fn a_solid_box_overlaps_and_is_as_far_as_a_box() {
    let mut numbers = Numbers::new(101);
    let mut tally = Tally::default();
    for round in 0..3_000 {
        let scale = [1.0, 1e-6, 1e6][round % 7 % 3];
        let half = (numbers.shares().abs() + 0.05) * scale;
        let (mesh, body) = (solid_box(half), Geometry::cuboid(half).expect("a box"));
        let far = [1.0, 1e3, 1e6][round % 3] * scale;
        let place = numbers.shares() * far;
        let here = pose(&mut numbers, place, round % 4 != 0);
        let there = here.position + numbers.shares() * 1.5 * scale;
        let there = pose(&mut numbers, there, round % 5 != 0);
        // Another form, or another solid box, which may hold the first one.
        let other = if round % 3 == 0 {
            solid_box((numbers.shares().abs() * 2.0 + 0.05) * scale)
        } else {
            convex(&mut numbers).scaled(scale).expect("a form")
        };
        let (other, mesh, body) = (at(&other, there), at(&mesh, here), at(&body, here));
        let context = || format!("round {round}: {other:?} {mesh:?}");

        let (found, expected) = (overlap(other, mesh, &EXACT, &mut work()), overlap(other, body, &EXACT, &mut work()));
        assert!(agree(found.verdict, expected.verdict), "{found:?} {expected:?} {}", context());
        assert_eq!(overlap(mesh, other, &EXACT, &mut work()), found, "{}", context());
        tally.count(found.verdict);

        let apart = |target, limit| distance(other, target, limit, &EXACT, &mut work());
        let (found, expected) =
            (apart(mesh, f64::INFINITY).expect("no limit"), apart(body, f64::INFINITY).expect("no limit"));
        assert!(do_meet(found.certificate.bound, expected.certificate.bound), "{found:?} {expected:?} {}", context());
        assert!((found.distance - expected.distance).abs() < 1e-12 * far, "{found:?} {expected:?} {}", context());
        let back = distance(mesh, other, f64::INFINITY, &EXACT, &mut work()).expect("no limit");
        assert_eq!((back.certificate, back.point_on_a), (found.certificate, found.point_on_b), "{}", context());
        let short = expected.distance * 0.999 - 1e-9 * scale;
        assert_eq!(apart(mesh, short.max(0.0)).is_none(), expected.distance > 1e-6 * scale, "{}", context());
    }
    assert!(tally.is_balanced(), "{tally:?}");
}

#[test]
fn a_solid_box_is_hit_as_a_box() {
    let mut numbers = Numbers::new(103);
    let (mut tally, mut within) = (Tally::default(), 0);
    for round in 0..3_000 {
        let half = numbers.shares().abs() + 0.05;
        let (mesh, body) = (solid_box(half), Geometry::cuboid(half).expect("a box"));
        let place = numbers.shares() * [1.0, 1e3, 1e6][round % 3];
        let here = pose(&mut numbers, place, round % 4 != 0);
        let away = numbers.shares() * 1.5;
        let there = pose(&mut numbers, here.position + away, round % 5 != 0);
        let other = convex(&mut numbers);
        let turn = |turns: bool, vector: DVec3| if turns { vector * 3.0 } else { DVec3::ZERO };
        let motion = Motion {
            displacement_a: numbers.shares() * 1.5 - away,
            displacement_b: numbers.shares() * 0.5,
            rotation_a: turn(round % 6 > 3, numbers.shares()),
            rotation_b: turn(round % 6 > 4, numbers.shares()),
            initial: if round % 2 == 0 { InitialTouch::Counts } else { InitialTouch::IsIgnored },
        };
        let ask = |target: &Geometry| impact(at(&other, there), at(target, here), &motion, &EXACT, &mut work());
        let (found, expected) = (ask(&mesh), ask(&body));
        let touches = |target: &Geometry| overlap(at(&other, there), at(target, here), &EXACT, &mut work()).verdict;
        if motion.initial == InitialTouch::IsIgnored && touches(&body) != Verdict::Miss {
            // Triangles are ignored one by one; what lies clear of all of them meets none from inside.
            let corners = box_corners(half);
            let walls = Geometry::mesh(&corners, &CUBE).expect("walls");
            let is_free = touches(&walls) == Verdict::Miss && !motion.turns();
            within += u32::from(is_free);
            assert!(!is_free || found.is_none(), "round {round}: {found:?}");
            continue;
        }
        check_touch(found, expected, &|| {
            format!("round {round}: {other:?} at {there:?}, {half:?} at {here:?}, {motion:?}")
        });
        tally.count(found.map_or(Verdict::Miss, |touch| touch.certificate.verdict));
        let swapped = Motion {
            displacement_a: motion.displacement_b,
            displacement_b: motion.displacement_a,
            rotation_a: motion.rotation_b,
            rotation_b: motion.rotation_a,
            ..motion
        };
        let back = impact(at(&mesh, here), at(&other, there), &swapped, &EXACT, &mut work());
        assert_eq!(back.map(|touch| touch.certificate), found.map(|touch| touch.certificate), "round {round}");
    }
    assert!(tally.is_balanced() && within > 8, "{tally:?}, {within} begin inside");
}

fn check_touch(found: Option<ImpactTouch>, expected: Option<ImpactTouch>, context: &dyn Fn() -> String) {
    let both = || format!("{found:?}\n{expected:?}\n{}", context());
    assert_eq!(found.is_some(), expected.is_some(), "{}", both());
    let (Some(touch), Some(known)) = (found, expected) else { return };
    assert_eq!(touch.certificate.verdict, known.certificate.verdict, "{}", both());
    assert_eq!(touch.initial, known.initial, "{}", both());
    assert!(do_meet(touch.certificate.bound, known.certificate.bound), "{}", both());
    assert!((touch.fraction - known.fraction).abs() < 1e-9, "{}", both());
    assert_eq!(touch.normal_b_to_a.is_some(), known.normal_b_to_a.is_some(), "{}", both());
}

/// A body of cubes as one solid mesh, and each of its cubes.
fn body_of_cubes(noise: &mut Noise) -> (Geometry, Vec<DVec3>) {
    let cubes = Cubes::random(noise);
    let (vertices, triangles) = cubes.surface();
    let solid = Geometry::mesh_as(MeshMode::Solid, &vertices, &triangles).expect("a body");
    let cells = (0..SIZE * SIZE * SIZE).map(|index| [index % SIZE, index / SIZE % SIZE, index / SIZE / SIZE]);
    let centers =
        cells.filter(|&cell| cubes.is_filled(cell)).map(|cell| DVec3::from(cell.map(|index| index as f64 + 0.5)));
    (solid, centers.collect())
}

/// Many cubes meet in an edge or a corner only, and there are caves. Where forms touch within rounding, either may be open.
#[test]
fn a_solid_of_cubes_answers_as_its_cubes_do() {
    let (mut noise, mut numbers) = (Noise(0x2545_F491_4F6C_DD1D), Numbers::new(109));
    let (mut tally, mut rays) = (Tally::default(), Tally::default());
    let cube = Geometry::cuboid(DVec3::splat(0.5)).expect("a cube");
    for round in 0..40 {
        let (solid, centers) = body_of_cubes(&mut noise);
        let place = numbers.shares() * [1.0, 1e4][round % 2];
        let here = pose(&mut numbers, place, round % 3 != 0);
        let solid = at(&solid, here);
        let cells: Vec<Placed<'_>> =
            centers.iter().map(|&center| at(&cube, Pose::new(here.transform_point(center), here.rotation))).collect();
        for _ in 0..60 {
            let middle = here.transform_point(DVec3::splat(2.0) + numbers.shares() * 3.0);
            let form = if numbers.below(4) == 0 {
                solid_box(numbers.shares().abs() + 0.05)
            } else {
                convex(&mut numbers).scaled(0.5).expect("small")
            };
            let other = at(&form, pose(&mut numbers, middle, true));
            let context = || format!("round {round}: {other:?}");
            let found = overlap(other, solid, &EXACT, &mut work());
            let is_touched =
                cells.iter().any(|&cell| overlap(other, cell, &EXACT, &mut work()).verdict == Verdict::Hit);
            assert_eq!(found.verdict == Verdict::Hit, is_touched, "{found:?} {}", context());
            tally.count(found.verdict);
            let apart =
                |target| distance(other, target, f64::INFINITY, &EXACT, &mut work()).expect("no limit").distance;
            let least = cells.iter().map(|&cell| apart(cell)).fold(f64::INFINITY, f64::min);
            assert!((apart(solid) - least).abs() < 1e-9, "{} is not {least}: {}", apart(solid), context());

            let ray = Ray { hollow: false, faces: Faces::Both, ..ray(&mut numbers, middle) };
            let found = raycast(&ray, solid, &EXACT, &mut work()).certain.map(|touch| touch.distance);
            let known = cells.iter().filter_map(|&cell| raycast(&ray, cell, &EXACT, &mut work()).certain);
            let known = known.map(|touch| touch.distance).min_by(f64::total_cmp);
            let is_same = found
                .zip(known)
                .map_or(found.is_some() == known.is_some(), |(found, known)| (found - known).abs() < 1e-9);
            assert!(is_same, "{found:?} is not {known:?}: {ray:?} {}", context());
            rays.count(if found.is_some() { Verdict::Hit } else { Verdict::Miss });

            let motion = Motion { displacement_a: numbers.shares() * 2.0, ..Motion::default() };
            let touch = impact(other, solid, &motion, &EXACT, &mut work()).map(|touch| touch.fraction);
            let known = cells.iter().filter_map(|&cell| impact(other, cell, &motion, &EXACT, &mut work()));
            let known = known.map(|touch| touch.fraction).min_by(f64::total_cmp);
            let is_same = touch
                .zip(known)
                .map_or(touch.is_some() == known.is_some(), |(touch, known)| (touch - known).abs() < 1e-9);
            assert!(is_same, "{touch:?} is not {known:?}: {motion:?} {}", context());
        }
    }
    assert!(tally.is_balanced() && rays.is_balanced(), "{tally:?} {rays:?}");
}

/// Each part of a compound holds what it holds.
#[test]
fn a_solid_part_of_a_compound_is_a_body() {
    let mut numbers = Numbers::new(137);
    let mut tally = Tally::default();
    for round in 0..600 {
        let halves = [0, 1].map(|_| numbers.shares().abs() + 0.2);
        let places = [0, 1].map(|index| pose(&mut numbers, DVec3::X * (2.0 * f64::from(index) - 1.0), round % 3 != 0));
        let of = |parts: [Geometry; 2]| {
            let parts = parts.into_iter().zip(places).map(|(geometry, pose)| Part { geometry: geometry.into(), pose });
            Geometry::compound(parts.collect()).expect("a compound")
        };
        let meshes = of(halves.map(solid_box));
        let bodies = of(halves.map(|half| Geometry::cuboid(half).expect("a box")));
        let place = numbers.shares() * [1.0, 1e6][round % 2];
        let here = pose(&mut numbers, place, round % 4 != 0);
        let form = convex(&mut numbers);
        let there = here.transform_point(numbers.shares() * DVec3::new(2.0, 1.2, 1.2));
        let other = at(&form, pose(&mut numbers, there, true));
        let ask = |target: &Geometry| overlap(other, at(target, here), &EXACT, &mut work()).verdict;
        assert!(agree(ask(&meshes), ask(&bodies)), "round {round}: {other:?} {halves:?} {places:?} {here:?}");
        tally.count(ask(&meshes));
        let apart =
            |target| distance(other, at(target, here), 1e9, &EXACT, &mut work()).expect("near").certificate.bound;
        assert!(do_meet(apart(&meshes), apart(&bodies)), "round {round}");
        let motion =
            Motion { displacement_a: numbers.shares() * 2.0, rotation_b: numbers.shares(), ..Motion::default() };
        let touch = |target| impact(other, at(target, here), &motion, &EXACT, &mut work());
        let (found, expected) = (touch(&meshes), touch(&bodies));
        if let (Some(found), Some(expected)) = (found, expected) {
            assert!(
                do_meet(found.certificate.bound, expected.certificate.bound),
                "round {round}: {found:?} {expected:?}"
            );
        }
        assert_eq!(found.is_some(), expected.is_some(), "round {round}");
    }
    assert!(tally.is_balanced(), "{tally:?}");
}

/// Depth is told by the faces that are touched from outside; what has its middle in the solid needs convex parts.
#[test]
fn a_solid_is_touched_from_outside() {
    let mut numbers = Numbers::new(113);
    let (mut contacts, mut deep) = (0, 0);
    for round in 0..2_000 {
        let half = numbers.shares().abs() + 0.3;
        let (mesh, body) = (solid_box(half), Geometry::cuboid(half).expect("a box"));
        let place = numbers.shares() * 10.0;
        let here = pose(&mut numbers, place, round % 4 != 0);
        let there = here.position + numbers.shares() * 1.5;
        let other = convex(&mut numbers);
        let other = at(&other, pose(&mut numbers, there, true));
        let context = || format!("round {round}: {other:?} {half:?} {here:?}");
        let expected = penetration(other, at(&body, here), 0.0, &EXACT, &mut work()).expect("convex");
        match penetration(other, at(&mesh, here), 0.0, &EXACT, &mut work()) {
            Err(NeedsDecomposition) => {
                deep += 1;
                assert!(!expected.is_empty(), "{}", context());
            }
            Ok(found) => {
                assert_eq!(found.is_empty(), expected.is_empty(), "{}", context());
                for contact in &found {
                    contacts += 1;
                    let normal = here.matrix().transpose() * contact.normal_b_to_a;
                    let face = CUBE[contact.feature_b.face.expect("a face") as usize];
                    let corner = |k: usize| {
                        half * DVec3::from(
                            [face[k] & 1, face[k] >> 1 & 1, face[k] >> 2].map(|bit| 2.0 * f64::from(bit) - 1.0),
                        )
                    };
                    let front = (corner(1) - corner(0)).cross(corner(2) - corner(0));
                    assert!(normal.dot(front) >= -1e-5 * front.length(), "{contact:?} {}", context());
                    // A way out of the box is a way out of its face, so it is no shorter.
                    assert!(
                        contact.depth <= expected[0].depth.max(0.0) + 4.0 && contact.depth >= -1e-12,
                        "{contact:?}"
                    );
                }
                assert_same_contacts(
                    &found,
                    &penetration(at(&mesh, here), other, 0.0, &EXACT, &mut work()).expect("as well"),
                );
            }
        }
    }
    assert!(contacts > 500 && deep > 300, "{contacts} contacts, {deep} deep");
}

fn assert_same_contacts(found: &Contacts, swapped: &Contacts) {
    assert_eq!(found.len(), swapped.len());
    for (a, b) in found.iter().zip(swapped) {
        assert_eq!((a.normal_b_to_a, a.certificate), (-b.normal_b_to_a, b.certificate));
        assert_eq!((a.feature_b, a.points[0].point_on_a), (b.feature_a, b.points[0].point_on_b));
    }
}

/// A rod that goes through an edge of a body's surface, to within rounding, has no volume in common with the triangles there:
/// they prove no touch, and how deep the rod lies in the body they do not tell.
#[test]
fn a_rod_through_an_edge_of_a_body_is_bounded_as_by_the_body() {
    let mut numbers = Numbers::new(617);
    let mut deep = [0; 2];
    for round in 0..400 {
        // A terrain is a box that is as deep as it is wide.
        let half = DVec3::splat(0.5 + 0.5 * numbers.share().abs());
        let spacing = half * 2.0;
        let terrain = Geometry::height_field(&Terrain { columns: 2, rows: 2, heights: &[0.0; 4], spacing, holes: &[] });
        let (terrain, mesh) = (terrain.expect("a terrain"), solid_box(half));
        let body = Geometry::cuboid(half).expect("a box");
        let place = numbers.shares() * [0.0, 9.0, 1e3][round % 3];
        let here = pose(&mut numbers, place, round % 4 != 0);
        let of_terrain = Pose::new(here.transform_point(DVec3::new(-half.x, half.y, -half.z)), here.rotation);
        let through = here.transform_point(half * DVec3::new(0.9 * numbers.share(), 1.0, 1.0));
        // The first end, and the middle, are outside.
        let outwards = numbers.shares() + DVec3::new(0.0, 1.5, 1.5);
        let (length, turn) = (0.2 + numbers.share().abs(), DQuat::from_rotation_arc(DVec3::Y, outwards.normalize()));
        let rod = if round % 2 == 0 {
            Geometry::capsule(length, 0.0)
        } else {
            Geometry::hull(&[DVec3::Y * length, DVec3::Y * -length])
        };
        let rod = rod.expect("a rod");
        let turn = here.rotation.normalize() * turn;
        let rod = at(&rod, Pose::new(through + turn * DVec3::Y * (0.5 * length), turn));
        let ask = |body: Placed<'_>| overlap(rod, body, &EXACT, &mut work());
        let known = ask(at(&body, here));
        for (body, deep) in [at(&mesh, here), at(&terrain, of_terrain)].into_iter().zip(&mut deep) {
            let found = ask(body);
            assert!(agree(found.verdict, known.verdict), "round {round}: {found:?} {known:?}");
            // The place of the terrain is rounded.
            let found_wide = Bound::new(found.bound.lower - 1e-11, found.bound.upper + 1e-11);
            assert!(do_meet(found_wide, known.bound), "round {round}: {found:?} {known:?}");
            *deep += u32::from(found.verdict == Verdict::Undecided && known.bound.upper < -0.01);
        }
    }
    assert!(deep.iter().all(|&deep| deep > 60), "{deep:?} of 400 are open and deep");
}
