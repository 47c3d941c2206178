//! Builds nodes over many boxes at once.
//!
//! # Method
//! Top down. A range of boxes becomes a node: it is cut in two, and the part of largest area in two again, until there are
//! four parts or only single boxes. A cut is made where the surface-area heuristic is least, over 16 bins of centres on each
//! axis; a part counts as many boxes as fill its nodes, so that nodes are full. Boxes with equal centres are halved by
//! position, and so is, along the widest axis, whatever is still too large after as many levels as the logarithm of the
//! number of boxes, so that the depth is bounded whatever comes in.
//!
//! # Source
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007; nodes of four by opening the largest part:
//! Wald, Benthin, Boulos, "Getting Rid of Packets", 2008, section 3.

use glam::Vec3A;
use smallvec::SmallVec;

use super::{
    local::LocalBox,
    node::{Child, LANES, Node},
};

/// A box that is to become a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) bounds: LocalBox,
    pub(super) leaf: u32,
    pub(super) layers: u32,
}

/// Nodes over all items, the root first, a parent before its children.
#[derive(Debug, Default)]
pub(super) struct Built {
    pub(super) nodes: Vec<Node>,
    /// The lane that leads to each node, as `4 * node + lane`; `u32::MAX` for the root.
    pub(super) parents: Vec<u32>,
    /// Levels, the root's being the first.
    pub(super) depth: u32,
}

