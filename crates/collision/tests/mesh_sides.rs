//! Modes of meshes: what a one-sided one feels, how rays meet each, what is no body, and that they are told apart.

mod meshes;
mod whole;

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Verdict, Work},
    math::Pose,
    narrow::{Faces, ImpactTouch, Motion, Placed, Ray, RayTouches, distance, impact, overlap, penetration, raycast},
    shape::{Form, Geometry, GeometryError, MeshMode, SolidFault},
};
use meshes::{CUBE, Tally, box_corners, convex, pose, ray, solid_box};
use whole::Numbers;

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

fn at(geometry: &Geometry, pose: Pose) -> Placed<'_> {
    Placed { geometry, pose }
}

fn work() -> Work {
    Work::default()
}

#[test]
fn a_solid_box_stops_rays_as_a_box() {
    let mut numbers = Numbers::new(107);
    let (mut tally, mut inside) = (Tally::default(), 0);
    for round in 0..10_000 {
        let half = numbers.shares().abs() + 0.05;
        let (mesh, body) = (solid_box(half), Geometry::cuboid(half).expect("a box"));
        let place = numbers.shares() * [1.0, 1e3, 1e6][round % 3];
        let here = pose(&mut numbers, place, round % 4 != 0);
        let ray = ray(&mut numbers, here.position);
        let ask = |target: &Geometry| raycast(&ray, at(target, here), &EXACT, &mut work());
        let (RayTouches { certain: found, undecided }, expected) = (ask(&mesh), ask(&body).certain);
        let context =
            || format!("round {round}: {ray:?} at {half:?} at {here:?}:\n{found:?}\n{expected:?}\n{undecided:?}");
        assert_eq!(found.is_some(), expected.is_some(), "{}", context());
        tally.count(if found.is_some() { Verdict::Hit } else { Verdict::Miss });
        if let (Some(touch), Some(known)) = (found, expected) {
            assert!(
                touch.certificate.bound.lower <= known.certificate.bound.upper
                    && known.certificate.bound.lower <= touch.certificate.bound.upper,
                "{}",
                context()
            );
            assert_eq!((touch.inside, touch.normal.is_some()), (known.inside, known.normal.is_some()), "{}", context());
            inside += u32::from(touch.inside);
        }
    }
    assert!(tally.is_balanced() && inside > 150, "{tally:?}, {inside} begin inside");
}

/// Triangles that share no vertex, two-sided and one-sided, and each front normal.
fn fronts(numbers: &mut Numbers) -> (Geometry, Geometry, Vec<DVec3>) {
    let points: Vec<DVec3> = (0..36).map(|_| numbers.shares()).collect();
    let triangles: Vec<[u32; 3]> = (0..12).map(|first| [first, first + 12, first + 24]).collect();
    let normal = |&[a, b, c]: &[u32; 3]| {
        let corner = |vertex: u32| points[vertex as usize];
        (corner(b) - corner(a)).cross(corner(c) - corner(a)).normalize()
    };
    let of_mode = |mode| Geometry::mesh_as(mode, &points, &triangles).expect("triangles");
    (of_mode(MeshMode::TwoSided), of_mode(MeshMode::OneSided), triangles.iter().map(normal).collect())
}

#[test]
fn a_one_sided_mesh_stops_rays_with_its_fronts() {
    let mut numbers = Numbers::new(127);
    let mut tally = Tally::default();
    for round in 0..1_000 {
        let (two_sided, one_sided, _) = fronts(&mut numbers);
        let here = pose(&mut numbers, DVec3::splat(3.0), round % 4 != 0);
        let ray = ray(&mut numbers, here.position);
        let ask = |target: &Geometry, faces| raycast(&Ray { faces, ..ray }, at(target, here), &EXACT, &mut work());
        let distances = |touches: RayTouches| {
            [touches.certain, touches.undecided].map(|touch| touch.map(|touch| (touch.distance, touch.feature)))
        };
        let fronts = distances(ask(&two_sided, Faces::Front));
        assert_eq!(distances(ask(&one_sided, Faces::Both)), fronts);
        assert_eq!(distances(ask(&one_sided, Faces::Front)), fronts);
        assert_eq!(distances(ask(&one_sided, Faces::Back)), [None, None]);
        tally.count(if fronts[0].is_some() { Verdict::Hit } else { Verdict::Miss });
    }
    assert!(tally.is_balanced(), "{tally:?}");
}

