//! `FirstTouch`: when, in the past that is held, the subject touched something first.

use wire::v1 as pb;

use super::scene::Scene;
use crate::{convert::first_touch, problem::Checked};

/// Answers it on the history of the scene's version.
///
/// # Errors
/// What is wrong with the question, the deadline.
pub(super) fn answer(sent: &pb::FirstTouchRequest, scene: &Scene) -> Checked<pb::FirstTouchResponse> {
    let question = first_touch::first_touch(sent, &scene.session.geometries, &scene.snapshot)?;
    let terms = scene.shared.overridden_by(sent.options.as_deref())?;
    let (found, account) =
        scene.ask(&terms, |meter| scene.snapshot.first_touch(&question, &terms.filter, &terms.accuracy, meter))?;
    Ok(pb::FirstTouchResponse { info: scene.info(&terms, account), ..first_touch::touched(&found)? })
}
