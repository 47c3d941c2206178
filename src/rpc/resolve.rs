//! `Resolve`: how bodies in contact would bounce and be pushed apart.

use collision::world::Found;
use wire::v1 as pb;

use super::scene::Scene;
use crate::{convert::resolve, problem::Checked};

/// Answers it on the scene's version.
///
/// # Errors
/// What is wrong with the question, the deadline.
pub(super) fn answer(sent: &pb::ResolveRequest, scene: &Scene) -> Checked<pb::ResolveResponse> {
    let question = resolve::resolve(sent, &scene.snapshot)?;
    let terms = scene.shared.overridden_by(sent.options.as_deref())?;
    let (resolved, account) = scene.ask(&terms, |meter| {
        let resolved = scene.snapshot.resolve(&question, &terms.filter, &terms.accuracy, meter)?;
        Ok(Found { verdict: resolved.verdict, hits: vec![resolved], truncated: false })
    })?;
    Ok(pb::ResolveResponse { info: scene.info(&terms, account), ..resolve::resolved(&resolved.hits[0])? })
}
