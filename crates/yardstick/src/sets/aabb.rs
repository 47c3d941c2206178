//! `aabb/X`: raw boxes and how many pairs of them overlap.

use std::{collections::BTreeMap, path::Path};

use glam::DVec3;
use serde::Deserialize;

use super::{Folder, SetError, read_bytes, read_text};

/// Boxes and what is true of their pairs.
#[derive(Clone, Debug)]
pub struct BoxSet {
    /// Lower and upper corners.
    pub boxes: Vec<(DVec3, DVec3)>,
    /// How many pairs have a point in common.
    pub pair_count: u64,
    /// The order-free hash of those pairs: see [`pair_hash`].
    pub pair_hash: u64,
}

#[derive(Deserialize)]
struct Expected {
    boxes: usize,
    overlap_pairs: u64,
    pair_hash: String,
}

const BYTES_PER_BOX: usize = 24;

/// Reads a file of boxes and its entry in `aabb/expected.json`.
///
/// # Errors
/// A file is missing, its length does not fit, or it is not listed.
pub fn read(path: &Path, folder: &Folder, stem: &str) -> Result<BoxSet, SetError> {
    let list_path = folder.companion("aabb", "expected.json")?;
    let listed: BTreeMap<String, Expected> = serde_json::from_str(&read_text(&list_path)?)
        .map_err(|error| SetError::line(&list_path, error.line(), error.to_string()))?;
    let expected =
        listed.get(stem).ok_or_else(|| SetError::file(path, format!("{} does not list it", list_path.display())))?;
    let pair_hash = expected
        .pair_hash
        .parse()
        .map_err(|_| SetError::file(&list_path, format!("pair_hash of {stem} is no whole number of 64 bits")))?;
    let bytes = read_bytes(path)?;
    if bytes.len() != expected.boxes * BYTES_PER_BOX {
        return Err(SetError::file(path, format!("{} bytes are not {} boxes", bytes.len(), expected.boxes)));
    }
    Ok(BoxSet { boxes: parse(&bytes), pair_count: expected.overlap_pairs, pair_hash })
}

fn parse(bytes: &[u8]) -> Vec<(DVec3, DVec3)> {
    let (words, _) = bytes.as_chunks::<4>();
    let numbers: Vec<f64> = words.iter().map(|&word| f64::from(f32::from_le_bytes(word))).collect();
    let (boxes, _) = numbers.as_chunks::<6>();
    boxes.iter().map(|&[a, b, c, d, e, f]| (DVec3::new(a, b, c), DVec3::new(d, e, f))).collect()
}

/// The hash of a pair `i < j`; sums of it do not depend on the order of the pairs.
#[must_use]
pub fn pair_hash(i: u64, j: u64) -> u64 {
    let mut x = i.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(j.wrapping_mul(0xC2B2_AE3D_27D4_EB4F));
    x ^= x >> 29;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^ (x >> 32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_numbers_are_a_box() {
        let bytes: Vec<u8> =
            [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.5].iter().flat_map(|number| number.to_le_bytes()).collect();
        assert_eq!(parse(&bytes), vec![(DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.5))]);
    }
}
