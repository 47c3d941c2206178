//! What the program understands: its commands, its exit codes, and how it says that something went wrong.

mod account;
mod ask;
#[cfg(feature = "measure")]
mod bench;
mod carry;
mod demo;
mod explain;
mod input;
mod json;
mod load;
mod mesh_file;
mod play;
mod print;
mod replay_file;
mod serve;
#[cfg(feature = "measure")]
mod stage;
mod target;
mod trace;
#[cfg(feature = "measure")]
mod tune;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// A networked collision query service whose answers state how wrong they can be.
#[derive(Debug, Parser)]
#[command(
    version,
    propagate_version = true,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 done (a question that was answered, hit or miss), 1 failed, 2 the command line was not \
                  understood.\n\nBegin with `calipers serve --demo` in one terminal and `calipers describe` in another."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
enum Command {
    /// Runs the server until it is interrupted
    Serve(serve::Serve),
    /// Puts a triangle mesh from a file (OBJ, STL, PLY, glTF) into a world
    Load(load::Load),
    /// Drives a world from a recorded trace of moves
    Play(play::Play),
    /// Asks what a ray hits
    Raycast(ask::Raycast),
    /// Asks what touches a form
    Overlap(ask::Overlap),
    /// Says what a world holds, what was built for it, and what that costs
    Describe(ask::Describe),
    /// Asks a question again that was kept in a file, and tells what was done
    Explain(explain::Explain),
    /// Keeps a world in a file
    Export(carry::Export),
    /// Fills an empty world from a file
    Import(carry::Import),
    /// Measures what accuracy costs on a scene, with true errors
    #[cfg(feature = "measure")]
    Bench(bench::Bench),
    /// Recommends the cheapest accuracy that is good enough for a scene
    #[cfg(feature = "measure")]
    Tune(tune::Tune),
}

/// Why a command failed, as one sentence for people.
#[derive(Debug)]
pub(crate) struct Failure(String);

impl Failure {
    pub(crate) fn new(sentence: impl Into<String>) -> Self {
        Self(sentence.into())
    }
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self(error.to_string())
    }
}

/// Runs the program to its end.
pub(crate) fn run() -> ExitCode {
    let cli = Cli::parse();
    let runtime = match tokio::runtime::Builder::new_multi_thread().enable_all().build() {
        Ok(runtime) => runtime,
        Err(error) => return fail(&Failure::new(format!("cannot start threads: {error}"))),
    };
    let mut out = io::stdout();
    let done = runtime.block_on(async {
        match cli.command {
            Command::Serve(command) => command.run(&mut out).await,
            Command::Load(command) => command.run(&mut out).await,
            Command::Play(command) => command.run(&mut out).await,
            Command::Raycast(command) => command.run(&mut out).await,
            Command::Overlap(command) => command.run(&mut out).await,
            Command::Describe(command) => command.run(&mut out).await,
            Command::Explain(command) => command.run(&mut out).await,
            Command::Export(command) => command.run(&mut out).await,
            Command::Import(command) => command.run(&mut out).await,
            #[cfg(feature = "measure")]
            Command::Bench(command) => command.run(&mut out),
            #[cfg(feature = "measure")]
            Command::Tune(command) => command.run(&mut out),
        }
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => fail(&failure),
    }
}

fn fail(failure: &Failure) -> ExitCode {
    // Standard error may be closed as well; the exit code still tells.
    let _ = writeln!(io::stderr(), "calipers: {}", failure.0);
    ExitCode::FAILURE
}
