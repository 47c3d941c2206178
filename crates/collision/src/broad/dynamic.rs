//! A tree over boxes that come, move and go, and that its clones share until one of them writes.
//!
//! # Method
//! A leaf is put beside the node where the surface-area heuristic grows least, found by descending with a lower bound
//! of what lies below; on the way back up, exchanges of a node with a child of its sibling are made where they lower the
//! cost. Leaves are kept in *fat* boxes, so that small moves change nothing; a box that left its fat one is enlarged in
//! place where its parent still holds it, else put in anew.
//!
//! The heuristic alone makes chains of boxes that lie in each other, as tall as they are many. So siblings may differ in
//! height by [`balance::IMBALANCE_MAX`] at most, as in an AVL tree (Adelson-Velsky and Landis 1962) of wider tolerance: see
//! [`DynamicTree::balance`]. The height is then at most about 3 log₂ of the number of leaves.
//!
//! # Source
//! Catto, "Dynamic Bounding Volume Hierarchies", GDC 2019 (descent, rotations); Kopta et al., "Fast, Effective BVH
//! Updates for Animated Scenes", I3D 2012 (rotations). The bound on heights is our own.

mod balance;
mod check;

use glam::DVec3;

use super::{
    Tree,
    traverse::{Expanded, NodeIndex},
};
use crate::{math::Aabb, pages::Pages};
use balance::IMBALANCE_MAX;

/// No node.
const NONE: u32 = u32::MAX;

/// A tree over boxes that come, move and go. Cloning it shares all nodes.
#[derive(Clone, Debug)]
pub struct DynamicTree {
    nodes: Pages<Node>,
    root: u32,
    /// First of the unused nodes, linked by `parent`.
    free: u32,
    leaf_count: usize,
}

/// Inner: both children are nodes. Leaf: `left` is `NONE` and `right` the leaf number. Unused: `parent` is the next.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    parent: u32,
    left: u32,
    right: u32,
    /// 0 for a leaf, else one more than the higher child's.
    height: u32,
}

impl Default for Node {
    fn default() -> Self {
        Self { bounds: Aabb::new(DVec3::ZERO, DVec3::ZERO), parent: NONE, left: NONE, right: NONE, height: 0 }
    }
}

impl Node {
    fn is_leaf(&self) -> bool {
        self.left == NONE
    }
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

impl Default for DynamicTree {
    fn default() -> Self {
        Self { nodes: Pages::default(), root: NONE, free: NONE, leaf_count: 0 }
    }
}

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

    /// Levels, the root's being the first; 0 for an empty tree.
    #[must_use]
    pub fn depth(&self) -> u32 {
        if self.root == NONE { 0 } else { self.node(self.root).height + 1 }
    }

    /// Puts in `leaf` with a box that is larger than `bounds` by `margin` metres on each side. The node that is
    /// returned names it until it is removed.
    ///
    /// # Panics
    /// If there are 2³¹ leaves.
    pub fn insert(&mut self, leaf: u32, bounds: Aabb, margin: f64) -> NodeIndex {
        assert!(self.leaf_count < 1 << 31, "fewer than 2^31 leaves");
        let node = self.allocate(Node { bounds: bounds.inflated(margin), right: leaf, ..Node::default() });
        self.leaf_count += 1;
        self.link(node);
        NodeIndex(node)
    }

    /// Takes out a leaf that [`DynamicTree::insert`] returned.
    pub fn remove(&mut self, leaf: NodeIndex) {
        self.unlink(leaf.0);
        self.release(leaf.0);
        self.leaf_count -= 1;
    }

    /// Gives a leaf a new box. Only if that is not within its fat box is the tree changed, and the new fat box is larger
    /// by `margin` metres on each side.
    pub fn update(&mut self, leaf: NodeIndex, bounds: Aabb, margin: f64) -> Refit {
        let node = self.node(leaf.0);
        if node.bounds.contains(bounds) {
            return Refit::Kept;
        }
        let fat = bounds.inflated(margin);
        let parent = node.parent;
        let is_within_parent = parent != NONE && self.node(parent).bounds.contains(fat);
        if is_within_parent {
            self.nodes[leaf.0 as usize].bounds = fat;
            return Refit::Enlarged;
        }
        self.unlink(leaf.0);
        self.nodes[leaf.0 as usize].bounds = fat;
        self.link(leaf.0);
        Refit::Reinserted
    }

    /// The fat box of a leaf.
    #[must_use]
    pub fn fat_bounds(&self, leaf: NodeIndex) -> Aabb {
        self.node(leaf.0).bounds
    }

    /// Its cost by the surface-area heuristic, m²: the half areas of all nodes, leaves included.
    #[must_use]
    pub fn area_sum(&self) -> f64 {
        let mut sum = 0.0;
        let mut open: Vec<u32> = (self.root != NONE).then_some(self.root).into_iter().collect();
        while let Some(index) = open.pop() {
            let node = self.node(index);
            sum += node.bounds.half_area();
            if !node.is_leaf() {
                open.extend([node.left, node.right]);
            }
        }
        sum
    }

