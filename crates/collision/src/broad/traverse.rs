//! How a tree of boxes is searched: by a box, along a path with a shrinking limit, and nearest first.
//!
//! # Method
//! One loop for each kind of search. Each takes a node of eight boxes at a time and goes on with those that qualify: by a
//! box in any order, along a path the nearest entry first, and for the nearest from a list of open nodes in order, so that no
//! node is looked at that is farther than the final answer. A node is skipped only if it lies beyond the limit, which the
//! visitor lowers as it finds certain hits. Stacks and lists grow: no node is ever dropped. They have room for a usual
//! tree, so that a search asks for no memory. A node that will be looked at later is fetched as soon as it is known, and waited for
//! when its turn comes.

use std::ops::ControlFlow;

use smallvec::SmallVec;

use super::{
    forest::{Cell, Forest, Nodes, Rooted},
    local::LocalBox,
    node::{Child, Lanes, NO_NODE, Target},
    open::{Open, Opens, push_but_nearest, push_in_order},
    pairs::each_pair,
    path::{Line, LocalPath, Path},
    walk::Walked,
    wide::Wide,
};
use crate::{answer::Work, math::Aabb, tolerance};

/// What a search costs its caller: it is told of each node, and may call the search off.
pub trait Toll {
    /// Why a search was called off.
    type Stop;

    /// A node is visited.
    ///
    /// # Errors
    /// The search is called off.
    fn pay(&mut self) -> Result<(), Self::Stop>;
}

/// Counts nodes and never calls off.
impl Toll for Work {
    type Stop = std::convert::Infallible;

    fn pay(&mut self) -> Result<(), Self::Stop> {
        self.nodes_visited += 1;
        Ok(())
    }
}

/// What a search along a path does with a leaf: it returns the new limit.
type Visit<'a, T> = dyn FnMut(&mut T, u32) -> Result<f64, <T as Toll>::Stop> + 'a;

/// Every layer: nothing is passed over because of those it is on.
pub const ALL_LAYERS: u32 = u32::MAX;

/// A tree of boxes that can be searched. Leaves that are on none of the `layers` of a search may be passed over.
pub trait Tree {
    /// The box of everything in it, rounded outwards; `None` if it is empty.
    fn bounds(&self) -> Option<Aabb>;

    /// Visits every leaf whose box touches `query` (and maybe others), until the visitor breaks.
    ///
    /// # Errors
    /// What `toll` or `visit` returned.
    fn visit_box<T: Toll>(
        &self,
        query: Aabb,
        layers: u32,
        toll: &mut T,
        visit: impl FnMut(&mut T, u32) -> Result<ControlFlow<()>, T::Stop>,
    ) -> Result<(), T::Stop>;

