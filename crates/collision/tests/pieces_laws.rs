//! Laws of meshes in pairs: questions agree with each other, swapping swaps, and a mesh answers as its triangles do.

mod whole;

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Certificate, Verdict, Work},
    math::Pose,
    narrow::{
        ImpactTouch, InitialTouch, Motion, NeedsDecomposition, Placed, Separation, distance, impact, overlap,
        penetration,
    },
    shape::Geometry,
};
use glam::Vec3Swizzles as _;
use whole::{Numbers, to_f64, turned};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

fn at(geometry: &Geometry, pose: Pose) -> Placed<'_> {
    Placed { geometry, pose }
}

/// From −1 to 1.
fn share(numbers: &mut Numbers) -> f64 {
    numbers.within(1 << 40) as f64 / (1_u64 << 40) as f64
}

fn vector(numbers: &mut Numbers) -> DVec3 {
    DVec3::new(share(numbers), share(numbers), share(numbers))
}

fn pose(numbers: &mut Numbers, far: f64) -> Pose {
    let [x, y, z, w] = [0; 4].map(|_| share(numbers));
    Pose::new(vector(numbers) * far, DQuat::from_xyzw(x, y, z, w))
}

/// A soup of triangles within the unit cube, and each of them alone.
fn soup(numbers: &mut Numbers) -> (Geometry, Vec<Geometry>) {
    let points: Vec<DVec3> = (0..30).map(|_| vector(numbers)).collect();
    let triangles: Vec<[u32; 3]> = (0..20).map(|first| [first, first + 3, first + 10]).collect();
    let alone = triangles.iter().map(|&triangle| {
        let corners = triangle.map(|vertex| points[vertex as usize]);
        Geometry::mesh(&corners, &[[0, 1, 2]]).expect("a triangle")
    });
    (Geometry::mesh(&points, &triangles).expect("a soup"), alone.collect())
}

fn convex(numbers: &mut Numbers) -> Geometry {
    let half = (vector(numbers) * 0.3).abs() + 0.01;
    let form = match numbers.below(5) {
        0 => Geometry::sphere(half.x),
        1 => Geometry::capsule(half.x, half.y),
        2 => Geometry::cuboid(half),
        3 => Geometry::cuboid(half).and_then(|form| form.rounded(0.1)),
        _ => Geometry::hull(&[half, -half, half.zxy(), -half.yzx(), DVec3::new(0.2, -half.x, half.y)]),
    };
    form.expect("a form")
}

fn work() -> Work {
    Work::default()
}

#[test]
fn questions_about_a_form_and_a_mesh_agree_with_each_other_and_with_its_triangles() {
    let mut numbers = Numbers::new(61);
    let (mut hits, mut misses) = (0, 0);
    for round in 0..400 {
        let (soup, triangles) = soup(&mut numbers);
        let form = convex(&mut numbers);
        let far = [1.0, 1e3, 1e6][round % 3];
        let place = pose(&mut numbers, far);
        let mesh = at(&soup, place);
        let other = Pose::new(place.position + vector(&mut numbers) * 1.1, pose(&mut numbers, 1.0).rotation);
        let body = at(&form, other);
        let context = || format!("{form:?} at {other:?}, soup {round} at {place:?}");

        let (found, apart) = check_distance(body, mesh, &triangles, &context);
        let least = found.distance;
        let touching = overlap(body, mesh, &EXACT, &mut work());
        assert_eq!(touching.verdict, overlap(mesh, body, &EXACT, &mut work()).verdict, "{}", context());
        match touching.verdict {
            Verdict::Hit => {
                hits += 1;
                assert_eq!(least, 0.0, "{}", context());
            }
            Verdict::Miss => {
                misses += 1;
                assert!(least > 0.0 && found.certificate.bound.lower > 0.0, "{}", context());
                let short = distance(body, mesh, least * 0.999, &EXACT, &mut work());
                assert!(short.is_none(), "{}", context());
            }
            Verdict::Undecided => assert!(least < 1e-12 * far, "{}", context()),
        }

        check_contacts(body, mesh, &apart, &context);
    }
    assert!(hits > 120 && misses > 120, "{hits} hits, {misses} misses");
}

/// The distance to a mesh is the least of those to its triangles, and the same both ways.
fn check_distance(
    body: Placed<'_>,
    mesh: Placed<'_>,
    triangles: &[Geometry],
    context: &dyn Fn() -> String,
) -> (Separation, Vec<f64>) {
    let found = distance(body, mesh, f64::INFINITY, &EXACT, &mut work()).expect("no limit");
    let swapped = distance(mesh, body, f64::INFINITY, &EXACT, &mut work()).expect("no limit");
    assert_eq!(found.distance.to_bits(), swapped.distance.to_bits(), "{}", context());
    assert_eq!((found.point_on_a, found.feature_b), (swapped.point_on_b, swapped.feature_a), "{}", context());
    assert_eq!(found.certificate, swapped.certificate, "{}", context());
    let apart: Vec<f64> = triangles
        .iter()
        .map(|triangle| distance(body, at(triangle, mesh.pose), f64::INFINITY, &EXACT, &mut work()).expect("no limit"))
        .map(|found| found.distance)
        .collect();
    let least = apart.iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(found.distance, least, "{}", context());
    let face = found.feature_b.face.expect("a face") as usize;
    assert_eq!(apart[face], least, "{}", context());
    assert_eq!(apart.iter().position(|&distance| distance == least), Some(face), "{}", context());
    assert!(found.certificate.bound.contains(least), "{}", context());

    (found, apart)
}

