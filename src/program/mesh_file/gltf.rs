//! Reads triangles from a glTF 2.0 file, text or binary, with its nodes where the scene puts them.
//!
//! # Method
//! The matrices of nodes are multiplied in double precision, and each corner is rounded to single precision once. A mirrored
//! node turns its triangles round, so that their fronts stay in front. Buffers are within the file, beside it, or written
//! into it as base64.
//!
//! # Limits
//! Points and lines are passed over; skins, morph targets and animations are left as they are at rest. Compressed meshes
//! (`KHR_draco_mesh_compression`) are refused.

use std::io::{BufReader, Read};
use std::path::Path;

use base64::Engine;
use glam::{DMat4, DVec3};
use gltf::buffer::Source;
use gltf::mesh::Mode;
use gltf::{Gltf, Node, Primitive};

use super::{Format, MeshFileError, Triangles};

/// Nodes within nodes at most: deeper files are taken for broken.
const DEPTH: usize = 64;

/// The triangles of the default scene, or of all scenes if none is the default.
///
/// # Errors
/// It is broken, needs an extension that is not known here, or a buffer is missing.
pub(super) fn read(path: &Path, file: impl Read) -> Result<Triangles, MeshFileError> {
    let broken = |problem: String| MeshFileError::Broken { path: path.to_owned(), format: Format::Gltf, problem };
    let file =
        Gltf::from_reader(seekable(file).map_err(|source| MeshFileError::Read { path: path.to_owned(), source })?);
    let mut file = file.map_err(|error| broken(error.to_string()))?;
    let inner = file.blob.take();
    let buffers = file.buffers().map(|buffer| {
        let bytes = bytes_of(path, buffer.source(), inner.as_deref())?;
        match bytes.len() >= buffer.length() {
            true => Ok(bytes),
            false => Err(format!("buffer {} has {} bytes of {}", buffer.index(), bytes.len(), buffer.length())),
        }
    });
    let buffers = buffers.collect::<Result<Vec<_>, _>>().map_err(broken)?;
    let mut reading = Reading { buffers: &buffers, triangles: Triangles::default(), passed_over: 0, mirrored: 0 };
    let scenes: Vec<_> = match file.default_scene() {
        Some(scene) => vec![scene],
        None => file.scenes().collect(),
    };
    for scene in scenes {
        for node in scene.nodes() {
            reading.node(&node, DMat4::IDENTITY, 0).map_err(broken)?;
        }
    }
    Ok(reading.noted())
}

/// The whole file in memory, as the library reads it from its start.
fn seekable(file: impl Read) -> std::io::Result<std::io::Cursor<Vec<u8>>> {
    let mut bytes = Vec::new();
    BufReader::new(file).read_to_end(&mut bytes)?;
    Ok(std::io::Cursor::new(bytes))
}

/// What a buffer holds.
fn bytes_of(path: &Path, source: Source<'_>, inner: Option<&[u8]>) -> Result<Vec<u8>, String> {
    let uri = match source {
        Source::Bin => return inner.map(<[u8]>::to_vec).ok_or_else(|| "its binary part is missing".to_owned()),
        Source::Uri(uri) => uri,
    };
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data.split_once(";base64,").ok_or_else(|| "a data URI is not in base64".to_owned())?;
        return base64::engine::general_purpose::STANDARD.decode(text).map_err(|error| format!("a data URI: {error}"));
    }
    if uri.contains("://") {
        return Err(format!("{uri} is not a file beside it"));
    }
    let name = percent_encoding::percent_decode_str(uri).decode_utf8().map_err(|error| format!("{uri}: {error}"))?;
    let beside = path.with_file_name("").join(&*name);
    std::fs::read(&beside).map_err(|error| format!("{} cannot be read: {error}", beside.display()))
}

/// What was read so far.
struct Reading<'a> {
    buffers: &'a [Vec<u8>],
    triangles: Triangles,
    /// Primitives of points and lines.
    passed_over: usize,
    /// Nodes whose triangles were turned round.
    mirrored: usize,
}

impl Reading<'_> {
    fn node(&mut self, node: &Node<'_>, parent: DMat4, depth: usize) -> Result<(), String> {
        if depth > DEPTH {
            return Err(format!("nodes lie within nodes more than {DEPTH} deep"));
        }
        let own = DMat4::from_cols_array_2d(&node.transform().matrix().map(|column| column.map(f64::from)));
        let place = parent * own;
        if let Some(mesh) = node.mesh() {
            self.mirrored += usize::from(place.determinant() < 0.0);
            for primitive in mesh.primitives() {
                self.primitive(&primitive, place).map_err(|problem| {
                    format!("primitive {} of mesh {}: {problem}", primitive.index(), mesh.index())
                })?;
            }
        }
        node.children().try_for_each(|child| self.node(&child, place, depth + 1))
    }

    fn primitive(&mut self, primitive: &Primitive<'_>, place: DMat4) -> Result<(), String> {
        let buffers = self.buffers;
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        let Some(positions) = reader.read_positions() else { return Err("it has no positions".to_owned()) };
        let first = u32::try_from(self.triangles.vertices.len() / 3).map_err(|_| "too many vertices".to_owned())?;
        let corner =
            |position: [f32; 3]| place.transform_point3(DVec3::from(position.map(f64::from))).as_vec3().to_array();
        let before = self.triangles.vertices.len();
        self.triangles.vertices.extend(positions.flat_map(corner));
        let vertex_count = (self.triangles.vertices.len() - before) / 3;
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..).take(vertex_count).collect(),
        };
        if let Some(index) = indices.iter().find(|&&index| index as usize >= vertex_count) {
            return Err(format!("index {index} names no vertex: there are {vertex_count}"));
        }
        let corners: Vec<[u32; 3]> = match primitive.mode() {
            Mode::Triangles => indices.as_chunks().0.to_vec(),
            Mode::TriangleStrip => indices.windows(3).enumerate().map(strip_triangle).collect(),
            Mode::TriangleFan => indices.windows(2).skip(1).map(|pair| [indices[0], pair[0], pair[1]]).collect(),
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => {
                self.passed_over += 1;
                return Ok(());
            }
        };
        let is_mirrored = place.determinant() < 0.0;
        for [a, b, c] in corners {
            let (b, c) = if is_mirrored { (c, b) } else { (b, c) };
            self.triangles.indices.extend([a, b, c].map(|corner| first + corner));
        }
        Ok(())
    }

    fn noted(mut self) -> Triangles {
        if self.passed_over > 0 {
            self.triangles.notes.push(format!("{} primitives of points or lines passed over", self.passed_over));
        }
        if self.mirrored > 0 {
            let what = format!("{} nodes are mirrored: their triangles were turned round", self.mirrored);
            self.triangles.notes.push(what);
        }
        self.triangles
    }
}