/// How far a surface is and whether it is touched has no direction; what moves or pushes does so against fronts.
#[test]
fn a_one_sided_mesh_is_a_surface_that_pushes_to_its_front() {
    let mut numbers = Numbers::new(131);
    let (mut moved, mut passed, mut pushed) = (0, 0, 0);
    for round in 0..1_500 {
        let (two_sided, one_sided, fronts) = fronts(&mut numbers);
        let here = pose(&mut numbers, DVec3::splat(3.0), round % 4 != 0);
        let (both, one) = (at(&two_sided, here), at(&one_sided, here));
        let form = convex(&mut numbers);
        let away = numbers.shares() * 2.0;
        let other = at(&form, pose(&mut numbers, here.position + away, true));
        assert_eq!(overlap(other, one, &EXACT, &mut work()), overlap(other, both, &EXACT, &mut work()));
        let apart = |target| distance(other, target, 4e12, &EXACT, &mut work()).expect("no limit").certificate;
        assert_eq!(apart(one), apart(both));

        let motion = Motion { displacement_a: numbers.shares() - away, ..Motion::default() };
        let front_of = |face: Option<u32>| here.matrix() * fronts[face.expect("a face") as usize];
        let ask = |target| impact(other, target, &motion, &EXACT, &mut work());
        if let Some(touch) = ask(one) {
            moved += 1;
            let front = front_of(touch.feature_b.face);
            let first = ask(both).expect("the same surface");
            assert!(
                first.certificate.bound.lower <= touch.certificate.bound.upper,
                "{touch:?} {first:?} {motion:?} {form:?}"
            );
            if let Some(normal) = touch.normal_b_to_a {
                assert!(front.dot(normal) >= -1e-5 && front.dot(motion.displacement_a) <= 1e-5, "{touch:?}");
            }
        } else if let Some(touch) = ask(both) {
            passed += 1;
            let front = front_of(touch.feature_b.face);
            let is_from_behind = front.dot(motion.displacement_a) > 0.0
                || touch.normal_b_to_a.is_some_and(|normal| front.dot(normal) < 0.0)
                || touch.initial;
            assert!(is_from_behind, "{touch:?}");
        }
        for contact in penetration(other, one, 0.0, &EXACT, &mut work()).expect("one mesh") {
            pushed += 1;
            assert!(front_of(contact.feature_b.face).dot(contact.normal_b_to_a) >= -1e-5, "{contact:?}");
        }
    }
    assert!(moved > 300 && passed > 100 && pushed > 150, "{moved} touched, {passed} passed, {pushed} pushed");
}

/// The side from which a triangle is touched is told by the two triangles that meet: not by the normal that the other one's body
/// has where it is touched.
#[test]
fn a_one_sided_triangle_is_felt_by_a_body_as_by_the_walls_of_that() {
    let mut numbers = Numbers::new(137);
    let (mut tally, mut passed) = (Tally::default(), 0);
    for round in 0..1_500 {
        let corners = [numbers.shares(), numbers.shares(), numbers.shares()];
        let alone = |mode, corners: &[DVec3]| Geometry::mesh_as(mode, corners, &[[0, 1, 2]]).expect("a triangle");
        let (front, surface) = (alone(MeshMode::OneSided, &corners), alone(MeshMode::TwoSided, &corners));
        let half = numbers.shares().abs() + 0.05;
        let (body, points) = (solid_box(half), box_corners(half));
        let away = numbers.shares().normalize() * 3.0;
        let there = pose(&mut numbers, away, round % 4 != 0);
        let motion = Motion { displacement_a: numbers.shares() - away * 2.0, ..Motion::default() };
        let ask = |form: &Geometry, target: &Geometry| {
            let touch = impact(at(form, there), at(target, Pose::IDENTITY), &motion, &EXACT, &mut work());
            touch.map(|touch| touch.fraction)
        };
        let walls =
            CUBE.map(|wall| ask(&alone(MeshMode::TwoSided, &wall.map(|corner| points[corner as usize])), &front));
        let first = walls.into_iter().flatten().min_by(f64::total_cmp);
        let found = ask(&body, &front);
        assert_eq!(found, first, "round {round}: {motion:?}");
        passed += u32::from(found.is_none() && ask(&body, &surface).is_some());
        tally.count(if found.is_some() { Verdict::Hit } else { Verdict::Miss });
    }
    assert!(tally.is_balanced() && passed > 100, "{tally:?}, {passed} passed from behind");
}

