//! How a tree of boxes is searched: by a box, along a path with a shrinking limit, and nearest first.
//!
//! # Method
//! There are two loops. One goes depth first, nearer child first, and serves boxes and paths: they differ only in the
//! [`Probe`] that says whether and where a box is entered. The other takes the nearest open node from a heap, and so
//! looks at no node that is farther than the final answer. Both skip a node only if its entry lies beyond the limit,
//! which the visitor lowers as it finds certain hits. Stacks and heaps grow: no node is ever dropped.
//!
//! # Source
//! Slab test: Williams, Barrus, Morley, Shirley, "An Efficient and Robust Ray-Box Intersection Algorithm", 2005, with
//! the widening of Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013. Ize's factor covers the rounding of the test
//! itself; what the caller's path was rounded by is added to the box (see [`Path`]).

use std::{cmp::Ordering, collections::BinaryHeap, ops::ControlFlow};

use glam::{BVec3, DVec3};
use smallvec::SmallVec;

use crate::{answer::Work, math::Aabb, tolerance};

/// Names a node of the tree it came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct NodeIndex(pub(super) u32);

/// What a node holds.
#[derive(Clone, Copy, Debug)]
pub enum Expanded<'a> {
    /// Two nodes, and their boxes.
    Children([(NodeIndex, &'a Aabb); 2]),
    /// Leaf numbers.
    Leaves(&'a [u32]),
}

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

/// The way of a point or of a box: `origin + t * direction` for `t >= 0`, and all points within `reach` of it in each
/// component.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// Where it begins (for a box: its centre).
    pub origin: DVec3,
    /// Of any length but 0, components up to 1e150; `t` counts multiples of it.
    pub direction: DVec3,
    /// Half extents of the mover, plus how far from this path the true one may be; 0 for an exact ray. Each at least 0.
    pub reach: DVec3,
}

impl Path {
    /// A `t` before which the path does not enter `bounds`, at least 0; `None` if it surely enters it nowhere from 0 to
    /// `limit`. Whenever this is `Some`, a search along this path offers a leaf of that box.
    #[must_use]
    pub fn entry(&self, bounds: &Aabb, limit: f64) -> Option<f64> {
        Slabs::new(self, bounds).entry(bounds, limit)
    }
}

/// A tree of boxes that can be searched.
pub trait Tree {
    /// The root and its box; `None` if the tree is empty.
    fn root(&self) -> Option<(NodeIndex, &Aabb)>;

    /// What a node holds.
    fn expand(&self, node: NodeIndex) -> Expanded<'_>;

    /// The box of everything in it; `None` if it is empty.
    fn bounds(&self) -> Option<Aabb> {
        self.root().map(|(_, bounds)| *bounds)
    }

    /// Visits every leaf whose box touches `query` (and maybe others), until the visitor breaks.
    ///
    /// # Errors
    /// What `toll` or `visit` returned.
    fn visit_box<T: Toll>(
        &self,
        query: Aabb,
        toll: &mut T,
        mut visit: impl FnMut(&mut T, u32) -> Result<ControlFlow<()>, T::Stop>,
    ) -> Result<(), T::Stop> {
        depth_first(self, &query, f64::INFINITY, toll, |toll, leaf, _| {
            Ok(match visit(toll, leaf)? {
                ControlFlow::Continue(()) => f64::INFINITY,
                ControlFlow::Break(()) => f64::NEG_INFINITY,
            })
        })
    }

    /// Visits every leaf whose box `path` enters at a `t` of at most `limit` (and maybe others), roughly in order.
    /// The visitor gets the leaf and a `t` before which its box is not entered, and returns the new limit;
    /// −∞ ends the search. A limit above the old one has no effect.
    ///
    /// # Errors
    /// What `toll` or `visit` returned.
    fn visit_ray<T: Toll>(
        &self,
        path: &Path,
        limit: f64,
        toll: &mut T,
        visit: impl FnMut(&mut T, u32, f64) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop> {
        let Some((_, bounds)) = self.root() else {
            return Ok(());
        };
        depth_first(self, &Slabs::new(path, bounds), limit, toll, visit)
    }

    /// Visits every leaf whose box is within `limit` metres of `query` (and maybe others), nearest node first. The
    /// visitor gets the leaf and a distance below which its box is not, and returns the new limit; −∞ ends the search.
    /// A limit above the old one has no effect.
    ///
    /// # Errors
    /// What `toll` or `visit` returned.
    fn visit_nearest<T: Toll>(
        &self,
        query: Aabb,
        limit: f64,
        toll: &mut T,
        visit: impl FnMut(&mut T, u32, f64) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop> {
        best_first(self, query, limit, toll, visit)
    }
}

/// Decides whether and where a search enters a box.
trait Probe {
    /// A value at or below the true entry, at least 0, or `None` if the box is surely not entered at or before `limit`.
    fn entry(&self, bounds: &Aabb, limit: f64) -> Option<f64>;
}

impl Probe for Aabb {
    fn entry(&self, bounds: &Aabb, _limit: f64) -> Option<f64> {
        self.intersects(*bounds).then_some(0.0)
    }
}

/// A path made ready for slab tests against the boxes of one tree.
struct Slabs {
    origin: DVec3,
    /// ±∞ where the direction is ±0: then a box is entered in that axis at all times or never.
    inverse: DVec3,
    backwards: BVec3,
    /// The path's reach, and what rounding the walls of a box can shift them by.
    reach: DVec3,
}

impl Slabs {
    /// Rounding, derived: a wall is computed as `fl(b ∓ reach)`, off by at most `u(|b| + reach)`, and `reach` itself
    /// was rounded when this slack was added; all other operations have relative errors in `t` only, which
    /// [`tolerance::SLAB_WIDENING`] covers. The path's own origin counts as well, because callers compute it from
    /// positions of that size. The largest component counts for all three, so that a component of the direction whose
    /// inverse overflows cannot lose a box whose wall is a denormal away.
    fn new(path: &Path, bounds: &Aabb) -> Self {
        let walls = bounds.min.abs().max(bounds.max.abs());
        let magnitude = (walls + path.reach + path.origin.abs()).max_element();
        Self {
            origin: path.origin,
            inverse: path.direction.recip(),
            backwards: signs(path.direction),
            reach: path.reach + magnitude * tolerance::SLAB_SLACK,
        }
    }
}

/// The sign bits of a vector; −0 counts as negative, so that its inverse −∞ is met by the right wall.
fn signs(v: DVec3) -> BVec3 {
    BVec3::new(v.x.is_sign_negative(), v.y.is_sign_negative(), v.z.is_sign_negative())
}

impl Probe for Slabs {
    fn entry(&self, bounds: &Aabb, limit: f64) -> Option<f64> {
        let (low, high) = (bounds.min - self.reach, bounds.max + self.reach);
        let near = (DVec3::select(self.backwards, high, low) - self.origin) * self.inverse;
        let far = (DVec3::select(self.backwards, low, high) - self.origin) * self.inverse;
        // The origin in a wall and no motion across it is 0 · ∞ = NaN. As the first operand of these it drops out:
        // the wall counts as entered, which is the safe branch.
        let entry = larger(near.x, larger(near.y, larger(near.z, 0.0)));
        let exit = smaller(far.x, smaller(far.y, smaller(far.z, limit)));
        (entry <= exit * tolerance::SLAB_WIDENING).then_some(entry * tolerance::SLAB_NARROWING)
    }
}

/// The larger one; `b` if `a` is NaN.
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller one; `b` if `a` is NaN.
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Nodes that wait: enough for a tree of the usual depth without asking for memory.
type Stack = SmallVec<[(NodeIndex, f64); 32]>;

/// The one depth-first loop. The visitor gets the leaf and the entry of its node, and returns the new limit.
fn depth_first<T: Toll>(
    tree: &(impl Tree + ?Sized),
    probe: &impl Probe,
    mut limit: f64,
    toll: &mut T,
    mut visit: impl FnMut(&mut T, u32, f64) -> Result<f64, T::Stop>,
) -> Result<(), T::Stop> {
    let Some((root, bounds)) = tree.root() else {
        return Ok(());
    };
    let mut stack = Stack::new();
    stack.extend(probe.entry(bounds, limit).map(|entry| (root, entry)));
    while let Some((node, entry)) = stack.pop() {
        if entry > limit {
            continue;
        }
        toll.pay()?;
        match tree.expand(node) {
            Expanded::Leaves(leaves) => {
                for &leaf in leaves {
                    limit = limit.min(visit(toll, leaf, entry)?);
                }
            }
            Expanded::Children([(a, box_a), (b, box_b)]) => {
                match (probe.entry(box_a, limit), probe.entry(box_b, limit)) {
                    (Some(entry_a), Some(entry_b)) if entry_a <= entry_b => {
                        stack.push((b, entry_b));
                        stack.push((a, entry_a));
                    }
                    (first, second) => {
                        stack.extend(first.map(|entry| (a, entry)));
                        stack.extend(second.map(|entry| (b, entry)));
                    }
                }
            }
        }
    }
    Ok(())
}

/// A node of the heap: the smallest distance is the greatest, the lower index wins ties.
struct Open {
    distance: f64,
    node: NodeIndex,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance).then_with(|| other.node.cmp(&self.node))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

/// Metres, not above the true distance of two boxes: the root of a sum of squares is off by a few rounded operations,
/// unless the squares are so small that they lose digits; then 0 is said. Never larger for a larger box.
#[must_use]
pub fn distance_at_least(a: Aabb, b: Aabb) -> f64 {
    let distance_sq = a.distance_sq(b);
    if distance_sq > tolerance::SQUARE_MIN { distance_sq.sqrt() * tolerance::SLAB_NARROWING } else { 0.0 }
}

/// The one best-first loop.
fn best_first<T: Toll>(
    tree: &(impl Tree + ?Sized),
    query: Aabb,
    mut limit: f64,
    toll: &mut T,
    mut visit: impl FnMut(&mut T, u32, f64) -> Result<f64, T::Stop>,
) -> Result<(), T::Stop> {
    let Some((root, bounds)) = tree.root() else {
        return Ok(());
    };
    let mut open = BinaryHeap::new();
    open.push(Open { distance: distance_at_least(query, *bounds), node: root });
    while let Some(Open { distance, node }) = open.pop() {
        if distance > limit {
            return Ok(());
        }
        toll.pay()?;
        match tree.expand(node) {
            Expanded::Leaves(leaves) => {
                for &leaf in leaves {
                    limit = limit.min(visit(toll, leaf, distance)?);
                }
            }
            Expanded::Children(children) => {
                for (node, bounds) in children {
                    let distance = distance_at_least(query, *bounds);
                    if distance <= limit {
                        open.push(Open { distance, node });
                    }
                }
            }
        }
    }
    Ok(())
}
