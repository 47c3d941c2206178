//! What holds in a dynamic tree after every edit, asserted; for tests.

use super::{DynamicTree, NONE, balance::IMBALANCE_MAX};

impl DynamicTree {
    /// Asserts what holds after every edit; for tests.
    ///
    /// # Panics
    /// If a link is not mutual, a box does not hold its children's, a height is wrong or siblings are out of balance.
    pub fn assert_sound(&self) {
        let (mut leaf_count, mut node_count) = (0, 0);
        let mut open: Vec<(u32, u32)> = (self.root != NONE).then_some((self.root, NONE)).into_iter().collect();
        while let Some((index, parent)) = open.pop() {
            let node = self.node(index);
            node_count += 1;
            assert_eq!(node.parent, parent, "parent of node {index}");
            if node.is_leaf() {
                leaf_count += 1;
                assert_eq!(node.height, 0, "height of leaf {index}");
                continue;
            }
            let (left, right) = (self.node(node.left), self.node(node.right));
            assert_eq!(node.height, 1 + left.height.max(right.height), "height of node {index}");
            assert!(left.height.abs_diff(right.height) <= IMBALANCE_MAX, "balance of node {index}");
            assert!(node.bounds.contains(left.bounds.union(right.bounds)), "box of node {index}");
            open.extend([(node.left, index), (node.right, index)]);
        }
        assert_eq!(leaf_count, self.leaf_count, "number of leaves");
        let mut free = self.free;
        while free != NONE {
            node_count += 1;
            free = self.node(free).parent;
        }
        assert_eq!(node_count, self.nodes.len(), "every node is in the tree or free");
    }
}
