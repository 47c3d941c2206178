//! How leaves and subtrees are linked into a dynamic tree and taken out of it.
//!
//! # Method
//! A leaf is put where the areas of all nodes grow least: into a free lane, or into a new node beside one of the leaves on
//! the way down (beside a node, all that is below it would come to lie deeper, unseen). Going down, the growth above is known,
//! and below a box no place can cost less than that plus its own growth; so the descent ends when a place on the way is
//! cheaper. A node that is left with one child gives way to it. There are no rotations: what lies badly is built anew, by small
//! subtrees (`tend.rs`), which finds what rotations find and more.

use smallvec::SmallVec;

use super::{DynamicTree, Place};
use crate::broad::{
    build::build,
    item::Item,
    local::LocalBox,
    node::{Child, LANES, NO_NODE, Node, Target},
};

/// Marks the parent of a root, with the number of its cell.
pub(super) const ROOT: u32 = 1 << 31;

/// Where a leaf is to be put.
#[derive(Clone, Copy)]
enum Spot {
    /// Into this lane, which is free.
    Free(u32),
    /// Into a new node, together with what is in this lane.
    Beside(u32),
}

fn lane_number(node: u32, lane: usize) -> u32 {
    node * LANES as u32 + lane as u32
}

/// How deep a tree of so many leaves may be.
fn depth_max(leaf_count: usize) -> u32 {
    4 + 2 * leaf_count.max(1).ilog2()
}

impl DynamicTree {
    /// Puts a leaf into the tree of a cell, where it is counted already.
    pub(super) fn link(&mut self, cell: u16, item: Item) {
        let leaf = Child::leaf(item.leaf());
        let root = self.forest.cells[usize::from(cell)].root;
        if root == NO_NODE {
            let root = self.allocate(ROOT | u32::from(cell));
            self.forest.nodes[root as usize].set(0, item.bounds(), leaf, item.layers());
            self.forest.set_root(cell.into(), root);
            self.note(cell, leaf, lane_number(root, 0));
            return;
        }
        let (spot, level) = self.best_spot(root, item);
        let (spot_lane, lane, level) = match spot {
            Spot::Free(lane) => {
                self.forest.nodes[lane as usize / LANES].set(lane as usize % LANES, item.bounds(), leaf, item.layers());
                self.note(cell, leaf, lane);
                (lane, lane, level)
            }
            Spot::Beside(lane) => {
                let node = self.allocate(lane);
                let above = &mut self.forest.nodes[lane as usize / LANES];
                let at = lane as usize % LANES;
                let (bounds, child, layers) = (above.lane(at), above.children[at], above.layers[at]);
                above.set(at, bounds.union(item.bounds()), Child::node(node), layers | item.layers());
                let mut pair = Node::EMPTY;
                pair.set(0, bounds, child, layers);
                pair.set(1, item.bounds(), leaf, item.layers());
                self.forest.nodes[node as usize] = pair;
                self.note(cell, child, lane_number(node, 0));
                self.note(cell, leaf, lane_number(node, 1));
                (lane, lane_number(node, 1), level + 1)
            }
        };
        self.grow_above(spot_lane / LANES as u32, item);
        if level > depth_max(self.forest.cells[usize::from(cell)].leaf_count as usize) {
            self.rebuild_above(cell, lane / LANES as u32);
        }
    }

    /// Takes a leaf out of its lane.
    pub(super) fn unlink(&mut self, lane: u32) {
        let (index, at) = (lane / LANES as u32, lane as usize % LANES);
        let node = &self.forest.nodes[index as usize];
        let mut others = node.taken().filter(|&other| other != at);
        let (first, second) = (others.next(), others.next());
        let parent = self.parents[index as usize];
        match (first, second) {
            (None, _) => {
                self.forest.cells[(parent ^ ROOT) as usize].root = NO_NODE;
                self.release(index);
            }
            (Some(last), None) if parent < ROOT => {
                let (bounds, child, layers) = (node.lane(last), node.children[last], node.layers[last]);
                self.forest.nodes[parent as usize / LANES].set(parent as usize % LANES, bounds, child, layers);
                self.note_moved(child, parent);
                self.release(index);
                self.refit_from(parent / LANES as u32);
            }
            (Some(last), None) if matches!(node.children[last].target(), Target::Node(_)) => {
                if let Target::Node(below) = node.children[last].target() {
                    self.forest.set_root((parent ^ ROOT) as usize, below);
                    self.parents[below as usize] = parent;
                }
                self.release(index);
            }
            (Some(_), _) => {
                self.forest.nodes[index as usize].clear(at);
                self.refit_from(index);
            }
        }
    }

