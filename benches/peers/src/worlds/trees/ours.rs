//! Boxes as Calipers keeps them. All that a change of the trees' functions touches is here.

use std::ops::ControlFlow;

use collision::{
    answer::Work,
    broad::{DynamicTree, NodeIndex, StaticTree, Tree as _},
    math::Aabb,
};

/// Boxes that come, move and go.
#[derive(Debug, Default)]
pub(super) struct Tree {
    tree: DynamicTree,
    nodes: Vec<NodeIndex>,
}

impl Tree {
    /// The next leaf: they are numbered from 0.
    pub(super) fn insert(&mut self, leaf: u32, bounds: Aabb) {
        self.nodes.push(self.tree.insert(leaf, bounds, 0.0));
    }

    pub(super) fn update(&mut self, leaf: u32, bounds: Aabb) {
        self.tree.update(self.nodes[leaf as usize], bounds, 0.0);
    }

    pub(super) fn remove_and_insert(&mut self, leaf: u32, bounds: Aabb) {
        let node = &mut self.nodes[leaf as usize];
        self.tree.remove(*node);
        *node = self.tree.insert(leaf, bounds, 0.0);
    }

    /// Does what was put off, so that searches are at full speed.
    pub(super) fn settle(&mut self) {}

    /// Every pair of leaves whose `boxes`, those that the tree was given, overlap; each pair once.
    pub(super) fn visit_pairs(&self, boxes: &[Aabb], mut visit: impl FnMut(u32, u32)) {
        for (first, bounds) in (0..).zip(boxes) {
            let Ok(()) = self.tree.visit_box(*bounds, &mut Work::default(), |_, second| {
                if first < second && boxes[second as usize].intersects(*bounds) {
                    visit(first, second);
                }
                Ok(ControlFlow::Continue(()))
            });
        }
    }
}

/// A tree over boxes that do not change, built whole.
pub(super) fn bulk(boxes: &[Aabb]) -> StaticTree {
    StaticTree::build(boxes)
}

/// Every pair of leaves whose boxes overlap; each pair once.
pub(super) fn visit_pairs_of_bulk(tree: &StaticTree, boxes: &[Aabb], mut visit: impl FnMut(u32, u32)) {
    for (first, bounds) in (0..).zip(boxes) {
        let Ok(()) = tree.visit_box(*bounds, &mut Work::default(), |_, second| {
            if first < second && boxes[second as usize].intersects(*bounds) {
                visit(first, second);
            }
            Ok(ControlFlow::Continue(()))
        });
    }
}
