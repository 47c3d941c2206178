//! Subcommands that need more than a few lines.

pub(crate) mod attack;
pub(crate) mod coverage;

use std::{
    io,
    io::IsTerminal,
    sync::atomic::{AtomicBool, Ordering},
    thread,
};

use indicatif::{ProgressBar, ProgressStyle};

/// What a shell calls a program that an interrupt ended.
const EXIT_INTERRUPTED: i32 = 130;

/// Sets `stop` at the first interrupt; a second one ends the program.
pub(crate) fn stop_on_interrupt(stop: &'static AtomicBool) -> io::Result<()> {
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
pub(crate) fn progress_bar() -> ProgressBar {
    if !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style =
        ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(0).with_style(style)
}
