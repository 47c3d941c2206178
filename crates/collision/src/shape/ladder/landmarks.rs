//! Some points of a geometry, by which it is told how near to it others are.
//!
//! # Method
//! Whatever points of a geometry are taken, the nearest of them is no nearer than the geometry: what is measured to them is an
//! upper bound, and the denser they lie the better it is. Large triangles are strewn with points, by their area; of many
//! small ones every so many gives a corner.

use glam::DVec3;

use super::super::{Compound, Convex, Core, Form, Geometry, Mesh};
use crate::math::Norm;

/// About how many are taken.
const LANDMARKS: usize = 1024;

/// Points of a geometry, at least one, each to within a few roundings of its reach.
pub(super) fn of(geometry: &Geometry) -> Vec<DVec3> {
    let mut points = Vec::new();
    add(geometry, LANDMARKS, &mut |point| points.push(point));
    points
}

fn add(geometry: &Geometry, most: usize, take: &mut dyn FnMut(DVec3)) {
    match geometry.form() {
        Form::Convex(convex) => add_convex(convex, most, take),
        Form::Mesh(mesh) => add_mesh(mesh, most, take),
        Form::Compound(compound) => add_compound(compound, most, take),
        Form::HeightField(field) => {
            let step = field.cell_count().div_ceil(most).max(1);
            let mut count = 0;
            field.each_triangle(|_, [corner, ..]| {
                if count % step == 0 {
                    take(corner);
                }
                count += 1;
            });
        }
        Form::HalfSpace(half_space) => take(half_space.normal * half_space.offset),
    }
}

fn add_convex(convex: &Convex, most: usize, take: &mut dyn FnMut(DVec3)) {
    match &convex.core {
        Core::Point => take(DVec3::ZERO),
        Core::Segment { half_height } => [-half_height, *half_height].map(|y| take(DVec3::Y * y)).into_iter().collect(),
        Core::Cuboid { half_extents: h } => {
            for corner in 0..8 {
                let side = |axis: usize| if corner >> axis & 1 == 1 { h[axis] } else { -h[axis] };
                take(DVec3::new(side(0), side(1), side(2)));
            }
        }
        Core::Hull(hull) => every_so_many(hull.vertices().len(), most).for_each(|at| take(hull.vertices()[at])),
        Core::Triangle(corners) => corners.map(&mut *take).into_iter().collect(),
        Core::Cylinder { half_height, radius } => {
            for y in [-half_height, *half_height] {
                around_axis(*radius, y, take);
            }
        }
        Core::Cone { half_height, radius } => {
            take(DVec3::Y * *half_height);
            around_axis(*radius, -half_height, take);
        }
        Core::Ellipsoid { radii } => {
            for (axis, radius) in DVec3::AXES.into_iter().zip(radii.to_array()) {
                take(axis * radius);
                take(-axis * radius);
            }
        }
    }
}

fn around_axis(radius: f64, y: f64, take: &mut dyn FnMut(DVec3)) {
    for [x, z] in [[radius, 0.0], [-radius, 0.0], [0.0, radius], [0.0, -radius]] {
        take(DVec3::new(x, y, z));
    }
}

fn add_mesh(mesh: &Mesh, most: usize, take: &mut dyn FnMut(DVec3)) {
    let count = mesh.triangles().len();
    if count >= most {
        every_so_many(count, most).for_each(|triangle| take(mesh.corners(triangle)[0]));
        return;
    }
    let area = |triangle: usize| {
        let [a, b, c] = mesh.corners(triangle);
        (b - a).cross(c - a).norm()
    };
    let all: f64 = (0..count).map(area).sum();
    for triangle in 0..count {
        let share = area(triangle) / all;
        // Of `n` steps along an edge come half of n² points. NaN and what is too small to measure give the corners.
        let steps = (2.0 * share * (most - count) as f64).sqrt().clamp(1.0, most as f64).floor();
        strew(mesh.corners(triangle), steps, take);
    }
}

fn strew([a, b, c]: [DVec3; 3], steps: f64, take: &mut dyn FnMut(DVec3)) {
    let count = steps as usize;
    for i in 0..=count {
        for j in 0..=count - i {
            take(a + (b - a) * (i as f64 / steps) + (c - a) * (j as f64 / steps));
        }
    }
}

fn add_compound(compound: &Compound, most: usize, take: &mut dyn FnMut(DVec3)) {
    let parts = compound.parts();
    let share = (most / parts.len()).max(1);
    for at in every_so_many(parts.len(), most) {
        let axes = parts[at].pose.matrix();
        add(&parts[at].geometry, share, &mut |point| take(axes * point + parts[at].pose.position));
    }
}

/// At most `most` numbers below `count`, evenly spread.
fn every_so_many(count: usize, most: usize) -> impl Iterator<Item = usize> {
    (0..count).step_by(count.div_ceil(most).max(1))
}
