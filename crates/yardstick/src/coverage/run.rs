//! Asks and judges very many questions on some threads.

use std::{
    io,
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
    time::Instant,
};

use collision::narrow::{ImpactTouch, RayTouches};

use super::{
    ask::{Answers, Unasked, ask},
    case::Case,
    forms::Kind,
    judge::judge,
    moves::{self, MoveQuestion},
    outcome::{Asked, Fault, Outcome},
    pairs::Question,
    rays::{RayQuestion, cast, judge_ray},
    report::Report,
    state::{Keeper, State},
};
use crate::oracle::Truth;

/// What to run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// How many answers at least: the run ends after the batch of cases that reaches them.
    pub answers: u64,
    /// The number of the first case.
    pub first: u64,
    /// How many cases at most.
    pub cases: u64,
    /// Names the run: the same seed makes the same questions, on any number of threads.
    pub seed: u64,
    /// Only these two kinds of convex forms.
    pub kinds: Option<(Kind, Kind)>,
    /// Threads.
    pub threads: usize,
    /// Where the run is kept, to be resumed.
    pub resume: Option<PathBuf>,
}

/// A question with something wrong in an answer.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Its number: alone again with `--first` and `--cases 1`.
    pub index: u64,
    /// What is wrong.
    pub faults: Vec<Fault>,
    /// A test to paste.
    pub source: String,
}

/// Cases after which what came of them is gathered.
const BATCH: u64 = 2000;

/// Runs until there are enough answers or `stop` is set. `failed` is called with each failure as it is found, `done` with
/// the number of answers after each batch.
///
/// # Errors
/// Those of the file that the run is kept in.
pub fn run(
    settings: &Settings,
    stop: &AtomicBool,
    done: &mut dyn FnMut(&State),
    failed: &mut (dyn FnMut(Failure) + Send),
) -> io::Result<State> {
    let path = settings.resume.as_deref();
    let beginning = State::beginning(settings.seed, settings.first);
    let mut state = if let Some(path) = path { beginning.or_resumed(path)? } else { beginning };
    let mut keeper = Keeper::new(path);
    let failed = Mutex::new(failed);
    let last = settings.first.saturating_add(settings.cases);
    while state.report.total.count < settings.answers && state.next < last {
        let begun = Instant::now();
        let end = (state.next + BATCH).min(last);
        let report = batch(settings, state.next..end, stop, &failed);
        // Half a batch is not kept: it is asked again.
        if stop.load(Ordering::Relaxed) {
            break;
        }
        state.report.merge(&report);
        state.next = end;
        state.seconds += begun.elapsed().as_secs_f64();
        keeper.keep(&state)?;
        done(&state);
    }
    keeper.save(&state)?;
    Ok(state)
}

fn batch(
    settings: &Settings,
    cases: std::ops::Range<u64>,
    stop: &AtomicBool,
    failed: &Mutex<&mut (dyn FnMut(Failure) + Send)>,
) -> Report {
    let next = AtomicU64::new(cases.start);
    let total = Mutex::new(Report::default());
    let work = || {
        let mut report = Report::default();
        while !stop.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= cases.end {
                break;
            }
            if let (Some(failure), Ok(mut failed)) = (ask_case(settings, index, &mut report), failed.lock()) {
                failed(failure);
            }
        }
        if let Ok(mut total) = total.lock() {
            total.merge(&report);
        }
    };
    thread::scope(|scope| {
        for _ in 0..settings.threads.max(1) {
            scope.spawn(work);
        }
    });
    total.into_inner().unwrap_or_default()
}

fn ask_case(settings: &Settings, index: u64, report: &mut Report) -> Option<Failure> {
    let case = Case::of(settings, index);
    let Some(outcome) = case.examine() else {
        report.refused += 1;
        return None;
    };
    report.add(&case.labels(), &outcome);
    let faults: Vec<Fault> = outcome.faults().cloned().collect();
    if faults.is_empty() {
        return None;
    }
    let what: Vec<String> = faults.iter().map(|fault| format!("{}: {}", fault.kind.name(), fault.what)).collect();
    let name = format!("coverage_seed_{}_number_{index}", settings.seed);
    Some(Failure { index, source: case.source(&name, &what), faults })
}

/// What the kernels say of a pair, in both orders; `None` if the crate refuses a form.
#[must_use]
pub fn answers(question: &Question) -> Option<[Answers; 2]> {
    ask(question).ok()
}

/// What the kernels say of a ray; `None` if the crate refuses the form.
#[must_use]
pub fn touches(question: &RayQuestion) -> Option<RayTouches> {
    cast(question)
}

/// What the kernels say of a motion, judged; `None` if the crate refuses a form.
#[must_use]
pub fn first_touch(question: &MoveQuestion) -> Option<(Outcome, Option<ImpactTouch>)> {
    let moved = moves::ask(question)?;
    Some((moves::examine(question)?, moved.there))
}

/// Asks and judges one ray; `None` if the crate refuses the form.
#[must_use]
pub fn examine_ray(question: &RayQuestion) -> Option<Outcome> {
    match catch_unwind(AssertUnwindSafe(|| cast(question))) {
        Err(_) => Some(Outcome::panicked(Asked::Ray)),
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
            Some((Outcome::panicked(Asked::Distance), truth))
        }
        Ok(answers) => {
            let of_warm = answers[0].warm.iter().filter_map(|warm| warm.contact.as_ref());
            let of_contact = answers[0].contact.iter().chain(of_warm).map(|contact| contact.normal_b_to_a);
            let of_distance = answers[0].distance.iter().filter_map(|distance| distance.normal_b_to_a);
            let hints: Vec<_> = of_contact.chain(of_distance).map(|normal| -normal).collect();
            let truth = Truth::of(&question.a, &question.b, &hints);
            Some((judge(question, &answers, &truth), truth))
        }
    }
}
