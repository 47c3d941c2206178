//! `stream/X`: a recorded stream of moves, and the close pairs after each frame.

use std::{collections::BTreeMap, path::Path};

use glam::{DQuat, DVec3};
use serde::Deserialize;

use super::{Folder, Pose, SetError, read_lines, read_text};

/// What an actor is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActorKind {
    /// A vehicle: the box that the format names.
    Car,
    /// A ball: the sphere that the format names.
    Ball,
}

/// One thing that happens in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// The actor is at this pose from now on.
    Move {
        /// Which.
        actor: u64,
        /// What it is.
        kind: ActorKind,
        /// Where.
        pose: Pose,
    },
    /// The actor does not count until it moves again.
    Remove {
        /// Which.
        actor: u64,
    },
}

/// All rows of a frame, and what is true after them.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The number in the trace.
    pub number: u64,
    /// What happens, in order.
    pub changes: Vec<Change>,
    /// All pairs of actors that are then less than 100 apart, and their signed distance.
    pub close_pairs: Vec<(u64, u64, f64)>,
}

#[derive(Deserialize)]
struct Line {
    frame: u64,
    pairs: Vec<(u64, u64, f64)>,
}

/// Reads a stream and what is expected of it.
///
/// # Errors
/// The trace is missing, a line is not understood, or an expected frame is not in the trace.
pub fn read(path: &Path, folder: &Folder, stem: &str) -> Result<Vec<Frame>, SetError> {
    let trace_path = folder.companion("stream", &format!("{stem}.csv"))?;
    let mut frames = parse_trace(&trace_path, &read_text(&trace_path)?)?;
    for (number, line) in read_lines::<Line>(path)? {
        let frame = frames
            .get_mut(&line.frame)
            .ok_or_else(|| SetError::line(path, number, format!("frame {} is not in the trace", line.frame)))?;
        frame.close_pairs = line.pairs;
    }
    Ok(frames.into_values().collect())
}

/// The columns that matter: frame, op, actor, kind, position, quaternion.
const COLUMNS: [&str; 12] = ["frame", "time", "op", "actor", "kind", "px", "py", "pz", "qx", "qy", "qz", "qw"];

fn parse_trace(path: &Path, text: &str) -> Result<BTreeMap<u64, Frame>, SetError> {
    let header = text.lines().next().unwrap_or_default();
    if !header.split(',').map(str::trim).take(COLUMNS.len()).eq(COLUMNS) {
        return Err(SetError::line(path, 1, format!("the columns must begin with {}", COLUMNS.join(","))));
    }
    let mut frames = BTreeMap::new();
    let mut newest = 0;
    for (index, line) in text.lines().enumerate().skip(1) {
        let wrong = |reason: String| SetError::line(path, index + 1, reason);
        let words: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |column: usize| -> Result<u64, SetError> {
            let word = words.get(column).copied().unwrap_or_default();
            word.parse().map_err(|_| wrong(format!("{} is `{word}`: it must be a whole number", COLUMNS[column])))
        };
        let frame = number(0)?;
        if frame < newest {
            return Err(wrong(format!("frame {frame} comes after frame {newest}")));
        }
        newest = frame;
        let entry =
            frames.entry(frame).or_insert_with(|| Frame { number: frame, changes: vec![], close_pairs: vec![] });
        let actor = number(3)?;
        match words[2] {
            // What appears has no rotation yet and counts from its first move on; an id that is used again is new.
            "N" | "D" => entry.changes.push(Change::Remove { actor }),
            "M" => entry.changes.extend(moved(actor, &words).map_err(wrong)?),
            op => return Err(wrong(format!("op is `{op}`: it must be N, M or D"))),
        }
    }
    Ok(frames)
}

/// The move in a row; `None` if the format passes it over: other kinds, no rotation, a rotation of zeros.
fn moved(actor: u64, words: &[&str]) -> Result<Option<Change>, String> {
    let kind = match words[4] {
        "car" => ActorKind::Car,
        "ball" => ActorKind::Ball,
        _ => return Ok(None),
    };
    if words.len() < COLUMNS.len() || words[8..12].iter().any(|word| word.is_empty()) {
        return Ok(None);
    }
    let coordinate = |column: usize| match words[column].parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(f64::from(to_f32(number))),
        _ => Err(format!("{} is `{}`: it must be a finite number", COLUMNS[column], words[column])),
    };
    let position = DVec3::new(coordinate(5)?, coordinate(6)?, coordinate(7)?);
    let rotation = DQuat::from_xyzw(coordinate(8)?, coordinate(9)?, coordinate(10)?, coordinate(11)?);
    if rotation.to_array() == [0.0; 4] {
        return Ok(None);
    }
    Ok(Some(Change::Move { actor, kind, pose: Pose { position, rotation } }))
}

#[allow(clippy::cast_possible_truncation, reason = "the format rounds these numbers to f32")]
fn to_f32(number: f64) -> f32 {
    number as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "frame,time,op,actor,kind,px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz,sleep\n";

    #[test]
    fn rows_become_changes() {
        let text = format!(
            "{HEADER}0,0,N,5,ball,0,0,93,,,,,,,,,,,\n0,0,M,5,ball,0.1,0,92.75,0,0,0,1,0,0,0,0,0,0,1\n\
             1,0,M,6,boost,0,0,0,0,0,0,1,,,,,,,\n1,0,M,7,car,0,0,0,0,0,0,0,,,,,,,\n1,0,M,7,car,0,0,0,,,,,,,,,,,\n2,0,D,5,,,,,,,,,,,,,,,\n"
        );
        let frames = parse_trace(Path::new("t.csv"), &text).expect("a trace");
        assert_eq!(frames.keys().copied().collect::<Vec<_>>(), vec![0, 1, 2]);
        let [Change::Remove { actor: 5 }, Change::Move { actor: 5, kind: ActorKind::Ball, pose }] =
            frames[&0].changes[..]
        else {
            panic!("{:?}", frames[&0].changes);
        };
        assert_eq!(pose.position.x, f64::from(0.1_f32));
        assert!(frames[&1].changes.is_empty(), "other kinds and rows without a rotation are passed over");
        assert_eq!(frames[&2].changes, vec![Change::Remove { actor: 5 }]);
    }

    #[test]
    fn errors_name_their_line() {
        for (row, part) in [
            ("x,0,M,5,ball,0,0,0,0,0,0,1", "frame is `x`"),
            ("0,0,Q,5,ball", "op is `Q`"),
            ("0,0,M,5,ball,0,?,0,0,0,0,1", "py is `?`"),
        ] {
            let error = parse_trace(Path::new("t.csv"), &format!("{HEADER}{row}\n")).expect_err("an error").to_string();
            assert!(error.starts_with("t.csv:2: ") && error.contains(part), "{error}");
        }
        assert!(parse_trace(Path::new("t.csv"), "a,b\n").is_err());
    }
}
