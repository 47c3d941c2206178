//! Boxes as parry3d keeps them.

use parry3d::{
    bounding_volume::Aabb,
    math::Vector,
    partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace},
};

use crate::worlds::workload::Bounds;

pub(super) fn bounds(bounds: &Bounds) -> Aabb {
    Aabb::new(Vector::from_array(bounds.min), Vector::from_array(bounds.max))
}

/// Boxes that come, move and go.
pub(super) struct Tree {
    tree: Bvh,
    workspace: BvhWorkspace,
}

impl Tree {
    pub(super) fn new() -> Self {
        Self { tree: Bvh::new(), workspace: BvhWorkspace::default() }
    }

    /// Built whole, the way that the library calls the usual one.
    pub(super) fn bulk(boxes: &[Aabb]) -> Self {
        Self { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, boxes), workspace: BvhWorkspace::default() }
    }

    pub(super) fn insert(&mut self, leaf: u32, bounds: Aabb) {
        self.tree.insert(bounds, leaf);
    }

    /// Not searched before [`Tree::refit`].
    pub(super) fn update(&mut self, leaf: u32, bounds: Aabb) {
        self.tree.insert_or_update_partially(bounds, leaf, 0.0);
    }

    pub(super) fn refit(&mut self) {
        self.tree.refit(&mut self.workspace);
    }

    pub(super) fn remove_and_insert(&mut self, leaf: u32, bounds: Aabb) {
        self.tree.remove(leaf);
        self.tree.insert(bounds, leaf);
    }

    /// Every pair of leaves whose boxes overlap; each pair once.
    pub(super) fn visit_pairs(&mut self, mut visit: impl FnMut(u32, u32)) {
        self.tree.traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut visit);
    }
}
