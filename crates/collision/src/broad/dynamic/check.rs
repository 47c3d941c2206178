//! What holds in a dynamic tree after every edit, asserted; for tests.

use super::{DynamicTree, Place, links::ROOT};
use crate::broad::node::{LANES, NO_NODE, Target};

impl DynamicTree {
    /// Asserts what holds after every edit; for tests.
    ///
    /// # Panics
    /// If a link is not mutual, a box or the layers of a node are not those of what is below it, a node has one child only, a
    /// count is wrong or the tree is too deep.
    pub fn assert_sound(&self) {
        let mut leaf_count = self.forest.large.len() + self.waiting.len();
        let mut node_count = 0;
        let mut unused = self.unused;
        while let Some(index) = unused.checked_sub(1) {
            node_count += 1;
            unused = self.parents[index as usize];
        }
        for (cell_index, cell) in (0..).zip(&self.forest.cells) {
            let mut in_cell = 0;
            let root = (cell.root != NO_NODE).then_some((cell.root, ROOT | cell_index, 1));
            let mut open: Vec<(u32, u32, u32)> = root.into_iter().collect();
            while let Some((index, parent, level)) = open.pop() {
                node_count += 1;
                assert_eq!(self.parents[index as usize], parent, "parent of node {index}");
                assert!(level <= 5 + 2 * self.places.len().ilog2(), "node {index} at level {level}");
                let node = &self.forest.nodes[index as usize];
                assert!(parent >= ROOT || node.taken().count() > 1, "node {index} has one child");
                for lane in node.taken() {
                    let number = index * LANES as u32 + lane as u32;
                    match node.children[lane].target() {
                        Target::Node(below) => {
                            let child = &self.forest.nodes[below as usize];
                            assert_eq!(node.lane(lane), child.bounds(), "box of node {below}");
                            assert_eq!(node.layers[lane], child.all_layers(), "layers of node {below}");
                            open.push((below, number, level + 1));
                        }
                        Target::Leaf(leaf) => {
                            let place = Place::Lane { cell: cell_index as u16, lane: number };
                            assert_eq!(self.places[leaf as usize], place, "place of leaf {leaf}");
                            in_cell += 1;
                        }
                        Target::Nothing => unreachable!("the lane is taken"),
                    }
                }
            }
            if cell.root != NO_NODE {
                let bounds = self.forest.nodes[cell.root as usize].bounds().in_world(cell.origin);
                assert_eq!(cell.bounds, bounds, "box of cell {cell_index}");
            }
            assert_eq!(in_cell, cell.leaf_count, "leaves of cell {cell_index}");
            leaf_count += in_cell as usize;
        }
        assert_eq!(leaf_count, self.leaf_count, "number of leaves");
        assert_eq!(node_count, self.parents.len(), "every node is in the tree or unused");
    }
}
