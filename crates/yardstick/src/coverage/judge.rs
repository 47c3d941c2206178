//! Holds answers against the truth.

use collision::{
    DVec3,
    accuracy::Tier,
    answer::{Bound, Certificate, Stop, Verdict},
    narrow::{Contact, Separation},
};

use super::{
    ask::{Answers, Warmed, geometry},
    outcome::{Answer, Asked, FaultKind, Outcome},
    pairs::Question,
};
use crate::oracle::{PlacedSolid, Truth, scale};

/// Widest interval to accept of a search that converged, as a part of s.
const CONVERGED: f64 = 1e-11;

/// UNDECIDED is accepted within this part of s of touch.
const OPEN: f64 = 1e-11;

/// Normals may be off by this, and the width along them by this part of s.
const NORMAL: f64 = 1e-13;

/// The same for the depth behind an overlap, which comes without a normal that the oracle could begin at: in some of a
/// thousand pairs it finds none that is as good, though in none by so much.
const SEARCH: f64 = 1e-5;

/// Nearest points may be off by this part of s, and by this part of their coordinates in the world.
const POINTS: f64 = 1e-9;
const WORLD_POINT: f64 = 1e-15;

/// Widths are judged relative to at least this, metres: the least size the service accepts.
const SCALE_MIN: f64 = 1e-9;

/// Whether the two arguments can be told from each other.
#[derive(Clone, Copy, PartialEq)]
enum Told {
    Apart,
    Alike,
}

struct Judge<'a> {
    question: &'a Question,
    truth: &'a Truth,
    s: f64,
    outcome: Outcome,
}

/// Judges the answers in the order of the question, and whether those in the other order are the same.
#[must_use]
pub fn judge(question: &Question, [there, back]: &[Answers; 2], truth: &Truth) -> Outcome {
    let s = scale(&question.a, &question.b).max(SCALE_MIN);
    let outcome = Outcome { overlaps: !truth.is_above(0.0), blur: truth.blur() / s, ..Outcome::default() };
    let mut judge = Judge { question, truth, s, outcome };
    let told = judge.told();
    judge.begin(Asked::Distance);
    if truth.nearest().is_nan() {
        judge.fault(FaultKind::Form, "the oracle has no answer");
    }
    judge.distance(there.distance.as_ref());
    judge.distance_order(there, back, told);
    judge.begin(Asked::Overlap);
    judge.overlap(&there.overlap);
    if told == Told::Apart && there.overlap != back.overlap {
        judge.fault(FaultKind::Order, format!("overlap: {:?}, swapped {:?}", there.overlap, back.overlap));
    }
    judge.begin(Asked::Penetration);
    judge.contact(there.contact.as_ref());
    judge.contact_order(there, back, told);
    if let Some(warm) = &there.warm {
        judge.warm(warm);
    }
    judge.outcome
}

