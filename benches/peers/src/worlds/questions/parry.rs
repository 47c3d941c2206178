//! The questions as a user of parry3d would ask them: its tree with a limit that shrinks, and its shapes at the leaves.

use std::time::Duration;

use parry3d::{
    bounding_volume::Aabb,
    math::{Pose, Real, Vector},
    partitioning::{Bvh, BvhBuildStrategy, BvhNode, BvhWorkspace},
    query::{self, Ray, RayCast as _, ShapeCastHit, ShapeCastOptions},
    shape::{Ball, Shape},
};

use crate::{
    forms::{Place, parry_pose, parry_shape},
    timing::spent,
    worlds::workload::{Line, Workload},
};

const SUPPORTED: &str = "all kinds of the workload are supported";

/// Shapes, where they are and the tree over their boxes.
#[derive(Clone)]
pub(super) struct World<'s> {
    shapes: &'s [Box<dyn Shape>],
    poses: Vec<Pose>,
    tree: Bvh,
}

/// The shapes of a workload.
pub(super) fn shapes(workload: &Workload) -> Vec<Box<dyn Shape>> {
    workload.forms.iter().map(parry_shape).collect()
}

impl<'s> World<'s> {
    /// With a tree that is built whole, which is searched fastest.
    pub(super) fn new(shapes: &'s [Box<dyn Shape>], workload: &Workload) -> Self {
        let poses: Vec<Pose> = workload.places.iter().map(parry_pose).collect();
        let boxes: Vec<Aabb> = shapes.iter().zip(&poses).map(|(shape, pose)| shape.compute_aabb(pose)).collect();
        Self { shapes, poses, tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes) }
    }

    /// The same after a tick of far moves, boxes enlarged in place and refitted.
    pub(super) fn moved(&self, workload: &Workload) -> Self {
        let mut moved = self.clone();
        for (shape, place) in &workload.far_moves {
            let pose = parry_pose(place);
            moved.poses[*shape as usize] = pose;
            let bounds = self.shapes[*shape as usize].compute_aabb(&pose);
            moved.tree.insert_or_update_partially(bounds, *shape, 0.0);
        }
        moved.tree.refit(&mut BvhWorkspace::default());
        moved
    }

    fn at(&self, leaf: u32) -> (&'s dyn Shape, &Pose) {
        (&*self.shapes[leaf as usize], &self.poses[leaf as usize])
    }

    /// Multiples of the direction to the closest hit.
    pub(super) fn raycast(&self, ray: &Ray, limit: f32) -> Option<f32> {
        let hit = self.tree.cast_ray(ray, limit, |leaf, best| self.raycast_shape(ray, leaf, best));
        hit.map(|(_, distance)| distance)
    }

    /// The same for one shape.
    pub(super) fn raycast_shape(&self, ray: &Ray, leaf: u32, limit: f32) -> Option<f32> {
        let (shape, pose) = self.at(leaf);
        shape.cast_ray(pose, ray, limit, true)
    }

    /// The shapes that touch a form, into a list that is used again.
    pub(super) fn overlap(&self, form: &dyn Shape, pose: &Pose, hits: &mut Vec<u32>) {
        hits.clear();
        let bounds = form.compute_aabb(pose);
        hits.extend(self.tree.intersect_aabb(&bounds).filter(|&leaf| {
            let (shape, pose_of_shape) = self.at(leaf);
            query::intersection_test(pose, form, pose_of_shape, shape).expect(SUPPORTED).intersecting
        }));
    }

    /// The part of the way to the first touch: the library's own search in a compound, with a limit that shrinks.
    pub(super) fn cast(&self, ball: &Ball, Cast { pose, way }: &Cast) -> Option<f32> {
        let bounds = ball.compute_aabb(pose);
        let (shift, margin) = (-bounds.center(), bounds.half_extents());
        let ray = Ray::new(Vector::ZERO, *way);
        let hit: Option<(u32, ShapeCastHit)> = self.tree.find_best(
            1.0,
            |node: &BvhNode, best: Real| {
                let sum = Aabb { mins: node.mins() + shift - margin, maxs: node.maxs() + shift + margin };
                sum.cast_local_ray(&ray, best, true).unwrap_or(Real::MAX)
            },
            |leaf, best| {
                let (shape, pose_of_shape) = self.at(leaf);
                let options = ShapeCastOptions {
                    max_time_of_impact: best,
                    compute_impact_geometry_on_penetration: false,
                    ..ShapeCastOptions::default()
                };
                query::cast_shapes(pose_of_shape, Vector::ZERO, shape, pose, *way, ball, options).expect(SUPPORTED)
            },
        );
        hit.map(|(_, hit)| hit.time_of_impact)
    }
}

/// A ball on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cast {
    pose: Pose,
    way: Vector,
}

pub(super) fn rays(lines: &[Line]) -> Vec<Ray> {
    let ray = |line: &Line| Ray::new(Vector::from_array(line.origin), Vector::from_array(line.direction));
    lines.iter().map(ray).collect()
}

pub(super) fn casts(lines: &[Line], length: f32) -> Vec<Cast> {
    let cast = |line: &Line| Cast {
        pose: Pose::from_translation(Vector::from_array(line.origin)),
        way: Vector::from_array(line.direction.map(|part| part * length)),
    };
    lines.iter().map(cast).collect()
}

pub(super) fn poses(places: impl Iterator<Item = Place>) -> Vec<Pose> {
    places.map(|place| parry_pose(&place)).collect()
}

/// CPU time of asking one question of each item.
pub(super) fn time<Question, Answer>(
    questions: &[Question],
    count: usize,
    ask: impl FnMut(&Question) -> Answer,
) -> Duration {
    spent(questions[..count].iter(), ask)
}
