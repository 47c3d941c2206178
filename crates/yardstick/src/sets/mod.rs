//! Readers of the query sets: which files a folder holds, and what each of their lines says. Nothing here asks.
//!
//! A set that cannot be read is an error that names the file and the line; nothing is skipped in silence.

pub mod aabb;
pub mod casts;
mod folder;
mod form;
mod lines;
pub mod meshes;
pub mod motion;
mod obj;
pub mod pairs;
pub mod rays;
pub mod stream;
pub mod toi;

pub use folder::{Folder, SetFile, SetKind};
pub use form::{Form, FormRecord, HullTable, Placed, PointCloud, Pose, TriangleMesh};
pub use lines::{read_bytes, read_lines, read_text};
pub use obj::{parse_obj, read_obj};

use std::path::PathBuf;

/// Why a file of a folder is not understood.
#[derive(Debug, thiserror::Error)]
pub enum SetError {
    /// The file system or the decompressor said no.
    #[error("{}: {source}", path.display())]
    Io {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A line says something that is not in the format.
    #[error("{}:{line}: {reason}", path.display())]
    Line {
        /// Which file.
        path: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// The file as a whole does not fit.
    #[error("{}: {reason}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

impl SetError {
    /// A line that does not fit.
    pub fn line(path: impl Into<PathBuf>, line: usize, reason: impl Into<String>) -> Self {
        Self::Line { path: path.into(), line, reason: reason.into() }
    }

    /// A file that does not fit.
    pub fn file(path: impl Into<PathBuf>, reason: impl Into<String>) -> Self {
        Self::File { path: path.into(), reason: reason.into() }
    }
}
