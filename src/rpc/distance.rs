//! `Distance`: what is nearest to a subject.

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
pub(super) fn answer(sent: &pb::DistanceRequest, scene: &Scene) -> Checked<pb::DistanceResponse> {
    let question = asked::distance(sent, &scene.session.geometries)?;
    let terms = scene.shared.overridden_by(sent.options.as_deref())?;
    let (hits, account) =
        scene.ask(&terms, |meter| scene.snapshot.distance(&question, &terms.filter, &terms.accuracy, meter))?;
    Ok(pb::DistanceResponse { info: scene.info(&terms, account), ..found::distance(&hits)? })
}
