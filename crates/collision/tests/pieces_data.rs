//! Meshes against convex forms and against each other, compared with the reference data.

mod reference;

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Verdict, Work},
    math::Pose,
    narrow::{InitialTouch, Motion, Placed, distance, impact, overlap, penetration},
    shape::{Form, Geometry},
};
use glam::{DMat3, DQuat};
use reference::{number, vector};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

/// What was wrong, to be shown together.
#[derive(Default)]
struct Wrong(Vec<String>);

impl Wrong {
    fn unless(&mut self, is_right: bool, what: impl FnOnce() -> String) {
        if !is_right {
            self.0.push(what());
        }
    }

    fn none(self, name: &str, asked: usize) {
        let shown: Vec<&String> = self.0.iter().take(5).collect();
        assert!(self.0.is_empty(), "{name}: {} of {asked} are wrong: {shown:#?}", self.0.len());
    }
}

fn at(geometry: &Geometry, pose: Pose) -> Placed<'_> {
    Placed { geometry, pose }
}

#[test]
fn capsules_and_meshes() {
    let Some(folder) = reference::folder() else { return };
    for name in ["nav_test", "test_map01"] {
        let mesh = reference::mesh(&folder, &format!("mesh/{name}.obj"));
        let mesh = at(&mesh, Pose::IDENTITY);
        let records = reference::records(&folder, &format!("capsulemesh_{name}.jsonl"));
        let (mut wrong, mut worst) = (Wrong::default(), 0.0_f64);
        for record in &records {
            let capsule = Geometry::capsule(number(record, "h"), number(record, "r")).expect("a capsule");
            let capsule = at(&capsule, reference::pose(record));
            let (truth, size) = (number(record, "d"), number(record, "s"));
            let work = &mut Work::default();
            let touching = overlap(capsule, mesh, &EXACT, work);
            let separation = distance(capsule, mesh, f64::INFINITY, &EXACT, work).expect("no limit");
            let contacts = penetration(capsule, mesh, 0.0, &EXACT, work).expect("one mesh");
            let error = (separation.distance - truth.max(0.0)).abs() / size;
            let bound = separation.certificate.bound;
            let slack = 4e-16 * size;
            worst = worst.max(error);
            wrong.unless(error <= 1e-12, || format!("{record}\n    {separation:?}"));
            let is_within = bound.lower - slack <= truth.max(0.0) && truth.max(0.0) <= bound.upper + slack;
            wrong.unless(is_within, || format!("{record}\n    truth outside: {separation:?}"));
            if reference::is_ambiguous(record) {
                continue;
            }
            let is_hit = record["overlap"].as_bool() == Some(true);
            let expected = if is_hit { Verdict::Hit } else { Verdict::Miss };
            wrong.unless(touching.verdict == expected, || format!("{record}\n    {touching:?}"));
            let faces: Vec<u64> = contacts.iter().filter_map(|contact| contact.feature_b.face).map(u64::from).collect();
            let sure = record["ids"].as_array().expect("ids").iter().filter_map(serde_json::Value::as_u64);
            let sure: Vec<u64> = sure.collect();
            wrong.unless(sure.iter().all(|id| faces.contains(id)), || format!("{record}\n    contacts {faces:?}"));
            let nearest = alone(mesh.geometry, separation.feature_b.face.expect("a face"));
            let to_nearest = distance(capsule, at(&nearest, Pose::IDENTITY), f64::INFINITY, &EXACT, work);
            let to_nearest = to_nearest.expect("no limit").distance;
            wrong.unless((to_nearest - truth.max(0.0)).abs() <= 1e-12 * size, || {
                format!("{record}\n    another triangle is nearest: {separation:?}")
            });
        }
        eprintln!("capsulemesh_{name}: {} records, largest error {worst:.1e} of the scale", records.len());
        wrong.none(name, records.len());
    }
}

/// A face of a mesh (none of whose triangles was left out) as a mesh of its own.
fn alone(geometry: &Geometry, face: u32) -> Geometry {
    let Form::Mesh(mesh) = geometry.form() else { panic!("a mesh") };
    Geometry::mesh(&mesh.corners(face as usize), &[[0, 1, 2]]).expect("a triangle")
}

