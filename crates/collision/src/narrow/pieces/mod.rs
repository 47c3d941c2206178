//! Meshes in pairs: a mesh is asked as its triangles, each of them a convex piece, and its tree says which.
//!
//! # Method
//! The other form's box is taken into the mesh's own frame, where the tree searches for triangles; a convex kernel answers
//! for each. Of two meshes the first is searched for triangles near the second's box, then the second for triangles near
//! each of those. What may be first is gathered, and merged by intervals: certain answers bound, open ones only widen.
//!
//! # Limits
//! A mesh is a surface: what lies wholly inside a closed one does not touch it.

mod distance;
mod impact;
mod overlap;
mod sweep;

use glam::DVec3;

pub(super) use self::{
    distance::distance,
    impact::{First, impact},
    overlap::{overlap, penetration},
};
use super::{Placed, convex::PlacedConvex};
use crate::{
    math::{Aabb, Pose},
    shape::{Convex, Core, Form, Mesh},
    tolerance,
};

/// A mesh at a pose.
#[derive(Clone, Copy)]
struct Surface<'a> {
    mesh: &'a Mesh,
    whole: Placed<'a>,
}

/// What a form is in a pair.
enum Side<'a> {
    Convex(PlacedConvex<'a>),
    Surface(Surface<'a>),
}

impl<'a> Side<'a> {
    fn of(placed: Placed<'a>) -> Self {
        match placed.geometry.form() {
            Form::Convex(convex) => Self::Convex(PlacedConvex { convex, pose: placed.pose }),
            Form::Mesh(mesh) => Self::Surface(Surface { mesh, whole: placed }),
            Form::HalfSpace(_) => unreachable!("half spaces have kernels of their own"),
        }
    }
}

/// Two meshes are asked in the order of their content and poses, so that swapping them swaps the answer.
fn is_swapped(a: &Surface<'_>, b: &Surface<'_>) -> bool {
    let key = |surface: &Surface<'_>| {
        let pose = surface.whole.pose;
        let [x, y, z] = pose.position.to_array();
        let [i, j, k, w] = pose.rotation.to_array();
        (surface.whole.geometry.id(), [x, y, z, i, j, k, w].map(f64::to_bits))
    };
    key(b) < key(a)
}

impl Surface<'_> {
    /// A triangle as a convex form in the mesh's frame.
    fn piece(&self, triangle: usize) -> Convex {
        Convex { core: Core::Triangle(self.mesh.corners(triangle)), radius: 0.0 }
    }

    /// A piece where it is.
    fn placed<'p>(&self, piece: &'p Convex) -> PlacedConvex<'p> {
        PlacedConvex { convex: piece, pose: self.whole.pose }
    }

    /// The number of a triangle as the client knows it.
    fn face(&self, triangle: usize) -> Option<u32> {
        Some(self.mesh.sent_number(triangle))
    }

    /// A box in the mesh's frame that surely holds a convex form.
    fn box_of(&self, other: PlacedConvex<'_>) -> Aabb {
        let relative = self.relative(&other.pose);
        let slack = self.slack(&other.pose, other.convex.reach());
        other.convex.bounds(&relative).inflated(slack)
    }

    /// A box in the mesh's frame that surely holds another mesh.
    fn box_of_surface(&self, other: &Surface<'_>) -> Aabb {
        let relative = self.relative(&other.whole.pose);
        let slack = self.slack(&other.whole.pose, other.whole.geometry.reach());
        other.whole.geometry.bounds(&relative).inflated(slack)
    }

    /// A displacement in the world, in the mesh's axes.
    fn displacement_in(&self, world: DVec3) -> DVec3 {
        self.whole.pose.matrix().transpose() * world
    }

    fn relative(&self, pose: &Pose) -> Pose {
        let to_local = self.whole.pose.unit_rotation().conjugate();
        Pose::new(to_local * (pose.position - self.whole.pose.position), to_local * pose.unit_rotation())
    }

    /// What the relative pose may be off by, at a form of the given reach.
    fn slack(&self, pose: &Pose, reach: f64) -> f64 {
        let way = (pose.position - self.whole.pose.position).length();
        tolerance::RELATIVE_POSE * (way + reach)
    }
}
