//! Reads triangles from mesh files: Wavefront OBJ, STL, PLY and glTF, each by a library and a file of its own.
//!
//! # Method
//! The ending of the name says the format. What the file gives is checked, brought into metres with y up, and rounded to
//! single precision. What is passed over is told in notes; what the triangles are like (open edges, slivers) is told by the
//! server.

mod gltf;
mod obj;
mod ply;
mod stl;

use std::fmt;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};

use clap::ValueEnum;

/// Triangles of a file, in the order in which the file has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Triangles {
    /// x, y, z of each vertex.
    pub(crate) vertices: Vec<f32>,
    /// Three vertex numbers for each triangle.
    pub(crate) indices: Vec<u32>,
    /// What the file has besides, and what was done about it.
    pub(crate) notes: Vec<String>,
}

/// Why a file gives no triangles.
#[derive(Debug, thiserror::Error)]
pub(crate) enum MeshFileError {
    #[error("{} cannot be read: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("{}: the ending of its name says no format that is known: .obj, .stl, .ply, .gltf or .glb", path.display())]
    NoFormat { path: PathBuf },
    #[error("{}, line {line}: {problem}", path.display())]
    Line { path: PathBuf, line: usize, problem: String },
    #[error("{} has {vertex_count} vertices and no faces, so there are no triangles to load", path.display())]
    NoFaces { path: PathBuf, vertex_count: usize },
    #[error("{} is no {format} file that can be understood: {problem}", path.display())]
    Broken { path: PathBuf, format: Format, problem: String },
}

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Obj,
    Stl,
    Ply,
    Gltf,
}

impl Format {
    fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            "ply" => Some(Self::Ply),
            "gltf" | "glb" => Some(Self::Gltf),
            _ => None,
        }
    }
}

/// Whether the ending of a name says a format of mesh files.
#[cfg(feature = "measure")]
pub(crate) fn is_known(path: &Path) -> bool {
    Format::of(path).is_some()
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "Wavefront OBJ",
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::Gltf => "glTF 2.0",
        })
    }
}

/// What one of the file's numbers means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Unit {
    /// Millimetres
    Mm,
    /// Centimetres
    Cm,
    /// Metres
    #[default]
    M,
    /// Inches
    In,
    /// Feet
    Ft,
}

impl Unit {
    fn metres(self) -> f64 {
        match self {
            Self::Mm => 0.001,
            Self::Cm => 0.01,
            Self::M => 1.0,
            Self::In => 0.0254,
            Self::Ft => 0.3048,
        }
    }
}

/// The axis that points up in a file. In the world it is y.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Up {
    /// As in the world
    #[default]
    Y,
    /// As in most CAD files: x stays, z becomes y, y becomes -z
    Z,
}

/// Reads a file. `watch` wraps the reader, so that the caller can show how far it is.
///
/// # Errors
/// A file that cannot be read, is broken, or has no faces.
pub(crate) fn read<R: Read + Seek>(
    path: &Path,
    unit: Unit,
    up: Up,
    watch: impl FnOnce(File) -> R,
) -> Result<Triangles, MeshFileError> {
    let format = Format::of(path).ok_or_else(|| MeshFileError::NoFormat { path: path.to_owned() })?;
    let file = File::open(path).map_err(|source| MeshFileError::Read { path: path.to_owned(), source })?;
    let file = watch(file);
    let mut triangles = match format {
        Format::Obj => obj::read(path, file)?,
        Format::Stl => stl::read(path, file)?,
        Format::Ply => ply::read(path, file)?,
        Format::Gltf => gltf::read(path, file)?,
    };
    if triangles.indices.is_empty() {
        return Err(MeshFileError::NoFaces { path: path.to_owned(), vertex_count: triangles.vertices.len() / 3 });
    }
    place(&mut triangles.vertices, unit, up);
    match triangles.vertices.iter().position(|number| !number.is_finite()) {
        None => Ok(triangles),
        Some(number) => {
            let (vertex, axis) = (number / 3, ["x", "y", "z"][number % 3]);
            let problem = format!("{axis} of vertex {vertex} (counted from 0) is {}", triangles.vertices[number]);
            Err(MeshFileError::Broken { path: path.to_owned(), format, problem })
        }
    }
}

