//! Every pair of leaves of a tree whose boxes touch.
//!
//! # Method
//! The tree is joined with itself. A node with itself gives the pairs of its lanes: each lane is compared with those that follow it, by
//! turning all of them, so that four comparisons without a branch are enough ([`super::node::LanePairs`]). Two nodes give the pairs of
//! their lanes that touch, of those that touch the box of the other node, eight tests at a time; and a leaf goes on against a node
//! alone. What is listed beside the nodes, and cells whose boxes touch, are searched box by box.
//!
//! # Source
//! Ericson, "Real-Time Collision Detection", 2005, section 6.3 (simultaneous descent).

use std::ops::ControlFlow;

use smallvec::SmallVec;

use super::{
    Toll,
    forest::{Cell, Forest, Nodes, Rooted},
    node::{LANES, NO_NODE, Node, Target},
    traverse::{ALL_LAYERS, touch},
    wide::Wide,
};
use crate::math::Aabb;

/// What is still to be joined.
#[derive(Default)]
struct Open {
    /// Nodes, each with itself.
    within: SmallVec<[u32; 64]>,
    between: SmallVec<[Between; 64]>,
}

/// What is below one node with what is below another.
struct Between {
    a: u32,
    b: u32,
    /// What leads to `b`: eight times its node, and the number of the lane.
    lane_to_b: u32,
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
    let mut open = Open::default();
    open.within.extend((cell.root != NO_NODE).then_some(cell.root));
    while let Some(index) = open.within.pop() {
        toll.pay()?;
        let node = forest.nodes.node(index);
        let nodes_below = node.nodes_below();
        if nodes_below.is_empty() {
            for (lane, other) in node.touching_pairs() {
                visit(toll, node.children[lane].number(), node.children[other].number())?;
            }
            continue;
        }
        open.within.extend(nodes_below.map(|lane| node.children[lane].number()));
        for (lane, other) in node.touching_pairs() {
            meet(forest, (node, lane), (index, node, other), &mut open, toll, visit)?;
        }
        while let Some(Between { a, b, lane_to_b }) = open.between.pop() {
            toll.pay()?;
            let (node_a, node_b) = (forest.nodes.node(a), forest.nodes.node(b));
            // That node has the same box, but would have to be asked for it lane by lane.
            let bounds_b = forest.nodes.node(lane_to_b / LANES as u32).lane_splat(lane_to_b as usize % LANES);
            for lane in node_a.touching(&bounds_b) {
                for other in node_b.touching(&node_a.lane_splat(lane)) {
                    meet(forest, (node_a, lane), (b, node_b, other), &mut open, toll, visit)?;
                }
            }
        }
    }
    Ok(())
}

/// Two lanes whose boxes touch: leaves are visited, two nodes wait.
#[inline]
fn meet<T: Toll, N: Nodes>(
    forest: &Forest<N>,
    (node_a, lane_a): (&Node, usize),
    (index_b, node_b, lane_b): (u32, &Node, usize),
    open: &mut Open,
    toll: &mut T,
    visit: &mut impl FnMut(&mut T, u32, u32) -> Result<(), T::Stop>,
) -> Result<(), T::Stop> {
    match (node_a.children[lane_a].target(), node_b.children[lane_b].target()) {
        (Target::Leaf(leaf), Target::Leaf(other)) => visit(toll, leaf, other),
        (Target::Node(a), Target::Node(b)) => {
            open.between.push(Between { a, b, lane_to_b: index_b * LANES as u32 + lane_b as u32 });
            Ok(())
        }
        (Target::Leaf(leaf), Target::Node(below)) => {
            leaf_with(forest, leaf, &node_a.lane_splat(lane_a), below, toll, visit)
        }
        (Target::Node(below), Target::Leaf(leaf)) => {
            leaf_with(forest, leaf, &node_b.lane_splat(lane_b), below, toll, visit)
        }
        (Target::Nothing, _) | (_, Target::Nothing) => Ok(()),
    }
}

/// A leaf and what is below a node, whose subtree is as deep as the tree at most.
fn leaf_with<T: Toll, N: Nodes>(
    forest: &Forest<N>,
    leaf: u32,
    bounds: &[Wide; 6],
    below: u32,
    toll: &mut T,
    visit: &mut impl FnMut(&mut T, u32, u32) -> Result<(), T::Stop>,
) -> Result<(), T::Stop> {
    toll.pay()?;
    let node = forest.nodes.node(below);
    for lane in node.touching(bounds) {
        match node.children[lane].target() {
            Target::Node(below) => leaf_with(forest, leaf, bounds, below, toll, visit)?,
            Target::Leaf(other) => visit(toll, leaf, other)?,
            Target::Nothing => {}
        }
    }
    Ok(())
}
