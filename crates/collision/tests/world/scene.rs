//! Random worlds, and short ways to question them.

use std::{num::NonZeroU64, sync::Arc};

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    math::Pose,
    narrow::{Faces, InitialTouch, Ray},
    shape::Geometry,
    world::{
        Distance, Edit, EditRule, Filter, HitMode, Meter, Mobility, Overlap, Penetration, Raycast, Shape, ShapeId,
        Snapshot, Subject, Time, TimeOfImpact, World,
    },
};

use crate::random::Random;

pub(crate) fn id(number: u64) -> ShapeId {
    NonZeroU64::new(number).expect("not 0")
}

/// A dynamic shape on layer 1 that wants all.
pub(crate) fn shape(number: u64, geometry: Arc<Geometry>, pose: Pose) -> Shape {
    Shape { user_data: number * 10, ..Shape::new(id(number), geometry, pose) }
}

/// How large everything is, and where.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) scale: f64,
    pub(crate) origin: DVec3,
}

impl Frame {
    pub(crate) const UNIT: Self = Self { scale: 1.0, origin: DVec3::ZERO };

    fn place(self, position: DVec3) -> DVec3 {
        position * self.scale + self.origin
    }
}

pub(crate) fn random_pose(random: &mut Random, frame: Frame, spread: f64) -> Pose {
    let turn = random.vector();
    Pose::new(frame.place(random.vector() * spread), DQuat::from_xyzw(turn.x, turn.y, turn.z, random.unit() + 0.01))
}

pub(crate) fn random_geometry(random: &mut Random, frame: Frame) -> Arc<Geometry> {
    let size = random.vector().abs() + 0.2;
    Arc::new(
        match random.bits() % 5 {
            0 => Geometry::sphere(size.x),
            1 => Geometry::cuboid(size),
            2 => Geometry::capsule(size.x, size.y),
            3 => {
                // A roof of four triangles, open below.
                let corners = [DVec3::Y * size.y, DVec3::X, DVec3::Z, -DVec3::X, -DVec3::Z];
                Geometry::mesh(&corners.map(|corner| corner * size.x), &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
            }
            _ => {
                let points: Vec<DVec3> = (0..12).map(|_| random.vector() * size.x).collect();
                Geometry::hull(&points)
            }
        }
        .and_then(|geometry| geometry.scaled(frame.scale))
        .expect("a geometry"),
    )
}

/// Shapes of all kinds, flags, layers and groups.
pub(crate) fn random_shapes(random: &mut Random, frame: Frame, count: u64) -> Vec<Shape> {
    (1..=count)
        .map(|number| Shape {
            layers: 1 << (random.bits() % 3),
            collides_with: (random.bits() % 8) as u32 | 1,
            mobility: match random.bits() % 3 {
                0 => Mobility::Static,
                1 => Mobility::Dynamic,
                _ => Mobility::Kinematic,
            },
            sensor: random.unit() < 0.2,
            group: (random.bits() % 4) as u32,
            ..shape(number, random_geometry(random, frame), random_pose(random, frame, 4.0))
        })
        .collect()
}

/// A floor, a wall and a slope at the rim of the random shapes, numbered from `first`.
pub(crate) fn half_spaces(random: &mut Random, frame: Frame, first: u64) -> [Shape; 3] {
    let slope = random.vector();
    let kinds = [(DVec3::Y, Mobility::Static), (DVec3::X * -7.0, Mobility::Dynamic), (slope, Mobility::Kinematic)];
    let mut number = first;
    kinds.map(|(normal, mobility)| {
        let geometry = Arc::new(Geometry::half_space(normal, -3.5 * frame.scale).expect("a half space"));
        number += 1;
        Shape { mobility, ..shape(number - 1, geometry, Pose::at(frame.origin)) }
    })
}

/// Boxes on a grid that touch face to face, each twice: every question ties.
pub(crate) fn grid_shapes() -> Vec<Shape> {
    let cube = Arc::new(Geometry::cuboid(DVec3::splat(0.5)).expect("a box"));
    (0..2_u32 * 4 * 4 * 4)
        .map(|i| {
            let cell = i / 2;
            let position = DVec3::new(f64::from(cell % 4), f64::from(cell / 4 % 4), f64::from(cell / 16)) - 1.5;
            shape(u64::from(i) + 1, Arc::clone(&cube), Pose::at(position))
        })
        .collect()
}

pub(crate) fn world_of(shapes: impl IntoIterator<Item = Shape>) -> World {
    let mut world = World::new(Time(0));
    let edits = shapes.into_iter().map(Edit::Insert).collect();
    world.apply(edits, Time(0), EditRule::AllOrNothing).expect("a tick");
    world
}

/// A question of any kind.
#[derive(Clone, Debug)]
pub(crate) enum Question {
    Raycast(Raycast),
    Overlap(Overlap),
    Penetration(Penetration),
    TimeOfImpact(TimeOfImpact),
    Distance(Distance),
}

/// Its answer, bit by bit: `Debug` prints floats so that they read back as the same.
pub(crate) fn ask(snapshot: &Snapshot, question: &Question, filter: &Filter) -> String {
    let mut go_on = || true;
    ask_by(&mut Meter::new(&mut go_on), snapshot, question, filter)
}

/// The same by a meter at hand.
pub(crate) fn ask_by(meter: &mut Meter<'_>, snapshot: &Snapshot, question: &Question, filter: &Filter) -> String {
    let accuracy = Accuracy::default();
    match question {
        Question::Raycast(question) => format!("{:?}", snapshot.raycast(question, filter, &accuracy, meter)),
        Question::Overlap(question) => format!("{:?}", snapshot.overlap(question, filter, &accuracy, meter)),
        Question::Penetration(question) => format!("{:?}", snapshot.penetration(question, filter, &accuracy, meter)),
        Question::TimeOfImpact(question) => {
            format!("{:?}", snapshot.time_of_impact(question, filter, &accuracy, meter))
        }
        Question::Distance(question) => format!("{:?}", snapshot.distance(question, filter, &accuracy, meter)),
    }
}

pub(crate) fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, min_distance: 0.0, max_distance: 4e12, hollow: false, faces: Faces::Both }
}

