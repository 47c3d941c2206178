//! Which shapes a question has to look at: from both trees, the static one first.

use std::ops::ControlFlow;

use smallvec::{SmallVec, smallvec};

use super::{
    Filter, Meter, QuestionError, Shape, ShapeId, Snapshot, Subject,
    filter::Sieve,
    store::{Entry, Slot},
};
use crate::{
    broad::{Path, Tree},
    math::{Aabb, Pose},
    narrow::Placed,
    shape::{Form, Geometry},
};

/// One side of a question: a form, where it is, and which shape of the world it is, if any.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side<'a> {
    pub(super) placed: Placed<'a>,
    /// Where it is says `placed`, which for a past moment is made up; all else holds.
    pub(super) shape: Option<&'a Shape>,
    /// Its canonical box where it is placed.
    pub(super) bounds: Aabb,
}

impl<'a> Side<'a> {
    /// A shape of the world where it is.
    pub(super) fn of(entry: &'a Entry) -> Self {
        Self {
            placed: Placed { geometry: &entry.shape.geometry, pose: entry.shape.pose },
            shape: Some(&entry.shape),
            bounds: entry.bounds,
        }
    }

    fn at(geometry: &'a Geometry, pose: Pose, shape: Option<&'a Shape>) -> Self {
        Self { placed: Placed { geometry, pose }, shape, bounds: geometry.bounds(&pose) }
    }

    /// Its id, if it is a shape of the world.
    pub(super) fn id(&self) -> Option<ShapeId> {
        self.shape.map(|shape| shape.id)
    }

    /// Whether it blocks nothing.
    pub(super) fn is_sensor(&self) -> bool {
        self.shape.is_some_and(|shape| shape.sensor)
    }

    /// The shape's user data; 0 for a geometry.
    pub(super) fn user_data(&self) -> u64 {
        self.shape.map_or(0, |shape| shape.user_data)
    }
}

/// Sides in order; those that a usual question sees have room here.
pub(super) type Sides<'a> = SmallVec<[Side<'a>; 64]>;

/// Larger by `margin` on each side, rounded outwards.
pub(super) fn outward(bounds: Aabb, margin: f64) -> Aabb {
    let inflated = bounds.inflated(margin);
    Aabb::new(inflated.min.map(f64::next_down), inflated.max.map(f64::next_up))
}

impl Snapshot {
    /// What a question is about; no half space.
    pub(super) fn subject<'a>(&'a self, subject: &'a Subject) -> Result<Side<'a>, QuestionError> {
        let side = self.side(subject).map_err(QuestionError::SubjectNotFound)?;
        match side.placed.geometry.form() {
            Form::HalfSpace(_) => Err(QuestionError::SubjectUnbounded(side.id())),
            Form::Convex(_) | Form::Mesh(_) => Ok(side),
        }
    }

    /// What it is asked against, if it names that.
    pub(super) fn against<'a>(&'a self, against: Option<&'a Subject>) -> Result<Option<Side<'a>>, QuestionError> {
        against.map(|against| self.side(against)).transpose().map_err(QuestionError::AgainstNotFound)
    }

    /// What it is asked against, by id: that which it names, or what of the world touches `query`.
    pub(super) fn others_in<'a>(
        &'a self,
        query: Aabb,
        subject: &Side<'_>,
        against: Option<&'a Subject>,
        filter: &Filter,
        meter: &mut Meter<'_>,
    ) -> Result<Sides<'a>, QuestionError> {
        match self.against(against)? {
            Some(other) if other.bounds.intersects(query) => Ok(smallvec![other]),
            Some(_) => Ok(Sides::new()),
            None => self.seen_in(query, subject.shape, filter, meter),
        }
    }

    fn side<'a>(&'a self, subject: &'a Subject) -> Result<Side<'a>, ShapeId> {
        match subject {
            Subject::Geometry { geometry, pose } => Ok(Side::at(geometry, *pose, None)),
            Subject::Shape { id, pose } => {
                let entry = self.state.get(*id).ok_or(*id)?;
                Ok(match pose {
                    Some(pose) => Side::at(&entry.shape.geometry, *pose, Some(&entry.shape)),
                    None => Side::of(entry),
                })
            }
        }
    }

    /// What is in a slot.
    fn side_in(&self, slot: Slot) -> Side<'_> {
        Side::of(self.state.shapes.entry(slot))
    }

    /// What an asker sees of what touches `query`, by id.
    fn seen_in(
        &self,
        query: Aabb,
        asker: Option<&Shape>,
        filter: &Filter,
        meter: &mut Meter<'_>,
    ) -> Result<Sides<'_>, QuestionError> {
        let sieve = Sieve::new(filter, asker);
        let mut seen = Sides::new();
        let mut see = |slot: Slot| {
            let side = self.side_in(slot);
            if side.bounds.intersects(query) && sieve.passes(&side) {
                seen.push(side);
            }
            Ok(ControlFlow::Continue(()))
        };
        if self.state.static_count > 0 {
            let fixed = self.state.fixed();
            fixed.tree.visit_box(query, sieve.layers_seen(), meter, |_, leaf| see(fixed.slot(leaf)))?;
        }
        self.state.moving.visit_box(query, sieve.layers_seen(), meter, |_, leaf| see(Slot(leaf)))?;
        seen.sort_unstable_by_key(Side::id);
        Ok(seen)
    }

    /// Visits the shapes that `path` may enter at a `t` of at most `limit`. The visitor returns the new limit.
    pub(super) fn along<'m>(
        &self,
        path: &Path,
        mut limit: f64,
        layers: u32,
        meter: &mut Meter<'m>,
        mut visit: impl FnMut(&mut Meter<'m>, Side<'_>) -> Result<f64, QuestionError>,
    ) -> Result<(), QuestionError> {
        if self.state.static_count > 0 {
            let fixed = self.state.fixed();
            fixed.tree.visit_ray(path, limit, layers, meter, |meter, leaf| {
                limit = limit.min(visit(meter, self.side_in(fixed.slot(leaf)))?);
                Ok(limit)
            })?;
        }
        self.state.moving.visit_ray(path, limit, layers, meter, |meter, leaf| visit(meter, self.side_in(Slot(leaf))))
    }

    /// Visits the shapes whose boxes may be within `limit` metres of `query`, in each tree the nearest first. The visitor
    /// returns the new limit.
    pub(super) fn near<'m>(
        &self,
        query: Aabb,
        mut limit: f64,
        layers: u32,
        meter: &mut Meter<'m>,
        mut visit: impl FnMut(&mut Meter<'m>, Side<'_>) -> Result<f64, QuestionError>,
    ) -> Result<(), QuestionError> {
        if self.state.static_count > 0 {
            let fixed = self.state.fixed();
            fixed.tree.visit_nearest(query, limit, layers, meter, |meter, leaf| {
                limit = limit.min(visit(meter, self.side_in(fixed.slot(leaf)))?);
                Ok(limit)
            })?;
        }
        self.state
            .moving
            .visit_nearest(query, limit, layers, meter, |meter, leaf| visit(meter, self.side_in(Slot(leaf))))
    }
}
