//! Convex forms: a core and a radius around it.

use std::sync::Arc;

use glam::DVec3;

use super::Hull;

/// All points within `radius` of a core.
#[derive(Clone, Debug)]
pub struct Convex {
    /// What the radius goes around.
    pub core: Core,
    /// Metres, at least 0.
    pub radius: f64,
}

/// A polytope about the local origin, possibly flat.
#[derive(Clone, Debug)]
pub enum Core {
    /// The local origin.
    Point,
    /// From −`half_height` to +`half_height` along y.
    Segment {
        /// Half of its length, metres.
        half_height: f64,
    },
    /// A box about the local origin; a component may be 0.
    Cuboid {
        /// Half of each edge, metres.
        half_extents: DVec3,
    },
    /// The convex hull of points.
    Hull(Arc<Hull>),
    /// A triangle of a mesh, by its corners.
    Triangle([DVec3; 3]),
}
