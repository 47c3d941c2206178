//! Meshes and rays as obvhs has them: its eight-wide tree over its own triangles, none of whose tests is watertight.

use std::time::Duration;

use glam::Vec3A;
use obvhs::{
    BvhBuildParams,
    cwbvh::{CwBvh, builder::build_cwbvh_from_tris},
    ray::{Ray, RayHit},
    triangle::Triangle,
};

use super::{
    ours::RAY_LENGTH,
    workload::{Line, Triangles},
};

pub(super) fn triangles(mesh: &Triangles) -> Vec<Triangle> {
    let vertex = |index: u32| Vec3A::from_array(mesh.vertices[index as usize]);
    mesh.indices.iter().map(|&[a, b, c]| Triangle { v0: vertex(a), v1: vertex(b), v2: vertex(c) }).collect()
}

/// The preset in the middle: the faster ones build in less time, and their rays take longer.
pub(super) fn build(triangles: &[Triangle]) -> CwBvh {
    build_cwbvh_from_tris(triangles, BvhBuildParams::medium_build(), &mut Duration::default())
}

pub(super) fn rays(lines: &[Line]) -> Vec<Ray> {
    let vector = Vec3A::from_array;
    lines.iter().map(|line| Ray::new(vector(line.origin.position), vector(line.direction), 0.0, RAY_LENGTH)).collect()
}

/// The triangles in the order of a tree.
pub(super) fn in_order(tree: &CwBvh, triangles: &[Triangle]) -> Vec<Triangle> {
    tree.primitive_indices.iter().map(|&index| triangles[index as usize]).collect()
}

/// Multiples of the direction to the closest hit.
pub(super) fn raycast(tree: &CwBvh, ordered: &[Triangle], ray: &Ray) -> Option<f32> {
    let mut hit = RayHit::none();
    tree.ray_traverse(*ray, &mut hit, |ray, place| ordered[place].intersect(ray)).then_some(hit.t)
}
