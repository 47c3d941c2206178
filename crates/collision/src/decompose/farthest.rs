//! How far simplices reach beyond a set at most: a maximum with proof.
//!
//! # Method
//! Branch and bound. The distance from a set changes by no more than one goes, so in a simplex it is at most that at a ball's
//! middle and the ball's radius. It is also at most the distance from any one convex item of the set, which is convex and
//! so greatest at a corner: simplices that lie flat against an item are done at once. The simplex of greatest bound is halved,
//! until none may hold much more than the greatest distance found. Of a set with an inside only what lies outside counts: a
//! simplex that lies inside as a whole is done.
//!
//! # Source
//! The distance as a Lipschitz function: Piyavskii, "An algorithm for finding the absolute extremum of a function" (1972).

use std::collections::BinaryHeap;

use glam::DVec3;

use super::{Cancelled, cell::Simplex, meter::Meter};
use crate::{
    answer::{Bound, Work},
    shape::{Containment, radius_up},
};

/// How often a simplex is halved at most: far beyond what f64 can tell apart.
const HALVINGS_MAX: u32 = 128;

/// Most simplices that wait at a time, some 100 MB: a search that needs more is given up.
const OPEN_MAX: usize = 1 << 19;

/// A closed set made of convex items, from which distances are measured.
pub(super) trait Field {
    /// How near the set is to a point, or that it is nearer than `enough`; `hint` is an item that may be near.
    fn near(&self, point: DVec3, hint: u32, enough: f64, work: &mut Work) -> Near;

    /// An upper bound of the distance from one item; a convex function but for its rounding.
    fn upper_to(&self, point: DVec3, item: u32, work: &mut Work) -> f64;

    /// On which side of the set's border a point lies, if it has an inside.
    fn side(&self, point: DVec3, work: &mut Work) -> Containment;

    /// How far a simplex may reach out of the set, if no more than touches its border is in it: see [`super::beyond_mesh`].
    fn lid(&self, simplex: &Simplex, inside: DVec3, near: Near, target: f64, work: &mut Work) -> f64;

    /// What a bound is widened by for rounding, metres.
    fn slack(&self) -> f64;
}

/// The nearest item to a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// The border of the set is not nearer than this.
    pub(super) lower: f64,
    /// The set is not farther than this.
    pub(super) upper: f64,
    pub(super) item: u32,
}

/// When a search may end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// It is enough to know that the distance is not above this.
    pub(super) enough: f64,
    /// Or to know it to within this part of itself.
    pub(super) share: f64,
    /// Or to know that it is above this.
    pub(super) hopeless: f64,
}

/// How far simplices reach beyond a set.
#[derive(Clone, Copy, Debug)]
pub(super) struct Farthest {
    pub(super) bound: Bound,
    /// A point of them that is nearly as far as any, and the item that is nearest to it.
    pub(super) point: DVec3,
    pub(super) item: u32,
}

/// How far simplices reach beyond a set, if it is `known` that it is not farther than that. A budget that is spent leaves the
/// interval wide.
pub(super) fn farthest(
    field: &impl Field,
    simplices: impl IntoIterator<Item = Simplex>,
    known: f64,
    goal: Goal,
    meter: &mut Meter<'_>,
) -> Result<Farthest, Cancelled> {
    let found = Farthest { bound: Bound::new(0.0, 0.0), point: DVec3::ZERO, item: 0 };
    let mut search = Search { field, goal, known, open: BinaryHeap::new(), found, last: 0, offered: 0 };
    for simplex in simplices {
        if meter.is_spent() || search.is_hopeless() {
            search.drop(known);
            break;
        }
        search.offer(simplex, None, &mut meter.work);
        meter.pass()?;
    }
    search.run(meter)?;
    Ok(search.found)
}

/// A simplex that is not done yet.
#[derive(Clone, Copy)]
struct Cell {
    simplex: Simplex,
    upper: f64,
    center: DVec3,
    /// No border is nearer to the middle than this.
    clear: f64,
    side: Containment,
    item: u32,
    halvings: u32,
    /// In the order found: of equal bounds the first goes on.
    number: u64,
}

struct Search<'a, F> {
    field: &'a F,
    goal: Goal,
    known: f64,
    open: BinaryHeap<Cell>,
    found: Farthest,
    /// The item that was nearest last.
    last: u32,
    offered: u64,
}

impl<F: Field> Search<'_, F> {
    fn run(&mut self, meter: &mut Meter<'_>) -> Result<(), Cancelled> {
        while let Some(cell) = self.open.pop() {
            meter.pass()?;
            let is_full = self.open.len() >= OPEN_MAX;
            if cell.upper <= self.target() || meter.is_spent() || is_full || self.is_hopeless() {
                self.drop(cell.upper);
                break;
            }
            if cell.halvings >= HALVINGS_MAX {
                self.drop(cell.upper);
                continue;
            }
            for half in cell.simplex.halves() {
                self.offer(half, Some(&cell), &mut meter.work);
            }
        }
        let slack = self.field.slack();
        let Bound { lower, upper } = self.found.bound;
        self.found.bound = Bound::new((lower - slack).max(0.0), upper.max(lower) + slack);
        Ok(())
    }

    /// Nothing up to this needs a closer look.
    fn target(&self) -> f64 {
        self.goal.enough.max(self.found.bound.lower * (1.0 + self.goal.share))
    }

    fn is_hopeless(&self) -> bool {
        self.found.bound.lower - self.field.slack() > self.goal.hopeless
    }

    fn drop(&mut self, upper: f64) {
        self.found.bound.upper = self.found.bound.upper.max(upper);
    }

    /// Bounds a simplex, and keeps it if it may hold more than is known.
    fn offer(&mut self, simplex: Simplex, parent: Option<&Cell>, work: &mut Work) {
        let (center, radius) = simplex.ball();
        work.pairs_tested += 1;
        let target = self.target();
        let near = self.field.near(center, parent.map_or(self.last, |parent| parent.item), target - radius, work);
        self.last = near.item;
        let mut upper = parent.map_or(self.known, |parent| parent.upper).min(near.upper + radius);
        if upper > target {
            let farther = |most: f64, &corner: &DVec3| most.max(self.field.upper_to(corner, near.item, work));
            upper = upper.min(simplex.corners().iter().fold(0.0, farther));
        }
        if upper <= target {
            return self.drop(upper);
        }
        let side = match parent {
            Some(parent) if radius_up(parent.center, &[center]) < parent.clear => parent.side,
            _ => self.field.side(center, work),
        };
        match side {
            Containment::Inside => {
                upper = upper.min((radius - near.lower).max(0.0));
                if upper > target {
                    upper = upper.min(self.field.lid(&simplex, center, near, target, work));
                }
                if upper <= target {
                    return self.drop(upper);
                }
            }
            Containment::Outside if near.lower > self.found.bound.lower => {
                self.found.bound.lower = near.lower;
                (self.found.point, self.found.item) = (center, near.item);
            }
            Containment::Outside | Containment::Undecided => {}
        }
        self.offered += 1;
        self.open.push(Cell {
            simplex,
            upper,
            center,
            clear: near.lower,
            side,
            item: near.item,
            halvings: parent.map_or(0, |parent| parent.halvings + 1),
            number: self.offered,
        });
    }
}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.upper.total_cmp(&other.upper).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Cell {}
