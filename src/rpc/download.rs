//! `DownloadGeometry`: a registered geometry as a header and chunks, which `UploadGeometry` takes back.

use std::sync::Arc;

use collision::shape::Geometry;
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Request, Response, Status};
use wire::v1::{self as pb, geometry_piece::Piece};

use super::{
    Answers, Caller, Server,
    answers::{Handed, Unread, hand},
    fitting,
};
use crate::{
    convert::lists::{Lists, header_out},
    token::Role,
};

/// Numbers of a chunk: 1 MiB.
const NUMBERS: usize = 1 << 18;
/// Messages that wait for a reader.
const UNREAD_MESSAGES: usize = 2;

/// Sends a geometry back.
///
/// # Errors
/// There is no such geometry.
pub(super) fn answer(
    server: &Server,
    request: Request<pb::DownloadGeometryRequest>,
) -> Result<Response<Answers<pb::DownloadGeometryResponse>>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Reader)?;
    let geometry = session.geometries.get(&sent.geometry_id)?;
    let lists = Lists::of(&geometry);
    let header = fitting(header_out(&geometry, lists), "download the parts of the compound by their own ids")?;
    let (parts, unread) = mpsc::channel(UNREAD_MESSAGES);
    tokio::spawn(async move {
        if !is_taken(&parts, Piece::Header(header)).await {
            return;
        }
        for chunk in chunks(&geometry, lists) {
            if !is_taken(&parts, Piece::Chunk(chunk)).await {
                return;
            }
        }
    });
    Ok(Response::new(Box::pin(ReceiverStream::new(unread))))
}

/// Whether the reader has room for a piece before its time is over, and is there at all.
async fn is_taken(parts: &Unread<pb::DownloadGeometryResponse>, piece: Piece) -> bool {
    let piece = pb::DownloadGeometryResponse { piece: Some(pb::GeometryPiece { piece: Some(piece) }) };
    hand(parts, piece).await == Handed::Over
}

/// The numbers, piece by piece: first all values, then all indices.
fn chunks(geometry: &Arc<Geometry>, lists: Lists) -> impl Iterator<Item = pb::GeometryChunk> {
    let steps = |count: usize| (0..count).step_by(NUMBERS).map(move |begin| begin..count.min(begin + NUMBERS));
    let values = steps(lists.value_count).map({
        let geometry = geometry.clone();
        move |range| pb::GeometryChunk { values: lists.values(&geometry, range), indices: Vec::new() }
    });
    let geometry = geometry.clone();
    let indices = steps(lists.index_count)
        .map(move |range| pb::GeometryChunk { values: Vec::new(), indices: lists.indices(&geometry, range) });
    values.chain(indices)
}