#[test]
fn a_ball_goes_through_a_one_sided_floor_from_below_only() {
    let corners = [DVec3::new(-9.0, 0.0, -9.0), DVec3::new(9.0, 0.0, -9.0), DVec3::new(0.0, 0.0, 9.0)];
    let floor = Geometry::mesh_as(MeshMode::OneSided, &corners, &[[0, 2, 1]]).expect("a floor");
    let ball = Geometry::sphere(0.5).expect("a ball");
    let moved = |from: f64, way: f64, turn: f64| {
        let motion = Motion { displacement_a: DVec3::Y * way, rotation_b: DVec3::Y * turn, ..Motion::default() };
        impact(at(&ball, Pose::at(DVec3::Y * from)), at(&floor, Pose::IDENTITY), &motion, &EXACT, &mut work())
    };
    for turn in [0.0, 1.0] {
        let touch = moved(2.0, -4.0, turn).expect("from above");
        assert!((touch.fraction - 0.375).abs() < 1e-9 && touch.normal_b_to_a == Some(DVec3::Y), "{touch:?}");
        assert!(moved(-2.0, 4.0, turn).is_none(), "from below");
        assert!(moved(0.3, 0.1, turn).expect("it begins in it").initial);
        assert!(moved(-0.3, -0.1, turn).is_none(), "its middle is below");
    }
    let contacts = |height: f64| {
        penetration(at(&ball, Pose::at(DVec3::Y * height)), at(&floor, Pose::IDENTITY), 0.0, &EXACT, &mut work())
            .expect("one mesh")
    };
    let [contact] = contacts(0.3).to_vec().try_into().expect("one contact");
    assert!((contact.depth - 0.2).abs() < 1e-15 && contact.normal_b_to_a == DVec3::Y);
    assert!(contacts(-0.3).is_empty());
}

#[test]
fn what_is_no_body_is_refused_by_name() {
    let corners: Vec<DVec3> = (0..8).map(|i: u32| DVec3::from([i & 1, i >> 1 & 1, i >> 2].map(f64::from))).collect();
    let solid = |triangles: &[[u32; 3]]| Geometry::mesh_as(MeshMode::Solid, &corners, triangles);
    let fault = |triangles: &[[u32; 3]]| match solid(triangles) {
        Err(GeometryError::NotSolid { field, fault }) if field == "indices" => fault,
        other => panic!("{other:?}"),
    };
    assert!(solid(&CUBE).is_ok());
    // A triangle without area is left out, and the others keep their numbers.
    let mut open = CUBE.to_vec();
    open[0] = [0, 0, 1];
    let SolidFault::OpenEdge { vertices, triangle } = fault(&open) else { panic!("{}", fault(&open)) };
    let is_of = |triangle: u32| vertices.iter().all(|vertex| CUBE[triangle as usize].contains(vertex));
    assert!(is_of(0) && is_of(triangle), "{vertices:?} of {triangle}");
    let mut uneven = CUBE;
    uneven[7].swap(0, 1);
    let SolidFault::UnevenEdge { vertices, .. } = fault(&uneven) else { panic!("{}", fault(&uneven)) };
    assert!(vertices.iter().all(|vertex| CUBE[7].contains(vertex)), "{vertices:?}");
    let inwards = CUBE.map(|[a, b, c]| [a, c, b]);
    assert_eq!(fault(&inwards), SolidFault::Inwards { volume: -1.0 });
    for triangles in [open, uneven.to_vec(), inwards.to_vec()] {
        for mode in [MeshMode::TwoSided, MeshMode::OneSided] {
            assert!(Geometry::mesh_as(mode, &corners, &triangles).is_ok());
        }
    }
    // So small that its corners become one.
    assert!(solid(&CUBE).expect("a cube").scaled(1e-320).is_err());
}

#[test]
fn a_mode_is_part_of_the_content() {
    let corners: Vec<DVec3> = (0..8).map(|i: u32| DVec3::from([i & 1, i >> 1 & 1, i >> 2].map(f64::from))).collect();
    let id = |mode| Geometry::mesh_as(mode, &corners, &CUBE).expect("a cube").id();
    let [two_sided, one_sided, solid] = [MeshMode::TwoSided, MeshMode::OneSided, MeshMode::Solid].map(id);
    assert_eq!(Geometry::mesh(&corners, &CUBE).expect("a cube").id(), two_sided);
    assert!(two_sided != one_sided && one_sided != solid && solid != two_sided);
    let halved = Geometry::mesh_as(MeshMode::Solid, &corners, &CUBE).and_then(|cube| cube.scaled(0.5)).expect("a cube");
    let inner = at(&halved, Pose::IDENTITY);
    let point = Geometry::point();
    assert_eq!(overlap(inner, at(&point, Pose::at(DVec3::splat(0.25))), &EXACT, &mut work()).verdict, Verdict::Hit);
}

