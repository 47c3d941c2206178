//! Convex forms: a core and a radius around it.
//!
//! ```text
//!   Segment      Cuboid        Cylinder        Cone            Ellipsoid
//!      |         +---+         .-----.          /\              .---.
//!   y  |         |   |   y     |  y  |         /y \           (   y  )
//!      |         +---+         '-----'        /____\            '---'
//! ```

use std::sync::Arc;

use glam::DVec3;

use super::Hull;
use crate::math::Norm;

/// All points within `radius` of a core. The radius lies before the core in memory, beside what of it is not empty.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Convex {
    /// Metres, at least 0.
    pub radius: f64,
    /// What the radius goes around.
    pub core: Core,
}

/// What a radius goes around: a polytope, possibly flat, or one of three round bodies about the local origin.
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
    /// A cylinder about the local origin, along y.
    Cylinder {
        /// Half of its height, metres, above 0.
        half_height: f64,
        /// Of both ends, metres, above 0.
        radius: f64,
    },
    /// A cone along y: base at −`half_height`, apex at +`half_height`.
    Cone {
        /// Half of its height, metres, above 0.
        half_height: f64,
        /// Of the base, metres, above 0.
        radius: f64,
    },
    /// An ellipsoid about the local origin.
    Ellipsoid {
        /// Half axes along x, y and z, metres, above 0.
        radii: DVec3,
    },
}

impl Core {
    /// Largest distance of one of its points from the local origin, metres, to within a few roundings.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match self {
            Self::Point => 0.0,
            Self::Segment { half_height } => *half_height,
            Self::Cuboid { half_extents } => half_extents.norm(),
            Self::Hull(hull) => hull.reach(),
            Self::Triangle(corners) => farthest(corners),
            Self::Cylinder { half_height, radius } | Self::Cone { half_height, radius } => {
                (half_height * half_height + radius * radius).sqrt()
            }
            Self::Ellipsoid { radii } => radii.max_element(),
        }
    }

    /// Whether it has finitely many corners.
    #[must_use]
    pub fn is_polytope(&self) -> bool {
        match self {
            Self::Point | Self::Segment { .. } | Self::Cuboid { .. } | Self::Hull(_) | Self::Triangle(_) => true,
            Self::Cylinder { .. } | Self::Cone { .. } | Self::Ellipsoid { .. } => false,
        }
    }
}

fn farthest(points: &[DVec3]) -> f64 {
    points.iter().map(|point| point.length_squared()).fold(0.0, f64::max).sqrt()
}
