//! Forms that scenes are made of.

use std::{f64::consts::TAU, sync::Arc};

use collision::{
    DVec3,
    shape::{Geometry, GeometryError},
};

use crate::scene::Random;

pub(super) type Made = Result<Arc<Geometry>, GeometryError>;

/// A ball, a capsule and a box that reach about as far as `radius`, metres.
pub(super) fn usual(radius: f64) -> Result<Vec<Arc<Geometry>>, GeometryError> {
    let ball = Geometry::sphere(radius)?;
    let capsule = Geometry::capsule(0.6 * radius, 0.4 * radius)?;
    let cuboid = Geometry::cuboid(DVec3::new(0.7, 0.5, 0.4) * radius)?;
    Ok([ball, capsule, cuboid].map(Arc::new).to_vec())
}

/// The hull of points on a ball that is a little uneven.
pub(super) fn pebble(random: &mut Random, count: usize, radius: f64) -> Made {
    let squash = DVec3::new(1.0, random.uniform(0.5, 1.0), random.uniform(0.6, 1.0)) * radius;
    let points: Vec<DVec3> = (0..count).map(|_| random.direction() * squash).collect();
    Geometry::hull(&points).map(Arc::new)
}

/// A closed mesh of `2 * rings * 2 * rings` triangles and a few: a ball with dents.
pub(super) fn rock(random: &mut Random, rings: u32, radius: f64) -> Made {
    let dents: Vec<(DVec3, f64)> = (0..6).map(|_| (random.direction(), random.uniform(0.15, 0.5))).collect();
    let at = |direction: DVec3| {
        let dent = |(middle, deep): &(DVec3, f64)| deep * (1.0 - 1.5 * (direction - *middle).length_squared()).max(0.0);
        direction * (radius * (1.0 - dents.iter().map(dent).sum::<f64>().min(0.75)))
    };
    let columns = 2 * rings;
    let mut vertices = vec![at(DVec3::Y), at(DVec3::NEG_Y)];
    for ring in 1..rings {
        let (sin, cos) = (TAU * 0.5 * f64::from(ring) / f64::from(rings)).sin_cos();
        for column in 0..columns {
            let (z, x) = (TAU * f64::from(column) / f64::from(columns)).sin_cos();
            vertices.push(at(DVec3::new(x * sin, cos, z * sin)));
        }
    }
    Geometry::mesh(&vertices, &around(rings, columns)).map(Arc::new)
}

/// The triangles of rings of corners between corner 0 at the top and corner 1 at the bottom, seen from outside
/// counter-clockwise.
fn around(rings: u32, columns: u32) -> Vec<[u32; 3]> {
    let corner = |ring: u32, column: u32| 2 + (ring - 1) * columns + column % columns;
    let mut triangles = Vec::new();
    for column in 0..columns {
        triangles.push([0, corner(1, column + 1), corner(1, column)]);
        triangles.push([1, corner(rings - 1, column), corner(rings - 1, column + 1)]);
        for ring in 1..rings - 1 {
            let [a, b] = [corner(ring, column), corner(ring, column + 1)];
            let [c, d] = [corner(ring + 1, column), corner(ring + 1, column + 1)];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    triangles
}

/// A fluted column: a closed mesh along y about the local origin, with foot and head.
pub(super) fn column(flutes: u32, half_height: f64, radius: f64) -> Made {
    let columns = 4 * flutes;
    let profile = [(1.0, 1.35), (0.93, 1.35), (0.9, 1.0), (0.45, 0.98), (0.0, 0.97), (-0.45, 0.98), (-0.9, 1.0)];
    let profile = profile.into_iter().chain([(-0.93, 1.35), (-1.0, 1.35)]);
    let mut vertices = vec![DVec3::Y * half_height, DVec3::NEG_Y * half_height];
    let mut rings = 1;
    for (height, wide) in profile {
        rings += 1;
        for column in 0..columns {
            let (z, x) = (TAU * f64::from(column) / f64::from(columns)).sin_cos();
            let groove = if wide > 1.2 { 0.0 } else { [0.0, 0.08, 0.12, 0.08][column as usize % 4] };
            let far = radius * (wide - groove);
            vertices.push(DVec3::new(x * far, height * half_height, z * far));
        }
    }
    Geometry::mesh(&vertices, &around(rings, columns)).map(Arc::new)
}

/// A disc along y as the hull of two rings of corners.
pub(super) fn disc(corners: u32, half_height: f64, radius: f64) -> Made {
    let corner = |number: u32| {
        let (z, x) = (TAU * f64::from(number) / f64::from(corners)).sin_cos();
        [half_height, -half_height].map(|height| DVec3::new(x * radius, height, z * radius))
    };
    let points: Vec<DVec3> = (0..corners).flat_map(corner).collect();
    Geometry::hull(&points).map(Arc::new)
}

/// A ramp: a box of these half extents with one upper edge cut away.
pub(super) fn ramp(half: DVec3) -> Made {
    let corners = [(-1., -1., -1.), (1., -1., -1.), (-1., -1., 1.), (1., -1., 1.), (1., 1., -1.), (1., 1., 1.)];
    Geometry::hull(&corners.map(|(x, y, z)| DVec3::new(x, y, z) * half)).map(Arc::new)
}
