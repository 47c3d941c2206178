//! A node of a tree: up to eight boxes side by side, so that one test serves all of them.
//!
//! Lanes are of fixed width and the arithmetic is the same wherever it runs, so the same boxes are found on every machine.

use glam::Vec3A;

use super::{
    local::LocalBox,
    wide::{Mask, Wide},
};

/// Boxes of a node at most.
pub(super) use super::wide::LANES;

/// No node.
pub(super) const NO_NODE: u32 = u32::MAX >> 2;

/// What a lane leads to: nothing, a leaf or a node. A tree has fewer than 2²⁸ nodes, whose lanes are numbered with 31 bits; leaf numbers are
/// below 2³¹ − 1.
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

    #[inline]
    pub(super) fn target(self) -> Target {
        if self == Self::NOTHING {
            Target::Nothing
        } else if self.0 & Self::LEAF != 0 {
            Target::Leaf(self.0 & !Self::LEAF)
        } else {
            Target::Node(self.0)
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
        let mut planes = self.planes;
        for axis in 0..3 {
            planes[axis].set(lane, bounds.min[axis]);
            planes[axis + 3].set(lane, bounds.max[axis]);
        }
        bounds_of(&planes)
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
    pub(super) fn taken(&self) -> impl Iterator<Item = usize> + use<> {
        let children = self.children;
        (0..LANES).filter(move |&lane| children[lane] != Child::NOTHING)
    }

    /// A lane that is free.
    pub(super) fn free_lane(&self) -> Option<usize> {
        self.children.iter().position(|child| *child == Child::NOTHING)
    }

    /// The lanes whose boxes touch a box, given plane by plane, a bit for each.
    pub(super) fn touching(&self, query: &[Wide; 6]) -> Lanes {
        let [min_x, min_y, min_z, max_x, max_y, max_z] = &self.planes;
        let x = min_x.at_most(query[3]) & query[0].at_most(*max_x);
        let y = min_y.at_most(query[4]) & query[1].at_most(*max_y);
        let z = min_z.at_most(query[5]) & query[2].at_most(*max_z);
        Lanes::of(x & y & z)
    }

    /// The half areas of its boxes, and of their unions with another, m²; NaN or infinite for empty lanes.
    pub(super) fn half_areas_with(&self, other: &[Wide; 6]) -> (Wide, Wide) {
        let p = &self.planes;
        let area = |x: Wide, y: Wide, z: Wide| x * y + y * z + z * x;
        let extent = |axis: usize| p[axis + 3] - p[axis];
        let united = |axis: usize| p[axis + 3].max(other[axis + 3]) - p[axis].min(other[axis]);
        (area(extent(0), extent(1), extent(2)), area(united(0), united(1), united(2)))
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

    /// Those after a lane.
    pub(super) fn after(self, lane: usize) -> Self {
        Self(self.0 & (u32::MAX << 1) << lane)
    }
}

impl Iterator for Lanes {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    }
}