    /// Bytes it holds in memory, what it shares with its clones included.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        size_of::<Self>() as u64 + self.nodes.memory_bytes()
    }

    fn node(&self, index: u32) -> &Node {
        &self.nodes[index as usize]
    }

    fn height(&self, index: u32) -> u32 {
        self.node(index).height
    }

    fn allocate(&mut self, node: Node) -> u32 {
        if self.free == NONE {
            self.nodes.push(node);
            return (self.nodes.len() - 1) as u32;
        }
        let index = self.free;
        self.free = self.node(index).parent;
        self.nodes[index as usize] = node;
        index
    }

    fn release(&mut self, index: u32) {
        self.nodes[index as usize] = Node { parent: self.free, ..Node::default() };
        self.free = index;
    }

    /// Puts a leaf that has no parent into the tree.
    fn link(&mut self, leaf: u32) {
        if self.root == NONE {
            self.root = leaf;
            self.nodes[leaf as usize].parent = NONE;
            return;
        }
        let sibling = self.best_sibling(self.node(leaf).bounds);
        let (bounds, height, above) = {
            let sibling = self.node(sibling);
            (sibling.bounds, sibling.height, sibling.parent)
        };
        let parent = self.allocate(Node {
            bounds: bounds.union(self.node(leaf).bounds),
            parent: above,
            left: sibling,
            right: leaf,
            height: height + 1,
        });
        self.nodes[sibling as usize].parent = parent;
        self.nodes[leaf as usize].parent = parent;
        self.replace_child(above, sibling, parent);
        self.refit_from(above);
    }

    /// Takes a leaf out of the tree; it keeps its box.
    fn unlink(&mut self, leaf: u32) {
        let parent = self.node(leaf).parent;
        if parent == NONE {
            self.root = NONE;
            return;
        }
        let (sibling, above) = {
            let parent = self.node(parent);
            let sibling = if parent.left == leaf { parent.right } else { parent.left };
            (sibling, parent.parent)
        };
        self.nodes[sibling as usize].parent = above;
        self.replace_child(above, parent, sibling);
        self.release(parent);
        self.refit_from(above);
    }

    fn replace_child(&mut self, parent: u32, old: u32, new: u32) {
        if parent == NONE {
            self.root = new;
            return;
        }
        let parent = &mut self.nodes[parent as usize];
        if parent.left == old {
            parent.left = new;
        } else {
            parent.right = new;
        }
    }

    /// The node beside which a box costs least, among those that are low enough to stay in balance with a leaf.
    ///
    /// The cost of a place is the area of the new parent and by how much all nodes above grow. Going down, the growth
    /// above is known, and below a child no place can cost less than that plus the least its own growth can be.
    fn best_sibling(&self, bounds: Aabb) -> u32 {
        let mut index = self.root;
        let mut area_with_box = self.node(index).bounds.union(bounds).half_area();
        let mut growth_above = 0.0;
        let (mut best, mut best_cost) = (NONE, f64::INFINITY);
        loop {
            let node = self.node(index);
            let cost = growth_above + area_with_box;
            if node.height <= IMBALANCE_MAX && cost < best_cost {
                (best, best_cost) = (index, cost);
            }
            if node.is_leaf() {
                return best;
            }
            growth_above += area_with_box - node.bounds.half_area();
            let (lower_left, area_left) = self.cost_below(node.left, bounds, growth_above);
            let (lower_right, area_right) = self.cost_below(node.right, bounds, growth_above);
            if best_cost <= lower_left.min(lower_right) {
                return best;
            }
            // Equal boxes must not make a chain: among equals the lower child is taken.
            let is_left = lower_left < lower_right
                || (lower_left <= lower_right && self.height(node.left) <= self.height(node.right));
            (index, area_with_box) = if is_left { (node.left, area_left) } else { (node.right, area_right) };
        }
    }

    /// A lower bound of the cost of the places at and below a node, and its area with the box.
    fn cost_below(&self, index: u32, bounds: Aabb, growth_above: f64) -> (f64, f64) {
        let node = self.node(index);
        let area_with_box = node.bounds.union(bounds).half_area();
        if node.is_leaf() {
            return (growth_above + area_with_box, area_with_box);
        }
        // Beside a node below, the new parent holds the box at least, and this node grows.
        let growth = area_with_box - node.bounds.half_area();
        ((growth_above + growth + bounds.half_area()).min(growth_above + area_with_box), area_with_box)
    }
}

impl Tree for DynamicTree {
    fn root(&self) -> Option<(NodeIndex, &Aabb)> {
        (self.root != NONE).then(|| (NodeIndex(self.root), &self.node(self.root).bounds))
    }

    fn expand(&self, node: NodeIndex) -> Expanded<'_> {
        let node = self.node(node.0);
        if node.is_leaf() {
            return Expanded::Leaves(std::slice::from_ref(&node.right));
        }
        let (left, right) = (node.left, node.right);
        Expanded::Children([(NodeIndex(left), &self.node(left).bounds), (NodeIndex(right), &self.node(right).bounds)])
    }
}
