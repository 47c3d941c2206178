//! Places: an arena, a debris field, a terrain, a hall.

use std::{f64::consts::TAU, sync::Arc};

use collision::{
    DQuat, DVec3,
    math::Pose,
    shape::{Geometry, GeometryError, Terrain},
    world::Mobility,
};

use super::{Item, Scene, bodies};
use crate::scene::Random;

fn fixed(geometry: &Arc<Geometry>, position: DVec3) -> Item {
    Item { geometry: geometry.clone(), pose: Pose::at(position), mobility: Mobility::Static }
}

fn moving(geometry: &Arc<Geometry>, pose: Pose) -> Item {
    Item { geometry: geometry.clone(), pose, mobility: Mobility::Dynamic }
}

fn upright(random: &mut Random) -> DQuat {
    DQuat::from_rotation_y(random.uniform(0.0, TAU))
}

/// 80 by 80 metres, walls, 24 pillars, 8 ramps, 80 crates and 200 players.
pub(super) fn arena(random: &mut Random) -> Result<Scene, GeometryError> {
    const HALF: f64 = 40.0;
    let cuboid = |x, y, z| Geometry::cuboid(DVec3::new(x, y, z)).map(Arc::new);
    let (floor, wall) = (cuboid(HALF, 0.5, HALF)?, [cuboid(HALF, 2.0, 0.5)?, cuboid(0.5, 2.0, HALF)?]);
    let mut items = vec![fixed(&floor, DVec3::NEG_Y * 0.5)];
    for side in [-1.0, 1.0] {
        items.push(fixed(&wall[0], DVec3::new(0.0, 2.0, side * HALF)));
        items.push(fixed(&wall[1], DVec3::new(side * HALF, 2.0, 0.0)));
    }
    let ground =
        |random: &mut Random, height: f64| DVec3::new(random.uniform(-38.0, 38.0), height, random.uniform(-38.0, 38.0));
    let pillar = Arc::new(Geometry::cylinder(2.0, 0.6)?);
    let ramp = bodies::ramp(DVec3::new(3.0, 0.8, 1.5))?;
    items.extend((0..24).map(|_| fixed(&pillar, ground(random, 2.0))));
    items.extend((0..8).map(|_| fixed(&ramp, ground(random, 0.8))));
    for _ in 0..80 {
        let half = random.uniform(0.3, 0.9);
        let pose = Pose::new(ground(random, half), upright(random));
        items.push(moving(&cuboid(half, half, half)?, pose));
    }
    let player = Arc::new(Geometry::capsule(0.55, 0.35)?);
    items.extend((0..200).map(|_| moving(&player, Pose::new(ground(random, 0.9), upright(random)))));
    let shot = Arc::new(Geometry::sphere(0.1)?);
    let subjects = vec![player, shot, cuboid(0.5, 0.5, 0.5)?];
    Ok(Scene { name: "arena".into(), items, subjects, size: 1.0 })
}

/// 300 rocks, pebbles of 64 and boulders of 800 points in a cube of 60 metres.
pub(super) fn debris(random: &mut Random) -> Result<Scene, GeometryError> {
    let mut kinds = Vec::new();
    for _ in 0..3 {
        kinds.push(bodies::rock(random, 8, 1.5)?);
        kinds.push(bodies::pebble(random, 64, 1.0)?);
        kinds.push(bodies::pebble(random, 800, 1.6)?);
    }
    let items = (0..300).map(|number| {
        let mut coordinate = || random.uniform(-30.0, 30.0);
        let position = DVec3::new(coordinate(), coordinate(), coordinate());
        moving(&kinds[number % kinds.len()], Pose::new(position, random.rotation()))
    });
    let items = items.collect();
    let subjects = vec![kinds[2].clone(), kinds[0].clone(), kinds[1].clone(), Arc::new(Geometry::sphere(0.5)?)];
    Ok(Scene { name: "debris".into(), items, subjects, size: 1.5 })
}

/// 256 by 256 metres of hills, 100 boulders, 60 trees.
pub(super) fn terrain(random: &mut Random) -> Result<Scene, GeometryError> {
    const SIDE: usize = 257;
    let phases: [f64; 6] = std::array::from_fn(|_| random.uniform(0.0, TAU));
    let height = |x: f64, z: f64| {
        let [a, b, c, d, e, f] = phases;
        8.0 * (0.03 * x + a).sin() * (0.025 * z + b).cos()
            + 3.0 * (0.11 * x + 0.07 * z + c).sin()
            + 0.8 * (0.37 * z - 0.31 * x + d).sin()
            + 0.2 * (1.3 * x + e).sin() * (1.1 * z + f).sin()
    };
    let sample = |number: usize| height((number % SIDE) as f64, (number / SIDE) as f64) as f32;
    let heights: Vec<f32> = (0..SIDE * SIDE).map(sample).collect();
    let terrain = Terrain { columns: SIDE, rows: SIDE, heights: &heights, spacing: DVec3::ONE, holes: &[] };
    let ground = Arc::new(Geometry::height_field(&terrain)?);
    let mut items = vec![fixed(&ground, DVec3::ZERO)];
    let place = |random: &mut Random, up: f64| {
        let (x, z) = (random.uniform(2.0, 254.0), random.uniform(2.0, 254.0));
        DVec3::new(x, height(x, z) + up, z)
    };
    for _ in 0..100 {
        let size = random.uniform(0.4, 1.6);
        let boulder = Arc::new(Geometry::ellipsoid(DVec3::new(1.0, 0.7, 0.85) * size)?);
        items.push(fixed(&boulder, place(random, 0.2)));
    }
    let tree = Arc::new(Geometry::capsule(3.0, 0.3)?);
    items.extend((0..60).map(|_| fixed(&tree, place(random, 3.0))));
    let car = Arc::new(Geometry::cuboid(DVec3::new(2.1, 0.7, 0.9))?);
    items.extend((0..40).map(|_| moving(&car, Pose::new(place(random, 0.9), upright(random)))));
    let subjects = vec![Arc::new(Geometry::capsule(0.55, 0.35)?), car, Arc::new(Geometry::sphere(0.3)?)];
    Ok(Scene { name: "terrain".into(), items, subjects, size: 1.5 })
}

/// Twelve rows of eight fluted columns between floor and ceiling.
pub(super) fn columns(random: &mut Random) -> Result<Scene, GeometryError> {
    let column = bodies::column(20, 4.0, 0.7)?;
    let slab = Arc::new(Geometry::cuboid(DVec3::new(30.0, 0.25, 22.0))?);
    let mut items = vec![fixed(&slab, DVec3::NEG_Y * 4.25), fixed(&slab, DVec3::Y * 4.25)];
    for number in 0..96 {
        let at = DVec3::new(f64::from(number % 12) * 4.8 - 26.4, 0.0, f64::from(number / 12) * 5.4 - 18.9);
        let pose = Pose::new(at, upright(random));
        items.push(Item { pose, ..fixed(&column, at) });
    }
    let visitor = Arc::new(Geometry::capsule(0.55, 0.35)?);
    for _ in 0..60 {
        let at = DVec3::new(random.uniform(-29.0, 29.0), -3.1, random.uniform(-21.0, 21.0));
        items.push(moving(&visitor, Pose::at(at)));
    }
    let subjects =
        vec![visitor, Arc::new(Geometry::cuboid(DVec3::new(0.8, 0.4, 0.5))?), bodies::pebble(random, 40, 0.6)?];
    Ok(Scene { name: "columns".into(), items, subjects, size: 1.0 })
}
