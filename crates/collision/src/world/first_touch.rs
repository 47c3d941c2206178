//! When, in the past that is held, did two shapes touch first?
//!
//! # Method
//! Tick by tick: between a tick and the next each shape goes as a question between them sees it, and the first touch of two that
//! move so is a time of impact. What is inserted, replaced, teleported or removed by the next tick stands where it was until
//! then; what came with it is first seen there. The last tick is asked as it is. It ends at the first tick with a certain touch.
//!
//! Against the world the path of the subject asks the trees of the span of ticks, whose boxes hold all that happens in it.
//!
//! # Limits
//! Two that touch only while a third tick would be between (poses within a tick that were overwritten in it) are not seen: nobody
//! saw those.

use std::sync::Arc;

use super::{
    Filter, Found, HitMode, Impact, Meter, Moment, QuestionError, ShapeId, Snapshot, Subject, Tick,
    filter::Sieve,
    hits::{Gathered, raise},
    notes::Note,
    search::Side,
    sweeps::Moving,
};
use crate::{
    accuracy::Accuracy,
    answer::Verdict,
    broad::Line,
    narrow::{self, InitialTouch, Motion},
    shape::Form,
};

/// Hits that are told: what may come first, and the certain one.
const HITS_MAX: usize = 256;

/// When did two touch first?
#[derive(Clone, Debug)]
pub struct FirstTouch {
    /// What is asked about: a shape as it went, or where a pose says, a form where it stands.
    pub subject: Subject,
    /// Only against this; `None` is the whole world as it went.
    pub against: Option<Subject>,
    /// The first tick that is looked at.
    pub from: Tick,
    /// The last one, not before the first.
    pub to: Tick,
}

/// A touch in the past.
#[derive(Clone, Debug)]
pub struct PastTouch {
    /// The tick at or after which it was.
    pub tick: Tick,
    /// When and where: the fraction, from 0 to below 1, is that of the way to the next tick.
    pub impact: Impact,
}

impl Snapshot {
    /// When the subject first touched what it is asked against, sensors included: the first certain touch, after those undecided
    /// ones that may have been before it.
    ///
    /// # Errors
    /// [`QuestionError::History`] of the last tick, then of the first; a shape that is at none of the ticks,
    /// [`QuestionError::Interrupted`].
    pub fn first_touch(
        self: &Arc<Self>,
        question: &FirstTouch,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Found<PastTouch>, QuestionError> {
        // Both ends are checked before any work is done.
        for end in [question.to, question.from] {
            self.at(Moment::Tick(end))?;
        }
        let mut seen = Presence::default();
        let mut found = Found { verdict: Verdict::Miss, hits: Vec::new(), truncated: false };
        for tick in (question.from.get()..=question.to.get()).filter_map(Tick::new) {
            let world = match tick == question.to {
                true => self.at(Moment::Tick(tick))?,
                // Any fraction tells how all go on from here.
                false => self.at(Moment::Between(tick, 0.5))?,
            };
            let _asking = world.asking().now();
            let touches = question.in_tick(&world, &mut seen, filter, accuracy, meter)?;
            let is_certain = touches.verdict == Verdict::Hit;
            let touches = touches.hits.into_iter().map(|impact| PastTouch { tick, impact });
            found.hits.extend(touches);
            if is_certain {
                found.verdict = Verdict::Hit;
                break;
            }
        }
        if found.verdict == Verdict::Miss {
            seen.check(question)?;
            found.verdict = if found.hits.is_empty() { Verdict::Miss } else { Verdict::Undecided };
        }
        cut(&mut found);
        Ok(found)
    }

    /// A shape as it goes on from the tick that this moment is at or after; it stands if the moment is a tick.
    fn on_its_way(&self, id: ShapeId) -> Option<Moving<'_>> {
        let (side, end) = self.way(id)?;
        Some(match end {
            Some(end) => Moving::travelling(side, &end, id),
            None => Moving::standing(side, id),
        })
    }
}

/// Leaves out those that are too many, of the undecided ones the last.
fn cut(found: &mut Found<PastTouch>) {
    if found.hits.len() > HITS_MAX {
        let last = found.hits.split_off(found.hits.len() - 1);
        found.hits.truncate(HITS_MAX - 1);
        found.hits.extend(last);
        found.truncated = true;
    }
}

