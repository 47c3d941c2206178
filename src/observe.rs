//! Log lines: for people on a terminal, one JSON object each otherwise.

use std::io::{self, IsTerminal};

use tracing_subscriber::{
    Layer,
    filter::{ParseError, Targets},
    fmt,
    layer::SubscriberExt,
    util::SubscriberInitExt,
};

use crate::config::{LogFormat, Settings};

/// Why logging did not start.
#[derive(Debug, thiserror::Error)]
pub enum ObserveError {
    /// The filter is not understood.
    #[error("log_filter is {found:?}, which is no filter ({source}); a right one is info,calipers=debug")]
    Filter {
        /// What was found.
        found: String,
        /// Why.
        source: ParseError,
    },
    /// Something else in this process logs already.
    #[error("logging was started twice")]
    Twice,
}

/// Starts writing log lines to standard error, as the settings say. Once in a process.
///
/// # Errors
/// A filter that is not understood; logging was started before.
pub fn start(settings: &Settings) -> Result<(), ObserveError> {
    let filter: Targets = settings
        .log_filter
        .parse()
        .map_err(|source| ObserveError::Filter { found: settings.log_filter.clone(), source })?;
    let lines = fmt::layer().with_writer(io::stderr);
    let for_people = match settings.log_format {
        LogFormat::Auto => io::stderr().is_terminal(),
        LogFormat::Human => true,
        LogFormat::Json => false,
    };
    let lines = if for_people {
        lines.with_target(false).with_filter(filter).boxed()
    } else {
        lines.json().flatten_event(true).with_filter(filter).boxed()
    };
    tracing_subscriber::registry().with(lines).try_init().map_err(|_| ObserveError::Twice)
}
