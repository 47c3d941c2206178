//! Triangle meshes and their tree, which is built when a question first needs it.

use glam::DVec3;

/// Triangles, felt from both sides.
#[derive(Debug)]
pub struct Mesh {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    report: MeshReport,
}

/// What was found in a mesh when it came.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshReport {
    /// Triangles as sent.
    pub triangles_sent: usize,
    /// Triangles without area, left out.
    pub degenerate: usize,
    /// Vertices that were equal to an earlier one.
    pub merged_vertices: usize,
    /// Edges with one triangle only.
    pub open_edges: usize,
    /// Edges with more than two.
    pub non_manifold_edges: usize,
}

impl Mesh {
    /// The distinct vertices.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// The kept triangles, by vertex.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// What was found when it came.
    #[must_use]
    pub fn report(&self) -> MeshReport {
        self.report
    }
}
