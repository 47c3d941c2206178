//! Builds nodes over many boxes at once.
//!
//! # Method
//! Top down. A range of boxes becomes a node: it is cut in two, and the part of largest area in two again, until each part
//! fits a node of its own or there are as many parts as a node has lanes. Lanes that are left take in boxes that lie far out
//! in their part, whose node then is smaller. A cut is made where the surface-area heuristic is least, over 16 bins of centres
//! on each axis; a part counts as many boxes as fill its nodes, so that nodes are full. Boxes with equal centres are halved by
//! position, and so is, along the widest axis, whatever is still too large after as many levels as the logarithm of the
//! number of boxes, so that the depth is bounded whatever comes in.
//!
//! # Source
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007; wide nodes by opening the largest part:
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
    /// The lane that leads to each node, as `LANES * node + lane`; `u32::MAX` for the root.
    pub(super) parents: Vec<u32>,
    /// Levels, the root's being the first.
    pub(super) depth: u32,
}

/// Bins on each axis, and for few boxes.
const BINS: usize = 16;
const BINS_FOR_FEW: usize = 8;
/// From here on f32 has no fractions; the bits of a number are this one's plus what is added to it.
const WHOLE: f32 = 8_388_608.0;
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

/// The parts that become the lanes of a node.
type Parts = SmallVec<[Part; LANES]>;

/// The parts of a part that become the lanes of its node. What fits a node of its own is not cut, so that nodes are full
/// rather than many. Lanes that are left take single boxes out of such parts, each time the one without which its part is
/// smaller by most.
fn cut_up(parts: &mut Parts, items: &mut [Item], whole: Part, is_by_cost: bool) {
    parts.clear();
    if whole.len() <= LANES {
        let single = |at: usize| Part { begin: at, end: at + 1, bounds: items[at].bounds };
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
            after[at - 1] = after[at].union(items[part.begin + at].bounds);
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
            before = before.union(items[item].bounds);
        }
        best
    }

    /// Takes the item out of its part.
    fn leave(&self, items: &mut [Item], part: &mut Part) -> Part {
        let last = part.end - 1;
        items.swap(self.item, last);
        (part.end, part.bounds) = (last, self.rest);
        Part { begin: last, end: last + 1, bounds: items[last].bounds }
    }
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

    /// Area times the nodes that hold its boxes.
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

    /// Numbers are made whole by adding 2²³, from where on f32 has no fractions: as a conversion that holds for any number
    /// this was a third of the time of building.
    #[inline]
    fn bins_of(&self, item: &Item) -> [usize; 3] {
        let bins = (item.bounds.center_doubled() - self.low) * self.scale - Vec3A::splat(0.5);
        let whole = bins.max(Vec3A::ZERO).min(self.last) + Vec3A::splat(WHOLE);
        whole.to_array().map(|bin| (bin.to_bits() & 0xff) as usize)
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
            // Without a branch, for no processor foresees it: what is between the two positions goes right, in any order.
            let is_left = self.grid.bins_of(&range[at])[self.axis] <= self.last_left_bin;
            range.swap(count, at);
            count += usize::from(is_left);
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
    // The cost, which is at least 0, and after it the imbalance; again without branches.
    let (mut best, mut best_at) = (u64::MAX, (0, 0));
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
            let (cost, imbalance) = (left.cost() + cost_right[last_left_bin], left.count.abs_diff(count_right));
            let is_cut = (left.count != 0) & (count_right != 0);
            let key = if is_cut { u64::from(cost.to_bits()) << 32 | imbalance as u64 } else { u64::MAX };
            best_at = if key < best { (axis, last_left_bin) } else { best_at };
            best = best.min(key);
        }
    }
    if best == u64::MAX {
        return None;
    }
    let (axis, last_left_bin) = best_at;
    let (left, right) = bins[axis].split_at(last_left_bin + 1);
    let all = |bins: &[Bin]| bins.iter().fold(LocalBox::NOTHING, |all, bin| all.union(bin.bounds));
    Some(Cut { grid, axis, last_left_bin, left: all(left), right: all(right) })
}