/// A half space is a box that is large enough: in motion, turning or not, at the start, and in contact.
#[test]
fn a_half_space_meets_the_fronts_that_a_large_box_meets() {
    let mut numbers = Numbers::new(149);
    let half = 1e4;
    let large = Geometry::cuboid(DVec3::splat(half)).expect("a box");
    let space = Geometry::half_space(DVec3::Y, half).expect("a half space");
    let mut tally = [Tally::default(), Tally::default()];
    let (mut initial, mut touching) = (0, 0);
    for round in 0..1_000 {
        let (_, one_sided, fronts) = fronts(&mut numbers);
        let Form::Mesh(mesh) = one_sided.form() else { panic!("a mesh") };
        let here = {
            let height = DVec3::Y * (1.8 + 1.5 * numbers.share());
            let place = pose(&mut numbers, DVec3::ZERO, true);
            Pose::new(height, place.rotation)
        };
        let floor = Pose::at(DVec3::Y * -half);
        // Turns of the surface alone: a point of the box far out would go far.
        let turn = if round % 3 == 0 { numbers.shares() } else { DVec3::ZERO };
        let motion = Motion {
            displacement_a: numbers.shares() - DVec3::Y * 0.5,
            rotation_a: turn,
            displacement_b: numbers.shares(),
            ..Motion::default()
        };
        let ask = |other| impact(at(&one_sided, here), at(other, floor), &motion, &EXACT, &mut work());
        let (found, known) = (ask(&space), ask(&large));
        let context = || format!("round {round}: {found:?}\n{known:?}\n{here:?} {motion:?}");
        // What the box undoes by its size, the plane knows.
        assert_eq!(found.is_some(), known.is_some(), "{}", context());
        tally[usize::from(motion.turns())].count(if found.is_some() { Verdict::Hit } else { Verdict::Miss });
        if let (Some(found), Some(known)) = (&found, &known) {
            assert_eq!(found.initial, known.initial, "{}", context());
            assert!((found.fraction - known.fraction).abs() < 1e-7, "{}", context());
            initial += u32::from(found.initial);
        }
        let contacts =
            penetration(at(&one_sided, here), at(&space, floor), 0.0, &EXACT, &mut work()).expect("one mesh");
        let told: Vec<u32> = contacts.iter().filter_map(|contact| contact.feature_a.face).collect();
        let corners_of = |face: usize| mesh.corners(face).map(|corner| here.transform_point(corner));
        let below = |face: &usize| {
            corners_of(*face).into_iter().any(|corner| corner.y < 0.0) && (here.matrix() * fronts[*face]).y < 0.0
        };
        let expected: Vec<u32> = (0..12).filter(below).map(|face| face as u32).collect();
        assert_eq!(told, expected, "{}", context());
        touching += told.len();
    }
    assert!(tally.iter().all(Tally::is_balanced), "{tally:?}");
    assert!(initial > 100 && touching > 300, "{initial} begin in it, {touching} contacts");
}

