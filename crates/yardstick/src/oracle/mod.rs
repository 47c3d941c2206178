//! A slow and obvious oracle: plain f64 formulas, every feature looked at, no tree and no iteration, and nothing taken
//! from the kernels it judges.

mod convex;
mod surface;

pub use convex::{separation_along, signed_distance_lower, support_height};
pub use surface::{distance_to_mesh, distance_to_triangle, nearest_on_mesh};

use glam::DVec3;

use crate::sets::{Form, Placed};

/// How far a point lies from the surface of a placed form, metres. For hulls of few points and everything else this
/// is a lower bound outside, and exact inside; for larger hulls 0 is answered for all points inside the hull's box.
#[must_use]
pub fn distance_to_surface(placed: &Placed, point: DVec3) -> f64 {
    match &placed.form {
        Form::Mesh(mesh) => distance_to_mesh(mesh, &placed.pose, point),
        _ => signed_distance_lower(placed, point).abs(),
    }
}
