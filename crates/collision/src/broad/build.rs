//! Builds nodes over many boxes at once.
//!
//! # Method
//! Top down. A range of boxes becomes a node: it is cut in two, and the part of largest area in two again, until each part
//! fits a node of its own or there are as many parts as a node has lanes. Lanes that are left take in boxes that lie far out
//! in their part, whose node then is smaller. Cuts are those of least cost (`cut.rs`); whatever is still too large after as many
//! levels as the logarithm of the number of boxes is halved along its widest axis, so that the depth is bounded whatever comes in.
//!
//! # Source
//! Wide nodes by opening the largest part: Wald, Benthin, Boulos, "Getting Rid of Packets", 2008, section 3.

use smallvec::SmallVec;

use super::{
    cut::{Halves, bounds_of, cut},
    item::Item,
    local::LocalBox,
    node::{Child, LANES, Node},
};

/// Nodes over all items, the root first, a parent before its children.
#[derive(Debug, Default)]
pub(super) struct Built {
    pub(super) nodes: Vec<Node>,
    /// The lane that leads to each node, as `LANES * node + lane`; `u32::MAX` for the root.
    pub(super) parents: Vec<u32>,
    /// Levels, the root's being the first.
    pub(super) depth: u32,
}

/// A range of items that is to become the node `node`.
struct Pending {
    node: u32,
    part: Part,
    level: u32,
}

/// A range of items and their box.
#[derive(Clone, Copy)]
struct Part {
    begin: usize,
    end: usize,
    bounds: LocalBox,
}

impl Part {
    fn len(&self) -> usize {
        self.end - self.begin
    }
}

/// Builds nodes over `items`, which it reorders; at least one. The depth is at most 3 + 1.5 log₂ of their number.
pub(super) fn build(items: &mut [Item]) -> Built {
    // About as many as there will be: nodes of 3 boxes and more are usual.
    let usual = items.len() / 4 + 1;
    let mut built = Built { nodes: Vec::with_capacity(usual), parents: Vec::with_capacity(usual), depth: 0 };
    let levels_by_cost = items.len().ilog2() + 1;
    let whole = Part { begin: 0, end: items.len(), bounds: bounds_of(items) };
    let mut pending = vec![Pending { node: 0, part: whole, level: 1 }];
    built.nodes.push(Node::EMPTY);
    built.parents.push(u32::MAX);
    let mut parts = Parts::new();
    while let Some(Pending { node, part, level }) = pending.pop() {
        built.depth = built.depth.max(level);
        cut_up(&mut parts, items, part, level <= levels_by_cost);
        for (lane, &part) in parts.iter().enumerate() {
            let (child, layers) = if let [item] = &items[part.begin..part.end] {
                (Child::leaf(item.leaf()), item.layers())
            } else {
                let below = built.nodes.len() as u32;
                built.nodes.push(Node::EMPTY);
                built.parents.push(LANES as u32 * node + lane as u32);
                pending.push(Pending { node: below, part, level: level + 1 });
                (Child::node(below), 0)
            };
            built.nodes[node as usize].set(lane, part.bounds, child, layers);
        }
    }
    for node in (1..built.nodes.len()).rev() {
        let (layers, parent) = (built.nodes[node].all_layers(), built.parents[node] as usize);
        built.nodes[parent / LANES].layers[parent % LANES] = layers;
    }
    built
}

/// The parts that become the lanes of a node.
type Parts = SmallVec<[Part; LANES]>;

/// The parts of a part that become the lanes of its node. What fits a node of its own is not cut, so that nodes are full
/// rather than many. Lanes that are left take single boxes out of such parts, each time the one without which its part is
/// smaller by most.
fn cut_up(parts: &mut Parts, items: &mut [Item], whole: Part, is_by_cost: bool) {
    parts.clear();
    if whole.len() <= LANES {
        let single = |at: usize| Part { begin: at, end: at + 1, bounds: items[at].bounds() };
        parts.extend((whole.begin..whole.end).map(single));
        return;
    }
    parts.push(whole);
    while let Some(at) = largest_to_cut(parts) {
        let (left, right) = split(items, parts[at], is_by_cost);
        parts[at] = left;
        parts.insert(at + 1, right);
    }
    if parts.len() == LANES {
        return;
    }
    let mut outliers: SmallVec<[Outlier; LANES]> = parts.iter().map(|part| Outlier::of(items, part)).collect();
    while parts.len() < LANES {
        let farthest =
            (0..outliers.len()).fold(0, |best, at| if outliers[at].less > outliers[best].less { at } else { best });
        if parts[farthest].len() == 1 {
            break;
        }
        let single = outliers[farthest].leave(items, &mut parts[farthest]);
        outliers[farthest] = Outlier::of(items, &parts[farthest]);
        parts.push(single);
    }
}

/// Which part is to be cut next: the one of largest area among those too large for a node; of equal ones the first.
fn largest_to_cut(parts: &[Part]) -> Option<usize> {
    if parts.len() == LANES {
        return None;
    }
    let mut largest: Option<(f32, usize)> = None;
    for (at, part) in parts.iter().enumerate().filter(|(_, part)| part.len() > LANES) {
        let area = part.bounds.half_area();
        if largest.is_none_or(|(other, _)| area > other) {
            largest = Some((area, at));
        }
    }
    largest.map(|(_, at)| at)
}

/// The item without which a part is smaller by most.
struct Outlier {
    item: usize,
    /// By how much the half area is less; of a single box, which stays where it is, less than any.
    less: f32,
    /// The box of the others.
    rest: LocalBox,
}

impl Outlier {
    /// That of a part of up to [`LANES`] items.
    fn of(items: &[Item], part: &Part) -> Self {
        if part.len() == 1 {
            return Self { item: part.begin, less: f32::NEG_INFINITY, rest: part.bounds };
        }
        let mut after = [LocalBox::NOTHING; LANES];
        for at in (1..part.len()).rev() {
            after[at - 1] = after[at].union(items[part.begin + at].bounds());
        }
        let area = part.bounds.half_area();
        let mut best = Self { item: part.begin, less: f32::NEG_INFINITY, rest: after[0] };
        let mut before = LocalBox::NOTHING;
        for (item, after) in (part.begin..part.end).zip(after) {
            let rest = before.union(after);
            // Of two, no node is left.
            let less = if part.len() == 2 { area } else { area - rest.half_area() };
            if less > best.less {
                best = Self { item, less, rest };
            }
            before = before.union(items[item].bounds());
        }
        best
    }

    /// Takes the item out of its part.
    fn leave(&self, items: &mut [Item], part: &mut Part) -> Part {
        let last = part.end - 1;
        items.swap(self.item, last);
        (part.end, part.bounds) = (last, self.rest);
        Part { begin: last, end: last + 1, bounds: items[last].bounds() }
    }
}

/// Reorders the items of a part into two; neither is empty.
fn split(items: &mut [Item], part: Part, is_by_cost: bool) -> (Part, Part) {
    let Halves { count, left, right } = cut(&mut items[part.begin..part.end], is_by_cost);
    let middle = part.begin + count;
    (Part { end: middle, bounds: left, ..part }, Part { begin: middle, bounds: right, ..part })
}
