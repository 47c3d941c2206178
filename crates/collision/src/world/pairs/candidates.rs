//! Which pairs the boxes let through.
//!
//! # Method
//! Each moving shape asks the tree of the moving ones, and of a pair that both find the one with the lower slot counts. For
//! pairs with static shapes, the fewer of the two kinds ask the tree of the other. Two static shapes are never a pair, so
//! a world of static shapes needs no tree.

use std::ops::ControlFlow;

use crate::{
    broad::Tree,
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
        let state = &self.state;
        let sieve = Sieve::new(filter, None);
        let (moving, fixed) = (state.moving.len(), state.static_count);
        let moving_asks_fixed = moving <= fixed;
        for (slot, entry) in state.shapes.iter() {
            let is_moving = entry.leaf.is_some();
            if moving == 0 || !sieve.passes(&entry.shape) {
                continue;
            }
            meter.spend()?;
            let mut offer = |meter: &mut Meter<'m>, other: &Entry| {
                if is_pair(entry, other) && sieve.passes(&other.shape) {
                    visit(meter, Side::of(entry), Side::of(other))?;
                }
                Ok(())
            };
            if is_moving || !moving_asks_fixed {
                self.moving_near(entry, meter, |meter, other_slot, other| {
                    // Of two moving shapes both ask, a static one is not asked back.
                    if !is_moving || slot.0 < other_slot.0 { offer(meter, other) } else { Ok(()) }
                })?;
            }
            if is_moving && moving_asks_fixed {
                self.fixed_near(entry, meter, |meter, _, other| offer(meter, other))?;
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
        let Some(entry) = self.state.get(id).filter(|entry| sieve.passes(&entry.shape)) else {
            return Ok(());
        };
        meter.spend()?;
        let mut offer = |meter: &mut Meter<'m>, _: Slot, other: &Entry| {
            if other.shape.id != id && is_pair(entry, other) && sieve.passes(&other.shape) {
                visit(meter, Side::of(entry), Side::of(other))?;
            }
            Ok(())
        };
        self.moving_near(entry, meter, &mut offer)?;
        match entry.leaf {
            Some(_) => self.fixed_near(entry, meter, &mut offer),
            None => Ok(()),
        }
    }

    fn moving_near<'m>(
        &self,
        entry: &Entry,
        meter: &mut Meter<'m>,
        mut visit: impl FnMut(&mut Meter<'m>, Slot, &Entry) -> Result<(), QuestionError>,
    ) -> Result<(), QuestionError> {
        self.state.moving.visit_box(entry.bounds, meter, |meter, leaf| {
            visit(meter, Slot(leaf), self.state.shapes.entry(Slot(leaf))).map(ControlFlow::Continue)
        })
    }

    fn fixed_near<'m>(
        &self,
        entry: &Entry,
        meter: &mut Meter<'m>,
        mut visit: impl FnMut(&mut Meter<'m>, Slot, &Entry) -> Result<(), QuestionError>,
    ) -> Result<(), QuestionError> {
        if self.state.static_count == 0 {
            return Ok(());
        }
        let fixed = self.state.fixed();
        fixed.tree.visit_box(entry.bounds, meter, |meter, leaf| {
            let slot = fixed.slot(leaf);
            visit(meter, slot, self.state.shapes.entry(slot)).map(ControlFlow::Continue)
        })
    }
}

fn is_pair(a: &Entry, b: &Entry) -> bool {
    a.bounds.intersects(b.bounds) && want_each_other(&a.shape, &b.shape)
}
