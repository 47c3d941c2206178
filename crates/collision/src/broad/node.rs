//! A node of a tree: up to eight boxes side by side, so that one test serves all of them.
//!
//! Lanes are of fixed width and the arithmetic is the same wherever it runs, so the same boxes are found on every machine.

use glam::Vec3A;
use prefetch_index::prefetch_index;

use super::{
    local::LocalBox,
    wide::{Mask, Wide},
};
use crate::tolerance;

/// Boxes of a node at most.
pub(super) use super::wide::LANES;

/// No node.
pub(super) const NO_NODE: u32 = u32::MAX >> 2;

/// What a lane leads to: nothing, a leaf or a node. A tree has fewer than 2²⁸ nodes, whose lanes are numbered with 31 bits; leaf numbers are
/// below 2²⁸. So, of the floats of these bits, that of nothing is NaN, and those of leaves alone have the sign bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Child(u32);

/// A [`Child`] taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    Nothing,
    Leaf(u32),
    Node(u32),
}

impl Child {
    pub(super) const NOTHING: Self = Self(u32::MAX);
    const LEAF: u32 = 1 << 31;

    pub(super) fn leaf(number: u32) -> Self {
        Self(Self::LEAF | number)
    }

    pub(super) fn node(index: u32) -> Self {
        Self(index)
    }

    /// As a number.
    #[inline]
    pub(super) fn bits(self) -> u32 {
        self.0
    }

    /// What had these bits.
    #[inline]
    pub(super) fn of_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// The number of what is below, which is a leaf or a node.
    #[inline]
    pub(super) fn number(self) -> u32 {
        self.0 & !Self::LEAF
    }

    #[inline]
    pub(super) fn target(self) -> Target {
        if self.0 & Self::LEAF == 0 {
            Target::Node(self.0)
        } else if self != Self::NOTHING {
            Target::Leaf(self.0 & !Self::LEAF)
        } else {
            Target::Nothing
        }
    }
}

/// Eight boxes: lower x, y, z, then upper x, y, z of all lanes; what they lead to; and the layers of everything below.
/// An empty lane has a box that nothing touches. Four cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    pub(super) planes: [Wide; 6],
    pub(super) children: [Child; LANES],
    pub(super) layers: [u32; LANES],
}

impl Default for Node {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Node {
    pub(super) const EMPTY: Self = Self {
        planes: [
            Wide::splat(f32::INFINITY),
            Wide::splat(f32::INFINITY),
            Wide::splat(f32::INFINITY),
            Wide::splat(f32::NEG_INFINITY),
            Wide::splat(f32::NEG_INFINITY),
            Wide::splat(f32::NEG_INFINITY),
        ],
        children: [Child::NOTHING; LANES],
        layers: [0; LANES],
    };

    /// Reads something of each line of memory that holds the boxes; what comes out means nothing.
    #[inline]
    pub(super) fn read_planes_ahead(&self) -> u32 {
        let [x, _, z, _, upper_y, _] = &self.planes;
        [x, z, upper_y].map(|plane| plane.get(0).to_bits()).into_iter().fold(0, |all, bits| all ^ bits)
    }

    /// Asks for the memory that it is in, but for its layers, without waiting for it: two planes to a line, then what they lead to.
    #[inline]
    pub(super) fn prefetch(&self) {
        for plane in [0, 2, 4] {
            prefetch_index(self.planes.as_slice(), plane);
        }
        prefetch_index(self.children.as_slice(), 0);
    }

    /// The box of a lane.
    pub(super) fn lane(&self, lane: usize) -> LocalBox {
        let at = |plane: usize| self.planes[plane].get(lane);
        LocalBox { min: Vec3A::new(at(0), at(1), at(2)), max: Vec3A::new(at(3), at(4), at(5)) }
    }

    /// The box of a lane, in all lanes.
    #[inline]
    pub(super) fn lane_splat(&self, lane: usize) -> [Wide; 6] {
        let at = |plane: usize| Wide::splat(self.planes[plane].get(lane));
        [at(0), at(1), at(2), at(3), at(4), at(5)]
    }

    /// Changes the box of a lane.
    pub(super) fn set_box(&mut self, lane: usize, bounds: LocalBox) {
        for axis in 0..3 {
            self.planes[axis].set(lane, bounds.min[axis]);
            self.planes[axis + 3].set(lane, bounds.max[axis]);
        }
    }

    /// Fills a lane.
    pub(super) fn set(&mut self, lane: usize, bounds: LocalBox, child: Child, layers: u32) {
        self.set_box(lane, bounds);
        self.children[lane] = child;
        self.layers[lane] = layers;
    }

