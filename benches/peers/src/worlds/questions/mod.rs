//! What a world is asked: exact shapes behind a tree, the closest hit or all of them.

mod ours;
mod parry;

use std::iter;

use parry3d::shape::{Ball, Shape};

use super::{obvhs, rows::Question, workload::Workload};
use crate::{
    errors::{Errors, Proof},
    forms::{Form, Place, parry_shape, pose, vector},
    timing::{self, Times, spent},
};

/// Radius of the balls that are asked what they overlap, metres.
const OVERLAP_RADIUS: f32 = 0.5;
/// Radius of the balls that are cast, metres.
const CAST_RADIUS: f32 = 0.25;
/// How far balls are cast, metres.
const CAST_LENGTH: f32 = 10.0;

/// One world in both engines, as it is and after a tick of far moves.
pub(super) struct Worlds<'w> {
    workload: &'w Workload,
    ours: ours::Side,
    parry_still: parry::World<'w>,
    parry_moved: parry::World<'w>,
}

/// The shapes that [`Worlds::new`] wants.
pub(super) fn shapes(workload: &Workload) -> Vec<Box<dyn Shape>> {
    parry::shapes(workload)
}

impl<'w> Worlds<'w> {
    pub(super) fn new(workload: &'w Workload, shapes: &'w [Box<dyn Shape>]) -> Self {
        let parry_still = parry::World::new(shapes, workload);
        let parry_moved = parry_still.moved(workload);
        Self { workload, ours: ours::Side::new(workload), parry_still, parry_moved }
    }

    /// Measures one row.
    pub(super) fn measure(&self, question: Question) -> (Times, Errors) {
        match question {
            Question::RayShort => self.raycast(&self.ours.still, &self.parry_still, 10.0),
            Question::RayLong => self.raycast(&self.ours.still, &self.parry_still, 1000.0),
            Question::RayLongAfterMoves => self.raycast(&self.ours.moved, &self.parry_moved, 1000.0),
            Question::OverlapBall => {
                let place = |position: &[f32; 3]| Place { position: *position, rotation: [0.0, 0.0, 0.0, 1.0] };
                let places: Vec<Place> = self.workload.balls.iter().map(place).collect();
                self.overlap(&Form::Ball(OVERLAP_RADIUS), &places)
            }
            Question::OverlapCuboid => self.overlap(&Workload::cuboid(), &self.workload.cuboids),
            Question::CastBall => self.cast(),
        }
    }

    fn raycast(&self, ours: &collision::world::Snapshot, parry: &parry::World<'_>, length: f32) -> (Times, Errors) {
        use ours::Question as _;
        let lines = &self.workload.rays;
        let (rays, parry_rays) = (ours::rays(lines, f64::from(length)), parry::rays(lines));
        let proofs: Vec<Proof> = rays.iter().map(|ray| ours::of_ray(&ray.ask(ours))).collect();
        let metres = lines.iter().map(|line| vector(line.direction).length());
        let claims = parry_rays.iter().map(|ray| parry.raycast(ray, length)).zip(metres);
        let claims: Vec<Option<f64>> = claims.map(|(hit, unit)| hit.map(|hit| f64::from(hit) * unit)).collect();
        let times = timing::compare(
            rays.len(),
            |count| ours::time(ours, &rays, count),
            |count| parry::time(&parry_rays, count, |ray| parry.raycast(ray, length)),
        );
        let times = self.beside_obvhs(times, parry, &parry_rays, length);
        (times, Errors::between(&proofs, &claims))
    }

    /// Not after moves: obvhs has no tree that follows them and stays as fast.
    fn beside_obvhs(&self, times: Times, parry: &parry::World<'_>, rays: &[parry3d::query::Ray], length: f32) -> Times {
        if !std::ptr::eq(parry, &self.parry_still) {
            return times;
        }
        let tree = obvhs::build(&obvhs::boxes(&self.workload.boxes));
        let obvhs_rays = obvhs::rays(&self.workload.rays, length);
        let cast = |(ray, obvhs_ray): (&parry3d::query::Ray, &::obvhs::ray::Ray)| {
            obvhs::raycast(&tree, obvhs_ray, |shape, limit| parry.raycast_shape(ray, shape, limit))
        };
        let differing = rays.iter().zip(&obvhs_rays).filter(|pair| cast(*pair) != parry.raycast(pair.0, length));
        assert!(differing.count() * 1000 < rays.len(), "obvhs finds what parry3d finds");
        times.beside_obvhs(|count| spent(rays.iter().zip(&obvhs_rays).take(count), cast))
    }

