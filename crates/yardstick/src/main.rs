//! `yardstick check DIR`: asks every query set of a folder and says whether all answers are right.
//! `yardstick coverage`: asks very many random pairs and says whether every interval holds the truth.

use std::{
    fs::File,
    io::{self, IsTerminal, Write},
    path::PathBuf,
    process::ExitCode,
    sync::atomic::{AtomicBool, AtomicU64, Ordering},
    thread,
};

use clap::{Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use yardstick::{
    check::{Asker, CrateAsker, Known, Reporting, ServerAsker, check_folder},
    coverage::{self, Failure, Fault, Kind, Settings},
    ladder,
};

/// How right Calipers is.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Asks every query set of a folder in the exact tier and compares the answers with those of the reference.
    ///
    /// Exits with 0 if all are right, 1 on any shortfall, 2 if nothing was read or a file is not understood.
    Check(CheckArguments),
    /// Asks very many random and adversarial pairs of convex forms and compares the answers with the oracle's truth.
    ///
    /// Prints the first failures as tests to paste and a table by kinds. An interrupt ends it early, with the table so far.
    /// Exits with 0 if all are right (but for what `--wide` accepts), 1 on any failure.
    Coverage(CoverageArguments),
    /// Measures what each stand-in for real assets costs and how wide its intervals are, and prints a table.
    Ladder(LadderArguments),
}

#[derive(clap::Args)]
struct LadderArguments {
    /// The folder with the query sets.
    dir: PathBuf,
}

#[derive(clap::Args)]
struct CoverageArguments {
    /// How many pairs.
    #[arg(long, value_name = "COUNT", default_value_t = 100_000)]
    pairs: u64,
    /// How many rays, after the pairs: a tenth as many if not given.
    #[arg(long, value_name = "COUNT")]
    rays: Option<u64>,
    /// Names the run: the same seed makes the same pairs.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The number of the first pair and ray: with `--pairs 1 --rays 0`, the pair of a failure alone.
    #[arg(long, value_name = "INDEX", default_value_t = 0)]
    first: u64,
    /// Only pairs of these kinds, such as box-cylinder (they change what a number stands for).
    #[arg(long, value_name = "A-B", value_parser = kinds)]
    kind: Option<(Kind, Kind)>,
    /// Threads to use.
    #[arg(long, value_name = "COUNT", default_value_t = 1)]
    threads: usize,
    /// Accept that this share of the pairs has intervals that hold the truth but are wider than they should be.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0)]
    wide: f64,
    /// Show this many failures as tests.
    #[arg(long, value_name = "COUNT", default_value_t = 10)]
    examples: usize,
    /// Show only failures of this kind: bound, verdict, undecided, width, normal, form, points, order or panic.
    #[arg(long, value_name = "KIND")]
    fault: Option<String>,
    /// Write the table to this file as JSON.
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

#[derive(clap::Args)]
struct CheckArguments {
    /// The folder with the query sets.
    dir: PathBuf,
    /// Ask this running server, such as 127.0.0.1:7070, instead of the crate in this process.
    #[arg(long, value_name = "ADDR")]
    server: Option<String>,
    /// What is known not to be right yet (TOML): anything worse, and anything listed that is right by now, is exit 1.
    #[arg(long, value_name = "FILE")]
    known: Option<PathBuf>,
    /// Show this many faulty records of each category.
    #[arg(long, value_name = "COUNT", default_value_t = 3)]
    examples: usize,
}

/// Nothing was read, or something was not understood.
const EXIT_NOT_UNDERSTOOD: u8 = 2;

/// What a shell calls a program that an interrupt ended.
const EXIT_INTERRUPTED: i32 = 130;

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Check(arguments) => check(&arguments),
        Command::Ladder(arguments) => {
            let done = ladder::run(&arguments.dir, &mut io::stdout().lock());
            done.map(|()| 0).map_err(|error| error.to_string())
        }
        Command::Coverage(arguments) => cover(&arguments).map_err(|error| error.to_string()),
    };
    match done {
        Ok(code) => ExitCode::from(code),
        Err(reason) => {
            let _ = writeln!(io::stderr(), "yardstick: {reason}");
            ExitCode::from(EXIT_NOT_UNDERSTOOD)
        }
    }
}

