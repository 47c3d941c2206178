//! Reads the reference data, if they are there: meshes and records with answers from an independent program.
#![allow(dead_code, reason = "each test file uses its part of it")]

use std::path::{Path, PathBuf};

use collision::{DQuat, DVec3, math::Pose, shape::Geometry};
use serde_json::Value;

/// The folder of data; `None`, said aloud, where there is none.
pub(crate) fn folder() -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = std::env::var_os("CALIPERS_DATA").map_or_else(|| "../shared/data".into(), PathBuf::from);
    let folder = workspace.join(folder);
    if folder.is_dir() {
        return Some(folder);
    }
    let must_be_there = std::env::var("CI").is_ok_and(|ci| ci == "true") && workspace.join("../shared").exists();
    assert!(!must_be_there, "no reference data in {}", folder.display());
    eprintln!("no reference data in {}: nothing was compared", folder.display());
    None
}

/// The records of a file.
pub(crate) fn records(folder: &Path, name: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(folder.join(name)).expect("a file of records");
    text.lines().map(|line| serde_json::from_str(line).expect("a record")).collect()
}

/// A mesh from an OBJ file; coordinates are rounded to f32, as the format of the data says.
pub(crate) fn mesh(folder: &Path, name: &str) -> Geometry {
    let text = std::fs::read_to_string(folder.join(name)).expect("an OBJ file");
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f64> =
                    words.take(3).map(|word| f64::from(word.parse::<f32>().expect("a coordinate"))).collect();
                vertices.push(DVec3::new(numbers[0], numbers[1], numbers[2]));
            }
            Some("f") => {
                let corner = |word: &str| word.split('/').next().and_then(|index| index.parse::<u32>().ok());
                let corners: Vec<u32> = words.map(|word| corner(word).expect("an index") - 1).collect();
                triangles.push([corners[0], corners[1], corners[2]]);
            }
            _ => {}
        }
    }
    Geometry::mesh(&vertices, &triangles).expect("a mesh")
}

/// A vector field; 0 where there is none.
pub(crate) fn vector(record: &Value, field: &str) -> DVec3 {
    let part = |axis: usize| record[field][axis].as_f64().unwrap_or(0.0);
    DVec3::new(part(0), part(1), part(2))
}

/// A number field.
pub(crate) fn number(record: &Value, field: &str) -> f64 {
    record[field].as_f64().expect("a number")
}

/// The pose in fields p and q.
pub(crate) fn pose(record: &Value) -> Pose {
    let part = |index: usize| record["q"][index].as_f64();
    let rotation = match [part(0), part(1), part(2), part(3)] {
        [Some(x), Some(y), Some(z), Some(w)] => DQuat::from_xyzw(x, y, z, w),
        _ => DQuat::IDENTITY,
    };
    Pose::new(vector(record, "p"), rotation)
}

/// Whether the yes or no of a record is not to be judged.
pub(crate) fn is_ambiguous(record: &Value) -> bool {
    record.get("amb").is_some()
}
