//! What does a moving subject touch first, and when?

use glam::DVec3;

use super::{
    Filter, Found, HitMode, Meter, QuestionError, ShapeId, Snapshot, Subject,
    filter::Sieve,
    hits::{Gathered, Hit, raise},
    notes::Note,
    search::{Side, outward},
};
use crate::{
    accuracy::Accuracy,
    answer::Certificate,
    broad::{Line, Path},
    math::{Aabb, Norm},
    narrow::{self, ImpactTouch, InitialTouch, Motion},
    tolerance,
};

/// What does the subject touch first when it goes by `displacement` and turns by `rotation`?
#[derive(Clone, Debug)]
pub struct TimeOfImpact {
    /// What moves.
    pub subject: Subject,
    /// Where to, from its pose, metres.
    pub displacement: DVec3,
    /// How it turns about its local origin meanwhile: the axis times the angle, radians, world axes.
    pub rotation: DVec3,
    /// Only against this; `None` is the whole world, standing still.
    pub against: Option<Subject>,
    /// How `against` moves in the same time, metres.
    pub against_displacement: DVec3,
    /// How `against` turns in the same time.
    pub against_rotation: DVec3,
    /// What becomes of what is touched at the start.
    pub initial: InitialTouch,
    /// Which hits to return.
    pub mode: HitMode,
}

/// The first touch of the subject and a shape.
#[derive(Clone, Debug)]
pub struct Impact {
    /// The shape; `None` if it is a geometry given in `against`.
    pub id: Option<ShapeId>,
    /// The shape's.
    pub user_data: u64,
    /// It blocks nothing: see [`HitMode::Pierce`].
    pub pierced: bool,
    /// When and where; `b` is the shape.
    pub touch: ImpactTouch,
}

impl Hit for Impact {
    fn value(&self) -> f64 {
        self.touch.fraction
    }

    fn id(&self) -> Option<ShapeId> {
        self.id
    }

    fn certificate(&self) -> &Certificate {
        &self.touch.certificate
    }

    fn certificate_mut(&mut self) -> &mut Certificate {
        &mut self.touch.certificate
    }

    fn is_pierced(&self) -> bool {
        self.pierced
    }
}

/// The way of a box that moves by `displacement` past boxes that move by `against_displacement`, as seen by them.
pub(super) fn sweep(bounds: Aabb, displacement: DVec3, against_displacement: DVec3) -> Path {
    let origin = bounds.center();
    // The difference of two displacements is rounded; so is the half extent.
    let rounding = (displacement.abs() + against_displacement.abs()) * tolerance::SLAB_SLACK;
    Path {
        origin,
        direction: displacement - against_displacement,
        reach: (bounds.max - origin).max(origin - bounds.min) + rounding,
    }
}

/// A box that holds a form all the time while it turns where it is: that of the ball about its local origin, less what is
/// farther from its box at the start than turning takes its points.
pub(super) fn turning_bounds(side: &Side<'_>, rotation: DVec3) -> Aabb {
    if rotation == DVec3::ZERO {
        return side.bounds;
    }
    let (reach, place) = (side.placed.geometry.reach(), side.placed.pose.position);
    let ball = outward(Aabb::new(place, place), reach);
    let near = outward(side.bounds, reach * rotation.norm() * tolerance::LENGTH_WIDENING);
    Aabb::new(ball.min.max(near.min), ball.max.min(near.max))
}

impl TimeOfImpact {
    /// A fraction before which the boxes of what it is asked against prove that it is not touched; `None` if it never is.
    fn least(&self, subject: &Side<'_>, against: &Side<'_>) -> Option<f64> {
        let (displacement_b, rotation_b) = self.motion_of_others();
        let path = sweep(turning_bounds(subject, self.rotation), self.displacement, displacement_b);
        path.entry(&turning_bounds(against, rotation_b), 1.0)
    }

    /// The first touch of a pair, which is not before the fraction `least`, and of which nothing is told that is surely after `limit`.
    fn ask(
        &self,
        (subject, other): (&Side<'_>, &Side<'_>),
        [least, limit]: [f64; 2],
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Option<Impact> {
        let motion = self.motion();
        let found = narrow::impact_of(subject.placed, other.operand(), &motion, limit, accuracy, &mut meter.work);
        meter.note(|| {
            let certificate = found.map(|touch| touch.certificate);
            Note::of_motion((subject, other), (&motion, limit), certificate, accuracy)
        });
        let mut touch = found?;
        raise(&mut touch.fraction, &mut touch.certificate, least);
        let pierced = self.mode.pierces(other);
        Some(Impact { id: other.id(), user_data: other.user_data(), pierced, touch })
    }

    fn motion(&self) -> Motion {
        let (displacement_b, rotation_b) = self.motion_of_others();
        Motion {
            displacement_a: self.displacement,
            displacement_b,
            rotation_a: self.rotation,
            rotation_b,
            initial: self.initial,
        }
    }

    /// Sensors block nothing: they are seen only by what also tells what blocks nothing.
    fn sees(&self, other: &Side<'_>) -> bool {
        !other.is_sensor() || matches!(self.mode, HitMode::Pierce { .. })
    }

    /// How far what it is asked against goes, and how it turns; the world stands still.
    fn motion_of_others(&self) -> (DVec3, DVec3) {
        match self.against {
            Some(_) => (self.against_displacement, self.against_rotation),
            None => (DVec3::ZERO, DVec3::ZERO),
        }
    }
}

impl Snapshot {
    /// What the moving subject touches first. Sensors block nothing: they are passed over, unless `against` names one
    /// or the mode is [`HitMode::Pierce`].
    ///
    /// # Errors
    /// A shape that is not there, [`QuestionError::Interrupted`].
    pub fn time_of_impact(
        &self,
        question: &TimeOfImpact,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Found<Impact>, QuestionError> {
        let _asking = self.asking().now();
        let subject = self.subject(&question.subject)?;
        let mut gathered = Gathered::new(question.mode);
        if let Some(other) = self.against(question.against.as_ref())? {
            meter.look()?;
            let impact = match question.least(&subject, &other) {
                Some(least) => question.ask((&subject, &other), [least, 1.0], accuracy, meter),
                None => {
                    meter.note(|| Note::of_motion((&subject, &other), (&question.motion(), 1.0), None, accuracy));
                    None
                }
            };
            gathered.take(impact);
            return Ok(gathered.finish());
        }
        let bounds = turning_bounds(&subject, question.rotation);
        let path = sweep(bounds, question.displacement, DVec3::ZERO);
        let line = Line::new(&path);
        let sieve = Sieve::new(filter, subject.shape);
        self.along(&line, 1.0, sieve.layers_seen(), meter, |meter, other| {
            let limit = gathered.limit().min(1.0);
            if let Some(least) = line.entry(&other.bounds, limit).filter(|&least| least <= limit)
                && question.sees(&other)
                && sieve.passes(&other)
            {
                meter.look()?;
                gathered.take(question.ask((&subject, &other), [least, limit], accuracy, meter));
            }
            Ok(gathered.limit())
        })?;
        Ok(gathered.finish())
    }
}
