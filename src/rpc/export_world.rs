//! `ExportWorld`: one tick of a world, complete in itself, in pieces that `ImportWorld` takes.
//!
//! # Method
//! A version never changes, so it is read while others edit on. The pieces are made one by one, as the reader takes them. Each
//! carries a hash of all before it and of itself, so that the importer notices what is lost, damaged or out of order.

use std::{sync::Arc, vec::IntoIter};

use collision::{
    shape::Geometry,
    world::{ShapeId, Snapshot},
};
use prost::Message;
use tonic::{Request, Response, Status};
use wire::v1::{self as pb, world_piece::Piece};

use super::{
    Answers, Caller, MESSAGE_BYTES, Server,
    answers::{Handed, Unread, hand, stream},
};
use crate::{
    compute::{self, Weight},
    convert::{
        archive::{self, named_by_id},
        number::timestamp,
        question::read_at,
        settings::settings_out,
        shape::shape_out,
    },
    problem::{Checked, Problem, Reason, Under},
    session::ReadAt,
    token::Role,
};

/// Shapes of a piece: about 200 bytes each.
pub(super) const SHAPES_OF_A_PIECE: usize = 1000;
/// Pieces that wait for a reader.
const UNREAD_PIECES: usize = 2;

/// Begins to send a world.
///
/// # Errors
/// Who may not read the session; a tick that is not held; a moment between two.
pub(super) async fn open(
    server: &Server,
    request: Request<pb::ExportWorldRequest>,
) -> Result<Response<Answers<pb::ExportWorldResponse>>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Reader)?;
    let read_at = read_at(sent.read_at.as_ref()).under("read_at")?;
    let snapshot = session.pin(read_at, caller.deadline).await?;
    if snapshot.fraction() > 0.0 {
        let field = if matches!(read_at, ReadAt::Time(_)) { "read_at.time" } else { "read_at.tick_fraction" };
        let what = "is between two ticks, and an export is of one: name a tick alone, such as {\"tick\": 7}";
        return Err(Problem::at(field, Reason::OutOfLimits, what).into());
    }
    let pieces = compute::run(Weight::Heavy, "exporting a world", move || Ok(Pieces::of(snapshot))).await?;
    let lease = session.clone();
    let answers = stream(UNREAD_PIECES, |answers| async move {
        let _lease = lease.lease.hold();
        Ok(send(pieces, &answers).await?)
    });
    Ok(Response::new(answers))
}

/// Sends piece after piece, as long as somebody takes them.
async fn send(mut pieces: Pieces, answers: &Unread<pb::ExportWorldResponse>) -> Checked<()> {
    loop {
        let (made, rest) = compute::run(Weight::Heavy, "exporting a world", move || {
            let piece = pieces.next()?;
            Ok((piece, pieces))
        })
        .await?;
        pieces = rest;
        let Some(piece) = made else { return Ok(()) };
        match hand(answers, pb::ExportWorldResponse { piece: Some(piece) }).await {
            Handed::Over => {}
            Handed::Gone => return Ok(()),
            Handed::TooSlow => {
                let what = "the client took no piece for 10 s: export again, and read on";
                return Err(Problem::new(Reason::Overloaded, what));
            }
        }
    }
}

/// What is told of all pieces so far.
#[derive(Clone, Debug)]
pub(super) struct Chain(blake3::Hash);

impl Chain {
    /// Before the first piece.
    pub(super) fn new() -> Self {
        Self(blake3::hash(b"calipers world export 1"))
    }

    /// After one more; what that says of the chain itself does not count. Whoever wrote the bytes of a piece, its fields are the same.
    pub(super) fn after(&self, piece: &pb::WorldPiece) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.0.as_bytes());
        hasher.update(&pb::WorldPiece { piece: piece.piece.clone(), chain: String::new() }.encode_to_vec());
        Self(hasher.finalize())
    }

    /// As it is sent.
    pub(super) fn text(&self) -> String {
        hex(*self.0.as_bytes())
    }
}

