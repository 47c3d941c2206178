//! Asks and judges very many pairs on some threads.

use std::{
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
    report::{Report, pair_name},
    source::test_source,
};
use crate::{oracle::Truth, scene::Random};

/// What to run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// How many pairs.
    pub pairs: u64,
    /// The number of the first.
    pub first: u64,
    /// Names the run: the same seed makes the same pairs, on any number of threads.
    pub seed: u64,
    /// Only these two kinds.
    pub kinds: Option<(Kind, Kind)>,
    /// Threads.
    pub threads: usize,
}

/// A pair with something wrong.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Its number: alone again with `--first` and `--pairs 1`.
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

/// The kinds and the question of a number.
fn numbered(settings: &Settings, index: u64, all: &[(Kind, Kind)]) -> ((Kind, Kind), Question) {
    let kinds = settings.kinds.unwrap_or(all[(index % all.len() as u64) as usize]);
    let seed = Random::new(settings.seed ^ index.wrapping_mul(0xD134_2543_DE82_EF95)).bits();
    (kinds, question(seed, kinds))
}

/// Runs until all are done or `stop` is set. `failed` is called with each failure as it is found, `done` with the
/// number of pairs so far.
pub fn run(
    settings: &Settings,
    stop: &AtomicBool,
    done: &(dyn Fn(u64) + Sync),
    failed: &mut (dyn FnMut(Failure) + Send),
) -> Report {
    let all = kind_pairs();
    let next = AtomicU64::new(0);
    let failed = Mutex::new(failed);
    let total = Mutex::new(Report::default());
    let work = || {
        let mut report = Report::default();
        while !stop.load(Ordering::Relaxed) {
            let step = next.fetch_add(1, Ordering::Relaxed);
            if step >= settings.pairs {
                break;
            }
            let index = settings.first + step;
            let (kinds, question) = numbered(settings, index, &all);
            let kind_report = report.by_kinds.entry(kinds).or_default();
            match examine(&question) {
                None => kind_report.refused += 1,
                Some((outcome, truth)) => {
                    kind_report.add(&outcome);
                    if !outcome.faults.is_empty()
                        && let Ok(mut failed) = failed.lock()
                    {
                        failed(failure(settings.seed, index, kinds, &question, &truth, outcome));
                    }
                }
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

/// Asks and judges one pair; `None` if the crate refuses one of the forms.
#[must_use]
pub fn examine(question: &Question) -> Option<(Outcome, Truth)> {
    match ask(question) {
        Err(Unasked::Refused(_)) => None,
        Err(Unasked::Panicked) => {
            let fault = Fault { kind: FaultKind::Panic, what: "a kernel panicked".into() };
            let truth = Truth::of(&question.a, &question.b, &[]);
            Some((Outcome { faults: vec![fault], ..Outcome::default() }, truth))
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

fn failure(
    seed: u64,
    index: u64,
    kinds: (Kind, Kind),
    question: &Question,
    truth: &Truth,
    outcome: Outcome,
) -> Failure {
    let what: Vec<String> =
        outcome.faults.iter().map(|fault| format!("{}: {}", fault.kind.name(), fault.what)).collect();
    let name = format!("coverage_{}_seed_{seed}_pair_{index}", pair_name(kinds).replace('-', "_"));
    Failure { index, source: test_source(&name, question, truth, &what), faults: outcome.faults }
}
