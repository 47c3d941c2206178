//! Which shapes touch the subject?

use super::{
    Filter, Found, Meter, QuestionError, ShapeId, Snapshot, Subject,
    hits::{Best, Hit, verdict},
    notes::Note,
    outline::Outline,
    search::Side,
};
use crate::{
    accuracy::Accuracy,
    answer::{Certificate, Verdict},
    narrow,
};

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

/// All are as good: they are in order of their ids.
impl Hit for OverlapHit {
    fn value(&self) -> f64 {
        0.0
    }

    fn id(&self) -> Option<ShapeId> {
        self.id
    }

    fn certificate(&self) -> &Certificate {
        &self.certificate
    }

    fn certificate_mut(&mut self) -> &mut Certificate {
        &mut self.certificate
    }
}

impl Snapshot {
    /// Which shapes touch the subject, or may do so, by id; if there are more than asked for, those of the lowest ids.
    ///
    /// # Errors
    /// A shape that is not there, [`QuestionError::Interrupted`].
    pub fn overlap(
        &self,
        question: &Overlap,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Found<OverlapHit>, QuestionError> {
        let _asking = self.asking().now();
        let subject = self.subject(&question.subject)?;
        // One more than asked for says that there are more. What has no place among them is not looked at.
        let mut lowest = Best::new(question.max_hits.saturating_add(1));
        let sides = (&subject, question.against.as_ref());
        self.others_near(&Outline::of(&subject), sides, filter, meter, |meter, other| {
            if lowest.has_place(0.0, other.id()) {
                touch(&subject, &other, accuracy, meter)?.into_iter().for_each(|hit| lowest.add(hit));
            }
            Ok(())
        })?;
        let mut hits = lowest.into_sorted();
        let truncated = hits.len() > question.max_hits;
        hits.truncate(question.max_hits);
        Ok(Found { verdict: verdict(hits.iter().map(|hit| &hit.certificate)), hits, truncated })
    }
}

/// `None` if it is proved that they do not touch.
fn touch(
    subject: &Side<'_>,
    other: &Side<'_>,
    accuracy: &Accuracy,
    meter: &mut Meter<'_>,
) -> Result<Option<OverlapHit>, QuestionError> {
    meter.look()?;
    let certificate = narrow::overlap_of(subject.placed, other.operand(), accuracy, &mut meter.work);
    meter.note(|| Note::of([subject.id(), other.id()], Some(certificate)));
    Ok((certificate.verdict != Verdict::Miss).then(|| OverlapHit {
        id: other.id(),
        user_data: other.user_data(),
        certificate,
    }))
}
