//! `Depenetrate`: which way out of everything that it overlaps the subject has.

use collision::world::Found;
use wire::v1 as pb;

use super::scene::Scene;
use crate::{convert::depenetrate, problem::Checked};

/// Answers it on the scene's version.
///
/// # Errors
/// What is wrong with the question, the deadline.
pub(super) fn answer(sent: &pb::DepenetrateRequest, scene: &Scene) -> Checked<pb::DepenetrateResponse> {
    let question = depenetrate::depenetrate(sent, &scene.session.geometries)?;
    let terms = scene.shared.overridden_by(sent.options.as_deref())?;
    let (out, account) = scene.ask(&terms, |meter| {
        let out = scene.snapshot.depenetrate(&question, &terms.filter, &terms.accuracy, meter)?;
        Ok(Found { verdict: out.verdict, hits: vec![out], truncated: false })
    })?;
    let out = depenetrate::depenetrated(&out.hits[0])?;
    Ok(pb::DepenetrateResponse { info: scene.info(&terms, account), ..out })
}
