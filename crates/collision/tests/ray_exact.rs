//! Rays compared with exact arithmetic: whole numbers in, turned by whole quaternions, answers as fractions of i128.
//!
//! A verdict must never contradict the exact answer, every interval must hold it, and undecided answers must be rare.

mod whole;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::Work,
    math::Pose,
    narrow::{Faces, Placed, Ray, raycast},
    shape::Geometry,
};
use whole::{
    Fraction, Numbers, V3,
    scene::{Scene, Tally},
    to_f64, turned_back,
};

#[test]
fn balls() {
    let mut numbers = Numbers::new(11);
    let mut tally = Tally::default();
    for _ in 0..20_000 {
        let radius = numbers.below(1000) + 1;
        let scene = Scene::random(&mut numbers, radius + radius / 4 + 1);
        let ball = Geometry::sphere(radius as f64 * scene.scale).expect("a ball");
        let from = [0, 1, 2].map(|axis| scene.origin[axis] - scene.position[axis]);
        let (half_b, a) = (whole::dot(from, scene.direction), whole::dot(scene.direction, scene.direction));
        let c = whole::dot(from, from) - radius * radius;
        let discriminant = half_b * half_b - a * c;
        let root = (discriminant as f64).sqrt();
        let truth = match () {
            () if c <= 0 => Some(0.0),
            () if discriminant < 0 || half_b > 0 => None,
            () => Some(scene.metres(c as f64 / (root - half_b as f64))),
        };
        tally.take(&scene, scene.cast(&ball, false), truth, radius as f64);
        let wall = match () {
            () if discriminant < 0 || (half_b > 0 && c > 0) => None,
            () if c > 0 => truth,
            () if half_b > 0 => Some(scene.metres(-c as f64 / (root + half_b as f64))),
            () => Some(scene.metres((root - half_b as f64) / a as f64)),
        };
        if c != 0 {
            let mut hollow = Tally::default();
            hollow.take(&scene, scene.cast(&ball, true), wall, radius as f64);
        }
    }
    tally.is_not_vacuous();
}

/// The stretch of a ray in a box, exactly.
fn box_stretch(scene: &Scene, half: V3) -> Option<(Fraction, Fraction)> {
    let from = [0, 1, 2].map(|axis| scene.origin[axis] - scene.position[axis]);
    let norm = scene.rotation.iter().map(|part| part * part).sum::<i128>();
    let (origin, direction) = (turned_back(scene.rotation, from), turned_back(scene.rotation, scene.direction));
    let (mut entry, mut exit): (Option<Fraction>, Option<Fraction>) = (None, None);
    for axis in 0..3 {
        let wall = half[axis] * norm;
        if direction[axis] == 0 {
            if origin[axis].abs() > wall {
                return None;
            }
            continue;
        }
        let sign = direction[axis].signum();
        let speed = direction[axis].abs();
        let a = Fraction::new(-wall - sign * origin[axis], speed);
        let b = Fraction::new(wall - sign * origin[axis], speed);
        entry = Some(entry.map_or(a, |known| known.max(a)));
        exit = Some(exit.map_or(b, |known| known.min(b)));
    }
    let (entry, exit) = (entry?, exit?);
    (entry <= exit && exit >= Fraction::new(0, 1)).then_some((entry, exit))
}

fn corners(half: V3, scale: f64) -> Vec<DVec3> {
    let corner = |bits: i128| [0, 1, 2].map(|axis| if bits >> axis & 1 == 0 { -half[axis] } else { half[axis] });
    (0..8).map(|bits| to_f64(corner(bits)) * scale).collect()
}

/// The twelve triangles of a box by corner, wound both ways.
const FACES: [[u32; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 4, 5],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
];

#[test]
fn boxes_their_hulls_and_their_meshes() {
    let mut numbers = Numbers::new(5);
    let mut tallies: [Tally; 4] = Default::default();
    for _ in 0..10_000 {
        let half = [0; 3].map(|_| numbers.below(1000) + 1);
        let scene = Scene::random(&mut numbers, 600);
        let points = corners(half, scene.scale);
        let cuboid = Geometry::cuboid(points[7]).expect("a box");
        let hull = Geometry::hull(&points).expect("a hull");
        let mesh = Geometry::mesh(&points, &FACES).expect("a mesh");
        let stretch = box_stretch(&scene, half);
        let first = stretch.map(|(entry, _)| scene.metres(entry.to_f64().max(0.0)));
        let zero = Fraction::new(0, 1);
        let wall = stretch.map(|(entry, exit)| scene.metres(if entry >= zero { entry } else { exit }.to_f64()));
        let reach = points[7].length() / scene.scale;
        tallies[0].take(&scene, scene.cast(&cuboid, false), first, reach);
        tallies[1].take(&scene, scene.cast(&hull, false), first, reach);
        tallies[2].take(&scene, scene.cast(&hull, true), wall, reach);
        tallies[3].take(&scene, scene.cast(&mesh, false), wall, reach);
    }
    tallies.iter().for_each(Tally::is_not_vacuous);
}

