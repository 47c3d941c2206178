//! What a long run keeps in a file, so that it can be resumed.

use std::{
    fs, io,
    path::Path,
    time::{Duration, Instant},
};

use serde::{Deserialize, Serialize};

use super::report::Report;

/// How far a run is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Names the run.
    pub seed: u64,
    /// The number of the first case that is still to be asked.
    pub next: u64,
    /// How long it took so far, all parts of it together, seconds.
    pub seconds: f64,
    /// What came of it so far.
    pub report: Report,
}

impl State {
    /// A run of which nothing is asked yet; `first` is the number of its first case.
    #[must_use]
    pub fn beginning(seed: u64, first: u64) -> Self {
        Self { seed, next: first, ..Self::default() }
    }

    /// What was saved, or this if there is no such file.
    ///
    /// # Errors
    /// The file cannot be read, is none of ours, or is that of another seed.
    pub fn or_resumed(self, path: &Path) -> io::Result<Self> {
        if !path.exists() {
            return Ok(self);
        }
        let state: Self = serde_json::from_slice(&fs::read(path)?).map_err(io::Error::from)?;
        if state.seed != self.seed {
            let reason = format!("{} is of seed {}, not {}", path.display(), state.seed, self.seed);
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
        Ok(state)
    }

    /// Writes it beside and then puts it in place, so that an interrupt leaves the one or the other.
    ///
    /// # Errors
    /// The file system's.
    pub fn save(&self, path: &Path) -> io::Result<()> {
        let beside = path.with_extension("new");
        fs::write(&beside, serde_json::to_vec(self).map_err(io::Error::from)?)?;
        fs::rename(beside, path)
    }
}

/// Saves now and then.
pub(super) struct Keeper<'a> {
    path: Option<&'a Path>,
    saved: Instant,
}

const SAVE_EVERY: Duration = Duration::from_secs(20);

impl<'a> Keeper<'a> {
    pub(super) fn new(path: Option<&'a Path>) -> Self {
        Self { path, saved: Instant::now() }
    }

    /// Saves if it was not done lately.
    pub(super) fn keep(&mut self, state: &State) -> io::Result<()> {
        if self.saved.elapsed() < SAVE_EVERY {
            return Ok(());
        }
        self.saved = Instant::now();
        self.save(state)
    }

    pub(super) fn save(&self, state: &State) -> io::Result<()> {
        self.path.map_or(Ok(()), |path| state.save(path))
    }
}
