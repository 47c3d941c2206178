//! From the stretch of a ray inside a convex body to what the ray touches of it.

use glam::DVec3;

use super::{Faces, Ray, RayTouch, RayTouches, frame::LocalRay};
use crate::{
    answer::{Bound, Certificate, Feature, Method, Model, Stop, Verdict},
    math::Pose,
};

/// Where a line enters and leaves a body. Distances are metres along the ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub entry: Wall,
    pub exit: Wall,
    /// Whether it is proved that the line meets the body. If not, the bounds hold should it do so.
    pub certain: bool,
    pub method: Method,
    pub stop: Stop,
    pub iterations: u32,
}

/// Where a line goes through the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    pub bound: Bound,
    pub best: f64,
    /// Outward normal, local frame; need not be of unit length.
    pub normal: DVec3,
    pub face: Option<u32>,
}

/// What was found out about one wall.
pub(super) struct Judged {
    wall: Wall,
    bound: Bound,
    best: f64,
    verdict: Verdict,
    inside: bool,
}

impl Judged {
    /// Metres along the ray: the best value.
    pub(super) fn distance(&self) -> f64 {
        self.best
    }

    /// The ray begins inside.
    pub(super) fn is_inside(&self) -> bool {
        self.inside
    }
}

impl Crossing {
    /// What the ray touches of the body.
    pub(super) fn touches(&self, ray: &Ray, local: &LocalRay, pose: &Pose) -> RayTouches {
        let (certain, undecided) = self.judged(ray, local.first, local.last);
        let touch = |judged: Judged| {
            let outwards = local.normal_to_world(judged.wall.normal);
            let is_from_inside = judged.wall.normal.dot(local.direction) > 0.0;
            let towards_asker = if is_from_inside { DVec3::ZERO - outwards } else { outwards };
            let point = local.to_world(pose, local.point_at(judged.best));
            self.touch(judged, point, towards_asker)
        };
        RayTouches { certain: certain.map(touch), undecided: undecided.map(touch) }
    }

    /// The certain touch between two distances, and the one that may be closer.
    pub(super) fn judged(&self, ray: &Ray, first: f64, last: f64) -> (Option<Judged>, Option<Judged>) {
        if self.entry.bound.lower > last || self.exit.bound.upper < first {
            return (None, None);
        }
        match ray.faces {
            Faces::Both if ray.hollow && self.certain => self.hollow(first, last),
            Faces::Both => self.solid(first, last),
            Faces::Front => self.one_wall(self.entry, first, last),
            Faces::Back => self.one_wall(self.exit, first, last),
        }
    }

    /// A touch at a point of the world.
    pub(super) fn touch(&self, judged: Judged, point: DVec3, towards_asker: DVec3) -> RayTouch {
        let Judged { wall, inside, .. } = judged;
        RayTouch {
            distance: judged.best + 0.0,
            point,
            normal: (!inside).then_some(towards_asker),
            inside,
            feature: Feature { part: None, face: if inside { None } else { wall.face } },
            barycentric: None,
            certificate: Certificate {
                method: self.method,
                stop: self.stop,
                iterations: self.iterations,
                ..certificate(judged.verdict, judged.bound)
            },
        }
    }

    /// A full body: a ray that begins inside touches where it begins.
    fn solid(&self, first: f64, last: f64) -> (Option<Judged>, Option<Judged>) {
        let (entry, exit) = (self.entry.bound, self.exit.bound);
        let is_hit = self.certain && entry.upper <= last && exit.lower >= first;
        let lower = entry.lower.max(first);
        let upper = if is_hit { entry.upper.max(first) } else { exit.upper.min(last) };
        let judged = Judged {
            wall: self.entry,
            bound: Bound::new(lower, upper.max(lower)),
            best: self.entry.best.clamp(lower, upper.max(lower)),
            verdict: if is_hit { Verdict::Hit } else { Verdict::Undecided },
            inside: self.entry.best < first,
        };
        if is_hit { (Some(judged), None) } else { (None, Some(judged)) }
    }

    /// This wall only.
    fn one_wall(&self, wall: Wall, first: f64, last: f64) -> (Option<Judged>, Option<Judged>) {
        match judge_wall(wall, first, last) {
            Some(judged) if self.certain && judged.verdict == Verdict::Hit => (Some(judged), None),
            judged => (None, judged.map(|judged| Judged { verdict: Verdict::Undecided, ..judged })),
        }
    }

    /// Walls only: the nearest of the two that the ray reaches.
    fn hollow(&self, first: f64, last: f64) -> (Option<Judged>, Option<Judged>) {
        let entry = judge_wall(self.entry, first, last);
        match entry {
            Some(entry) if entry.verdict == Verdict::Hit => (Some(entry), None),
            entry => match judge_wall(self.exit, first, last) {
                Some(exit) if exit.verdict == Verdict::Hit => (Some(exit), entry),
                exit => (None, entry.or(exit)),
            },
        }
    }
}

/// Whether a wall that is surely there lies between `first` and `last`; `None` if surely not.
fn judge_wall(wall: Wall, first: f64, last: f64) -> Option<Judged> {
    let Bound { lower, upper } = wall.bound;
    if upper < first || lower > last {
        return None;
    }
    let is_hit = lower >= first && upper <= last;
    let bound = Bound::new(lower.max(first), upper.min(last));
    Some(Judged {
        wall,
        bound,
        best: wall.best.clamp(bound.lower, bound.upper),
        verdict: if is_hit { Verdict::Hit } else { Verdict::Undecided },
        inside: false,
    })
}

/// The certificate of a value found by formula.
pub(super) fn certificate(verdict: Verdict, bound: Bound) -> Certificate {
    Certificate {
        verdict,
        bound: Bound::new(bound.lower + 0.0, bound.upper + 0.0),
        model: Model::EXACT,
        method: Method::ClosedForm,
        stop: Stop::Converged,
        iterations: 1,
    }
}
