//! Kernels and main questions, one at a time, for `.ci/counts` to count the instructions of.
//!
//! `counted list` prints their names; `counted NAME` runs one. What is made ready is not counted, only what [`measured`] calls.

use std::{
    hint::black_box,
    io::{self, Write},
    sync::Arc,
};

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::Work,
    math::Pose,
    narrow::{self, Faces, Motion, Placed, Ray},
    shape::Geometry,
    world::{Distance, Edit, EditRule, Filter, HitMode, Meter, Overlap, Raycast, Shape, ShapeId, Subject, Time, World},
};

/// All that is run here is counted, and nothing else.
#[inline(never)]
fn measured(work: &mut dyn FnMut()) {
    work();
}

/// Makes sure that an answer is computed.
fn keep<T>(answer: T) {
    black_box(answer);
}

/// Multiples of a golden ratio: numbers between -1 and 1 that are spread evenly, the same everywhere.
fn spread(index: u32, axis: u32) -> f64 {
    let turns = f64::from(index) * [0.819_172_513, 0.671_043_606, 0.549_700_477][axis as usize % 3] + f64::from(axis);
    2.0 * (turns - turns.floor()) - 1.0
}

fn vector(index: u32) -> DVec3 {
    DVec3::new(spread(index, 0), spread(index, 1), spread(index, 2))
}

fn turn(index: u32) -> DQuat {
    let v = vector(index + 7);
    DQuat::from_xyzw(v.x, v.y, v.z, 1.0)
}

fn ball_of_points(count: u32) -> Vec<DVec3> {
    (0..count).map(|index| vector(index).normalize_or(DVec3::X)).collect()
}

fn form(name: &str) -> Geometry {
    let made = match name {
        "box" => Geometry::cuboid(DVec3::new(1.0, 0.75, 0.5)),
        "capsule" => Geometry::capsule(0.75, 0.25),
        "hull" => Geometry::hull(&ball_of_points(32)),
        "cone" => Geometry::cone(0.75, 0.5),
        "ellipsoid" => Geometry::ellipsoid(DVec3::new(1.0, 0.75, 0.5)),
        "floor" => Geometry::half_space(DVec3::Y, -0.5),
        _ => mesh(),
    };
    made.expect("a form within the limits")
}

/// Hilly ground of 32 by 32 cells.
fn mesh() -> Result<Geometry, collision::shape::GeometryError> {
    let side = 33;
    let vertex = |index: u32| {
        DVec3::new(f64::from(index % side) / 8.0 - 2.0, 0.1 * spread(index, 1), f64::from(index / side) / 8.0 - 2.0)
    };
    let cell = |index: u32| {
        let corner = index / 32 * side + index % 32;
        [[corner, corner + side, corner + side + 1], [corner, corner + side + 1, corner + 1]]
    };
    let vertices: Vec<DVec3> = (0..side * side).map(vertex).collect();
    Geometry::mesh(&vertices, &(0..32 * 32).flat_map(cell).collect::<Vec<_>>())
}

const PAIRS: [(&str, &str); 7] = [
    ("box", "box"),
    ("capsule", "capsule"),
    ("hull", "hull"),
    ("ellipsoid", "cone"),
    ("box", "floor"),
    ("hull", "mesh"),
    ("capsule", "hull"),
];
const QUESTIONS: [&str; 6] = ["overlap", "distance", "depth", "ray", "impact", "turning"];
const WORLDS: [&str; 5] = ["world-insert", "world-move", "world-raycast", "world-overlap", "world-distance"];

/// How many poses of a pair are asked about.
const POSES: u32 = 64;

fn names() -> Vec<String> {
    let pairs = QUESTIONS.iter().flat_map(|question| PAIRS.map(|(a, b)| format!("{question}-{a}-{b}")));
    pairs.chain(WORLDS.map(String::from)).collect()
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, min_distance: 0.0, max_distance: 1e3, hollow: false, faces: Faces::Both }
}

