//! One question to one pair of convex forms.
//!
//! # Method
//! Each form is a core (a polytope) and a radius. The cores are taken into the pair's own frame ([`frame`]); GJK
//! ([`gjk`]) measures their gap; only where the cores themselves overlap do separating axes ([`axes`]) measure the
//! depth. Radii stay outside of both, so round forms are as exact as polytopes.
//!
//! Arguments are put in a fixed order first (kind, content, pose), so that swapping them swaps the answer bit by bit.

mod along;
mod axes;
mod balls;
mod body;
mod boxes;
mod cast;
mod contact;
mod depth;
mod directions;
mod ellipsoid;
mod epa;
mod facing;
mod formula;
mod frame;
mod gjk;
mod impact;
mod inscribed;
mod manifold;
mod motion;
mod nested;
mod newest;
mod order;
mod orientation;
mod overlapping;
mod portal;
mod revolved;
mod rods;
mod separation;
mod simplex;
mod slide;
mod standing;
mod straight;
mod touch;
mod turning;
mod warm;

use crate::{math::Pose, shape::Convex};

pub use warm::Warm;

pub(crate) use along::{Ruling, penetration_ruled};
pub(crate) use contact::{depth, penetration, penetration_warm};
pub(crate) use impact::impact;
pub(crate) use separation::{distance, distance_warm, overlap, within};
pub(super) use standing::{feet, lowest};

/// A convex form at a pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedConvex<'a> {
    /// The form.
    pub(crate) convex: &'a Convex,
    /// Where it is.
    pub(crate) pose: &'a Pose,
    /// No point of it is farther than this from where the pose puts it, metres: 0 where that is known as it was sent.
    pub(crate) blur: f64,
}

impl<'a> PlacedConvex<'a> {
    /// A form at a pose that is known as it was sent.
    pub(crate) fn new(convex: &'a Convex, pose: &'a Pose) -> Self {
        Self { convex, pose, blur: 0.0 }
    }
}
