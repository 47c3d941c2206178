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
    body::Body,
    frame::Pair,
    gjk::{self, Gap},
    simplex::{Simplex, Vertex},
};

/// Where a search begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seed {
    corners: [[u32; 2]; 4],
    count: usize,
    /// Unit vector from `b` to `a` in the pair's frame; 0 where none is known.
    normal: DVec3,
}

impl Seed {
    /// What a search ended with.
    pub(super) fn of(gap: &Gap) -> Self {
        let mut corners = [[0; 2]; 4];
        let vertices = gap.simplex.vertices();
        for (slot, vertex) in corners.iter_mut().zip(vertices) {
            *slot = [vertex.on_a.index, vertex.on_b.index];
        }
        Self { corners, count: vertices.len(), normal: gap.normal }
    }

    /// The simplex to begin with at the pair's present pose; `None` if nothing useful is known.
    pub(super) fn simplex(&self, pair: &Pair<'_>) -> Option<Simplex> {
        let in_range =
            |body: &Body<'_>, corner: u32| body.corner_count().is_some_and(|count| (corner as usize) < count);
        let known = &self.corners[..self.count.min(4)];
        if !known.is_empty() && known.iter().all(|&[on_a, on_b]| in_range(&pair.a, on_a) && in_range(&pair.b, on_b)) {
            let vertex = |&[on_a, on_b]: &[u32; 2]| Vertex::new(pair.a.corner(on_a), pair.b.corner(on_b));
            let mut vertices = [vertex(&known[0]); 4];
            for (slot, corners) in vertices.iter_mut().zip(known) {
                *slot = vertex(corners);
            }
            return Simplex::nearest_of(&vertices[..known.len()]);
        }
        (self.normal != DVec3::ZERO).then(|| Simplex::of(gjk::support(pair, self.normal)))
    }
}
