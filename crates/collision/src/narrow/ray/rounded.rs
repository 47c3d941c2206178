//! Rays against rounded hulls and polygons: a ray is a moving point.
//!
//! # Method
//! As for balls, the body is taken once larger and once smaller by the error of the ray. Only the stretch within the
//! body's ball is cast, so that a far origin costs nothing; the exit is found by a cast from the other end. Where the
//! radius is within the error there is no smaller body of this kind, and what crosses the core by its own formula is
//! inside.

use glam::DVec3;

use super::{
    core_crossing,
    crossing::{Crossing, Wall},
    frame::{LocalRay, Target},
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Method, Stop, Verdict, Work},
    math::Pose,
    narrow::{
        ImpactTouch, Motion,
        convex::{self, PlacedConvex},
    },
    shape::{Convex, Core},
};

/// Where the line crosses the body; `None` if surely nowhere.
pub(super) fn crossing(
    ray: &LocalRay,
    body: &Convex,
    about: Target,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Crossing> {
    let span = about.radius + 2.0 * ray.error;
    let caster = Caster { body, pose: Pose::at(DVec3::ZERO - about.center), accuracy, margin: 2.0 * ray.error };
    let (begin, end) = (ray.foot - ray.direction * span, ray.foot + ray.direction * span);
    let entry = caster.wall(begin, ray.direction * (2.0 * span), work)?;
    let exit = caster.wall(end, ray.direction * (-2.0 * span), work)?;
    let (near, far) = (ray.shift - span, ray.shift + span);
    let entry_at = |fraction: f64| near + fraction * (2.0 * span);
    let exit_at = |fraction: f64| far - fraction * (2.0 * span);
    let inner = if body.radius > caster.margin {
        let stretch = (entry_at(entry.bound.upper) + ray.error, exit_at(exit.bound.upper) - ray.error);
        (entry.certain && exit.certain).then_some(stretch)
    } else {
        let core = core_crossing(ray, &body.core, about.center).filter(|core| core.certain);
        core.map(|core| (core.entry.bound.upper, core.exit.bound.lower))
    };
    let whole = Bound::new(entry_at(entry.bound.lower) - ray.error, exit_at(exit.bound.lower) + ray.error);
    let (entry_bound, exit_bound) = inner.map_or((whole, whole), |(begin, end)| {
        (Bound::new(whole.lower, begin.max(whole.lower)), Bound::new(end.min(whole.upper), whole.upper))
    });
    let wall = |bound: Bound, best: f64, normal: DVec3| Wall { bound, best, normal, face: None };
    Some(Crossing {
        entry: wall(entry_bound, entry_at(entry.best), entry.normal.unwrap_or(DVec3::ZERO - ray.direction)),
        exit: wall(exit_bound, exit_at(exit.best), exit.normal.unwrap_or(ray.direction)),
        certain: inner.is_some(),
        method: Method::Advancement,
        stop: if entry.stop == Stop::Budget { entry.stop } else { exit.stop },
        iterations: entry.iterations.saturating_add(exit.iterations),
    })
}

struct Caster<'a> {
    body: &'a Convex,
    pose: Pose,
    accuracy: &'a Accuracy,
    margin: f64,
}

/// When a moving point gets to the surface, as a fraction of its motion.
struct Arrival {
    bound: Bound,
    best: f64,
    normal: Option<DVec3>,
    certain: bool,
    stop: Stop,
    iterations: u32,
}

impl Caster<'_> {
    fn wall(&self, origin: DVec3, motion: DVec3, work: &mut Work) -> Option<Arrival> {
        let outer = self.cast(self.margin, origin, motion, work)?;
        let inner = if self.body.radius > self.margin { self.cast(-self.margin, origin, motion, work) } else { None };
        let middle = self.cast(0.0, origin, motion, work);
        let casts = [Some(outer), inner, middle].into_iter().flatten();
        let is_spent = casts.clone().any(|touch| touch.certificate.stop == Stop::Budget);
        let iterations = casts.map(|touch| touch.certificate.iterations).fold(0, u32::saturating_add);
        let inner = inner.filter(|touch| touch.certificate.verdict == Verdict::Hit);
        let best = middle.map_or(outer.fraction, |touch| touch.fraction);
        Some(Arrival {
            bound: Bound::new(outer.certificate.bound.lower, inner.map_or(1.0, |touch| touch.certificate.bound.upper)),
            best,
            normal: middle.unwrap_or(outer).normal_b_to_a,
            certain: inner.is_some(),
            stop: if is_spent { Stop::Budget } else { Stop::Converged },
            iterations,
        })
    }

    fn cast(&self, growth: f64, origin: DVec3, motion: DVec3, work: &mut Work) -> Option<ImpactTouch> {
        let point = Convex { core: Core::Point, radius: 0.0 };
        let body = Convex { core: self.body.core.clone(), radius: self.body.radius + growth };
        let start = Pose::at(origin);
        let point = PlacedConvex::new(&point, &start);
        let body = PlacedConvex::new(&body, &self.pose);
        let motion = Motion { displacement_a: motion, ..Motion::default() };
        convex::impact(point, body, &motion, [DVec3::ZERO; 2], self.accuracy, work)
    }
}