    fn overlap(&self, form: &Form, places: &[Place]) -> (Times, Errors) {
        use ours::Question as _;
        let (ours, parry) = (&self.ours.still, &self.parry_still);
        let questions = ours::overlaps(form, places.iter().map(pose));
        let (shape, poses) = (parry_shape(form), parry::poses(places.iter().copied()));
        let mut hits = Vec::new();
        let (mut proofs, mut claims, mut hit_count) = (Vec::new(), Vec::new(), 0);
        for (question, pose) in questions.iter().zip(&poses) {
            let found = ours::of_overlap(&question.ask(ours));
            parry.overlap(&*shape, pose, &mut hits);
            hits.sort_unstable();
            hit_count += usize::from(!found.is_empty());
            for &(number, proof) in &found {
                proofs.push(proof);
                claims.push(hits.binary_search(&number).is_ok().then_some(0.0));
            }
            let strays = hits.iter().filter(|number| found.binary_search_by_key(number, |(own, _)| own).is_err());
            claims.extend(strays.map(|_| Some(0.0)));
            proofs.extend(iter::repeat_n(Proof::NONE, claims.len() - proofs.len()));
        }
        let times = timing::compare(
            questions.len(),
            |count| ours::time(ours, &questions, count),
            |count| parry::time(&poses, count, |pose| parry.overlap(&*shape, pose, &mut hits)),
        );
        let hit_share = hit_count as f64 / questions.len() as f64;
        (times, Errors { hit_share, ..Errors::between(&proofs, &claims) })
    }

    fn cast(&self) -> (Times, Errors) {
        use ours::Question as _;
        let (ours, parry) = (&self.ours.still, &self.parry_still);
        let form = Form::Ball(CAST_RADIUS);
        let lines = self.workload.free_ways(|origin| {
            let here = iter::once(collision::math::Pose::at(vector(*origin)));
            ours::overlaps(&form, here).iter().all(|question| ours::is_free(ours, question))
        });
        let questions = ours::casts(&form, &lines, CAST_LENGTH);
        let (ball, casts) = (Ball::new(CAST_RADIUS), parry::casts(&lines, CAST_LENGTH));
        let lengths: Vec<f64> = questions.iter().map(|question| question.displacement.length()).collect();
        let proofs = questions.iter().zip(&lengths).map(|(question, way)| ours::of_cast(&question.ask(ours), *way));
        let proofs: Vec<Proof> = proofs.collect();
        let claims = casts
            .iter()
            .zip(&lengths)
            .map(|(cast, way)| parry.cast(&ball, cast).map(|fraction| f64::from(fraction) * way));
        let claims: Vec<Option<f64>> = claims.collect();
        let times = timing::compare(
            questions.len(),
            |count| ours::time(ours, &questions, count),
            |count| parry::time(&casts, count, |cast| parry.cast(&ball, cast)),
        );
        (times, Errors::between(&proofs, &claims))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_engines_find_the_same() {
        let workload = Workload::new(1000);
        let shapes = shapes(&workload);
        let worlds = Worlds::new(&workload, &shapes);
        for (question, shares) in [
            (Question::RayShort, 0.3..0.95),
            (Question::RayLong, 0.3..0.95),
            (Question::RayLongAfterMoves, 0.3..0.95),
            (Question::OverlapBall, 0.1..0.9),
            (Question::OverlapCuboid, 0.9..1.01),
            (Question::CastBall, 0.3..0.95),
        ] {
            let (times, errors) = worlds.measure(question);
            assert!(times.operations > 1000, "{question:?}");
            assert!(shares.contains(&errors.hit_share), "{question:?}: {}", errors.hit_share);
            assert!(errors.max_error < 1e-9, "{question:?}: {}", errors.max_error);
            assert!(errors.peer_wrong_count < 10, "{question:?}: {}", errors.peer_wrong_count);
            assert!(errors.peer_error_p999 < 0.01, "{question:?}: {}", errors.peer_error_p999);
        }
    }
}
