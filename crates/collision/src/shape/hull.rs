//! Convex hulls of points.

use glam::DVec3;

/// The convex hull of points: its extreme vertices, faces and edges.
#[derive(Debug)]
pub struct Hull {
    vertices: Vec<DVec3>,
}

impl Hull {
    /// The extreme points, in the order they were sent.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }
}
