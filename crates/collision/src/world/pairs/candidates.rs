//! Which pairs the boxes let through.
//!
//! # Method
//! The tree of the moving shapes is joined with itself. For
//! pairs with static shapes, the fewer of the two kinds ask the tree of the other. Two static shapes are never a pair, so
//! a world of static shapes needs no tree.

use std::ops::ControlFlow;

use crate::{
    broad::{ALL_LAYERS, Tree},
    world::{
        Filter, Meter, Mobility, QuestionError, Shape, ShapeId, Snapshot,
        filter::Sieve,
        search::Side,
        store::{Entry, Slot},
    },
};

/// Whether two shapes are a pair wherever they are: each wants the other, they are of no common group and not both static.
pub(in crate::world) fn want_each_other(a: &Shape, b: &Shape) -> bool {
    let is_wanted = a.layers & b.collides_with != 0 && b.layers & a.collides_with != 0;
    let is_of_one_group = a.group != 0 && a.group == b.group;
    let stands = a.mobility == Mobility::Static && b.mobility == Mobility::Static;
    is_wanted && !is_of_one_group && !stands
}

/// The id of a side that came from a tree.
pub(super) fn id_of(side: &Side<'_>) -> ShapeId {
    side.id().expect("trees hold shapes of the world")
}

impl Snapshot {
    /// Calls `visit` with each pair whose canonical boxes touch and whose shapes want each other and pass the filter; each
    /// pair once, in no certain order.
    pub(super) fn each_box_pair<'m>(
        &self,
        filter: &Filter,
        meter: &mut Meter<'m>,
        mut visit: impl FnMut(&mut Meter<'m>, Side<'_>, Side<'_>) -> Result<(), QuestionError>,
    ) -> Result<(), QuestionError> {
        let state = self.state();
        let sieve = Sieve::new(filter, None);
        if state.moving.is_empty() {
            return Ok(());
        }
        let mut offer = |meter: &mut Meter<'m>, a: &Entry, b: &Entry| {
            let (side_a, side_b) = (Side::of(a), Side::of(b));
            if is_pair(a, b) && sieve.passes(&side_a) && sieve.passes(&side_b) {
                visit(meter, side_a, side_b)?;
            }
            Ok(())
        };
        let entry_of = |leaf: u32| state.shapes.entry(Slot(leaf));
        state.moving.visit_pairs(meter, |meter, a, b| offer(meter, entry_of(a), entry_of(b)))?;
        if state.static_count == 0 {
            return Ok(());
        }
        let moving_asks = state.moving.len() <= state.static_count;
        for (_, entry) in state.shapes.iter().filter(|(_, entry)| entry.is_static() != moving_asks) {
            meter.spend()?;
            if moving_asks {
                self.fixed_near(entry, meter, |meter, other| offer(meter, entry, other))?;
            } else {
                self.moving_near(entry, meter, |meter, other| offer(meter, entry, other))?;
            }
        }
        Ok(())
    }

    /// Calls `visit` with each partner of a shape: as [`Snapshot::each_box_pair`], the shape itself first.
    pub(super) fn each_partner<'m>(
        &self,
        id: ShapeId,
        sieve: &Sieve<'_>,
        meter: &mut Meter<'m>,
        mut visit: impl FnMut(&mut Meter<'m>, Side<'_>, Side<'_>) -> Result<(), QuestionError>,
    ) -> Result<(), QuestionError> {
        let Some(entry) = self.state().get(id).filter(|entry| sieve.passes(&Side::of(entry))) else {
            return Ok(());
        };
        meter.spend()?;
        let mut offer = |meter: &mut Meter<'m>, other: &Entry| {
            if other.shape().id != id && is_pair(entry, other) && sieve.passes(&Side::of(other)) {
                visit(meter, Side::of(entry), Side::of(other))?;
            }
            Ok(())
        };
        self.moving_near(entry, meter, &mut offer)?;
        if entry.is_static() { Ok(()) } else { self.fixed_near(entry, meter, &mut offer) }
    }

    fn moving_near<'m>(
        &self,
        entry: &Entry,
        meter: &mut Meter<'m>,
        mut visit: impl FnMut(&mut Meter<'m>, &Entry) -> Result<(), QuestionError>,
    ) -> Result<(), QuestionError> {
        self.state().moving.visit_box(entry.bounds, ALL_LAYERS, meter, |meter, leaf| {
            visit(meter, self.state().shapes.entry(Slot(leaf))).map(ControlFlow::Continue)
        })
    }

    fn fixed_near<'m>(
        &self,
        entry: &Entry,
        meter: &mut Meter<'m>,
        mut visit: impl FnMut(&mut Meter<'m>, &Entry) -> Result<(), QuestionError>,
    ) -> Result<(), QuestionError> {
        if self.state().static_count == 0 {
            return Ok(());
        }
        let fixed = self.state().fixed(self.tick);
        fixed.tree.visit_box(entry.bounds, ALL_LAYERS, meter, |meter, leaf| {
            visit(meter, self.state().shapes.entry(fixed.slot(leaf))).map(ControlFlow::Continue)
        })
    }
}

fn is_pair(a: &Entry, b: &Entry) -> bool {
    a.bounds.intersects(b.bounds) && want_each_other(a.shape(), b.shape())
}
