//! The first touch of a form and a half space of which at least one turns.
//!
//! # Method
//! The height of the form above the plane is measured where both are at a time; [`advance`] does the rest. Let `z` be a
//! point of the form from the half space's origin, at most `D` away, `n` the plane's normal, `ω` and `μ` the turns of the form
//! and of the plane, `ρ` the form's reach from what it turns about and `v` the relative velocity. The height `n·z − offset` changes by at most
//! `|v| + |ω|ρ + |μ|D`, and its speed by at most `|ω|²ρ + 2|μ|(|v| + |ω|ρ) + |μ|²D`. Between two times `h` apart the height lies
//! above the parabola of that, as in `convex/motion.rs`.
//!
//! # Limits
//! A start that is ignored is ignored triangle by triangle, each of which is searched by itself; so are those of surfaces that are
//! felt from one side, unless nothing at all is touched. Two half spaces
//! of which one turns touch as soon as they are not parallel: what is not proved to touch at the start stays open.

use glam::DVec3;

use super::{Above, Body, Low, sides::Felt};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Feature, Method, Model, Verdict, Work},
    math::{Norm, Pose},
    narrow::{
        ImpactTouch, InitialTouch,
        advance::{self, Gaps, Instant, Look, Paces, Width},
        pieces::First,
        place::Place,
    },
    shape::{Convex, Core},
    tolerance::{ANGLE_ROUNDING, BEND_WIDENING, MOTION_ROUNDING, PAIR_ROUNDING},
};

/// How the form and the half space move.
#[derive(Clone, Copy)]
pub(super) struct Ways {
    /// How far each goes: the form, the half space.
    pub(super) displacements: [DVec3; 2],
    /// How each turns.
    pub(super) rotations: [DVec3; 2],
    pub(super) initial: InitialTouch,
}

/// A form above a plane, in motion; the half space's local origin stays where it is.
struct Search<'a> {
    above: &'a Above<'a>,
    body: Body<'a>,
    ways: Ways,
    apart: DVec3,
    way: DVec3,
    paces: Paces,
    now: Option<Look>,
    budget: u32,
    iterations: u32,
}

impl Above<'_> {
    /// The first touch in a motion of which at least one side turns.
    pub(super) fn turning_impact(&self, ways: Ways, accuracy: &Accuracy, work: &mut Work) -> Option<ImpactTouch> {
        let felt = Felt::in_motion(self.body, ways.initial);
        let is_ignored = ways.initial == InitialTouch::IsIgnored && !matches!(self.body, Body::Convex(_));
        if !is_ignored {
            let touch = Search::new(self, self.body, ways, accuracy).touch(accuracy, work)?;
            if felt == Felt::All {
                return Some(touch);
            }
        }
        // Each triangle by itself: which touch is ignored, or felt, is another question for each.
        let mut first = First::default();
        self.body.each_triangle(|_, corners| {
            let piece = Convex { core: Core::Triangle(corners), radius: 0.0 };
            let mut search = Search::new(self, Body::Convex(&piece), ways, accuracy);
            let touch = search.touch(accuracy, work);
            first.offer(touch.filter(|touch| search.at(touch.fraction).feeling(felt).feels(corners)));
        });
        first.merged()
    }
}

impl<'a> Search<'a> {
    fn new(above: &'a Above<'a>, body: Body<'a>, ways: Ways, accuracy: &Accuracy) -> Self {
        let [to, to_space] = ways.displacements;
        let (apart, way) = (above.pose.position - above.arm - above.space_pose.position, to - to_space);
        let (core, reach) = match body {
            Body::Convex(convex) => (convex.core.reach(), convex.core.reach() + convex.radius),
            Body::Mesh(_) | Body::Field(_) => (above.reach, above.reach),
        };
        let arm = above.arm.norm();
        let (core, reach) = (core + arm, reach + arm);
        let [spin, tilt] = ways.rotations.map(Norm::norm);
        let farthest = apart.norm().max((apart + way).norm()) + reach;
        let extent = farthest + way.norm() + above.half_space.offset.abs();
        let paces = Paces {
            speed: (way.norm() + spin * core + tilt * farthest) * BEND_WIDENING,
            bend: (spin * spin * core + 2.0 * tilt * (way.norm() + spin * core) + tilt * tilt * farthest)
                * BEND_WIDENING,
            turn: spin.max(tilt),
            doubt: (PAIR_ROUNDING + MOTION_ROUNDING + ANGLE_ROUNDING * (spin + tilt)) * extent + above.blur,
        };
        Self { above, body, ways, apart, way, paces, now: None, budget: accuracy.budget, iterations: 0 }
    }

