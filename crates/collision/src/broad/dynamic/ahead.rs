//! What changing a leaf will want to read, asked for before it is wanted.
//!
//! # Method
//! To change a leaf is to read where it is, the node there, where that is and the node above, one after the other, and in a tree
//! larger than the caches each is waited for. Of several leaves these are read side by side, step by step: what is waited for is
//! on its way at once.

use std::hint::black_box;

use super::{DynamicTree, Place, links::ROOT};
use crate::broad::{node::LANES, wide::Wide};

/// Leaves that are read together: more than a processor can wait for at once gain nothing.
const TOGETHER: usize = 32;
/// Nodes from which on it pays; fewer are in the caches already.
const NODES_MIN: usize = 1024;

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

    /// Reads something of each line of memory that holds boxes of a lane's node; what comes out means nothing.
    fn read_node(&self, lane: u32) -> u32 {
        let [x, _, z, _, upper_y, _]: &[Wide; 6] = &self.forest.nodes[lane as usize / LANES].planes;
        [x, z, upper_y].map(|plane| plane.get(0).to_bits()).into_iter().fold(0, |all, bits| all ^ bits)
    }
}
