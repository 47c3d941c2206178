//! Questions to a version of a world, and their answers.

use std::sync::Arc;

use glam::DVec3;

use super::{Filter, ShapeId, Snapshot};
use crate::{
    accuracy::Accuracy,
    answer::{Certificate, Feature, Verdict, Work},
    math::Pose,
    narrow::{ContactPoint, Ray},
    shape::Geometry,
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
}

/// What does a ray hit?
#[derive(Clone, Debug)]
pub struct Raycast {
    /// The ray.
    pub ray: Ray,
    /// Which hits to return.
    pub mode: HitMode,
}

/// Which shapes touch the subject?
#[derive(Clone, Debug)]
pub struct Overlap {
    /// What to test.
    pub subject: Subject,
    /// Only against this; `None` is the whole world.
    pub against: Option<Subject>,
    /// At most this many hits.
    pub max_hits: usize,
}

/// How deep do shapes and the subject overlap, and where do they touch?
#[derive(Clone, Debug)]
pub struct Penetration {
    /// What to test.
    pub subject: Subject,
    /// Only against this; `None` is the whole world.
    pub against: Option<Subject>,
    /// Also contacts that are still this far apart, metres.
    pub max_gap: f64,
    /// At most this many contacts.
    pub max_contacts: usize,
}

/// What does the subject touch first when it goes by `displacement` without turning?
#[derive(Clone, Debug)]
pub struct TimeOfImpact {
    /// What moves.
    pub subject: Subject,
    /// Where to, from its pose, metres.
    pub displacement: DVec3,
    /// Only against this; `None` is the whole world, standing still.
    pub against: Option<Subject>,
    /// How `against` moves in the same time, metres.
    pub against_displacement: DVec3,
    /// Pass over what is touched at the start and not yet clear of.
    pub ignore_initial: bool,
    /// Which hits to return.
    pub mode: HitMode,
}

/// Which shapes are nearest to the subject, and how near?
#[derive(Clone, Debug)]
pub struct Distance {
    /// From where.
    pub subject: Subject,
    /// Only to this; `None` is the whole world.
    pub against: Option<Subject>,
    /// Only shapes within this, metres.
    pub max_distance: f64,
    /// At most this many.
    pub max_hits: usize,
}

/// A list of hits in order.
#[derive(Clone, Debug)]
pub struct Found<H> {
    /// `Hit` if one of the hits is certain, `Undecided` if there are only undecided ones, `Miss` if it is proved that
    /// there is none.
    pub verdict: Verdict,
    /// The hits, ordered by value, equal ones by id.
    pub hits: Vec<H>,
    /// There are more than were asked for.
    pub truncated: bool,
}

/// Where a ray hits a shape.
#[derive(Clone, Debug)]
pub struct RayHit {
    /// The shape.
    pub id: ShapeId,
    /// The shape's.
    pub user_data: u64,
    /// Where, and what that is worth.
    pub touch: crate::narrow::RayTouch,
}

/// A shape that touches the subject.
#[derive(Clone, Debug)]
pub struct OverlapHit {
    /// The shape; `None` if it is a geometry given in `against`.
    pub id: Option<ShapeId>,
    /// The shape's.
    pub user_data: u64,
    /// Bounds of the signed distance, metres.
    pub certificate: Certificate,
}

/// A contact of two convex pieces.
#[derive(Clone, Debug)]
pub struct Contact {
    /// The shape; `None` if it is a geometry given in `against`.
    pub id: Option<ShapeId>,
    /// The shape's.
    pub user_data: u64,
    /// From the shape to the subject.
    pub normal: DVec3,
    /// Metres; negative is a gap.
    pub depth: f64,
    /// Where they touch: `point_on_a` is on the subject, `point_on_b` on the shape.
    pub points: Vec<ContactPoint>,
    /// The subject's piece.
    pub subject_feature: Feature,
    /// The shape's piece.
    pub feature: Feature,
    /// What the depth is worth.
    pub certificate: Certificate,
}

/// The first touch of the subject and a shape.
#[derive(Clone, Debug)]
pub struct Impact {
    /// The shape; `None` if it is a geometry given in `against`.
    pub id: Option<ShapeId>,
    /// The shape's.
    pub user_data: u64,
    /// When and where; `b` is the shape.
    pub touch: crate::narrow::ImpactTouch,
}

/// A shape near the subject.
#[derive(Clone, Debug)]
pub struct Neighbor {
    /// The shape; `None` if it is a geometry given in `against`.
    pub id: Option<ShapeId>,
    /// The shape's.
    pub user_data: u64,
    /// How far and where; `a` is the subject, `b` the shape.
    pub separation: crate::narrow::Separation,
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
    /// Depth between two meshes needs convex parts.
    #[error("shape {0:?} and the subject are both meshes without convex parts")]
    NeedsDecomposition(Option<ShapeId>),
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
        }
    }

    /// Spends one unit.
    ///
    /// # Errors
    /// [`QuestionError::Interrupted`] if the caller's check said to stop.
    pub fn spend(&mut self) -> Result<(), QuestionError> {
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

impl Snapshot {
    /// What a ray hits.
    ///
    /// # Errors
    /// [`QuestionError::Interrupted`].
    pub fn raycast(
        &self,
        _question: &Raycast,
        _filter: &Filter,
        _accuracy: &Accuracy,
        _meter: &mut Meter<'_>,
    ) -> Result<Found<RayHit>, QuestionError> {
        todo!()
    }

    /// Which shapes touch the subject, by id.
    ///
    /// # Errors
    /// A shape that is not there, [`QuestionError::Interrupted`].
    pub fn overlap(
        &self,
        _question: &Overlap,
        _filter: &Filter,
        _accuracy: &Accuracy,
        _meter: &mut Meter<'_>,
    ) -> Result<Found<OverlapHit>, QuestionError> {
        todo!()
    }

    /// How deep shapes and the subject overlap; deepest first.
    ///
    /// # Errors
    /// A shape that is not there, [`QuestionError::NeedsDecomposition`], [`QuestionError::Interrupted`].
    pub fn penetration(
        &self,
        _question: &Penetration,
        _filter: &Filter,
        _accuracy: &Accuracy,
        _meter: &mut Meter<'_>,
    ) -> Result<Found<Contact>, QuestionError> {
        todo!()
    }

    /// What the moving subject touches first.
    ///
    /// # Errors
    /// A shape that is not there, [`QuestionError::Interrupted`].
    pub fn time_of_impact(
        &self,
        _question: &TimeOfImpact,
        _filter: &Filter,
        _accuracy: &Accuracy,
        _meter: &mut Meter<'_>,
    ) -> Result<Found<Impact>, QuestionError> {
        todo!()
    }

    /// Which shapes are nearest to the subject.
    ///
    /// # Errors
    /// A shape that is not there, [`QuestionError::Interrupted`].
    pub fn distance(
        &self,
        _question: &Distance,
        _filter: &Filter,
        _accuracy: &Accuracy,
        _meter: &mut Meter<'_>,
    ) -> Result<Found<Neighbor>, QuestionError> {
        todo!()
    }
}
