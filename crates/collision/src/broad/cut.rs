//! Where a range of boxes is cut in two.
//!
//! # Method
//! Where the surface-area heuristic is least, over bins of centres on each axis: 16, or 8 for few boxes. A side counts as many boxes as fill
//! its nodes, so that nodes are full. Boxes with equal centres are halved by position.
//!
//! A box goes into its bins four numbers at a time, and the areas of what lies before and after each bin are taken of four bins
//! at a time. Which side a box is on is told without a branch, for no processor foresees it.
//!
//! # Source
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007.

use glam::{Mat4, Vec3A, Vec4};

use super::{
    item::{Corners, Item},
    local::LocalBox,
    node::LANES,
};

/// Bins on each axis, and for few boxes.
const BINS: usize = 16;
const BINS_FOR_FEW: usize = 8;
/// Fewer boxes than this are few.
const FEW: usize = 32;
/// From here on f32 has no fractions; the bits of a number are this one's plus what is added to it.
const WHOLE: f32 = 8_388_608.0;

/// A range of items that was cut: how many are on the left, which is the beginning, and the boxes of both sides.
pub(super) struct Halves {
    pub(super) count: usize,
    pub(super) left: LocalBox,
    pub(super) right: LocalBox,
}

/// Reorders at least two items into a left and a right side; neither is empty.
pub(super) fn cut(range: &mut [Item], is_by_cost: bool) -> Halves {
    let (low, high) = bounds_of_centers(range);
    let extent = high - low;
    let best = match range.len() {
        _ if !is_by_cost => None,
        0..FEW => Bins::<BINS_FOR_FEW>::of(range, low, extent).best_cut(range.len()),
        _ => Bins::<BINS>::of(range, low, extent).best_cut(range.len()),
    };
    match best {
        Some(cut) => cut.apply(range),
        None => halves(range, extent),
    }
}

/// The least and the greatest of what is twice each centre.
fn bounds_of_centers(range: &[Item]) -> (Vec3A, Vec3A) {
    let (twos, rest) = range.as_chunks::<2>();
    let of_rest = |(low, high): (Vec3A, Vec3A), item: &Item| {
        let center = item.bounds().center_doubled();
        (low.min(center), high.max(center))
    };
    let begun = rest.iter().fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), of_rest);
    // Two at a time, so that half as many wait for the one before.
    twos.iter().fold(begun, |(low, high), two| {
        let [a, b] = [0, 1].map(|at| two[at].bounds().center_doubled());
        (low.min(a.min(b)), high.max(a.max(b)))
    })
}

/// Halves a range along its widest axis, equal centres by position.
fn halves(range: &mut [Item], extent: Vec3A) -> Halves {
    let count = range.len() / 2;
    if extent.max_element() > 0.0 {
        let axis = extent.max_position();
        range.select_nth_unstable_by(count, |a, b| {
            let (center_a, center_b) = (a.bounds().center_doubled()[axis], b.bounds().center_doubled()[axis]);
            center_a.total_cmp(&center_b).then(a.leaf().cmp(&b.leaf()))
        });
    }
    let (left, right) = range.split_at(count);
    Halves { count, left: bounds_of(left), right: bounds_of(right) }
}

/// The box of all items.
pub(super) fn bounds_of(items: &[Item]) -> LocalBox {
    items.iter().fold(Corners::NOTHING, |all, item| all.union(item.corners)).bounds()
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
        let bins = (item.bounds().center_doubled() - self.low) * self.scale - Vec3A::splat(0.5);
        let whole = bins.max(Vec3A::ZERO).min(self.last) + Vec3A::splat(WHOLE);
        whole.to_array().map(|bin| (bin.to_bits() & 0xff) as usize)
    }
}

/// What is in each bin of each axis.
struct Bins<const N: usize> {
    grid: Grid,
    boxes: [[Corners; N]; 3],
    counts: [[i32; N]; 3],
}

/// Where to cut: everything in bins of `axis` before `first_right_bin` goes left.
struct Cut {
    grid: Grid,
    axis: usize,
    first_right_bin: usize,
    left: LocalBox,
    right: LocalBox,
}

impl<const N: usize> Bins<N> {
    fn of(range: &[Item], low: Vec3A, extent: Vec3A) -> Self {
        let grid = Grid::new(low, extent, N);
        let mut bins = Self { grid, boxes: [[Corners::NOTHING; N]; 3], counts: [[0; N]; 3] };
        // Neighbours in the range tend to be in one bin, where each has to wait for the one before it.
        let (first, second) = range.split_at(range.len() / 2);
        for (at, item) in second.iter().enumerate() {
            bins.add(item);
            if let Some(item) = first.get(at) {
                bins.add(item);
            }
        }
        bins
    }