/// Contacts are with all triangles that touch, and across the gap with the nearest at least: what is nearer by way of a
/// neighbour is left to that. They are the same both ways.
fn check_contacts(body: Placed<'_>, mesh: Placed<'_>, apart: &[f64], context: &dyn Fn() -> String) {
    let gap = 0.1;
    let contacts = penetration(body, mesh, gap, &EXACT, &mut work()).expect("one mesh");
    let faces: Vec<u32> = contacts.iter().filter_map(|contact| contact.feature_b.face).collect();
    let least = apart.iter().copied().fold(f64::INFINITY, f64::min);
    for (face, &apart) in (0..).zip(apart) {
        let is_there = faces.contains(&face);
        assert!(is_there || apart > 0.0 && apart > least || apart > gap, "{face}: {}", context());
        assert!(!is_there || apart <= gap, "{face}: {}", context());
    }
    assert!(faces.is_sorted());
    let swapped = penetration(mesh, body, gap, &EXACT, &mut work()).expect("one mesh");
    let swapped: Vec<u32> = swapped.iter().filter_map(|contact| contact.feature_a.face).collect();
    assert_eq!(faces, swapped, "{}", context());
}

/// Balls that touch a face of a turned box of triangles in one point, exactly: the poses are whole numbers.
#[test]
fn an_exact_touch_is_never_a_miss() {
    let mut numbers = Numbers::new(73);
    for round in 0..2_000 {
        let q = [0; 4].map(|_| numbers.within(9));
        let norm: i128 = q.iter().map(|part| part * part).sum();
        if norm == 0 {
            continue;
        }
        let half = 1_000 * norm;
        let radius = numbers.below([4, 1_000_000][round % 2]) + 1;
        let corner = |x: i128, y: i128| to_f64([x * half, y * half, half]);
        let face = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
        let mesh = Geometry::mesh(&face, &[[0, 1, 2], [0, 2, 3]]).expect("a face");
        let on_face = numbers.vector(900);
        let from_face = turned(q, [on_face[0], on_face[1], 1_000]);
        let normal = turned(q, [0, 0, 1]);
        let position = numbers.vector(1 << 40);
        let center = [0, 1, 2].map(|axis| position[axis] + from_face[axis] + radius * normal[axis]);
        let [x, y, z, w] = q.map(|part| part as f64);
        let mesh = at(&mesh, Pose::new(to_f64(position), DQuat::from_xyzw(x, y, z, w)));
        let ball = Geometry::sphere((radius * norm) as f64).expect("a ball");
        let ball = at(&ball, Pose::at(to_f64(center)));
        let context = || format!("{ball:?} and {mesh:?}");
        assert_ne!(overlap(ball, mesh, &EXACT, &mut work()).verdict, Verdict::Miss, "{}", context());
        assert_ne!(overlap(mesh, ball, &EXACT, &mut work()).verdict, Verdict::Miss, "{}", context());
        let found = distance(ball, mesh, 0.0, &EXACT, &mut work()).unwrap_or_else(|| panic!("{}", context()));
        assert_eq!(found.certificate.bound.lower, 0.0, "{}", context());
        assert!(!penetration(ball, mesh, 0.0, &EXACT, &mut work()).expect("one mesh").is_empty(), "{}", context());
    }
}

#[test]
fn two_meshes_are_as_far_apart_as_their_nearest_triangles() {
    let mut numbers = Numbers::new(67);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..100 {
        let (first, triangles) = soup(&mut numbers);
        let (second, others) = soup(&mut numbers);
        let (here, mut there) = (pose(&mut numbers, 10.0), pose(&mut numbers, 10.0));
        there.position = here.position + vector(&mut numbers) * 1.6;
        let (a, b) = (at(&first, here), at(&second, there));
        let found = distance(a, b, f64::INFINITY, &EXACT, &mut work()).expect("no limit");
        let swapped = distance(b, a, f64::INFINITY, &EXACT, &mut work()).expect("no limit");
        assert_eq!(found.distance.to_bits(), swapped.distance.to_bits());
        assert_eq!((found.feature_a, found.feature_b), (swapped.feature_b, swapped.feature_a));
        let pairs = triangles.iter().flat_map(|one| others.iter().map(move |other| (one, other)));
        let least = pairs
            .map(|(one, other)| {
                distance(at(one, here), at(other, there), f64::INFINITY, &EXACT, &mut work())
                    .expect("no limit")
                    .distance
            })
            .fold(f64::INFINITY, f64::min);
        assert!((found.distance - least).abs() <= 1e-14, "{} is not {least}", found.distance);
        let verdict = overlap(a, b, &EXACT, &mut work()).verdict;
        assert_eq!(verdict, overlap(b, a, &EXACT, &mut work()).verdict);
        hits += u32::from(verdict == Verdict::Hit && least == 0.0);
        misses += u32::from(verdict == Verdict::Miss && least > 0.0);
        assert_eq!(penetration(a, b, 0.0, &EXACT, &mut work()).err(), Some(NeedsDecomposition));
    }
    assert!(hits + misses == 100 && hits > 30 && misses > 30, "{hits} hits, {misses} misses");
}