    /// Makes boxes and layers right from a node that changed to the root.
    pub(super) fn refit_from(&mut self, mut index: u32) {
        loop {
            let parent = self.parents[index as usize];
            if parent >= ROOT {
                self.forest.set_root((parent ^ ROOT) as usize, index);
                return;
            }
            let node = &self.forest.nodes[index as usize];
            let (bounds, layers) = (node.bounds(), node.all_layers());
            let (above, lane) = (&self.forest.nodes[parent as usize / LANES], parent as usize % LANES);
            if above.lane(lane) == bounds && above.layers[lane] == layers {
                return;
            }
            let above = &mut self.forest.nodes[parent as usize / LANES];
            above.set_box(lane, bounds);
            above.layers[lane] = layers;
            index = parent / LANES as u32;
        }
    }

    /// As [`DynamicTree::refit_from`], where only the box of a node changed, to `bounds`.
    pub(super) fn refit_boxes_from(&mut self, mut index: u32, mut bounds: LocalBox) {
        loop {
            let parent = self.parents[index as usize];
            if parent >= ROOT {
                self.forest.set_bounds((parent ^ ROOT) as usize, bounds);
                return;
            }
            let (above, lane) = (&self.forest.nodes[parent as usize / LANES], parent as usize % LANES);
            if above.lane(lane) == bounds {
                return;
            }
            let grown = above.bounds_with(lane, bounds);
            self.forest.nodes[parent as usize / LANES].set_box(lane, bounds);
            (index, bounds) = (parent / LANES as u32, grown);
        }
    }

    /// Builds the nodes over `items` and links them where `parent` says.
    pub(super) fn build_below(&mut self, cell: u16, parent: u32, items: &mut [Item]) {
        let built = build(items);
        let numbers = self.numbers_for(built.nodes.len());
        for (mut node, (&number, &above)) in built.nodes.into_iter().zip(numbers.iter().zip(&built.parents)) {
            node.renumber(|index| numbers[index as usize]);
            let parent_of_node = match numbers.get(above as usize / LANES) {
                Some(&above_number) => lane_number(above_number, above as usize % LANES),
                None => parent,
            };
            if number as usize == self.parents.len() {
                self.parents.push(parent_of_node);
                self.forest.nodes.push(node);
            } else {
                self.parents[number as usize] = parent_of_node;
                self.forest.nodes[number as usize] = node;
            }
            for lane in node.taken() {
                if let Target::Leaf(leaf) = node.children[lane].target() {
                    self.places[leaf as usize] = Place::Lane { cell, lane: lane_number(number, lane) };
                }
            }
        }
        if parent >= ROOT {
            self.forest.set_root(cell.into(), numbers[0]);
        } else {
            let root = self.forest.nodes[numbers[0] as usize];
            let (bounds, layers) = (root.bounds(), root.all_layers());
            let above = &mut self.forest.nodes[parent as usize / LANES];
            above.set(parent as usize % LANES, bounds, Child::node(numbers[0]), layers);
        }
    }

    /// Gives up the nodes from `top` on, which may be none, and adds their leaves to `items`.
    pub(super) fn take_apart(&mut self, top: u32, items: &mut Vec<Item>) {
        let mut open: Vec<u32> = (top != NO_NODE).then_some(top).into_iter().collect();
        while let Some(index) = open.pop() {
            let node = self.forest.nodes[index as usize];
            self.release(index);
            for lane in node.taken() {
                match node.children[lane].target() {
                    Target::Node(below) => open.push(below),
                    Target::Leaf(leaf) => {
                        items.push(Item::new(node.lane(lane), leaf, node.layers[lane]));
                    }
                    Target::Nothing => {}
                }
            }
        }
    }

    /// Numbers for so many nodes: first of those that are not used, then, in order, of those that are still to be pushed.
    fn numbers_for(&mut self, count: usize) -> Vec<u32> {
        let mut numbers = Vec::with_capacity(count);
        while numbers.len() < count
            && let Some(index) = self.unused.checked_sub(1)
        {
            self.unused = self.parents[index as usize];
            numbers.push(index);
        }
        let pushed = self.parents.len() as u32;
        numbers.extend(pushed..pushed + (count - numbers.len()) as u32);
        numbers
    }

    fn allocate(&mut self, parent: u32) -> u32 {
        if let Some(index) = self.unused.checked_sub(1) {
            self.unused = std::mem::replace(&mut self.parents[index as usize], parent);
            return index;
        }
        self.forest.nodes.push(Node::EMPTY);
        self.parents.push(parent);
        self.parents.len() as u32 - 1
    }

