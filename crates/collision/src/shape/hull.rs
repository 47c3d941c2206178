//! Convex hulls of points: their vertices, and their faces and edges once a question needs them.
//!
//! # Limits
//! The vertices are the distinct points as sent, inner ones included: the support function passes over those. Faces are
//! whole polygons (triangles in exactly one plane are one face).

use std::sync::OnceLock;

use glam::DVec3;

use super::{
    quickhull,
    topology::{Edge, Face, Topology},
};

/// The convex hull of points, which may be flat, straight or a single point.
#[derive(Debug)]
pub struct Hull {
    vertices: Vec<DVec3>,
    topology: OnceLock<Topology>,
}

impl Hull {
    /// The hull of `points`, at least one, all finite. The topology is built when a question first needs it.
    #[must_use]
    pub fn new(points: &[DVec3]) -> Self {
        Self { vertices: quickhull::distinct(points), topology: OnceLock::new() }
    }

    /// The distinct points, in the order they were sent.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Its faces and edges: built on the first call, in O(n log n) for typical points.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        self.topology.get_or_init(|| quickhull::topology(&self.vertices))
    }

    /// Bytes it holds in memory now.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        let topology = self.topology.get().map_or(0, |topology| {
            let corners: usize = topology.faces.iter().map(|face| face.vertices.len() * size_of::<u32>()).sum();
            corners + topology.faces.len() * size_of::<Face>() + topology.edges.len() * size_of::<Edge>()
        });
        (size_of::<Self>() + self.vertices.len() * size_of::<DVec3>() + topology) as u64
    }
}
