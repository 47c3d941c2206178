//! Worlds of mixed shapes for benches and examples: seeded, so that every run asks the same.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::sets::{Form, Placed, Pose};

/// A small, fast generator (SplitMix64; Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
/// The same seed gives the same numbers on every machine.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// From a seed; any number is a good one.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform from `low` to `high`, without `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        #[allow(clippy::cast_precision_loss, reason = "53 bits are exact in an f64")]
        let fraction = (self.bits() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64);
        low + (high - low) * fraction
    }

    /// True once in so many times.
    pub fn one_in(&mut self, count: u64) -> bool {
        self.bits().is_multiple_of(count)
    }

    /// A unit vector, uniform on the sphere.
    pub fn direction(&mut self) -> DVec3 {
        let z = self.uniform(-1.0, 1.0);
        let (sin, cos) = self.uniform(0.0, TAU).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cos, radius * sin, z)
    }

    /// A uniform rotation (Shoemake, "Uniform random rotations", Graphics Gems III, 1992).
    pub fn rotation(&mut self) -> DQuat {
        let split = self.uniform(0.0, 1.0);
        let (a, b) = (self.uniform(0.0, TAU).sin_cos(), self.uniform(0.0, TAU).sin_cos());
        let (first, second) = ((1.0 - split).sqrt(), split.sqrt());
        DQuat::from_xyzw(first * a.0, first * a.1, second * b.0, second * b.1)
    }
}

/// Shapes in a cube.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The shapes.
    pub shapes: Vec<Placed>,
    /// Half of the cube's edge, metres; its middle is the origin.
    pub half_edge: f64,
}

/// How many times the summed volume of the shapes the cube holds: 5 % of it is filled.
const CUBE_PER_SHAPE_VOLUME: f64 = 20.0;

/// `count` shapes, in turn box, box, sphere, capsule: box half extents and sphere radii 0.1 to 1 m, capsule half
/// segments and radii 0.1 to 0.5 m; centres uniform in a cube that they fill by about 5 %, rotations uniform.
#[must_use]
pub fn mixed(count: usize, seed: u64) -> Scene {
    let mut random = Random::new(seed);
    let forms: Vec<Form> = (0..count).map(|index| form(&mut random, index)).collect();
    let volume: f64 = forms.iter().map(volume).sum();
    let half_edge = 0.5 * (CUBE_PER_SHAPE_VOLUME * volume).cbrt();
    let shapes = forms
        .into_iter()
        .map(|form| {
            let mut coordinate = || random.uniform(-half_edge, half_edge);
            let position = DVec3::new(coordinate(), coordinate(), coordinate());
            Placed { form, pose: Pose { position, rotation: random.rotation() } }
        })
        .collect();
    Scene { shapes, half_edge }
}

fn form(random: &mut Random, index: usize) -> Form {
    match index % 4 {
        0 | 1 => {
            let mut edge = || random.uniform(0.1, 1.0);
            Form::Cuboid { half_extents: DVec3::new(edge(), edge(), edge()) }
        }
        2 => Form::Sphere { radius: random.uniform(0.1, 1.0) },
        _ => Form::Capsule { half_height: random.uniform(0.1, 0.5), radius: random.uniform(0.1, 0.5) },
    }
}

/// Cubic metres; only of the forms that a scene is made of.
fn volume(form: &Form) -> f64 {
    let ball = |radius: f64| 2.0 / 3.0 * TAU * radius * radius * radius;
    match form {
        Form::Sphere { radius } => ball(*radius),
        Form::Capsule { half_height, radius } => TAU * radius * radius * half_height + ball(*radius),
        Form::Cuboid { half_extents } => 8.0 * half_extents.element_product(),
        Form::Hull(_) | Form::Mesh(_) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_what_it_says() {
        let scene = mixed(400, 7);
        let count = |wanted: fn(&Form) -> bool| scene.shapes.iter().filter(|shape| wanted(&shape.form)).count();
        assert_eq!(count(|form| matches!(form, Form::Cuboid { .. })), 200);
        assert_eq!(count(|form| matches!(form, Form::Sphere { .. })), 100);
        assert_eq!(count(|form| matches!(form, Form::Capsule { .. })), 100);
        let filled: f64 = scene.shapes.iter().map(|shape| volume(&shape.form)).sum();
        let cube = (2.0 * scene.half_edge).powi(3);
        assert!((filled / cube - 0.05).abs() < 1e-12);
        assert!(scene.shapes.iter().all(|shape| shape.pose.position.abs().max_element() <= scene.half_edge));
    }

    #[test]
    fn a_seed_names_a_scene() {
        let place = |seed| mixed(8, seed).shapes[7].pose;
        assert_eq!(place(3), place(3));
        assert_ne!(place(3), place(4));
    }
}
