//! Boxes as Calipers keeps them. All that a change of the trees' functions touches is here.

use collision::{
    answer::Work,
    broad::{ALL_LAYERS, DynamicTree, StaticTree},
    math::Aabb,
};

/// Changes whose leaves are read ahead together.
pub(super) const CHANGES_TOGETHER: usize = 32;

/// Boxes that come, move and go.
#[derive(Debug, Default)]
pub(super) struct Tree {
    tree: DynamicTree,
}

impl Tree {
    /// The next leaf: they are numbered from 0.
    pub(super) fn insert(&mut self, leaf: u32, bounds: Aabb) {
        self.tree.insert(leaf, bounds, 0.0, ALL_LAYERS);
    }

    /// Before some changes.
    pub(super) fn read_ahead(&self, leaves: impl Iterator<Item = u32>) {
        self.tree.read_ahead(leaves);
    }

    pub(super) fn update(&mut self, leaf: u32, bounds: Aabb) {
        self.tree.update(leaf, bounds, 0.0);
    }

    pub(super) fn remove_and_insert(&mut self, leaf: u32, bounds: Aabb) {
        self.tree.remove(leaf);
        self.tree.insert(leaf, bounds, 0.0, ALL_LAYERS);
    }

    /// Does what was put off, so that searches are at full speed.
    pub(super) fn settle(&mut self) {
        self.tree.settle();
    }

    /// Every pair of leaves whose `boxes`, those that the tree was given, overlap; each pair once.
    pub(super) fn visit_pairs(&self, boxes: &[Aabb], mut visit: impl FnMut(u32, u32)) {
        visit_pairs_of(&self.tree, boxes, &mut visit);
    }
}

/// Pairs that are looked at together: their boxes lie anywhere in memory, and are waited for at the same time.
const TOGETHER: usize = 64;

fn visit_pairs_of(tree: &impl collision::broad::Tree, boxes: &[Aabb], visit: &mut impl FnMut(u32, u32)) {
    let mut offered: Vec<(u32, u32)> = Vec::with_capacity(TOGETHER);
    let mut look = |offered: &mut Vec<(u32, u32)>| {
        for (first, second) in offered.drain(..) {
            if boxes[first as usize].intersects(boxes[second as usize]) {
                visit(first, second);
            }
        }
    };
    let Ok(()) = tree.visit_pairs(&mut Work::default(), |_, first, second| {
        offered.push((first, second));
        if offered.len() == TOGETHER {
            look(&mut offered);
        }
        Ok(())
    });
    look(&mut offered);
}

/// A tree over boxes that do not change, built whole.
pub(super) fn bulk(boxes: &[Aabb]) -> StaticTree {
    StaticTree::build(boxes)
}

/// Every pair of leaves whose boxes overlap; each pair once.
pub(super) fn visit_pairs_of_bulk(tree: &StaticTree, boxes: &[Aabb], mut visit: impl FnMut(u32, u32)) {
    visit_pairs_of(tree, boxes, &mut visit);
}
