//! The kernels' answers to a question, with the arguments in both orders.

use std::panic::{AssertUnwindSafe, catch_unwind};

use collision::{
    answer::{Certificate, Work},
    math::Pose,
    narrow::{self, Contact, NeedsDecomposition, Placed, Separation, Warm},
    shape::{Geometry, GeometryError},
};

use super::pairs::Question;
use crate::oracle::{Core, PlacedSolid, Solid};

/// What the kernels say of a pair.
#[derive(Clone, Debug)]
pub struct Answers {
    /// `None`: farther apart than the limit.
    pub distance: Option<Separation>,
    /// Whether they overlap.
    pub overlap: Certificate,
    /// `None`: farther apart than the greatest gap asked.
    pub contact: Option<Contact>,
    /// Distance and contact again, from where the pair stood before.
    pub warm: Option<Warmed>,
}

/// What is said of a pair that has been asked about at other poses before.
#[derive(Clone, Debug)]
pub struct Warmed {
    /// As in [`Answers`].
    pub distance: Option<Separation>,
    /// As in [`Answers`].
    pub contact: Option<Contact>,
}

/// The crate's form.
pub(super) fn geometry(solid: &Solid) -> Result<Geometry, GeometryError> {
    let rounded = |geometry: Geometry| if solid.radius == 0.0 { Ok(geometry) } else { geometry.rounded(solid.radius) };
    match &solid.core {
        Core::Point if solid.radius == 0.0 => Ok(Geometry::point()),
        Core::Point => Geometry::sphere(solid.radius),
        Core::Segment { half_height } => Geometry::capsule(*half_height, solid.radius),
        Core::Cuboid { half_extents } => rounded(Geometry::cuboid(*half_extents)?),
        Core::Hull(points) => rounded(Geometry::hull(points)?),
        Core::Cylinder { half_height, radius } => rounded(Geometry::cylinder(*half_height, *radius)?),
        Core::Cone { half_height, radius } => rounded(Geometry::cone(*half_height, *radius)?),
        Core::HalfSpace { normal, offset } => Geometry::half_space(*normal, *offset),
        Core::Ellipsoid { radii } => rounded(Geometry::ellipsoid(*radii)?),
    }
}

pub(super) fn pose(placed: &PlacedSolid) -> Pose {
    Pose::new(placed.position, placed.rotation)
}

/// Why there is nothing to judge.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Unasked {
    /// The form is refused: the pair is none of ours.
    Refused(String),
    /// A kernel panicked.
    Panicked,
}

/// Both orders of the arguments: as they are, and swapped.
pub(super) fn ask(question: &Question) -> Result<[Answers; 2], Unasked> {
    let refused = |error: GeometryError| Unasked::Refused(error.to_string());
    let a = geometry(&question.a.solid).map_err(refused)?;
    let b = geometry(&question.b.solid).map_err(refused)?;
    let a = Placed { geometry: &a, pose: pose(&question.a) };
    let b = Placed { geometry: &b, pose: pose(&question.b) };
    let both = || {
        let there = one_order(question, a, b)?;
        let warm = Some(warmed(question, a, b)?);
        Ok([Answers { warm, ..there }, one_order(question, b, a)?])
    };
    let answered: Result<[Answers; 2], NeedsDecomposition> =
        catch_unwind(AssertUnwindSafe(both)).map_err(|_| Unasked::Panicked)?;
    answered.map_err(|error| Unasked::Refused(error.to_string()))
}

fn one_order(question: &Question, a: Placed<'_>, b: Placed<'_>) -> Result<Answers, NeedsDecomposition> {
    let (accuracy, work) = (&question.accuracy, &mut Work::default());
    Ok(Answers {
        distance: narrow::distance(a, b, question.limit, accuracy, work),
        overlap: narrow::overlap(a, b, accuracy, work),
        contact: narrow::penetration(a, b, question.max_gap, accuracy, work)?.into_iter().next(),
        warm: None,
    })
}

/// Two questions at the pose before warm what is remembered; then the ones that are judged.
fn warmed(question: &Question, a: Placed<'_>, b: Placed<'_>) -> Result<Warmed, NeedsDecomposition> {
    let (accuracy, work) = (&question.accuracy, &mut Work::default());
    let before = Placed { pose: Pose::new(question.before.0, question.before.1), ..b };
    let (mut of_distance, mut of_contact) = (Warm::default(), Warm::default());
    narrow::distance_warm(a, before, f64::INFINITY, accuracy, &mut of_distance, work);
    narrow::penetration_warm(a, before, question.max_gap, accuracy, &mut of_contact, work)?;
    Ok(Warmed {
        distance: narrow::distance_warm(a, b, question.limit, accuracy, &mut of_distance, work),
        contact: narrow::penetration_warm(a, b, question.max_gap, accuracy, &mut of_contact, work)?.into_iter().next(),
    })
}
