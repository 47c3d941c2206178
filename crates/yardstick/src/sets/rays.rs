//! `rays_MESH`: rays at a mesh.

use std::{path::Path, sync::Arc};

use glam::DVec3;
use serde::Deserialize;

use super::{Form, Placed, Pose, SetError, TriangleMesh, read_lines};

/// A ray at a mesh and where it first meets it.
#[derive(Clone, Debug)]
pub struct RayRecord {
    /// Index in the file.
    pub index: u64,
    /// Category.
    pub category: String,
    /// The yes or no is not to be judged.
    pub ambiguous: bool,
    /// The mesh where it stands.
    pub target: Placed,
    /// Where the ray begins.
    pub origin: DVec3,
    /// Where it goes; points of it are `origin + t * direction`.
    pub direction: DVec3,
    /// The greatest `t`; infinite if none is given.
    pub max_t: f64,
    /// What it meets first, if anything.
    pub hit: Option<RayTruth>,
    /// Diagonal of the mesh's box, plus the distance from its middle to the origin of the ray, metres.
    pub scale: f64,
}

/// What a ray meets first.
#[derive(Clone, Debug)]
pub struct RayTruth {
    /// Where, as a parameter of the ray.
    pub t: f64,
    /// All triangles it meets there.
    pub faces: Vec<u32>,
    /// Cosine of the angle to the triangle's normal.
    pub cos: f64,
}

#[derive(Deserialize)]
struct Line {
    i: u64,
    cat: String,
    #[serde(default)]
    amb: u8,
    o: [f64; 3],
    d: [f64; 3],
    #[serde(default)]
    p: [f64; 3],
    max_t: Option<f64>,
    hit: bool,
    t: Option<f64>,
    #[serde(default)]
    ids: Vec<u32>,
    cos: Option<f64>,
}

/// Reads a set of rays at `mesh`.
///
/// # Errors
/// The file or a line of it is not understood.
pub fn read(path: &Path, mesh: &Arc<TriangleMesh>) -> Result<Vec<RayRecord>, SetError> {
    let (diagonal, center) = (mesh.diagonal(), mesh.center());
    let lines = read_lines::<Line>(path)?;
    lines
        .into_iter()
        .map(|(number, line)| {
            let hit = truth(&line).map_err(|reason| SetError::line(path, number, reason))?;
            let (position, origin) = (DVec3::from_array(line.p), DVec3::from_array(line.o));
            Ok(RayRecord {
                index: line.i,
                category: line.cat,
                ambiguous: line.amb != 0,
                target: Placed { form: Form::Mesh(Arc::clone(mesh)), pose: Pose::at(position) },
                origin,
                direction: DVec3::from_array(line.d),
                max_t: line.max_t.unwrap_or(f64::INFINITY),
                hit,
                scale: diagonal + (origin - (center + position)).length(),
            })
        })
        .collect()
}

fn truth(line: &Line) -> Result<Option<RayTruth>, String> {
    if line.d.iter().all(|&component| component == 0.0) {
        return Err("d is all zeros: it is no direction".to_owned());
    }
    match (line.hit, line.t, line.cos) {
        (true, Some(t), Some(cos)) => Ok(Some(RayTruth { t, faces: line.ids.clone(), cos })),
        (false, None, _) => Ok(None),
        _ => Err("t and cos must be there if hit is true, and t only then".to_owned()),
    }
}
