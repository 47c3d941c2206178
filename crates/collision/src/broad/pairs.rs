//! Every pair of leaves of a tree whose boxes touch.
//!
//! # Method
//! The tree is joined with itself: a node with itself gives the pairs of its lanes, two nodes give the pairs of their lanes
//! that touch, eight tests at a time, and a leaf goes on against a node alone. What is listed beside the nodes, and cells
//! whose boxes touch, are searched box by box.
//!
//! # Source
//! Ericson, "Real-Time Collision Detection", 2005, section 6.3 (simultaneous descent).

use std::ops::ControlFlow;

use smallvec::SmallVec;

use super::{
    Toll,
    forest::{Cell, Forest, Nodes, Rooted},
    node::{Child, LANES, NO_NODE, Node, Target},
    traverse::{ALL_LAYERS, touch},
    wide::Wide,
};
use crate::math::Aabb;

/// What is still to be joined. A lane is eight times its node, and the number of the lane.
#[derive(Clone, Copy)]
enum Join {
    /// All pairs below a node.
    Within(u32),
    /// Pairs of what is below one node and what is below another, in these lanes.
    Between(u32, u32),
    /// Pairs of the leaf in a lane and what is below a node.
    LeafWith(u32, u32),
}

/// Visits every pair of leaves whose boxes touch (and maybe others), each once, in no certain order.
pub(super) fn each_pair<T: Toll, R: Rooted>(
    tree: &R,
    toll: &mut T,
    mut visit: impl FnMut(&mut T, u32, u32) -> Result<(), T::Stop>,
) -> Result<(), T::Stop> {
    let forest = tree.forest();
    for (at, large) in tree.listed().enumerate() {
        for other in tree.listed().skip(at + 1).filter(|other| other.bounds.intersects(large.bounds)) {
            visit(toll, large.leaf, other.leaf)?;
        }
        for cell in &forest.cells {
            each_of_cell(forest, cell, large.bounds, toll, |toll, other| visit(toll, large.leaf, other))?;
        }
    }
    for (at, cell) in forest.cells.iter().enumerate() {
        each_within(forest, cell, toll, &mut visit)?;
        for other in &forest.cells[at + 1..] {
            each_between(forest, cell, other, toll, &mut visit)?;
        }
    }
    Ok(())
}

fn each_of_cell<T: Toll, N: Nodes>(
    forest: &Forest<N>,
    cell: &Cell,
    query: Aabb,
    toll: &mut T,
    mut visit: impl FnMut(&mut T, u32) -> Result<(), T::Stop>,
) -> Result<(), T::Stop> {
    let mut visit = |toll: &mut T, leaf| visit(toll, leaf).map(ControlFlow::Continue);
    touch(forest, cell, query, ALL_LAYERS, toll, &mut visit).map(|_| ())
}

/// Pairs of leaves of different cells: rare, for cells are far from each other.
fn each_between<T: Toll, N: Nodes>(
    forest: &Forest<N>,
    a: &Cell,
    b: &Cell,
    toll: &mut T,
    visit: &mut impl FnMut(&mut T, u32, u32) -> Result<(), T::Stop>,
) -> Result<(), T::Stop> {
    if a.root == NO_NODE || b.root == NO_NODE || !a.bounds.intersects(b.bounds) {
        return Ok(());
    }
    let mut open = vec![a.root];
    while let Some(index) = open.pop() {
        toll.pay()?;
        let node = forest.nodes.node(index);
        for lane in node.taken() {
            let bounds = node.lane(lane).in_world(a.origin);
            match node.children[lane].target() {
                _ if !bounds.intersects(b.bounds) => {}
                Target::Node(below) => open.push(below),
                Target::Leaf(leaf) => {
                    each_of_cell(forest, b, bounds, toll, |toll, other| visit(toll, leaf, other))?;
                }
                Target::Nothing => {}
            }
        }
    }
    Ok(())
}

fn each_within<T: Toll, N: Nodes>(
    forest: &Forest<N>,
    cell: &Cell,
    toll: &mut T,
    visit: &mut impl FnMut(&mut T, u32, u32) -> Result<(), T::Stop>,
) -> Result<(), T::Stop> {
    let mut open: SmallVec<[Join; 64]> = SmallVec::new();
    open.extend((cell.root != NO_NODE).then_some(Join::Within(cell.root)));
    while let Some(join) = open.pop() {
        toll.pay()?;
        match join {
            Join::Within(index) => {
                let node = forest.nodes.node(index);
                for lane in node.taken() {
                    if let Target::Node(below) = node.children[lane].target() {
                        open.push(Join::Within(below));
                    }
                    for other in node.touching(&node.lane_splat(lane)).after(lane) {
                        pair((index, node, lane), (index, node, other), toll, &mut open, visit)?;
                    }
                }
            }
            Join::Between(lane_a, lane_b) => {
                let (Some(a), Some(b)) = (below(forest, lane_a), below(forest, lane_b)) else { continue };
                let (node_a, node_b) = (forest.nodes.node(a), forest.nodes.node(b));
                for lane in node_a.touching(&lane_of(forest, lane_b)) {
                    for other in node_b.touching(&node_a.lane_splat(lane)) {
                        pair((a, node_a, lane), (b, node_b, other), toll, &mut open, visit)?;
                    }
                }
            }
            Join::LeafWith(lane, index) => {
                let (holder, node) = (forest.nodes.node(lane / LANES as u32), forest.nodes.node(index));
                let at = lane as usize % LANES;
                for other in node.touching(&lane_of(forest, lane)) {
                    pair((lane / LANES as u32, holder, at), (index, node, other), toll, &mut open, visit)?;
                }
            }
        }
    }
    Ok(())
}

/// The box in a lane: the node that it leads to has the same one, but would have to be asked for it lane by lane.
#[inline]
fn lane_of<N: Nodes>(forest: &Forest<N>, lane: u32) -> [Wide; 6] {
    forest.nodes.node(lane / LANES as u32).lane_splat(lane as usize % LANES)
}

/// The node that a lane leads to.
#[inline]
fn below<N: Nodes>(forest: &Forest<N>, lane: u32) -> Option<u32> {
    match forest.nodes.node(lane / LANES as u32).children[lane as usize % LANES].target() {
        Target::Node(below) => Some(below),
        Target::Leaf(_) | Target::Nothing => None,
    }
}

/// A lane: the number of its node, the node, and the number of the lane in it.
type Lane<'a> = (u32, &'a Node, usize);

/// Two lanes whose boxes touch: leaves are visited, nodes wait.
#[inline]
fn pair<T: Toll>(
    a: Lane<'_>,
    b: Lane<'_>,
    toll: &mut T,
    open: &mut SmallVec<[Join; 64]>,
    visit: &mut impl FnMut(&mut T, u32, u32) -> Result<(), T::Stop>,
) -> Result<(), T::Stop> {
    let child = |(_, node, lane): Lane<'_>| -> Child { node.children[lane] };
    let number = |(index, _, lane): Lane<'_>| index * LANES as u32 + lane as u32;
    match (child(a).target(), child(b).target()) {
        (Target::Leaf(leaf), Target::Leaf(other)) => visit(toll, leaf, other)?,
        (Target::Leaf(_), Target::Node(below)) => open.push(Join::LeafWith(number(a), below)),
        (Target::Node(below), Target::Leaf(_)) => open.push(Join::LeafWith(number(b), below)),
        (Target::Node(_), Target::Node(_)) => open.push(Join::Between(number(a), number(b))),
        (Target::Nothing, _) | (_, Target::Nothing) => {}
    }
    Ok(())
}
