//! Questions about two forms of which one is concave, or has stand-ins.

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Certificate, Model, Stop, Verdict, Work},
    narrow::{self, Contact, Contacts, NeedsDecomposition, Placed, Separation},
};

use super::{
    case::accuracy_name,
    forms::{Kind, power_of_ten},
    judge::iterations_max,
    outcome::{Answer, Asked, FaultKind, Outcome},
    pairs::accuracy,
    report::Labels,
    source,
    whole::PlacedWhole,
    wholes::{Class, place_of, placed_wholes},
};
use crate::{
    oracle::{Double, Truth, Union, length},
    scene::Random,
};

/// Two forms and what is asked of them.
#[derive(Clone, Debug)]
pub struct WholeQuestion {
    /// What is hard about it.
    pub category: &'static str,
    /// The forms.
    pub sides: [PlacedWhole; 2],
    /// How exact the answers must be.
    pub accuracy: Accuracy,
    /// The limit of the distance, metres; mostly infinite.
    pub limit: f64,
    /// The greatest gap of a contact, metres; mostly 0.
    pub max_gap: f64,
}

/// What is relative to what: the greatest of both radii and the distance of the origins, metres.
pub(super) fn scale_of([a, b]: &[PlacedWhole; 2]) -> f64 {
    a.whole.reach().max(b.whole.reach()).max(length(b.position - a.position)).max(1e-9)
}

/// The question that a seed, a class and a kind name.
#[must_use]
pub(super) fn whole_question(seed: u64, class: Class, kind: Kind) -> WholeQuestion {
    whole_question_at(seed, class, kind, None)
}

/// The same, hard in a way that is named.
pub(super) fn whole_question_at(seed: u64, class: Class, kind: Kind, extreme: Option<&'static str>) -> WholeQuestion {
    let mut random = Random::new(seed);
    let (category, sides) = placed_wholes(&mut random, class, kind, extreme);
    let s = scale_of(&sides);
    let accuracy = accuracy(&mut random, s);
    let limit = if random.one_in(5) { s * power_of_ten(&mut random, -3.0, 0.5) } else { f64::INFINITY };
    let max_gap = if random.one_in(4) { s * power_of_ten(&mut random, -9.0, -0.5) } else { 0.0 };
    WholeQuestion { category, sides, accuracy, limit, max_gap }
}

struct Answers {
    distance: Option<Separation>,
    overlap: Certificate,
    contacts: Result<Contacts, NeedsDecomposition>,
    work: [Work; 3],
}

impl WholeQuestion {
    /// What its answers are counted as.
    pub(super) fn labels(&self) -> Labels {
        labels_of(&self.sides, vec![self.category], &self.accuracy)
    }

    /// A test to paste.
    pub(super) fn source(&self, name: &str) -> String {
        let [a, b] = &self.sides;
        format!(
            "#[test]\nfn {name}() {{\n{}{}    panic!(\"{{:?}} {{:?}} {{:?}}\", narrow::overlap(a, b, &accuracy, &mut Work::default()), \
             narrow::distance(a, b, {}, &accuracy, &mut Work::default()), narrow::penetration(a, b, {:?}, &accuracy, &mut Work::default()));\n}}\n",
            source::sides(a, b),
            source::accuracy(&self.accuracy),
            source::number(self.limit),
            self.max_gap
        )
    }

    fn ask(&self, a: Placed<'_>, b: Placed<'_>) -> Answers {
        let accuracy = &self.accuracy;
        let mut work = [Work::default(); 3];
        Answers {
            distance: narrow::distance(a, b, self.limit, accuracy, &mut work[0]),
            overlap: narrow::overlap(a, b, accuracy, &mut work[1]),
            contacts: narrow::penetration(a, b, self.max_gap, accuracy, &mut work[2]),
            work,
        }
    }
}

/// What answers about two forms are counted as.
pub(super) fn labels_of(sides: &[PlacedWhole; 2], extremes: Vec<&'static str>, accuracy: &Accuracy) -> Labels {
    let classes = sides.each_ref().map(|side| side.whole.class());
    let class = classes.into_iter().find(|class| *class != "convex").unwrap_or("convex");
    let mut forms: Vec<&'static str> = sides.iter().flat_map(|side| side.whole.labels()).collect();
    forms.sort_unstable();
    forms.dedup();
    let accuracy = accuracy_name(accuracy.tier, accuracy.max_error);
    Labels { class, forms, extremes, accuracy }
}

