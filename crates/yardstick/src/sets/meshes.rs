//! `mesh_mesh_A_B`: mesh B at a pose, against mesh A at the origin.

use std::{path::Path, sync::Arc};

use glam::DVec3;
use serde::Deserialize;

use super::{Form, Placed, Pose, SetError, TriangleMesh, read_lines};

/// Two placed meshes and how far apart their surfaces are.
#[derive(Clone, Debug)]
pub struct MeshPairRecord {
    /// Index in the file.
    pub index: u64,
    /// Category.
    pub category: String,
    /// The yes or no is not to be judged.
    pub ambiguous: bool,
    /// The first mesh.
    pub a: Placed,
    /// The second mesh.
    pub b: Placed,
    /// Distance of the surfaces, metres; 0 if any triangles cross.
    pub distance: f64,
    /// How many pairs of triangles cross.
    pub crossing_count: u64,
    /// What errors are relative to: a diagonal and the distance of the origins, metres.
    pub scale: f64,
    /// How far the pose may lie beside what was meant because the record's rotation is not a rotation, metres.
    pub pose_error: f64,
}

#[derive(Deserialize)]
struct Line {
    i: u64,
    cat: String,
    #[serde(default)]
    amb: u8,
    p: [f64; 3],
    q: [f64; 4],
    d: f64,
    tri_pairs: u64,
}

/// Reads a set of mesh pairs: `placed` at the poses of the records, `fixed` at the origin.
///
/// # Errors
/// The file or a line of it is not understood.
pub fn read(
    path: &Path,
    fixed: &Arc<TriangleMesh>,
    placed: &Arc<TriangleMesh>,
) -> Result<Vec<MeshPairRecord>, SetError> {
    let diagonal = fixed.diagonal().max(placed.diagonal());
    let lines = read_lines::<Line>(path)?;
    lines
        .into_iter()
        .map(|(number, line)| {
            if line.q.iter().all(|&component| component == 0.0) {
                return Err(SetError::line(path, number, "q is all zeros: it is no rotation"));
            }
            let pose = Pose::from_arrays(line.p, line.q);
            Ok(MeshPairRecord {
                index: line.i,
                category: line.cat,
                ambiguous: line.amb != 0,
                a: Placed { form: Form::Mesh(Arc::clone(fixed)), pose: Pose::at(DVec3::ZERO) },
                b: Placed { form: Form::Mesh(Arc::clone(placed)), pose },
                distance: line.d,
                crossing_count: line.tri_pairs,
                scale: diagonal + pose.position.length(),
                pose_error: 0.0,
            })
        })
        .collect()
}
