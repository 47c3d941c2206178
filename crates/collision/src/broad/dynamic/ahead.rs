//! What changing a leaf will want to read, asked for before it is wanted.
//!
//! # Method
//! To change a leaf is to read where it is, the node there, where that is and the node above, one after the other, and in a tree
//! larger than the caches each is waited for. Of several leaves these are read side by side, step by step: what is waited for is
//! on its way at once. The way of a new leaf is gone without it first, and what was read is of use even where leaves that are put in
//! before it change that way.

use std::hint::black_box;

use smallvec::SmallVec;

use super::{DynamicTree, Place, links::ROOT};
use crate::broad::{
    item::Item,
    node::{LANES, Target},
    wide::Wide,
};

/// Leaves that are read together: more than a processor can wait for at once gain nothing.
pub(super) const TOGETHER: usize = 32;
/// Nodes from which on it pays; fewer are in the caches already.
const NODES_MIN: usize = 1024;
/// The same for the ways of new leaves, which cost more to go twice.
const NODES_MIN_FOR_WAYS: usize = 8192;

impl DynamicTree {
    /// Reads what changing these leaves will want, so that those changes need not wait for it one after the other: to be called before
    /// some dozens of them. Changes nothing; leaves that are not in the tree are passed over.
    pub fn read_ahead(&self, leaves: impl IntoIterator<Item = u32>) {
        if self.parents.len() < NODES_MIN {
            return;
        }
        let mut leaves = leaves.into_iter();
        loop {
            let mut lanes = [0; TOGETHER];
            let mut count = 0;
            for (lane, leaf) in lanes.iter_mut().zip(&mut leaves) {
                *lane = match self.places.get(leaf as usize) {
                    Some(Place::Lane { lane, .. }) => *lane,
                    Some(Place::Absent | Place::Large(_) | Place::Waiting(_)) | None => 0,
                };
                count += 1;
            }
            let lanes = &mut lanes[..count];
            black_box(lanes.iter().fold(0, |all, &lane| all ^ self.read_node(lane)));
            for lane in lanes.iter_mut() {
                let parent = self.parents[*lane as usize / LANES];
                *lane = if parent < ROOT { parent } else { 0 };
            }
            black_box(lanes.iter().fold(0, |all, &lane| all ^ self.read_node(lane)));
            if count < TOGETHER {
                return;
            }
        }
    }

    /// Reads the nodes on the ways of leaves that are to be put in, down from a root, level by level for all of them.
    pub(super) fn read_ahead_of_ways(&self, root: u32, leaves: &[Item]) {
        if self.parents.len() < NODES_MIN_FOR_WAYS {
            return;
        }
        let mut ways: SmallVec<[(u32, [Wide; 6]); TOGETHER]> =
            leaves.iter().map(|item| (root, item.bounds().splat())).collect();
        while !black_box(&mut ways).is_empty() {
            ways.retain(|(index, planes)| {
                let node = &self.forest.nodes[*index as usize];
                let [(_, below), _] = node.least_growths(planes);
                match node.children[below].target() {
                    Target::Node(below) if node.free_lane().is_none() => {
                        *index = below;
                        true
                    }
                    Target::Node(_) | Target::Leaf(_) | Target::Nothing => false,
                }
            });
        }
    }

    /// Reads something of each line of memory that holds boxes of a lane's node; what comes out means nothing.
    fn read_node(&self, lane: u32) -> u32 {
        self.forest.nodes[lane as usize / LANES].read_planes_ahead()
    }
}
