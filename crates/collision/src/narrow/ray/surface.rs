//! What the search of a ray through triangles needs to know of them.

use glam::DVec3;

use super::triangle;
use crate::{
    broad::{StaticTree, Tree},
    math::Ball,
    shape::{HeightField, Mesh},
};

/// Triangles that a tree finds.
pub(super) trait Surface {
    /// The tree.
    type Tree: Tree;

    /// Holds all of it, local frame.
    fn ball(&self) -> Ball;

    /// Its leaves are triangles.
    fn tree(&self) -> &Self::Tree;

    /// In order.
    fn corners(&self, leaf: usize) -> [DVec3; 3];

    /// The number of a triangle as it is told.
    fn face(&self, leaf: usize) -> u32;

    /// The one triangle beyond a side, and whether its corners go along that side the same way.
    fn across(&self, leaf: usize, side: usize) -> Option<(usize, bool)>;

    /// The weights of the corners that are told of a touch.
    fn weights(corners: [DVec3; 3], point: DVec3) -> Option<DVec3>;
}

impl Surface for Mesh {
    type Tree = StaticTree;

    fn ball(&self) -> Ball {
        self.ball()
    }

    fn tree(&self) -> &StaticTree {
        self.tree()
    }

    fn corners(&self, leaf: usize) -> [DVec3; 3] {
        self.corners(leaf)
    }

    fn face(&self, leaf: usize) -> u32 {
        self.sent_number(leaf)
    }

    fn across(&self, leaf: usize, side: usize) -> Option<(usize, bool)> {
        let mut others = self.adjacency().across(leaf, side);
        let (other, side_of_other) = others.next()?;
        let is_same_way = self.triangles()[leaf][side] == self.triangles()[other][side_of_other];
        others.next().is_none().then_some((other, is_same_way))
    }

    #[inline(always)]
    fn weights(corners: [DVec3; 3], point: DVec3) -> Option<DVec3> {
        triangle::weights(corners, point)
    }
}

impl Surface for HeightField {
    type Tree = Self;

    fn ball(&self) -> Ball {
        self.ball()
    }

    fn tree(&self) -> &Self {
        self
    }

    fn corners(&self, leaf: usize) -> [DVec3; 3] {
        self.corners(leaf)
    }

    fn face(&self, leaf: usize) -> u32 {
        Self::cell_of(leaf) as u32
    }

    fn across(&self, leaf: usize, side: usize) -> Option<(usize, bool)> {
        Some((self.across(leaf, side)?, false))
    }

    /// A cell has two triangles and more, which are not told apart.
    fn weights(_: [DVec3; 3], _: DVec3) -> Option<DVec3> {
        None
    }
}