/// Which sides of the question were there at some tick.
#[derive(Debug, Default)]
struct Presence {
    subject: bool,
    against: bool,
}

impl Presence {
    fn check(&self, question: &FirstTouch) -> Result<(), QuestionError> {
        match (&question.subject, &question.against) {
            (Subject::Shape { id, .. }, _) if !self.subject => Err(QuestionError::SubjectNotFound(*id)),
            (_, Some(Subject::Shape { id, .. })) if !self.against => Err(QuestionError::AgainstNotFound(*id)),
            _ => Ok(()),
        }
    }
}

/// A side of the question from a tick to the next; `None` if it is not there.
fn side<'a>(world: &'a Snapshot, subject: &'a Subject) -> Option<Moving<'a>> {
    match subject {
        Subject::Shape { id, pose: None } => world.on_its_way(*id),
        Subject::Shape { id, pose: Some(pose) } => {
            let shape = world.find(*id)?;
            Some(Moving::standing(Side::at(shape.placed.geometry, *pose, shape.shape), *id))
        }
        // Of two of which one stands, no id says which comes first.
        Subject::Geometry { geometry, pose } => Some(Moving::standing(Side::at(geometry, *pose, None), ShapeId::MIN)),
    }
}

impl FirstTouch {
    /// The first touches from a tick to the next.
    fn in_tick(
        &self,
        world: &Snapshot,
        seen: &mut Presence,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Found<Impact>, QuestionError> {
        let mut gathered = Gathered::new(HitMode::Closest);
        meter.spend()?;
        let against = self.against.as_ref().map(|against| side(world, against));
        seen.against |= matches!(against, Some(Some(_)));
        let Some(subject) = side(world, &self.subject) else { return Ok(gathered.finish()) };
        seen.subject = true;
        if let Form::HalfSpace(_) = subject.side.placed.geometry.form() {
            return Err(QuestionError::SubjectUnbounded(subject.side.id()));
        }
        match against {
            Some(None) => {}
            Some(Some(other)) => {
                if let Some(least) = subject.entry(&other) {
                    meter.look()?;
                    gathered.take(touch(&subject, &other, least, accuracy, meter));
                }
            }
            None => self.in_the_world(world, &subject, &mut gathered, filter, accuracy, meter)?,
        }
        Ok(gathered.finish())
    }

    fn in_the_world(
        &self,
        world: &Snapshot,
        subject: &Moving<'_>,
        gathered: &mut Gathered<Impact>,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<(), QuestionError> {
        let sieve = Sieve::new(filter, subject.side.shape);
        let line = Line::new(&subject.path());
        world.along(&line, 1.0, sieve.layers_seen(), meter, |meter, at_some_time| {
            // The box of the whole span was met; where the shape is in this tick says its way.
            if sieve.passes(&at_some_time)
                && let Some(other) = at_some_time.id().and_then(|id| world.on_its_way(id))
                && let Some(least) = subject.entry(&other).filter(|&least| least <= gathered.limit())
            {
                meter.look()?;
                gathered.take(touch(subject, &other, least, accuracy, meter));
            }
            Ok(gathered.limit())
        })
    }
}

/// The first touch of two from a tick to the next; none at its end, which is the beginning of the next.
fn touch(
    subject: &Moving<'_>,
    other: &Moving<'_>,
    least: f64,
    accuracy: &Accuracy,
    meter: &mut Meter<'_>,
) -> Option<Impact> {
    let motion = Motion {
        displacement_a: subject.displacement,
        displacement_b: other.displacement,
        rotation_a: subject.rotation,
        rotation_b: other.rotation,
        initial: InitialTouch::Counts,
    };
    let (a, b) = (subject.side.placed, other.side.placed);
    let found = narrow::impact(a, b, &motion, accuracy, &mut meter.work);
    meter.note(|| {
        let certificate = found.map(|touch| touch.certificate);
        Note::of_motion((&subject.side, &other.side), (&motion, 1.0), certificate, accuracy)
    });
    let mut touch = found?;
    raise(&mut touch.fraction, &mut touch.certificate, least);
    if touch.certificate.bound.lower >= 1.0 {
        return None;
    }
    touch.fraction = touch.fraction.min(1.0_f64.next_down());
    Some(Impact { id: other.side.id(), user_data: other.side.user_data(), pierced: false, touch })
}
