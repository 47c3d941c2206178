//! Holds first touches against what the oracle sees of the motion.
//!
//! # Method
//! Without turns the oracle knows the first touch of each pair of convex pieces. With turns it looks for an overlap before the
//! answer's interval, and for one at its end, which is how the answer proves its touch.

use super::{
    judge::iterations_max,
    moves::{MoveQuestion, Moved},
    moves_first::{First, first, pairs},
    outcome::{Answer, Asked, FaultKind, Outcome},
    whole_pairs::scale_of,
};
use crate::oracle::{Place, Solid, Truth, Union, look_for_overlap};
use collision::{
    accuracy::Tier,
    answer::{Stop, Verdict},
    narrow::{ImpactTouch, InitialTouch},
};

/// Times are rounded to an f64 by whoever tells them.
const TIME: f64 = 1e-15;

/// What lasts no longer than this is below the rounding of the oracle's lengths.
const NOW: f64 = 1e-24;

/// Touches may stay open within this part of s of a graze.
const OPEN: f64 = 1e-11;

/// Widest interval to accept of a motion without turns, as a part of s over the cosine of incidence, where that is not small.
const WIDE: f64 = 1e-11;
const COSINE_MIN: f64 = 1e-2;

/// Judges a first touch.
pub(super) fn judge(question: &MoveQuestion, moved: &Moved) -> Outcome {
    let mut answer = Answer::to(question.asked());
    let touch = moved.there.as_ref();
    sane(&mut answer, question, moved);
    let unions = question.sides.each_ref().map(|side| side.whole.union());
    let overlaps = match answer.asked {
        Asked::Impact => judge_straight(&mut answer, question, &unions, touch),
        _ => judge_turning(&mut answer, question, &unions, touch),
    };
    Outcome { answers: vec![answer], overlaps, blur: 0.0 }
}

/// What holds of every answer.
fn sane(answer: &mut Answer, question: &MoveQuestion, moved: &Moved) {
    let accuracy = &question.accuracy;
    let most = u64::from(iterations_max(accuracy.budget)) * (moved.work.pairs_tested + 1);
    if moved.work.iterations > most {
        answer.fault(FaultKind::Work, format!("{:?}: at most {most} iterations are allowed", moved.work));
    }
    let told = |touch: &ImpactTouch| (touch.fraction, touch.certificate, touch.initial);
    let (here, other) = (moved.there.as_ref().map(told), moved.back.as_ref().map(told));
    if here != other {
        answer.fault(FaultKind::Order, format!("{here:?}, swapped {other:?}"));
    }
    let Some(touch) = &moved.there else { return };
    let (bound, certificate) = (touch.certificate.bound, &touch.certificate);
    let in_order = 0.0 <= bound.lower && bound.lower <= touch.fraction && touch.fraction <= bound.upper;
    if !(in_order && bound.upper <= 1.0 && touch.point.is_finite()) {
        answer.fault(FaultKind::Form, format!("{touch:?}"));
    }
    if touch.normal_b_to_a.is_some_and(|normal| (normal.length() - 1.0).abs() > 1e-12) {
        answer.fault(FaultKind::Normal, format!("{touch:?}"));
    }
    answer.is_undecided = certificate.verdict == Verdict::Undecided;
    if certificate.verdict == Verdict::Miss {
        answer.fault(FaultKind::Verdict, format!("MISS in an answer: {touch:?}"));
    }
    let way = (question.motion.displacement_b - question.motion.displacement_a).length();
    let of_motion = if way > 0.0 { accuracy.max_error / way } else { 1.0 };
    let asked = of_motion.max(accuracy.max_error_relative * bound.upper) * (1.0 + 1e-9);
    if certificate.stop == Stop::Tolerance && certificate.verdict == Verdict::Hit && bound.width() > asked {
        answer.fault(FaultKind::Width, format!("asked {asked:e}: {touch:?}"));
    }
    if accuracy.tier == Tier::Exact && accuracy.max_error == 0.0 {
        answer.width = Some(bound.width() * (way / scale_of(&question.sides)).min(1.0));
    }
}

