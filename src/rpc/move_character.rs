//! `MoveCharacter`: how far a character gets that slides along what it meets.

use collision::world::Found;
use wire::v1 as pb;

use super::scene::Scene;
use crate::{convert::character, problem::Checked};

/// Answers it on the scene's version.
///
/// # Errors
/// What is wrong with the question, the deadline.
pub(super) fn answer(sent: &pb::MoveCharacterRequest, scene: &Scene) -> Checked<pb::MoveCharacterResponse> {
    let question = character::move_character(sent, &scene.session.geometries)?;
    let terms = scene.shared.overridden_by(sent.options.as_deref())?;
    let (moved, account) = scene.ask(&terms, |meter| {
        let moved = scene.snapshot.move_character(&question, &terms.filter, &terms.accuracy, meter)?;
        Ok(Found { verdict: moved.verdict, hits: vec![moved], truncated: false })
    })?;
    let moved = character::moved_character(&moved.hits[0])?;
    Ok(pb::MoveCharacterResponse { info: scene.info(&terms, account), ..moved })
}
