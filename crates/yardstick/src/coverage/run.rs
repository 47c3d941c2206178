//! Asks and judges very many pairs and rays on some threads.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
};

use super::{
    ask::{Unasked, ask},
    forms::Kind,
    judge::{Fault, FaultKind, Outcome, judge},
    pairs::{Question, question},
    rays::{RayQuestion, cast, judge_ray, ray_question},
    report::{Report, Row},
    source::{ray_test_source, test_source},
};
use crate::{oracle::Truth, scene::Random};

/// What to run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// How many pairs.
    pub pairs: u64,
    /// How many rays, after the pairs.
    pub rays: u64,
    /// The number of the first pair, and of the first ray.
    pub first: u64,
    /// Names the run: the same seed makes the same pairs and rays, on any number of threads.
    pub seed: u64,
    /// Only these two kinds.
    pub kinds: Option<(Kind, Kind)>,
    /// Threads.
    pub threads: usize,
}

/// A pair or a ray with something wrong.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Its number: alone again with `--first` and `--pairs 1` or `--rays 1`.
    pub index: u64,
    /// What is wrong.
    pub faults: Vec<Fault>,
    /// A test to paste.
    pub source: String,
}

/// All pairs of kinds, each once.
fn kind_pairs() -> Vec<(Kind, Kind)> {
    let after = |first: usize| Kind::ALL[first..].iter().map(move |&second| (Kind::ALL[first], second));
    let all = (0..Kind::ALL.len()).flat_map(after);
    all.filter(|kinds| *kinds != (Kind::HalfSpace, Kind::HalfSpace)).collect()
}

/// Kinds that rays are cast at: the oracle knows no stretch without an end.
fn ray_kinds(settings: &Settings) -> Vec<Kind> {
    let kinds = settings.kinds.map_or_else(|| Kind::ALL.to_vec(), |(a, b)| vec![a, b]);
    kinds.into_iter().filter(|kind| *kind != Kind::HalfSpace).collect()
}

/// One of a list by a number.
fn pick<T: Copy>(all: &[T], index: u64) -> Option<T> {
    all.get(usize::try_from(index % all.len().max(1) as u64).ok()?).copied()
}

fn seed_of(settings: &Settings, index: u64) -> u64 {
    Random::new(settings.seed ^ index.wrapping_mul(0xD134_2543_DE82_EF95)).bits()
}

/// What came of one question: where to count it, and, unless a form was refused, the outcome with the test that it
/// would be.
struct Done {
    row: Row,
    outcome: Option<Outcome>,
    failure: Option<Failure>,
}

/// Runs until all are done or `stop` is set. `failed` is called with each failure as it is found, `done` with the
/// number of pairs and rays so far.
pub fn run(
    settings: &Settings,
    stop: &AtomicBool,
    done: &(dyn Fn(u64) + Sync),
    failed: &mut (dyn FnMut(Failure) + Send),
) -> Report {
    let pair_kinds = settings.kinds.map_or_else(kind_pairs, |kinds| vec![kinds]);
    let ray_kinds = ray_kinds(settings);
    let next = AtomicU64::new(0);
    let failed = Mutex::new(failed);
    let total = Mutex::new(Report::default());
    let work = || {
        let mut report = Report::default();
        while !stop.load(Ordering::Relaxed) {
            let step = next.fetch_add(1, Ordering::Relaxed);
            let asked = match step.checked_sub(settings.pairs) {
                None => pick(&pair_kinds, settings.first + step)
                    .map(|kinds| ask_pair(settings, settings.first + step, kinds)),
                Some(ray) if ray < settings.rays => {
                    pick(&ray_kinds, settings.first + ray).map(|kind| ask_ray(settings, settings.first + ray, kind))
                }
                Some(_) => None,
            };
            let Some(asked) = asked else { break };
            let row = report.rows.entry(asked.row).or_default();
            match &asked.outcome {
                Some(outcome) => row.add(outcome),
                None => row.refused += 1,
            }
            if let (Some(failure), Ok(mut failed)) = (asked.failure, failed.lock()) {
                failed(failure);
            }
            done(step + 1);
        }
        if let Ok(mut total) = total.lock() {
            total.merge(report);
        }
    };
    thread::scope(|scope| {
        for _ in 0..settings.threads.max(1) {
            scope.spawn(work);
        }
    });
    total.into_inner().unwrap_or_default()
}

fn ask_pair(settings: &Settings, index: u64, kinds: (Kind, Kind)) -> Done {
    let question = question(seed_of(settings, index), kinds);
    let row = Row::Pair(kinds.0, kinds.1);
    let Some((outcome, truth)) = examine(&question) else { return Done { row, outcome: None, failure: None } };
    let source = |name: &str, faults: &[String]| test_source(name, &question, &truth, faults);
    let failure = failure(settings, index, row, &outcome, source);
    Done { row, outcome: Some(outcome), failure }
}

fn ask_ray(settings: &Settings, index: u64, kind: Kind) -> Done {
    let question = ray_question(seed_of(settings, index), kind);
    let row = Row::Ray(kind);
    let Some(outcome) = examine_ray(&question) else { return Done { row, outcome: None, failure: None } };
    let source = |name: &str, faults: &[String]| ray_test_source(name, &question, faults);
    let failure = failure(settings, index, row, &outcome, source);
    Done { row, outcome: Some(outcome), failure }
}

fn failure(
    settings: &Settings,
    index: u64,
    row: Row,
    outcome: &Outcome,
    source: impl Fn(&str, &[String]) -> String,
) -> Option<Failure> {
    if outcome.faults.is_empty() {
        return None;
    }
    let what: Vec<String> =
        outcome.faults.iter().map(|fault| format!("{}: {}", fault.kind.name(), fault.what)).collect();
    let name = format!("coverage_{}_seed_{}_number_{index}", row.name().replace('-', "_"), settings.seed);
    Some(Failure { index, source: source(&name, &what), faults: outcome.faults.clone() })
}

fn panicked() -> Outcome {
    Outcome { faults: vec![Fault { kind: FaultKind::Panic, what: "a kernel panicked".into() }], ..Outcome::default() }
}

/// Asks and judges one ray; `None` if the crate refuses the form.
#[must_use]
pub fn examine_ray(question: &RayQuestion) -> Option<Outcome> {
    match catch_unwind(AssertUnwindSafe(|| cast(question))) {
        Err(_) => Some(panicked()),
        Ok(answer) => answer.map(|answer| judge_ray(question, &answer)),
    }
}

/// Asks and judges one pair; `None` if the crate refuses one of the forms.
#[must_use]
pub fn examine(question: &Question) -> Option<(Outcome, Truth)> {
    match ask(question) {
        Err(Unasked::Refused(_)) => None,
        Err(Unasked::Panicked) => {
            let truth = Truth::of(&question.a, &question.b, &[]);
            Some((panicked(), truth))
        }
        Ok(answers) => {
            let of_contact = answers[0].contact.iter().map(|contact| contact.normal_b_to_a);
            let of_distance = answers[0].distance.iter().filter_map(|distance| distance.normal_b_to_a);
            let hints: Vec<_> = of_contact.chain(of_distance).map(|normal| -normal).collect();
            let truth = Truth::of(&question.a, &question.b, &hints);
            Some((judge(question, &answers, &truth), truth))
        }
    }
}
