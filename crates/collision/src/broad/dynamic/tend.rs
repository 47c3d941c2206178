//! How a tree that many small changes have spoilt is mended bit by bit.
//!
//! # Method
//! A leaf that is put in anew finds the best place that there is, but the nodes there were made for other leaves. So after
//! each batch some subtrees of a few dozen leaves are built anew: those around one leaf after the other, in order of their
//! numbers, as many leaves in all as a share of what changed. So a tick pays in proportion to its edits, a world that stands
//! pays nothing, and one that goes on moving is built anew, part by part, every few ticks.
//!
//! # Source
//! Rebuilding treelets in passing: Karras and Aila, "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies",
//! HPG 2013, whose treelets are chosen and optimised otherwise.

use super::{DynamicTree, Place, links::ROOT};
use crate::broad::node::LANES;

/// A leaf is built anew for so many that changed their place. Fewer make ticks dearer: with one for each, a move costs
/// twice as much. More mend more slowly.
const CHANGES_PER_TENDED: usize = 8;
/// Leaves of a subtree that is built anew, at most.
const SUBTREE_MAX: usize = 64;

impl DynamicTree {
    /// Builds some subtrees anew, in proportion to what changed since the last time.
    pub(super) fn tend(&mut self) {
        let mut left = self.changed_count / CHANGES_PER_TENDED;
        self.changed_count %= CHANGES_PER_TENDED;
        while left > 0 {
            self.tended = (self.tended + 1) % self.places.len() as u32;
            let tended_count = match self.places[self.tended as usize] {
                Place::Lane { cell, lane } => self.rebuild_around(cell, lane / LANES as u32),
                Place::Absent | Place::Large(_) | Place::Waiting(_) => 1,
            };
            left = left.saturating_sub(tended_count);
        }
    }

    /// Builds the largest subtree anew that holds a node and is no larger than it may be; how many leaves it has.
    fn rebuild_around(&mut self, cell: u16, node: u32) -> usize {
        let mut top = node;
        while self.parents[top as usize] < ROOT {
            let above = self.parents[top as usize] / LANES as u32;
            if self.leaf_count_below(above, SUBTREE_MAX) > SUBTREE_MAX {
                break;
            }
            top = above;
        }
        let parent = self.parents[top as usize];
        let mut items = Vec::with_capacity(SUBTREE_MAX);
        self.take_apart(top, &mut items);
        self.build_below(cell, parent, &mut items);
        items.len()
    }
}
