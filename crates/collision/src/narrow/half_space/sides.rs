//! Which triangles of a mesh a half space meets.
//!
//! # Method
//! Of a surface that is felt from one side, those whose front looks into the half space: its matter is before them then, as far
//! as it goes, which is what the middle of a bounded form tells of that. So the same surface lies on a half space as on a large
//! box. A triangle on its edge counts; in a motion only where the half space does not go along the front or away from it.

use glam::DVec3;

use super::{Above, Body};
use crate::{
    math::{Norm, expansion::triangle_cross, try_unit},
    narrow::InitialTouch,
    shape::MeshMode,
    tolerance::SURFACE_LEAN,
};

/// Which triangles of a form count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Felt {
    /// All.
    All,
    /// Those whose front looks into the half space.
    Fronts,
    /// Those of them that it meets as it goes this way past the form, in the form's own axes.
    FrontsAhead(DVec3),
}

impl Felt {
    /// Those that have contacts.
    pub(super) fn in_contact(body: Body<'_>) -> Self {
        match body {
            Body::Mesh(mesh) if mesh.mode() != MeshMode::TwoSided => Self::Fronts,
            Body::Convex(_) | Body::Mesh(_) | Body::Field(_) => Self::All,
        }
    }

    /// Those that are touched in a motion.
    pub(super) fn in_motion(body: Body<'_>, initial: InitialTouch) -> Self {
        let Body::Mesh(mesh) = body else { return Self::All };
        match mesh.mode() {
            MeshMode::OneSided => Self::Fronts,
            // What begins in a solid and is not yet clear of it comes to its walls from behind.
            MeshMode::Solid if initial == InitialTouch::IsIgnored => Self::Fronts,
            MeshMode::TwoSided | MeshMode::Solid => Self::All,
        }
    }
}

impl<'a> Above<'a> {
    /// The same where only some triangles count.
    pub(super) fn feeling(&self, felt: Felt) -> Self {
        Self { felt, ..*self }
    }

    /// Whether a triangle counts.
    pub(super) fn feels(&self, corners: [DVec3; 3]) -> bool {
        let front = || try_unit(triangle_cross(corners)).unwrap_or(DVec3::ZERO);
        match self.felt {
            Felt::All => true,
            Felt::Fronts => front().dot(self.normal) <= SURFACE_LEAN,
            Felt::FrontsAhead(way) => {
                let front = front();
                front.dot(self.normal) <= SURFACE_LEAN && front.dot(way) <= SURFACE_LEAN * way.norm()
            }
        }
    }
}
