//! What a search has still to look at, and where that begins.
//!
//! # Method
//! Both are packed into one number, so that the nearer of two is the smaller number, found without a branch: no processor
//! foresees which of two boxes a path enters first. Most nodes have one or two boxes that qualify.

use smallvec::SmallVec;

use super::{
    node::{Child, Lanes, Node},
    wide::Wide,
};

/// Something to look at, and where it begins. Of two, the one that begins earlier is less.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Open(u64);

/// What a search has still to look at. There is room for a usual tree, so that a search asks for no memory.
pub(super) type Opens = SmallVec<[Open; 128]>;

impl Open {
    /// `begins` is at least 0.
    #[inline]
    pub(super) fn new(begins: f32, child: Child) -> Self {
        // The bits of such floats are in their order, but for the sign of −0.
        Self(u64::from(begins.to_bits() & 0x7fff_ffff) << 32 | u64::from(child.bits()))
    }

    #[inline]
    pub(super) fn begins(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline]
    pub(super) fn child(self) -> Child {
        Child::of_bits(self.0 as u32)
    }
}

/// The lane to go on with, which is the nearest; the others are put on a stack so that the nearer ones come off first.
#[inline(always)]
pub(super) fn push_but_nearest(opens: &mut Opens, node: &Node, mut lanes: Lanes, entries: Wide) -> Option<Open> {
    let entries = entries.to_array();
    let open = |lane: usize| Open::new(entries[lane], node.children[lane]);
    let mut nearest = open(lanes.next()?);
    let base = opens.len();
    for lane in lanes {
        let other = open(lane);
        opens.push(nearest.max(other));
        nearest = nearest.min(other);
    }
    if opens.len() > base + 1 {
        sort(&mut opens[base..]);
    }
    Some(nearest)
}

/// Adds one to those that are in order, the farthest first. What is found later mostly lies nearer, so its place is sought from there.
#[inline]
pub(super) fn push_in_order(opens: &mut Opens, found: Open) {
    opens.push(found);
    sink_last(opens);
}

/// The farthest first. There are few, and they are nearly so.
#[inline(never)]
fn sort(opens: &mut [Open]) {
    for end in 2..=opens.len() {
        sink_last(&mut opens[..end]);
    }
}

/// Puts the last one where it belongs among the others, which are in order.
#[inline]
fn sink_last(opens: &mut [Open]) {
    for at in (1..opens.len()).rev() {
        if opens[at - 1] >= opens[at] {
            break;
        }
        opens.swap(at - 1, at);
    }
}
