//! Files as text, plain or gzipped, and JSON lines with the place of each error.

use std::{fs::File, io::Read, path::Path};

use flate2::read::MultiGzDecoder;
use serde::de::DeserializeOwned;

use super::SetError;

/// The bytes of a file; one whose name ends in `.gz` is unpacked.
///
/// # Errors
/// The file cannot be read or unpacked.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, SetError> {
    let io = |source| SetError::Io { path: path.to_owned(), source };
    let mut file = File::open(path).map_err(io)?;
    let mut bytes = Vec::new();
    if path.extension().is_some_and(|extension| extension == "gz") {
        MultiGzDecoder::new(file).read_to_end(&mut bytes).map_err(io)?;
    } else {
        file.read_to_end(&mut bytes).map_err(io)?;
    }
    Ok(bytes)
}

/// The text of a file; one whose name ends in `.gz` is unpacked.
///
/// # Errors
/// The file cannot be read or unpacked, or is not UTF-8.
pub fn read_text(path: &Path) -> Result<String, SetError> {
    String::from_utf8(read_bytes(path)?).map_err(|error| SetError::file(path, format!("not UTF-8 text: {error}")))
}

/// The JSON lines of a file, each with its number from 1; empty lines are passed over.
///
/// # Errors
/// The file cannot be read, or a line is not JSON of this kind: then the error names file and line.
pub fn read_lines<T: DeserializeOwned>(path: &Path) -> Result<Vec<(usize, T)>, SetError> {
    let text = read_text(path)?;
    let mut records = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        let record = serde_json::from_str(line).map_err(|error| SetError::line(path, index + 1, error.to_string()))?;
        records.push((index + 1, record));
    }
    Ok(records)
}
