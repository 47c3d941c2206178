//! Rays against triangles: the tree, watertight edges, and which touch comes first.
//!
//! # Method
//! Each triangle that the tree offers is hit, missed or open. Open ones lie within the error of an edge. They are decided
//! together with their neighbours: if a patch of triangles all face alike and the ray surely passes inside each side of
//! the patch's border, it goes through one of them, whichever it is, because the border winds around it. Only
//! silhouettes and open borders stay undecided.

use std::convert::Infallible;

use glam::DVec3;
use smallvec::SmallVec;

use super::{
    Aim, Faces, RayTouch, RayTouches,
    crossing::certificate,
    frame::{LocalRay, Spot, Stretch, Target},
    surface::Surface,
    triangle::{Meeting, Sight, Sign, View, normal},
};
use crate::{
    answer::{Bound, Feature, Verdict, Work},
    broad::Tree,
    math::Pose,
    shape::Geometry,
};

/// Triangles of a patch at most: more meet at one vertex only in contrived meshes, and then the touch stays undecided.
const PATCH_MAX: usize = 64;

/// A triangle that the ray may go through.
#[derive(Clone, Copy)]
struct Candidate {
    triangle: usize,
    bound: Bound,
    best: f64,
    verdict: Verdict,
}

/// What a ray touches of a surface of triangles.
pub(super) fn touches<S: Surface>(
    aim: &Aim<'_>,
    (mesh, geometry): (&S, &Geometry),
    spot: Spot<'_>,
    work: &mut Work,
) -> RayTouches {
    let center = Target::within(mesh.ball(), geometry.reach(), spot.blur);
    let local = LocalRay::new(aim, spot.pose, center);
    let Some(Stretch { path, length, before }) = local.stretch(center.radius) else {
        return RayTouches::default();
    };
    let sight = Sight::new(&local, center.center);
    let sieve = local.sieve(&center, sight.across);
    let mut found = Found::default();
    let Ok(()) = mesh.tree().visit_near_ray(path, length, work, |work, leaf| {
        work.pairs_tested += 1;
        work.iterations += 1;
        if !sieve.passes(mesh.corners(leaf as usize)) {
            found.look_at(&sight, mesh, leaf as usize, aim.ray.faces);
        }
        // No farther along the path than what is no farther along the ray.
        Ok::<f64, Infallible>(found.limit - before)
    });
    found.touches(&local, mesh, spot.pose)
}

/// Whether a triangle surely shows the ray a side that does not count.
fn is_culled(view: View, faces: Faces) -> bool {
    match faces {
        Faces::Both => false,
        Faces::Front => view.facing == Sign::Positive,
        Faces::Back => view.facing == Sign::Negative,
    }
}

/// The hull of when the ray meets a patch around `seed` that it surely goes through; `None` if there is no proof.
fn patch_meeting<S: Surface>(sight: &Sight<'_>, mesh: &S, seed: usize, view: View) -> Option<Bound> {
    let mut patch: SmallVec<[(usize, View); 16]> = SmallVec::new();
    patch.push((seed, view));
    let mut next = 0;
    while let Some(&(triangle, view)) = patch.get(next) {
        next += 1;
        for k in 0..3 {
            if oriented(view, view.edges[k])? == Sign::Positive {
                continue;
            }
            let (other, view_of_other) = across(sight, mesh, triangle, view, k)?;
            if patch.iter().all(|&(known, _)| known != other) {
                if patch.len() == PATCH_MAX {
                    return None;
                }
                patch.push((other, view_of_other));
            }
        }
    }
    let bounds = patch
        .iter()
        .filter(|(_, view)| !view.is_missed())
        .map(|&(triangle, _)| sight.meeting_of_neighbour(mesh.corners(triangle)));
    bounds.reduce(|a, b| Bound::new(a.lower.min(b.lower), a.upper.max(b.upper)))
}

/// The one triangle beyond a side, if it faces as this one does, so that the side is no silhouette.
fn across<S: Surface>(sight: &Sight<'_>, mesh: &S, triangle: usize, view: View, k: usize) -> Option<(usize, View)> {
    let (other, is_same_way) = mesh.across(triangle, k)?;
    let view_of_other = sight.view_of_neighbour(mesh.corners(other));
    let faces_alike = oriented(view, Sign::Positive)? == oriented(view_of_other, Sign::Positive)?;
    (is_same_way != faces_alike).then_some((other, view_of_other))
}

/// A sign as if the triangle were wound so that the ray meets it along its normal; `None` if it may be seen edge-on.
fn oriented(view: View, sign: Sign) -> Option<Sign> {
    match view.facing {
        Sign::Positive => Some(sign),
        Sign::Negative => Some(sign.flipped()),
        Sign::Zero | Sign::Unknown => None,
    }
}

