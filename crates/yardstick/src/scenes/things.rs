//! Things of extreme shape, place or number: needles, a planet's surface, coins.

use std::sync::Arc;

use collision::{
    DQuat, DVec3,
    math::Pose,
    shape::{Geometry, GeometryError},
    world::Mobility,
};

use super::{Item, Scene, bodies};
use crate::scene::{self, Random};
use crate::sets::Form;

/// 1,000 boxes, cones and rods of 1 to 6 metres, 100 to 1,000 times as long as wide.
pub(super) fn needles(random: &mut Random) -> Result<Scene, GeometryError> {
    let mut items = Vec::new();
    for number in 0..1000 {
        let half = random.uniform(0.5, 3.0);
        let thin = half / 10_f64.powf(random.uniform(2.0, 3.0));
        let needle = match number % 3 {
            0 => Geometry::cuboid(DVec3::new(thin, half, thin))?,
            1 => Geometry::cone(half, thin)?,
            _ => Geometry::capsule(half - thin, thin)?,
        };
        let position = DVec3::new(random.uniform(-8., 8.), random.uniform(-8., 8.), random.uniform(-8., 8.));
        let pose = Pose::new(position, random.rotation());
        items.push(Item { geometry: Arc::new(needle), pose, mobility: Mobility::Dynamic });
    }
    let mut subjects = bodies::usual(0.5)?;
    subjects.push(Arc::new(Geometry::cone(2.0, 0.01)?));
    Ok(Scene { name: "needles".into(), items, subjects, size: 1.0 })
}

/// Boxes, balls and capsules of the mixed scene about a point on a ball of 6,371 km, none of its coordinates round.
pub(super) fn planet(random: &mut Random) -> Result<Scene, GeometryError> {
    const RADIUS: f64 = 6_371_000.0;
    let up = DVec3::new(0.48, 0.6, 0.64);
    let ball = Arc::new(Geometry::sphere(RADIUS)?);
    let mut items = vec![Item { geometry: ball, pose: Pose::IDENTITY, mobility: Mobility::Static }];
    let mixed = scene::mixed(300, random.bits());
    for shape in mixed.shapes {
        let geometry = match shape.form {
            Form::Sphere { radius } => Geometry::sphere(radius)?,
            Form::Capsule { half_height, radius } => Geometry::capsule(half_height, radius)?,
            Form::Cuboid { half_extents } => Geometry::cuboid(half_extents)?,
            Form::Hull(_) | Form::Mesh(_) => continue,
        };
        let position = up * (RADIUS + mixed.half_edge) + shape.pose.position;
        let pose = Pose::new(position, shape.pose.rotation);
        items.push(Item { geometry: Arc::new(geometry), pose, mobility: Mobility::Dynamic });
    }
    Ok(Scene { name: "planet".into(), items, subjects: bodies::usual(0.6)?, size: 1.0 })
}

/// 400 coins of 24 mm in a heap, three of four of them round, the others of 256 corners a side; they overlap by a little.
pub(super) fn coins(random: &mut Random) -> Result<Scene, GeometryError> {
    let (round, cornered) = (Arc::new(Geometry::cylinder(0.001, 0.012)?), bodies::disc(256, 0.001, 0.012)?);
    let table = Arc::new(Geometry::cuboid(DVec3::new(0.3, 0.01, 0.3))?);
    let below = Pose::at(DVec3::NEG_Y * 0.01);
    let mut items = vec![Item { geometry: table, pose: below, mobility: Mobility::Static }];
    for number in 0..400 {
        let far = 0.08 * random.uniform(0.0, 1.0).sqrt();
        let (sin, cos) = random.uniform(0.0, std::f64::consts::TAU).sin_cos();
        let height = random.uniform(0.0, 1.0) * (0.02 - 0.2 * far) + 0.001;
        let lean = random.direction() * DVec3::new(0.3, 1.0, 0.3);
        let pose = Pose::new(DVec3::new(far * cos, height, far * sin), DQuat::from_scaled_axis(lean));
        let geometry = if number % 4 == 0 { cornered.clone() } else { round.clone() };
        items.push(Item { geometry, pose, mobility: Mobility::Dynamic });
    }
    let finger = Arc::new(Geometry::capsule(0.02, 0.006)?);
    let subjects = vec![cornered, round, finger];
    Ok(Scene { name: "coins".into(), items, subjects, size: 0.012 })
}