    #[inline(always)]
    fn add(&mut self, item: &Item) {
        for (axis, bin) in self.grid.bins_of(item).into_iter().enumerate() {
            let bin = bin % N;
            self.boxes[axis][bin] = self.boxes[axis][bin].union(item.corners);
            self.counts[axis][bin] += 1;
        }
    }

    /// The cut of least cost; among equals the most even one, which matters where all areas are 0. `None` if all of `count` boxes
    /// are in one bin on each axis.
    fn best_cut(&self, count: usize) -> Option<Cut> {
        let costs = [0, 1, 2].map(|axis| self.costs(axis, count as i32));
        let mut least = Vec4::INFINITY;
        for cost in costs.iter().flat_map(|costs| fours(costs)) {
            least = Vec4::select(cost.cmplt(least), cost, least);
        }
        let least = Vec4::splat(least.min_element());
        let mut best: Option<(i32, usize, usize)> = None;
        for (axis, costs) in costs.iter().enumerate() {
            for (four, cost) in fours(costs).enumerate() {
                let mut equal = cost.cmpeq(least).bitmask();
                while equal != 0 {
                    let bin = 4 * four + equal.trailing_zeros() as usize;
                    equal &= equal - 1;
                    let left_count: i32 = self.counts[axis][..bin].iter().sum();
                    let imbalance = (2 * left_count - count as i32).abs();
                    if best.is_none_or(|(least, ..)| imbalance < least) {
                        best = Some((imbalance, axis, bin));
                    }
                }
            }
        }
        let (_, axis, first_right_bin) = best?;
        let (left, right) = self.boxes[axis].split_at(first_right_bin);
        let [left, right] = [left, right].map(|boxes| boxes.iter().fold(Corners::NOTHING, |all, &bin| all.union(bin)));
        Some(Cut { grid: self.grid, axis, first_right_bin, left: left.bounds(), right: right.bounds() })
    }

    /// What a cut before each bin costs: of both sides the half area times the nodes that hold its boxes. NaN, which is 0 nodes times an
    /// infinite area, where one side is empty.
    #[inline]
    fn costs(&self, axis: usize, count: i32) -> [f32; N] {
        let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
        let nodes = |count: i32| ((count + (LANES as i32 - 1)) / LANES as i32) as f32;
        let mut costs = [0.0; N];
        let mut before = [0; N];
        for bin in 1..N {
            before[bin] = before[bin - 1] + counts[bin - 1];
        }
        let mut left = Corners::NOTHING;
        for four in (0..N).step_by(4) {
            let areas = half_areas([0, 1, 2, 3].map(|at| {
                let before = left;
                left = left.union(boxes[four + at]);
                before
            }));
            for at in 0..4 {
                costs[four + at] = areas[at] * nodes(before[four + at]);
            }
        }
        let mut right = Corners::NOTHING;
        for four in (0..N).step_by(4).rev() {
            let areas = half_areas([3, 2, 1, 0].map(|at| {
                right = right.union(boxes[four + at]);
                right
            }));
            for at in 0..4 {
                costs[four + at] += areas[3 - at] * nodes(count - before[four + at]);
            }
        }
        costs
    }
}

/// Four numbers at a time.
#[inline]
fn fours(numbers: &[f32]) -> impl Iterator<Item = Vec4> + '_ {
    numbers.chunks_exact(4).map(Vec4::from_slice)
}

/// The half areas of four boxes, infinite for one that holds nothing.
#[inline]
fn half_areas(boxes: [Corners; 4]) -> [f32; 4] {
    let [a, b, c, d] = boxes.map(|corners| corners.high - corners.low);
    let extents = Mat4::from_cols(a, b, c, d).transpose();
    let (x, y, z) = (extents.x_axis, extents.y_axis, extents.z_axis);
    (x * y + y * z + z * x).to_array()
}

