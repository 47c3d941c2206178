//! The convex forms whose signed distance is known to the oracle, as they are sent.

use glam::{DQuat, DVec3};

/// What a radius goes around.
#[derive(Clone, Debug, PartialEq)]
pub enum Core {
    /// The local origin.
    Point,
    /// Along local y.
    Segment {
        /// Half of its length, metres.
        half_height: f64,
    },
    /// About the local origin.
    Cuboid {
        /// Half of each edge, metres; 0 is allowed.
        half_extents: DVec3,
    },
    /// The convex hull of points.
    Hull(Vec<DVec3>),
    /// About the local origin, along local y.
    Cylinder {
        /// Half of its height, metres.
        half_height: f64,
        /// Metres.
        radius: f64,
    },
    /// Along local y, the base at −`half_height`, the apex at +`half_height`.
    Cone {
        /// Half of its height, metres.
        half_height: f64,
        /// Of the base, metres.
        radius: f64,
    },
    /// About the local origin.
    Ellipsoid {
        /// Half axes, metres.
        radii: DVec3,
    },
    /// Everything on one side of a plane; without a radius around it.
    HalfSpace {
        /// Outward, of any length but 0.
        normal: DVec3,
        /// Where the plane cuts the line along the unit normal, metres from the local origin.
        offset: f64,
    },
}

/// All points within a radius of a core.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// What the radius goes around.
    pub core: Core,
    /// Metres, at least 0.
    pub radius: f64,
}

/// A form at a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedSolid {
    /// What.
    pub solid: Solid,
    /// Where its local origin is, metres.
    pub position: DVec3,
    /// How it is turned: a quaternion of any length but 0.
    pub rotation: DQuat,
}

impl Solid {
    /// The greatest distance of one of its points from the local origin, metres, to within some roundings; for a half
    /// space that of its plane.
    #[must_use]
    pub fn reach(&self) -> f64 {
        let core = match &self.core {
            Core::Point => 0.0,
            Core::Segment { half_height } => *half_height,
            Core::Cuboid { half_extents } => length(*half_extents),
            Core::Hull(points) => points.iter().map(|&point| length(point)).fold(0.0, f64::max),
            Core::Cylinder { half_height, radius } | Core::Cone { half_height, radius } => half_height.hypot(*radius),
            Core::Ellipsoid { radii } => radii.max_element(),
            Core::HalfSpace { offset, .. } => offset.abs(),
        };
        core + self.radius
    }
}

/// A length whose square may be out of range.
#[must_use]
pub fn length(v: DVec3) -> f64 {
    let most = v.abs().max_element();
    // Below this the quotient would not be finite.
    if most < 1e-300 { most } else { (v / most).length() * most }
}

/// What errors of a pair are relative to, metres: the greatest of both radii about the local origins and the distance
/// of those.
#[must_use]
pub fn scale(a: &PlacedSolid, b: &PlacedSolid) -> f64 {
    a.solid.reach().max(b.solid.reach()).max(length(b.position - a.position))
}