/// Bins on each axis, and for few boxes.
const BINS: usize = 16;
const BINS_FOR_FEW: usize = 8;
/// Fewer boxes than this are few.
const FEW: usize = 32;

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
    let mut built = Built::default();
    let levels_by_cost = items.len().ilog2() + 1;
    let whole = Part { begin: 0, end: items.len(), bounds: bounds_of(items) };
    let mut pending = vec![Pending { node: 0, part: whole, level: 1 }];
    built.nodes.push(Node::EMPTY);
    built.parents.push(u32::MAX);
    while let Some(Pending { node, part, level }) = pending.pop() {
        built.depth = built.depth.max(level);
        for (lane, part) in parts(items, part, level <= levels_by_cost).into_iter().enumerate() {
            let (child, layers) = if let [item] = &items[part.begin..part.end] {
                (Child::leaf(item.leaf), item.layers)
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

/// The parts of a part that become the lanes of its node: singles, if there are no more of them than lanes.
fn parts(items: &mut [Item], whole: Part, is_by_cost: bool) -> SmallVec<[Part; LANES]> {
    if whole.len() <= LANES {
        let single = |at: usize| Part { begin: at, end: at + 1, bounds: items[at].bounds };
        return (whole.begin..whole.end).map(single).collect();
    }
    let mut parts: SmallVec<[Part; LANES]> = SmallVec::new();
    parts.push(whole);
    while parts.len() < LANES {
        let largest = (0..parts.len())
            .filter(|&at| parts[at].len() > 1)
            .max_by(|&a, &b| parts[a].bounds.half_area().total_cmp(&parts[b].bounds.half_area()).then(b.cmp(&a)));
        // There are more items than lanes, so one part has several.
        let Some(at) = largest else { break };
        let (left, right) = split(items, parts[at], is_by_cost);
        parts[at] = left;
        parts.insert(at + 1, right);
    }
    parts
}

/// Reorders the items of a part into two; neither is empty.
fn split(items: &mut [Item], part: Part, is_by_cost: bool) -> (Part, Part) {
    let range = &mut items[part.begin..part.end];
    let centers = range.iter().map(|item| item.bounds.center_doubled());
    let (low, high) =
        centers.fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(low, high), center| (low.min(center), high.max(center)));
    let extent = high - low;
    let cut = match range.len() {
        _ if !is_by_cost => None,
        0..FEW => best_cut::<BINS_FOR_FEW>(range, low, extent),
        _ => best_cut::<BINS>(range, low, extent),
    };
    let (count, left, right) = match cut {
        Some(cut) => cut.apply(range),
        None => halves(range, extent),
    };
    let middle = part.begin + count;
    (Part { end: middle, bounds: left, ..part }, Part { begin: middle, bounds: right, ..part })
}

/// Halves a range along its widest axis, equal centres by position; how many go left, and the boxes of both halves.
fn halves(range: &mut [Item], extent: Vec3A) -> (usize, LocalBox, LocalBox) {
    let half = range.len() / 2;
    if extent.max_element() > 0.0 {
        let axis = extent.max_position();
        range.select_nth_unstable_by(half, |a, b| {
            let (center_a, center_b) = (a.bounds.center_doubled()[axis], b.bounds.center_doubled()[axis]);
            center_a.total_cmp(&center_b).then(a.leaf.cmp(&b.leaf))
        });
    }
    (half, bounds_of(&range[..half]), bounds_of(&range[half..]))
}

fn bounds_of(items: &[Item]) -> LocalBox {
    items.iter().fold(LocalBox::NOTHING, |all, item| all.union(item.bounds))
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: LocalBox,
    count: usize,
}

const NO_BIN: Bin = Bin { bounds: LocalBox::NOTHING, count: 0 };

impl Bin {
    fn add(&mut self, other: Self) {
        self.bounds = self.bounds.union(other.bounds);
        self.count += other.count;
    }

    /// Area times the nodes of four that hold its boxes.
    fn cost(&self) -> f32 {
        self.bounds.half_area() * self.count.div_ceil(LANES) as f32
    }
}

/// Which bin a centre is in, on each axis. Monotone, so that a cut between bins is a cut between centres.
#[derive(Clone, Copy)]
struct Grid {
    low: Vec3A,
    scale: Vec3A,
    last: Vec3A,
}

impl Grid {
    fn new(low: Vec3A, extent: Vec3A, bins: usize) -> Self {
        let scale = Vec3A::splat(bins as f32) / extent;
        // An axis without extent has one bin, and so has one so short that the scale overflows.
        let scale = Vec3A::select(scale.cmplt(Vec3A::splat(f32::MAX)), scale, Vec3A::ZERO);
        Self { low, scale, last: Vec3A::splat((bins - 1) as f32) }
    }

    fn bins_of(&self, item: &Item) -> [usize; 3] {
        let bins = ((item.bounds.center_doubled() - self.low) * self.scale).min(self.last);
        [bins.x as usize, bins.y as usize, bins.z as usize]
    }
}

/// Where to cut: everything in bins of `axis` up to and with `last_left_bin` goes left.
struct Cut {
    grid: Grid,
    axis: usize,
    last_left_bin: usize,
    left: LocalBox,
    right: LocalBox,
}

impl Cut {
    /// Brings what goes left to the front; how much that is, and the boxes of both sides.
    fn apply(&self, range: &mut [Item]) -> (usize, LocalBox, LocalBox) {
        let mut count = 0;
        for at in 0..range.len() {
            if self.grid.bins_of(&range[at])[self.axis] <= self.last_left_bin {
                range.swap(count, at);
                count += 1;
            }
        }
        (count, self.left, self.right)
    }
}

/// The cut of least cost; among equals the most even one, which matters where all areas are 0. `None` if all boxes are in
/// one bin on each axis.
fn best_cut<const BINS: usize>(range: &[Item], low: Vec3A, extent: Vec3A) -> Option<Cut> {
    let grid = Grid::new(low, extent, BINS);
    let mut bins = [[NO_BIN; BINS]; 3];
    for item in range {
        for (bins, bin) in bins.iter_mut().zip(grid.bins_of(item)) {
            bins[bin].add(Bin { bounds: item.bounds, count: 1 });
        }
    }
    let mut best: Option<(f32, usize, usize, usize)> = None;
    for (axis, bins) in bins.iter().enumerate() {
        if grid.scale[axis] == 0.0 {
            continue;
        }
        let mut cost_right = [0.0; BINS];
        let mut right = NO_BIN;
        for at in (1..BINS).rev() {
            right.add(bins[at]);
            cost_right[at - 1] = right.cost();
        }
        let mut left = NO_BIN;
        for last_left_bin in 0..BINS - 1 {
            left.add(bins[last_left_bin]);
            let count_right = range.len() - left.count;
            if left.count == 0 || count_right == 0 {
                continue;
            }
            let (cost, imbalance) = (left.cost() + cost_right[last_left_bin], left.count.abs_diff(count_right));
            let is_better =
                best.is_none_or(|(least, most_even, ..)| cost < least || (cost <= least && imbalance < most_even));
            if is_better {
                best = Some((cost, imbalance, axis, last_left_bin));
            }
        }
    }
    let (_, _, axis, last_left_bin) = best?;
    let (left, right) = bins[axis].split_at(last_left_bin + 1);
    let all = |bins: &[Bin]| bins.iter().fold(LocalBox::NOTHING, |all, bin| all.union(bin.bounds));
    Some(Cut { grid, axis, last_left_bin, left: all(left), right: all(right) })
}
