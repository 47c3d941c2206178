//! `toi`: two moving convex forms and when they first touch.

use std::path::Path;

use glam::DVec3;
use serde::Deserialize;

use super::{FormRecord, HullTable, Placed, SetError, read_lines};

/// How a form moves over the time 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Metres, world frame.
    pub displacement: DVec3,
    /// Rotation vector about the form's origin, radians, world axes; the speed of turning is constant.
    pub rotation_vector: DVec3,
}

impl Motion {
    /// Whether it turns.
    #[must_use]
    pub fn turns(&self) -> bool {
        self.rotation_vector != DVec3::ZERO
    }
}

/// Two moving forms and what is true of them.
#[derive(Clone, Debug)]
pub struct ToiRecord {
    /// Index in the file.
    pub index: u64,
    /// Category.
    pub category: String,
    /// The yes or no is not to be judged.
    pub ambiguous: bool,
    /// The first form at the start.
    pub a: Placed,
    /// How it moves.
    pub motion_a: Motion,
    /// The second form at the start.
    pub b: Placed,
    /// How it moves.
    pub motion_b: Motion,
    /// The time of the first touch; `None` if there is none.
    pub time: Option<f64>,
    /// They overlap at the start.
    pub start: bool,
    /// What errors are relative to, metres.
    pub scale: f64,
    /// Relative displacement, metres.
    pub speed: f64,
    /// Speed of approach at the touch, metres per motion, where it is known.
    pub rate: Option<f64>,
}

#[derive(Deserialize)]
struct Line {
    i: u64,
    cat: String,
    #[serde(default)]
    amb: u8,
    a: FormRecord,
    b: FormRecord,
    hit: bool,
    t: Option<f64>,
    start: bool,
    s: f64,
    speed: f64,
    rate: Option<f64>,
}

/// Reads a set of motions.
///
/// # Errors
/// The file or a line of it is not understood.
pub fn read(path: &Path, hulls: &HullTable) -> Result<Vec<ToiRecord>, SetError> {
    let lines = read_lines::<Line>(path)?;
    lines
        .into_iter()
        .map(|(number, line)| {
            let wrong = |reason: String| SetError::line(path, number, reason);
            let resolve = |form: &FormRecord, side: &str| {
                form.resolve(hulls).map_err(|reason| wrong(format!("{side}: {reason}")))
            };
            if line.hit != line.t.is_some() {
                return Err(wrong("t must be there if hit is true, and only then".to_owned()));
            }
            Ok(ToiRecord {
                a: resolve(&line.a, "a")?,
                motion_a: motion(&line.a),
                b: resolve(&line.b, "b")?,
                motion_b: motion(&line.b),
                index: line.i,
                category: line.cat,
                ambiguous: line.amb != 0,
                time: line.t,
                start: line.start,
                scale: line.s,
                speed: line.speed,
                rate: line.rate,
            })
        })
        .collect()
}

fn motion(form: &FormRecord) -> Motion {
    Motion { displacement: DVec3::from_array(form.v), rotation_vector: DVec3::from_array(form.w) }
}
