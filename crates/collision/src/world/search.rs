//! Which shapes a question has to look at: from both trees, the static one first.

use std::ops::ControlFlow;

use super::{
    Filter, Meter, QuestionError, Shape, ShapeId, Snapshot, Subject,
    batch::Batch,
    filter::Sieve,
    history::Past,
    outline::Outline,
    snapshot::Content,
    state::{Fixed, State},
    store::{Entry, Slot},
};
use crate::{
    broad::{DynamicTree, Line, Tree},
    math::{Aabb, Pose},
    narrow::{Operand, Placed},
    shape::{Form, Geometry, Simple},
};

/// One side of a question: a form, where it is, and which shape of the world it is, if any.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side<'a> {
    pub(super) placed: Placed<'a>,
    /// Its form, if that is simple and at hand.
    pub(super) simple: Option<&'a Simple>,
    /// Where it is says `placed`, which for a past moment is made up; all else holds.
    pub(super) shape: Option<&'a Shape>,
    /// Its canonical box where it is placed.
    pub(super) bounds: Aabb,
}

impl<'a> Side<'a> {
    /// A shape of the world where it is.
    #[inline]
    pub(super) fn of(entry: &'a Entry) -> Self {
        let shape = entry.shape();
        Self {
            placed: Placed { geometry: &shape.geometry, pose: shape.pose },
            simple: entry.simple.as_ref(),
            shape: Some(shape),
            bounds: entry.bounds,
        }
    }

    pub(super) fn at(geometry: &'a Geometry, pose: Pose, shape: Option<&'a Shape>) -> Self {
        Self { placed: Placed { geometry, pose }, simple: None, shape, bounds: geometry.bounds(&pose) }
    }

    /// Itself for a kernel.
    pub(super) fn operand(&self) -> Operand<'a> {
        Operand { placed: self.placed, simple: self.simple }
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

/// Larger by `margin` on each side, rounded outwards.
pub(super) fn outward(bounds: Aabb, margin: f64) -> Aabb {
    let inflated = bounds.inflated(margin);
    Aabb::new(inflated.min.map(f64::next_down), inflated.max.map(f64::next_up))
}

impl Snapshot {
    /// What a question is about; no half space.
    pub(super) fn subject<'a>(&'a self, subject: &'a Subject) -> Result<Side<'a>, QuestionError> {
        let side = self.side(subject, QuestionError::SubjectNotFound)?;
        match side.placed.geometry.form() {
            Form::HalfSpace(_) => Err(QuestionError::SubjectUnbounded(side.id())),
            Form::Convex(_) | Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_) => Ok(side),
        }
    }

    /// What it is asked against, if it names that.
    pub(super) fn against<'a>(&'a self, against: Option<&'a Subject>) -> Result<Option<Side<'a>>, QuestionError> {
        against.map(|against| self.other(against)).transpose()
    }

    /// What a question is asked against.
    pub(super) fn other<'a>(&'a self, against: &'a Subject) -> Result<Side<'a>, QuestionError> {
        self.side(against, QuestionError::AgainstNotFound)
    }

    /// Visits what may touch the subject, by its outline, of that which a question is asked against: of what it names, or of
    /// what the subject sees.
    pub(super) fn others_near<'a, 'm>(
        &'a self,
        outline: &Outline,
        (subject, against): (&Side<'_>, Option<&'a Subject>),
        filter: &Filter,
        meter: &mut Meter<'m>,
        mut visit: impl FnMut(&mut Meter<'m>, Side<'a>) -> Result<(), QuestionError>,
    ) -> Result<(), QuestionError> {
        let Some(against) = against else {
            return self.seen_near(outline, subject.shape, filter, meter, visit);
        };
        let other = self.other(against)?;
        if outline.may_touch(&other.bounds) { visit(meter, other) } else { Ok(()) }
    }

