//! What stands on, slides over or falls onto triangles feels the surface, not the edges between them.

mod reference;
mod whole;

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Verdict, Work},
    math::{Aabb, Pose},
    narrow::{Contact, ImpactTouch, InitialTouch, Motion, Placed, distance, impact, penetration},
    shape::{Form, Geometry, Mesh, MeshMode},
};
use whole::Numbers;

const EXACT: Accuracy = Accuracy::of(Tier::Exact);
/// Cells along a side of a floor.
const SIDE: u32 = 12;

fn at(geometry: &Geometry, pose: Pose) -> Placed<'_> {
    Placed { geometry, pose }
}

fn work() -> Work {
    Work::default()
}

/// A flat floor at height 0 that reaches from −6 to 6, its vertices and diagonals at random, long triangles and slivers among
/// them.
fn floor(numbers: &mut Numbers, mode: MeshMode) -> Geometry {
    // Cells stay convex up to a quarter; a power makes those in the middle small and the others long.
    let (jitter, power) = [(0.0, 1), (0.24, 1), (0.0, 5)][numbers.below(3) as usize];
    let place = |index: u32, noise: f64| {
        let noise = if index.is_multiple_of(SIDE) { 0.0 } else { noise * jitter };
        ((f64::from(index) + noise) * 2.0 / f64::from(SIDE) - 1.0).powi(power) * 6.0
    };
    let vertex = |numbers: &mut Numbers, column: u32, row: u32| {
        DVec3::new(place(column, numbers.share()), 0.0, place(row, numbers.share()))
    };
    let mut vertices = Vec::new();
    for row in 0..=SIDE {
        vertices.extend((0..=SIDE).map(|column| vertex(numbers, column, row)));
    }
    let mut triangles = Vec::new();
    for cell in 0..SIDE * SIDE {
        let first = cell / SIDE * (SIDE + 1) + cell % SIDE;
        let [a, b, c, d] = [first, first + 1, first + SIDE + 2, first + SIDE + 1];
        let halves = if numbers.below(2) == 0 { [[a, c, b], [a, d, c]] } else { [[a, d, b], [b, d, c]] };
        for triangle in halves {
            let by = numbers.below(3) as usize;
            triangles.push([triangle[by], triangle[(by + 1) % 3], triangle[(by + 2) % 3]]);
        }
    }
    Geometry::mesh_as(mode, &vertices, &triangles).expect("a floor")
}

/// A form, and how far its lowest point is below its local origin when it stands upright and is turned about y.
fn stander(numbers: &mut Numbers, kind: i128) -> (Geometry, f64, DQuat) {
    let size = numbers.shares().abs() * 0.6 + 0.2;
    let about_y = DQuat::from_rotation_y(numbers.share() * 3.0);
    let lying = about_y * DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    let (form, below, rotation) = match kind {
        0 => (Geometry::sphere(size.x), size.x, about_y),
        1 => (Geometry::capsule(size.y, size.x), size.y + size.x, about_y),
        2 => (Geometry::capsule(size.y, size.x), size.x, lying),
        3 => (Geometry::cuboid(size), size.y, about_y),
        4 => (Geometry::cuboid(size).and_then(|form| form.rounded(0.1)), size.y + 0.1, about_y),
        _ => (Geometry::cylinder(size.y, size.x), size.y, about_y),
    };
    (form.expect("a form"), below, rotation)
}

/// Where a floor and what stands on it are: anywhere, turned anyhow.
struct Ground {
    pose: Pose,
}

impl Ground {
    fn random(numbers: &mut Numbers, round: usize) -> Self {
        let [x, y, z, w] = [0; 4].map(|_| numbers.share());
        let rotation = if round.is_multiple_of(3) { DQuat::IDENTITY } else { DQuat::from_xyzw(x, y, z, w) };
        Self { pose: Pose::new(numbers.shares() * [1.0, 1e4][round % 2], rotation) }
    }

    fn up(&self) -> DVec3 {
        self.pose.matrix() * DVec3::Y
    }

    fn place(&self, local: DVec3, rotation: DQuat) -> Pose {
        Pose::new(self.pose.transform_point(local), self.pose.rotation.normalize() * rotation)
    }
}

#[test]
fn contacts_with_a_flat_floor_are_floor_contacts() {
    let mut numbers = Numbers::new(211);
    for round in 0..600 {
        let mode = [MeshMode::TwoSided, MeshMode::OneSided][round % 2];
        let floor = floor(&mut numbers, mode);
        let ground = Ground::random(&mut numbers, round);
        let (form, below, rotation) = stander(&mut numbers, round as i128 % 6);
        let depth = [0.0, 1e-9, 1e-4, 0.05, -1e-4, -0.05][round / 6 % 6];
        let place = DVec3::new(numbers.share() * 4.0, below - depth, numbers.share() * 4.0);
        let (mesh, body) = (at(&floor, ground.pose), at(&form, ground.place(place, rotation)));
        let gap = 0.1;
        let contacts = penetration(body, mesh, gap, &EXACT, &mut work()).expect("one mesh");
        let context = || format!("round {round}: {form:?}, {depth} deep at {place}");
        assert!(!contacts.is_empty(), "{}", context());
        let scale = 1e-11 * (1.0 + ground.pose.position.length() * 1e-3);
        for contact in &contacts {
            assert_is_along(contact.normal_b_to_a, ground.up(), &|| format!("{contact:?} {}", context()));
            assert!((contact.depth - depth).abs() < scale, "{contact:?} {}", context());
            let bound = contact.certificate.bound;
            assert!(bound.upper - bound.lower < 1e-9 && bound.contains(contact.depth), "{contact:?} {}", context());
        }
        let swapped = penetration(mesh, body, gap, &EXACT, &mut work()).expect("one mesh");
        assert_eq!(swapped.len(), contacts.len());
        for (contact, swapped) in contacts.iter().zip(&swapped) {
            assert_eq!((contact.normal_b_to_a, contact.depth), (-swapped.normal_b_to_a, swapped.depth));
        }
    }
}

