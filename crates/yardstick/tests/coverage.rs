//! The coverage runner sees what is wrong: bounds, verdicts and points that were tampered with.

use std::{process::Command, sync::atomic::AtomicBool};

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Stop, Verdict, Work},
    math::Pose,
    narrow::{self, Placed},
    shape::Geometry,
};
use yardstick::{
    coverage::{Answers, Asked, By, FaultKind, Kind, Outcome, Question, Settings, State, examine, judge, run},
    oracle::{Core, PlacedSolid, Solid, Truth},
};

/// Two boxes that are turned, `gap` apart along x.
fn boxes(gap: f64) -> Question {
    let cube = |x: f64| PlacedSolid {
        solid: Solid { core: Core::Cuboid { half_extents: DVec3::ONE }, radius: 0.0 },
        position: DVec3::new(x, 0.25, 0.0),
        rotation: DQuat::from_xyzw(0.25, 0.0, 0.0, 0.75),
    };
    let accuracy = Accuracy::of(Tier::Exact);
    let (a, b) = (cube(0.0), cube(2.0 + gap));
    let before = (b.position, b.rotation);
    Question { category: "test", a, b, accuracy, limit: f64::INFINITY, max_gap: 1.0, before }
}

fn answers(question: &Question) -> [Answers; 2] {
    let cube = Geometry::cuboid(DVec3::ONE).expect("a box");
    let place = |placed: &PlacedSolid| Pose::new(placed.position, placed.rotation);
    let a = Placed { geometry: &cube, pose: place(&question.a) };
    let b = Placed { geometry: &cube, pose: place(&question.b) };
    let answer = |a: Placed<'_>, b: Placed<'_>| {
        let (accuracy, work) = (&question.accuracy, &mut Work::default());
        let contacts = narrow::penetration(a, b, question.max_gap, accuracy, work).expect("convex");
        Answers {
            distance: narrow::distance(a, b, question.limit, accuracy, work),
            overlap: narrow::overlap(a, b, accuracy, work),
            contact: contacts.into_iter().next(),
            warm: None,
        }
    };
    [answer(a, b), answer(b, a)]
}

/// What is found wrong once both answers are tampered with alike.
fn tampered(gap: f64, tamper: impl Fn(&mut Answers)) -> Outcome {
    let question = boxes(gap);
    let mut answers = answers(&question);
    answers.iter_mut().for_each(tamper);
    judge(&question, &answers, &Truth::of(&question.a, &question.b, &[]))
}

#[track_caller]
fn expect(outcome: &Outcome, kind: FaultKind) {
    assert!(outcome.faults().any(|fault| fault.kind == kind), "{outcome:?}");
}

#[test]
fn right_answers_have_no_fault() {
    for gap in [0.5, -0.5] {
        let outcome = tampered(gap, |_| ());
        assert!(outcome.faults().next().is_none() && outcome.overlaps == (gap < 0.0), "{outcome:?}");
    }
}

#[test]
fn planted_wrong_bounds_are_found() {
    // By little more than nothing on either side.
    let beside = [Bound::new(0.5 + 1e-14, 0.5 + 2e-14), Bound::new(0.5 - 2e-14, 0.5 - 1e-14)];
    for bound in beside {
        expect(
            &tampered(0.5, |answers| {
                let distance = answers.distance.as_mut().expect("no limit");
                (distance.certificate.bound, distance.distance) = (bound, bound.lower);
            }),
            FaultKind::Bound,
        );
        expect(
            &tampered(-0.5, |answers| {
                let contact = answers.contact.as_mut().expect("they overlap");
                (contact.certificate.bound, contact.depth) = (bound, bound.lower);
            }),
            FaultKind::Bound,
        );
        expect(&tampered(0.5, |answers| answers.overlap.bound = bound), FaultKind::Bound);
    }
}

#[test]
fn other_faults_are_found() {
    expect(&tampered(0.5, |answers| answers.overlap.verdict = Verdict::Hit), FaultKind::Verdict);
    expect(&tampered(-0.5, |answers| answers.overlap.verdict = Verdict::Miss), FaultKind::Verdict);
    expect(&tampered(-0.5, |answers| answers.overlap.verdict = Verdict::Undecided), FaultKind::Undecided);
    expect(&tampered(0.5, |answers| answers.distance = None), FaultKind::Verdict);
    expect(&tampered(-0.5, |answers| answers.contact = None), FaultKind::Verdict);
    let widened = |answers: &mut Answers| {
        let certificate = &mut answers.distance.as_mut().expect("no limit").certificate;
        (certificate.bound.upper, certificate.stop) = (0.6, Stop::Converged);
    };
    expect(&tampered(0.5, widened), FaultKind::Width);
    let turned = |answers: &mut Answers| {
        let contact = answers.contact.as_mut().expect("they overlap");
        contact.normal_b_to_a = DVec3::new(0.8, 0.6, 0.0);
    };
    expect(&tampered(-0.5, turned), FaultKind::Normal);
    expect(&tampered(0.5, |answers| answers.distance.as_mut().expect("no limit").point_on_a += 0.1), FaultKind::Points);
    let busy = |answers: &mut Answers| answers.overlap.iterations = 1_000_000;
    expect(&tampered(-0.5, busy), FaultKind::Work);
    let nan = |answers: &mut Answers| answers.contact.as_mut().expect("they overlap").depth = f64::NAN;
    expect(&tampered(-0.5, nan), FaultKind::Form);
}