fn check(arguments: &CheckArguments) -> Result<u8, String> {
    let known = match &arguments.known {
        Some(path) => Known::read(path).map_err(|error| error.to_string())?,
        None => Known::default(),
    };
    let mut asker: Box<dyn Asker> = match &arguments.server {
        Some(address) => Box::new(ServerAsker::connect(address)?),
        None => {
            // Panics of the crate are counted, record by record: their text would only drown the tables.
            std::panic::set_hook(Box::new(|_| {}));
            Box::new(CrateAsker::default())
        }
    };
    let bar = progress_bar();
    let mut progress = |done: usize, all: usize, name: &str| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
        bar.set_message(name.to_owned());
    };
    let mut tables = Vec::new();
    let mut reporting = Reporting { out: &mut tables, progress: &mut progress, examples_max: arguments.examples };
    let conclusion = check_folder(&arguments.dir, asker.as_mut(), &known, &mut reporting);
    let conclusion = conclusion.map_err(|error| error.to_string())?;
    bar.finish_and_clear();
    let mut out = io::stdout().lock();
    let print = |out: &mut dyn Write| -> io::Result<()> {
        out.write_all(&tables)?;
        for strange in &conclusion.strange {
            writeln!(out, "not understood: {strange}")?;
        }
        for mismatch in &conclusion.mismatches {
            writeln!(out, "shortfall: {}", mismatch.0)?;
        }
        let says = match conclusion.exit_code() {
            0 => "all as expected",
            1 => "there are shortfalls",
            _ => "nothing was read, or not all was understood",
        };
        writeln!(out, "{} records: {says}", conclusion.record_count)
    };
    print(&mut out).map_err(|error| error.to_string())?;
    Ok(conclusion.exit_code())
}

fn cover(arguments: &CoverageArguments) -> io::Result<u8> {
    // Panics of the kernels are failures like others; their text would only drown the table.
    std::panic::set_hook(Box::new(|_| {}));
    let settings = Settings {
        pairs: arguments.pairs,
        rays: arguments.rays.unwrap_or(arguments.pairs / 10),
        first: arguments.first,
        seed: arguments.seed,
        kinds: arguments.kind,
        threads: arguments.threads,
    };
    static STOP: AtomicBool = AtomicBool::new(false);
    stop_on_interrupt(&STOP)?;
    let bar = progress_bar();
    bar.set_length(settings.pairs + settings.rays);
    let failed_count = AtomicU64::new(0);
    let done = |count: u64| {
        if count.is_multiple_of(256) {
            bar.set_position(count);
            bar.set_message(format!("{} failed", failed_count.load(Ordering::Relaxed)));
        }
    };
    let mut shown = 0;
    let mut failed = |failure: Failure| {
        failed_count.fetch_add(1, Ordering::Relaxed);
        let is_wanted = |fault: &Fault| arguments.fault.as_ref().is_none_or(|wanted| wanted == fault.kind.name());
        if shown < arguments.examples && failure.faults.iter().any(is_wanted) {
            shown += 1;
            bar.suspend(|| {
                let _ = writeln!(io::stdout(), "{}", failure.source);
            });
        }
    };
    let report = coverage::run(&settings, &STOP, &done, &mut failed);
    bar.finish_and_clear();
    report.print(&mut io::stdout().lock())?;
    if let Some(path) = &arguments.json {
        report.write_json(&mut File::create(path)?)?;
    }
    let total = report.total();
    let is_right = total.failed == total.wide && total.wide as f64 <= arguments.wide * total.count as f64;
    Ok(u8::from(!is_right))
}

/// Sets `stop` at the first interrupt; a second one ends the program.
fn stop_on_interrupt(stop: &'static AtomicBool) -> io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build()?;
    thread::spawn(move || {
        while runtime.block_on(tokio::signal::ctrl_c()).is_ok() {
            if stop.swap(true, Ordering::Relaxed) {
                std::process::exit(EXIT_INTERRUPTED);
            }
        }
    });
    Ok(())
}

/// A bar on a terminal; nothing where nobody watches.
fn progress_bar() -> ProgressBar {
    if !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style =
        ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(0).with_style(style)
}
