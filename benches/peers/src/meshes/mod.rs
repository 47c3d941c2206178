//! Part C: triangle meshes, what they cost to build and what their answers cost.

mod dungeon;
#[cfg(feature = "embree")]
mod embree;
mod obvhs;
mod ours;
mod parry;
mod rows;
mod workload;

use std::io;

use collision::{math::Pose, narrow::Placed, shape::Geometry};
use parry3d::shape::TriMesh;

pub(crate) use rows::{Task, rows};

use crate::{
    errors::{Errors, Proof},
    forms::{Form, geometry, parry_pose, parry_shape, pose},
    report::Outcome,
    rows::{Row, Task as AnyTask},
    timing::{self, Times, spent, time_of},
};
use ours::Side;
use rows::{LEVELS, Operation};
use workload::Workload;

/// Measures those of the rows that are of part C, mesh by mesh, and hands over each as it is done.
pub(crate) fn measure(rows: &[Row], mut done: impl FnMut(Outcome) -> io::Result<()>) -> io::Result<()> {
    for level in LEVELS {
        let tasks = rows.iter().filter_map(|row| match row.task {
            AnyTask::Mesh(task) if task.level == level => Some((row, task.operation)),
            _ => None,
        });
        let tasks: Vec<(&Row, Operation)> = tasks.collect();
        if tasks.is_empty() {
            continue;
        }
        let subject = Subject::new(Workload::new(level)?);
        for (row, operation) in tasks {
            let (times, errors) = subject.measure(operation);
            done(Outcome { row: row.clone(), times, errors })?;
        }
    }
    Ok(())
}

/// One mesh in both engines.
struct Subject {
    workload: Workload,
    ours: Geometry,
    parry: TriMesh,
}

impl Subject {
    fn new(workload: Workload) -> Self {
        let ours = ours::build(&ours::input(&workload.mesh));
        let parry = parry::build(parry::input(&workload.mesh));
        Self { workload, ours, parry }
    }

    fn side<'a>(&'a self, form: &'a Geometry) -> Side<'a> {
        Side { mesh: Placed { geometry: &self.ours, pose: Pose::IDENTITY }, form }
    }

    fn measure(&self, operation: Operation) -> (Times, Errors) {
        match operation {
            Operation::Build => self.build(),
            Operation::Ray => self.raycast(),
            Operation::CastBall => self.cast(&Workload::ball()),
            Operation::CastCapsule => self.cast(&Workload::capsule()),
            Operation::OverlapCapsule => self.overlap(),
        }
    }

    /// Without answers to compare; the other rows ask what was built.
    fn build(&self) -> (Times, Errors) {
        let (ours, parry) = (ours::input(&self.workload.mesh), parry::input(&self.workload.mesh));
        let times = timing::compare_whole(
            self.workload.mesh.indices.len(),
            || time_of(|| ours::build(&ours)),
            || {
                let input = parry.clone();
                time_of(|| parry::build(input))
            },
        );
        let triangles = obvhs::triangles(&self.workload.mesh);
        let times = times.beside_obvhs(|_| time_of(|| obvhs::build(&triangles)));
        #[cfg(feature = "embree")]
        let times = times.beside_embree(|_| time_of(|| embree::Scene::new(&self.workload.mesh)));
        (times, Errors::default())
    }

