//! Concave forms in pairs: such a form is asked as its convex pieces, and its tree says which.
//!
//! # Method
//! A concave form offers its pieces by a box, along a path and nearest first ([`Concave`]); a piece of a compound may be
//! concave again. The other form's box is taken into the concave form's own frame, where its tree searches; a convex kernel
//! answers for each pair of pieces. Of two concave forms one is searched for pieces near the other's box, then each of those is
//! asked against the other. What may be first is gathered, and merged by intervals: certain answers bound, open ones only widen.
//!
//! Against a half space a compound is asked part by part; other forms have kernels of their own for that.
//!
//! A height field has an inside, which is asked by points ([`matter`]).
//!
//! A mesh is asked as its triangles. Of a solid one it is also asked whether it holds the other form ([`inside`]); which normals
//! the triangles have, and from which side they are felt, is told by [`facet`]. Most triangles that a search offers to a box, a
//! ball or a capsule are known not to touch it before a kernel is asked ([`rod`]).
//!
//! # Limits
//! A mesh that is not solid is a surface: what lies wholly inside a closed one does not touch it. Of two height fields the
//! contacts are those of pieces of the first one's skin, so one that lies wholly in the other has contacts only as the first.

mod concave;
mod distance;
mod facet;
mod impact;
mod inside;
mod instant;
mod matter;
mod overlap;
mod penetration;
mod rod;
mod stand_in;
mod sweep;

use glam::DVec3;

pub use self::stand_in::{PartsWanted, parts_wanted};
use self::{concave::Concave, facet::Facet, stand_in::StandIns};
pub(super) use self::{
    distance::distance,
    impact::{First, impact},
    instant::{is_felt_from_both_sides, touch_at},
    overlap::overlap,
    penetration::penetration,
};
use super::{
    Placed,
    convex::PlacedConvex,
    half_space::{self, Body},
    place::Place,
};
use crate::{
    answer::Feature,
    math::{Aabb, Pose},
    shape::{Convex, Form, Geometry, HalfSpace, MeshMode},
};

/// What a form is in a pair; a piece of a concave form is one too.
#[derive(Clone, Copy)]
enum Side<'a> {
    Convex(Piece<'a>),
    Concave(Concave<'a>),
    Space(Space<'a>),
}

/// A convex form, whole or one of the pieces of another.
#[derive(Clone, Copy)]
struct Piece<'a> {
    convex: &'a Convex,
    place: Place,
    /// Which piece it is.
    feature: Feature,
    /// It is a triangle of the skin of a body, whose corners go counter-clockwise seen from outside.
    skin: bool,
    /// The triangle, if it is one of a mesh.
    facet: Option<Facet<'a>>,
    /// It is one of the convex parts that stand in for a mesh.
    is_of_parts: bool,
}

/// A half space.
#[derive(Clone, Copy)]
struct Space<'a> {
    half_space: &'a HalfSpace,
    geometry: &'a Geometry,
    place: Place,
}

impl<'a> Piece<'a> {
    fn placed(&self) -> PlacedConvex<'_> {
        PlacedConvex { convex: self.convex, pose: &self.place.pose, blur: self.place.blur }
    }

    /// Whether it is a triangle of the surface of a body, so that what touches it may lie deeper in the body.
    fn bounds_matter(&self) -> bool {
        self.skin || self.facet.is_some_and(|facet| facet.mesh.mode() == MeshMode::Solid)
    }
}

impl<'a> Side<'a> {
    /// A geometry at a place; `part` is the number of its first leaf in the compound that it is part of.
    fn of(geometry: &'a Geometry, place: Place, part: Option<u32>) -> Self {
        match geometry.form() {
            Form::Convex(convex) => {
                let feature = Feature { part, face: None };
                Self::Convex(Piece { convex, place, feature, skin: false, facet: None, is_of_parts: false })
            }
            Form::Mesh(mesh) => Self::Concave(Concave::mesh(mesh, geometry, place, part)),
            Form::Compound(compound) => Self::Concave(Concave::compound(compound, geometry, place, part)),
            Form::HeightField(field) => Self::Concave(Concave::height_field(field, geometry, place, part)),
            Form::HalfSpace(half_space) => Self::Space(Space { half_space, geometry, place }),
        }
    }

    /// What stands in for it if it is a mesh of which something does; else itself.
    fn or_parts(&self, stand_ins: StandIns<'_>) -> Self {
        match self {
            Self::Concave(concave) => Self::Concave(concave.or_parts(stand_ins)),
            Self::Convex(_) | Self::Space(_) => *self,
        }
    }

    fn place(&self) -> &Place {
        match self {
            Self::Convex(piece) => &piece.place,
            Self::Concave(concave) => concave.place(),
            Self::Space(space) => &space.place,
        }
    }

