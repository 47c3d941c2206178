//! How a dynamic tree is kept tight, cheap and of bounded height on the way back up from an edit.

use super::{DynamicTree, NONE};

/// How much the heights of siblings may differ. Smaller forces boxes that are far apart to be siblings, larger allows
/// deeper trees: with 6 a tree of a million leaves has at most 61 levels.
pub(super) const IMBALANCE_MAX: u32 = 6;

impl DynamicTree {
    /// Makes boxes, heights and balance right from `index` to the root, and lowers the cost where it can.
    pub(super) fn refit_from(&mut self, mut index: u32) {
        while index != NONE {
            let old = *self.node(index);
            self.balance(index);
            self.refit(index);
            self.lower_cost(index, old.height);
            let new = self.node(index);
            let is_settled = new.bounds == old.bounds && new.height == old.height;
            index = new.parent;
            if is_settled {
                return;
            }
        }
    }

    fn refit(&mut self, index: u32) {
        let node = *self.node(index);
        let (left, right) = (self.node(node.left), self.node(node.right));
        let (bounds, height) = (left.bounds.union(right.bounds), 1 + left.height.max(right.height));
        if bounds != node.bounds || height != node.height {
            let node = &mut self.nodes[index as usize];
            node.bounds = bounds;
            node.height = height;
        }
    }

    /// Restores the bound on heights at a node whose children may now differ by one more than allowed.
    ///
    /// Let `low` be the lower child, of height `l`, and `high` the other, of height `l + K + 1`. Its higher child `up`
    /// has height `l + K`, its other child `stay` any from `l` to `l + K`. After exchanging `low` and `up`, the children
    /// of `high` differ by at most `K`, its height is 1 more than `stay`'s, and it differs from `up` by at most `K`. The
    /// height of the whole falls by 1 or stays. By induction no height changes by more than 1 in one edit, so the
    /// children never differ by more than `K + 1` here.
    fn balance(&mut self, index: u32) {
        let node = *self.node(index);
        let (left, right) = (self.height(node.left), self.height(node.right));
        if left.abs_diff(right) <= IMBALANCE_MAX {
            return;
        }
        let (low, high) = if left < right { (node.left, node.right) } else { (node.right, node.left) };
        let high = *self.node(high);
        let up = if self.height(high.left) >= self.height(high.right) { high.left } else { high.right };
        self.exchange(index, low, up);
    }

    /// Exchanges `child`, of the node `index`, with `grandchild`, of its other child, which is refitted.
    fn exchange(&mut self, index: u32, child: u32, grandchild: u32) {
        let middle = self.node(grandchild).parent;
        self.replace_child(middle, grandchild, child);
        self.replace_child(index, child, grandchild);
        self.nodes[child as usize].parent = middle;
        self.nodes[grandchild as usize].parent = index;
        self.refit(middle);
    }

    /// Exchanges a child with a grandchild of the other side where that makes the node between them smaller, unless that
    /// spoils the balance or makes the height differ by more than 1 from what it was before the edit.
    fn lower_cost(&mut self, index: u32, height_before: u32) {
        let node = *self.node(index);
        let mut best: Option<(f64, u32, u32)> = None;
        for (child, middle) in [(node.left, node.right), (node.right, node.left)] {
            let middle = *self.node(middle);
            if middle.is_leaf() {
                continue;
            }
            for (grandchild, stays) in [(middle.left, middle.right), (middle.right, middle.left)] {
                let (height_child, height_stays) = (self.height(child), self.height(stays));
                let height_middle = 1 + height_child.max(height_stays);
                let height_grandchild = self.height(grandchild);
                let height = 1 + height_middle.max(height_grandchild);
                let is_balanced = height_child.abs_diff(height_stays) <= IMBALANCE_MAX
                    && height_middle.abs_diff(height_grandchild) <= IMBALANCE_MAX
                    && height.abs_diff(height_before) <= 1;
                let area = self.node(child).bounds.union(self.node(stays).bounds).half_area();
                let gain = middle.bounds.half_area() - area;
                if is_balanced && gain > best.map_or(0.0, |(gain, ..)| gain) {
                    best = Some((gain, child, grandchild));
                }
            }
        }
        if let Some((_, child, grandchild)) = best {
            self.exchange(index, child, grandchild);
            self.refit(index);
        }
    }
}
