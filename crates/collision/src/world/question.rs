//! What all questions to a version of a world have in common: the subject, the form of the answer, the meter.
//! Each question has a file of its own.

use std::sync::Arc;

use super::{
    HistoryError, ShapeId,
    notes::{Note, Notes},
    search::Side,
};
use crate::{
    answer::{Verdict, Work},
    broad::Toll,
    math::Pose,
    narrow::PartsWanted,
    shape::{Geometry, GeometryError},
};

/// What a question is about.
#[derive(Clone, Debug)]
pub enum Subject {
    /// A shape of the world, which does not see itself; at its own pose, or at another.
    Shape {
        /// Which.
        id: ShapeId,
        /// Where; `None` is the shape's own pose.
        pose: Option<Pose>,
    },
    /// A form that is not in the world.
    Geometry {
        /// The form.
        geometry: Arc<Geometry>,
        /// Where it is.
        pose: Pose,
    },
}

/// Which hits to return.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HitMode {
    /// The closest certain hit, after any undecided ones that may be closer.
    Closest,
    /// Any certain hit.
    Any,
    /// All of them, closest first, one for each shape, at most this many.
    All(usize),
    /// All that is not proved to lie behind the first certain blocker, closest first, and that blocker at the end. Sensors and
    /// shapes on any of these layers block nothing. Of what comes before the blocker at most `most`, those that begin first.
    Pierce {
        /// A bit for each layer.
        layers: u32,
        /// How many hits besides the blocker.
        most: usize,
    },
}

impl HitMode {
    /// Whether a side of a question blocks nothing: it is a sensor or on a layer that is pierced. In other modes nothing is.
    pub(super) fn pierces(self, side: &Side<'_>) -> bool {
        match self {
            Self::Pierce { layers, .. } => side.shape.is_some_and(|shape| shape.sensor || shape.layers & layers != 0),
            Self::Closest | Self::Any | Self::All(_) => false,
        }
    }
}

/// A list of hits in order.
#[derive(Clone, Debug)]
pub struct Found<H> {
    /// `Hit` if one of the hits is certain, `Undecided` if there are only undecided ones, `Miss` if it is proved that
    /// there is none. For [`HitMode::Pierce`] only those count that block.
    pub verdict: Verdict,
    /// The hits, ordered by value, equal ones by id.
    pub hits: Vec<H>,
    /// There are more than were asked for.
    pub truncated: bool,
}

/// Why a question has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuestionError {
    /// The subject is not in this version.
    #[error("there is no shape {0}")]
    SubjectNotFound(ShapeId),
    /// The shape in `against` is not in this version.
    #[error("there is no shape {0}")]
    AgainstNotFound(ShapeId),
    /// The subject is a half space, by its id if it is a shape: only what it is asked against may be one.
    #[error("{} is a half space, which no question is asked about: ask about the other form, against it", .0.map_or("the subject".into(), |id| format!("shape {id}")))]
    SubjectUnbounded(Option<ShapeId>),
    /// Depth between two meshes, or compounds with such, or of what is deep in a solid one, needs convex parts.
    #[error("{} and the subject both have meshes without convex parts, or one is deep in the other, a solid one", .0.map_or("what it is tested against".into(), |id| format!("shape {id}")))]
    NeedsDecomposition(Option<ShapeId>),
    /// The same where the question names an error, so that parts may be made for it: of these meshes they are not there yet. Once
    /// each has them ([`furnish`](crate::decompose::furnish)), the question has an answer.
    #[error("convex parts that a depth needs are not made yet, of {} meshes of the subject or of {}", .wanted.len(), .with.map_or("what it is tested against".into(), |id| format!("shape {id}")))]
    PartsMissing {
        /// The shape that the subject is tested against; `None` if it is a geometry.
        with: Option<ShapeId>,
        /// What is to be made.
        wanted: Vec<PartsWanted>,
    },
    /// The subject, by its id if it is a shape, must be convex for this question.
    #[error("{} is not convex, which this question needs", .0.map_or("the subject".into(), |id| format!("shape {id}")))]
    SubjectNotConvex(Option<ShapeId>),
    /// The subject with its skin is out of limits.
    #[error("the subject cannot have this skin: {0}")]
    Skin(GeometryError),
    /// A tick that it asks about is not held, or not made yet.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// More pairs overlap than a list holds, or telling which takes too many steps.
    #[error(
        "more than {} pairs overlap, or telling which takes more than {} steps",
        super::PAIRS_MAX,
        super::STEPS_MAX
    )]
    TooManyPairs,
    /// It took more steps than [`Meter::with_limit`] allows.
    #[error("the question takes more than {0} steps")]
    TooLong(u64),
    /// The caller's check said to stop.
    #[error("the question was interrupted")]
    Interrupted,
}

