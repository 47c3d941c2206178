//! A world whose shapes move, and questions to it: 10,000 spheres or boxes of 0.2 to 2 m that fill about 5 % of a cube, of which each
//! tick moves another 1,000 by 0.1 m and turns them a little.

use std::{f64::consts::TAU, num::NonZeroU64, sync::Arc, time::Instant};

use collision::{
    DQuat, DVec3,
    math::Pose,
    narrow::{Faces, Ray},
    shape::Geometry,
    world::{Edit, EditRule, HitMode, Means, Overlap, Raycast, Settings, Shape, Snapshot, Subject, Time, World},
};

use crate::{Failure, dice::Dice};

pub(crate) const SHAPE_COUNT: u64 = 10_000;
/// Moves of a tick.
pub(crate) const MOVES: u64 = 1000;
/// How far each goes, metres.
const STEP: f64 = 0.1;
/// Length of rays, metres.
const RAY_LENGTH: f64 = 10.0;
pub(crate) const QUESTIONS: usize = 2000;

/// Shapes at random in a cube of which they fill a twentieth, and its side.
pub(crate) fn filled(name: &str, dice: &mut Dice, history_ticks: u32) -> Result<(World, f64), Failure> {
    let mut geometries = Vec::new();
    let mut volume = 0.0;
    for _ in 0..SHAPE_COUNT {
        let half = DVec3::from_array(std::array::from_fn(|_| dice.between(0.1, 1.0)));
        if name == "sphere" {
            volume += TAU * 2.0 / 3.0 * half.x.powi(3);
            geometries.push(Geometry::sphere(half.x)?);
        } else {
            volume += 8.0 * half.element_product();
            geometries.push(Geometry::cuboid(half)?);
        }
    }
    let side = (20.0 * volume).cbrt();
    let inserts = (1..).zip(geometries).map(|(number, geometry)| {
        let pose =
            Pose::new(DVec3::from_array(dice.point(side)), DQuat::from_xyzw(dice.between(-1.0, 1.0), 0.3, 0.2, 1.0));
        Edit::Insert(Shape::new(id(number), Arc::new(geometry), pose))
    });
    let settings = Settings { history_ticks, ..Settings::default() };
    let mut world = World::with(Time(0), settings, Means::default());
    world.apply(inserts.collect(), Time(0), EditRule::AllOrNothing)?;
    Ok((world, side))
}

pub(crate) fn id(number: u64) -> NonZeroU64 {
    NonZeroU64::MIN.saturating_add(number - 1)
}

/// Every tenth shape, from a random one on: spread over all pages, as the movers of a world are.
pub(crate) fn moves(newest: &Snapshot, dice: &mut Dice) -> Vec<Edit> {
    let stride = SHAPE_COUNT / MOVES;
    let first = (dice.between(0.0, 1.0) * stride as f64) as u64;
    let mut moves = Vec::new();
    for number in 0..MOVES {
        let id = id(1 + first + number * stride);
        if let Some(shape) = newest.shape(id) {
            let turn = DQuat::from_xyzw(0.02, dice.between(-0.02, 0.02), 0.0, 1.0);
            moves.push(Edit::Move {
                id,
                position: Some(shape.pose.position + DVec3::from_array(dice.point(2.0)).normalize_or_zero() * STEP),
                rotation: Some(turn * shape.pose.unit_rotation()),
                velocity: None,
                angular_velocity: None,
                teleport: false,
            });
        }
    }
    moves
}

/// Applies moves, a sixtieth of a second later.
pub(crate) fn tick(world: &mut World, moves: Vec<Edit>) -> Result<(), Failure> {
    let time = Time(world.newest().time().0 + 16_666_667);
    world.apply(moves, time, EditRule::AllOrNothing)?;
    Ok(())
}

/// Closest hits of rays from anywhere.
pub(crate) fn rays(side: f64, dice: &mut Dice) -> Vec<Raycast> {
    let mut ray = || Ray {
        origin: DVec3::from_array(dice.point(side)),
        direction: DVec3::from_array(dice.point(1.0)),
        min_distance: 0.0,
        max_distance: RAY_LENGTH,
        hollow: false,
        faces: Faces::Both,
    };
    (0..QUESTIONS).map(|_| Raycast { ray: ray(), mode: HitMode::Closest }).collect()
}

/// Overlaps of a ball of 2 m anywhere.
pub(crate) fn balls(side: f64, dice: &mut Dice) -> Result<Vec<Overlap>, Failure> {
    let ball = Arc::new(Geometry::sphere(2.0)?);
    let subject = |pose| Subject::Geometry { geometry: Arc::clone(&ball), pose };
    let places = (0..QUESTIONS).map(|_| Pose::at(DVec3::from_array(dice.point(side))));
    Ok(places.map(|pose| Overlap { subject: subject(pose), against: None, max_hits: 1000 }).collect())
}

/// Seconds that something takes, and what it gives.
pub(crate) fn timed_value<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let begin = Instant::now();
    let value = work();
    (begin.elapsed().as_secs_f64(), value)
}

pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
