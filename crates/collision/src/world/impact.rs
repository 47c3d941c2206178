//! What does a moving subject touch first, and when?

use glam::DVec3;

use super::{
    Filter, Found, HitMode, Meter, QuestionError, ShapeId, Snapshot, Subject,
    filter::Sieve,
    hits::{Gathered, Hit, raise},
    search::Side,
};
use crate::{
    accuracy::Accuracy,
    answer::{Certificate, Verdict},
    broad::Path,
    math::Aabb,
    narrow::{self, ImpactTouch, InitialTouch, Motion},
    tolerance,
};

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
}

/// The way of a box that moves by `displacement` past boxes that move by `against_displacement`, as seen by them.
fn sweep(bounds: Aabb, displacement: DVec3, against_displacement: DVec3) -> Path {
    let origin = bounds.center();
    // The difference of two displacements is rounded; so is the half extent.
    let rounding = (displacement.abs() + against_displacement.abs()) * tolerance::SLAB_SLACK;
    Path {
        origin,
        direction: displacement - against_displacement,
        reach: (bounds.max - origin).max(origin - bounds.min) + rounding,
    }
}

impl TimeOfImpact {
    fn ask(&self, subject: &Side<'_>, other: &Side<'_>, accuracy: &Accuracy, meter: &mut Meter<'_>) -> Option<Impact> {
        let path = sweep(subject.bounds, self.displacement, self.displacement_of_others());
        let least = path.entry(&other.bounds, 1.0)?;
        let motion = Motion {
            displacement_a: self.displacement,
            displacement_b: self.displacement_of_others(),
            initial: self.initial,
        };
        let mut touch = narrow::linear_impact(subject.placed, other.placed, &motion, accuracy, &mut meter.work)?;
        raise(&mut touch.fraction, &mut touch.certificate, least);
        Some(Impact { id: other.id(), user_data: other.user_data(), touch })
    }

    /// The world stands still.
    fn displacement_of_others(&self) -> DVec3 {
        if self.against.is_some() { self.against_displacement } else { DVec3::ZERO }
    }
}

impl Snapshot {
    /// What the moving subject touches first. Sensors block nothing: they are passed over, unless `against` names one.
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
        let subject = self.subject(&question.subject)?;
        let mut gathered = Gathered::new(question.mode);
        if let Some(other) = self.against(question.against.as_ref())? {
            meter.look()?;
            gather(&mut gathered, question.ask(&subject, &other, accuracy, meter));
            return Ok(gathered.finish());
        }
        let path = sweep(subject.bounds, question.displacement, DVec3::ZERO);
        let sieve = Sieve::new(filter, subject.shape);
        self.along(&path, 1.0, meter, |meter, entry| {
            let limit = gathered.limit().min(1.0);
            let may_touch = path.entry(&entry.bounds, limit).is_some_and(|least| least <= limit);
            if may_touch && !entry.shape.sensor && sieve.passes(&entry.shape) {
                meter.look()?;
                gather(&mut gathered, question.ask(&subject, &Side::of(entry), accuracy, meter));
            }
            Ok(gathered.limit())
        })?;
        Ok(gathered.finish())
    }
}

fn gather(gathered: &mut Gathered<Impact>, impact: Option<Impact>) {
    match impact {
        Some(impact) if impact.touch.certificate.verdict == Verdict::Hit => gathered.add(Some(impact), None),
        impact => gathered.add(None, impact),
    }
}
