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

impl Core {
    /// Largest distance of one of its points from the local origin, metres, to within a few roundings.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match self {
            Self::Point => 0.0,
            Self::Segment { half_height } => *half_height,
            Self::Cuboid { half_extents } => half_extents.length(),
            Self::Hull(hull) => farthest(hull.vertices()),
            Self::Triangle(corners) => farthest(corners),
        }
    }
}

fn farthest(points: &[DVec3]) -> f64 {
    points.iter().map(|point| point.length_squared()).fold(0.0, f64::max).sqrt()
}
