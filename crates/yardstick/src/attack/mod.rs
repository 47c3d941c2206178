//! An adversarial search: hill-climbs on the ratio of error to bound over the raw numbers of a question.
//!
//! # Method
//! A question of the exact tier is a list of numbers. One of them is changed: by some units of the last place, by a part of
//! itself, to another of the list, to 0, or to a power of two. What brings the truth nearer to an end of an answer's interval is kept.
//! The ratio is 0 for a truth in the middle of the interval and 1 at its ends; above 1 the answer is wrong, and so is one that
//! [`super::coverage`] finds a fault with.
//!
//! # Limits
//! It climbs to the nearest top, so it is begun from very many questions.

mod kept;

use collision::{answer::Bound, narrow::Motion};
use glam::DVec3;

pub use self::kept::{Find, Form};
use crate::{
    coverage::{self, MoveQuestion, Outcome, Question, RayQuestion},
    oracle::{meeting, stretch_inside},
    scene::Random,
};

/// What a search does.
#[derive(Clone, Copy, Debug)]
pub struct Climb {
    /// Names the search.
    pub seed: u64,
    /// Questions that are begun from.
    pub starts: u64,
    /// Changes tried of each.
    pub steps: u64,
    /// How many of the worst are kept of each sort.
    pub keep: usize,
}

/// What is asked of the numbers.
#[derive(Clone, Debug)]
pub enum Asked {
    /// Distance, overlap and depth of two forms.
    Pair(Question),
    /// A ray at a form.
    Ray(RayQuestion),
    /// A first touch without turns.
    Move(MoveQuestion),
}

/// How bad the answers are: the ratio, infinite if any is wrong; `None` if the crate refuses a form or nothing was measured.
#[must_use]
pub fn badness(asked: &Asked) -> Option<f64> {
    let (outcome, ratio) = examined(asked)?;
    if outcome.faults().next().is_some() { Some(f64::INFINITY) } else { ratio }
}

/// What is wrong with the answers, in words.
#[must_use]
pub fn faults(asked: &Asked) -> Vec<String> {
    let outcome = examined(asked).map(|(outcome, _)| outcome).unwrap_or_default();
    outcome.faults().map(|fault| format!("{}: {}", fault.kind.name(), fault.what)).collect()
}

fn examined(asked: &Asked) -> Option<(Outcome, Option<f64>)> {
    match asked {
        Asked::Pair(question) => pair(question),
        Asked::Ray(question) => ray(question),
        Asked::Move(question) => first_touch(question),
    }
}

/// How far a truth is from the middle of an interval, where its ends are 1.
fn ratio(bound: Bound, truth: f64) -> Option<f64> {
    let width = bound.width();
    let ratio = (truth - bound.lower - 0.5 * width).abs() / (0.5 * width);
    (width > 0.0 && ratio.is_finite()).then_some(ratio)
}

fn pair(question: &Question) -> Option<(Outcome, Option<f64>)> {
    let (outcome, truth) = coverage::examine(question)?;
    let [answers, _] = coverage::answers(question)?;
    let distance = answers.distance.as_ref().and_then(|found| {
        (found.certificate.bound.lower > 0.0).then(|| ratio(found.certificate.bound, truth.nearest())).flatten()
    });
    let depth = answers.contact.as_ref().and_then(|found| ratio(found.certificate.bound, -truth.nearest()));
    Some((outcome, worst([distance, depth])))
}

fn ray(question: &RayQuestion) -> Option<(Outcome, Option<f64>)> {
    let outcome = coverage::examine_ray(question)?;
    let touches = coverage::touches(question)?;
    let stretch = stretch_inside(&question.target, question.ray.origin, question.ray.direction);
    let ratio = stretch.zip(touches.certain).and_then(|(stretch, touch)| {
        (!touch.inside).then(|| ratio(touch.certificate.bound, stretch.enter[0])).flatten()
    });
    Some((outcome, ratio))
}

fn first_touch(question: &MoveQuestion) -> Option<(Outcome, Option<f64>)> {
    let (outcome, touch) = coverage::first_touch(question)?;
    let [a, b] = question.places();
    let [solid_a, solid_b] = question.sides.each_ref().map(|side| side.whole.as_convex());
    let met = meeting([(solid_a?, &a), (solid_b?, &b)]);
    // At a graze the oracle does not know the time well enough.
    let is_known = |bound: Bound| met.touching_at.is_some_and(|at| at - met.free_until <= KNOWN * bound.width());
    let bound = touch.map(|touch| touch.certificate.bound).filter(|bound| !met.touches_at_start && is_known(*bound));
    Some((outcome, bound.and_then(|bound| ratio(bound, met.free_until))))
}

/// The part of an interval that the oracle's own may cover.
const KNOWN: f64 = 1e-3;

fn worst(ratios: [Option<f64>; 2]) -> Option<f64> {
    ratios.into_iter().flatten().reduce(f64::max)
}

/// Searches, and returns the worst finds, worst first.
#[must_use]
pub fn climb(settings: &Climb) -> Vec<Find> {
    let mut random = Random::new(settings.seed);
    let begun: Vec<Find> = (0..settings.starts).map(|start| Find::random(random.bits(), start)).collect();
    climb_from(begun, settings)
}

/// The same from given questions in place of random ones: without steps they are only measured anew. Those about which nothing can be
/// measured are left out.
#[must_use]
pub fn climb_from(begun: Vec<Find>, settings: &Climb) -> Vec<Find> {
    let mut random = Random::new(!settings.seed);
    let mut finds: Vec<Find> = Vec::new();
    for begun in begun {
        let Some(mut best) = begun.measured() else { continue };
        for _ in 0..settings.steps {
            let mut next = best.clone();
            let mut numbers = next.numbers_mut();
            let index = (random.bits() % numbers.len() as u64) as usize;
            let other = *numbers[(random.bits() % numbers.len() as u64) as usize];
            *numbers[index] = changed(&mut random, *numbers[index], other);
            drop(numbers);
            if let Some(next) = next.measured()
                && next.ratio > best.ratio
            {
                best = next;
            }
        }
        finds.push(best);
    }
    finds.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
    let mut kept: Vec<Find> = Vec::new();
    for find in finds {
        if kept.iter().filter(|known| known.sort() == find.sort()).count() < settings.keep {
            kept.push(find);
        }
    }
    kept
}

fn changed(random: &mut Random, value: f64, other: f64) -> f64 {
    let sign = if random.one_in(2) { 1.0 } else { -1.0 };
    match random.bits() % 8 {
        0..=2 => {
            let units = 1 + random.bits() % 4;
            let step = if sign > 0.0 { f64::next_up } else { f64::next_down };
            (0..units).fold(value, |value, _| step(value))
        }
        3 | 4 => value * (1.0 + sign * 10f64.powf(random.uniform(-15.0, 0.0))),
        5 => other,
        6 if random.one_in(4) => 0.0,
        _ => value * if sign > 0.0 { 2.0 } else { 0.5 },
    }
}

/// A motion without turns by both displacements.
fn straight([displacement_a, displacement_b]: [DVec3; 2]) -> Motion {
    Motion { displacement_a, displacement_b, ..Motion::default() }
}
