//! The questions as a user of parry3d would ask them: of its mesh, which has a tree of its own.

use parry3d::{
    math::{Pose, Vector},
    query::{self, Ray, RayCast as _, ShapeCastOptions},
    shape::{Shape, TriMesh},
};

use super::{
    ours::RAY_LENGTH,
    workload::{CAST_LENGTH, Line, Triangles},
};
use crate::forms::parry_pose;

const SUPPORTED: &str = "meshes and capsules are supported";

/// What [`build`] wants.
pub(super) fn input(mesh: &Triangles) -> (Vec<Vector>, Vec<[u32; 3]>) {
    (mesh.vertices.iter().copied().map(Vector::from_array).collect(), mesh.indices.clone())
}

pub(super) fn build((vertices, indices): (Vec<Vector>, Vec<[u32; 3]>)) -> TriMesh {
    TriMesh::new(vertices, indices).expect("there are triangles")
}

/// A form at a pose, and its way.
pub(super) struct Cast {
    pose: Pose,
    way: Vector,
}

pub(super) fn rays(lines: &[Line]) -> Vec<Ray> {
    let ray = |line: &Line| Ray::new(Vector::from_array(line.origin.position), Vector::from_array(line.direction));
    lines.iter().map(ray).collect()
}

pub(super) fn casts(lines: &[Line]) -> Vec<Cast> {
    let cast = |line: &Line| Cast {
        pose: parry_pose(&line.origin),
        way: Vector::from_array(line.direction.map(|part| part * CAST_LENGTH)),
    };
    lines.iter().map(cast).collect()
}

/// Multiples of the direction to the closest hit.
pub(super) fn raycast(mesh: &TriMesh, ray: &Ray) -> Option<f32> {
    mesh.cast_local_ray(ray, RAY_LENGTH, true)
}

pub(super) fn overlap(mesh: &TriMesh, form: &dyn Shape, pose: &Pose) -> bool {
    query::intersection_test(pose, form, &Pose::IDENTITY, mesh).expect(SUPPORTED).intersecting
}

/// The part of the way to the first touch.
pub(super) fn cast(mesh: &TriMesh, form: &dyn Shape, Cast { pose, way }: &Cast) -> Option<f32> {
    let options = ShapeCastOptions {
        compute_impact_geometry_on_penetration: false,
        ..ShapeCastOptions::with_max_time_of_impact(1.0)
    };
    let hit = query::cast_shapes(pose, *way, form, &Pose::IDENTITY, Vector::ZERO, mesh, options).expect(SUPPORTED);
    hit.map(|hit| hit.time_of_impact)
}
