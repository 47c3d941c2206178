//! A slow and obvious oracle, which takes nothing from the kernels it judges.
//!
//! # Map
//! [`Truth`] is the signed distance of two convex forms to 32 digits, with bounds of its own, [`stretch_inside`] the stretch of
//! a line in one. [`Place`] says where a form is at a time of its motion: [`meeting`] is the first touch of two that do not turn,
//! [`look_for_overlap`] looks for one of two that do. [`Union`] is a concave form as its convex pieces. The rest are plain f64 formulas for the conformance runner: every feature looked at, no tree and no iteration.

mod apart;
mod convex;
mod double;
mod form;
mod frame;
mod gap;
mod inside;
mod line;
mod meeting;
mod place;
mod plane;
mod polytope;
mod space;
mod surface;
mod truth;
mod turning;
mod union;
mod winding;

pub use double::{Double, Number};
pub use form::{Core, PlacedSolid, Solid, length, scale};
pub use line::{Inside, stretch_inside, stretch_inside_part};
pub use meeting::{Meeting, meeting};
pub use place::Place;
pub use truth::Truth;
pub use turning::{Sighting, look_for_overlap};
pub use union::{Piece, Union};
pub use winding::winding_number;

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
