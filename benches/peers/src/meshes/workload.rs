//! The meshes and what they are asked: the same for every engine, in numbers that f32 holds exactly.

use std::{io, iter};

use collision::{DVec3, math::Aabb};

use super::{dungeon::dungeon, rows::Level};
use crate::{
    dice::Dice,
    files,
    forms::{Form, Place, single, vector},
};

/// Questions of each kind.
const QUESTIONS: usize = 20_000;
/// How far forms are cast, metres.
pub(super) const CAST_LENGTH: f32 = 20.0;

/// Triangles over vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Triangles {
    pub(super) vertices: Vec<[f32; 3]>,
    pub(super) indices: Vec<[u32; 3]>,
}

impl Triangles {
    fn bounds(&self) -> Aabb {
        let corners = self.vertices.iter().copied().map(vector);
        let (min, max) = corners
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), corner| (min.min(corner), max.max(corner)));
        Aabb::new(min, max)
    }
}

/// A ray or the way of a form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) origin: Place,
    /// A unit vector, but for the rounding to f32.
    pub(super) direction: [f32; 3],
}

/// A mesh, and what it is asked.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Workload {
    pub(super) mesh: Triangles,
    pub(super) rays: Vec<Line>,
    /// Where a capsule may be.
    pub(super) places: Vec<Place>,
    /// Ways that a form may take, in a random order; some begin where it has no room.
    ways: Vec<Line>,
}

impl Workload {
    /// The same each time.
    ///
    /// # Errors
    /// The file of the mesh cannot be read.
    pub(super) fn new(level: Level) -> io::Result<Self> {
        let mesh = match level {
            Level::Dungeon => dungeon(),
            Level::NavTest => {
                let (vertices, indices) = files::obj(&files::folder().join("nav_test.obj"))?;
                Triangles { vertices: vertices.into_iter().map(single).collect(), indices }
            }
        };
        let bounds = mesh.bounds();
        let dice = &mut Dice::new(mesh.indices.len() as u64);
        let half = (bounds.max - bounds.min) * 0.5;
        let place = |dice: &mut Dice| Place {
            position: single(bounds.min + half + dice.point(1.0) * half),
            rotation: dice.rotation().to_array().map(|part| part as f32),
        };
        let line = |dice: &mut Dice| Line { origin: place(dice), direction: single(dice.direction()) };
        let rays = iter::repeat_with(|| line(dice)).take(QUESTIONS).collect();
        let ways = iter::repeat_with(|| line(dice)).take(2 * QUESTIONS).collect();
        let places = iter::repeat_with(|| place(dice)).take(QUESTIONS).collect();
        Ok(Self { mesh, rays, places, ways })
    }

    /// The form of the balls that are cast.
    pub(super) fn ball() -> Form {
        Form::Ball(0.3)
    }

    /// The form of the capsules.
    pub(super) fn capsule() -> Form {
        Form::Capsule { half_height: 0.6, radius: 0.3 }
    }

    /// The first of the ways that begin where there is room.
    pub(super) fn free_ways(&self, is_free: impl Fn(&Place) -> bool) -> Vec<Line> {
        self.ways.iter().filter(|way| is_free(&way.origin)).take(QUESTIONS).copied().collect()
    }
}
