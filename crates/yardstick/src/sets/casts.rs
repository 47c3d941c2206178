//! `spherecast_MESH` and `capsulemesh_MESH`: a ball that flies at a mesh, and a capsule placed near one.

use std::{path::Path, sync::Arc};

use glam::DVec3;
use serde::Deserialize;

use super::{Pose, SetError, TriangleMesh, read_lines};

/// A ball that goes from `origin` by `displacement` at a mesh at the origin.
#[derive(Clone, Debug)]
pub struct SphereCastRecord {
    /// Index in the file.
    pub index: u64,
    /// Category.
    pub category: String,
    /// The yes or no is not to be judged.
    pub ambiguous: bool,
    /// The mesh.
    pub mesh: Arc<TriangleMesh>,
    /// Where the ball begins.
    pub origin: DVec3,
    /// Where it goes in the time 0 to 1.
    pub displacement: DVec3,
    /// Its radius, metres.
    pub radius: f64,
    /// The time of the first touch; `None` if there is none.
    pub time: Option<f64>,
    /// They overlap at the start.
    pub start: bool,
    /// What errors are relative to, metres.
    pub scale: f64,
}

#[derive(Deserialize)]
struct CastLine {
    i: u64,
    cat: String,
    #[serde(default)]
    amb: u8,
    o: [f64; 3],
    d: [f64; 3],
    r: f64,
    hit: bool,
    t: Option<f64>,
    start: bool,
    s: f64,
}

/// Reads a set of sphere casts at `mesh`.
///
/// # Errors
/// The file or a line of it is not understood.
pub fn read_sphere_casts(path: &Path, mesh: &Arc<TriangleMesh>) -> Result<Vec<SphereCastRecord>, SetError> {
    let lines = read_lines::<CastLine>(path)?;
    lines
        .into_iter()
        .map(|(number, line)| {
            if line.hit != line.t.is_some() {
                return Err(SetError::line(path, number, "t must be there if hit is true, and only then"));
            }
            Ok(SphereCastRecord {
                index: line.i,
                category: line.cat,
                ambiguous: line.amb != 0,
                mesh: Arc::clone(mesh),
                origin: DVec3::from_array(line.o),
                displacement: DVec3::from_array(line.d),
                radius: line.r,
                time: line.t,
                start: line.start,
                scale: line.s,
            })
        })
        .collect()
}

/// A capsule near a mesh at the origin.
#[derive(Clone, Debug)]
pub struct CapsuleMeshRecord {
    /// Index in the file.
    pub index: u64,
    /// Category.
    pub category: String,
    /// The yes or no is not to be judged.
    pub ambiguous: bool,
    /// The mesh.
    pub mesh: Arc<TriangleMesh>,
    /// Where the capsule is.
    pub pose: Pose,
    /// Half of its segment, metres.
    pub half_height: f64,
    /// Its radius, metres.
    pub radius: f64,
    /// They touch.
    pub overlap: bool,
    /// Distance of its segment to the surface, less its radius.
    pub distance: f64,
    /// Triangles that it surely touches.
    pub faces: Vec<u32>,
    /// Triangles at its very skin: touched or not.
    pub maybe: Vec<u32>,
    /// What errors are relative to, metres.
    pub scale: f64,
}

#[derive(Deserialize)]
struct CapsuleLine {
    i: u64,
    cat: String,
    #[serde(default)]
    amb: u8,
    p: [f64; 3],
    q: [f64; 4],
    h: f64,
    r: f64,
    overlap: bool,
    d: f64,
    ids: Vec<u32>,
    maybe: Vec<u32>,
    s: f64,
}

/// Reads a set of capsules at `mesh`.
///
/// # Errors
/// The file or a line of it is not understood.
pub fn read_capsules(path: &Path, mesh: &Arc<TriangleMesh>) -> Result<Vec<CapsuleMeshRecord>, SetError> {
    let lines = read_lines::<CapsuleLine>(path)?;
    lines
        .into_iter()
        .map(|(number, line)| {
            if line.q.iter().all(|&component| component == 0.0) {
                return Err(SetError::line(path, number, "q is all zeros: it is no rotation"));
            }
            Ok(CapsuleMeshRecord {
                index: line.i,
                category: line.cat,
                ambiguous: line.amb != 0,
                mesh: Arc::clone(mesh),
                pose: Pose::from_arrays(line.p, line.q),
                half_height: line.h,
                radius: line.r,
                overlap: line.overlap,
                distance: line.d,
                faces: line.ids,
                maybe: line.maybe,
                scale: line.s,
            })
        })
        .collect()
}
