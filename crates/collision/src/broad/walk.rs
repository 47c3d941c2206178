//! A search along a path that is taken step by step, so that several can go side by side.
//!
//! # Method
//! The same search as [`Tree::visit_ray`](super::Tree::visit_ray), of a tree with one cell, with its state outside of the loop. In a tree
//! larger than the caches a search waits for each node in turn. Whoever takes several walks asks ahead for what each will look at next, and
//! waits for all of them at once.

use super::{
    forest::{Cell, Nodes, Rooted},
    node::{Child, NO_NODE, Target},
    open::{Open, Opens, push_but_nearest},
    path::{Line, LocalPath},
};

/// How far a search along a path has come. Any number of searches may use it, one after the other.
#[derive(Default)]
pub struct Walk {
    path: Option<LocalPath>,
    /// In multiples of the line's direction, and of the path's.
    limit: f64,
    local_limit: f32,
    layers: u32,
    opens: Opens,
    nearest: Option<Open>,
}

/// What a walk looks at next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// A node of the tree, to be entered.
    Node(u32),
    /// A leaf, which is the caller's to look at.
    Leaf(u32),
}

impl Walk {
    /// The next step; `None` at the end.
    #[inline]
    pub fn next_step(&mut self) -> Option<Step> {
        while let Some(open) = self.nearest.take().or_else(|| self.opens.pop()) {
            if open.begins() > self.local_limit {
                continue;
            }
            match open.child().target() {
                Target::Node(index) => return Some(Step::Node(index)),
                Target::Leaf(leaf) => return Some(Step::Leaf(leaf)),
                Target::Nothing => {}
            }
        }
        None
    }

    /// From here on nothing beyond `limit` is looked at. A limit above the old one has no effect.
    #[inline]
    pub fn narrow(&mut self, limit: f64) {
        if limit < self.limit
            && let Some(path) = &self.path
        {
            self.limit = limit;
            self.local_limit = path.limit(limit);
        }
    }

    fn begin(&mut self, cell: Option<&Cell>, line: &Line, limit: f64, layers: u32) {
        self.opens.clear();
        self.nearest = None;
        self.path = match cell {
            Some(cell) if cell.root != NO_NODE => LocalPath::new(line, &cell.bounds, cell.origin, limit),
            _ => None,
        };
        if let (Some(path), Some(cell)) = (&self.path, cell) {
            (self.limit, self.local_limit, self.layers) = (limit, path.limit(limit), layers);
            self.nearest = Some(Open::new(0.0, Child::node(cell.root)));
        }
    }
}

/// A tree that can be walked along a path.
pub trait Walked {
    /// Whether it can: it has no more than one cell. Nearly all worlds have.
    fn is_walked(&self) -> bool;

    /// Begins to walk along `line` up to `limit`.
    fn begin(&self, walk: &mut Walk, line: &Line, limit: f64, layers: u32);

    /// The leaves that are in no node, which are looked at before the nodes: those that the line may enter at a `t` of at most `limit`,
    /// which `visit` returns anew. Returns the limit at the end.
    ///
    /// # Errors
    /// What `visit` returned.
    fn visit_listed<E>(
        &self,
        line: &Line,
        limit: f64,
        layers: u32,
        visit: impl FnMut(u32) -> Result<f64, E>,
    ) -> Result<f64, E>;

    /// Asks for the memory that entering a node wants, without waiting for it.
    fn prefetch(&self, node: u32);

    /// Enters a node that is the next step.
    fn enter(&self, walk: &mut Walk, node: u32);
}

impl<R: Rooted> Walked for R {
    fn is_walked(&self) -> bool {
        self.forest().cells.len() <= 1
    }

    fn begin(&self, walk: &mut Walk, line: &Line, limit: f64, layers: u32) {
        walk.begin(self.forest().cells.first(), line, limit, layers);
    }

    fn visit_listed<E>(
        &self,
        line: &Line,
        limit: f64,
        layers: u32,
        mut visit: impl FnMut(u32) -> Result<f64, E>,
    ) -> Result<f64, E> {
        let mut limit = limit;
        for large in self.listed_on(layers) {
            if line.entry(&large.bounds, limit).is_some() {
                limit = limit.min(visit(large.leaf)?);
            }
        }
        Ok(limit)
    }

    #[inline]
    fn prefetch(&self, node: u32) {
        self.forest().nodes.node(node).prefetch();
    }

    fn enter(&self, walk: &mut Walk, node: u32) {
        let node = self.forest().nodes.node(node);
        if let Some(path) = &walk.path {
            let (lanes, entries) = path.entering(node, walk.local_limit);
            walk.nearest = push_but_nearest(&mut walk.opens, node, node.on_layers(lanes, walk.layers), entries);
        }
    }
}