/// The stretch of a ray in the hull of points, exactly: all planes through three points that have none beyond them.
fn hull_stretch(scene: &Scene, points: &[V3]) -> Option<(Fraction, Fraction)> {
    let from = [0, 1, 2].map(|axis| scene.origin[axis] - scene.position[axis]);
    let norm = scene.rotation.iter().map(|part| part * part).sum::<i128>();
    let (origin, direction) = (turned_back(scene.rotation, from), turned_back(scene.rotation, scene.direction));
    let (mut entry, mut exit) = (Fraction::new(-1 << 60, 1), Fraction::new(1 << 60, 1));
    for (i, &a) in points.iter().enumerate() {
        for (j, &b) in points.iter().enumerate().skip(i + 1) {
            for &c in &points[j + 1..] {
                let normal = whole::cross(whole::minus(b, a), whole::minus(c, a));
                let sides = points.iter().map(|&point| whole::dot(normal, whole::minus(point, a)).signum());
                let (above, below) = (sides.clone().any(|side| side > 0), sides.clone().any(|side| side < 0));
                if above == below {
                    continue;
                }
                let normal = if above { normal.map(|part| -part) } else { normal };
                let gap = whole::dot(normal, a) * norm - whole::dot(normal, origin);
                match whole::dot(normal, direction) {
                    0 if gap < 0 => return None,
                    0 => {}
                    speed if speed > 0 => exit = exit.min(Fraction::new(gap, speed)),
                    speed => entry = entry.max(Fraction::new(-gap, -speed)),
                }
            }
        }
    }
    (entry <= exit && exit >= Fraction::new(0, 1)).then_some((entry, exit))
}

#[test]
fn hulls_down_to_slivers() {
    let mut numbers = Numbers::new(29);
    let mut tallies: [Tally; 2] = Default::default();
    for round in 0..4_000 {
        let thickness = [1, 30, 30_000][round % 3];
        let mut points: Vec<V3> = (0..9).map(|_| numbers.vector(30_000)).collect();
        points.iter_mut().for_each(|point| point[2] = numbers.within(thickness));
        // A lone tip near an edge makes faces whose corners lie almost on a line.
        points.push([0, 1, 2].map(|axis| (points[0][axis] + points[1][axis]) / 2 + numbers.within(1)));
        let mut scene = Scene::random(&mut numbers, 10_000);
        let away = numbers.vector(500_000);
        scene.position = numbers.vector(1 << 20);
        scene.origin = [0, 1, 2].map(|axis| scene.position[axis] + away[axis]);
        scene.scale = scene.scale.min(1.0);
        let aim = whole::turned(scene.rotation, points[9].map(|part| part / 2));
        let norm = scene.rotation.iter().map(|part| part * part).sum::<i128>();
        scene.direction = [0, 1, 2].map(|axis| aim[axis] / norm + numbers.within(24_000) - away[axis]);
        let stretch = hull_stretch(&scene, &points);
        let first = stretch.map(|(entry, _)| scene.metres(entry.to_f64().max(0.0)));
        let zero = Fraction::new(0, 1);
        let wall = stretch.map(|(entry, exit)| scene.metres(if entry >= zero { entry } else { exit }.to_f64()));
        let hull: Vec<DVec3> = points.iter().map(|&point| to_f64(point) * scene.scale).collect();
        let hull = Geometry::hull(&hull).expect("a hull");
        tallies[0].take(&scene, scene.cast(&hull, false), first, 60_000.0);
        tallies[1].take(&scene, scene.cast(&hull, true), wall, 60_000.0);
    }
    tallies.iter().for_each(Tally::is_not_vacuous);
}

/// Rays that come in almost along a large triangle of an unturned mesh: where they meet it, exact sums say.
#[test]
fn grazing_rays_and_slivers() {
    let mut numbers = Numbers::new(37);
    let mut tally = Tally::default();
    for round in 0..5_000 {
        let mut scene = Scene::random(&mut numbers, 1000);
        scene.rotation = [0, 0, 0, 1];
        let mut corners: [V3; 3] = [0; 3].map(|_| numbers.vector(10_000));
        if round % 2 == 0 {
            corners[2] = [0, 1, 2].map(|axis| (corners[0][axis] + 2 * corners[1][axis]) / 3 + numbers.within(2));
        }
        corners = corners.map(|corner| corner.map(|part| 3 * part));
        // Aimed from a point next to the plane at the middle of the triangle, or near it.
        let miss = if numbers.below(2) == 0 { 0 } else { 40 };
        let along = whole::minus(corners[1], corners[0]);
        let from = [0, 1, 2].map(|axis| corners[0][axis] - 20 * along[axis] + numbers.within(100));
        let middle = |axis: usize| (corners[0][axis] + corners[1][axis] + corners[2][axis]) / 3;
        let aim = [0, 1, 2].map(|axis| middle(axis) + numbers.within(miss));
        scene.origin = [0, 1, 2].map(|axis| scene.position[axis] + from[axis]);
        scene.direction = whole::minus(aim, from);
        let normal = whole::cross(along, whole::minus(corners[2], corners[0]));
        if normal == [0; 3] || scene.direction == [0; 3] {
            continue;
        }
        let sides = [0, 1, 2].map(|k| {
            let (a, b) = (whole::minus(corners[k], from), whole::minus(corners[(k + 1) % 3], from));
            whole::dot(scene.direction, whole::cross(a, b)).signum()
        });
        let speed = whole::dot(normal, scene.direction);
        let height = whole::dot(normal, whole::minus(corners[0], from));
        let is_hit = speed != 0 && height * speed >= 0 && !(sides.contains(&1) && sides.contains(&-1));
        let truth = is_hit.then(|| scene.metres(height as f64 / speed as f64));
        let points = corners.map(|corner| to_f64(corner) * scene.scale);
        let mesh = Geometry::mesh(&points, &[[0, 1, 2]]).expect("a triangle");
        tally.take(&scene, scene.cast(&mesh, false), truth, 20_000.0);
    }
    tally.is_not_vacuous();
}