    /// Empties a lane.
    pub(super) fn clear(&mut self, lane: usize) {
        self.set(lane, LocalBox::NOTHING, Child::NOTHING, 0);
    }

    /// The box of everything below.
    pub(super) fn bounds(&self) -> LocalBox {
        bounds_of(&self.planes)
    }

    /// The box of everything below if the box of a lane were another.
    pub(super) fn bounds_with(&self, lane: usize, bounds: LocalBox) -> LocalBox {
        let this = Mask::only(lane);
        let ([min_x, min_y, min_z, max_x, max_y, max_z], [min, max]) = (self.planes, [bounds.min, bounds.max]);
        bounds_of(&[
            min_x.with(this, min.x),
            min_y.with(this, min.y),
            min_z.with(this, min.z),
            max_x.with(this, max.x),
            max_y.with(this, max.y),
            max_z.with(this, max.z),
        ])
    }

    /// The layers of everything below.
    pub(super) fn all_layers(&self) -> u32 {
        self.layers.iter().fold(0, |all, layers| all | layers)
    }

    /// The half areas of its boxes, m².
    pub(super) fn area_sum(&self) -> f64 {
        self.taken().map(|lane| f64::from(self.lane(lane).half_area())).sum()
    }

    /// Gives the nodes that it leads to other numbers.
    pub(super) fn renumber(&mut self, number: impl Fn(u32) -> u32) {
        for child in &mut self.children {
            if let Target::Node(index) = child.target() {
                *child = Child::node(number(index));
            }
        }
    }

    /// The lanes that are taken.
    #[inline]
    pub(super) fn taken(&self) -> Lanes {
        Lanes(self.children_as_floats().nan() ^ ALL)
    }

    /// A lane that is free.
    #[inline]
    pub(super) fn free_lane(&self) -> Option<usize> {
        Lanes(self.children_as_floats().nan()).next()
    }

    /// The lanes that lead to nodes.
    #[inline]
    pub(super) fn nodes_below(&self) -> Lanes {
        Lanes(self.children_as_floats().negative().bits() ^ ALL)
    }

    fn children_as_floats(&self) -> Wide {
        Wide::of_bits(self.children.map(Child::bits))
    }

    /// The lanes whose boxes touch a box, given plane by plane, a bit for each.
    pub(super) fn touching(&self, query: &[Wide; 6]) -> Lanes {
        let [min_x, min_y, min_z, max_x, max_y, max_z] = &self.planes;
        let x = min_x.at_most(query[3]) & query[0].at_most(*max_x);
        let y = min_y.at_most(query[4]) & query[1].at_most(*max_y);
        let z = min_z.at_most(query[5]) & query[2].at_most(*max_z);
        Lanes::of(x & y & z)
    }

    /// Not above the squared distances of its boxes to a box, given plane by plane.
    pub(super) fn distances_sq(&self, query: &[Wide; 6]) -> Wide {
        let gap = |axis: usize| {
            let (below, above) = (query[axis] - self.planes[axis + 3], self.planes[axis] - query[axis + 3]);
            below.max(above).max(Wide::splat(0.0))
        };
        let (x, y, z) = (gap(0), gap(1), gap(2));
        (x * x + y * y + z * z) * Wide::splat(tolerance::TREE_NARROWING)
    }

    /// The pairs of lanes whose boxes touch.
    pub(super) fn touching_pairs(&self) -> LanePairs {
        LanePairs::touching(&self.planes)
    }

    /// Where another box costs least in a node that is full: below a node, by how much its half area grows, and beside a leaf, the half
    /// area of both, each with its lane, m². Infinite where there is none.
    pub(super) fn least_growths(&self, other: &[Wide; 6]) -> [(f32, usize); 2] {
        let p = &self.planes;
        let area = |x: Wide, y: Wide, z: Wide| x * y + y * z + z * x;
        let extent = |axis: usize| p[axis + 3] - p[axis];
        let united = |axis: usize| p[axis + 3].max(other[axis + 3]) - p[axis].min(other[axis]);
        let (areas, united) = (area(extent(0), extent(1), extent(2)), area(united(0), united(1), united(2)));
        let leaves = self.children_as_floats().negative();
        let below_nodes = (united - areas).with(leaves, f32::INFINITY);
        let beside_leaves = Wide::splat(f32::INFINITY).with_of(leaves, united);
        [below_nodes, beside_leaves].map(|costs| {
            let least = costs.min_element();
            (least, Lanes::of(costs.at_most(Wide::splat(least))).next().unwrap_or(0))
        })
    }

