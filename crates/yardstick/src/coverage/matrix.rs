//! The matrix of extremes: every kind of form at every extreme, in both orders, moved rigidly and scaled by powers of two.
//!
//! # Method
//! A cell is a question that is hard in a named way about forms of a named kind. Its answers are held against the oracle as
//! [`super::run`] does: finite, within their work, the truth inside, both orders alike. The same is asked of the question moved
//! rigidly, whose numbers are others by rounding. Scaled by a power of two, each number of an answer must be scaled likewise, bit by
//! bit.

use std::fmt::Debug;

use collision::{
    answer::{Bound, Certificate},
    narrow::{self, ImpactTouch, Motion, Placed},
    shape::Limits,
};
use glam::{DQuat, DVec3};

use super::{
    ask::ask,
    forms::Kind,
    moves::{self, MoveQuestion, Movers, STYLES, Turning, move_question_at},
    outcome::Outcome,
    pairs::{Question, extremes, question_at},
    run::examine,
    scaled::{Movable, Rigid},
    whole_pairs::{self, WholeQuestion, whole_question_at},
    wholes::{Class, HARD},
};
use crate::scene::Random;

/// What came of the matrix.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// Cells, each with as many questions as were asked for.
    pub cells: usize,
    /// Answers that were judged.
    pub answers: usize,
    /// Answers that were compared bit by bit with those of a scaled question.
    pub scaled: usize,
    /// What is wrong, in words.
    pub faults: Vec<String>,
}

/// Powers of two that questions are scaled by, as long as sizes stay within limits.
const SCALES: [f64; 4] = [1.0 / 1024.0, 0.125, 32.0, 65536.0];

impl Sweep {
    /// Pairs of convex forms. With a `stride` above 1 only every so many of all pairs of kinds are asked, other ones at each
    /// extreme.
    pub fn pairs(&mut self, questions: u64, stride: usize) {
        for (number, extreme) in extremes().enumerate() {
            for (index, kinds) in kind_pairs().into_iter().enumerate() {
                if (index + number).is_multiple_of(stride) {
                    let seeds = self.cell(index * 64 + number, questions);
                    seeds.for_each(|seed| self.check_pair(extreme, &question_at(seed, kinds, Some(extreme))));
                }
            }
        }
    }

    /// Convex forms in motion, each kind with all others in turn.
    pub fn moves(&mut self, questions: u64, stride: usize) {
        for (number, style) in STYLES.into_iter().enumerate() {
            for (index, (a, b)) in kind_pairs().into_iter().enumerate() {
                for turning in [Turning::No, Turning::Yes] {
                    let is_asked = turning == Turning::Yes || style != "many_turns";
                    if is_asked && (index + number).is_multiple_of(stride) {
                        let seeds = self.cell(10_000 + index * 64 + number, questions);
                        let movers = Movers::Convex(a, b);
                        seeds.for_each(|seed| {
                            self.check_move(style, &move_question_at(seed, movers, turning, Some(style)));
                        });
                    }
                }
            }
        }
    }

    /// Concave forms with convex ones of all kinds in turn, at rest and in motion.
    pub fn wholes(&mut self, questions: u64, stride: usize) {
        for (number, extreme) in HARD.into_iter().enumerate() {
            for class in Class::ALL {
                for (index, kind) in Kind::ALL.into_iter().enumerate() {
                    if !(index + number + class as usize).is_multiple_of(stride) {
                        continue;
                    }
                    let seeds = self.cell(20_000 + index * 64 + number * 8 + class as usize, questions);
                    for seed in seeds {
                        self.check_whole(extreme, &whole_question_at(seed, class, kind, Some(extreme)));
                        let style = STYLES[(number + index) % 5];
                        let movers = Movers::Concave(class, kind);
                        self.check_move(style, &move_question_at(seed, movers, Turning::No, Some(style)));
                    }
                }
            }
        }
    }

    fn cell(&mut self, number: usize, questions: u64) -> impl Iterator<Item = u64> + use<> {
        self.cells += 1;
        let mut random = Random::new(number as u64);
        (0..questions).map(move |_| random.bits())
    }

    fn check_pair(&mut self, extreme: &str, question: &Question) {
        let Some((outcome, _)) = examine(question) else { return };
        self.take(extreme, question, &outcome);
        let moved = question.moved(&rigid(question.a.position));
        if let Some((outcome, _)) = examine(&moved) {
            self.take(extreme, &moved, &outcome);
        }
        for by in SCALES.into_iter().filter(|by| is_in_range(&[question.a.position, question.b.position], extreme, *by))
        {
            let (Ok([here, _]), Ok([there, _])) = (ask(question), ask(&question.scaled(by))) else { continue };
            let distance = |found: &narrow::Separation| (found.distance, found.certificate);
            self.compare(
                extreme,
                question,
                Scaled::all(by),
                here.distance.as_ref().map(distance),
                there.distance.as_ref().map(distance),
            );
            self.compare(extreme, question, Scaled::all(by), Some((0.0, here.overlap)), Some((0.0, there.overlap)));
            let depth = |found: &narrow::Contact| (found.depth, found.certificate);
            self.compare(
                extreme,
                question,
                Scaled::all(by),
                here.contact.as_ref().map(depth),
                there.contact.as_ref().map(depth),
            );
        }
    }