pub(crate) fn random_subject(random: &mut Random, frame: Frame, shape_count: u64) -> Subject {
    let pose = random_pose(random, frame, 5.0);
    match random.bits() % 3 {
        0 => Subject::Geometry { geometry: random_geometry(random, frame), pose },
        1 => Subject::Shape { id: id(1 + random.bits() % shape_count), pose: Some(pose) },
        _ => Subject::Shape { id: id(1 + random.bits() % shape_count), pose: None },
    }
}

pub(crate) fn random_mode(random: &mut Random) -> HitMode {
    match random.bits() % 4 {
        0 => HitMode::All(1000),
        1 => HitMode::All((random.bits() % 4) as usize),
        _ => HitMode::Closest,
    }
}

/// A question of each kind.
pub(crate) fn random_questions(random: &mut Random, frame: Frame, shape_count: u64) -> [Question; 5] {
    let mut subject = || random_subject(random, frame, shape_count);
    let subjects = [subject(), subject(), subject(), subject()];
    let [overlap, penetration, impact, distance] = subjects;
    let origin = random.vector() * 8.0;
    let towards = random.vector() * 3.0 - origin;
    [
        Question::Raycast(Raycast {
            ray: Ray {
                min_distance: if random.unit() < 0.2 { 2.0 * frame.scale } else { 0.0 },
                max_distance: if random.unit() < 0.3 { 6.0 * frame.scale } else { 4e12 },
                hollow: random.unit() < 0.3,
                ..ray(frame.place(origin), towards)
            },
            mode: random_mode(random),
        }),
        Question::Overlap(Overlap {
            subject: overlap,
            against: None,
            max_hits: if random.unit() < 0.3 { 2 } else { 1000 },
        }),
        Question::Penetration(Penetration {
            subject: penetration,
            against: None,
            max_gap: if random.unit() < 0.5 { 0.0 } else { 0.3 * frame.scale },
            max_contacts: if random.unit() < 0.3 { 2 } else { 64 },
        }),
        Question::TimeOfImpact(TimeOfImpact {
            subject: impact,
            displacement: random.vector() * 8.0 * frame.scale,
            rotation: if random.unit() < 0.5 { random.vector() * 3.0 } else { DVec3::ZERO },
            against: None,
            against_displacement: DVec3::ZERO,
            against_rotation: DVec3::ZERO,
            initial: if random.unit() < 0.3 { InitialTouch::IsIgnored } else { InitialTouch::Counts },
            mode: random_mode(random),
        }),
        Question::Distance(Distance {
            subject: distance,
            against: None,
            max_distance: if random.unit() < 0.3 { frame.scale } else { 4e12 },
            max_hits: 1 + (random.bits() % 5) as usize,
        }),
    ]
}

pub(crate) fn random_filter(random: &mut Random) -> Filter {
    let mut maybe = |chance: f64| random.unit() < chance;
    let (layers, wanted, sensors, statics) = (maybe(0.3), maybe(0.3), maybe(0.3), maybe(0.2));
    Filter {
        layers: layers.then_some(3),
        collides_with: wanted.then_some(5),
        exclude_ids: (0..random.bits() % 4).map(|_| id(1 + random.bits() % 40)).collect(),
        exclude_sensors: sensors,
        exclude_static: statics,
        exclude_groups: (0..random.bits() % 2).map(|_| (random.bits() % 4) as u32).collect(),
    }
}
