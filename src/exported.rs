//! The world of an export, put together again without a server.

use collision::world::World;
use wire::v1 as pb;

use crate::rpc;

/// What came is no whole export.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct NotWhole(String);

/// The world that `ExportWorld` sent in these pieces.
///
/// # Errors
/// A piece is missing, damaged or out of place.
pub fn world(pieces: impl Iterator<Item = pb::WorldPiece>) -> Result<World, NotWhole> {
    rpc::read_export(pieces).map_err(|problem| NotWhole(problem.to_string()))
}
