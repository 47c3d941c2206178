//! The first touch of two convex forms in motion; of forms that do not turn here, of others in [`super::turning`].
//!
//! # Method
//! Conservative advancement: the plane that GJK proves between the cores also says how long the way stays free, so the
//! pair is moved to where the plane would be reached, and again. The signed distance of convex forms is a convex function
//! of the time, so for polytopes this ends after finitely many planes and for round forms it converges as Newton's method
//! does. Once the gap is within rounding, an instant of proved overlap is sought just beyond, at growing steps: a small
//! gap proves no touch.
//!
//! The frame of a long way is coarse: what is apart at the start may touch in it, and then has no normal in it. Such a touch is
//! sought once more in the frame of the way up to it.
//!
//! Most pairs never come to that. The balls around the forms ([`balls`]) miss each other or tell where to begin; boxes
//! are asked by their axes ([`slide`]), polytopes by the face in the way ([`portal`]), others by a search whose target
//! moves ([`cast`]), and what was nearest at the end of that proves the overlap a moment later.
//!
//! # Source
//! Mirtich, "Impulse-based dynamic simulation" (1996), section 2.3; van den Bergen, "Ray casting against general convex
//! objects" (2004) for the same planes seen as a ray cast.

use glam::DVec3;

use super::{
    PlacedConvex, balls, boxes,
    cast::{self, Approach},
    frame::Pair,
    gjk,
    motion::Swings,
    order, overlapping, portal, rods,
    simplex::Simplex,
    slide::{self, Slide},
    turning,
    warm::Seed,
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Feature, Method, Model, Stop, Verdict, Work},
    math::Norm,
    narrow::{ImpactTouch, InitialTouch, Motion, advance::Touch},
    shape::Core,
    tolerance::{PAIR_ROUNDING, STEP_SHORTENING},
};