    #[inline]
    fn side<'a>(
        &'a self,
        subject: &'a Subject,
        missing: impl FnOnce(ShapeId) -> QuestionError,
    ) -> Result<Side<'a>, QuestionError> {
        match subject {
            Subject::Geometry { geometry, pose } => Ok(Side::at(geometry, *pose, None)),
            Subject::Shape { id, pose } => {
                let side = self.find(*id).ok_or_else(|| missing(*id))?;
                Ok(match pose {
                    Some(pose) => Side::at(side.placed.geometry, *pose, side.shape),
                    None => side,
                })
            }
        }
    }

    /// The trees that a question searches.
    pub(super) fn trees(&self) -> Trees<'_> {
        let (state, past) = match &self.content {
            Content::Now(state) => (state, None),
            Content::Then(past) => (past.base(), Some(past)),
        };
        Trees {
            state,
            past,
            fixed: (state.static_count > 0).then(|| state.fixed(self.tick)),
            moving: past.is_none_or(Past::searches_moving).then_some(&state.moving),
        }
    }

    /// Visits what an asker sees of what may touch an outline.
    pub(super) fn seen_near<'a, 'm>(
        &'a self,
        outline: &Outline,
        asker: Option<&Shape>,
        filter: &Filter,
        meter: &mut Meter<'m>,
        mut visit: impl FnMut(&mut Meter<'m>, Side<'a>) -> Result<(), QuestionError>,
    ) -> Result<(), QuestionError> {
        let sieve = Sieve::new(filter, asker);
        let (layers, query) = (sieve.layers_seen(), outline.bounds());
        let trees = self.trees();
        let mut batch = Batch::default();
        let mut look = |meter: &mut Meter<'m>, batch: &mut Batch<'a>| {
            batch.visit_near(outline, |entry| {
                if sieve.lets_through(entry.shape()) { visit(meter, Side::of(entry)) } else { Ok(()) }
            })
        };
        let mut offer = |meter: &mut Meter<'m>, slot: Slot| {
            if let Some(entry) = trees.entry_in(slot) {
                batch.add(entry);
            }
            if batch.is_full() {
                look(meter, &mut batch)?;
            }
            Ok(ControlFlow::Continue(()))
        };
        if let Some(fixed) = trees.fixed {
            fixed.tree.visit_box(query, layers, meter, |meter, leaf| offer(meter, fixed.slot(leaf)))?;
        }
        if let Some(moving) = trees.moving {
            moving.visit_box(query, layers, meter, |meter, leaf| offer(meter, Slot(leaf)))?;
        }
        look(meter, &mut batch)?;
        if let Some(past) = trees.past {
            past.tree().visit_box(query, layers, meter, |meter, leaf| {
                let side = past.side_of(leaf).filter(|side| outline.may_touch(&side.bounds) && sieve.passes(side));
                side.map_or(Ok(()), |side| visit(meter, side)).map(ControlFlow::Continue)
            })?;
        }
        Ok(())
    }

    /// Visits the shapes that the path of `line` may enter at a `t` of at most `limit`. The visitor returns the new limit.
    pub(super) fn along<'m>(
        &self,
        line: &Line,
        limit: f64,
        layers: u32,
        meter: &mut Meter<'m>,
        visit: impl FnMut(&mut Meter<'m>, Side<'_>) -> Result<f64, QuestionError>,
    ) -> Result<(), QuestionError> {
        let trees = self.trees();
        let mut visitor = Visitor { limit, visit };
        if let Some(fixed) = trees.fixed {
            fixed.tree.visit_ray(line, limit, layers, meter, |meter, leaf| {
                visitor.visit(meter, trees.side_in(fixed.slot(leaf)))
            })?;
        }
        if let Some(moving) = trees.moving {
            let limit = visitor.limit;
            moving
                .visit_ray(line, limit, layers, meter, |meter, leaf| visitor.visit(meter, trees.side_in(Slot(leaf))))?;
        }
        if let Some(past) = trees.past {
            let limit = visitor.limit;
            past.tree()
                .visit_ray(line, limit, layers, meter, |meter, leaf| visitor.visit(meter, past.side_of(leaf)))?;
        }
        Ok(())
    }

    /// Visits the shapes whose boxes may be within `limit` metres of `query`, in each tree the nearest first. The visitor
    /// returns the new limit.
    pub(super) fn near<'m>(
        &self,
        query: Aabb,
        limit: f64,
        layers: u32,
        meter: &mut Meter<'m>,
        visit: impl FnMut(&mut Meter<'m>, Side<'_>) -> Result<f64, QuestionError>,
    ) -> Result<(), QuestionError> {
        let trees = self.trees();
        let mut visitor = Visitor { limit, visit };
        if let Some(fixed) = trees.fixed {
            fixed.tree.visit_nearest(query, limit, layers, meter, |meter, leaf| {
                visitor.visit(meter, trees.side_in(fixed.slot(leaf)))
            })?;
        }
        if let Some(moving) = trees.moving {
            let limit = visitor.limit;
            moving.visit_nearest(query, limit, layers, meter, |meter, leaf| {
                visitor.visit(meter, trees.side_in(Slot(leaf)))
            })?;
        }
        if let Some(past) = trees.past {
            let limit = visitor.limit;
            past.tree()
                .visit_nearest(query, limit, layers, meter, |meter, leaf| visitor.visit(meter, past.side_of(leaf)))?;
        }
        Ok(())
    }
}

/// The trees that a question searches.
pub(super) struct Trees<'a> {
    pub(super) state: &'a State,
    /// What was otherwise, if a past moment is asked: that has a tree of its own.
    pub(super) past: Option<&'a Past>,
    /// Over the static shapes, if there are any.
    pub(super) fixed: Option<&'a Fixed>,
    /// Over the moving shapes, unless the tree of the past holds them all.
    pub(super) moving: Option<&'a DynamicTree>,
}

impl<'a> Trees<'a> {
    /// What is in a slot, unless it was something else at the moment that is asked.
    #[inline]
    fn entry_in(&self, slot: Slot) -> Option<&'a Entry> {
        match self.past {
            None => Some(self.state.shapes.entry(slot)),
            Some(past) => past.entry_in(slot),
        }
    }

    /// The same, as a side of a question.
    #[inline]
    fn side_in(&self, slot: Slot) -> Option<Side<'a>> {
        self.entry_in(slot).map(Side::of)
    }
}

/// A visitor of several trees, one after the other, under one limit.
struct Visitor<V> {
    limit: f64,
    visit: V,
}

impl<V> Visitor<V> {
    /// Shows what is there, and gives the new limit.
    fn visit<'m>(&mut self, meter: &mut Meter<'m>, side: Option<Side<'_>>) -> Result<f64, QuestionError>
    where
        V: FnMut(&mut Meter<'m>, Side<'_>) -> Result<f64, QuestionError>,
    {
        if let Some(side) = side {
            self.limit = self.limit.min((self.visit)(meter, side)?);
        }
        Ok(self.limit)
    }
}
