//! Questions that were kept with all that their answers depend on, asked again without a server.

use wire::v1::{self as pb, answer::Answer as Kind};

use crate::rpc;

/// Why what was kept cannot be asked again.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// It was written by a later program.
    #[error("it has layout {found}, and calipers {} reads layout {known}: ask it with calipers {program}", env!("CARGO_PKG_VERSION"))]
    Layout {
        /// Its layout.
        found: u32,
        /// That of this program.
        known: u32,
        /// The program that wrote it.
        program: String,
    },
    /// It is damaged, or no replay.
    #[error("it is no whole replay: {0}")]
    Damaged(String),
}

/// Asks the question of a replay again, of the shapes beside it; whatever else its world held had no part in the answer. The
/// answer, or why there is none, tells what was done, pair by pair.
///
/// # Errors
/// The replay is damaged, or of a layout that this program does not know.
pub fn ask_again(replay: &pb::Replay) -> Result<pb::Answer, ReplayError> {
    if replay.format == 0 {
        return Err(ReplayError::Damaged("format is 0".to_owned()));
    }
    if replay.format > rpc::REPLAY_FORMAT {
        return Err(ReplayError::Layout {
            found: replay.format,
            known: rpc::REPLAY_FORMAT,
            program: replay.program.clone(),
        });
    }
    rpc::ask_again(replay).map_err(|problem| ReplayError::Damaged(problem.to_string()))
}

/// An answer without what it says of itself: what must be the same, byte for byte, whenever the question is asked again.
#[must_use]
pub fn bare(mut answer: pb::Answer) -> pb::Answer {
    match &mut answer.answer {
        Some(Kind::Raycast(it)) => it.info = None,
        Some(Kind::Overlap(it)) => it.info = None,
        Some(Kind::Penetration(it)) => it.info = None,
        Some(Kind::TimeOfImpact(it)) => it.info = None,
        Some(Kind::Distance(it)) => it.info = None,
        Some(Kind::MoveCharacter(it)) => it.info = None,
        Some(Kind::FirstTouch(it)) => it.info = None,
        Some(Kind::Depenetrate(it)) => it.info = None,
        Some(Kind::Resolve(it)) => it.info = None,
        Some(Kind::Pairs(it)) => it.info = None,
        Some(Kind::Problem(_)) | None => {}
    }
    answer
}

/// What an answer says of itself.
#[must_use]
pub fn info_of(answer: &pb::Answer) -> Option<&pb::AnswerInfo> {
    match answer.answer.as_ref()? {
        Kind::Raycast(it) => it.info.as_ref(),
        Kind::Overlap(it) => it.info.as_ref(),
        Kind::Penetration(it) => it.info.as_ref(),
        Kind::TimeOfImpact(it) => it.info.as_ref(),
        Kind::Distance(it) => it.info.as_ref(),
        Kind::MoveCharacter(it) => it.info.as_ref(),
        Kind::FirstTouch(it) => it.info.as_ref(),
        Kind::Depenetrate(it) => it.info.as_ref(),
        Kind::Resolve(it) => it.info.as_ref(),
        Kind::Pairs(it) => it.info.as_ref(),
        Kind::Problem(_) => None,
    }
}
