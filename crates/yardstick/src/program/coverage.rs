//! `yardstick coverage`.

use std::{
    fs::File,
    io::{self, Write},
    path::PathBuf,
    sync::atomic::AtomicBool,
};

use yardstick::coverage::{self, Failure, Fault, Kind, Settings, State};

use super::{progress_bar, stop_on_interrupt};

#[derive(clap::Args)]
pub(crate) struct CoverageArguments {
    /// How many answers.
    #[arg(long, value_name = "COUNT", default_value_t = 100_000)]
    answers: u64,
    /// Names the run: the same seed asks the same questions.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The number of the first case: with `--cases 1`, the case of a failure alone.
    #[arg(long, value_name = "INDEX", default_value_t = 0)]
    first: u64,
    /// How many cases at most; each gives one to five answers.
    #[arg(long, value_name = "COUNT", default_value_t = u64::MAX)]
    cases: u64,
    /// Only these kinds of convex forms, such as box-cylinder (they change what a number stands for).
    #[arg(long, value_name = "A-B", value_parser = kinds)]
    kind: Option<(Kind, Kind)>,
    /// Threads to use.
    #[arg(long, value_name = "COUNT", default_value_t = 1)]
    threads: usize,
    /// Keep the run in this file, and go on from it if it is there: an interrupt loses some seconds at most.
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Accept that the budget of the exact tier ends this share of the answers on an interval that is wider than rounding
    /// makes it. They say so.
    #[arg(long, value_name = "SHARE", default_value_t = 0.001)]
    unfinished: f64,
    /// Show this many failures as tests.
    #[arg(long, value_name = "COUNT", default_value_t = 10)]
    examples: usize,
    /// Show only failures of this kind: bound, verdict, undecided, width, normal, form, points, order, work or panic.
    #[arg(long, value_name = "KIND")]
    fault: Option<String>,
    /// Write the tables to this file as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

fn kinds(text: &str) -> Result<(Kind, Kind), String> {
    let known = || Kind::ALL.map(Kind::name).join(", ");
    let (a, b) = text.split_once('-').ok_or("two kinds with a dash between them, such as box-hull")?;
    let named = |name: &str| Kind::named(name).ok_or_else(|| format!("`{name}` is none of {}", known()));
    match (named(a)?, named(b)?) {
        (Kind::HalfSpace, Kind::HalfSpace) => Err("two half spaces overlap without end".into()),
        kinds => Ok(kinds),
    }
}

/// Runs it, and says the exit code: 0 if all is right, 1 if not.
pub(crate) fn cover(arguments: &CoverageArguments) -> io::Result<u8> {
    // Panics of the kernels are failures like others; their text would only drown the table.
    std::panic::set_hook(Box::new(|_| {}));
    let settings = Settings {
        answers: arguments.answers,
        first: arguments.first,
        cases: arguments.cases,
        seed: arguments.seed,
        kinds: arguments.kind,
        threads: arguments.threads,
        resume: arguments.resume.clone(),
    };
    static STOP: AtomicBool = AtomicBool::new(false);
    stop_on_interrupt(&STOP)?;
    let bar = progress_bar();
    bar.set_length(settings.answers);
    let mut done = |state: &State| {
        bar.set_position(state.report.total.count);
        bar.set_message(format!("{} failed, {:.0} s", state.report.total.failed, state.seconds));
    };
    let mut shown = 0;
    let mut failed = |failure: Failure| {
        let is_wanted = |fault: &Fault| arguments.fault.as_ref().is_none_or(|wanted| wanted == fault.kind.name());
        if shown < arguments.examples && failure.faults.iter().any(is_wanted) {
            shown += 1;
            bar.suspend(|| {
                let _ = writeln!(io::stdout(), "{}", failure.source);
            });
        }
    };
    let state = coverage::run(&settings, &STOP, &mut done, &mut failed)?;
    bar.finish_and_clear();
    conclude(arguments, &state, &mut io::stdout().lock())
}

/// A run of fewer answers, or of chosen kinds, is not asked whether it has enough of all sorts.
const ANSWERS_OF_ALL_SORTS: u64 = 20_000;

fn conclude(arguments: &CoverageArguments, state: &State, out: &mut dyn Write) -> io::Result<u8> {
    let report = &state.report;
    report.print(out)?;
    if let Some(path) = &arguments.json {
        report.write_json(&mut File::create(path)?)?;
    }
    let is_whole = arguments.kind.is_none() && report.total.count >= ANSWERS_OF_ALL_SORTS;
    let shortages = if is_whole { report.shortages() } else { Vec::new() };
    for shortage in &shortages {
        writeln!(out, "too few: {shortage}")?;
    }
    let unfinished = report.total.share(report.total.unfinished);
    if unfinished > arguments.unfinished {
        writeln!(out, "unfinished: {unfinished:e} of the answers, at most {:e} are accepted", arguments.unfinished)?;
    }
    let is_right = report.total.failed == 0 && shortages.is_empty() && unfinished <= arguments.unfinished;
    let says = if is_right { "all right" } else { "not all right" };
    let (count, seconds) = (report.total.count, state.seconds);
    writeln!(out, "{count} answers of seed {} in {seconds:.0} s, next case {}: {says}", state.seed, state.next)?;
    Ok(u8::from(!is_right))
}
