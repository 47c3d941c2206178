//! A tree over boxes that come, move and go, and that its clones share until one of them writes.
//!
//! # Method
//! Leaves are kept in *fat* boxes, so that small moves change nothing. A box that left its fat one is changed in place
//! where the node it is in does not grow by much, else it is taken out and put in anew: see `dynamic/links.rs`. What is
//! inserted waits until the batch is over ([`DynamicTree::settle`]): many at once are worth building their cell anew, by the
//! builder of static trees, few are put in one at a time. Searches see what waits as well. What moves spoil is mended bit by
//! bit: see `dynamic/tend.rs`. In large trees a change mostly waits for memory, which [`DynamicTree::read_ahead`] asks for in time.
//!
//! The heuristic alone makes chains of boxes that lie in each other, as tall as they are many. A leaf that comes to lie too
//! deep has the lowest subtree that is too deep for its size built anew, so the depth is at most 4 + 2 log₂ of the most
//! leaves there were, and that costs a logarithm of it for each leaf put in (a scapegoat tree).
//!
//! # Source
//! Catto, "Dynamic Bounding Volume Hierarchies", GDC 2019 (fat boxes, descent by the heuristic); Galperin and Rivest,
//! "Scapegoat Trees", SODA 1993.

mod ahead;
mod check;
mod links;
mod tend;

use super::{
    forest::{Forest, Large, Rooted},
    item::Item,
    levels::{NodeBox, node_boxes},
    local::LocalBox,
    node::{LANES, NO_NODE, Node, Target},
};
use crate::{math::Aabb, pages::Pages};
use links::ROOT;

/// A tree over boxes that come, move and go. Cloning it shares all nodes.
#[derive(Clone, Debug, Default)]
pub struct DynamicTree {
    forest: Forest<Pages<Node, 32>>,
    /// The lane that leads to each node: eight times its node, and the number of the lane. Of a root, `ROOT` and its cell. Of
    /// a node that is not used, one more than the next such node, or 0.
    parents: Pages<u32, 256>,
    /// One more than the first node that is not used; 0 if all are.
    unused: u32,
    /// Where each leaf is.
    places: Pages<Place, 256>,
    /// Leaves that wait for [`DynamicTree::settle`].
    waiting: Vec<Large>,
    leaf_count: usize,
    /// Leaves that changed their place since the last tending, and the leaf where that goes on.
    changed_count: usize,
    tended: u32,
}

/// Where a leaf is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Place {
    #[default]
    Absent,
    /// In this lane: eight times its node, and the number of the lane.
    Lane { cell: u16, lane: u32 },
    /// At this position of the list of enormous boxes.
    Large(u32),
    /// At this position of those that wait.
    Waiting(u32),
}

/// What a move did to the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refit {
    /// Nothing: the fat box still holds the new one.
    Kept,
    /// The leaf has a new fat box at the same place of the tree.
    Enlarged,
    /// The leaf was taken out and put in anew.
    Reinserted,
}

/// A cell is built anew when what waits for it is more than its leaves over this. Smaller builds more often, larger
/// puts more in one at a time, which costs about as much for each leaf and makes a tree that is searched in more steps.
const REBUILD_SHARE: usize = 4;

/// A leaf that still touches its old box may change it in place while the node it is in grows by this multiple of the leaf's
/// area at most. Larger spoils the tree, smaller puts leaves in anew that hardly moved. (What the node itself measures is
/// no scale: nodes that are large because they are bad would become worse for ever.)
const GROWTH_IN_PLACE: f32 = 1.0;

impl DynamicTree {
    /// How many leaves it holds.
    #[must_use]
    pub fn len(&self) -> usize {
        self.leaf_count
    }