fn ask_pair(question: &str, a: Placed<'_>, b: Placed<'_>, index: u32) {
    let (accuracy, work) = (&Accuracy::of(Tier::Exact), &mut Work::default());
    let way = b.pose.position - a.pose.position;
    let motion = Motion { displacement_a: way * 1.5, ..Motion::default() };
    match question {
        "overlap" => keep(narrow::overlap(a, b, accuracy, work)),
        "distance" => keep(narrow::distance(a, b, f64::INFINITY, accuracy, work)),
        "depth" => keep(narrow::penetration(a, b, 0.0, accuracy, work)),
        "ray" => keep(narrow::raycast(&ray(a.pose.position, way), b, accuracy, work)),
        "impact" => keep(narrow::impact(a, b, &motion, accuracy, work)),
        _ => {
            let motion = Motion { rotation_a: vector(index), ..motion };
            keep(narrow::impact(a, b, &motion, &Accuracy::default(), work));
        }
    }
}

fn run_pair(question: &str, names: (&str, &str)) {
    let (a, b) = (form(names.0), form(names.1));
    let placed = |index: u32| {
        let apart = vector(index) * (1.0 + 0.5 * f64::from(index % 4));
        let here = Placed { geometry: &a, pose: Pose::new(apart, turn(index)) };
        (here, Placed { geometry: &b, pose: Pose::new(DVec3::ZERO, turn(index + 100)) })
    };
    // What is built when first needed is not what is counted.
    let ask = |index: u32| {
        let (a, b) = placed(index);
        ask_pair(question, a, b, index);
    };
    ask(0);
    measured(&mut || (0..POSES).for_each(ask));
}

fn id(index: u32) -> ShapeId {
    ShapeId::MIN.saturating_add(u64::from(index))
}

fn shapes() -> Vec<Edit> {
    let forms = ["box", "capsule", "hull", "ellipsoid"].map(|name| Arc::new(form(name)));
    let shape = |index: u32| {
        let pose = Pose::new(vector(index) * 20.0, turn(index));
        Edit::Insert(Shape::new(id(index), Arc::clone(&forms[index as usize % 4]), pose))
    };
    (0..2000).map(shape).collect()
}

fn moves() -> Vec<Edit> {
    let moved = |index: u32| Edit::Move {
        id: id(index),
        position: Some(vector(index) * 20.0 + vector(index + 3)),
        rotation: None,
        velocity: None,
        angular_velocity: None,
        teleport: false,
    };
    (0..2000).map(moved).collect()
}

fn run_world(question: &str) {
    let mut world = World::new(Time(0));
    if question == "world-insert" {
        let mut edits = Some(shapes());
        measured(&mut || {
            keep(world.apply(edits.take().unwrap_or_default(), Time(0), EditRule::AllOrNothing));
        });
        return;
    }
    world.apply(shapes(), Time(0), EditRule::AllOrNothing).expect("a tick");
    if question == "world-move" {
        let mut edits = Some(moves());
        measured(&mut || {
            keep(world.apply(edits.take().unwrap_or_default(), Time(1), EditRule::AllOrNothing));
        });
        return;
    }
    let (snapshot, filter, accuracy) = (world.newest(), Filter::default(), Accuracy::default());
    let probe = Arc::new(form("capsule"));
    let ask = |index: u32| {
        let mut go_on = || true;
        let meter = &mut Meter::new(&mut go_on);
        let subject =
            Subject::Geometry { geometry: Arc::clone(&probe), pose: Pose::new(vector(index) * 20.0, turn(index)) };
        match question {
            "world-raycast" => {
                let ray = ray(vector(index) * 40.0, vector(index + 9) - vector(index));
                keep(snapshot.raycast(&Raycast { ray, mode: HitMode::Closest }, &filter, &accuracy, meter));
            }
            "world-overlap" => {
                let question = Overlap { subject, against: None, max_hits: 100 };
                keep(snapshot.overlap(&question, &filter, &accuracy, meter));
            }
            _ => {
                let question = Distance { subject, against: None, max_distance: 100.0, max_hits: 1 };
                keep(snapshot.distance(&question, &filter, &accuracy, meter));
            }
        }
    };
    ask(0);
    measured(&mut || (0..POSES).for_each(ask));
}

fn main() {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    if wanted == "list" {
        let listed = names().join("\n");
        let _ = writeln!(io::stdout(), "{listed}");
        return;
    }
    let mut parts = wanted.split('-');
    match (parts.next(), parts.next(), parts.next()) {
        (Some("world"), ..) => run_world(&wanted),
        (Some(question), Some(a), Some(b)) => run_pair(question, (a, b)),
        _ => {
            let _ = writeln!(io::stderr(), "`counted list`, or `counted` and one of its names");
        }
    }
}