    fn release(&mut self, index: u32) {
        self.parents[index as usize] = std::mem::replace(&mut self.unused, index + 1);
    }

    /// Notes which lane leads to a leaf or a node.
    fn note(&mut self, cell: u16, child: Child, lane: u32) {
        match child.target() {
            Target::Leaf(leaf) => self.places[leaf as usize] = Place::Lane { cell, lane },
            Target::Node(index) => self.parents[index as usize] = lane,
            Target::Nothing => {}
        }
    }

    /// As [`DynamicTree::note`], for what stays in its cell.
    fn note_moved(&mut self, child: Child, lane: u32) {
        match child.target() {
            Target::Leaf(leaf) => {
                if let Place::Lane { cell, .. } = self.places[leaf as usize] {
                    self.places[leaf as usize] = Place::Lane { cell, lane };
                }
            }
            Target::Node(index) => self.parents[index as usize] = lane,
            Target::Nothing => {}
        }
    }

    /// Where a leaf costs least, and the level of the node with that lane, the root's being 1.
    fn best_spot(&self, root: u32, item: Item) -> (Spot, u32) {
        let planes = item.bounds().splat();
        let (mut index, mut level, mut growth_above) = (root, 1, 0.0);
        // Areas are finite: the first node on the way has a free lane, a leaf, or nodes to descend into.
        let mut best = (f32::INFINITY, Spot::Beside(lane_number(root, 0)), level);
        loop {
            let node = &self.forest.nodes[index as usize];
            if let Some(free) = node.free_lane() {
                if growth_above < best.0 {
                    best = (growth_above, Spot::Free(lane_number(index, free)), level);
                }
                return (best.1, best.2);
            }
            let [(growth, below), (united, beside)] = node.least_growths(&planes);
            if growth_above + united < best.0 {
                best = (growth_above + united, Spot::Beside(lane_number(index, beside)), level);
            }
            match node.children[below].target() {
                Target::Node(below) if growth_above + growth < best.0 => {
                    (index, level, growth_above) = (below, level + 1, growth_above + growth);
                }
                Target::Node(_) | Target::Leaf(_) | Target::Nothing => return (best.1, best.2),
            }
        }
    }

    /// Makes the boxes above a node hold a leaf that was put into it.
    fn grow_above(&mut self, index: u32, item: Item) {
        let (mut index, mut parent) = (index, self.parents[index as usize]);
        while parent < ROOT {
            let (above, lane) = (&self.forest.nodes[parent as usize / LANES], parent as usize % LANES);
            let (bounds, layers) = (above.lane(lane), above.layers[lane]);
            if bounds.contains(item.bounds()) && layers | item.layers() == layers {
                return;
            }
            let above = &mut self.forest.nodes[parent as usize / LANES];
            above.set_box(lane, bounds.union(item.bounds()));
            above.layers[lane] |= item.layers();
            index = parent / LANES as u32;
            parent = self.parents[index as usize];
        }
        self.forest.set_root((parent ^ ROOT) as usize, index);
    }

    /// Builds the lowest subtree anew that is too deep for its size, from a node that is too deep upwards.
    fn rebuild_above(&mut self, cell: u16, lowest: u32) {
        let (mut top, mut height) = (lowest, 1);
        let mut leaf_count = self.leaf_count_below(top, usize::MAX);
        while self.parents[top as usize] < ROOT && height <= depth_max(leaf_count) {
            let below = top;
            top = self.parents[top as usize] / LANES as u32;
            height += 1;
            let node = self.forest.nodes[top as usize];
            for lane in node.taken() {
                leaf_count += match node.children[lane].target() {
                    Target::Node(other) if other != below => self.leaf_count_below(other, usize::MAX),
                    Target::Leaf(_) => 1,
                    Target::Node(_) | Target::Nothing => 0,
                };
            }
        }
        let parent = self.parents[top as usize];
        let mut items = Vec::with_capacity(leaf_count);
        self.take_apart(top, &mut items);
        self.build_below(cell, parent, &mut items);
    }

    /// How many leaves there are below a node; if there are more than `most`, a number above it, found in as many steps.
    pub(super) fn leaf_count_below(&self, top: u32, most: usize) -> usize {
        let (mut open, mut count): (SmallVec<[u32; 64]>, usize) = (SmallVec::new(), 0);
        open.push(top);
        while let Some(index) = open.pop() {
            for child in self.forest.nodes[index as usize].children {
                match child.target() {
                    Target::Node(below) => open.push(below),
                    Target::Leaf(_) => count += 1,
                    Target::Nothing => {}
                }
            }
            // Below each node there is a leaf at least.
            if count + open.len() > most {
                return count + open.len();
            }
        }
        count
    }
}
