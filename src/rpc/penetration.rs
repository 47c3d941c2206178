//! `Penetration`: what overlaps a subject, and how deep.

use wire::v1 as pb;

use super::scene::Scene;
use crate::{
    convert::{answer as found, question as asked},
    problem::Checked,
};

/// Answers it on the scene's version.
///
/// # Errors
/// What is wrong with the question, the deadline.
pub(super) fn answer(sent: &pb::PenetrationRequest, scene: &Scene) -> Checked<pb::PenetrationResponse> {
    let question = asked::penetration(sent, &scene.session.geometries)?;
    let terms = scene.shared.overridden_by(sent.options.as_ref())?;
    let (hits, account) =
        scene.ask(&terms, |meter| scene.snapshot.penetration(&question, &terms.filter, &terms.accuracy, meter))?;
    Ok(pb::PenetrationResponse { info: scene.info(&terms, account), ..found::penetration(&hits)? })
}
