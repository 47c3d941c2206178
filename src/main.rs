//! The `calipers` program: the server, and one-liners that talk to one.

mod program;

use std::process::ExitCode;

fn main() -> ExitCode {
    program::run()
}
