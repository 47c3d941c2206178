//! `Raycast`: what a ray hits.

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
pub(super) fn answer(sent: &pb::RaycastRequest, scene: &Scene) -> Checked<pb::RaycastResponse> {
    let question = asked::raycast(sent)?;
    let terms = scene.shared.overridden_by(sent.options.as_deref())?;
    let against = asked::against(sent.against.as_deref(), &scene.session.geometries)?;
    let (hits, account) = scene.ask(&terms, |meter| match &against {
        None => scene.snapshot.raycast(&question, &terms.filter, &terms.accuracy, meter),
        Some(against) => scene.snapshot.raycast_against(&question, against, &terms.accuracy, meter),
    })?;
    Ok(pb::RaycastResponse { info: scene.info(&terms, account), ..found::raycast(&hits)? })
}