impl Cut {
    /// Brings what goes left to the front.
    fn apply(&self, range: &mut [Item]) -> Halves {
        let (low, scale, limit) = (self.grid.low[self.axis], self.grid.scale[self.axis], self.limit());
        let mut count = 0;
        for at in 0..range.len() {
            let is_left = (range[at].center_doubled(self.axis) - low) * scale - 0.5 <= limit;
            // What is between the two positions goes right, in any order.
            let (item, other) = (range[at].corners, range[count].corners);
            range[at].corners = Corners { low: other.low, high: other.high };
            range[count].corners = Corners { low: item.low, high: item.high };
            count += usize::from(is_left);
        }
        Halves { count, left: self.left, right: self.right }
    }

    /// The greatest number that [`Grid::bins_of`] makes whole to less than the first bin on the right: halves go to the even side.
    fn limit(&self) -> f32 {
        let half = self.first_right_bin as f32 - 0.5;
        if self.first_right_bin % 2 == 1 { half } else { half.next_down() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Dice(u64);

    impl Dice {
        /// From 0 to 1.
        fn number(&mut self) -> f32 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f32 / (1_u64 << 24) as f32
        }

        fn vector(&mut self) -> Vec3A {
            Vec3A::new(self.number(), self.number(), self.number())
        }

        /// With coordinates on a coarse grid now and then, so that centres are equal and lie between bins.
        fn items(&mut self, count: usize, steps: f32) -> Vec<Item> {
            let rounded = |v: Vec3A| if steps > 0.0 { (v * steps).floor() / steps } else { v };
            let item = |leaf: usize| {
                let min = rounded(self.vector() * Vec3A::new(8.0, 1.0, 3.0));
                let bounds = LocalBox { min, max: min + rounded(self.vector() * 0.5) };
                Item::new(bounds, leaf as u32, u32::MAX - leaf as u32)
            };
            (0..count).map(item).collect()
        }
    }

    fn cost(items: &[&Item]) -> f32 {
        let bounds = items.iter().fold(LocalBox::NOTHING, |all, item| all.union(item.bounds()));
        bounds.half_area() * items.len().div_ceil(LANES) as f32
    }

    /// Against all cuts between bins, each looked at by itself.
    fn check<const N: usize>(items: &mut [Item]) -> usize {
        let (low, high) = bounds_of_centers(items);
        let grid = Grid::new(low, high - low, N);
        let cuts = (0..3).flat_map(|axis| (1..N).map(move |bin| (axis, bin)));
        let costs = cuts.filter_map(|(axis, bin)| {
            let (left, right): (Vec<&Item>, Vec<&Item>) = items.iter().partition(|item| grid.bins_of(item)[axis] < bin);
            let is_cut = !left.is_empty() && !right.is_empty();
            is_cut.then(|| (cost(&left) + cost(&right), left.len().abs_diff(right.len())))
        });
        let least = costs.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let Some(cut) = Bins::<N>::of(items, low, high - low).best_cut(items.len()) else {
            assert!(least.is_none());
            return 0;
        };
        let mut leaves: Vec<u32> = items.iter().map(Item::leaf).collect();
        let Halves { count, left, right } = cut.apply(items);
        let (on_left, on_right) = items.split_at(count);
        let is_left = |item: &Item| grid.bins_of(item)[cut.axis] < cut.first_right_bin;
        assert!(on_left.iter().all(is_left) && !on_right.iter().any(is_left));
        assert_eq!((left, right), (bounds_of(on_left), bounds_of(on_right)));
        let [a, b] = [on_left, on_right].map(|side| cost(&side.iter().collect::<Vec<_>>()));
        assert_eq!(Some((a + b, on_left.len().abs_diff(on_right.len()))), least);
        assert!(items.iter().all(|item| item.layers() == u32::MAX - item.leaf()), "what belongs together stays so");
        leaves.sort_unstable();
        assert!(leaves.iter().copied().eq(0..leaves.len() as u32));
        1
    }

    #[test]
    fn a_range_is_cut_where_it_costs_least() {
        let mut dice = Dice(1);
        let mut cut = 0;
        for round in 0..600 {
            let steps = [0.0, 1.0, 4.0, 16.0][round % 4];
            let count = 2 + round % 61;
            cut += check::<8>(&mut dice.items(count, steps)) + check::<16>(&mut dice.items(count, steps));
        }
        assert!(cut > 1000, "{cut}");
        let same = Item::new(LocalBox { min: Vec3A::ONE, max: Vec3A::ONE }, 0, 1);
        assert_eq!(check::<8>(&mut [same]), 0);
        let Halves { count, left, right } = super::cut(&mut [same; 5], true);
        assert_eq!((count, left, right), (2, same.bounds(), same.bounds()), "by position");
    }
}
