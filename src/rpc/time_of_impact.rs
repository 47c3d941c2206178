//! `TimeOfImpact`: what a moving subject touches first.

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
pub(super) fn answer(sent: &pb::TimeOfImpactRequest, scene: &Scene) -> Checked<pb::TimeOfImpactResponse> {
    let question = asked::time_of_impact(sent, &scene.session.geometries, &scene.snapshot)?;
    let terms = scene.shared.overridden_by(sent.options.as_deref())?;
    let (hits, account) =
        scene.ask(&terms, |meter| scene.snapshot.time_of_impact(&question, &terms.filter, &terms.accuracy, meter))?;
    Ok(pb::TimeOfImpactResponse { info: scene.info(&terms, account), ..found::time_of_impact(&hits)? })
}