    /// Whether it holds none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.leaf_count == 0
    }

    /// Puts in `leaf`, a number that is not in the tree, with a box that is larger than `bounds` by `margin` metres on each
    /// side, on `layers`. Memory grows with the largest number. It waits for [`DynamicTree::settle`].
    ///
    /// # Panics
    /// If it is in the tree, or 2²⁸ or more.
    pub fn insert(&mut self, leaf: u32, bounds: Aabb, margin: f64, layers: u32) {
        assert!(leaf < 1 << 28, "leaf numbers are below 2^28");
        while self.places.len() < leaf as usize {
            self.places.push(Place::Absent);
        }
        let place = Place::Waiting(self.waiting.len() as u32);
        if self.places.len() == leaf as usize {
            self.places.push(place);
        } else {
            assert_eq!(self.places[leaf as usize], Place::Absent, "leaf {leaf} is in the tree");
            self.places[leaf as usize] = place;
        }
        self.waiting.push(Large { leaf, bounds: bounds.inflated(margin), layers });
        self.leaf_count += 1;
    }

    /// Takes out a leaf.
    ///
    /// # Panics
    /// If it is not in the tree.
    pub fn remove(&mut self, leaf: u32) {
        match self.places[leaf as usize] {
            Place::Absent => panic!("leaf {leaf} is not in the tree"),
            Place::Lane { cell, lane } => {
                self.unlink(lane);
                self.forest.cells[usize::from(cell)].leaf_count -= 1;
            }
            Place::Large(at) => {
                self.forest.large.swap_remove(at as usize);
                if let Some(moved) = self.forest.large.get(at as usize) {
                    self.places[moved.leaf as usize] = Place::Large(at);
                }
            }
            Place::Waiting(at) => {
                self.waiting.swap_remove(at as usize);
                if let Some(moved) = self.waiting.get(at as usize) {
                    self.places[moved.leaf as usize] = Place::Waiting(at);
                }
            }
        }
        self.places[leaf as usize] = Place::Absent;
        self.leaf_count -= 1;
    }

    /// Gives a leaf a new box. Only if that is not within its fat box is the tree changed, and the new fat box is larger
    /// by `margin` metres on each side.
    ///
    /// # Panics
    /// If it is not in the tree.
    pub fn update(&mut self, leaf: u32, bounds: Aabb, margin: f64) -> Refit {
        let fat = || bounds.inflated(margin);
        match self.places[leaf as usize] {
            Place::Absent => panic!("leaf {leaf} is not in the tree"),
            Place::Lane { cell, lane } => self.update_lane(leaf, cell, lane, bounds, margin),
            Place::Large(at) if self.forest.large[at as usize].bounds.contains(bounds) => Refit::Kept,
            Place::Large(at) => {
                let layers = self.forest.large[at as usize].layers;
                self.remove(leaf);
                self.insert(leaf, bounds, margin, layers);
                Refit::Reinserted
            }
            Place::Waiting(at) => {
                self.waiting[at as usize].bounds = fat();
                Refit::Enlarged
            }
        }
    }

    fn update_lane(&mut self, leaf: u32, cell: u16, lane: u32, bounds: Aabb, margin: f64) -> Refit {
        let origin = self.forest.cells[usize::from(cell)].origin;
        let (index, lane_of_node) = (lane as usize / LANES, lane as usize % LANES);
        let node = &self.forest.nodes[index];
        if node.lane(lane_of_node).contains(LocalBox::around(bounds, origin)) {
            return Refit::Kept;
        }
        let fat = bounds.inflated(margin);
        if !self.forest.stays(cell.into(), fat) {
            let layers = node.layers[lane_of_node];
            self.remove(leaf);
            self.insert(leaf, bounds, margin, layers);
            return Refit::Reinserted;
        }
        let local = LocalBox::around(fat, origin);
        let changed = node.bounds_with(lane_of_node, local);
        let parent = self.parents[index];
        let may_stay = parent >= ROOT || {
            let before = self.forest.nodes[parent as usize / LANES].lane(parent as usize % LANES).half_area();
            let growth = changed.half_area() - before;
            node.lane(lane_of_node).touches(local) && growth <= local.half_area() * GROWTH_IN_PLACE
        };
        if may_stay {
            self.forest.nodes[index].set_box(lane_of_node, local);
            self.refit_boxes_from(index as u32, changed);
            return Refit::Enlarged;
        }
        let layers = node.layers[lane_of_node];
        self.unlink(lane);
        self.link(cell, Item::new(local, leaf, layers));
        self.changed_count += 1;
        Refit::Reinserted
    }

    /// Puts in what waits: to be called when a batch of edits is over. Searches find the same leaves before and after, but
    /// look at each one that waits. Then parts of the tree are built anew, in proportion to what changed: see
    /// `dynamic/tend.rs`.
    pub fn settle(&mut self) {
        if !self.waiting.is_empty() {
            self.put_in_what_waits();
        }
        self.tend();
    }

    fn put_in_what_waits(&mut self) {
        let waiting = std::mem::take(&mut self.waiting);
        let is_first = self.forest.cells.iter().all(|cell| cell.leaf_count == 0) && self.forest.large.is_empty();
        let boxes = waiting.iter().copied();
        let arriving = if is_first { self.forest.distribute(boxes) } else { self.forest.assign(boxes) };
        for (at, large) in (0..).zip(&self.forest.large) {
            self.places[large.leaf as usize] = Place::Large(at);
        }
        for (cell, mut items) in (0..).zip(arriving) {
            let total = self.forest.cells[usize::from(cell)].leaf_count as usize;
            if items.len() * REBUILD_SHARE > total {
                let root = std::mem::replace(&mut self.forest.cells[usize::from(cell)].root, NO_NODE);
                self.take_apart(root, &mut items);
                self.build_below(cell, ROOT | u32::from(cell), &mut items);
            } else {
                self.changed_count += items.len();
                for items in items.chunks(ahead::TOGETHER) {
                    self.read_ahead_of_ways(self.forest.cells[usize::from(cell)].root, items);
                    items.iter().for_each(|item| self.link(cell, *item));
                }
            }
        }
    }

    /// The fat box of a leaf, or one that holds it.
    ///
    /// # Panics
    /// If it is not in the tree.
    #[must_use]
    pub fn fat_bounds(&self, leaf: u32) -> Aabb {
        match self.places[leaf as usize] {
            Place::Absent => panic!("leaf {leaf} is not in the tree"),
            Place::Lane { cell, lane } => {
                let local = self.forest.nodes[lane as usize / LANES].lane(lane as usize % LANES);
                local.in_world(self.forest.cells[usize::from(cell)].origin)
            }
            Place::Large(at) => self.forest.large[at as usize].bounds,
            Place::Waiting(at) => self.waiting[at as usize].bounds,
        }
    }

    /// Levels, the root's being the first; 0 for an empty tree. Costs a pass over all nodes.
    #[must_use]
    pub fn depth(&self) -> u32 {
        let mut deepest = 0;
        self.walk(|_, level| deepest = deepest.max(level));
        deepest
    }

    /// The boxes of its nodes and leaves down to a level, level by level, at most so many; for those who draw them. The
    /// boxes of all are level 0, one for each part of the world that has an origin of its own.
    #[must_use]
    pub fn node_boxes(&self, level_max: u32, count_max: usize) -> Vec<NodeBox> {
        node_boxes(self, level_max, count_max)
    }

    /// Its cost by the surface-area heuristic, m²: the half areas of all boxes in all nodes. Costs a pass over all nodes.
    #[must_use]
    pub fn area_sum(&self) -> f64 {
        let mut sum = 0.0;
        self.walk(|node, _| sum += node.area_sum());
        sum
    }

    /// Bytes it holds in memory, what it shares with its clones included.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        let lists = (self.waiting.capacity() * size_of::<Large>()) as u64;
        let pages = self.forest.nodes.memory_bytes() + self.parents.memory_bytes() + self.places.memory_bytes();
        size_of::<Self>() as u64 + pages + lists + self.forest.list_bytes()
    }

    /// Bytes it holds in memory that `other` does not share, lists of enormous boxes not.
    #[must_use]
    pub fn bytes_beside(&self, other: &Self) -> u64 {
        self.forest.nodes.bytes_beside(&other.forest.nodes)
            + self.parents.bytes_beside(&other.parents)
            + self.places.bytes_beside(&other.places)
    }

    /// Shows all nodes and their levels, the root's being the first.
    fn walk(&self, mut see: impl FnMut(&Node, u32)) {
        let roots = self.forest.cells.iter().map(|cell| cell.root).filter(|&root| root != NO_NODE);
        let mut open: Vec<(u32, u32)> = roots.map(|root| (root, 1)).collect();
        while let Some((index, level)) = open.pop() {
            let node = &self.forest.nodes[index as usize];
            see(node, level);
            for lane in node.taken() {
                if let Target::Node(below) = node.children[lane].target() {
                    open.push((below, level + 1));
                }
            }
        }
    }
}

impl Rooted for DynamicTree {
    type Nodes = Pages<Node, 32>;

    fn forest(&self) -> &Forest<Pages<Node, 32>> {
        &self.forest
    }

    fn waiting(&self) -> &[Large] {
        &self.waiting
    }
}