#[test]
fn swapped_arguments_must_swap_the_answer() {
    let question = boxes(0.5);
    let [there, mut back] = answers(&question);
    back.overlap.iterations += 1;
    let truth = Truth::of(&question.a, &question.b, &[]);
    expect(&judge(&question, &[there, back], &truth), FaultKind::Order);
}

fn settings(kinds: Option<(Kind, Kind)>, answers: u64, threads: usize) -> Settings {
    Settings { answers, first: 0, cases: u64::MAX, seed: 1, kinds, threads, resume: None }
}

fn run_quietly(settings: &Settings) -> State {
    run(settings, &AtomicBool::new(false), &mut |_| (), &mut |_| ()).expect("no file, no error")
}

#[test]
fn any_number_of_threads_counts_the_same() {
    let few = |threads: usize| Settings { cases: 200, ..settings(None, u64::MAX, threads) };
    let alone = run_quietly(&few(1)).report;
    assert_eq!(alone, run_quietly(&few(2)).report);
    let table = &alone.tables[&By::Question];
    for asked in Asked::ALL {
        assert!(table.keys().any(|name| name.starts_with(asked.name())), "{asked:?}: {:?}", table.keys());
    }
}

#[test]
fn a_run_that_is_resumed_ends_as_one_that_was_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("run.json");
    let from = |first: u64| Settings { first, ..settings(None, u64::MAX, 1) };
    let kept = |cases: u64| Settings { cases, resume: Some(file.clone()), ..from(40) };
    assert_eq!(run_quietly(&kept(60)).next, 100, "a file that is not there yet is begun at the first case");
    let resumed = run_quietly(&kept(140));
    let whole = run_quietly(&Settings { cases: 140, ..from(40) });
    assert_eq!((resumed.next, &resumed.report), (whole.next, &whole.report));
    let other = Settings { seed: 2, ..kept(140) };
    assert!(run(&other, &AtomicBool::new(false), &mut |_| (), &mut |_| ()).is_err(), "the file is of another seed");
}

/// Neither all apart nor all overlapping, else the sweep would be worth little.
#[test]
fn the_pairs_are_mixed() {
    let outcome = |seed: u64| examine(&yardstick::coverage::question(seed, (Kind::Box, Kind::Capsule)));
    let outcomes: Vec<Outcome> = (0..200).filter_map(outcome).map(|(outcome, _)| outcome).collect();
    let overlaps = outcomes.iter().filter(|outcome| outcome.overlaps).count();
    assert!(outcomes.len() > 190 && (60..140).contains(&overlaps), "{overlaps} of {}", outcomes.len());
}

#[test]
fn closed_forms_hold_the_truth() {
    for kinds in [(Kind::Sphere, Kind::Sphere), (Kind::Sphere, Kind::Capsule), (Kind::Box, Kind::HalfSpace)] {
        let mut failures = Vec::new();
        let mut failed = |failure: yardstick::coverage::Failure| failures.push(failure.source);
        let cases = if cfg!(debug_assertions) { 200 } else { 3000 };
        let settings = Settings { cases, ..settings(Some(kinds), u64::MAX, 1) };
        let state = run(&settings, &AtomicBool::new(false), &mut |_| (), &mut failed).expect("no file");
        let total = state.report.total;
        assert!(total.failed == 0 && total.count > 2 * cases, "{}", failures.join("\n"));
    }
}

#[test]
fn too_few_of_a_sort_are_said() {
    let spheres = Settings { cases: 100, ..settings(Some((Kind::Sphere, Kind::Sphere)), u64::MAX, 1) };
    let shortages = run_quietly(&spheres).report.shortages();
    assert!(shortages.iter().any(|shortage| shortage.starts_with("form cone: 0.000 %")), "{shortages:?}");
    assert!(!shortages.iter().any(|shortage| shortage.starts_with("form sphere")), "{shortages:?}");
}

#[test]
fn the_program_prints_tables() {
    let arguments = ["coverage", "--answers", "100", "--cases", "40", "--kind", "sphere-sphere", "--seed", "3"];
    let output = Command::new(env!("CARGO_BIN_EXE_yardstick")).args(arguments).output().expect("it runs");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && said.contains("distance convex") && said.contains("answers of seed 3"),
        "{said}"
    );
    let wrong = Command::new(env!("CARGO_BIN_EXE_yardstick")).args(["coverage", "--kind", "box-torus"]).output();
    assert_eq!(wrong.expect("it runs").status.code(), Some(2));
}