#[test]
fn balls_that_fly_at_meshes() {
    let Some(folder) = reference::folder() else { return };
    for name in ["nav_test", "spot"] {
        let mesh = reference::mesh(&folder, &format!("mesh/{name}.obj"));
        let mesh = at(&mesh, Pose::IDENTITY);
        let records = reference::records(&folder, &format!("spherecast_{name}.jsonl"));
        let (mut wrong, mut worst) = (Wrong::default(), 0.0_f64);
        for record in records.iter().filter(|record| !reference::is_ambiguous(record)) {
            let ball = Geometry::sphere(number(record, "r")).expect("a ball");
            let (origin, way) = (vector(record, "o"), vector(record, "d"));
            let motion = Motion {
                displacement_a: way,
                displacement_b: DVec3::ZERO,
                initial: InitialTouch::Counts,
                ..Motion::default()
            };
            let touch = impact(at(&ball, Pose::at(origin)), mesh, &motion, &EXACT, &mut Work::default());
            let is_hit = record["hit"].as_bool() == Some(true);
            let Some(touch) = touch else {
                wrong.unless(!is_hit, || format!("{record}\n    missed"));
                continue;
            };
            let is_right = is_hit && touch.certificate.verdict == Verdict::Hit;
            wrong.unless(is_right, || format!("{record}\n    {touch:?}"));
            if !is_hit {
                continue;
            }
            let truth = number(record, "t");
            let is_start = record["start"].as_bool() == Some(true);
            wrong.unless(is_start == touch.initial, || format!("{record}\n    {touch:?}"));
            let bound = touch.certificate.bound;
            let is_within = bound.lower - 1e-14 <= truth && truth <= bound.upper + 1e-14;
            wrong.unless(is_within, || format!("{record}\n    truth outside: {touch:?}"));
            if is_start {
                continue;
            }
            let there = at(&ball, Pose::at(origin + way * touch.fraction));
            let gap = distance(there, mesh, f64::INFINITY, &EXACT, &mut Work::default()).expect("no limit").distance;
            let inside = penetration(there, mesh, 0.0, &EXACT, &mut Work::default()).expect("one mesh");
            let depth = inside.iter().map(|contact| contact.depth).fold(0.0, f64::max);
            let error = gap.max(depth) / number(record, "s");
            worst = worst.max(error);
            wrong.unless(error <= 1e-10, || format!("{record}\n    off by {error}: {touch:?}"));
        }
        eprintln!("spherecast_{name}: {} records, largest error {worst:.1e} of the scale", records.len());
        wrong.none(name, records.len());
    }
}

#[test]
fn a_robot_in_its_rooms() {
    let Some(folder) = reference::folder() else { return };
    let environment = reference::mesh(&folder, "mesh/fcl_env.obj");
    let robot = reference::mesh(&folder, "mesh/fcl_rob.obj");
    let environment = at(&environment, Pose::IDENTITY);
    let records = reference::records(&folder, "mesh_mesh_fcl_env_rob.jsonl");
    let (mut wrong, mut worst) = (Wrong::default(), 0.0_f64);
    for record in &records {
        let robot = at(&robot, reference::pose(record));
        let truth = number(record, "d");
        let size = robot.geometry.reach() + environment.geometry.reach() + robot.pose.position.length();
        let work = &mut Work::default();
        let touching = overlap(robot, environment, &EXACT, work);
        let expected = if truth > 0.0 { Verdict::Miss } else { Verdict::Hit };
        let is_judged = !reference::is_ambiguous(record);
        wrong.unless(!is_judged || touching.verdict == expected, || format!("{record}\n    {touching:?}"));
        let separation = distance(robot, environment, f64::INFINITY, &EXACT, work).expect("no limit");
        let swapped = distance(environment, robot, f64::INFINITY, &EXACT, work).expect("no limit");
        wrong.unless(separation.distance.to_bits() == swapped.distance.to_bits(), || {
            format!("{record}\n    {swapped:?}")
        });
        wrong.unless(separation.feature_a == swapped.feature_b, || format!("{record}\n    {swapped:?}"));
        let error = (separation.distance - truth).abs() / size;
        worst = worst.max(error);
        wrong.unless(error <= 1e-12, || format!("{record}\n    {separation:?}"));
        let bound = separation.certificate.bound;
        let is_within = bound.lower - 4e-16 * size <= truth && truth <= bound.upper + 4e-16 * size;
        wrong.unless(is_within, || format!("{record}\n    truth outside: {separation:?}"));
    }
    eprintln!("mesh_mesh_fcl_env_rob: {} records, largest error {worst:.1e} of the scale", records.len());
    wrong.none("mesh_mesh_fcl_env_rob", records.len());
}

#[test]
fn two_parts_in_motion_whose_corners_lie_far_from_their_own_origin() {
    let Some(folder) = reference::folder() else { return };
    let parts = ["1", "2"].map(|part| reference::mesh(&folder, &format!("motion/fcl_model1_obj{part}.obj")));
    let text = std::fs::read_to_string(folder.join("motion/fcl_model1_frames.csv")).expect("frames");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .map(|line| line.split([',', ' ', ';']).filter_map(|word| word.trim().parse().ok()).collect())
        .filter(|row: &Vec<f64>| row.len() == 26)
        .collect();
    let records = reference::records(&folder, "motion/fcl_model1_expected.jsonl");
    let (mut wrong, mut worst) = (Wrong::default(), 0.0_f64);
    for record in &records {
        let row = &rows[record["frame"].as_u64().expect("a frame") as usize];
        let placed = |part: usize| {
            let position = DVec3::from_slice(&row[2 + 3 * part..]);
            let matrix: Vec<f64> = row[8 + 9 * part..17 + 9 * part].to_vec();
            let rotation = DQuat::from_mat3(&DMat3::from_cols_slice(&matrix).transpose());
            at(&parts[part], Pose::new(position, rotation))
        };
        let (one, two) = (placed(0), placed(1));
        let bounds = one.geometry.local_bounds();
        let size = (bounds.max - bounds.min).length() + one.pose.position.length();
        let truth = number(record, "d");
        let separation = distance(one, two, f64::INFINITY, &EXACT, &mut Work::default()).expect("no limit");
        let error = (separation.distance - truth).abs() / size;
        worst = worst.max(error);
        wrong.unless(error <= 1e-9, || format!("{record}\n    {separation:?}"));
    }
    eprintln!("motion: {} frames, largest error {worst:.1e} of the scale", records.len());
    wrong.none("motion", records.len());
}