/// Asks and judges; `None` if the crate refuses one of the forms.
pub(super) fn examine(question: &WholeQuestion) -> Option<Outcome> {
    let geometries = question.sides.each_ref().map(|side| side.whole.geometry());
    let [Ok(a), Ok(b)] = &geometries else { return None };
    let a = Placed { geometry: a, pose: question.sides[0].pose() };
    let b = Placed { geometry: b, pose: question.sides[1].pose() };
    let (there, back) = (question.ask(a, b), question.ask(b, a));
    Some(judge(question, &there, &back))
}

/// UNDECIDED is accepted within this part of s of touch.
const OPEN: f64 = 1e-11;

/// Widest interval to accept of a search that converged, as a part of s.
const CONVERGED: f64 = 1e-11;

/// Normals may be off by this, and the width along them by this part of s.
const NORMAL: f64 = 1e-13;

/// What the oracle knows.
struct Known {
    nearest: Option<Truth>,
    unions: [Union; 2],
    /// One is inside of the other, off its surface.
    is_held: bool,
    /// They are apart, but so near to the surface of a solid that it is open on which side.
    is_open: bool,
    s: f64,
}

/// Nearer to a surface than this part of s the winding number is not asked.
const ON_SURFACE: f64 = 1e-14;

impl Known {
    fn of(question: &WholeQuestion) -> Self {
        let unions = question.sides.each_ref().map(|side| side.whole.union());
        let places = question.sides.each_ref().map(place_of);
        let nearest = Union::nearest((&unions[0], &places[0]), (&unions[1], &places[1])).map(|(truth, _)| truth);
        let held_by =
            |solid: usize, other: usize| unions[solid].holds_some_of(&places[solid], &unions[other], &places[other]);
        let s = scale_of(&question.sides);
        let is_off = |least: f64| nearest.as_ref().is_some_and(|truth| truth.is_above(least));
        let is_held = is_off(ON_SURFACE * s) && (held_by(0, 1) || held_by(1, 0));
        // On the surface the winding number means nothing.
        let has_walls = unions.iter().any(|union| !union.walls.is_empty());
        let is_open = has_walls && is_off(0.0) && !is_off(ON_SURFACE * s);
        Self { nearest, unions, is_held, is_open, s }
    }

    fn is_above(&self, metres: f64) -> bool {
        !self.is_held && !self.is_open && self.nearest.as_ref().is_some_and(|truth| truth.is_above(metres))
    }

    fn is_below(&self, metres: f64) -> bool {
        self.is_held && metres > 0.0 || self.nearest.as_ref().is_some_and(|truth| truth.is_below(metres))
    }

    fn says(&self) -> String {
        let nearest = self.nearest.as_ref().map(Truth::nearest);
        format!("truth {nearest:?}, held {}, s {:e}", self.is_held, self.s)
    }
}

fn judge(question: &WholeQuestion, there: &Answers, back: &Answers) -> Outcome {
    let known = Known::of(question);
    let overlaps = known.is_held || !known.is_above(0.0);
    let (distance, overlap) =
        (judge_distance(question, &known, there, back), judge_overlap(question, &known, there, back));
    let mut answers = vec![distance, overlap];
    if let Ok(contacts) = &there.contacts {
        answers.push(judge_contacts(question, &known, contacts, &there.work[2]));
    }
    Outcome { answers, overlaps, blur: 0.0 }
}

fn judge_distance(question: &WholeQuestion, known: &Known, there: &Answers, back: &Answers) -> Answer {
    let mut answer = Answer::to(Asked::Distance);
    let limit = question.limit;
    judge_work(&mut answer, question, &there.work[0]);
    let values = |answers: &Answers| answers.distance.as_ref().map(|found| (found.distance, found.certificate));
    if values(there) != values(back) {
        answer.fault(FaultKind::Order, format!("distance: {:?}, swapped {:?}", values(there), values(back)));
    }
    let Some(found) = &there.distance else {
        if known.is_below(limit) {
            answer.fault(FaultKind::Verdict, format!("distance: none within {limit:e}; {}", known.says()));
        }
        return answer;
    };
    let bound = found.certificate.bound;
    form(&mut answer, bound, found.distance);
    let below = bound.lower > 0.0 && known.is_below(bound.lower);
    if below || known.is_above(bound.upper) || bound.lower < 0.0 {
        answer.fault(FaultKind::Bound, format!("distance in [{:e}, {:e}]; {}", bound.lower, bound.upper, known.says()));
    }
    if found.certificate.verdict == Verdict::Hit && known.is_above(limit) {
        answer.fault(FaultKind::Verdict, format!("distance: within {limit:e}; {}", known.says()));
    }
    width(&mut answer, question, &found.certificate, known.s);
    answer
}

