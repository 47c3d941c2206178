//! How deep do shapes and the subject overlap, and where do they touch?

use std::cmp::Ordering;

use glam::DVec3;
use smallvec::SmallVec;

use super::{
    Filter, Found, Meter, QuestionError, ShapeId, Snapshot, Subject,
    hits::verdict,
    notes::Note,
    outline::Outline,
    search::{Side, outward},
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Feature, Verdict},
    narrow::{self, ContactPoint, NeedsDecomposition, PartsWanted},
};

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
    pub points: SmallVec<[ContactPoint; 4]>,
    /// The subject's piece.
    pub subject_feature: Feature,
    /// The shape's piece.
    pub feature: Feature,
    /// What the depth is worth; where convex parts of meshes were measured, the verdict is that of the meshes.
    pub certificate: Certificate,
}

impl Snapshot {
    /// How deep shapes and the subject overlap; deepest first, equal ones by id, then by piece.
    ///
    /// # Errors
    /// A shape that is not there, [`QuestionError::NeedsDecomposition`], [`QuestionError::PartsMissing`],
    /// [`QuestionError::Interrupted`].
    pub fn penetration(
        &self,
        question: &Penetration,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Found<Contact>, QuestionError> {
        let _asking = self.asking().now();
        let subject = self.subject(&question.subject)?;
        let outline = Outline::of_box(outward(subject.bounds, question.max_gap));
        let mut others: SmallVec<[Side<'_>; 32]> = SmallVec::new();
        self.others_near(&outline, (&subject, question.against.as_ref()), filter, meter, |_, other| {
            others.push(other);
            Ok(())
        })?;
        // So that the error of several is that of the lowest id.
        others.sort_unstable_by_key(Side::id);
        let mut hits = Vec::new();
        let mut missing = None;
        for other in &others {
            meter.look()?;
            let contacts =
                narrow::penetration(subject.placed, other.placed, question.max_gap, accuracy, &mut meter.work);
            meter.note(|| note(&subject, other, &contacts, accuracy));
            match contacts {
                Ok(contacts) => hits.extend(contacts.into_iter().map(|contact| of_shape(contact, other))),
                Err(NeedsDecomposition) => note_missing(&mut missing, &subject, other, accuracy)?,
            }
        }
        if let Some((with, wanted)) = missing {
            return Err(QuestionError::PartsMissing { with, wanted });
        }
        hits.sort_by(deepest_first);
        let truncated = hits.len() > question.max_contacts;
        hits.truncate(question.max_contacts);
        Ok(Found { verdict: verdict(hits.iter().map(|hit| &hit.certificate)), hits, truncated })
    }
}

/// What came of a pair: its deepest contact; of one that is refused, that nothing is decided.
fn note(
    subject: &Side<'_>,
    other: &Side<'_>,
    contacts: &Result<narrow::Contacts, NeedsDecomposition>,
    accuracy: &Accuracy,
) -> Note {
    match contacts {
        Ok(contacts) => {
            let deepest = contacts.iter().max_by(|a, b| a.depth.total_cmp(&b.depth));
            let Some(deepest) = deepest else {
                let mut apart = Note::of_gap(subject, other, None, accuracy);
                // A gap is a depth below 0.
                let certificate = apart.certificate.as_mut();
                certificate.into_iter().for_each(|it| it.bound = Bound::new(-it.bound.upper, -it.bound.lower));
                return apart;
            };
            Note::of([subject.id(), other.id()], Some(deepest.certificate))
        }
        Err(NeedsDecomposition) => Note { verdict: Verdict::Undecided, ..Note::of([subject.id(), other.id()], None) },
    }
}

/// The first of those it is missing with, and the parts of all.
type Missing = (Option<ShapeId>, Vec<PartsWanted>);

/// Notes what parts a pair lacks, so that those of all pairs can be made at once; an error if they cannot be made.
fn note_missing(
    missing: &mut Option<Missing>,
    subject: &Side<'_>,
    other: &Side<'_>,
    accuracy: &Accuracy,
) -> Result<(), QuestionError> {
    let found = narrow::parts_wanted([subject.placed.geometry, other.placed.geometry], accuracy);
    if found.is_empty() && missing.is_none() {
        return Err(QuestionError::NeedsDecomposition(other.id()));
    }
    let (_, wanted) = missing.get_or_insert_with(|| (other.id(), Vec::new()));
    for parts in found {
        if !wanted.contains(&parts) {
            wanted.push(parts);
        }
    }
    Ok(())
}

fn of_shape(contact: narrow::Contact, other: &Side<'_>) -> Contact {
    Contact {
        id: other.id(),
        user_data: other.user_data(),
        normal: contact.normal_b_to_a,
        depth: contact.depth,
        points: contact.points,
        subject_feature: contact.feature_a,
        feature: contact.feature_b,
        certificate: contact.certificate,
    }
}

fn deepest_first(a: &Contact, b: &Contact) -> Ordering {
    let piece = |feature: Feature| (feature.part, feature.face);
    b.depth
        .total_cmp(&a.depth)
        .then_with(|| a.id.cmp(&b.id))
        .then_with(|| piece(a.subject_feature).cmp(&piece(b.subject_feature)))
        .then_with(|| piece(a.feature).cmp(&piece(b.feature)))
}