fn assert_is_along(normal: DVec3, up: DVec3, context: &dyn Fn() -> String) {
    assert!((normal - up).length() < 1e-5, "{}", context());
}

#[test]
fn what_falls_onto_or_slides_over_a_flat_floor_meets_the_floor() {
    let mut numbers = Numbers::new(223);
    let (mut fallen, mut bumps) = (0, 0);
    for round in 0..900 {
        let mode = [MeshMode::TwoSided, MeshMode::OneSided][round % 2];
        let floor = floor(&mut numbers, mode);
        let ground = Ground::random(&mut numbers, round);
        let (form, below, rotation) = stander(&mut numbers, round as i128 % 6);
        // From above, or along the floor: a little above it, or a little in it.
        let gap = [0.5, 1e-3, 0.0, -1e-6, -1e-3][round / 6 % 5];
        let falls = gap > 0.0;
        let place = DVec3::new(numbers.share() * 4.0, below + gap, numbers.share() * 4.0);
        let down = if falls { -2.0 * gap - 1e-3 } else { -1e-4 * numbers.share().abs() };
        let local = DVec3::new(numbers.share(), 0.0, numbers.share()) * 1.5 + DVec3::Y * down;
        let spin = if round % 7 == 0 { ground.up() * numbers.share() } else { DVec3::ZERO };
        let motion = Motion {
            displacement_a: ground.pose.matrix() * local,
            rotation_a: spin,
            initial: if falls { InitialTouch::Counts } else { InitialTouch::IsIgnored },
            ..Motion::default()
        };
        let (mesh, body) = (at(&floor, ground.pose), at(&form, ground.place(place, rotation)));
        let touch = impact(body, mesh, &motion, &EXACT, &mut work());
        let context = || format!("round {round}: {form:?} at {place} goes {local}: {touch:?}");
        if falls {
            let ImpactTouch { fraction, normal_b_to_a, .. } = touch.unwrap_or_else(|| panic!("{}", context()));
            fallen += 1;
            assert!(
                (fraction * -down - gap).abs() < 1e-9 * (1.0 + ground.pose.position.length() * 1e-3),
                "{}",
                context()
            );
            assert_is_along(normal_b_to_a.expect("not at the start"), ground.up(), &context);
        } else if let Some(normal) = touch.and_then(|touch| touch.normal_b_to_a) {
            bumps += 1;
            assert_is_along(normal, ground.up(), &context);
        }
    }
    assert!(fallen > 300 && bumps > 100, "{fallen} fell, {bumps} slid onto other triangles");
}

/// The edge of a roof is an edge: what lies on it is pushed along any direction between the two sides.
#[test]
fn a_real_edge_is_felt_between_its_faces() {
    let corners = [[-2., -1., -9.], [-2., -1., 9.], [0., 0., -9.], [0., 0., 9.], [2., -1., -9.], [2., -1., 9.]];
    let roof =
        Geometry::mesh(&corners.map(DVec3::from_array), &[[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]]).expect("a roof");
    let ball = Geometry::sphere(1.0).expect("a ball");
    let sides = [DVec3::new(-1.0, 2.0, 0.0).normalize(), DVec3::new(1.0, 2.0, 0.0).normalize()];
    let mut numbers = Numbers::new(227);
    let (mut on_edge, mut beside) = (0, 0);
    for _ in 0..500 {
        let lean = numbers.share() * 0.8;
        let normal = DVec3::new(lean.sin(), lean.cos(), 0.0);
        let center = normal * 0.99 + DVec3::Z * numbers.share();
        let (ball, roof) = (at(&ball, Pose::at(center)), at(&roof, Pose::IDENTITY));
        let is_on_edge = sides.iter().all(|side| normal.dot(DVec3::new(-side.y, side.x, 0.0)) * side.x.signum() > 1e-9);
        let contacts = penetration(ball, roof, 0.0, &EXACT, &mut work()).expect("one mesh");
        let deepest: &Contact = contacts.iter().max_by(|a, b| a.depth.total_cmp(&b.depth)).expect("a touch");
        for contact in &contacts {
            let is_side = sides.iter().any(|side| (contact.normal_b_to_a - *side).length() < 1e-6);
            let is_between = (contact.normal_b_to_a - normal).length() < 1e-6;
            assert!(is_side || is_on_edge && is_between, "{lean}: {contact:?}");
        }
        on_edge += u32::from(is_on_edge);
        beside += u32::from(!is_on_edge);
        assert!(deepest.depth >= 0.01 - 1e-12, "{lean}: {deepest:?}");
        let motion = Motion { displacement_a: normal * -0.5, ..Motion::default() };
        let above = at(ball.geometry, Pose::at(center + normal * 0.1));
        let normal_of_touch = impact(above, roof, &motion, &EXACT, &mut work()).and_then(|touch| touch.normal_b_to_a);
        assert!(
            !is_on_edge || (normal_of_touch.expect("a touch") - normal).length() < 1e-6,
            "{lean}: {normal_of_touch:?}"
        );
    }
    assert!(on_edge > 100 && beside > 100, "{on_edge} on the edge, {beside} beside it");
}