/// Counts the work of a question and asks its caller, every so often, whether to go on.
pub struct Meter<'a> {
    /// What was spent.
    pub work: Work,
    keep_going: &'a mut dyn FnMut() -> bool,
    units_until_check: u32,
    steps_max: u64,
    /// What was done with each pair, if that is wanted.
    notes: Option<&'a mut Notes>,
}

impl<'a> Meter<'a> {
    /// Units (node visits and pair tests) between two checks: about 100 µs of work.
    const UNITS_BETWEEN_CHECKS: u32 = 256;

    /// A meter that asks `keep_going` about every 100 µs of work; `false` ends the question as interrupted.
    pub fn new(keep_going: &'a mut dyn FnMut() -> bool) -> Self {
        Self {
            work: Work::default(),
            keep_going,
            units_until_check: Self::UNITS_BETWEEN_CHECKS,
            steps_max: u64::MAX,
            notes: None,
        }
    }

    /// Ends what takes more steps than this in all, with [`QuestionError::TooLong`]: nodes visited, shapes looked at, pairs of
    /// pieces tested and their iterations, each a step.
    #[must_use]
    pub fn with_limit(self, steps_max: u64) -> Self {
        Self { steps_max, ..self }
    }

    /// Also notes what is done with each pair. That changes no answer, nor what is counted.
    #[must_use]
    pub fn noting(self, notes: &'a mut Notes) -> Self {
        Self { notes: Some(notes), ..self }
    }

    /// Counts a shape whose geometry is looked at.
    ///
    /// # Errors
    /// As [`Meter::spend`].
    pub(super) fn look(&mut self) -> Result<(), QuestionError> {
        self.work.shapes_tested += 1;
        if let Some(notes) = &mut self.notes {
            notes.begin(&self.work);
        }
        self.spend()
    }

    /// Notes what came of the pair that was looked at last; `told` is asked only if that is wanted.
    #[inline]
    pub(super) fn note(&mut self, told: impl FnOnce() -> Note) {
        if let Some(notes) = &mut self.notes {
            notes.end(told(), &self.work);
        }
    }

    /// Spends one unit.
    ///
    /// # Errors
    /// [`QuestionError::Interrupted`] if the caller's check said to stop, [`QuestionError::TooLong`].
    pub fn spend(&mut self) -> Result<(), QuestionError> {
        if self.work.steps() > self.steps_max {
            return Err(QuestionError::TooLong(self.steps_max));
        }
        self.units_until_check -= 1;
        if self.units_until_check == 0 {
            self.units_until_check = Self::UNITS_BETWEEN_CHECKS;
            if !(self.keep_going)() {
                return Err(QuestionError::Interrupted);
            }
        }
        Ok(())
    }
}

/// The work of a question is told node by node, so that its caller can end it anywhere.
impl Toll for Meter<'_> {
    type Stop = QuestionError;

    fn pay(&mut self) -> Result<(), QuestionError> {
        self.work.nodes_visited += 1;
        self.spend()
    }
}