#[test]
fn plates_are_hit_though_they_have_no_thickness() {
    let mut numbers = Numbers::new(17);
    let mut tallies: [Tally; 2] = Default::default();
    for _ in 0..10_000 {
        let half = [numbers.below(1000) + 1, 0, numbers.below(1000) + 1];
        let mut scene = Scene::random(&mut numbers, 400);
        scene.rotation = if scene.rotation[0] == 0 { [0, 0, 0, 1] } else { scene.rotation };
        let plate = Geometry::cuboid(to_f64(half) * scene.scale).expect("a plate");
        let flat = Geometry::hull(&corners(half, scene.scale)).expect("a flat hull");
        let truth = box_stretch(&scene, half).map(|(entry, _)| scene.metres(entry.to_f64().max(0.0)));
        let reach = to_f64(half).length();
        tallies[0].take(&scene, scene.cast(&plate, false), truth, reach);
        tallies[1].take(&scene, scene.cast(&flat, false), truth, reach);
    }
    tallies.iter().for_each(Tally::is_not_vacuous);
}

#[test]
fn rays_in_the_very_face_of_an_unturned_box_touch_it() {
    let cuboid = Geometry::cuboid(DVec3::new(0.1, 0.7, 0.3)).expect("a box");
    let target = Placed { geometry: &cuboid, pose: Pose::at(DVec3::new(0.0, 5.0, -8.0)) };
    for (x, expected) in [(0.1, true), (0.1_f64.next_up(), false), (-0.1, true), (0.1_f64.next_down(), true)] {
        let ray = Ray {
            origin: DVec3::new(x, 1e6, -8.0),
            direction: -DVec3::Y,
            min_distance: 0.0,
            max_distance: 1e18,
            hollow: false,
            faces: Faces::Both,
        };
        let touches = raycast(&ray, target, &Accuracy::default(), &mut Work::default());
        assert_eq!((touches.certain.is_some(), touches.undecided.is_some()), (expected, false), "{x}");
    }
}

/// A mesh of a box: rays at points of its diagonals and corners, where turned rays are within rounding of an edge.
#[test]
fn no_ray_slips_between_triangles_that_face_alike() {
    let mut numbers = Numbers::new(23);
    let (mut hits, mut open) = (0, 0);
    for round in 0..6_000 {
        let half = [numbers.below(1000) + 1, numbers.below(1000) + 1, 500];
        let mut scene = Scene::random(&mut numbers, 10);
        let norm = scene.rotation.iter().map(|part| part * part).sum::<i128>();
        // Corners 4 to 7 are the face z = 500, its diagonal goes from 4 to 7. The aim is a point of it, and the ray
        // comes from above, all multiplied by the norm, so that the turned point is whole.
        let share = if round % 2 == 0 { 0 } else { numbers.below(1001) };
        let local = [-half[0] * (1000 - 2 * share), -half[1] * (1000 - 2 * share), half[2] * 1000];
        let from = [local[0] + numbers.within(400_000), local[1] + numbers.within(400_000), 900_000];
        let (aim, from) = (whole::turned(scene.rotation, local), whole::turned(scene.rotation, from));
        scene.position = [0; 3];
        scene.origin = from;
        scene.direction = [0, 1, 2].map(|axis| aim[axis] - from[axis]);
        scene.scale = 1.0;
        let points: Vec<DVec3> = corners(half, 1000.0 * norm as f64);
        let mesh = Geometry::mesh(&points, &FACES).expect("a mesh");
        let touches = scene.cast(&mesh, false);
        let is_inner = share > 0 && share < 1000;
        if let Some(touch) = touches.certain {
            hits += 1;
            let truth = scene.metres(1.0);
            let bound = touch.certificate.bound;
            let is_within = bound.lower <= truth * (1.0 + 4e-16) && truth <= bound.upper * (1.0 + 4e-16);
            assert!(is_within || !is_inner && touches.undecided.is_some(), "{truth} is not in {bound:?}");
        } else {
            open += 1;
            assert!(!is_inner, "share {share}: {:?} at {:?}", scene.ray(false), scene.pose());
            assert!(touches.undecided.is_some(), "slipped: {:?} at {:?}", scene.ray(false), scene.pose());
        }
    }
    assert!(hits > 2 * open && open > 0, "{hits} hits, {open} open");
}
