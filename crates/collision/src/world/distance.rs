//! Which shapes are nearest to the subject, and how near?

use super::{
    Filter, Found, Meter, QuestionError, ShapeId, Snapshot, Subject,
    filter::Sieve,
    hits::{Best, Hit, raise, verdict},
    notes::Note,
    search::Side,
};
use crate::{
    accuracy::Accuracy,
    answer::Certificate,
    broad::distance_at_least,
    narrow::{self, Separation},
};

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

/// A shape near the subject.
#[derive(Clone, Debug)]
pub struct Neighbor {
    /// The shape; `None` if it is a geometry given in `against`.
    pub id: Option<ShapeId>,
    /// The shape's.
    pub user_data: u64,
    /// How far and where; `a` is the subject, `b` the shape.
    pub separation: Separation,
}

impl Hit for Neighbor {
    fn value(&self) -> f64 {
        self.separation.distance
    }

    fn id(&self) -> Option<ShapeId> {
        self.id
    }

    fn certificate(&self) -> &Certificate {
        &self.separation.certificate
    }

    fn certificate_mut(&mut self) -> &mut Certificate {
        &mut self.separation.certificate
    }
}

impl Distance {
    /// `None` if it is proved to be beyond the farthest distance asked for.
    ///
    /// The kernel gets that distance as its limit and not the one that shrinks while nearer shapes are found: what it
    /// returns must not depend on the order in which shapes are offered.
    fn ask(
        &self,
        subject: &Side<'_>,
        other: &Side<'_>,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Option<Neighbor> {
        let least = distance_at_least(subject.bounds, other.bounds);
        if least > self.max_distance {
            meter.note(|| Note::of_gap(subject, other, None, accuracy));
            return None;
        }
        let limit = self.max_distance;
        let found = narrow::distance_of(subject.placed, other.operand(), limit, accuracy, &mut meter.work);
        let certificate = || found.as_ref().map(|found| found.certificate);
        meter.note(|| Note::of_gap(subject, other, certificate(), accuracy));
        let mut separation = found?;
        raise(&mut separation.distance, &mut separation.certificate, least);
        Some(Neighbor { id: other.id(), user_data: other.user_data(), separation })
    }
}

impl Snapshot {
    /// Which shapes are nearest to the subject, nearest first, equal ones by id. `truncated` is never set: that there are
    /// more shapes farther off is no surprise.
    ///
    /// # Errors
    /// A shape that is not there, [`QuestionError::Interrupted`].
    pub fn distance(
        &self,
        question: &Distance,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Found<Neighbor>, QuestionError> {
        let _asking = self.asking().now();
        let subject = self.subject(&question.subject)?;
        let mut best = Best::new(question.max_hits);
        if let Some(other) = self.against(question.against.as_ref())? {
            meter.look()?;
            question.ask(&subject, &other, accuracy, meter).into_iter().for_each(|neighbor| best.add(neighbor));
        } else {
            let sieve = Sieve::new(filter, subject.shape);
            self.near(subject.bounds, question.max_distance, sieve.layers_seen(), meter, |meter, other| {
                let least = distance_at_least(subject.bounds, other.bounds);
                if least <= best.limit() && sieve.passes(&other) {
                    meter.look()?;
                    question.ask(&subject, &other, accuracy, meter).into_iter().for_each(|neighbor| best.add(neighbor));
                }
                Ok(best.limit())
            })?;
        }
        let hits = best.into_sorted();
        Ok(Found { verdict: verdict(hits.iter().map(Hit::certificate)), hits, truncated: false })
    }
}
