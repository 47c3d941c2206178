//! Reads triangles from a Wavefront OBJ file, and says where a broken one is broken.
//!
//! # Method
//! tobj parses and triangulates; its errors name no line. When it refuses a file, or what it read is not usable, the
//! text is gone through once more to find the first wrong line.
//!
//! # Limits
//! Materials, normals and texture coordinates are passed over, and so are points and lines.

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use tobj::LoadOptions;

use super::{Format, MeshFileError, Triangles};

/// What is wrong with a line.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Problem {
    NotText,
    Coordinate { found: String },
    FewCoordinates { count: usize },
    FewCorners { count: usize },
    Corner { found: String },
    NoSuchVertex { found: String, vertex_count: usize },
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotText => write!(f, "this is not text, so the file is no Wavefront OBJ"),
            Self::Coordinate { found } => write!(f, "{found:?} is not a finite number of single precision"),
            Self::FewCoordinates { count } => write!(f, "a vertex has three coordinates, this one has {count}"),
            Self::FewCorners { count } => write!(f, "a face has at least three corners, this one has {count}"),
            Self::Corner { found } => write!(f, "{found:?} is no corner; right ones are 7, 7/1, 7//3, 7/1/3 and -1"),
            Self::NoSuchVertex { found, vertex_count } => {
                write!(f, "corner {found:?} names a vertex that does not exist: {vertex_count} stand before this line")
            }
        }
    }
}

/// The triangles of a file.
///
/// # Errors
/// A broken line.
pub(super) fn read(path: &Path, file: impl Read) -> Result<Triangles, MeshFileError> {
    let options = LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..LoadOptions::default() };
    // Materials do not matter here, so that a missing material file must not be an error.
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = match tobj::load_obj_buf(&mut BufReader::new(file), &options, no_materials) {
        Ok(read) => read,
        Err(source) => {
            let problem = source.to_string();
            let other = MeshFileError::Broken { path: path.to_owned(), format: Format::Obj, problem };
            return Err(first_wrong_line(path)?.unwrap_or(other));
        }
    };
    let mut triangles = Triangles::default();
    for model in models {
        let first_vertex = (triangles.vertices.len() / 3) as u32;
        triangles.vertices.extend_from_slice(&model.mesh.positions);
        triangles.indices.extend(model.mesh.indices.iter().map(|index| first_vertex + index));
    }
    let is_usable = !triangles.indices.is_empty() && triangles.vertices.iter().all(|number| number.is_finite());
    if is_usable {
        return Ok(triangles);
    }
    let no_faces = MeshFileError::NoFaces { path: path.to_owned(), vertex_count: count_vertices(path)? };
    Err(first_wrong_line(path)?.unwrap_or(no_faces))
}

/// The first line, counted from 1, that is not as it must be.
fn first_wrong_line(path: &Path) -> Result<Option<MeshFileError>, MeshFileError> {
    let refuse = |source| MeshFileError::Read { path: path.to_owned(), source };
    let wrong = |index: usize, problem: Problem| {
        Some(MeshFileError::Line { path: path.to_owned(), line: index + 1, problem: problem.to_string() })
    };
    let mut vertex_count = 0;
    for (index, line) in BufReader::new(File::open(path).map_err(refuse)?).lines().enumerate() {
        let line = match line {
            Ok(line) => line,
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                return Ok(wrong(index, Problem::NotText));
            }
            Err(error) => return Err(refuse(error)),
        };
        let mut words = line.split_whitespace();
        let problem = match words.next() {
            Some("v") => {
                vertex_count += 1;
                wrong_vertex(words)
            }
            Some("f") => wrong_face(words, vertex_count),
            _ => None,
        };
        if let Some(problem) = problem {
            return Ok(wrong(index, problem));
        }
    }
    Ok(None)
}

fn count_vertices(path: &Path) -> Result<usize, MeshFileError> {
    let refuse = |source| MeshFileError::Read { path: path.to_owned(), source };
    let mut count = 0;
    for line in BufReader::new(File::open(path).map_err(refuse)?).lines() {
        if line.map_err(refuse)?.split_whitespace().next() == Some("v") {
            count += 1;
        }
    }
    Ok(count)
}

fn wrong_vertex<'a>(words: impl Iterator<Item = &'a str>) -> Option<Problem> {
    let mut count = 0;
    for word in words.take(3) {
        count += 1;
        match word.parse::<f32>() {
            Ok(number) if number.is_finite() => {}
            Ok(_) | Err(_) => return Some(Problem::Coordinate { found: word.to_owned() }),
        }
    }
    (count < 3).then_some(Problem::FewCoordinates { count })
}

fn wrong_face<'a>(words: impl Iterator<Item = &'a str>, vertex_count: usize) -> Option<Problem> {
    let mut count = 0;
    for word in words {
        count += 1;
        let first = word.split('/').next().unwrap_or(word);
        let Ok(number) = first.parse::<i64>() else {
            return Some(Problem::Corner { found: word.to_owned() });
        };
        // Numbers begin at 1; negative ones count back from the last vertex.
        let exists = number != 0 && usize::try_from(number.unsigned_abs()).is_ok_and(|back| back <= vertex_count);
        if !exists {
            return Some(Problem::NoSuchVertex { found: word.to_owned(), vertex_count });
        }
    }
    (count < 3).then_some(Problem::FewCorners { count })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{corners, read_bytes};

    #[test]
    fn faces_keep_their_order_over_objects_and_polygons_become_triangles() {
        let text = b"o one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\no two\nv 0 0 1\nf -1 1//9 2/3\n";
        let corners = corners(&read_bytes("order.obj", text).expect("the file is whole"));
        let (a, b, c, d, e) = ([0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [0., 0., 1.]);
        assert_eq!(corners, [a, b, c, a, c, d, e, a, b]);
    }

    #[test]
    fn vertices_are_rounded_to_single_precision() {
        let triangles =
            read_bytes("round.obj", b"v 0.1 16777217 -3e-5\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("it is whole");
        assert_eq!(triangles.vertices[..3], [0.1_f32, 16_777_216.0, -3e-5]);
    }

    #[test]
    fn a_broken_file_is_told_with_its_line() {
        let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        for (name, rest, line, said) in [
            ("index", "f 1 2 9\n", "line 4:", "names a vertex that does not exist"),
            ("zero", "f 0 1 2\n", "line 4:", "names a vertex that does not exist"),
            ("back", "f -4 1 2\n", "line 4:", "names a vertex that does not exist"),
            ("nan", "v nan 0 0\nf 1 2 4\n", "line 4:", "not a finite number"),
            ("huge", "v 1e39 0 0\nf 1 2 4\n", "line 4:", "not a finite number"),
            ("word", "v 1 two 3\nf 1 2 3\n", "line 4:", "\"two\""),
            ("short", "v 1 2\nf 1 2 3\n", "line 4:", "this one has 2"),
            ("corner", "f 1 2 x\n", "line 4:", "no corner"),
            ("empty", "", "no faces", "3 vertices"),
        ] {
            let sentence =
                read_bytes(&format!("{name}.obj"), format!("{corners}{rest}").as_bytes()).unwrap_err().to_string();
            assert!(sentence.contains(line) && sentence.contains(said), "{name}: {sentence}");
        }
        let sentence = read_bytes("binary.obj", b"v 0 0 0\n\xff\xfe\x00\x01").unwrap_err().to_string();
        assert!(sentence.contains("not text"), "{sentence}");
    }
}
