//! `box_box`, `hull_hull`, `mixed`: two placed convex forms and their signed distance.

use std::path::Path;

use serde::Deserialize;

use super::{FormRecord, HullTable, Placed, SetError, read_lines};

/// Two placed forms and what is true of them. The reference's normal is not read: another one may be as right, and where
/// forms are concentric there is none.
#[derive(Clone, Debug)]
pub struct PairRecord {
    /// Index in the file.
    pub index: u64,
    /// Category.
    pub category: String,
    /// The yes or no is not to be judged.
    pub ambiguous: bool,
    /// The first form.
    pub a: Placed,
    /// The second form.
    pub b: Placed,
    /// Signed distance, metres; negative is depth.
    pub distance: f64,
    /// What errors are relative to, metres.
    pub scale: f64,
}

#[derive(Deserialize)]
struct Line {
    i: u64,
    cat: String,
    #[serde(default)]
    amb: u8,
    a: FormRecord,
    b: FormRecord,
    d: f64,
    s: f64,
}

/// Reads a set of pairs.
///
/// # Errors
/// The file or a line of it is not understood.
pub fn read(path: &Path, hulls: &HullTable) -> Result<Vec<PairRecord>, SetError> {
    let lines = read_lines::<Line>(path)?;
    lines
        .into_iter()
        .map(|(number, line)| {
            let resolve = |form: &FormRecord, side: &str| {
                form.resolve(hulls).map_err(|reason| SetError::line(path, number, format!("{side}: {reason}")))
            };
            Ok(PairRecord {
                a: resolve(&line.a, "a")?,
                b: resolve(&line.b, "b")?,
                index: line.i,
                category: line.cat,
                ambiguous: line.amb != 0,
                distance: line.d,
                scale: line.s,
            })
        })
        .collect()
}