/// A hash as it is sent.
pub(super) fn hex(hash: [u8; 32]) -> String {
    blake3::Hash::from_bytes(hash).to_hex().to_string()
}

/// The pieces of a version that are still to be sent.
struct Pieces {
    snapshot: Arc<Snapshot>,
    chain: Chain,
    header: Option<pb::WorldHeader>,
    geometries: IntoIter<Arc<Geometry>>,
    /// Those of the geometry that is being sent.
    of_geometry: Box<dyn Iterator<Item = pb::GeometryPiece> + Send>,
    stage: Stage,
}

/// How far the shapes are.
enum Stage {
    /// After this one.
    Shapes(Option<ShapeId>),
    End,
    Done,
}

impl Pieces {
    fn of(snapshot: Arc<Snapshot>) -> Self {
        let mut geometries = Vec::new();
        let mut after = None;
        loop {
            let page = snapshot.shapes_after(after, SHAPES_OF_A_PIECE, None);
            let Some(last) = page.last() else { break };
            after = Some(last.id);
            geometries.extend(page.iter().map(|shape| shape.geometry.clone()));
        }
        let geometries = named_by_id(&geometries);
        let header = pb::WorldHeader {
            tick: snapshot.tick().get(),
            time: Some(timestamp(snapshot.time())),
            settings: Some(settings_out(snapshot.settings())),
            geometry_count: geometries.len() as u64,
            shape_count: snapshot.len() as u64,
        };
        Self {
            snapshot,
            chain: Chain::new(),
            header: Some(header),
            geometries: geometries.into_iter(),
            of_geometry: Box::new(std::iter::empty()),
            stage: Stage::Shapes(None),
        }
    }

    /// The next piece; `None` after the last.
    ///
    /// # Errors
    /// It does not fit into a message: a compound of very many parts.
    fn next(&mut self) -> Checked<Option<pb::WorldPiece>> {
        let Some(piece) = self.next_kind() else { return Ok(None) };
        let piece = pb::WorldPiece { piece: Some(piece), chain: String::new() };
        self.chain = self.chain.after(&piece);
        let piece = pb::WorldPiece { chain: self.chain.text(), ..piece };
        let bytes = piece.encoded_len();
        if bytes > MESSAGE_BYTES {
            let what = format!(
                "a compound of this world has so many parts that it would need {bytes} bytes, and a message may have \
                 {MESSAGE_BYTES}: make several compounds of it"
            );
            let problem = Problem::new(Reason::QuotaExceeded, what);
            return Err(problem.with("quota", "message_bytes").with("limit", MESSAGE_BYTES));
        }
        Ok(Some(piece))
    }

    fn next_kind(&mut self) -> Option<Piece> {
        if let Some(header) = self.header.take() {
            return Some(Piece::Header(header));
        }
        if let Some(piece) = self.of_geometry.next() {
            return Some(Piece::Geometry(piece));
        }
        if let Some(geometry) = self.geometries.next() {
            self.of_geometry = Box::new(archive::pieces(&geometry));
            // The first is its header, so there is one.
            return self.of_geometry.next().map(Piece::Geometry);
        }
        if let Stage::Shapes(after) = self.stage {
            let page = self.snapshot.shapes_after(after, SHAPES_OF_A_PIECE, None);
            if let Some(last) = page.last() {
                self.stage = Stage::Shapes(Some(last.id));
                return Some(Piece::Shapes(pb::ShapeList { shapes: page.into_iter().map(shape_out).collect() }));
            }
            self.stage = Stage::End;
        }
        match std::mem::replace(&mut self.stage, Stage::Done) {
            Stage::End => Some(Piece::End(pb::WorldEnd { content_hash: hex(self.snapshot.content_hash()) })),
            Stage::Shapes(_) | Stage::Done => None,
        }
    }
}
