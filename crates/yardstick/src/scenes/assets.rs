//! Scenes of a real asset many times over.

use std::f64::consts::TAU;

use collision::{DQuat, DVec3, math::Pose, shape::GeometryError, world::Mobility};

use super::{Item, Scene, TakenFor, Triangles};
use crate::scene::Random;

/// How many stand in a row, and how many rows there are.
const SIDE: u32 = 11;

/// From one to the next, as a part of its diagonal: boxes of neighbours meet, and most of the animals do not.
const SPACING: f64 = 0.8;

impl Scene {
    /// A herd: one asset 121 times, each looking its own way, about which one more of them is asked.
    ///
    /// # Errors
    /// The triangles are no mesh, or out of limits.
    pub fn herd(asset: &Triangles, seed: u64) -> Result<Self, GeometryError> {
        let alone = Self::of_files(std::slice::from_ref(asset), TakenFor::Mesh)?;
        let random = &mut Random::new(seed);
        let animal = &alone.items[0].geometry;
        let bounds = animal.local_bounds();
        let step = SPACING * (bounds.max - bounds.min).length();
        let item = |number: u32, random: &mut Random| {
            let place = DVec3::new(f64::from(number % SIDE), 0.0, f64::from(number / SIDE)) * step;
            let aside = random.direction() * DVec3::new(1.0, 0.0, 1.0) * (0.15 * step);
            let rotation = DQuat::from_rotation_y(random.uniform(0.0, TAU));
            let pose = Pose::new(place + aside - rotation * bounds.center(), rotation);
            Item { geometry: animal.clone(), pose, mobility: Mobility::Dynamic }
        };
        let items = (0..SIDE * SIDE).map(|number| item(number, random)).collect();
        let name = format!("herd of {}", asset.name);
        Ok(Self { name, items, subjects: vec![animal.clone()], size: animal.reach() })
    }
}