/// The first touch of `a` and `b` in motion; `None` is a proof that the way is free, or that it is so after an initial
/// touch that is ignored. `arms` are the vectors from what each turns about to its own local origin at the start, in the axes
/// of the world: 0 unless it is part of something.
pub(crate) fn impact(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    motion: &Motion,
    arms: [DVec3; 2],
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<ImpactTouch> {
    work.pairs_tested += 1;
    let touch = sought(a, b, motion, arms, accuracy, work)?;
    let Certificate { bound: Bound { lower, upper }, stop, iterations, .. } = touch.certificate;
    let is_within_rounding = stop == Stop::Converged && lower == 0.0 && !touch.initial && upper <= PART_LONGEST;
    if !is_within_rounding {
        return Some(touch);
    }
    let finer = sought(a, b, &motion.until(upper), arms, accuracy, work);
    let Some(finer) = finer.filter(|finer| finer.certificate.verdict == Verdict::Hit && !finer.initial) else {
        return Some(touch);
    };
    let found = finer.certificate;
    let bound =
        Bound::new((found.bound.lower * upper).next_down().max(0.0), (found.bound.upper * upper).next_up().min(upper));
    let certificate = Certificate { bound, iterations: iterations.saturating_add(found.iterations), ..found };
    Some(ImpactTouch { fraction: (finer.fraction * upper).clamp(bound.lower, bound.upper), certificate, ..finer })
}

/// The frame of a longer part of the way than this is no finer than that of the whole.
const PART_LONGEST: f64 = 0.5;

/// The same in the frame of the whole way.
fn sought(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    motion: &Motion,
    arms: [DVec3; 2],
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<ImpactTouch> {
    let relative = motion.displacement_a - motion.displacement_b;
    let turns = [turn_of(a, motion.rotation_a, arms[0]), turn_of(b, motion.rotation_b, arms[1])];
    let is_swapped = is_swapped(a, b, motion);
    let (first, second, way) = if is_swapped { (b, a, -relative) } else { (a, b, relative) };
    let (touch, method_iterations, pair, swung);
    let (mut linear, mut turning);
    if turns == [DVec3::ZERO; 2] {
        linear = Search::new([first, second], way, accuracy.budget);
        touch = linear.first_touch(motion.initial);
        (method_iterations, pair, swung) = (linear.iterations, &linear.pair, None);
    } else {
        let of_both = |[a, b]: [DVec3; 2]| if is_swapped { [b, a] } else { [a, b] };
        let swings = Swings { turns: of_both(turns), arms: of_both(arms) };
        turning = turning::Search::new([first, second], way, swings, accuracy.budget);
        touch = turning.first_touch(motion.initial, accuracy);
        (method_iterations, pair, swung) = (turning.iterations, &turning.course.pair, Some(&turning.course));
    }
    work.iterations += u64::from(method_iterations);
    let touch = touch?;
    let swung = swung.map_or(DVec3::ZERO, |turning| turning.swing_of_first(touch.fraction));
    let normal = touch.normal.map(|normal| pair.direction_out(normal));
    let first_displacement = if is_swapped { motion.displacement_b } else { motion.displacement_a };
    Some(ImpactTouch {
        fraction: touch.fraction,
        point: pair.point_out(touch.point) + swung + first_displacement * touch.fraction,
        normal_b_to_a: normal.map(|normal| if is_swapped { DVec3::ZERO - normal } else { normal }),
        initial: touch.is_initial,
        feature_b: Feature::default(),
        certificate: Certificate {
            verdict: touch.verdict,
            bound: touch.bound,
            model: Model::EXACT,
            method: Method::Advancement,
            stop: touch.stop,
            iterations: method_iterations,
        },
    })
}

/// How a form turns as far as that shows: a ball about its own middle never does.
fn turn_of(placed: PlacedConvex<'_>, rotation: DVec3, arm: DVec3) -> DVec3 {
    if matches!(placed.convex.core, Core::Point) && arm == DVec3::ZERO { DVec3::ZERO } else { rotation }
}

/// As [`order::is_swapped`]; forms that are alike and in one place are told apart by their motions.
fn is_swapped(a: PlacedConvex<'_>, b: PlacedConvex<'_>, motion: &Motion) -> bool {
    let key = |way: DVec3, turn: DVec3| [way.x, way.y, way.z, turn.x, turn.y, turn.z];
    let key_a = key(motion.displacement_a, motion.rotation_a);
    let key_b = key(motion.displacement_b, motion.rotation_b);
    order::is_swapped(a, b) || !order::is_swapped(b, a) && order::compare(&key_a, &key_b).is_gt()
}

/// A pair in motion: `a` stands, `b` goes by `-way` over the time from 0 to 1.
struct Search<'a> {
    placed: [PlacedConvex<'a>; 2],
    pair: Pair<'a>,
    start: DVec3,
    way: DVec3,
    budget: u32,
    iterations: u32,
}

/// What a plane says about the time that follows.
enum Step {
    /// Free for ever.
    Free,
    /// Free until then.
    FreeUntil(f64),
    /// The gap is within rounding, or the budget is spent.
    Closed(Stop),
}

impl<'a> Search<'a> {
    fn new(placed: [PlacedConvex<'a>; 2], way: DVec3, budget: u32) -> Self {
        let [a, b] = placed;
        let pair = Pair::new(a, b, way.norm());
        let start = pair.b.position;
        let way = pair.displacement_in(way);
        Self { placed, pair, start, way, budget, iterations: 0 }
    }

    fn go_to(&mut self, time: f64) {
        self.pair.b.position = self.start - self.way * time;
    }

    fn first_touch(&mut self, initial: InitialTouch) -> Option<Touch> {
        let entry = balls::entry(self.pair.b.position, self.pair.reach, self.way, PAIR_ROUNDING)?;
        let (mut time, mut normal, mut seed) = (entry, None, None);
        if let Some(slide) = slide::meeting(&self.pair, self.way) {
            match slide {
                Slide::Free => return None,
                Slide::Touch { bound, normal, edges } if bound.lower > 0.0 => {
                    return Some(self.slid_into(bound, normal, edges));
                }
                Slide::Touch { .. } | Slide::Open => {}
            }
        } else if !rods::applies(&self.pair) {
            let by = if portal::applies(&self.pair) { portal::approach } else { cast::approach };
            let approach = by(&self.pair, self.way, entry, self.budget);
            self.iterations = approach.iterations;
            if approach.time > 1.0 {
                return None;
            }
            if let Some(touch) = self.touch_after(&approach) {
                return Some(touch);
            }
            time = approach.time.max(entry);
            normal = (approach.normal != DVec3::ZERO).then_some(approach.normal);
            seed = approach.simplex.as_ref().map(|simplex| Seed::at(simplex, approach.normal));
        }
        loop {
            self.go_to(time);
            let rest = self.budget.saturating_sub(self.iterations).max(1);
            let gap = gjk::gap_warm(&self.pair, &mut seed, rest, |_, upper| upper <= self.pair.radius());
            self.iterations = self.iterations.saturating_add(gap.iterations);
            if gap.lower > 0.0 {
                normal = Some(gap.normal);
            }
            match self.step(time, &gap) {
                Step::Free => return None,
                Step::FreeUntil(next) if next > 1.0 => return None,
                Step::FreeUntil(next) => time = next,
                Step::Closed(stop) if time == 0.0 => return self.initial_touch(&gap, normal, stop, initial),
                Step::Closed(stop) => return Some(self.prove_touch(time, &gap, normal, stop)),
            }
        }
    }

    /// The touch at the end of a way that planes proved free, if what is nearest there surely overlaps a moment later.
    fn touch_after(&self, approach: &Approach) -> Option<Touch> {
        let (time, normal, simplex) = (approach.time, approach.normal, approach.simplex.as_ref()?);
        let closing = -normal.dot(self.way);
        let ahead = 6.0 * PAIR_ROUNDING / closing;
        let is_proved = time > 0.0 && closing > 0.0 && time + ahead <= 1.0 && self.is_held_by(simplex, ahead);
        let bound = Bound::new(time, time + ahead);
        is_proved.then(|| self.touch_at(simplex, Some(normal), bound, Verdict::Hit, Stop::Converged))
    }

    /// The first touch of boxes, where it lies on the axis that parts them last.
    fn slid_into(&mut self, bound: Bound, normal: DVec3, edges: Option<[usize; 2]>) -> Touch {
        self.iterations += 1;
        let fraction = 0.5 * bound.lower + 0.5 * bound.upper;
        self.go_to(fraction);
        let touching = boxes::touching(&self.pair, normal, edges);
        let (on_a, on_b) = touching.unwrap_or_else(|| gjk::gap(&self.pair, self.budget, |_, _| false).witnesses());
        Touch {
            fraction,
            bound,
            verdict: Verdict::Hit,
            stop: Stop::Converged,
            normal: Some(normal),
            point: on_a * 0.5 + on_b * 0.5,
            is_initial: false,
        }
    }

    fn step(&self, time: f64, gap: &gjk::Gap) -> Step {
        let free = gap.lower - self.pair.radius();
        if free > 0.0 {
            let closing = -gap.normal.dot(self.way);
            if closing <= 0.0 {
                return Step::Free;
            }
            // What is left is rounded down, so that the way up to there is surely free.
            let next = time + free / closing * STEP_SHORTENING;
            if free > 2.0 * PAIR_ROUNDING && next > time && self.iterations < self.budget {
                return Step::FreeUntil(next);
            }
            if next > 1.0 {
                return Step::Free;
            }
        }
        Step::Closed(if self.iterations < self.budget { Stop::Converged } else { Stop::Budget })
    }

    /// What the start is. The pair at rest is asked, whose frame is finer than that of a long way.
    fn initial_touch(
        &mut self,
        gap: &gjk::Gap,
        normal: Option<DVec3>,
        stop: Stop,
        initial: InitialTouch,
    ) -> Option<Touch> {
        let [a, b] = self.placed;
        let rest = overlapping::at_rest(a, b, self.budget);
        self.iterations = self.iterations.saturating_add(rest.iterations);
        if rest.verdict != Verdict::Miss && initial == InitialTouch::IsIgnored {
            // Unless rounding leaves it open, nobody knows yet whether there is a touch to pass over.
            let is_spent = rest.verdict == Verdict::Undecided && rest.iterations >= self.budget;
            let open = || self.touch_at(&gap.simplex, normal, Bound::new(0.0, 1.0), Verdict::Undecided, Stop::Budget);
            return is_spent.then(|| Touch { fraction: 0.0, ..open() });
        }
        if rest.verdict == Verdict::Hit {
            return Some(Touch {
                fraction: 0.0,
                bound: Bound::new(0.0, 0.0),
                verdict: Verdict::Hit,
                stop,
                normal: None,
                point: self.point_between(&gap.simplex),
                is_initial: true,
            });
        }
        let touch = self.prove_touch(0.0, gap, normal, stop);
        Some(Touch { is_initial: rest.verdict == Verdict::Undecided, ..touch })
    }

    /// From a gap within rounding at `time`: seeks an instant of proved overlap at growing steps beyond it, for which the
    /// budget is there once more.
    fn prove_touch(&mut self, time: f64, gap: &gjk::Gap, normal: Option<DVec3>, stop: Stop) -> Touch {
        let closing = normal.map_or(0.0, |normal| -normal.dot(self.way));
        let mut ahead = if closing > 0.0 { 6.0 * PAIR_ROUNDING / closing } else { PAIR_ROUNDING };
        let mut proved = None;
        // The nearest points of a formula may be off by a lean.
        let is_sharp = gap.upper - gap.length <= 2.0 * PAIR_ROUNDING;
        if is_sharp && closing > 0.0 && time + ahead <= 1.0 && self.is_held_by(&gap.simplex, ahead) {
            proved = Some(time + ahead);
        }
        let (mut stop, mut rest) = (stop, self.budget);
        while proved.is_none() {
            let instant = (time + ahead).min(1.0);
            self.go_to(instant);
            let overlap = overlapping::prove(&self.pair, 0.0, rest);
            self.iterations = self.iterations.saturating_add(overlap.iterations);
            rest = rest.saturating_sub(overlap.iterations);
            if overlap.verdict == Verdict::Hit {
                proved = Some(instant);
            } else if instant >= 1.0 {
                break;
            } else if rest == 0 {
                stop = Stop::Budget;
                break;
            }
            ahead *= 4.0;
        }
        let bound = Bound::new(time, proved.unwrap_or(1.0));
        let verdict = if proved.is_some() { Verdict::Hit } else { Verdict::Undecided };
        self.touch_at(&gap.simplex, normal, bound, verdict, stop)
    }

    /// A touch of what is nearest at the lower end of `bound`.
    fn touch_at(&self, nearest: &Simplex, normal: Option<DVec3>, bound: Bound, verdict: Verdict, stop: Stop) -> Touch {
        let closing = normal.map_or(0.0, |normal| -normal.dot(self.way));
        // The free way is counted to where the gap is surely open; the best value goes the rest of it.
        let rest = if closing > 0.0 { (nearest.point().norm() - self.pair.radius()) / closing } else { 0.0 };
        Touch {
            fraction: (bound.lower + rest).clamp(bound.lower, bound.upper),
            bound,
            verdict,
            stop,
            normal,
            point: self.point_between(nearest),
            is_initial: false,
        }
    }

    /// Whether the features that are nearest now surely overlap a while later: the points themselves if there are radii, or
    /// else the tetrahedron that they make with a point inside. This spares a search wherever the touch is not at the very
    /// edge of a feature.
    fn is_held_by(&self, simplex: &Simplex, ahead: f64) -> bool {
        let shift = self.way * ahead;
        let radius = self.pair.radius();
        if radius > 0.0 {
            return (simplex.point() + shift).norm() + 2.0 * PAIR_ROUNDING <= radius;
        }
        let [a, b, c] = *simplex.vertices() else { return false };
        portal::is_behind(&self.pair, &[a, b, c].map(|corner| corner.point), shift, PAIR_ROUNDING)
    }

    /// A point between the cores' nearest ones, on the surface of the first form.
    fn point_between(&self, nearest: &Simplex) -> DVec3 {
        let (on_a, on_b) = nearest.witnesses();
        let apart = (on_a - on_b).norm();
        let share = if apart > 0.0 { (self.pair.a.radius / apart).min(1.0) } else { 0.0 };
        on_a + (on_b - on_a) * share
    }
}
