//! Boxes as solid meshes, and convex forms and rays to ask about them.
#![allow(dead_code, reason = "each test file uses its part of it")]

use collision::{
    DQuat, DVec3,
    answer::Verdict,
    math::Pose,
    narrow::{Faces, Ray},
    shape::{Geometry, MeshMode},
};

use crate::whole::Numbers;

/// The triangles of a box, by the corners that [`box_corners`] gives.
pub(crate) const CUBE: [[u32; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];

/// A box as a solid mesh.
pub(crate) fn solid_box(half: DVec3) -> Geometry {
    Geometry::mesh_as(MeshMode::Solid, &box_corners(half), &CUBE).expect("a box")
}

/// The corners of a box about the origin.
pub(crate) fn box_corners(half: DVec3) -> [DVec3; 8] {
    [0_u32, 1, 2, 3, 4, 5, 6, 7].map(|i| half * (DVec3::from([i & 1, i >> 1 & 1, i >> 2].map(f64::from)) * 2.0 - 1.0))
}

/// A position, turned at random or not at all.
pub(crate) fn pose(numbers: &mut Numbers, position: DVec3, is_turned: bool) -> Pose {
    let [x, y, z, w] = [0; 4].map(|_| numbers.share());
    Pose::new(position, if is_turned { DQuat::from_xyzw(x, y, z, w) } else { DQuat::IDENTITY })
}

/// A convex form of some kind.
pub(crate) fn convex(numbers: &mut Numbers) -> Geometry {
    let half = numbers.shares().abs() * 0.6 + 0.01;
    let form = match numbers.below(6) {
        0 => Geometry::sphere(half.x),
        1 => Geometry::capsule(half.x, half.y),
        2 => Geometry::cuboid(half),
        3 => Geometry::cylinder(half.x, half.y),
        4 => Ok(Geometry::point()),
        _ => Geometry::hull(&[half, -half, half * DVec3::new(1.0, -1.0, 0.3), half * DVec3::new(-0.6, 0.5, 1.0)]),
    };
    form.expect("a form")
}

/// How often a law was asked of what is inside, crosses the surface, and is outside.
#[derive(Default, Debug)]
pub(crate) struct Tally {
    pub(crate) hits: u32,
    pub(crate) misses: u32,
    pub(crate) open: u32,
}

impl Tally {
    pub(crate) fn count(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Hit => self.hits += 1,
            Verdict::Miss => self.misses += 1,
            Verdict::Undecided => self.open += 1,
        }
    }

    /// As many of both, and nothing is left open that is not within rounding.
    pub(crate) fn is_balanced(&self) -> bool {
        self.hits.min(self.misses) * 4 > self.hits.max(self.misses) && self.open == 0
    }
}

/// A ray past a place, of any kind.
pub(crate) fn ray(numbers: &mut Numbers, around: DVec3) -> Ray {
    let origin = around + numbers.shares() * 1.5;
    let min_distance = if numbers.below(3) == 0 { numbers.share().abs() } else { 0.0 };
    Ray {
        origin,
        direction: around + numbers.shares() * 0.9 - origin,
        min_distance,
        max_distance: if numbers.below(4) == 0 { min_distance + 2.0 * numbers.share().abs() } else { 4e12 },
        hollow: numbers.below(2) == 0,
        faces: [Faces::Both, Faces::Both, Faces::Front, Faces::Back][numbers.below(4) as usize],
    }
}