    fn check_whole(&mut self, extreme: &str, question: &WholeQuestion) {
        let Some(outcome) = whole_pairs::examine(question) else { return };
        self.take(extreme, question, &outcome);
        let moved = question.moved(&rigid(question.sides[0].position));
        if let Some(outcome) = whole_pairs::examine(&moved) {
            self.take(extreme, &moved, &outcome);
        }
        let asked = |question: &WholeQuestion| {
            let [a, b] = question.sides.each_ref().map(|side| side.whole.geometry().ok());
            let (a, b) = (a?, b?);
            let [pose_a, pose_b] = question.sides.each_ref().map(super::PlacedWhole::pose);
            let (a, b) = (Placed { geometry: &a, pose: pose_a }, Placed { geometry: &b, pose: pose_b });
            let mut work = collision::answer::Work::default();
            let found = narrow::distance(a, b, question.limit, &question.accuracy, &mut work);
            let overlap = narrow::overlap(a, b, &question.accuracy, &mut work);
            Some((found.map(|found| (found.distance, found.certificate)), overlap))
        };
        let positions = question.sides.each_ref().map(|side| side.position);
        for by in SCALES.into_iter().filter(|by| is_in_range(&positions, extreme, *by)) {
            let (Some(here), Some(there)) = (asked(question), asked(&question.scaled(by))) else { continue };
            self.compare(extreme, question, Scaled::all(by), here.0, there.0);
            // Which pieces are looked at follows from boxes that are rounded, and bounds from those; the verdict does not.
            let (here, there) = (here.1.verdict, there.1.verdict);
            if here != there {
                self.faults.push(format!("{extreme}: scaled by {by}: {here:?}, but {there:?} of {question:?}"));
            }
        }
    }

    fn check_move(&mut self, style: &str, question: &MoveQuestion) {
        let Some(outcome) = moves::examine(question) else { return };
        self.take(style, question, &outcome);
        let moved = question.moved(&rigid(question.sides[0].position));
        if let Some(outcome) = moves::examine(&moved) {
            self.take(style, &moved, &outcome);
        }
        let Motion { displacement_a, displacement_b, .. } = question.motion;
        let [a, b] = question.sides.each_ref().map(|side| side.position);
        let extreme = question.categories[0];
        for by in SCALES.into_iter().filter(|by| is_in_range(&[a, b, displacement_a, displacement_b], extreme, *by)) {
            let (Some(here), Some(there)) = (moves::ask(question), moves::ask(&question.scaled(by))) else { continue };
            // Times are parts of the motion and do not scale; what stand-ins are off by is a length beside them as well.
            let told = |touch: ImpactTouch| (touch.fraction, touch.certificate);
            self.compare(
                style,
                question,
                Scaled { values: 1.0, lengths: by },
                here.there.map(told),
                there.there.map(told),
            );
        }
    }

    fn take(&mut self, extreme: &str, question: &impl Debug, outcome: &Outcome) {
        self.answers += outcome.answers.len();
        let faults = outcome.faults().map(|fault| format!("{extreme}: {fault:?} of {question:?}"));
        self.faults.extend(faults);
    }

    fn compare(
        &mut self,
        extreme: &str,
        question: &impl Debug,
        Scaled { values, lengths }: Scaled,
        here: Option<(f64, Certificate)>,
        there: Option<(f64, Certificate)>,
    ) {
        self.scaled += 1;
        let scaled = here.map(|(value, certificate)| {
            let Bound { lower, upper } = certificate.bound;
            let model = collision::answer::Model {
                outside: certificate.model.outside * lengths,
                inside: certificate.model.inside * lengths,
                ..certificate.model
            };
            (value * values, Certificate { bound: Bound::new(lower * values, upper * values), model, ..certificate })
        });
        if scaled != there {
            self.faults.push(format!("{extreme}: scaled by {lengths}: {scaled:?}, but {there:?} of {question:?}"));
        }
    }
}

/// What an answer is multiplied by where its question is scaled.
struct Scaled {
    /// The value and its bounds.
    values: f64,
    /// What stand-ins are off by.
    lengths: f64,
}

impl Scaled {
    /// Of a value that is a length.
    fn all(by: f64) -> Self {
        Self { values: by, lengths: by }
    }
}

/// Whether numbers stay within the limits, and none loses digits next to 0.
fn is_in_range(numbers: &[DVec3], extreme: &str, by: f64) -> bool {
    let fits = numbers.iter().all(|v| v.abs().max_element() * by <= Limits::COORDINATE);
    fits && extreme != "denormal"
}

/// A turn and a shift about as far as the pair is from the origin, so that nothing is lost.
fn rigid(position: DVec3) -> Rigid {
    let far = position.length();
    Rigid { turn: DQuat::from_xyzw(0.5, -0.1, 0.7, 0.4).normalize(), shift: DVec3::new(0.5, -0.25, 0.75) * far }
}

/// All pairs of kinds, each once; two half spaces overlap without end.
fn kind_pairs() -> Vec<(Kind, Kind)> {
    let after = |first: usize| Kind::ALL[first..].iter().map(move |&second| (Kind::ALL[first], second));
    let all = (0..Kind::ALL.len()).flat_map(after);
    all.filter(|kinds| *kinds != (Kind::HalfSpace, Kind::HalfSpace)).collect()
}
