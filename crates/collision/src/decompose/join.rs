//! Which parts become one.
//!
//! # Method
//! Of all pairs of parts whose boxes meet, the one whose common hull adds the least volume is tried first. If that hull is as near
//! to the mesh as is asked, it takes the place of both, and pairs with it join the queue. What does not go with one part does not go
//! with any that holds it.

use std::{
    cmp::Ordering,
    collections::{BTreeSet, BinaryHeap},
    sync::Arc,
};

use super::{
    Cancelled,
    grow::{Growing, Growth, corners_of},
};
use crate::shape::Hull;

/// Two parts that may become one.
struct Pair {
    /// What the common hull has beyond both.
    added: f64,
    parts: [usize; 2],
}

/// A part, and with which it does not go.
struct Candidate {
    part: Arc<Growing>,
    foes: BTreeSet<usize>,
}

/// Joins parts as long as two of them have a hull that is near enough.
pub(super) fn joined(growth: &mut Growth<'_>, parts: Vec<Arc<Growing>>) -> Result<Vec<Arc<Growing>>, Cancelled> {
    let candidate = |part| Some(Candidate { part, foes: BTreeSet::new() });
    let mut parts: Vec<Option<Candidate>> = parts.into_iter().map(candidate).collect();
    let mut pairs = BinaryHeap::new();
    for index in 0..parts.len() {
        growth.meter.pass()?;
        add_pairs(growth, &parts, index, &mut pairs);
    }
    while let Some(Pair { parts: [a, b], .. }) = pairs.pop() {
        growth.meter.pass()?;
        let (Some(one), Some(other)) = (&parts[a], &parts[b]) else { continue };
        if growth.meter.is_spent() {
            break;
        }
        let goal = growth.goal(growth.asked);
        // It is not cut again, so its piece is not needed.
        let made = growth.part(Arc::clone(&one.part.piece), hull_of(&one.part, &other.part), goal)?;
        if growth.is_done(&made) {
            let foes = one.foes.union(&other.foes).copied().collect();
            (parts[a], parts[b]) = (None, None);
            parts.push(Some(Candidate { part: Arc::new(made), foes }));
            add_pairs(growth, &parts, parts.len() - 1, &mut pairs);
        } else {
            for (part, foe) in [(a, b), (b, a)] {
                if let Some(part) = &mut parts[part] {
                    part.foes.insert(foe);
                }
            }
        }
    }
    Ok(parts.into_iter().flatten().map(|candidate| candidate.part).collect())
}

/// The pairs of a part with those before it.
fn add_pairs(growth: &mut Growth<'_>, parts: &[Option<Candidate>], index: usize, pairs: &mut BinaryHeap<Pair>) {
    let Some(Candidate { part, foes }) = parts[index].as_ref().filter(|_| !growth.meter.is_spent()) else { return };
    let near = part.hull.bounds().inflated(growth.asked);
    for (before, other) in parts[..index].iter().enumerate() {
        let Some(Candidate { part: other, .. }) = other.as_ref().filter(|_| !foes.contains(&before)) else { continue };
        if other.hull.bounds().intersects(near) && growth.is_done(part) && growth.is_done(other) {
            growth.meter.add(part.hull.vertices().len() + other.hull.vertices().len());
            let added = hull_of(part, other).volume() - part.volume - other.volume;
            pairs.push(Pair { added, parts: [before, index] });
        }
    }
}

fn hull_of(one: &Growing, other: &Growing) -> Hull {
    let points: Vec<_> = one.hull.vertices().iter().chain(other.hull.vertices()).copied().collect();
    corners_of(&points)
}

impl Ord for Pair {
    /// The greatest is the one that adds the least; of equals the first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.added.total_cmp(&self.added).then(other.parts.cmp(&self.parts))
    }
}

impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Pair {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Pair {}
