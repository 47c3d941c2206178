//! Boxes and rays as obvhs has them: a tree that is built whole, eight boxes in a node; rays ask parry3d's shapes at the leaves,
//! so that the columns of the two differ by their trees alone.

use std::time::Duration;

use glam::Vec3A;
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    cwbvh::{CwBvh, builder::build_cwbvh},
    ray::{Ray, RayHit},
};

use super::workload::{Bounds, Line};

fn vector(coordinates: [f32; 3]) -> Vec3A {
    Vec3A::from_array(coordinates)
}

pub(super) fn boxes(boxes: &[Bounds]) -> Vec<Aabb> {
    boxes.iter().map(|bounds| Aabb { min: vector(bounds.min), max: vector(bounds.max) }).collect()
}

/// The preset in the middle: the faster ones build in less time, and their rays take longer.
pub(super) fn build(boxes: &[Aabb]) -> CwBvh {
    build_cwbvh(boxes, BvhBuildParams::medium_build(), &mut Duration::default())
}

/// Rays of a length in multiples of their directions.
pub(super) fn rays(lines: &[Line], length: f32) -> Vec<Ray> {
    lines.iter().map(|line| Ray::new(vector(line.origin), vector(line.direction), 0.0, length)).collect()
}

/// Multiples of the direction to the closest hit; `cast` says where a ray meets a shape, up to a limit.
pub(super) fn raycast(tree: &CwBvh, ray: &Ray, cast: impl Fn(u32, f32) -> Option<f32>) -> Option<f32> {
    let mut hit = RayHit::none();
    let found = tree.ray_traverse(*ray, &mut hit, |ray, place| {
        cast(tree.primitive_indices[place], ray.tmax).unwrap_or(f32::INFINITY)
    });
    found.then_some(hit.t)
}