fn judge_overlap(question: &WholeQuestion, known: &Known, there: &Answers, back: &Answers) -> Answer {
    let mut answer = Answer::to(Asked::Overlap);
    let found = &there.overlap;
    let bound = found.bound;
    judge_work(&mut answer, question, &there.work[1]);
    if there.overlap != back.overlap {
        answer.fault(FaultKind::Order, format!("overlap: {:?}, swapped {:?}", there.overlap, back.overlap));
    }
    let in_order = bound.lower <= bound.upper;
    if !in_order {
        answer.fault(FaultKind::Form, format!("overlap in [{:e}, {:e}]", bound.lower, bound.upper));
    }
    let is_below = !known.is_held && known.is_below(bound.lower);
    if is_below || known.is_above(bound.upper) {
        answer.fault(FaultKind::Bound, format!("overlap in [{:e}, {:e}]; {}", bound.lower, bound.upper, known.says()));
    }
    let is_off = known.nearest.as_ref().is_some_and(|truth| truth.is_above(OPEN * known.s));
    // Pieces of a skin have no volume, so what has none either cannot be proved to touch them.
    let is_sheet = known.is_below(0.0) && question.sides.iter().any(|side| !side.whole.has_volume());
    let is_clear = is_off || known.is_below(-OPEN * known.s) && !is_sheet;
    match found.verdict {
        Verdict::Hit if known.is_above(0.0) => answer.fault(FaultKind::Verdict, format!("HIT; {}", known.says())),
        Verdict::Miss if known.is_below(0.0) || known.is_held => {
            answer.fault(FaultKind::Verdict, format!("MISS; {}", known.says()));
        }
        Verdict::Undecided => {
            answer.is_undecided = true;
            let is_excused = found.stop == Stop::Budget && question.accuracy.tier != Tier::Exact || known.is_open;
            if is_clear && !is_excused {
                answer.fault(FaultKind::Undecided, format!("overlap {found:?}; {}", known.says()));
            }
        }
        _ => {}
    }
    answer
}

fn judge_contacts(question: &WholeQuestion, known: &Known, contacts: &Contacts, work: &Work) -> Answer {
    let mut answer = Answer::to(Asked::Penetration);
    judge_work(&mut answer, question, work);
    answer.is_undecided = contacts.iter().any(|contact| contact.certificate.verdict == Verdict::Undecided);
    for contact in contacts {
        let bound = contact.certificate.bound;
        form(&mut answer, bound, contact.depth);
        if (contact.normal_b_to_a.length() - 1.0).abs() > NORMAL {
            answer.fault(FaultKind::Normal, format!("normal {:?}", contact.normal_b_to_a));
        }
        let points = contact.points.iter().flat_map(|point| [point.point_on_a, point.point_on_b]);
        if contact.points.is_empty() || !points.fold(DVec3::ZERO, |sum, point| sum + point).is_finite() {
            answer.fault(FaultKind::Form, format!("points {:?}", contact.points));
        }
        if contact.certificate.verdict == Verdict::Hit && known.is_above(0.0) {
            answer.fault(FaultKind::Verdict, format!("contact HIT; {}", known.says()));
        }
        judge_depth(&mut answer, question, known, contact);
    }
    // Each pair of convex pieces that touch has a contact, save for the backs of surfaces that have a front.
    let is_felt = question.sides.iter().all(|side| side.whole.is_felt_from_all_sides());
    if is_felt && contacts.is_empty() && known.is_below(-OPEN * known.s) {
        answer.fault(FaultKind::Verdict, format!("no contact; {}", known.says()));
    }
    answer
}

/// A contact of two pieces that can be told: its depth is theirs, or, of a triangle, that along the normal that its surface has.
fn judge_depth(answer: &mut Answer, question: &WholeQuestion, known: &Known, contact: &Contact) {
    let pieces = [contact.feature_a, contact.feature_b];
    let index = |side: usize| question.sides[side].whole.piece_of(pieces[side]);
    let (Some(a), Some(b)) = (index(0), index(1)) else { return };
    if contact.certificate.model != Model::EXACT {
        return;
    }
    let places = question.sides.each_ref().map(place_of);
    let (one, other) = (&known.unions[0].pieces[a], &known.unions[1].pieces[b]);
    let sides = [(&one.solid, &one.place(&places[0])), (&other.solid, &other.place(&places[1]))];
    let truth = Truth::at(sides, Double::default(), &[-contact.normal_b_to_a]);
    let bound = contact.certificate.bound;
    let along = -truth.gap_along(-contact.normal_b_to_a);
    let is_along = bound.lower <= along + NORMAL * known.s;
    let is_convex = question.sides.iter().all(|side| side.whole.is_felt_from_all_sides());
    let is_too_deep = is_convex && truth.is_above(-bound.lower);
    if !is_along || is_too_deep || truth.is_below(-bound.upper) {
        let (lower, upper, nearest) = (bound.lower, bound.upper, -truth.nearest());
        let what = format!("depth in [{lower:e}, {upper:e}], {nearest:e}, {along:e} along its normal, s {:e}", known.s);
        answer.fault(FaultKind::Bound, what);
    }
}

