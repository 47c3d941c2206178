//! All pairs of shapes that overlap.
//!
//! # Method
//! The trees enumerate the pairs whose boxes may touch, the canonical boxes judge first, the kernels decide. What is found
//! is sorted by ids, so the list depends on the shapes alone. Its changes between two versions are found from the shapes
//! that differ between them ([`since`]); who follows a world from version to version may keep the list ([`keeper`]).
//!
//! # Limits
//! [`PAIRS_MAX`] pairs and [`STEPS_MAX`] steps: a heap of shapes in one place has as many pairs as the square of their
//! number, and ends in an error instead of in gigabytes.

mod candidates;
mod keeper;
mod since;

pub(super) use candidates::want_each_other;
pub use keeper::PairKeeper;
pub use since::{PairChanges, Persisted};

use super::{Filter, Meter, QuestionError, ShapeId, Snapshot, notes::Note, search::Side};
use crate::{
    accuracy::Accuracy,
    answer::{Certificate, Verdict},
    narrow,
};

/// Pairs of a list at most.
pub const PAIRS_MAX: usize = 1 << 22;

/// Pairs of convex pieces and iterations that a list may take at most, in all.
pub const STEPS_MAX: u64 = 1 << 28;

/// Two shapes that overlap, or may do so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The shape with the lower id.
    pub a: ShapeId,
    /// The other shape.
    pub b: ShapeId,
    /// `Hit` or `Undecided`, and bounds of the signed distance, metres.
    pub certificate: Certificate,
}

impl Pair {
    fn ids(&self) -> (ShapeId, ShapeId) {
        (self.a, self.b)
    }
}

impl Snapshot {
    /// All pairs of shapes that overlap or may do so, ascending by `a`, then `b`. Two shapes are a pair if each wants the
    /// other (layers both ways, groups), they are not both static, and both pass the filter. Sensors and half spaces take
    /// part as all shapes do; of a mesh its surface counts.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use collision::{DVec3, accuracy::Accuracy, math::Pose, shape::Geometry, world::*};
    ///
    /// let ball = Arc::new(Geometry::sphere(1.0)?);
    /// let balls = (1..=3_u32).map(|i| {
    ///     let pose = Pose::at(DVec3::X * 1.5 * f64::from(i));
    ///     Edit::Insert(Shape::new(ShapeId::new(i.into()).unwrap(), Arc::clone(&ball), pose))
    /// });
    /// let mut world = World::new(Time(0));
    /// world.apply(balls.collect(), Time(0), EditRule::AllOrNothing)?;
    /// let mut go_on = || true;
    /// let pairs = world.newest().pairs(&Filter::default(), &Accuracy::default(), &mut Meter::new(&mut go_on))?;
    /// assert_eq!(pairs.iter().map(|pair| (pair.a.get(), pair.b.get())).collect::<Vec<_>>(), [(1, 2), (2, 3)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`QuestionError::TooManyPairs`], [`QuestionError::Interrupted`].
    pub fn pairs(
        &self,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Vec<Pair>, QuestionError> {
        let _asking = self.asking().now();
        let mut judge = Judge::new(accuracy, meter);
        self.each_box_pair(filter, meter, |meter, a, b| judge.take(&a, &b, meter))?;
        Ok(judge.into_sorted())
    }

    /// Calls `visit` with the ids of all pairs whose canonical boxes touch, the lower id first, each pair once, in no
    /// certain order. Which shapes are pairs is as in [`Snapshot::pairs`].
    ///
    /// # Errors
    /// What `visit` returned, [`QuestionError::Interrupted`].
    pub fn box_pairs(
        &self,
        filter: &Filter,
        meter: &mut Meter<'_>,
        mut visit: impl FnMut(ShapeId, ShapeId) -> Result<(), QuestionError>,
    ) -> Result<(), QuestionError> {
        self.each_box_pair(filter, meter, |_, a, b| {
            let (a, b) = (candidates::id_of(&a), candidates::id_of(&b));
            visit(a.min(b), a.max(b))
        })
    }
}

/// Tests pairs and keeps those that are not proved apart.
struct Judge<'a> {
    accuracy: &'a Accuracy,
    found: Vec<Pair>,
    judged_count: u64,
    /// Steps that the meter had counted before.
    steps_before: u64,
}

impl<'a> Judge<'a> {
    fn new(accuracy: &'a Accuracy, meter: &Meter<'_>) -> Self {
        Self { accuracy, found: Vec::new(), judged_count: 0, steps_before: steps(meter) }
    }

    /// Takes a pair whose boxes touch.
    ///
    /// One error stands for both limits: which of them is passed first would depend on the order of the pairs.
    fn take(&mut self, a: &Side<'_>, b: &Side<'_>, meter: &mut Meter<'_>) -> Result<(), QuestionError> {
        meter.look()?;
        let (a, b) = if candidates::id_of(a) < candidates::id_of(b) { (a, b) } else { (b, a) };
        let certificate = narrow::overlap(a.placed, b.placed, self.accuracy, &mut meter.work);
        meter.note(|| Note::of([a.id(), b.id()], Some(certificate)));
        self.judged_count += 1;
        if certificate.verdict != Verdict::Miss {
            self.found.push(Pair { a: candidates::id_of(a), b: candidates::id_of(b), certificate });
        }
        let taken = self.judged_count + steps(meter) - self.steps_before;
        if self.found.len() > PAIRS_MAX || taken > STEPS_MAX { Err(QuestionError::TooManyPairs) } else { Ok(()) }
    }

    fn into_sorted(mut self) -> Vec<Pair> {
        self.found.sort_unstable_by_key(Pair::ids);
        self.found
    }
}

fn steps(meter: &Meter<'_>) -> u64 {
    meter.work.pairs_tested + meter.work.iterations
}
