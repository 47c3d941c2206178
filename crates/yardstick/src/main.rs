//! `yardstick check DIR`: asks every query set of a folder and says whether all answers are right.
//! `yardstick coverage`: asks very many random questions and says whether every interval holds the truth.

mod program;

use std::{
    io::{self, Write},
    path::PathBuf,
    process::ExitCode,
};

use clap::{Parser, Subcommand};
use yardstick::{
    check::{Asker, CrateAsker, Known, Reporting, ServerAsker, check_folder},
    ladder, measure,
};

use program::{
    attack::{AttackArguments, attack},
    coverage::{CoverageArguments, cover},
    progress_bar,
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
    /// Asks very many random and adversarial questions of every kind and compares the answers with the oracle's truth.
    ///
    /// Prints the first failures as tests to paste, and tables by question, form, extreme and accuracy. An interrupt ends it
    /// early, with the tables so far. Exits with 1 if an interval misses the truth, an answer is not finite, takes more work
    /// than it may or is wider than it says, or if there are too few answers of some sort; else with 0.
    Coverage(CoverageArguments),
    /// Climbs over the raw numbers of questions towards the ends of the intervals that answer them, and prints the worst.
    ///
    /// Exits with 1 if an answer is wrong.
    Attack(AttackArguments),
    /// Measures what each stand-in for real assets costs and how wide its intervals are, and prints a table.
    Ladder(LadderArguments),
    /// Measures what accuracy costs on all scenes and writes it into a folder: accuracy.md, and plots in accuracy/.
    Accuracy(AccuracyArguments),
}

#[derive(clap::Args)]
struct AccuracyArguments {
    /// The folder, such as docs.
    folder: PathBuf,
    /// The folder with the query sets; else that of CALIPERS_DATA.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// How many questions of each kind.
    #[arg(long, value_name = "COUNT", default_value_t = 40)]
    count: usize,
}

#[derive(clap::Args)]
struct LadderArguments {
    /// The folder with the query sets.
    dir: PathBuf,
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

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Check(arguments) => check(&arguments),
        Command::Ladder(arguments) => {
            let done = ladder::run(&arguments.dir, &mut io::stdout().lock());
            done.map(|()| 0).map_err(|error| error.to_string())
        }
        Command::Attack(arguments) => {
            // Panics of the kernels are wrong answers.
            std::panic::set_hook(Box::new(|_| {}));
            attack(&arguments).map_err(|error| error.to_string())
        }
        Command::Accuracy(arguments) => account(&arguments).map_err(|error| error.to_string()),
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

fn account(arguments: &AccuracyArguments) -> Result<u8, measure::DocumentError> {
    let usual = || std::env::var_os("CALIPERS_DATA").map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    let data = arguments.data.clone().unwrap_or_else(usual);
    let bar = progress_bar();
    measure::document(&arguments.folder, &data, arguments.count, &mut |done, all, what| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
        bar.set_message(what.to_owned());
    })?;
    bar.finish_and_clear();
    Ok(0)
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
