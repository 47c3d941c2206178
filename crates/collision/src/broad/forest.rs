//! What the searches see of a tree: cells, each with nodes around an origin of its own, and a few enormous boxes beside them.
//!
//! # Method
//! The boxes of nodes are f32 numbers relative to the origin of their cell, so a cell reaches [`CELL_REACH`] to each side of
//! it: nearly all worlds are one cell. There are [`CELLS_MAX`] at most, the last of which takes whatever has no place in
//! the others, as coarsely as f32 sees it from the world's origin. Boxes larger than a cell are listed, the first
//! [`LARGE_MAX`] of them, so that a ground plane does not spoil the tree; more go into the tree.
//!
//! # Limits
//! In a world of more than 63 crowded places that are more than 131 km from each other, the crowds beyond are searched as if
//! their boxes were larger by up to 6e-8 of their coordinates. Answers do not depend on it.

use glam::DVec3;

use super::{
    item::Item,
    local::LocalBox,
    node::{NO_NODE, Node},
};
use crate::{math::Aabb, pages::Pages};

/// How far from its origin the centres of a cell's boxes lie, metres in each axis: f32 resolves 8 mm there. Larger is
/// coarser, smaller makes more cells of a world.
const CELL_REACH: f64 = 131_072.0;
/// Cells of a tree at most.
const CELLS_MAX: usize = 64;
/// Boxes of this extent or more are enormous, metres.
const LARGE_EXTENT: f64 = CELL_REACH;
/// Enormous boxes that are listed, at most; each is tested in every search.
const LARGE_MAX: usize = 64;

/// Where nodes are kept.
pub(super) trait Nodes {
    /// A node.
    fn node(&self, index: u32) -> &Node;
}

impl Nodes for Pages<Node, 32> {
    fn node(&self, index: u32) -> &Node {
        &self[index as usize]
    }
}

impl Nodes for Vec<Node> {
    fn node(&self, index: u32) -> &Node {
        &self[index as usize]
    }
}

/// What the searches see of a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Forest<N> {
    pub(super) nodes: N,
    pub(super) cells: Vec<Cell>,
    pub(super) large: Vec<Large>,
}

/// A tree, as the searches see it.
pub(super) trait Rooted {
    type Nodes: Nodes;

    /// Its nodes.
    fn forest(&self) -> &Forest<Self::Nodes>;

    /// Leaves that have no place in the nodes yet.
    fn waiting(&self) -> &[Large];

    /// Leaves that are looked at one by one.
    fn listed(&self) -> impl Iterator<Item = &Large> {
        self.forest().large.iter().chain(self.waiting())
    }

    /// Those of them that are on one of the layers.
    fn listed_on(&self, layers: u32) -> impl Iterator<Item = &Large> {
        self.listed().filter(move |large| large.layers & layers != 0)
    }
}

/// A part of the world with an origin of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) origin: DVec3,
    /// `NO_NODE` while there are none.
    pub(super) root: u32,
    /// Holds everything in it; of no account while there is no root.
    pub(super) bounds: Aabb,
    /// Leaves that belong to it; without any, its place may be used for another cell.
    pub(super) leaf_count: u32,
}

/// A box too large for a tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Large {
    pub(super) leaf: u32,
    pub(super) bounds: Aabb,
    pub(super) layers: u32,
}

/// Where a box belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Home {
    /// Among the enormous ones.
    Large,
    /// In this cell.
    Cell(u32),
}

impl<N> Forest<N> {
    /// Where a box belongs. It is counted there, in a cell that is begun for it if need be.
    pub(super) fn settle_in(&mut self, bounds: Aabb) -> Home {
        if self.large.len() < LARGE_MAX && is_large(bounds) {
            return Home::Large;
        }
        let cell = self.cell_for(bounds.center());
        self.cells[cell].leaf_count += 1;
        Home::Cell(cell as u32)
    }

    fn cell_for(&mut self, center: DVec3) -> usize {
        if let Some(index) = self.cells.iter().position(|cell| cell.leaf_count > 0 && cell.reaches(center)) {
            return index;
        }
        let unused = self.cells.iter().take(CELLS_MAX - 1).position(|cell| cell.leaf_count == 0);
        let index = unused.unwrap_or(self.cells.len().min(CELLS_MAX - 1));
        if index == self.cells.len() {
            self.cells.push(Cell::new(DVec3::ZERO));
        }
        if index < CELLS_MAX - 1 {
            self.cells[index].origin = center;
        }
        index
    }