/// All that may be the first touch.
struct Found {
    candidates: SmallVec<[Candidate; 4]>,
    /// A certain touch is not farther than this.
    limit: f64,
}

impl Default for Found {
    fn default() -> Self {
        Self { candidates: SmallVec::new(), limit: f64::INFINITY }
    }
}

impl Found {
    /// Keeps what is known of the ray and one triangle, unless it is surely not touched. Not in line, so that triangles that are passed by
    /// need no memory for those that are not.
    #[inline(never)]
    fn look_at<S: Surface>(&mut self, sight: &Sight<'_>, mesh: &S, triangle: usize, faces: Faces) {
        let corners = mesh.corners(triangle);
        let Some((view, meeting)) = sight.look(corners) else { return };
        if is_culled(view, faces) {
            return;
        }
        let (meeting, is_crossed) = if view.is_hit() {
            (meeting, true)
        } else {
            match patch_meeting(sight, mesh, triangle, view) {
                Some(bound) => (Meeting { bound, ..meeting }, true),
                None => (meeting, false),
            }
        };
        let (first, last) = (sight.ray.first, sight.ray.last);
        let Bound { mut lower, upper } = meeting.bound;
        if first == 0.0 && lower < 0.0 && upper >= 0.0 {
            match sight.is_ahead(corners) {
                Some(true) => lower = 0.0,
                Some(false) => return,
                None => {}
            }
        }
        if upper < first || lower > last || lower > self.limit {
            return;
        }
        let is_within = lower >= first && upper <= last;
        // Seen edge-on, a triangle might be culled.
        let counts = faces == Faces::Both || view.facing != Sign::Unknown;
        let bound = Bound::new(lower.max(first), upper.min(last));
        let verdict = if is_crossed && is_within && counts { Verdict::Hit } else { Verdict::Undecided };
        if verdict == Verdict::Hit && bound.upper < self.limit {
            self.limit = bound.upper;
            self.candidates.retain(|known| known.bound.lower <= bound.upper);
        }
        let best = meeting.best.clamp(bound.lower, bound.upper);
        self.candidates.push(Candidate { triangle, bound, best, verdict });
    }

    /// The first by its best value; where others cannot be told from it (they share an edge there), the least number.
    fn touches<S: Surface>(&self, local: &LocalRay, mesh: &S, pose: &Pose) -> RayTouches {
        match self.candidates.as_slice() {
            [] => return RayTouches::default(),
            [only] => {
                let touch = Some(touch(local, mesh, pose, *only, only.bound));
                return match only.verdict {
                    Verdict::Hit => RayTouches { certain: touch, undecided: None },
                    Verdict::Undecided | Verdict::Miss => RayTouches { certain: None, undecided: touch },
                };
            }
            _ => {}
        }
        let pick = |verdict: Verdict| {
            let those = || self.candidates.iter().filter(move |candidate| candidate.verdict == verdict);
            let first = those().min_by(|a, b| {
                let by_number = a.triangle.cmp(&b.triangle);
                a.best.total_cmp(&b.best).then(by_number)
            })?;
            let is_same = |other: &&Candidate| other.bound.contains(first.best) && first.bound.contains(other.best);
            let winner = those().filter(is_same).min_by_key(|candidate| candidate.triangle)?;
            let lower = those().map(|candidate| candidate.bound.lower).fold(f64::INFINITY, f64::min);
            let upper = those().map(|candidate| candidate.bound.upper);
            let upper = match verdict {
                Verdict::Hit => upper.fold(f64::INFINITY, f64::min),
                Verdict::Undecided | Verdict::Miss => upper.fold(f64::NEG_INFINITY, f64::max),
            };
            Some(touch(local, mesh, pose, *winner, Bound::new(lower, upper)))
        };
        RayTouches { certain: pick(Verdict::Hit), undecided: pick(Verdict::Undecided) }
    }
}

fn touch<S: Surface>(local: &LocalRay, mesh: &S, pose: &Pose, winner: Candidate, bound: Bound) -> RayTouch {
    let best = winner.best.clamp(bound.lower, bound.upper);
    let corners = mesh.corners(winner.triangle);
    let (outwards, _) = normal(corners);
    let point = local.point_at(best);
    let towards_asker = if outwards.dot(local.direction) > 0.0 { DVec3::ZERO - outwards } else { outwards };
    RayTouch {
        distance: best + 0.0,
        point: local.to_world(pose, point),
        normal: Some(local.normal_to_world(towards_asker)),
        inside: false,
        feature: Feature { part: None, face: Some(mesh.face(winner.triangle)) },
        barycentric: S::weights(corners, point),
        certificate: certificate(winner.verdict, bound),
    }
}