    fn touch(&mut self, accuracy: &Accuracy, work: &mut Work) -> Option<ImpactTouch> {
        let radius = if let Body::Convex(convex) = self.body { convex.radius } else { 0.0 };
        let [spin, _] = self.ways.rotations.map(Norm::norm);
        let width = Width::of(accuracy, self.paces.speed + spin * radius);
        let initial = self.ways.initial;
        let touch = advance::first_touch(self, 0.0, &width, initial);
        work.pairs_tested += 1;
        work.iterations += u64::from(self.iterations);
        let touch = touch?;
        let [_, to_space] = self.ways.displacements;
        Some(ImpactTouch {
            fraction: touch.fraction,
            point: touch.point + self.above.space_pose.position + to_space * touch.fraction,
            normal_b_to_a: touch.normal,
            initial: touch.is_initial,
            feature_b: Feature::default(),
            certificate: Certificate {
                verdict: touch.verdict,
                bound: Bound::new(touch.bound.lower, touch.bound.upper),
                model: Model::EXACT,
                method: Method::Advancement,
                stop: touch.stop,
                iterations: self.iterations,
            },
        })
    }

    /// Where both are at a time.
    fn at(&self, time: f64) -> Above<'a> {
        let [rotation, tilt] = self.ways.rotations;
        let arm = Pose::new(DVec3::ZERO, Pose::IDENTITY.rotation_after(rotation, time)).transform_point(self.above.arm);
        let position = self.apart + self.way * time + arm;
        let pose = Pose::new(position, self.above.pose.rotation_after(rotation, time));
        let space_pose = Pose::new(DVec3::ZERO, self.above.space_pose.rotation_after(tilt, time));
        let place = Place { pose, blur: 0.0, arm };
        Above::of(self.body, self.above.reach, &place, self.above.half_space, space_pose)
    }
}

impl Gaps for Search<'_> {
    fn look(&mut self, time: f64) -> Look {
        self.iterations = self.iterations.saturating_add(1);
        let above = self.at(time);
        let Low { point, radius, .. } = above.lowest();
        let height = above.height(point, radius);
        let error = above.error_at(height) + self.paces.doubt;
        let normal = above.plane.normal;
        let on_form = above.pose.matrix() * point;
        let [rotation, tilt] = self.ways.rotations;
        let growth = normal.dot(self.way + rotation.cross(above.arm + on_form))
            + tilt.cross(normal).dot(above.pose.position + on_form);
        let look = Look {
            instant: Instant { time, free: height - error, normal },
            gap: height,
            growth,
            is_overlap: height + error <= 0.0,
            point: above.point_out(point, radius),
        };
        self.now = Some(look);
        look
    }

    fn look_closely(&mut self, time: f64) -> Look {
        self.look(time)
    }

    fn depth(&mut self) -> f64 {
        self.now.map_or(0.0, |look| -look.gap - self.paces.doubt)
    }

    fn at_rest(&mut self) -> Verdict {
        let Above { reach, pose, blur, arm, half_space, space_pose, .. } = *self.above;
        let above = Above::of(self.body, reach, &Place { pose, blur, arm }, half_space, space_pose);
        above.signed(self.body, &above.lowest()).verdict
    }

    fn strain_between(&self, from: &Instant, to: &Instant) -> f64 {
        if from.free <= 0.0 || to.free <= 0.0 {
            return f64::INFINITY;
        }
        let time = to.time - from.time;
        // The square of the sum of both roots, by one root of an even power, so that a scale that is a power of two changes nothing.
        let root_sq = from.free + to.free + 2.0 * (from.free * to.free).sqrt();
        let (straight, bent) = (self.paces.speed * time, self.paces.bend * time * time * 0.5);
        (straight / (from.free + to.free)).min(bent / root_sq) * BEND_WIDENING
    }

    fn is_free_to_end(&mut self, from: &Instant) -> bool {
        let end = self.look(1.0);
        self.strain_between(from, &end.instant) < 1.0
    }

    fn paces(&self) -> Paces {
        self.paces
    }

    fn remaining(&self) -> u32 {
        self.budget.saturating_sub(self.iterations)
    }
}
