//! A tree over boxes that do not change: built whole, searched often.
//!
//! # Method
//! Top down; each range of boxes is cut where the surface-area heuristic is least, over 16 bins on each of three axes.
//! Leaves hold up to four. Boxes with equal centres are halved by index, and so is, along the widest axis, whatever is
//! still too large at level 48, so that the depth is bounded whatever comes in.
//!
//! # Source
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007.

use glam::DVec3;

use super::{
    Tree,
    traverse::{Expanded, NodeIndex},
};
use crate::math::Aabb;

/// A tree over boxes that do not change. A leaf number is the index of a box in the slice it was built from.
#[derive(Clone, Debug, Default)]
pub struct StaticTree {
    nodes: Vec<Node>,
    leaves: Vec<u32>,
    depth: u32,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// First of `count` leaves, or, if `count` is 0, the first of two nodes.
    first: u32,
    count: u32,
}

/// Leaves of a node at most.
const LEAF_MAX: usize = 4;
/// Bins on each axis.
const BINS: usize = 16;
/// Below this level ranges are halved: 32 more levels are enough for all numbers of a `u32`.
const DEPTH_OF_HALVING: u32 = 48;

impl StaticTree {
    /// Builds a tree over `boxes`, fewer than 2³¹ of them, with finite corners. About 0.3 µs a box.
    ///
    /// # Panics
    /// If there are 2³¹ boxes or more.
    #[must_use]
    pub fn build(boxes: &[Aabb]) -> Self {
        let count = u32::try_from(boxes.len()).expect("fewer than 2^31 boxes");
        assert!(count < 1 << 31, "fewer than 2^31 boxes");
        if boxes.is_empty() {
            return Self::default();
        }
        let mut builder = Builder {
            boxes,
            centers: boxes.iter().map(|bounds| bounds.center()).collect(),
            nodes: Vec::with_capacity(boxes.len() / 2 + 1),
            leaves: (0..count).collect(),
            depth: 0,
        };
        builder.run();
        builder.nodes.shrink_to_fit();
        Self { nodes: builder.nodes, leaves: builder.leaves, depth: builder.depth }
    }

    /// How many boxes it was built from.
    #[must_use]
    pub fn len(&self) -> usize {
        self.leaves.len()
    }

    /// Whether it was built from none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Levels, the root's being the first; at most 80.
    #[must_use]
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// Its cost by the surface-area heuristic, m²: the half areas of all nodes, those of leaves once more for each box in
    /// them. Compares with [`super::DynamicTree::area_sum`].
    #[must_use]
    pub fn area_sum(&self) -> f64 {
        self.nodes.iter().map(|node| node.bounds.half_area() * f64::from(1 + node.count)).sum()
    }

    /// Bytes it holds in memory.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        let nodes = self.nodes.capacity() * size_of::<Node>();
        let leaves = self.leaves.capacity() * size_of::<u32>();
        (size_of::<Self>() + nodes + leaves) as u64
    }
}

impl Tree for StaticTree {
    fn root(&self) -> Option<(NodeIndex, &Aabb)> {
        self.nodes.first().map(|root| (NodeIndex(0), &root.bounds))
    }

    fn expand(&self, node: NodeIndex) -> Expanded<'_> {
        let node = &self.nodes[node.0 as usize];
        let first = node.first as usize;
        if node.count > 0 {
            return Expanded::Leaves(&self.leaves[first..first + node.count as usize]);
        }
        Expanded::Children([
            (NodeIndex(node.first), &self.nodes[first].bounds),
            (NodeIndex(node.first + 1), &self.nodes[first + 1].bounds),
        ])
    }
}

struct Builder<'a> {
    boxes: &'a [Aabb],
    centers: Vec<DVec3>,
    nodes: Vec<Node>,
    leaves: Vec<u32>,
    depth: u32,
}

/// A range of `leaves` that is to become the node `node`.
struct Pending {
    node: usize,
    begin: usize,
    end: usize,
    level: u32,
}

/// Where to cut: everything in bins up to and with `last_left_bin` goes left.
struct Cut {
    axis: usize,
    last_left_bin: usize,
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: usize,
}

const NOTHING: Aabb = Aabb::new(DVec3::INFINITY, DVec3::NEG_INFINITY);

