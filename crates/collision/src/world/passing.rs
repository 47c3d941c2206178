//! How near to a shape comes what passes it by, for notes of what a question did.
//!
//! # Method
//! The distance of two that move changes no faster than they move and turn, so one look says how near they may be for a while before
//! and after it. The next look is at the time at which they may be nearest by all looks so far, until that is hardly nearer than they
//! were seen.
//!
//! # Source
//! Shubert, "A Sequential Method Seeking the Global Maximum of a Function", SIAM Journal on Numerical Analysis 9(3), 1972.

use glam::DVec3;
use smallvec::SmallVec;

use super::search::Side;
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Verdict, Work},
    math::{Norm, Pose},
    narrow::{self, Motion, Operand, Placed, Ray},
    shape::{Form, Geometry},
    tolerance,
};

/// Farther apart, in metres, are no two forms within the limits of a world.
const FARTHEST: f64 = 4e12;
/// Looks at a motion, at most.
const LOOKS: usize = 32;
/// The same where one of the two is of many pieces, which takes longer.
const LOOKS_AT_PIECES: usize = 8;
/// What they may be nearer than they were seen, as a part of that, for no more looks.
const NEARER: f64 = 1.0 / 64.0;

/// How far apart two are, one of which may be off by so much.
pub(super) fn apart(a: Placed<'_>, b: Operand<'_>, off: f64, accuracy: &Accuracy) -> Option<Certificate> {
    let found = narrow::distance_of(a, b, FARTHEST, accuracy, &mut Work::default())?.certificate;
    let bound = Bound { lower: (found.bound.lower - off).max(0.0), upper: found.bound.upper + off };
    Some(Certificate { verdict: Verdict::Miss, bound, ..found })
}

/// How far from a shape a ray passes: its part beside the shape's box, which holds the point that is nearest, is measured as a flat form.
pub(super) fn of_ray(ray: &Ray, other: &Side<'_>, accuracy: &Accuracy) -> Option<Certificate> {
    let direction = ray.direction.try_unit().filter(|_| ray.min_distance <= ray.max_distance)?;
    let (min, max) = (other.bounds.min, other.bounds.max);
    let beside = ((min * 0.5 + max * 0.5) - ray.origin).dot(direction);
    let reach = ((max - min) * 0.5).dot(direction.abs());
    let [begin, end] = [beside - reach, beside + reach].map(|at| at.clamp(ray.min_distance, ray.max_distance));
    let (middle, half) = (ray.origin + direction * (begin * 0.5 + end * 0.5), direction * (end * 0.5 - begin * 0.5));
    let part = Geometry::hull(&[half, -half]).ok()?;
    let off = (ray.origin.abs().max_element() + begin.abs().max(end.abs())) * (2.0 * tolerance::SLAB_SLACK);
    apart(Placed { geometry: &part, pose: Pose::at(middle) }, other.operand(), off, accuracy)
}

/// A look at two on their ways.
#[derive(Clone, Copy)]
struct Look {
    time: f64,
    certificate: Certificate,
}

/// How near two come to each other from the beginning of a motion to the time `until`.
pub(super) fn of_motion(
    subject: &Side<'_>,
    other: &Side<'_>,
    (motion, until): (&Motion, f64),
    accuracy: &Accuracy,
) -> Option<Certificate> {
    let (a, b) = (subject.placed, other.placed);
    let (begin, way) = (a.pose.position - b.pose.position, motion.displacement_a - motion.displacement_b);
    let turns = [(a, motion.rotation_a), (b, motion.rotation_b)].map(|(placed, turn)| (placed.geometry.reach(), turn));
    let turns = turns.iter().filter(|(_, turn)| *turn != DVec3::ZERO).map(|(reach, turn)| (*reach, turn.norm()));
    let speed =
        (way.norm() + turns.clone().map(|(reach, angle)| reach * angle).sum::<f64>()) * tolerance::LENGTH_WIDENING;
    let turned: f64 = turns.map(|(reach, angle)| reach * (1.0 + angle)).sum();
    let off = tolerance::RELATIVE_POSE * (begin.norm() + way.norm() + turned);
    let look = |time: f64| {
        let [pose_a, pose_b] = motion.poses_at([a.pose, b.pose], time);
        let (a, b) = (Placed { pose: pose_a, ..a }, Placed { pose: pose_b, ..b });
        let certificate = apart(a, Operand { placed: b, ..other.operand() }, off, accuracy)?;
        Some(Look { time, certificate })
    };
    let is_whole = |placed: Placed<'_>| matches!(placed.geometry.form(), Form::Convex(_) | Form::HalfSpace(_));
    let most = if is_whole(a) && is_whole(b) { LOOKS } else { LOOKS_AT_PIECES };
    let mut looks: SmallVec<[Look; LOOKS]> = SmallVec::new();
    looks.extend([look(0.0)?, look(until)?]);
    loop {
        let nearest = looks.iter().map(|look| look.certificate).reduce(nearer)?;
        let gap = looks.windows(2).enumerate().map(|(at, pair)| (at, least([pair[0], pair[1]], speed)));
        let (at, lower) = gap.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let seen = nearest.bound.upper;
        if looks.len() == most || lower >= seen * (1.0 - NEARER) || speed <= 0.0 {
            let lower = lower.clamp(0.0, nearest.bound.lower);
            return Some(Certificate { bound: Bound { lower, upper: seen }, ..nearest });
        }
        looks.insert(at + 1, look(between(looks[at], looks[at + 1], speed))?);
    }
}

/// How near two may come between two looks.
fn least([before, after]: [Look; 2], speed: f64) -> f64 {
    let lower = |look: Look| look.certificate.bound.lower;
    let sum = lower(before) + lower(after) - speed * (after.time - before.time);
    (0.5 * sum).min(lower(before)).min(lower(after))
}

/// When they may come so near.
fn between(before: Look, after: Look, speed: f64) -> f64 {
    let nearer_before = (before.certificate.bound.lower - after.certificate.bound.lower) / speed;
    let span = after.time - before.time;
    // Not at a time that was looked at already.
    let middle = 0.5 * (span + nearer_before);
    before.time + middle.clamp(0.125 * span, 0.875 * span)
}

fn nearer(a: Certificate, b: Certificate) -> Certificate {
    if b.bound.upper < a.bound.upper { b } else { a }
}
