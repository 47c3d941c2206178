//! A tree over boxes that do not change: built whole, searched often.
//!
//! # Method
//! The nodes are those of the tree that changes, in a vector of their own.
//!
//! Tried: nodes with their boxes in bytes, on a grid of their own with steps that are powers of two, rounded outwards, in 112 bytes
//! instead of 256. Such trees hold 20 bytes for each box instead of 45, but a search has to make numbers of the bytes first. With four
//! lanes to an instruction that takes more than fewer cache lines save while the nodes are in the second cache: rays took 1.2 times as
//! long among 1,000 boxes and on meshes, 1.13 times among 10,000, and as long from 100,000 on; overlaps 1.35 and 1.05 times. With
//! instructions of newer processors it is the same. Figures: `benches/README.md`.
//!
//! # Source
//! For the bytes: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017.

use super::{
    build::{Built, build},
    forest::{Forest, Large, Rooted},
    item::Item,
    levels::{NodeBox, node_boxes},
    node::Node,
    traverse::ALL_LAYERS,
};
use crate::math::Aabb;

/// A tree over boxes that do not change. A leaf number is the index of a box in the slice it was built from.
#[derive(Clone, Debug, Default)]
pub struct StaticTree {
    forest: Forest<Vec<Node>>,
    len: usize,
    depth: u32,
}

impl StaticTree {
    /// Builds a tree over `boxes`, fewer than 2²⁸ of them, with finite corners. About 0.15 µs a box.
    ///
    /// # Panics
    /// If there are 2²⁸ boxes or more.
    #[must_use]
    pub fn build(boxes: &[Aabb]) -> Self {
        Self::build_on_layers(boxes.iter().map(|bounds| (*bounds, ALL_LAYERS)))
    }

    /// As [`StaticTree::build`], with the layers of each box. Holds 32 bytes a box beside the nodes meanwhile, and goes through the
    /// boxes twice.
    ///
    /// # Panics
    /// If there are 2²⁸ boxes or more.
    #[must_use]
    pub fn build_on_layers(boxes: impl ExactSizeIterator<Item = (Aabb, u32)> + Clone) -> Self {
        assert_fits(boxes.len());
        let mut forest = Forest::default();
        let items = forest.distribute(boxes.enumerate().map(numbered));
        Self::of_items(forest, items)
    }

    /// As [`StaticTree::build`], of boxes that lie within `bounds`. Holds 32 bytes a box beside the nodes meanwhile, and goes through
    /// the boxes once, unless `bounds` is enormous.
    ///
    /// # Panics
    /// If there are 2²⁸ boxes or more.
    #[must_use]
    pub fn build_within(bounds: Aabb, boxes: impl ExactSizeIterator<Item = Aabb> + Clone) -> Self {
        assert_fits(boxes.len());
        let mut forest = Forest::default();
        let items =
            forest.distribute_within(bounds, boxes.map(|bounds| (bounds, ALL_LAYERS)).enumerate().map(numbered));
        Self::of_items(forest, items)
    }

    /// A tree over the items of each cell of a forest that has no nodes yet.
    fn of_items(forest: Forest<Vec<Node>>, items: Vec<Vec<Item>>) -> Self {
        let len = items.iter().map(Vec::len).sum::<usize>() + forest.large.len();
        let mut tree = Self { forest, len, depth: 0 };
        for (cell, mut items) in items.into_iter().enumerate() {
            if !items.is_empty() {
                let built = build(&mut items);
                drop(items);
                tree.depth = tree.depth.max(built.depth);
                tree.adopt(cell, built);
            }
        }
        tree
    }

    fn adopt(&mut self, cell: usize, built: Built) {
        let base = self.forest.nodes.len() as u32;
        if base == 0 {
            self.forest.nodes = built.nodes;
            self.forest.nodes.shrink_to_fit();
            self.forest.set_root(cell, base);
            return;
        }
        self.forest.nodes.reserve_exact(built.nodes.len());
        self.forest.nodes.extend(built.nodes.into_iter().map(|mut node| {
            node.renumber(|index| base + index);
            node
        }));
        self.forest.set_root(cell, base);
    }

    /// How many boxes it was built from.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether it was built from none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Levels, the root's being the first; at most 3 + 1.5 log₂ of the number of boxes.
    #[must_use]
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// The boxes of its nodes and leaves down to a level, level by level, at most so many; for those who draw them. The
    /// boxes of all are level 0, one for each part of the world that has an origin of its own.
    #[must_use]
    pub fn node_boxes(&self, level_max: u32, count_max: usize) -> Vec<NodeBox> {
        node_boxes(self, level_max, count_max)
    }

    /// Its cost by the surface-area heuristic, m²: the half areas of all boxes in all nodes. Compares with
    /// [`super::DynamicTree::area_sum`].
    #[must_use]
    pub fn area_sum(&self) -> f64 {
        self.forest.nodes.iter().map(Node::area_sum).sum()
    }

    /// Bytes it holds in memory.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        let nodes = self.forest.nodes.capacity() * size_of::<Node>();
        size_of::<Self>() as u64 + nodes as u64 + self.forest.list_bytes()
    }
}

fn assert_fits(len: usize) {
    assert!(len < 1 << 28, "fewer than 2^28 boxes");
}

/// A leaf for a box of a slice.
#[inline]
fn numbered((index, (bounds, layers)): (usize, (Aabb, u32))) -> Large {
    Large { leaf: index as u32, bounds, layers }
}

impl Rooted for StaticTree {
    type Nodes = Vec<Node>;

    fn forest(&self) -> &Forest<Vec<Node>> {
        &self.forest
    }

    fn waiting(&self) -> &[Large] {
        &[]
    }
}
