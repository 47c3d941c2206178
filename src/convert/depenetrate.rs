//! Ways out: what is asked, and where they lead.

use collision::world::{Depenetrate, Depenetrated, ShapeId};
use wire::v1 as pb;

use super::{
    answer::{all_out, contact, interval, verdict},
    number::{FROM_ZERO_TO_REACH, REACH, count, within},
    place::vec3_out,
    question::{against, subject},
};
use crate::{geometries::Geometries, problem::Checked};

/// The question of a way out.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn depenetrate(sent: &pb::DepenetrateRequest, known: &Geometries) -> Checked<Depenetrate> {
    let length = |field, length| within(field, length, 0.0..=REACH, FROM_ZERO_TO_REACH);
    Ok(Depenetrate {
        subject: subject(sent.subject.as_ref(), known)?,
        against: against(sent.against.as_deref(), known)?,
        gap: length("gap", sent.gap)?,
        max_distance: length("max_distance", sent.max_distance.unwrap_or(REACH))?,
        max_passes: count("passes", sent.passes, 8, 64)?,
    })
}

/// The answer; who sends it adds what was read.
///
/// # Errors
/// A number is not finite, which is a fault of the server.
pub(crate) fn depenetrated(out: &Depenetrated) -> Checked<pb::DepenetrateResponse> {
    Ok(pb::DepenetrateResponse {
        verdict: verdict(out.verdict).into(),
        position: Some(vec3_out(out.position)?),
        translation: Some(vec3_out(out.translation)?),
        depth: Some(interval(out.depth)?),
        ids: out.moved_out_of.iter().copied().map(ShapeId::get).collect(),
        contacts: all_out(&out.contacts, contact)?,
        // At most 64.
        passes: out.passes as u32,
        info: None,
    })
}
