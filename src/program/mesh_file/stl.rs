//! Reads triangles from an STL file, text or binary.
//!
//! # Limits
//! Normals and attributes are passed over. Corners with the same bits become one vertex.

use std::io::{BufReader, ErrorKind, Read, Seek};
use std::path::Path;

use super::{Format, MeshFileError, Triangles};

/// The triangles of a file.
///
/// # Errors
/// It is broken or ends too early.
pub(super) fn read(path: &Path, file: impl Read + Seek) -> Result<Triangles, MeshFileError> {
    let mesh = stl_io::read_stl(&mut BufReader::new(file)).map_err(|error| {
        let problem = match error.kind() {
            ErrorKind::UnexpectedEof => "it ends before its last triangle does".to_owned(),
            _ => error.to_string(),
        };
        MeshFileError::Broken { path: path.to_owned(), format: Format::Stl, problem }
    })?;
    let index = |vertex: usize| u32::try_from(vertex).unwrap_or(u32::MAX);
    Ok(Triangles {
        vertices: mesh.vertices.iter().flat_map(|vertex| vertex.0).collect(),
        indices: mesh.faces.iter().flat_map(|face| face.vertices.map(index)).collect(),
        notes: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{corners, read_bytes};

    const TEXT: &str = "solid made by hand\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0.5\n\
                        endloop\nendfacet\nendsolid\n";

    fn binary(count: u32) -> Vec<u8> {
        let mut bytes = b"not text".to_vec();
        bytes.resize(80, 0);
        bytes.extend(count.to_le_bytes());
        for triangle in 0..2_u8 {
            for coordinate in [0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., f32::from(triangle)] {
                bytes.extend(f32::to_le_bytes(coordinate));
            }
            bytes.extend([0, 0]);
        }
        bytes
    }

    #[test]
    fn text_and_binary_are_read_and_shared_corners_are_one_vertex() {
        let text = read_bytes("text.stl", TEXT.as_bytes()).expect("it is whole");
        assert_eq!(corners(&text), [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.5]]);
        let triangles = read_bytes("binary.STL", &binary(2)).expect("it is whole");
        assert_eq!(corners(&triangles)[3..], [[0., 0., 0.], [1., 0., 0.], [0., 1., 1.]]);
        assert_eq!(triangles.vertices.len(), 3 * 4);
    }

    #[test]
    fn a_broken_file_is_told_so() {
        let sentence = read_bytes("short.stl", &binary(3)).unwrap_err().to_string();
        assert!(sentence.contains("ends before its last triangle"), "{sentence}");
        let sentence = read_bytes("word.stl", TEXT.replace("0.5", "half").as_bytes()).unwrap_err().to_string();
        assert!(sentence.contains("no STL file"), "{sentence}");
        let sentence = read_bytes("empty.stl", &binary(0)).unwrap_err().to_string();
        assert!(sentence.contains("no faces"), "{sentence}");
    }
}