    fn raycast(&self) -> (Times, Errors) {
        let lines = &self.workload.rays;
        let (rays, parry_rays) = (ours::rays(lines), parry::rays(lines));
        let side = self.side(&self.ours);
        let proofs: Vec<Proof> = rays.iter().map(|ray| side.raycast(ray)).collect();
        let unit = |number: usize| rays[number].direction.length();
        let claims = parry_rays.iter().map(|ray| parry::raycast(&self.parry, ray));
        let claims: Vec<Option<f64>> =
            claims.enumerate().map(|(number, hit)| hit.map(|hit| f64::from(hit) * unit(number))).collect();
        let times = timing::compare(
            rays.len(),
            |count| side.time_rays(&rays, count),
            |count| spent(parry_rays[..count].iter(), |ray| parry::raycast(&self.parry, ray)),
        );
        let triangles = obvhs::triangles(&self.workload.mesh);
        let tree = obvhs::build(&triangles);
        let (ordered, obvhs_rays) = (obvhs::in_order(&tree, &triangles), obvhs::rays(lines));
        let times =
            times.beside_obvhs(|count| spent(obvhs_rays[..count].iter(), |ray| obvhs::raycast(&tree, &ordered, ray)));
        #[cfg(feature = "embree")]
        let times = {
            let (scene, rays) = (embree::Scene::new(&self.workload.mesh), embree::rays(lines));
            times.beside_embree(|count| spent(rays[..count].iter(), |ray| scene.raycast(ray)))
        };
        (times, Errors::between(&proofs, &claims))
    }

    fn cast(&self, form: &Form) -> (Times, Errors) {
        let (own, shape) = (geometry(form), parry_shape(form));
        let side = self.side(&own);
        let lines = self.workload.free_ways(|place| side.is_free(place));
        let (casts, parry_casts) = (ours::casts(&lines), parry::casts(&lines));
        let proofs: Vec<Proof> = casts.iter().map(|cast| side.cast(cast)).collect();
        let claims = parry_casts.iter().zip(&casts).map(|(cast, own)| {
            parry::cast(&self.parry, &*shape, cast).map(|fraction| f64::from(fraction) * own.length())
        });
        let claims: Vec<Option<f64>> = claims.collect();
        let times = timing::compare(
            casts.len(),
            |count| side.time_casts(&casts, count),
            |count| spent(parry_casts[..count].iter(), |cast| parry::cast(&self.parry, &*shape, cast)),
        );
        (times, Errors::between(&proofs, &claims))
    }

    fn overlap(&self) -> (Times, Errors) {
        let form = Workload::capsule();
        let (own, shape) = (geometry(&form), parry_shape(&form));
        let side = self.side(&own);
        let places = &self.workload.places;
        let (poses, parry_poses): (Vec<_>, Vec<_>) =
            (places.iter().map(pose).collect(), places.iter().map(parry_pose).collect());
        let proofs: Vec<Proof> = poses.iter().map(|pose| side.overlap(pose)).collect();
        let claims = parry_poses.iter().map(|pose| parry::overlap(&self.parry, &*shape, pose).then_some(0.0));
        let claims: Vec<Option<f64>> = claims.collect();
        let times = timing::compare(
            poses.len(),
            |count| side.time_overlaps(&poses, count),
            |count| spent(parry_poses[..count].iter(), |pose| parry::overlap(&self.parry, &*shape, pose)),
        );
        (times, Errors::between(&proofs, &claims))
    }
}

#[cfg(test)]
mod tests {
    use super::{rows::Level, *};

    #[test]
    fn both_engines_find_the_same() {
        let subject = Subject::new(Workload::new(Level::Dungeon).expect("it is made here"));
        for (operation, shares) in [
            (Operation::Ray, 0.3..0.97),
            (Operation::CastBall, 0.3..0.97),
            (Operation::CastCapsule, 0.3..0.97),
            (Operation::OverlapCapsule, 0.05..0.7),
        ] {
            let (times, errors) = subject.measure(operation);
            assert!(times.operations > 1000, "{operation:?}");
            assert!(shares.contains(&errors.hit_share), "{operation:?}: {}", errors.hit_share);
            assert!(errors.max_error < 1e-6, "{operation:?}: {}", errors.max_error);
            assert!(errors.peer_wrong_count < 40, "{operation:?}: {}", errors.peer_wrong_count);
            assert!(errors.peer_error_p999 < 0.05, "{operation:?}: {}", errors.peer_error_p999);
        }
    }
}