    /// Visits every leaf whose box the path of `line` enters at a `t` of at most `limit` (and maybe others), roughly in order. The
    /// visitor returns the new limit; −∞ ends the search. A limit above the old one has no effect.
    ///
    /// # Errors
    /// What `toll` or `visit` returned.
    fn visit_ray<T: Toll>(
        &self,
        line: &Line,
        limit: f64,
        layers: u32,
        toll: &mut T,
        visit: impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop>;

    /// As [`Tree::visit_ray`], for a path with a unit vector for its direction, whose beginning and end, at `limit`, are not much
    /// farther from the tree than the tree is wide. Of another path more leaves are visited than need be. Errors are those.
    fn visit_near_ray<T: Toll>(
        &self,
        path: Path,
        limit: f64,
        toll: &mut T,
        visit: impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop> {
        self.visit_ray(&Line::new(&path), limit, ALL_LAYERS, toll, visit)
    }

    /// Visits every leaf whose box is within `limit` metres of `query` (and maybe others), nearest node first. The
    /// visitor returns the new limit; −∞ ends the search. A limit above the old one has no effect.
    ///
    /// # Errors
    /// What `toll` or `visit` returned.
    fn visit_nearest<T: Toll>(
        &self,
        query: Aabb,
        limit: f64,
        layers: u32,
        toll: &mut T,
        visit: impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop>;

    /// Visits every pair of leaves whose boxes touch (and maybe others), each pair once, in no certain order.
    ///
    /// # Errors
    /// What `toll` or `visit` returned.
    fn visit_pairs<T: Toll>(
        &self,
        toll: &mut T,
        visit: impl FnMut(&mut T, u32, u32) -> Result<(), T::Stop>,
    ) -> Result<(), T::Stop>;
}

impl<R: Rooted> Tree for R {
    fn bounds(&self) -> Option<Aabb> {
        let forest = self.forest();
        let cells = forest.cells.iter().filter(|cell| cell.root != NO_NODE).map(|cell| cell.bounds);
        cells.chain(self.listed().map(|large| large.bounds)).reduce(Aabb::union)
    }

    fn visit_box<T: Toll>(
        &self,
        query: Aabb,
        layers: u32,
        toll: &mut T,
        mut visit: impl FnMut(&mut T, u32) -> Result<ControlFlow<()>, T::Stop>,
    ) -> Result<(), T::Stop> {
        let forest = self.forest();
        for large in self.listed_on(layers) {
            if large.bounds.intersects(query) && visit(toll, large.leaf)?.is_break() {
                return Ok(());
            }
        }
        for cell in &forest.cells {
            if touch(forest, cell, query, layers, toll, &mut visit)?.is_break() {
                return Ok(());
            }
        }
        Ok(())
    }

    fn visit_ray<T: Toll>(
        &self,
        line: &Line,
        limit: f64,
        layers: u32,
        toll: &mut T,
        mut visit: impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop> {
        let forest = self.forest();
        let mut limit = self.visit_listed(line, limit, layers, |leaf| visit(toll, leaf))?;
        if let [cell] = forest.cells.as_slice() {
            return follow(forest, cell, line, limit, layers, toll, &mut visit).map(|_| ());
        }
        let first_limit = limit;
        let begins = |bounds: Aabb| line.entry(&bounds, first_limit);
        for cell in in_order(forest, begins) {
            limit = follow(forest, cell, line, limit, layers, toll, &mut visit)?;
        }
        Ok(())
    }

    fn visit_near_ray<T: Toll>(
        &self,
        path: Path,
        limit: f64,
        toll: &mut T,
        mut visit: impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop> {
        let forest = self.forest();
        match forest.cells.as_slice() {
            [cell] if cell.root != NO_NODE && self.listed().next().is_none() => {
                let local = LocalPath::near(path, cell.origin, limit);
                descend(forest, cell, &local, limit, ALL_LAYERS, toll, &mut visit).map(|_| ())
            }
            // So rare that the search need not be compiled into this one as well.
            _ => {
                let visit: &mut Visit<'_, T> = &mut visit;
                self.visit_ray(&Line::new(&path), limit, ALL_LAYERS, toll, visit)
            }
        }
    }

    fn visit_nearest<T: Toll>(
        &self,
        query: Aabb,
        limit: f64,
        layers: u32,
        toll: &mut T,
        mut visit: impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop> {
        let forest = self.forest();
        let mut limit = limit;
        for large in self.listed_on(layers) {
            if distance_at_least(query, large.bounds) <= limit {
                limit = limit.min(visit(toll, large.leaf)?);
            }
        }
        if let [cell] = forest.cells.as_slice() {
            return approach(forest, cell, query, limit, layers, toll, &mut visit).map(|_| ());
        }
        let begins = |bounds: Aabb| Some(distance_at_least(query, bounds));
        for cell in in_order(forest, begins) {
            limit = approach(forest, cell, query, limit, layers, toll, &mut visit)?;
        }
        Ok(())
    }

    fn visit_pairs<T: Toll>(
        &self,
        toll: &mut T,
        visit: impl FnMut(&mut T, u32, u32) -> Result<(), T::Stop>,
    ) -> Result<(), T::Stop> {
        each_pair(self, toll, visit)
    }
}

/// Metres, not above the true distance of two boxes: the root of a sum of squares is off by a few rounded operations,
/// unless the squares are so small that they lose digits; then 0 is said. Never larger for a larger box.
#[must_use]
pub fn distance_at_least(a: Aabb, b: Aabb) -> f64 {
    let distance_sq = a.distance_sq(b);
    if distance_sq > tolerance::SQUARE_MIN { distance_sq.sqrt() * tolerance::SLAB_NARROWING } else { 0.0 }
}

/// The cells that are not empty, those whose boxes have the least value first. A cell without a value may be left out.
fn in_order<N>(forest: &Forest<N>, value: impl Fn(Aabb) -> Option<f64>) -> impl Iterator<Item = &Cell> {
    let taken = forest.cells.iter().filter(|cell| cell.root != NO_NODE);
    let mut found: SmallVec<[(f64, &Cell); 2]> = taken.filter_map(|cell| Some((value(cell.bounds)?, cell))).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, cell)| cell)
}

/// The loop of a search by a box.
pub(super) fn touch<T: Toll, N: Nodes>(
    forest: &Forest<N>,
    cell: &Cell,
    query: Aabb,
    layers: u32,
    toll: &mut T,
    visit: &mut impl FnMut(&mut T, u32) -> Result<ControlFlow<()>, T::Stop>,
) -> Result<ControlFlow<()>, T::Stop> {
    if cell.root == NO_NODE {
        return Ok(ControlFlow::Continue(()));
    }
    let query = LocalBox::around(query, cell.origin).splat();
    let mut stack: SmallVec<[u32; 128]> = SmallVec::new();
    let mut next = Some(cell.root);
    while let Some(index) = next {
        toll.pay()?;
        let node = forest.nodes.node(index);
        for lane in node.on_layers(node.touching(&query), layers) {
            match node.children[lane].target() {
                Target::Node(below) => {
                    forest.nodes.node(below).prefetch();
                    stack.push(below);
                }
                Target::Leaf(leaf) => {
                    if visit(toll, leaf)?.is_break() {
                        return Ok(ControlFlow::Break(()));
                    }
                }
                Target::Nothing => {}
            }
        }
        next = stack.pop();
    }
    Ok(ControlFlow::Continue(()))
}

/// The loop of a search along a path; the limit at its end.
fn follow<T: Toll, N: Nodes>(
    forest: &Forest<N>,
    cell: &Cell,
    line: &Line,
    limit: f64,
    layers: u32,
    toll: &mut T,
    visit: &mut impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
) -> Result<f64, T::Stop> {
    if cell.root == NO_NODE {
        return Ok(limit);
    }
    match LocalPath::new(line, &cell.bounds, cell.origin, limit) {
        Some(path) => descend(forest, cell, &path, limit, layers, toll, visit),
        None => Ok(limit),
    }
}

/// The same in the numbers of the cell.
#[inline]
fn descend<T: Toll, N: Nodes>(
    forest: &Forest<N>,
    cell: &Cell,
    path: &LocalPath,
    mut limit: f64,
    layers: u32,
    toll: &mut T,
    visit: &mut impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
) -> Result<f64, T::Stop> {
    let mut local_limit = path.limit(limit);
    let mut stack: Opens = Opens::new();
    let mut next = Some(Open::new(0.0, Child::node(cell.root)));
    while let Some(open) = next.take().or_else(|| stack.pop()) {
        if open.begins() > local_limit {
            continue;
        }
        match open.child().target() {
            Target::Node(index) => {
                toll.pay()?;
                let node = forest.nodes.node(index);
                let (lanes, entries) = path.entering(node, local_limit);
                next = push_but_nearest(&mut stack, node, node.on_layers(lanes, layers), entries);
                // It comes next if nothing below does.
                if let Some(Target::Node(index)) = stack.last().map(|open| open.child().target()) {
                    forest.nodes.node(index).prefetch();
                }
            }
            Target::Leaf(leaf) => {
                let found = visit(toll, leaf)?;
                if found < limit {
                    limit = found;
                    local_limit = path.limit(limit);
                }
            }
            Target::Nothing => {}
        }
    }
    Ok(limit)
}

/// The loop of a search for the nearest; the limit at its end. Distances are squared in it.
fn approach<T: Toll, N: Nodes>(
    forest: &Forest<N>,
    cell: &Cell,
    query: Aabb,
    limit: f64,
    layers: u32,
    toll: &mut T,
    visit: &mut impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
) -> Result<f64, T::Stop> {
    if cell.root == NO_NODE {
        return Ok(limit);
    }
    let mut limit = limit;
    let mut limit_sq = squared(limit);
    let query = LocalBox::around(query, cell.origin).splat();
    // Open nodes and leaves, the farthest first.
    let mut open: Opens = Opens::new();
    open.push(Open::new(0.0, Child::node(cell.root)));
    while let Some(nearest) = open.pop() {
        if nearest.begins() > limit_sq {
            break;
        }
        match nearest.child().target() {
            Target::Node(index) => {
                toll.pay()?;
                let node = forest.nodes.node(index);
                let distances_sq = node.distances_sq(&query);
                let lanes = Lanes::of(distances_sq.at_most(Wide::splat(limit_sq)));
                for lane in node.on_layers(lanes, layers).filter(|&lane| node.children[lane] != Child::NOTHING) {
                    push_in_order(&mut open, Open::new(distances_sq.get(lane), node.children[lane]));
                }
            }
            Target::Leaf(leaf) => {
                let found = visit(toll, leaf)?;
                if found < limit {
                    limit = found;
                    limit_sq = squared(limit);
                }
            }
            Target::Nothing => {}
        }
    }
    Ok(limit)
}

/// Not below the square of a distance; −∞ for less than 0, which is no distance.
fn squared(limit: f64) -> f32 {
    if limit < 0.0 {
        f32::NEG_INFINITY
    } else {
        (limit * limit * tolerance::TREE_LIMIT_WIDENING) as f32 + f32::MIN_POSITIVE
    }
}