    /// Less the lanes below which there is nothing on the given layers.
    pub(super) fn on_layers(&self, lanes: Lanes, layers: u32) -> Lanes {
        if layers == u32::MAX {
            return lanes;
        }
        Lanes(lanes.filter(|&lane| self.layers[lane] & layers != 0).fold(0, |all, lane| all | 1 << lane))
    }
}

fn bounds_of([min_x, min_y, min_z, max_x, max_y, max_z]: &[Wide; 6]) -> LocalBox {
    LocalBox {
        min: Vec3A::new(min_x.min_element(), min_y.min_element(), min_z.min_element()),
        max: Vec3A::new(max_x.max_element(), max_y.max_element(), max_z.max_element()),
    }
}

/// A set of lanes, and the iterator over them from the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lanes(u32);

impl Lanes {
    pub(super) fn of(mask: Mask) -> Self {
        Self(mask.bits())
    }

    #[inline]
    pub(super) fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// All lanes.
const ALL: u32 = 0xff;

impl Iterator for Lanes {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    }
}

/// A set of pairs of lanes, and the iterator over them. Each pair has a bit: see [`PAIRS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LanePairs(u32);

/// The pair of each bit. In each row eight lanes are compared with eight: with the next in their half, and with those two farther on
/// there, where every pair comes twice; then the first half with the second, as it is and turned by one, and by two and three.
#[rustfmt::skip]
const PAIRS: [(u8, u8); 32] = [
    (0, 1), (1, 2), (2, 3), (0, 3), (4, 5), (5, 6), (6, 7), (4, 7),
    (0, 2), (1, 3), (0, 2), (1, 3), (4, 6), (5, 7), (4, 6), (5, 7),
    (0, 4), (1, 5), (2, 6), (3, 7), (0, 5), (1, 6), (2, 7), (3, 4),
    (0, 6), (1, 7), (2, 4), (3, 5), (0, 7), (1, 4), (2, 5), (3, 6),
];

impl LanePairs {
    #[inline]
    fn touching(planes: &[Wide; 6]) -> Self {
        let touch = |a: &[Wide; 6], b: &[Wide; 6]| {
            let axis = |at: usize| a[at].at_most(b[at + 3]) & b[at].at_most(a[at + 3]);
            (axis(0) & axis(1) & axis(2)).bits()
        };
        let by_one = planes.map(Wide::turned);
        let by_two = by_one.map(Wide::turned);
        let by_three = by_two.map(Wide::turned);
        let first = planes.map(Wide::first_twice);
        let second = |left: &[Wide; 6], right: &[Wide; 6]| [0, 1, 2, 3, 4, 5].map(|at| left[at].seconds(right[at]));
        let bits = touch(planes, &by_one)
            | (touch(planes, &by_two) & 0b0011_0011) << 8
            | touch(&first, &second(planes, &by_one)) << 16
            | touch(&first, &second(&by_two, &by_three)) << 24;
        Self(bits)
    }
}

impl Iterator for LanePairs {
    type Item = (usize, usize);

    #[inline]
    fn next(&mut self) -> Option<(usize, usize)> {
        if self.0 == 0 {
            return None;
        }
        let (lane, other) = PAIRS[self.0.trailing_zeros() as usize];
        self.0 &= self.0 - 1;
        Some((lane.into(), other.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pairs_of_a_node_are_those_of_each_lane_with_those_after_it() {
        let mut state = 1_u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1_u64 << 24) as f32
        };
        let mut counts = [0; 32];
        for round in 0..2000_u32 {
            let mut node = Node::EMPTY;
            for lane in (0..LANES).filter(|lane| round % 7 == 0 || (round >> lane) & 1 == 0) {
                let min = Vec3A::new(number(), number(), number());
                let size = Vec3A::new(number(), number(), number());
                node.set(lane, LocalBox { min, max: min + size }, Child::leaf(lane as u32), 1);
            }
            let mut found: Vec<(usize, usize)> = node.touching_pairs().collect();
            found.sort_unstable();
            let pairs = (0..LANES).flat_map(|lane| (lane + 1..LANES).map(move |other| (lane, other)));
            let expected: Vec<_> = pairs.filter(|&(lane, other)| node.lane(lane).touches(node.lane(other))).collect();
            assert_eq!(found, expected);
            counts[found.len()] += 1;
            let leaves: Vec<usize> = node.taken().collect();
            assert_eq!(node.nodes_below().count(), 0);
            for &lane in &leaves {
                node.children[lane] = Child::node(lane as u32);
                assert!(node.nodes_below().eq(leaves.iter().copied().take_while(|&other| other <= lane)));
            }
        }
        assert!(counts[0] > 100 && counts[3..].iter().sum::<u32>() > 100, "{counts:?}");
    }
}