/// Brings vertices into metres with y up.
fn place(vertices: &mut [f32], unit: Unit, up: Up) {
    if (unit, up) == (Unit::M, Up::Y) {
        return;
    }
    let in_metres = |number: f32| (f64::from(number) * unit.metres()) as f32;
    for vertex in vertices.as_chunks_mut().0 {
        let [x, y, z] = vertex.map(in_metres);
        *vertex = match up {
            Up::Y => [x, y, z],
            Up::Z => [x, z, -y],
        };
    }
}

/// Cuts a polygon into triangles around its first corner.
fn add_polygon(indices: &mut Vec<u32>, corners: &[u32]) {
    let Some((&first, rest)) = corners.split_first() else { return };
    for pair in rest.windows(2) {
        indices.extend([first, pair[0], pair[1]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a file with these contents.
    pub(super) fn read_bytes(name: &str, contents: &[u8]) -> Result<Triangles, MeshFileError> {
        read_with(name, contents, Unit::M, Up::Y)
    }

    fn read_with(name: &str, contents: &[u8], unit: Unit, up: Up) -> Result<Triangles, MeshFileError> {
        let path = std::env::temp_dir().join(format!("calipers-{}-{name}", std::process::id()));
        std::fs::write(&path, contents).expect("the folder for temporary files is writable");
        let triangles = read(&path, unit, up, |file| file);
        std::fs::remove_file(&path).expect("the file was just written");
        triangles
    }

    /// The corners of all triangles, one after the other.
    pub(super) fn corners(triangles: &Triangles) -> Vec<[f32; 3]> {
        let corner = |&index: &u32| triangles.vertices.as_chunks().0[index as usize];
        triangles.indices.iter().map(corner).collect()
    }

    #[test]
    fn units_become_metres_and_up_becomes_y_without_mirroring() {
        let text = b"v 100 0 0\nv 0 200 0\nv 0 0 300\nf 1 2 3\n";
        let triangles = read_with("units.obj", text, Unit::Cm, Up::Z).expect("it is whole");
        assert_eq!(corners(&triangles), [[1.0, 0.0, 0.0], [0.0, 0.0, -2.0], [0.0, 3.0, 0.0]]);
        let feet = read_with("feet.obj", text, Unit::Ft, Up::Y).expect("it is whole");
        assert_eq!(corners(&feet)[0], [30.48, 0.0, 0.0]);
    }

    #[test]
    fn a_number_that_a_unit_drives_out_of_range_is_told() {
        let sentence = read_bytes("nan.stl", &stl_bytes(f32::NAN)).unwrap_err().to_string();
        assert!(sentence.contains("y of vertex 1 (counted from 0) is NaN"), "{sentence}");
    }

    fn stl_bytes(number: f32) -> Vec<u8> {
        let mut bytes = vec![0; 80];
        bytes.extend(1_u32.to_le_bytes());
        for coordinate in [0., 0., 1., 0., 0., 0., 1., number, 0., 0., 1., 0.] {
            bytes.extend(f32::to_le_bytes(coordinate));
        }
        bytes.extend([0, 0]);
        bytes
    }

    #[test]
    fn an_unknown_ending_is_told_with_those_that_are_known() {
        for name in ["mesh.fbx", "mesh"] {
            let sentence = read_bytes(name, b"").unwrap_err().to_string();
            assert!(sentence.contains(".obj, .stl, .ply, .gltf or .glb"), "{sentence}");
        }
        let missing = read(Path::new("/nowhere.glb"), Unit::M, Up::Y, |file| file).unwrap_err().to_string();
        assert!(missing.contains("cannot be read"), "{missing}");
    }
}