impl Judge<'_> {
    fn begin(&mut self, asked: Asked) {
        self.outcome.answers.push(Answer::to(asked));
    }

    /// The answer that is being judged.
    fn answer(&mut self) -> &mut Answer {
        if self.outcome.answers.is_empty() {
            self.begin(Asked::Distance);
        }
        let last = self.outcome.answers.len() - 1;
        &mut self.outcome.answers[last]
    }

    fn fault(&mut self, kind: FaultKind, what: impl Into<String>) {
        let (what, truth, s) = (what.into(), self.truth.nearest(), self.s);
        self.answer().fault(kind, format!("{what}; truth {truth:e}, s {s:e}"));
    }

    /// The same forms at other poses were asked first.
    fn warm(&mut self, warm: &Warmed) {
        self.begin(Asked::WarmDistance);
        self.distance(warm.distance.as_ref());
        self.begin(Asked::WarmPenetration);
        self.contact(warm.contact.as_ref());
    }

    fn is_exact(&self) -> bool {
        self.question.accuracy.tier == Tier::Exact && self.question.accuracy.max_error == 0.0
    }

    fn distance(&mut self, answer: Option<&Separation>) {
        let limit = self.question.limit;
        let Some(answer) = answer else {
            if self.truth.is_below(limit) {
                self.fault(FaultKind::Verdict, format!("distance: none within {limit:e}"));
            }
            return;
        };
        let bound = answer.certificate.bound;
        self.form("distance", bound, answer.distance);
        if bound.lower > 0.0 && self.truth.is_below(bound.lower)
            || bound.upper >= 0.0 && self.truth.is_above(bound.upper)
        {
            self.fault(FaultKind::Bound, format!("distance in [{:e}, {:e}]", bound.lower, bound.upper));
        }
        if bound.lower < 0.0 {
            self.fault(FaultKind::Form, format!("distance: lower {:e} is below 0", bound.lower));
        }
        match answer.certificate.verdict {
            Verdict::Hit if self.truth.is_above(limit) => {
                self.fault(FaultKind::Verdict, format!("distance: within {limit:e}"));
            }
            Verdict::Miss => self.fault(FaultKind::Verdict, "distance: MISS in an answer"),
            _ => {}
        }
        self.certified("distance", &answer.certificate);
        self.witnesses(answer);
    }

    /// Points carry no bound; they must be finite and as far apart as the answer says, to within what was asked.
    fn witnesses(&mut self, answer: &Separation) {
        let apart = answer.point_on_a.distance(answer.point_on_b);
        let far = answer.point_on_a.abs().max_element().max(answer.point_on_b.abs().max_element());
        let accuracy = &self.question.accuracy;
        let asked = accuracy.max_error.max(accuracy.max_error_relative * answer.distance);
        let slack = self.s * POINTS + far * WORLD_POINT + answer.certificate.bound.width() + asked;
        let agree = (apart - answer.distance).abs() <= slack;
        if !agree {
            self.fault(
                FaultKind::Points,
                format!("distance {:e}, but its points are {apart:e} apart", answer.distance),
            );
        }
        if answer.normal_b_to_a.is_some_and(|normal| !is_unit(normal)) {
            self.fault(FaultKind::Normal, format!("distance: normal {:?}", answer.normal_b_to_a));
        }
    }

    fn overlap(&mut self, answer: &Certificate) {
        let bound = answer.bound;
        self.answer().is_undecided = answer.verdict == Verdict::Undecided;
        self.work("overlap", answer);
        let in_order = bound.lower <= bound.upper;
        if !in_order {
            self.fault(FaultKind::Form, format!("overlap in [{:e}, {:e}]", bound.lower, bound.upper));
        }
        if self.truth.is_below(bound.lower) || self.truth.is_above(bound.upper) {
            self.fault(FaultKind::Bound, format!("overlap in [{:e}, {:e}]", bound.lower, bound.upper));
        } else if self.truth.is_likely_below(bound.lower - SEARCH * self.s) {
            self.fault(FaultKind::Bound, format!("overlap in [{:e}, {:e}], likely", bound.lower, bound.upper));
        }
        match answer.verdict {
            Verdict::Hit if self.truth.is_above(0.0) => self.fault(FaultKind::Verdict, "overlap: HIT"),
            Verdict::Miss if self.truth.is_below(0.0) => self.fault(FaultKind::Verdict, "overlap: MISS"),
            Verdict::Undecided => {
                let is_excused = answer.stop == Stop::Budget && self.question.accuracy.tier != Tier::Exact;
                if self.truth.nearest().abs() > OPEN * self.s && !is_excused {
                    let what = format!("overlap in [{:e}, {:e}], {:?}", bound.lower, bound.upper, answer.stop);
                    self.fault(FaultKind::Undecided, what);
                }
            }
            _ => {}
        }
    }

    fn contact(&mut self, answer: Option<&Contact>) {
        let max_gap = self.question.max_gap;
        let Some(answer) = answer else {
            if self.truth.is_below(max_gap) {
                self.fault(FaultKind::Verdict, format!("depth: no contact within {max_gap:e}"));
            }
            return;
        };
        let bound = answer.certificate.bound;
        self.form("depth", bound, answer.depth);
        if self.truth.is_above(-bound.lower) || self.truth.is_below(-bound.upper) {
            self.fault(FaultKind::Bound, format!("depth in [{:e}, {:e}]", bound.lower, bound.upper));
        } else if self.truth.is_likely_below(-bound.upper) {
            self.fault(FaultKind::Bound, format!("depth in [{:e}, {:e}], likely", bound.lower, bound.upper));
        }
        match answer.certificate.verdict {
            Verdict::Hit if self.truth.is_above(0.0) => self.fault(FaultKind::Verdict, "depth: HIT"),
            Verdict::Miss if self.truth.is_below(0.0) => self.fault(FaultKind::Verdict, "depth: MISS"),
            _ => {}
        }
        self.certified("depth", &answer.certificate);
        let normal = answer.normal_b_to_a;
        if !is_unit(normal) {
            self.fault(FaultKind::Normal, format!("depth: normal {normal:?}"));
        } else {
            let width = -self.truth.gap_along(-normal);
            if width > bound.upper + NORMAL * self.s {
                let what = format!("depth up to {:e}, but {width:e} along its normal", bound.upper);
                self.fault(FaultKind::Normal, what);
            }
        }
        let points = answer.points.iter().flat_map(|point| [point.point_on_a, point.point_on_b]);
        if answer.points.is_empty() || !points.fold(DVec3::ZERO, |sum, point| sum + point).is_finite() {
            self.fault(FaultKind::Form, format!("depth: points {:?}", answer.points));
        }
    }

    fn form(&mut self, name: &str, bound: Bound, value: f64) {
        // NaN fails every comparison.
        if !(bound.lower <= value && value <= bound.upper && value.is_finite()) {
            self.fault(FaultKind::Form, format!("{name} {value:e} in [{:e}, {:e}]", bound.lower, bound.upper));
        }
    }

    /// Width, work and verdict of an answer that has a value.
    fn certified(&mut self, name: &str, certificate: &Certificate) {
        let (bound, accuracy, s) = (certificate.bound, self.question.accuracy, self.s);
        self.answer().is_undecided = certificate.verdict == Verdict::Undecided;
        if self.is_exact() {
            self.answer().width = Some(bound.width() / s);
        }
        self.work(name, certificate);
        let value = bound.lower.abs().max(bound.upper.abs());
        let asked = accuracy.max_error.max(accuracy.max_error_relative * value);
        let widest = match certificate.stop {
            Stop::Budget => f64::INFINITY,
            Stop::Tolerance => asked,
            Stop::Converged => asked.max(CONVERGED * s),
        };
        let is_narrow = bound.width() <= widest;
        if !is_narrow {
            let width = bound.width() / s;
            let what = format!(
                "{name} in [{:e}, {:e}] is {width:e} s wide: {:?} by {:?} after {} iterations, asked {:e}",
                bound.lower, bound.upper, certificate.stop, certificate.method, certificate.iterations, asked
            );
            self.fault(FaultKind::Width, what);
        }
        let is_finished = bound.width() <= asked.max(CONVERGED * s);
        self.answer().is_unfinished = !is_finished && certificate.stop == Stop::Budget && accuracy.tier == Tier::Exact;
    }

    fn work(&mut self, name: &str, certificate: &Certificate) {
        let most = iterations_max(self.question.accuracy.budget);
        if certificate.iterations > most {
            let what = format!("{name}: {} iterations, at most {most} are allowed", certificate.iterations);
            self.fault(FaultKind::Work, what);
        }
    }

    /// Whether a swap of the arguments can be told: not of the same form at the same place twice, under whatever name (an
    /// ellipsoid of equal half axes is a sphere).
    fn told(&self) -> Told {
        let (a, b) = (&self.question.a, &self.question.b);
        let id = |placed: &PlacedSolid| geometry(&placed.solid).map(|geometry| geometry.id());
        let is_same = a.position == b.position && a.rotation == b.rotation && id(a).ok() == id(b).ok();
        if is_same { Told::Alike } else { Told::Apart }
    }

    fn distance_order(&mut self, there: &Answers, back: &Answers, told: Told) {
        let distance = |answer: &Separation, [on_a, on_b]: [DVec3; 2], sign: f64| {
            let normal = answer.normal_b_to_a.map(|normal| normal * sign);
            (answer.distance, answer.certificate, on_a, on_b, normal)
        };
        let here = there.distance.as_ref().map(|answer| distance(answer, [answer.point_on_a, answer.point_on_b], 1.0));
        let other = back.distance.as_ref().map(|answer| distance(answer, [answer.point_on_b, answer.point_on_a], -1.0));
        if told == Told::Apart && here != other {
            self.fault(FaultKind::Order, format!("distance: {here:?}, swapped {other:?}"));
        }
    }

    fn contact_order(&mut self, there: &Answers, back: &Answers, told: Told) {
        let contact = |answer: &Contact, sign: f64| (answer.depth, answer.certificate, answer.normal_b_to_a * sign);
        let here = there.contact.as_ref().map(|answer| contact(answer, 1.0));
        let other = back.contact.as_ref().map(|answer| contact(answer, -1.0));
        if told == Told::Apart && here != other {
            self.fault(FaultKind::Order, format!("depth: {here:?}, swapped {other:?}"));
        }
    }
}

/// The most iterations of a question about two convex forms. Each search that a question is made of has the whole budget, and at most
/// so many follow each other.
pub(super) fn iterations_max(budget: u32) -> u32 {
    budget.saturating_mul(SEARCHES_MAX).saturating_add(ONCE)
}

const SEARCHES_MAX: u32 = 4;

/// Iterations of closed forms and of all axes of two polytopes, which no budget stops: those are asked while there are few.
const ONCE: u32 = 2048;

fn is_unit(normal: DVec3) -> bool {
    (normal.length() - 1.0).abs() <= NORMAL
}