impl Builder<'_> {
    fn run(&mut self) {
        let mut pending = vec![Pending { node: 0, begin: 0, end: self.leaves.len(), level: 1 }];
        self.nodes.push(self.leaf(0, self.leaves.len()));
        while let Some(Pending { node, begin, end, level }) = pending.pop() {
            self.depth = self.depth.max(level);
            if end - begin <= LEAF_MAX {
                continue;
            }
            let middle = self.split(begin, end, level);
            let first = self.nodes.len();
            self.nodes.push(self.leaf(begin, middle));
            self.nodes.push(self.leaf(middle, end));
            self.nodes[node].first = index(first);
            self.nodes[node].count = 0;
            let level = level + 1;
            pending.push(Pending { node: first, begin, end: middle, level });
            pending.push(Pending { node: first + 1, begin: middle, end, level });
        }
    }

    fn leaf(&self, begin: usize, end: usize) -> Node {
        let boxes = self.leaves[begin..end].iter().map(|&leaf| self.boxes[leaf as usize]);
        Node { bounds: boxes.fold(NOTHING, Aabb::union), first: index(begin), count: index(end - begin) }
    }

    /// Reorders a range of leaves and says where its right part begins; neither part is empty.
    fn split(&mut self, begin: usize, end: usize, level: u32) -> usize {
        let range = &mut self.leaves[begin..end];
        let centers = &self.centers;
        let (low, high) = range.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &leaf| {
            let center = centers[leaf as usize];
            (low.min(center), high.max(center))
        });
        let half = range.len() / 2;
        let extent = high - low;
        if extent.max_element() <= 0.0 {
            return begin + half;
        }
        let cut = if level < DEPTH_OF_HALVING { best_cut(range, self.boxes, centers, low, extent) } else { None };
        let Some(cut) = cut else {
            let axis = extent.max_position();
            range.select_nth_unstable_by(half, |&a, &b| {
                let (center_a, center_b) = (centers[a as usize][axis], centers[b as usize][axis]);
                center_a.total_cmp(&center_b).then(a.cmp(&b))
            });
            return begin + half;
        };
        let is_left = |leaf: u32| {
            let offset = centers[leaf as usize][cut.axis] - low[cut.axis];
            bin_of(offset, extent[cut.axis]) <= cut.last_left_bin
        };
        begin + partition(range, is_left)
    }
}

/// The cut of least cost: area times number of boxes, summed over both sides. Among equals the most even one, which
/// matters where all areas are 0. `None` if all boxes are in one bin on each axis.
fn best_cut(range: &[u32], boxes: &[Aabb], centers: &[DVec3], low: DVec3, extent: DVec3) -> Option<Cut> {
    let mut best: Option<(f64, usize, Cut)> = None;
    for axis in 0..3 {
        if extent[axis] <= 0.0 {
            continue;
        }
        let mut bins = [Bin { bounds: NOTHING, count: 0 }; BINS];
        for &leaf in range {
            let bin = &mut bins[bin_of(centers[leaf as usize][axis] - low[axis], extent[axis])];
            bin.bounds = bin.bounds.union(boxes[leaf as usize]);
            bin.count += 1;
        }
        let mut right = [Bin { bounds: NOTHING, count: 0 }; BINS];
        let mut sum = Bin { bounds: NOTHING, count: 0 };
        for position in (1..BINS).rev() {
            sum = merge(sum, bins[position]);
            right[position - 1] = sum;
        }
        let mut left = Bin { bounds: NOTHING, count: 0 };
        for last_left_bin in 0..BINS - 1 {
            left = merge(left, bins[last_left_bin]);
            let right = right[last_left_bin];
            if left.count == 0 || right.count == 0 {
                continue;
            }
            let cost = left.bounds.half_area() * left.count as f64 + right.bounds.half_area() * right.count as f64;
            let imbalance = left.count.abs_diff(right.count);
            let is_better = best
                .as_ref()
                .is_none_or(|(least, most_even, _)| cost < *least || (cost <= *least && imbalance < *most_even));
            if is_better {
                best = Some((cost, imbalance, Cut { axis, last_left_bin }));
            }
        }
    }
    best.map(|(_, _, cut)| cut)
}

fn merge(a: Bin, b: Bin) -> Bin {
    Bin { bounds: a.bounds.union(b.bounds), count: a.count + b.count }
}

/// The bin of a centre that lies `offset` after the first of centres that extend over `extent`. Monotone in `offset`,
/// so that a cut between bins is a cut between centres.
fn bin_of(offset: f64, extent: f64) -> usize {
    ((offset / extent * BINS as f64) as usize).min(BINS - 1)
}

/// Brings those that are `left` to the front and says how many there are.
fn partition(range: &mut [u32], is_left: impl Fn(u32) -> bool) -> usize {
    let mut count = 0;
    for position in 0..range.len() {
        if is_left(range[position]) {
            range.swap(count, position);
            count += 1;
        }
    }
    count
}

/// Node and leaf numbers fit: there are fewer than 2³¹ boxes, and fewer nodes than twice that.
fn index(position: usize) -> u32 {
    position as u32
}
