//! Which shapes differ between two versions.
//!
//! # Method
//! Versions share the pages that no edit wrote between them, so only the shapes of other pages are compared. Versions of
//! unrelated worlds share none: then all shapes are compared, and the answer is the same.

use std::sync::Arc;

use super::{Shape, ShapeId, Snapshot};
use crate::math::Pose;

impl Snapshot {
    /// The shapes that are in one of two versions only, or that some question about overlaps could tell apart, by id.
    pub(super) fn changed_since(&self, old: &Self) -> Vec<ShapeId> {
        self.differing_from(old, is_alike)
    }

    /// The shapes that are in one of two versions only, or that are not alike in both, by id.
    pub(super) fn differing_from(&self, old: &Self, is_alike: fn(&Shape, &Shape) -> bool) -> Vec<ShapeId> {
        let (old, new) = (old.state(), self.state());
        let mut ids = Vec::new();
        for slot in new.shapes.unshared_slots(&old.shapes) {
            let [before, after] = [old, new].map(|state| state.shapes.get(slot).map(|entry| entry.shape()));
            if is_other(before, after, is_alike) {
                ids.extend(before.into_iter().chain(after).map(|shape| shape.id));
            }
        }
        ids.sort_unstable();
        ids.dedup();
        // What only went to another slot is the same shape.
        ids.retain(|&id| {
            let [before, after] = [old, new].map(|state| state.get(id).map(|entry| entry.shape()));
            is_other(before, after, is_alike)
        });
        ids
    }
}

fn is_other(before: Option<&Shape>, after: Option<&Shape>, is_alike: fn(&Shape, &Shape) -> bool) -> bool {
    match (before, after) {
        (None, None) => false,
        (Some(before), Some(after)) => !is_alike(before, after),
        (Some(_), None) | (None, Some(_)) => true,
    }
}

/// Whether no question about overlaps can tell them apart.
fn is_alike(a: &Shape, b: &Shape) -> bool {
    pose_bits(&a.pose) == pose_bits(&b.pose) && is_same_but_for_motion(a, b)
}

/// Whether no question about overlaps can tell them apart when they are at the same pose.
pub(super) fn is_same_but_for_motion(a: &Shape, b: &Shape) -> bool {
    let flags = |shape: &Shape| (shape.id, shape.layers, shape.collides_with, shape.group, shape.sensor);
    flags(a) == flags(b)
        && a.mobility == b.mobility
        && (Arc::ptr_eq(&a.geometry, &b.geometry) || a.geometry.id() == b.geometry.id())
}

/// A pose as it was sent: −0 is not 0, since the order of a pair's arguments tells them apart.
pub(super) fn pose_bits(pose: &Pose) -> [u64; 7] {
    let ([x, y, z], [i, j, k, w]) = (pose.position.to_array(), pose.rotation.to_array());
    [x, y, z, i, j, k, w].map(f64::to_bits)
}
