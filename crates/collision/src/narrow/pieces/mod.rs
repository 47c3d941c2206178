//! Concave forms in pairs: such a form is asked as its convex pieces, and its tree says which.
//!
//! # Method
//! A concave form offers its pieces by a box, along a path and nearest first ([`Concave`]). The other form's box is taken into
//! the concave form's own frame, where its tree searches; a convex kernel answers for each piece. Of two concave forms one
//! is searched for pieces near the other's box, then each of those is asked against the other. What may be first is gathered,
//! and merged by intervals: certain answers bound, open ones only widen.
//!
//! # Limits
//! A mesh is a surface: what lies wholly inside a closed one does not touch it.

mod concave;
mod distance;
mod impact;
mod overlap;
mod penetration;
mod sweep;

use self::concave::Concave;
pub(super) use self::{
    distance::distance,
    impact::{First, impact},
    overlap::overlap,
    penetration::penetration,
};
use super::{Placed, convex::PlacedConvex};
use crate::{
    answer::Feature,
    math::{Aabb, Pose},
    shape::Form,
};

/// What a form is in a pair; a piece of a concave form is one too.
#[derive(Clone, Copy)]
enum Side<'a> {
    Convex(Piece<'a>),
    Concave(Concave<'a>),
}

/// A convex form, whole or one of the pieces of another.
#[derive(Clone, Copy)]
struct Piece<'a> {
    placed: PlacedConvex<'a>,
    /// Which piece it is.
    feature: Feature,
}

impl<'a> Side<'a> {
    fn of(placed: Placed<'a>) -> Self {
        match placed.geometry.form() {
            Form::Convex(convex) => {
                Self::Convex(Piece { placed: PlacedConvex { convex, pose: placed.pose }, feature: Feature::default() })
            }
            Form::Mesh(mesh) => Self::Concave(Concave::mesh(mesh, placed)),
            Form::HalfSpace(_) => unreachable!("half spaces have kernels of their own"),
        }
    }

    fn pose(&self) -> &Pose {
        match self {
            Self::Convex(piece) => &piece.placed.pose,
            Self::Concave(concave) => concave.pose(),
        }
    }

    /// No point is farther from the local origin.
    fn reach(&self) -> f64 {
        match self {
            Self::Convex(piece) => piece.placed.convex.reach(),
            Self::Concave(concave) => concave.geometry().reach(),
        }
    }

    /// Its box in its own frame.
    fn local_bounds(&self) -> Aabb {
        match self {
            Self::Convex(piece) => piece.placed.convex.local_bounds(),
            Self::Concave(concave) => concave.geometry().local_bounds(),
        }
    }

    /// Its box if it were at another pose.
    fn bounds_at(&self, pose: &Pose) -> Aabb {
        match self {
            Self::Convex(piece) => piece.placed.convex.bounds(pose),
            Self::Concave(concave) => concave.geometry().bounds(pose),
        }
    }
}

/// The two in a fixed order, so that swapping them swaps the answer, and whether they were swapped for it: a convex form
/// first, of two concave ones that of fewer pieces, then by content and pose.
fn in_order<'a>(a: Side<'a>, b: Side<'a>) -> (Side<'a>, Side<'a>, bool) {
    let is_swapped = match (&a, &b) {
        (Side::Convex(_), _) => false,
        (Side::Concave(_), Side::Convex(_)) => true,
        (Side::Concave(a), Side::Concave(b)) => b.order_key() < a.order_key(),
    };
    if is_swapped { (b, a, true) } else { (a, b, false) }
}

/// What is done with a pair of sides next.
enum Next<'a> {
    /// A kernel is asked.
    Ask(Piece<'a>, Piece<'a>),
    /// The first is taken apart.
    SplitFirst(Concave<'a>, Side<'a>),
    /// The second is.
    SplitSecond(Side<'a>, Concave<'a>),
}

/// The one rule of which side is taken apart.
fn next<'a>(a: Side<'a>, b: Side<'a>) -> Next<'a> {
    match (a, b) {
        (Side::Convex(a), Side::Convex(b)) => Next::Ask(a, b),
        (Side::Concave(a), b) => Next::SplitFirst(a, b),
        (a, Side::Concave(b)) => Next::SplitSecond(a, b),
    }
}