fn motion(displacement_a: DVec3, displacement_b: DVec3, initial: InitialTouch) -> Motion {
    Motion { displacement_a, displacement_b, initial, ..Motion::default() }
}

fn is_before(touch: &Option<ImpactTouch>, certificate: &Certificate) -> bool {
    touch.as_ref().is_some_and(|touch| touch.certificate.bound.lower <= certificate.bound.upper)
}

#[test]
fn the_first_touch_of_a_mesh_is_that_of_its_first_triangle() {
    let mut numbers = Numbers::new(71);
    let mut hits = 0;
    for round in 0..300 {
        let (soup, triangles) = soup(&mut numbers);
        let form = convex(&mut numbers);
        let here = pose(&mut numbers, 10.0);
        let mut there = pose(&mut numbers, 1.0);
        let away = vector(&mut numbers) * 3.0;
        there.position = here.position + away;
        let (by_form, by_mesh) = (vector(&mut numbers) * 1.5 - away, vector(&mut numbers) * 0.5);
        let initial = if round % 3 == 0 { InitialTouch::IsIgnored } else { InitialTouch::Counts };
        // None turns, one of them does, or both.
        let turn = |turns: bool, vector: DVec3| if turns { vector * 3.0 } else { DVec3::ZERO };
        let rotation_a = turn(round % 4 > 1, vector(&mut numbers));
        let rotation_b = turn(round % 8 > 4, vector(&mut numbers));
        let there_and_turning = Motion { rotation_a, rotation_b, ..motion(by_form, by_mesh, initial) };
        let touch_of = |geometry: &Geometry| {
            let (a, b) = (at(&form, there), at(geometry, here));
            impact(a, b, &there_and_turning, &EXACT, &mut work())
        };
        let alone: Vec<Option<ImpactTouch>> = triangles.iter().map(touch_of).collect();
        let whole = touch_of(&soup);
        let earliest = alone.iter().flatten().map(|touch| touch.fraction).fold(f64::INFINITY, f64::min);
        let Some(touch) = whole else {
            assert!(alone.iter().all(Option::is_none), "round {round}: {alone:?}");
            continue;
        };
        hits += 1;
        assert_eq!(touch.certificate.verdict, Verdict::Hit, "round {round}: {touch:?}");
        assert_eq!(touch.fraction, earliest, "round {round}");
        assert!(is_before(&alone[touch.feature_b.face.expect("a face") as usize], &touch.certificate));
        let back = Motion { rotation_a: rotation_b, rotation_b: rotation_a, ..motion(by_mesh, by_form, initial) };
        let swapped = impact(at(&soup, here), at(&form, there), &back, &EXACT, &mut work());
        let swapped = swapped.expect("as the other way round");
        assert_eq!(swapped.fraction.to_bits(), touch.fraction.to_bits(), "round {round}");
        assert_eq!(swapped.certificate.bound, touch.certificate.bound, "round {round}");
        let rest = motion(DVec3::ZERO, DVec3::ZERO, InitialTouch::Counts);
        let resting = impact(at(&form, there), at(&soup, here), &rest, &EXACT, &mut work());
        let touching = overlap(at(&form, there), at(&soup, here), &EXACT, &mut work()).verdict;
        assert_eq!(resting.is_some(), touching == Verdict::Hit, "round {round}");
    }
    assert!((90..=210).contains(&hits), "{hits} hits");
}

/// Found by a random search: of two meshes with as many triangles, the first was looked through first.
#[test]
fn swapping_two_meshes_swaps_nothing_in_the_answer() {
    let corner = |i: u32| DVec3::from([i & 1, i >> 1 & 1, i >> 2].map(f64::from));
    let fan: Vec<[u32; 3]> = (2..8).map(|last| [0, last - 1, last]).collect();
    let vertices: Vec<DVec3> = (0..8).map(|i| corner(i) + DVec3::splat(f64::from(i)) * 0.1).collect();
    let mesh = Geometry::mesh(&vertices, &fan).expect("a mesh");
    for way in [DVec3::Y * 0.25, DVec3::new(0.3, -0.2, 0.1), DVec3::ONE] {
        let (a, b) = (Pose::IDENTITY, Pose::at(way));
        let [a, b] = [a, b].map(|pose| Placed { geometry: &mesh, pose });
        let ask = |a: Placed<'_>, b: Placed<'_>| overlap(a, b, &Accuracy::default(), &mut Work::default());
        assert_eq!(ask(a, b), ask(b, a));
    }
}