/// A triangle of a strip: every second one goes the other way round.
fn strip_triangle((number, corners): (usize, &[u32])) -> [u32; 3] {
    match number % 2 {
        0 => [corners[0], corners[1], corners[2]],
        _ => [corners[1], corners[0], corners[2]],
    }
}

#[cfg(test)]
mod tests {
    use base64::Engine;

    use super::super::tests::{corners, read_bytes};

    /// A square of four vertices as two triangles, used by two nodes: a child moved and twice as large, and a mirrored one.
    fn square(mode: u32, buffer: &str, bytes: usize) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,2]}}],
            "nodes":[{{"translation":[10,0,0],"children":[1]}},{{"scale":[2,2,2],"mesh":0}},
                     {{"scale":[1,1,-1],"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":{mode}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
                         {{"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"}}],
            "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":8}}],
            "buffers":[{{{buffer}"byteLength":{bytes}}}]}}"#
        )
    }

    fn buffer() -> Vec<u8> {
        let mut bytes = Vec::new();
        for coordinate in [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.] {
            bytes.extend(f32::to_le_bytes(coordinate));
        }
        (0_u16..4).for_each(|index| bytes.extend(index.to_le_bytes()));
        bytes
    }

    fn in_text(mode: u32) -> String {
        let data = base64::engine::general_purpose::STANDARD.encode(buffer());
        square(mode, &format!(r#""uri":"data:application/octet-stream;base64,{data}","#), 56)
    }

    fn glb() -> Vec<u8> {
        let mut json = square(5, "", 56).into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let buffer = buffer();
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        let length = 12 + 8 + json.len() + 8 + buffer.len();
        let number = |length: usize| u32::try_from(length).expect("it is short").to_le_bytes();
        bytes.extend(number(length));
        bytes.extend(number(json.len()));
        bytes.extend(b"JSON");
        bytes.extend(json);
        bytes.extend(number(buffer.len()));
        bytes.extend(b"BIN\0");
        bytes.extend(buffer);
        bytes
    }

    #[test]
    fn nodes_are_where_the_scene_puts_them_and_mirrors_keep_fronts_in_front() {
        let triangles = read_bytes("text.gltf", in_text(5).as_bytes()).expect("it is whole");
        let (a, b, c, d) = ([10., 0., 0.], [12., 0., 0.], [10., 2., 0.], [12., 2., 0.]);
        assert_eq!(corners(&triangles)[..6], [a, b, c, c, b, d]);
        let (a, b, c, d) = ([0., 0., -0.], [1., 0., -0.], [0., 1., -0.], [1., 1., -0.]);
        assert_eq!(corners(&triangles)[6..], [a, c, b, c, d, b]);
        assert!(triangles.notes.concat().contains("1 nodes are mirrored"), "{:?}", triangles.notes);
        assert_eq!(read_bytes("binary.glb", &glb()).expect("it is whole"), triangles);
    }

    #[test]
    fn fans_are_cut_and_lines_are_noted() {
        let fan = read_bytes("fan.gltf", in_text(6).as_bytes()).expect("it is whole");
        assert_eq!(fan.indices[..6], [0, 1, 2, 0, 2, 3]);
        let sentence = read_bytes("lines.gltf", in_text(1).as_bytes()).unwrap_err().to_string();
        assert!(sentence.contains("no faces"), "{sentence}");
    }

    #[test]
    fn a_broken_file_is_told_with_what_is_missing() {
        let missing = square(4, r#""uri":"not%20there.bin","#, 56);
        let remote = square(4, r#""uri":"https://example.com/a.bin","#, 56);
        let short = in_text(4).replace(r#""byteLength":56"#, r#""byteLength":5600"#);
        let draco = in_text(4).replacen('{', r#"{"extensionsRequired":["KHR_draco_mesh_compression"],"#, 1);
        for (name, text, said) in [
            ("missing.gltf", missing.as_str(), "not there.bin cannot be read"),
            ("remote.gltf", &remote, "is not a file beside it"),
            ("short.gltf", &short, "buffer 0 has 56 bytes of 5600"),
            ("draco.gltf", &draco, "no glTF 2.0 file"),
            ("json.gltf", "{", "no glTF 2.0 file"),
            ("empty.glb", "", "no glTF 2.0 file"),
        ] {
            let sentence = read_bytes(name, text.as_bytes()).unwrap_err().to_string();
            assert!(sentence.contains(said), "{name}: {sentence}");
        }
    }
}
