//! The same question moved, turned or scaled: what must not change an answer, or only with it.

use collision::narrow::Motion;
use glam::{DQuat, DVec3};

use super::{
    moves::MoveQuestion,
    pairs::Question,
    whole::{PlacedWhole, Whole},
    whole_pairs::WholeQuestion,
};
use crate::oracle::{Core, PlacedSolid, Solid};

/// A rigid motion of the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rigid {
    pub(super) turn: DQuat,
    pub(super) shift: DVec3,
}

/// What can be moved rigidly and scaled by a power of two.
pub(super) trait Movable {
    /// The same elsewhere. Positions and rotations are rounded: it is a question of its own, near to this one.
    fn moved(&self, by: &Rigid) -> Self;
    /// The same, so many times as large. Exact for powers of two, as far as no number leaves its range.
    fn scaled(&self, by: f64) -> Self;
}

impl Movable for Solid {
    fn moved(&self, _: &Rigid) -> Self {
        self.clone()
    }

    fn scaled(&self, by: f64) -> Self {
        let core = match &self.core {
            Core::Point => Core::Point,
            Core::Segment { half_height } => Core::Segment { half_height: half_height * by },
            Core::Cuboid { half_extents } => Core::Cuboid { half_extents: *half_extents * by },
            Core::Hull(points) => Core::Hull(points.iter().map(|point| *point * by).collect()),
            Core::Cylinder { half_height, radius } => {
                Core::Cylinder { half_height: half_height * by, radius: radius * by }
            }
            Core::Cone { half_height, radius } => Core::Cone { half_height: half_height * by, radius: radius * by },
            Core::Ellipsoid { radii } => Core::Ellipsoid { radii: *radii * by },
            Core::HalfSpace { normal, offset } => Core::HalfSpace { normal: *normal, offset: offset * by },
        };
        Self { core, radius: self.radius * by }
    }
}

impl Movable for Whole {
    fn moved(&self, _: &Rigid) -> Self {
        self.clone()
    }

    fn scaled(&self, by: f64) -> Self {
        match self {
            Self::Convex(solid) => Self::Convex(solid.scaled(by)),
            Self::Mesh { mode, vertices, triangles } => Self::Mesh {
                mode: *mode,
                vertices: vertices.iter().map(|vertex| *vertex * by).collect(),
                triangles: triangles.clone(),
            },
            Self::Field { columns, heights, spacing, holes } => Self::Field {
                columns: *columns,
                heights: heights.clone(),
                spacing: *spacing * by,
                holes: holes.clone(),
            },
            Self::Compound(parts) => Self::Compound(
                parts.iter().map(|(part, position, rotation)| (part.scaled(by), *position * by, *rotation)).collect(),
            ),
        }
    }
}

impl Movable for PlacedSolid {
    fn moved(&self, by: &Rigid) -> Self {
        let position = by.turn * self.position + by.shift;
        Self { position, rotation: by.turn * self.rotation, ..self.clone() }
    }

    fn scaled(&self, by: f64) -> Self {
        Self { solid: self.solid.scaled(by), position: self.position * by, ..self.clone() }
    }
}

impl Movable for PlacedWhole {
    fn moved(&self, by: &Rigid) -> Self {
        let position = by.turn * self.position + by.shift;
        Self { position, rotation: by.turn * self.rotation, ..self.clone() }
    }

    fn scaled(&self, by: f64) -> Self {
        Self { whole: self.whole.scaled(by), position: self.position * by, ..self.clone() }
    }
}

impl Movable for Question {
    fn moved(&self, by: &Rigid) -> Self {
        let (position, rotation) = self.before;
        let before = (by.turn * position + by.shift, by.turn * rotation);
        Self { a: self.a.moved(by), b: self.b.moved(by), before, ..self.clone() }
    }

    fn scaled(&self, by: f64) -> Self {
        let mut scaled = self.clone();
        (scaled.a, scaled.b) = (self.a.scaled(by), self.b.scaled(by));
        scaled.before.0 *= by;
        scaled.accuracy.max_error *= by;
        scaled.limit *= by;
        scaled.max_gap *= by;
        scaled
    }
}

impl Movable for WholeQuestion {
    fn moved(&self, by: &Rigid) -> Self {
        Self { sides: self.sides.each_ref().map(|side| side.moved(by)), ..self.clone() }
    }

    fn scaled(&self, by: f64) -> Self {
        let mut scaled = self.clone();
        scaled.sides = self.sides.each_ref().map(|side| side.scaled(by));
        scaled.accuracy.max_error *= by;
        scaled.limit *= by;
        scaled.max_gap *= by;
        scaled
    }
}

impl Movable for MoveQuestion {
    fn moved(&self, by: &Rigid) -> Self {
        let Motion { displacement_a, displacement_b, rotation_a, rotation_b, initial } = self.motion;
        let turned = [displacement_a, displacement_b, rotation_a, rotation_b].map(|v| by.turn * v);
        let [displacement_a, displacement_b, rotation_a, rotation_b] = turned;
        let motion = Motion { displacement_a, displacement_b, rotation_a, rotation_b, initial };
        Self { sides: self.sides.each_ref().map(|side| side.moved(by)), motion, ..self.clone() }
    }

    fn scaled(&self, by: f64) -> Self {
        let mut scaled = self.clone();
        scaled.sides = self.sides.each_ref().map(|side| side.scaled(by));
        scaled.accuracy.max_error *= by;
        scaled.motion.displacement_a *= by;
        scaled.motion.displacement_b *= by;
        scaled
    }
}