/// Whether the surface has a normal at a point, by all its triangles near it: a face has it, or nothing rises along it.
fn has_normal(mesh: &Mesh, near: &[usize], point: DVec3, normal: DVec3) -> bool {
    let lean = 1e-4;
    let rises = |triangle: usize| {
        let at = nearest_on(mesh.corners(triangle), point);
        mesh.corners(triangle).into_iter().any(|corner| {
            let way = corner - at;
            way.length() > 1e-3 && normal.dot(way) > lean * way.length()
        })
    };
    let is_face = |triangle: usize| normal.cross(mesh.normal(triangle)).length() < lean;
    near.iter().any(|&triangle| is_face(triangle)) || near.iter().all(|&triangle| !rises(triangle))
}

fn nearest_on(corners: [DVec3; 3], point: DVec3) -> DVec3 {
    let triangle = Geometry::mesh(&corners, &[[0, 1, 2]]).expect("a triangle");
    let there = Geometry::point();
    let found = distance(at(&there, Pose::at(point)), at(&triangle, Pose::IDENTITY), 1e9, &EXACT, &mut work());
    found.expect("near").point_on_b
}

/// Of a level: forms fall onto it wherever it is, and slide on from there.
#[test]
fn a_level_is_felt_with_its_own_normals() {
    let Some(folder) = reference::folder() else { return };
    for (name, seed) in [("nav_test", 229), ("test_map01", 233)] {
        let level = reference::mesh(&folder, &format!("mesh/{name}.obj"));
        let Form::Mesh(mesh) = level.form() else { panic!("a mesh") };
        let bounds = level.local_bounds();
        let mut numbers = Numbers::new(seed);
        let (mut asked, mut wrong) = (0, Vec::new());
        for round in 0..400 {
            let (form, _, rotation) = stander(&mut numbers, round % 6);
            let share = numbers.shares() * 0.5 + 0.5;
            let start = bounds.min + share * (bounds.max - bounds.min) + DVec3::Y * 5.0;
            let mut body = at(&form, Pose::new(start, rotation));
            let level = at(&level, Pose::IDENTITY);
            let down = Motion { displacement_a: DVec3::Y * -60.0, ..Motion::default() };
            let Some(landing) = impact(body, level, &down, &EXACT, &mut work()).filter(|touch| !touch.initial) else {
                continue;
            };
            let mut judge = |point: DVec3, normal: Option<DVec3>, what: &dyn Fn() -> String| {
                let near: Vec<usize> = (0..mesh.triangles().len())
                    .filter(|&triangle| mesh.triangle_bounds(triangle).inflated(1e-4).contains(Aabb::new(point, point)))
                    .filter(|&triangle| (nearest_on(mesh.corners(triangle), point) - point).length() < 1e-4)
                    .collect();
                asked += 1;
                if normal.is_some_and(|normal| !has_normal(mesh, &near, point, normal)) {
                    wrong.push(format!("{name} {round}: {} by {near:?}", what()));
                }
            };
            judge(landing.point, landing.normal_b_to_a, &|| format!("falls: {landing:?}"));
            // A little into it, and along.
            body.pose.position += down.displacement_a * landing.fraction - DVec3::Y * 1e-3;
            for contact in penetration(body, level, 0.0, &EXACT, &mut work()).expect("one mesh") {
                if contact.certificate.verdict == Verdict::Hit {
                    judge(contact.points[0].point_on_b, Some(contact.normal_b_to_a), &|| {
                        format!("stands: {contact:?}")
                    });
                }
            }
            let along = DVec3::new(numbers.share(), 0.0, numbers.share()) * 2.0;
            let slide = Motion { displacement_a: along, initial: InitialTouch::IsIgnored, ..Motion::default() };
            if let Some(touch) = impact(body, level, &slide, &EXACT, &mut work()) {
                judge(touch.point, touch.normal_b_to_a, &|| format!("slides {along}: {touch:?}"));
            }
        }
        eprintln!("{name}: {asked} normals, {} of them not the level's", wrong.len());
        assert!(asked > 300, "{asked}");
        let shown: Vec<&String> = wrong.iter().take(5).collect();
        assert!(wrong.is_empty(), "{} of {asked}: {shown:#?}", wrong.len());
    }
}