    /// No point is farther from the local origin.
    fn reach(&self) -> f64 {
        match self {
            Self::Convex(piece) => piece.convex.reach(),
            Self::Concave(concave) => concave.geometry().reach(),
            Self::Space(space) => space.geometry.reach(),
        }
    }

    /// Its box in its own frame.
    fn local_bounds(&self) -> Aabb {
        match self {
            Self::Convex(piece) => piece.convex.local_bounds(),
            Self::Concave(concave) => concave.geometry().local_bounds(),
            Self::Space(space) => space.geometry.local_bounds(),
        }
    }

    /// Its box if it were at another pose.
    fn bounds_at(&self, pose: &Pose) -> Aabb {
        match self {
            Self::Convex(piece) => piece.convex.bounds(pose),
            Self::Concave(concave) => concave.geometry().bounds(pose),
            Self::Space(space) => space.geometry.bounds(pose),
        }
    }
}

/// Two forms in a fixed order, so that swapping them swaps the answer.
struct Ordered<'a> {
    first: Side<'a>,
    second: Side<'a>,
    is_swapped: bool,
    /// Both are placed as seen from this point of the world, in the world's axes.
    origin: DVec3,
}

impl<'a> Ordered<'a> {
    /// A convex form first, then of concave ones that of fewer pieces, then by content and pose; a half space last.
    fn new(a: Placed<'a>, b: Placed<'a>) -> Self {
        let at_home = |placed: Placed<'a>| Side::of(placed.geometry, Place::of(placed.pose), None);
        let is_swapped = match (a.geometry.form(), b.geometry.form()) {
            (Form::Convex(_), _) | (_, Form::HalfSpace(_)) => false,
            (_, Form::Convex(_)) | (Form::HalfSpace(_), _) => true,
            _ => match (at_home(a), at_home(b)) {
                (Side::Concave(a), Side::Concave(b)) => b.goes_before(&a),
                _ => false,
            },
        };
        let (first, second) = if is_swapped { (b, a) } else { (a, b) };
        let Some(compound) = [first, second].into_iter().find(Placed::is_compound) else {
            return Self { first: at_home(first), second: at_home(second), is_swapped, origin: DVec3::ZERO };
        };
        let origin = compound.pose.position;
        let seen = |placed: Placed<'a>| Side::of(placed.geometry, Place::seen_from(&placed.pose, origin), None);
        Self { first: seen(first), second: seen(second), is_swapped, origin }
    }
}

/// What is done with a pair of sides next.
enum Next<'s, 'a> {
    /// The kernel for two convex forms is asked.
    Ask(&'s Piece<'a>, &'s Piece<'a>),
    /// The kernel for a half space is asked.
    AskSpace(&'s Side<'a>, &'s Space<'a>),
    /// The first is taken apart.
    SplitFirst(&'s Concave<'a>, &'s Side<'a>),
    /// The second is.
    SplitSecond(&'s Side<'a>, &'s Concave<'a>),
}

/// The one rule of which side is taken apart: compounds before meshes before height fields, else the first if it can be.
#[inline]
fn next<'s, 'a>(first: &'s Side<'a>, second: &'s Side<'a>) -> Next<'s, 'a> {
    match (first, second) {
        (Side::Convex(a), Side::Convex(b)) => Next::Ask(a, b),
        (Side::Convex(_), Side::Concave(b)) => Next::SplitSecond(first, b),
        (Side::Concave(a), Side::Convex(_)) => Next::SplitFirst(a, second),
        (Side::Concave(a), Side::Concave(b)) if b.rank() < a.rank() => Next::SplitSecond(first, b),
        (Side::Concave(a), Side::Concave(_)) => Next::SplitFirst(a, second),
        (Side::Concave(a), Side::Space(_)) if a.body().is_none() => Next::SplitFirst(a, second),
        (Side::Convex(_) | Side::Concave(_), Side::Space(b)) => Next::AskSpace(first, b),
        (Side::Space(_), _) => {
            unreachable!("a half space is the second of a pair, and the first is a compound or of one")
        }
    }
}

impl<'a> Space<'a> {
    /// A form that is no compound, above this, and the number of the part that it is.
    fn below(&self, form: &Side<'a>) -> Option<(half_space::Pair<'a>, Feature)> {
        let (body, feature) = match form {
            Side::Convex(piece) => (Body::Convex(piece.convex), piece.feature),
            Side::Concave(concave) => (concave.body()?, concave.feature()),
            Side::Space(_) => return None,
        };
        let pair = half_space::Pair::of_leaf(body, (form.place(), form.reach()), (self.half_space, &self.place));
        Some((pair, feature))
    }
}