/// Whether the forms meet.
fn judge_straight(
    answer: &mut Answer,
    question: &MoveQuestion,
    unions: &[Union; 2],
    touch: Option<&ImpactTouch>,
) -> bool {
    let first = first(question, unions);
    let Some(held) = is_held(question, unions) else { return true };
    let says = format!(
        "free until {:e}, touching at {:?}, at the start {}, held {held}",
        first.free_until, first.touching_at, first.at_start
    );
    let overlaps = first.free_until <= 1.0 || held;
    if first.is_open {
        return overlaps;
    }
    let way = (question.motion.displacement_b - question.motion.displacement_a).length();
    let s = scale_of(&question.sides).max(way);
    // Within rounding of a touch at the start it is open whether that is the one to pass over.
    let at_start = first.at_start || first.gap_at_start <= OPEN * s;
    if question.motion.initial == InitialTouch::IsIgnored && (at_start || held) {
        if touch.is_some_and(|touch| touch.certificate.verdict == Verdict::Hit) && first.touching_at == Some(0.0) {
            answer.fault(FaultKind::Verdict, format!("touches after a touch that is ignored: {touch:?}; {says}"));
        }
        return overlaps;
    }
    let first = if held { First { free_until: 0.0, touching_at: Some(0.0), at_start: true, ..first } } else { first };
    let is_clear = || deepest(question, unions, &first.counted) > OPEN * s;
    let Some(touch) = touch else {
        if first.touching_at.is_some_and(|time| time <= 1.0) {
            answer.fault(FaultKind::Verdict, format!("no touch; {says}"));
        }
        return overlaps;
    };
    let bound = touch.certificate.bound;
    let is_late = first.touching_at.is_some_and(|time| time + NOW < bound.lower);
    if first.free_until > bound.upper * (1.0 + TIME) && touch.certificate.verdict == Verdict::Hit {
        answer.fault(FaultKind::Verdict, format!("{touch:?}; {says}"));
    }
    if is_late {
        answer.fault(FaultKind::Bound, format!("{touch:?}; {says}"));
    }
    let width = bound.width() * way / s;
    let is_sharp = touch.certificate.verdict == Verdict::Hit && touch.certificate.stop != Stop::Budget;
    // Of a concave form another piece that is grazed may leave it open.
    let is_alone = unions.iter().all(|union| union.pieces.len() == 1);
    let is_exact = is_alone && question.accuracy.tier == Tier::Exact && question.accuracy.max_error == 0.0;
    if is_sharp && is_exact && first.cosine >= COSINE_MIN && width > WIDE / first.cosine && is_clear() {
        let cosine = first.cosine;
        answer.fault(FaultKind::Width, format!("{width:e} s wide at cosine {cosine:e}: {touch:?}; {says}"));
    }
    let is_excused = touch.certificate.stop == Stop::Budget && question.accuracy.tier != Tier::Exact;
    if touch.certificate.verdict == Verdict::Undecided && !is_excused && is_clear() {
        answer.fault(FaultKind::Undecided, format!("{touch:?}; {says}; s {s:e}"));
    }
    overlaps
}

/// One of the forms is inside of a solid one at the start, off its surface; `None` if that is open.
fn is_held(question: &MoveQuestion, unions: &[Union; 2]) -> Option<bool> {
    if unions.iter().all(|union| union.walls.is_empty()) {
        return Some(false);
    }
    let places = question.places();
    let held_by =
        |solid: usize, other: usize| unions[solid].holds_some_of(&places[solid], &unions[other], &places[other]);
    let nearest = Union::nearest((&unions[0], &places[0]), (&unions[1], &places[1]));
    let is_off = |(truth, _): &(Truth, _), least: f64| truth.is_above(least * scale_of(&question.sides));
    // On the surface the winding number means nothing.
    match nearest {
        Some(nearest) if is_off(&nearest, ON_SURFACE) => Some(held_by(0, 1) || held_by(1, 0)),
        Some(nearest) if is_off(&nearest, 0.0) => None,
        _ => Some(false),
    }
}