    /// Bytes of the lists beside the nodes.
    pub(super) fn list_bytes(&self) -> u64 {
        (self.cells.capacity() * size_of::<Cell>() + self.large.capacity() * size_of::<Large>()) as u64
    }

    /// Whether a box that belongs to a cell still does when it is this.
    pub(super) fn stays(&self, cell: u32, bounds: Aabb) -> bool {
        cell as usize == CELLS_MAX - 1 || (!is_large(bounds) && self.cells[cell as usize].reaches(bounds.center()))
    }

    /// Gives every box a home, in a forest that is empty: the enormous ones in its list, the others in cells, whose items are
    /// returned. If one cell is enough, its origin is the middle of all.
    /// The boxes are gone through twice, rather than kept: of a large mesh they are more than its tree.
    pub(super) fn distribute(&mut self, boxes: impl ExactSizeIterator<Item = Large> + Clone) -> Vec<Vec<Item>> {
        let centers = boxes.clone().filter(|large| !is_large(large.bounds)).map(|large| large.bounds.center());
        let centers = centers.map(|center| Aabb::new(center, center)).reduce(Aabb::union);
        self.cells.clear();
        self.cells.extend(centers.map(|centers| Cell { leaf_count: 1, ..Cell::new(centers.center()) }));
        let items = self.assign(boxes);
        if let Some(first) = self.cells.first_mut() {
            first.leaf_count -= 1;
        }
        items
    }

    /// As [`Forest::distribute`], of boxes that lie within a box, which are gone through once where that is not enormous.
    pub(super) fn distribute_within(
        &mut self,
        bounds: Aabb,
        boxes: impl ExactSizeIterator<Item = Large> + Clone,
    ) -> Vec<Vec<Item>> {
        if is_large(bounds) {
            return self.distribute(boxes);
        }
        let origin = bounds.center();
        self.cells.clear();
        self.cells.push(Cell { leaf_count: boxes.len() as u32, ..Cell::new(origin) });
        let item = |large: Large| Item::new(LocalBox::around(large.bounds, origin), large.leaf, large.layers);
        vec![boxes.map(item).collect()]
    }

    /// Gives every box a home and returns the items of each cell.
    pub(super) fn assign(&mut self, boxes: impl ExactSizeIterator<Item = Large>) -> Vec<Vec<Item>> {
        let mut items: Vec<Vec<Item>> = Vec::new();
        let count = boxes.len();
        for (at, large) in boxes.enumerate() {
            match self.settle_in(large.bounds) {
                Home::Large => self.large.push(large),
                Home::Cell(cell) => {
                    let (cell, Large { leaf, bounds, layers }) = (cell as usize, large);
                    if items.len() <= cell {
                        items.resize_with(cell + 1, Vec::new);
                        // Mostly all that is left goes into one cell.
                        items[cell].reserve(count - at);
                    }
                    let bounds = LocalBox::around(bounds, self.cells[cell].origin);
                    items[cell].push(Item::new(bounds, leaf, layers));
                }
            }
        }
        items
    }
}

impl<N: Nodes> Forest<N> {
    /// Notes the root of a cell, or that it has changed.
    pub(super) fn set_root(&mut self, cell: usize, root: u32) {
        self.cells[cell].root = root;
        self.set_bounds(cell, self.nodes.node(root).bounds());
    }

    /// Notes the box of the root of a cell.
    pub(super) fn set_bounds(&mut self, cell: usize, bounds: LocalBox) {
        let cell = &mut self.cells[cell];
        cell.bounds = bounds.in_world(cell.origin);
    }
}

fn is_large(bounds: Aabb) -> bool {
    (bounds.max - bounds.min).max_element() >= LARGE_EXTENT
}

impl Cell {
    fn new(origin: DVec3) -> Self {
        Self { origin, root: NO_NODE, bounds: Aabb::new(origin, origin), leaf_count: 0 }
    }

    fn reaches(&self, center: DVec3) -> bool {
        (center - self.origin).abs().max_element() <= CELL_REACH
    }
}
