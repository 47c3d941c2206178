//! What a pair of forms remembers from one question to the next.
//!
//! # Method
//! The corners whose difference was nearest to the origin are named by their numbers; at the next question they are put
//! where they are then, and the search goes on from there. Round cores have no numbered corners: they remember the
//! direction. The start changes the work, and within the reported interval the last digits, so it is an explicit argument
//! and a cold question never looks at it.
//!
//! # Source
//! Cameron, "Enhancing GJK: computing minimum and penetration distances between convex polyhedra" (1997), section 3.

use glam::DVec3;

use super::{
    frame::Pair,
    gjk::{self, Gap},
    simplex::{Simplex, Vertex},
};
use crate::{accuracy::Accuracy, math::Pose, narrow::Contact};

/// What a pair of forms remembers: keep one for each pair of shapes, and drop it when a form of the pair changes. A new one
/// knows nothing, and answers are then those of the cold question.
///
/// Poses may change as they like. Where they have not, the contact is returned as it was, to the last bit; where they have,
/// the search starts from the features that were nearest, and its interval is as certain as a cold one.
#[derive(Clone, Debug, Default)]
pub struct Warm {
    seed: Option<Seed>,
    /// The order of the arguments in which the seed was found.
    is_swapped: bool,
    /// Apart, so that those who only ask for distances do not carry its memory about.
    contact: Option<Box<(Resting, Option<Contact>)>>,
}

/// A question about a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Resting {
    pub(super) poses: [Pose; 2],
    pub(super) max_gap: f64,
    pub(super) accuracy: Accuracy,
}

impl Warm {
    /// What was found for the very same question; `None` if that was another.
    pub(super) fn contact_at(&self, question: &Resting) -> Option<&Option<Contact>> {
        self.contact.as_deref().filter(|(asked, _)| asked == question).map(|(_, contact)| contact)
    }

    pub(super) fn rest(&mut self, question: Resting, contact: Option<Contact>) {
        match &mut self.contact {
            Some(kept) => **kept = (question, contact),
            None => self.contact = Some(Box::new((question, contact))),
        }
    }

    /// Where to begin, and where to leave what was found; the arguments' order belongs to it. What is to be asked again is
    /// searched from the first time on, since a search leaves more to begin with than axes do.
    pub(super) fn seed(&mut self, is_swapped: bool) -> &mut Option<Seed> {
        if self.seed.is_none() || self.is_swapped != is_swapped {
            self.seed = Some(Seed::NOTHING);
            self.is_swapped = is_swapped;
        }
        &mut self.seed
    }
}

/// Where a search begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seed {
    corners: [[u32; 2]; 4],
    count: usize,
    /// Unit vector from `b` to `a` in the pair's frame; 0 where none is known.
    normal: DVec3,
}

impl Seed {
    /// Where nothing is known.
    pub(super) const NOTHING: Self = Self { corners: [[0; 2]; 4], count: 0, normal: DVec3::ZERO };

    /// What a search ended with.
    pub(super) fn of(gap: &Gap) -> Self {
        Self::at(&gap.simplex, gap.normal)
    }

    /// The corners of a simplex, and the direction of a plane, for cores that have none.
    pub(super) fn at(simplex: &Simplex, normal: DVec3) -> Self {
        let mut corners = [[0; 2]; 4];
        let vertices = simplex.vertices();
        for (slot, vertex) in corners.iter_mut().zip(vertices) {
            *slot = vertex.corners;
        }
        Self { corners, count: vertices.len(), normal }
    }

    /// The three corners of polytopes that were nearest, where they are at the pair's present pose; `None` if those were not
    /// three.
    pub(super) fn triangle(&self, pair: &Pair<'_>) -> Option<[DVec3; 3]> {
        (self.count == 3).then(|| [0, 1, 2].map(|i: usize| vertex(pair, self.corners[i]).point))
    }

    /// Whether something useful is known: corners that the pair has, or a direction.
    #[inline(always)]
    pub(super) fn is_known_to(&self, pair: &Pair<'_>) -> bool {
        self.has_corners_of(pair) || self.normal != DVec3::ZERO
    }

    #[inline(always)]
    fn has_corners_of(&self, pair: &Pair<'_>) -> bool {
        let [of_a, of_b] = [&pair.a, &pair.b].map(|body| body.corner_count().unwrap_or(0));
        let known = self.known();
        !known.is_empty() && known.iter().all(|&[on_a, on_b]| (on_a as usize) < of_a && (on_b as usize) < of_b)
    }

    #[inline(always)]
    fn known(&self) -> &[[u32; 2]] {
        &self.corners[..self.count.min(4)]
    }

    /// The simplex to begin with at the pair's present pose, where [`Seed::is_known_to`] says that there is one.
    #[inline(always)]
    pub(super) fn simplex(&self, pair: &Pair<'_>) -> Simplex {
        if !self.has_corners_of(pair) {
            return Simplex::of(gjk::support(pair, self.normal));
        }
        let mut simplex = Simplex::of(vertex(pair, self.corners[0]));
        for &corners in &self.known()[1..] {
            simplex.push(vertex(pair, corners));
        }
        simplex.settle();
        simplex
    }
}

#[inline(always)]
fn vertex(pair: &Pair<'_>, [on_a, on_b]: [u32; 2]) -> Vertex {
    Vertex::new(pair.a.corner(on_a), pair.b.corner(on_b))
}