fn form(answer: &mut Answer, bound: Bound, value: f64) {
    // NaN fails every comparison.
    if !(bound.lower <= value && value <= bound.upper && value.is_finite()) {
        answer.fault(FaultKind::Form, format!("{value:e} in [{:e}, {:e}]", bound.lower, bound.upper));
    }
}

fn width(answer: &mut Answer, question: &WholeQuestion, certificate: &Certificate, s: f64) {
    let (bound, accuracy) = (certificate.bound, &question.accuracy);
    answer.is_undecided = certificate.verdict == Verdict::Undecided;
    let asked = accuracy.max_error.max(accuracy.max_error_relative * bound.upper);
    let widest = match certificate.stop {
        Stop::Budget => f64::INFINITY,
        Stop::Tolerance => asked,
        Stop::Converged => asked.max(CONVERGED * s),
    };
    let is_narrow = bound.width() <= widest;
    if !is_narrow {
        let what = format!("[{:e}, {:e}], {:?}, asked {asked:e}, s {s:e}", bound.lower, bound.upper, certificate.stop);
        answer.fault(FaultKind::Width, what);
    }
    if accuracy.tier == Tier::Exact {
        let is_finished = bound.width() <= asked.max(CONVERGED * s);
        answer.is_unfinished = certificate.stop == Stop::Budget && !is_finished;
        if accuracy.max_error == 0.0 {
            answer.width = Some(bound.width() / s);
        }
    }
}

/// Pairs of pieces each have their budget.
fn judge_work(answer: &mut Answer, question: &WholeQuestion, work: &Work) {
    let most = u64::from(iterations_max(question.accuracy.budget)) * (work.pairs_tested + 1);
    if work.iterations > most {
        answer.fault(FaultKind::Work, format!("{work:?}: at most {most} iterations are allowed"));
    }
    let pairs = question.sides.iter().map(|side| side.whole.piece_count()).product::<u64>();
    if work.pairs_tested > PASSES_MAX * pairs || work.nodes_visited > PASSES_MAX * pairs {
        answer.fault(FaultKind::Work, format!("{work:?} for {pairs} pairs of pieces"));
    }
}

/// How often a pair of pieces, or a node, may be looked at.
const PASSES_MAX: u64 = 16;

#[cfg(test)]
mod tests {
    use super::*;

    fn is_right(question: &WholeQuestion, tamper: impl Fn(&mut Answers)) -> bool {
        let geometries = question.sides.each_ref().map(|side| side.whole.geometry().expect("a form"));
        let [a, b] = [0, 1].map(|side| Placed { geometry: &geometries[side], pose: question.sides[side].pose() });
        let (mut there, mut back) = (question.ask(a, b), question.ask(b, a));
        tamper(&mut there);
        tamper(&mut back);
        judge(question, &there, &back).faults().next().is_none()
    }

    #[test]
    fn planted_verdicts_and_bounds_are_found() {
        let mut found = [0; 2];
        for (seed, class) in (0..20).flat_map(|seed| Class::ALL.map(|class| (seed, class))) {
            let question = whole_question(seed, class, Kind::Box);
            assert!(is_right(&question, |_| ()), "{seed} {class:?}");
            let known = Known::of(&question);
            let away = known.is_above(1e-6 * known.s);
            if !away && !known.is_below(-1e-6 * known.s) {
                continue;
            }
            found[usize::from(away)] += 1;
            let wrong = if away { Verdict::Hit } else { Verdict::Miss };
            assert!(!is_right(&question, |answers| answers.overlap.verdict = wrong), "{seed} {class:?}");
            let moved = |answers: &mut Answers| {
                if let Some(found) = &mut answers.distance {
                    let Bound { lower, upper } = found.certificate.bound;
                    let by = upper.max(1e-3 * known.s);
                    (found.certificate.bound, found.distance) = (Bound::new(lower + by, upper + by), upper + by);
                }
            };
            assert!(question.limit.is_finite() || !is_right(&question, moved), "{seed} {class:?}");
        }
        assert!(found.iter().all(|count| *count > 20), "{found:?}");
    }
}
