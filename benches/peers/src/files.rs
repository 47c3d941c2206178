//! Meshes in the folder of data.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
};

use collision::DVec3;

/// Where the meshes are: `CALIPERS_DATA` names the folder of data, `../shared/data` from the workspace if it is not set.
pub(crate) fn folder() -> PathBuf {
    let folder = env::var_os("CALIPERS_DATA").map_or_else(|| "../shared/data".into(), PathBuf::from);
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder).join("mesh")
}

/// Vertices, rounded to f32 as the format of the data says, and triangles.
///
/// # Errors
/// The file cannot be read, or its faces are not triangles.
pub(crate) fn obj(path: &Path) -> io::Result<(Vec<DVec3>, Vec<[u32; 3]>)> {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let text = fs::read_to_string(path)
        .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", path.display())))?;
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f32> = words.filter_map(|word| word.parse().ok()).collect();
                let &[x, y, z, ..] = numbers.as_slice() else { return Err(io::Error::other("a vertex has 3 numbers")) };
                vertices.push(DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
            }
            Some("f") => {
                let corner = |word: &str| word.split('/').next().and_then(|index| index.parse::<u32>().ok());
                let corners: Vec<u32> = words.filter_map(corner).collect();
                let &[a, b, c] = corners.as_slice() else { return Err(io::Error::other("a triangle has 3 corners")) };
                triangles.push([a - 1, b - 1, c - 1]);
            }
            _ => {}
        }
    }
    Ok((vertices, triangles))
}
