//! What becomes of one overlap in a step.

use std::collections::BTreeMap;

use super::{Change, Step};
use crate::{
    accuracy::Accuracy,
    answer::Verdict,
    broad::distance_at_least,
    math::Pose,
    narrow::{self, InitialTouch, Motion},
    world::{Meter, QuestionError, ShapeId, outline::Outline, search::Side, sweeps::Moving},
};

/// What holds for all that is watched.
#[derive(Debug)]
pub(super) struct Terms {
    pub(super) accuracy: Accuracy,
    /// Metres.
    pub(super) hysteresis: f64,
}

/// Why an overlap is said to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hold {
    /// It is proved.
    Proved,
    /// It was proved, and the contrary is not: it is undecided, or the two are not far enough apart.
    Kept,
}

/// What became of one overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Outcome {
    /// What it is now; `None` if there is none.
    pub(super) hold: Option<Hold>,
    /// How that differs from before, if it does.
    pub(super) change: Option<Change>,
}

impl Outcome {
    /// It was not and is not.
    pub(super) const NOTHING: Self = Self { hold: None, change: None };

    /// From what it was, by what was seen in between, to what it is.
    fn of(was: Option<Hold>, passing: Passing, hold: Option<Hold>) -> Self {
        let change = match (was, passing, hold) {
            (None, _, Some(_)) => Some(Change::Came),
            (Some(_), _, None) => Some(Change::Went),
            (None, Passing::Seen, None) => Some(Change::CameAndWent),
            (None, Passing::NotSeen, None) | (Some(_), _, Some(_)) => None,
        };
        Self { hold, change }
    }

    /// One of the two is no longer there, or does not see the other any more.
    pub(super) fn gone(was: Option<Hold>) -> Self {
        Self::of(was, Passing::NotSeen, None)
    }
}

/// Whether two touched on the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Passing {
    /// It is proved that they did.
    Seen,
    /// It is not.
    NotSeen,
}

/// What became of those overlaps of a kind that were looked at.
pub(super) type Outcomes<K> = BTreeMap<(K, ShapeId), Outcome>;

/// A form at the end of a step, and how it came there.
pub(super) struct Body<'a> {
    pub(super) end: Side<'a>,
    pub(super) outline: Outline,
    pub(super) way: Moving<'a>,
}

impl<'a> Body<'a> {
    /// One that stands.
    pub(super) fn standing(end: Side<'a>, id: ShapeId) -> Self {
        Self { outline: Outline::of(&end), way: Moving::standing(end, id), end }
    }

    /// One that came from where `start` is.
    pub(super) fn travelling(start: Side<'a>, end: Side<'a>, id: ShapeId) -> Self {
        Self { outline: Outline::of(&end), way: Moving::travelling(start, &end.placed.pose, id), end }
    }
}

impl<'a> Step<'a> {
    /// A shape of the new version where it is, and how it came there.
    pub(super) fn body(&self, end: Side<'a>, id: ShapeId) -> Body<'a> {
        let start = self.old.filter(|_| self.passage.travelled(id)).and_then(|old| old.find(id));
        match start {
            Some(start) => Body::travelling(start, end, id),
            None => Body::standing(end, id),
        }
    }

    /// Where a shape was and is.
    pub(super) fn poses(&self, id: ShapeId) -> [Option<Pose>; 2] {
        [self.old, Some(self.new)].map(|version| Some(version?.find(id)?.placed.pose))
    }
}

impl Terms {
    /// What becomes of the overlap of a region, or the first shape of a pair, and a shape.
    pub(super) fn judge(
        &self,
        was: Option<Hold>,
        a: &Body<'_>,
        b: &Body<'_>,
        meter: &mut Meter<'_>,
    ) -> Result<Outcome, QuestionError> {
        let verdict = if a.outline.may_touch(&b.end.bounds) {
            meter.look()?;
            narrow::overlap_of(a.end.placed, b.end.operand(), &self.accuracy, &mut meter.work).verdict
        } else {
            Verdict::Miss
        };
        let passing = match (was, verdict) {
            (Some(_), _) | (_, Verdict::Hit) => Passing::NotSeen,
            (None, Verdict::Miss | Verdict::Undecided) => self.passing(a, b, meter)?,
        };
        self.settle(was, passing, verdict, [&a.end, &b.end], meter)
    }

    /// What becomes of an overlap, given what is proved at the end and on the way there.
    pub(super) fn settle(
        &self,
        was: Option<Hold>,
        passing: Passing,
        verdict: Verdict,
        ends: [&Side<'_>; 2],
        meter: &mut Meter<'_>,
    ) -> Result<Outcome, QuestionError> {
        let is_on = was.is_some() || passing == Passing::Seen;
        let hold = match verdict {
            Verdict::Hit => Some(Hold::Proved),
            Verdict::Undecided if is_on => Some(Hold::Kept),
            Verdict::Miss if is_on && !self.are_far(ends, meter)? => Some(Hold::Kept),
            Verdict::Undecided | Verdict::Miss => None,
        };
        Ok(Outcome::of(was, passing, hold))
    }

    /// Whether the ways of two that are apart at the start are proved to have met.
    fn passing(&self, a: &Body<'_>, b: &Body<'_>, meter: &mut Meter<'_>) -> Result<Passing, QuestionError> {
        let (a, b) = (&a.way, &b.way);
        if a.stands() && b.stands() || !a.way.intersects(b.way) || a.entry(b).is_none() {
            return Ok(Passing::NotSeen);
        }
        meter.look()?;
        let motion = Motion {
            displacement_a: a.displacement,
            displacement_b: b.displacement,
            rotation_a: a.rotation,
            rotation_b: b.rotation,
            initial: InitialTouch::Counts,
        };
        let touch = narrow::impact(a.side.placed, b.side.placed, &motion, &self.accuracy, &mut meter.work);
        let is_seen = touch.is_some_and(|touch| touch.certificate.verdict == Verdict::Hit);
        Ok(if is_seen { Passing::Seen } else { Passing::NotSeen })
    }

    /// Whether two that are apart are proved to be farther apart than the hysteresis.
    fn are_far(&self, [a, b]: [&Side<'_>; 2], meter: &mut Meter<'_>) -> Result<bool, QuestionError> {
        let limit = self.hysteresis;
        if limit <= 0.0 || distance_at_least(a.bounds, b.bounds) > limit {
            return Ok(true);
        }
        meter.look()?;
        Ok(narrow::distance(a.placed, b.placed, limit, &self.accuracy, &mut meter.work).is_none())
    }
}
