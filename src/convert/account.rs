//! What a question did, pair by pair, as it is sent to those who ask for it.

use collision::world::Note;
use wire::v1 as pb;

use super::answer::{certificate, id_or_none, verdict, work};
use crate::problem::Checked;

/// What was done with a pair, by the question or by this item of a batch.
///
/// # Errors
/// A number is not finite, which is a fault of the server.
pub(crate) fn pair(note: &Note, item: u32) -> Checked<pb::PairAccount> {
    let certificate = match &note.certificate {
        Some(found) => certificate(found)?,
        None => pb::Certificate {
            verdict: verdict(note.verdict).into(),
            iterations: u32::try_from(note.work.iterations).unwrap_or(u32::MAX),
            ..pb::Certificate::default()
        },
    };
    Ok(pb::PairAccount {
        subject_id: id_or_none(note.subject),
        id: id_or_none(note.id),
        certificate: Some(certificate),
        work: Some(work(&note.work)),
        item,
    })
}