/// A surface with its fronts down stays on a floor, one with them up sinks through, and of a body the bottom is touched.
#[test]
fn a_sheet_falls_through_a_half_space_that_comes_to_its_back() {
    let corners = [DVec3::new(-9.0, 0.0, -9.0), DVec3::new(9.0, 0.0, -9.0), DVec3::new(0.0, 0.0, 9.0)];
    let floor = Geometry::half_space(DVec3::Y, 0.0).expect("a half space");
    let fallen = |sheet: &Geometry, from: f64, turn: f64| {
        let motion = Motion { displacement_a: DVec3::Y * -4.0, rotation_a: DVec3::Y * turn, ..Motion::default() };
        impact(at(sheet, Pose::at(DVec3::Y * from)), at(&floor, Pose::IDENTITY), &motion, &EXACT, &mut work())
    };
    let sheet = |mode, triangle| Geometry::mesh_as(mode, &corners, &[triangle]).expect("a sheet");
    for turn in [0.0, 1.0] {
        for (mode, triangle, is_met) in [
            (MeshMode::OneSided, [0, 1, 2], true),
            (MeshMode::OneSided, [0, 2, 1], false),
            (MeshMode::TwoSided, [0, 2, 1], true),
        ] {
            let touch = fallen(&sheet(mode, triangle), 1.0, turn);
            assert_eq!(
                touch.is_some_and(|touch| (touch.fraction - 0.25).abs() < 1e-9),
                is_met,
                "{mode:?} {triangle:?}"
            );
            let begun = fallen(&sheet(mode, triangle), -1.0, turn);
            assert_eq!(begun.is_some_and(|touch| touch.initial), is_met, "{mode:?} {triangle:?}");
        }
        let body = solid_box(DVec3::splat(0.5));
        let touch = fallen(&body, 1.0, turn).expect("it falls on its bottom");
        assert!((touch.fraction - 0.125).abs() < 1e-9, "{touch:?}");
    }
    let body = solid_box(DVec3::splat(0.5));
    let sunk = penetration(at(&body, Pose::at(DVec3::Y * -0.25)), at(&floor, Pose::IDENTITY), 0.0, &EXACT, &mut work());
    let deepest = sunk.expect("one mesh").iter().map(|contact| contact.depth).fold(0.0, f64::max);
    assert!((deepest - 0.75).abs() < 1e-12, "{deepest}");
}

/// A motion of kilometres hides in its rounding how far forms are apart at the start, and so from which side they come. That is
/// told by the touch, as in the short motion that begins the long one: not by the side that the middle of the form is on.
#[test]
fn a_long_way_does_not_change_from_which_side_a_triangle_is_met() {
    let mut numbers = Numbers::new(151);
    let (mut felt, mut passed, mut on_other_side, mut differing) = (0, 0, 0, Vec::new());
    for round in 0..2_000 {
        let corners = [0; 3].map(|_| numbers.shares());
        let triangle = Geometry::mesh_as(MeshMode::OneSided, &corners, &[[0, 1, 2]]).expect("a triangle");
        let front = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        let body = convex(&mut numbers);
        let place = numbers.shares();
        let far = pose(&mut numbers, place, true);
        let ask = |here| distance(at(&body, here), at(&triangle, Pose::IDENTITY), 9.0, &EXACT, &mut work());
        let Some((gap, normal)) = ask(far).and_then(|found| Some((found.distance, found.normal_b_to_a?))) else {
            continue;
        };
        let near = Pose::new(far.position - normal * (gap - numbers.magnitude(-12.0, -11.0)), far.rotation);
        let way = (numbers.shares() * 0.5 - normal) * 1e4;
        let turn = if round % 2 == 0 { numbers.shares() } else { DVec3::ZERO };
        let moved = |part: f64| {
            let motion = Motion { displacement_a: way * part, rotation_a: turn * part, ..Motion::default() };
            impact(at(&body, near), at(&triangle, Pose::IDENTITY), &motion, &EXACT, &mut work())
        };
        let (long, short, other) = (moved(1.0), moved(1e-12), moved(1e-10));
        // A point has no volume to prove a touch by; and where short motions differ, rounding tells the side of an edge.
        let is_open = |touch: &ImpactTouch| touch.certificate.verdict == Verdict::Undecided;
        if long.iter().chain(&short).any(is_open) || short.is_some() != other.is_some() {
            continue;
        }
        let context = || format!("round {round}: {long:?}\n{short:?}\n{body:?} at {near:?} to {way:?} of {corners:?}");
        if long.is_some() != short.is_some() {
            differing.push(context());
            continue;
        }
        let is_before = front.dot(near.position - corners[0]) > 0.0;
        on_other_side += u32::from(front.dot(way) < 0.0 && is_before != short.is_some());
        if let (Some(long), Some(short)) = (long, short) {
            assert!(!long.initial && !short.initial, "{}", context());
            assert!(long.normal_b_to_a.is_some_and(|normal| front.dot(normal) > -1e-6), "{}", context());
            felt += 1;
        } else {
            passed += 1;
        }
    }
    // An edge met along a face is one whose side the last bits of the gap tell.
    assert!(differing.len() < 3, "{} differ: {}", differing.len(), differing[0]);
    assert!(
        felt > 500 && passed > 500 && on_other_side > 50,
        "{felt} felt, {passed} passed, {on_other_side} from there"
    );
}