/// Nearer to a surface than this part of s it is open on which side of it a form is.
const ON_SURFACE: f64 = 1e-14;

/// Times at which the depth is looked at.
const LOOKS: u32 = 16;

/// The greatest depth that some pieces that count surely have at some time of the motion.
fn deepest(question: &MoveQuestion, unions: &[Union; 2], counted: &[[usize; 2]]) -> f64 {
    let places = question.places();
    let mut deepest = 0.0_f64;
    for (look, pieces) in (0..=LOOKS).flat_map(|look| counted.iter().map(move |pieces| (look, pieces))) {
        let time = crate::oracle::Number::of(f64::from(look) / f64::from(LOOKS));
        let [a, b] = [0, 1].map(|side| &unions[side].pieces[pieces[side]]);
        let sides = [(&a.solid, &a.place(&places[0])), (&b.solid, &b.place(&places[1]))];
        deepest = deepest.max(-Truth::at(sides, time, &[]).bounds()[1]);
    }
    deepest
}

/// Whether the forms meet, as far as the answer says so.
fn judge_turning(
    answer: &mut Answer,
    question: &MoveQuestion,
    unions: &[Union; 2],
    touch: Option<&ImpactTouch>,
) -> bool {
    let verdict = touch.map_or(Verdict::Miss, |touch| touch.certificate.verdict);
    let overlaps = verdict == Verdict::Hit;
    if question.motion.initial == InitialTouch::IsIgnored
        || question.sides.iter().any(|side| side.whole.is_one_sided())
        || is_held(question, unions) != Some(false)
    {
        return overlaps;
    }
    let places = question.places();
    // What is so much smaller than its way touches within the rounding of the oracle's lengths.
    let way = places[0].displacement.length().max(places[1].displacement.length());
    let apart = (places[1].position - places[0].position).length();
    let reach = question.sides.iter().map(|side| side.whole.reach()).sum::<f64>();
    if apart + reach < 1e-15 * way {
        return overlaps;
    }
    let end = touch.map_or(1.0, |touch| touch.certificate.bound.lower);
    let pairs = pairs(unions, &places);
    for [(solid_a, place_a, _), (solid_b, place_b, _)] in &pairs {
        let seen = look_for_overlap([(solid_a, place_a), (solid_b, place_b)], end);
        if let Some(time) = seen.overlap_at {
            answer.fault(FaultKind::Bound, format!("{touch:?}, but they overlap at {time:?}"));
            return overlaps;
        }
    }
    let Some(touch) = touch.filter(|touch| touch.certificate.verdict == Verdict::Hit) else { return overlaps };
    let bound = touch.certificate.bound;
    let s = scale_of(&question.sides);
    let gap_at = |[(solid_a, place_a, _), (solid_b, place_b, _)]: &[(&Solid, Place, usize); 2], time: f64| {
        Truth::at([(solid_a, place_a), (solid_b, place_b)], crate::oracle::Number::of(time), &[]).bounds()[0]
    };
    let steps = || (0..=LOOKS).map(|step| bound.upper - bound.width() * (f64::from(step) / f64::from(LOOKS)));
    let is_closed = |pair, time| gap_at(pair, time) <= 1e-15 * s;
    // What goes through a sheet touches it for less than an instant between two f64: there it is nearest.
    let is_passed = |pair| is_closed(pair, nearest_time(|time| gap_at(pair, time), bound.lower, bound.upper));
    let touches = pairs.iter().any(|pair| steps().any(|time| is_closed(pair, time))) || pairs.iter().any(is_passed);
    let has_walls = unions.iter().any(|union| !union.walls.is_empty());
    if !touches && !has_walls {
        answer.fault(FaultKind::Verdict, format!("apart at all times of the interval looked at: {touch:?}"));
    }
    overlaps
}

