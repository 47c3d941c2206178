//! Reads triangles from a PLY file, text or binary of either byte order.
//!
//! # Limits
//! Colours, normals, edges and whatever else a file has are passed over. Triangle strips are not read.

use std::io::{BufReader, Read};
use std::path::Path;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

use super::{Format, MeshFileError, Triangles, add_polygon};

/// The triangles of a file.
///
/// # Errors
/// It is broken, or a face names a vertex that is not there.
pub(super) fn read(path: &Path, file: impl Read) -> Result<Triangles, MeshFileError> {
    let broken = |problem: String| MeshFileError::Broken { path: path.to_owned(), format: Format::Ply, problem };
    let refused = |error: ParseError| broken(error.to_string());
    let mut reader = Reader::new(BufReader::new(file));
    let header = Parser::<Vertex>::new().read_header(&mut reader).map_err(refused)?;
    let mut triangles = Triangles::default();
    let mut faces = Vec::new();
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => {
                let vertices = Parser::<Vertex>::new().read_payload_for_element(&mut reader, element, &header);
                triangles.vertices = vertices.map_err(refused)?.into_iter().flat_map(|vertex| vertex.0).collect();
            }
            "face" => {
                let read = Parser::<Face>::new().read_payload_for_element(&mut reader, element, &header);
                faces = read.map_err(refused)?;
            }
            _ => {
                Parser::<Other>::new().read_payload_for_element(&mut reader, element, &header).map_err(refused)?;
                triangles.notes.push(format!("{} of {name} passed over", element.count));
            }
        }
    }
    let vertex_count = triangles.vertices.len() / 3;
    for (number, face) in faces.iter().enumerate() {
        let corner = |&corner: &i64| u32::try_from(corner).ok().filter(|&corner| (corner as usize) < vertex_count);
        let corners: Option<Vec<u32>> = face.0.iter().map(corner).collect();
        let Some(corners) = corners else {
            let what = format!("face {number} (counted from 0) names vertices {:?}: there are {vertex_count}", face.0);
            return Err(broken(what));
        };
        if corners.len() < 3 {
            return Err(broken(format!(
                "face {number} (counted from 0) has {} corners, three at least",
                corners.len()
            )));
        }
        add_polygon(&mut triangles.indices, &corners);
    }
    Ok(triangles)
}

/// A vertex; what the file leaves out is NaN, which is told as such.
struct Vertex([f32; 3]);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([f32::NAN; 3])
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let (Some(axis), Some(number)) = (["x", "y", "z"].iter().position(|axis| *axis == name), value.to_f32_lossy())
        else {
            return PropertyAccessResult::Ignored;
        };
        self.0[axis] = number;
        PropertyAccessResult::Set
    }
}

/// The corners of a face.
struct Face(Vec<i64>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if name != "vertex_indices" && name != "vertex_index" {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match value {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

/// Something else, which is read past.
struct Other;

impl PropertyAccess for Other {
    fn new() -> Self {
        Self
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{corners, read_bytes};

    const HEADER: &str = "comment made by hand\nelement vertex 4\nproperty float x\nproperty double y\n\
                          property float z\nproperty uchar red\nelement face 1\n\
                          property list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nend_header\n";

    fn text(face: &str) -> Vec<u8> {
        let vertices = "0 0 0 255\n1 0 0 255\n1 1 0 9\n0 1 0.5 0\n";
        format!("ply\nformat ascii 1.0\n{HEADER}{vertices}{face}\n7\n").into_bytes()
    }

    fn binary() -> Vec<u8> {
        let mut bytes = format!("ply\nformat binary_big_endian 1.0\n{HEADER}").into_bytes();
        for [x, y, z] in [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.5_f32]] {
            bytes.extend(x.to_be_bytes());
            bytes.extend(f64::from(y).to_be_bytes());
            bytes.extend(z.to_be_bytes());
            bytes.push(255);
        }
        bytes.push(4);
        [0_i32, 1, 2, 3].iter().for_each(|corner| bytes.extend(corner.to_be_bytes()));
        bytes.extend(7_i32.to_be_bytes());
        bytes
    }

    #[test]
    fn text_and_binary_are_the_same_and_the_rest_is_noted() {
        let triangles = read_bytes("text.ply", &text("4 0 1 2 3")).expect("it is whole");
        let (a, b, c, d) = ([0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.5]);
        assert_eq!(corners(&triangles), [a, b, c, a, c, d]);
        assert_eq!(triangles.notes, ["1 of edge passed over"]);
        assert_eq!(read_bytes("binary.ply", &binary()).expect("it is whole"), triangles);
    }

    #[test]
    fn a_broken_file_is_told_with_the_place() {
        for (face, said) in [
            ("4 0 1 2 4", "face 0 (counted from 0) names vertices [0, 1, 2, 4]: there are 4"),
            ("3 0 1 -1", "names vertices [0, 1, -1]"),
            ("2 0 1", "has 2 corners"),
            ("3 0 1 x", "no PLY file"),
        ] {
            let sentence = read_bytes("face.ply", &text(face)).unwrap_err().to_string();
            assert!(sentence.contains(said), "{sentence}");
        }
        let cut = binary();
        let sentence = read_bytes("cut.ply", &cut[..cut.len() - 9]).unwrap_err().to_string();
        assert!(sentence.contains("no PLY file"), "{sentence}");
    }
}