/// Where a gap that first shrinks and then grows is least, between two times.
fn nearest_time(gap_at: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..80 {
        let third = (high - low) / 3.0;
        let (early, late) = (low + third, high - third);
        if gap_at(early) <= gap_at(late) { high = late } else { low = early }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use collision::{
        accuracy::Accuracy,
        answer::{Bound, Work},
        narrow::{self, Motion, Placed},
        shape::MeshMode,
    };
    use glam::{DQuat, DVec3};

    use super::*;
    use crate::{
        coverage::{PlacedWhole, Whole},
        oracle::Core,
    };

    /// A ball that comes to a box, and turns or does not.
    fn question(spin: f64) -> MoveQuestion {
        let place = |core: Core, radius: f64, x: f64| PlacedWhole {
            whole: Whole::Convex(Solid { core, radius }),
            position: DVec3::X * x,
            rotation: DQuat::IDENTITY,
        };
        let sides = [place(Core::Cuboid { half_extents: DVec3::ONE }, 0.0, 0.0), place(Core::Point, 0.5, 4.0)];
        let motion = Motion { displacement_b: DVec3::X * -4.0, rotation_a: DVec3::X * spin, ..Motion::default() };
        MoveQuestion { categories: ["test"; 2], sides, motion, accuracy: Accuracy::of(Tier::Exact) }
    }

    fn faults(spin: f64, tamper: impl Fn(&mut Option<ImpactTouch>)) -> Vec<FaultKind> {
        faults_of(&question(spin), tamper)
    }

    fn narrow_touch(question: &MoveQuestion) -> Option<ImpactTouch> {
        crate::coverage::first_touch(question).expect("forms").1
    }

    fn faults_of(question: &MoveQuestion, tamper: impl Fn(&mut Option<ImpactTouch>)) -> Vec<FaultKind> {
        let geometries = question.sides.each_ref().map(|side| side.whole.geometry().expect("a form"));
        let [a, b] = [0, 1].map(|side| Placed { geometry: &geometries[side], pose: question.sides[side].pose() });
        let mut work = Work::default();
        let mut there = narrow::impact(a, b, &question.motion, &question.accuracy, &mut work);
        tamper(&mut there);
        let outcome = judge(question, &Moved { there, back: there, work });
        outcome.faults().map(|fault| fault.kind).collect()
    }

    #[test]
    fn first_touches_that_are_right_have_no_fault_and_planted_ones_are_found() {
        for spin in [0.0, 1.0] {
            assert_eq!(faults(spin, |_| ()), [], "{spin}");
            assert_eq!(faults(spin, |touch| *touch = None).len(), 1, "{spin}");
            for by in [1e-9, -1e-9] {
                let moved = faults(spin, |touch| {
                    let touch = touch.as_mut().expect("they meet");
                    let Bound { lower, upper } = touch.certificate.bound;
                    touch.certificate.bound = Bound::new(lower + by, upper + by);
                    touch.fraction += by;
                });
                assert!(!moved.is_empty(), "{spin} {by}");
            }
        }
    }

    /// Beside a triangle that the ball goes through from behind, another may be grazed: that is as open as a graze is.
    #[test]
    fn only_what_counts_is_too_deep_to_be_open() {
        let from = |height: f64| {
            let mut question = question(0.0);
            let vertices = vec![DVec3::new(-9.0, 0.0, -9.0), DVec3::new(0.0, 0.0, 9.0), DVec3::new(9.0, 0.0, -9.0)];
            question.sides[0].whole = Whole::Mesh { mode: MeshMode::OneSided, vertices, triangles: vec![[0, 1, 2]] };
            question.sides[1].position = DVec3::Y * height;
            question.motion.displacement_b = DVec3::Y * (-2.0 * height);
            question
        };
        let touch = narrow_touch(&from(4.0)).expect("the front is met");
        assert!(narrow_touch(&from(-4.0)).is_none(), "the back is not");
        for (height, expected) in [(4.0, vec![FaultKind::Undecided]), (-4.0, vec![])] {
            let open = |found: &mut Option<ImpactTouch>| {
                let mut touch = touch;
                touch.certificate.verdict = Verdict::Undecided;
                *found = Some(touch);
            };
            assert_eq!(faults_of(&from(height), open), expected, "{height}");
        }
    }
}
