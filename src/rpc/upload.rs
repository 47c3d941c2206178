//! `UploadGeometry`: a geometry of more than one message, as a header and chunks.
//!
//! # Method
//! The header says how many numbers come, and the session's quota holds room for them from then on: a client that promises
//! more than fits is refused before it sends. The numbers are kept as they come and made a geometry when all are there, so
//! that the errors and the id are those of `CreateGeometry`.

use std::sync::Arc;

use tokio::time::timeout;
use tonic::{Request, Response, Status, Streaming};
use wire::v1::{self as pb, geometry::Kind, geometry_piece::Piece};

use super::{Caller, Server, WRITER_PATIENCE, geometry::register};
use crate::{
    compute::{self, Weight},
    convert::archive::{INDICES, VALUES, room, within},
    gate::the_api_says,
    problem::{Checked, Problem, Reason, Under},
    session::Session,
    token::Role,
};

/// Registers the geometry that a client sends in pieces.
///
/// # Errors
/// What is wrong with it; the memory quota; pieces are missing.
pub(super) async fn answer(
    server: &Server,
    request: Request<Streaming<pb::UploadGeometryRequest>>,
) -> Result<Response<pb::UploadGeometryResponse>, Status> {
    let caller = Caller::of(&request);
    let mut messages = request.into_inner();
    let Some(first) = next(server, None, &mut messages).await? else {
        return Err(no_header("no message came").into());
    };
    let session = server.enter(&caller, &first.session, Role::Writer)?;
    let _lease = session.lease.hold();
    let header = match first.piece.and_then(|piece| piece.piece) {
        Some(Piece::Header(header)) => header,
        Some(Piece::Chunk(_) | Piece::Exact(_)) => return Err(no_header("the first message has a chunk").into()),
        None => return Err(no_header("the first message has none").into()),
    };
    let mut upload = Upload::begin(header).under("piece.header")?;
    let _room = session.geometries.hold_room(upload.promised_bytes(), &session.newest())?;
    while let Some(message) = next(server, Some(&session), &mut messages).await? {
        upload.take(message)?;
    }
    let geometry = upload.end()?;
    let registering = session.clone();
    let registered = compute::run(Weight::Heavy, "making a geometry", move || register(&registering, &geometry));
    let info = registered.await?.started(server, session.clone());
    Ok(Response::new(pb::UploadGeometryResponse { geometry: Some(info) }))
}

/// The next message, unless there is a reason to wait no longer.
async fn next(
    server: &Server,
    session: Option<&Arc<Session>>,
    messages: &mut Streaming<pb::UploadGeometryRequest>,
) -> Result<Option<pb::UploadGeometryRequest>, Status> {
    let ended = async {
        match session {
            Some(session) => session.ended.cancelled().await,
            None => std::future::pending().await,
        }
    };
    tokio::select! {
        biased;
        () = server.drain.cancelled() => {
            Err(Problem::new(Reason::Stopping, "the server is stopping: upload again elsewhere, or later").into())
        }
        () = ended => Err(session.map_or_else(|| no_header("no message came"), |session| session.ended_problem()).into()),
        message = timeout(WRITER_PATIENCE, messages.message()) => match message {
            Ok(message) => message.map_err(the_api_says),
            Err(_) => Err(incomplete("no piece came for 30 s".to_owned()).into()),
        },
    }
}

/// A geometry whose numbers come.
#[derive(Debug)]
struct Upload {
    header: pb::GeometryHeader,
    values: Vec<f32>,
    indices: Vec<u32>,
}

impl Upload {
    /// With what the header says.
    ///
    /// # Errors
    /// It says more than a geometry may have, or names a kind that is sent in one message.
    fn begin(header: pb::GeometryHeader) -> Checked<Self> {
        let kind = header.geometry.as_ref().and_then(|geometry| geometry.kind.as_ref());
        let (values, indices) = match kind {
            Some(Kind::Hull(hull)) => (hull.points.len(), 0),
            Some(Kind::Mesh(mesh)) => (mesh.vertices.len(), mesh.indices.len()),
            Some(Kind::HeightField(field)) => (field.heights.len(), field.holes.len()),
            Some(_) => {
                let what = "is of a kind that one message holds: send it with CreateGeometry";
                return Err(Problem::at("geometry", Reason::BadGeometry, what));
            }
            None => {
                let what = "is absent: send a hull, a mesh or a height_field with its lists left empty, such as {\"mesh\": {}}";
                return Err(Problem::at("geometry", Reason::Missing, what));
            }
        };
        if values + indices > 0 {
            let what = format!("holds {} numbers: its lists must be empty here and come in chunks", values + indices);
            return Err(Problem::at("geometry", Reason::BadGeometry, what));
        }
        within("value_count", header.value_count, VALUES)?;
        within("index_count", header.index_count, INDICES)?;
        let (values, indices) = (room(header.value_count), room(header.index_count));
        Ok(Self { header, values: Vec::with_capacity(values), indices: Vec::with_capacity(indices) })
    }

    /// Bytes of the numbers that are to come.
    fn promised_bytes(&self) -> u64 {
        4 * (self.header.value_count + self.header.index_count)
    }

    /// Takes a piece in.
    ///
    /// # Errors
    /// It is no chunk, or brings more than was promised.
    fn take(&mut self, message: pb::UploadGeometryRequest) -> Checked<()> {
        let chunk = match message.piece.and_then(|piece| piece.piece) {
            Some(Piece::Chunk(chunk)) => chunk,
            Some(Piece::Header(_)) => {
                let what = "comes a second time: an upload is of one geometry, so begin another for the next";
                return Err(Problem::at("piece.header", Reason::BadGeometry, what));
            }
            Some(Piece::Exact(_)) => {
                let what = "belongs to exports: send chunks, such as {\"chunk\": {\"values\": [0, 0, 0]}}";
                return Err(Problem::at("piece.exact", Reason::BadGeometry, what));
            }
            None => {
                let what = "is absent: after the header come chunks, such as {\"chunk\": {\"values\": [0, 0, 0]}}";
                return Err(Problem::at("piece", Reason::Missing, what));
            }
        };
        let fits = |field: &str, held: usize, more: usize, promised: u64| match (held + more) as u64 <= promised {
            true => Ok(()),
            false => {
                let what =
                    format!("brings the numbers to {}: the header said {promised}, so send as many", held + more);
                Err(Problem::at(format!("piece.chunk.{field}"), Reason::TooManyItems, what))
            }
        };
        fits("values", self.values.len(), chunk.values.len(), self.header.value_count)?;
        fits("indices", self.indices.len(), chunk.indices.len(), self.header.index_count)?;
        self.values.extend_from_slice(&chunk.values);
        self.indices.extend_from_slice(&chunk.indices);
        Ok(())
    }

    /// The geometry, whole.
    ///
    /// # Errors
    /// Numbers are missing.
    fn end(self) -> Checked<pb::Geometry> {
        let Self { header, values, indices } = self;
        if (values.len() as u64, indices.len() as u64) != (header.value_count, header.index_count) {
            return Err(incomplete(format!(
                "{} of {} values and {} of {} indices came: send the rest before the end of the stream",
                values.len(),
                header.value_count,
                indices.len(),
                header.index_count
            )));
        }
        let mut geometry = header.geometry.unwrap_or_default();
        match &mut geometry.kind {
            Some(Kind::Hull(hull)) => hull.points = values,
            Some(Kind::Mesh(mesh)) => (mesh.vertices, mesh.indices) = (values, indices),
            Some(Kind::HeightField(field)) => (field.heights, field.holes) = (values, indices),
            Some(_) | None => {}
        }
        Ok(geometry)
    }
}

fn no_header(found: &str) -> Problem {
    let what = format!(
        ": {found}: an upload begins with a header, such as {{\"header\": {{\"geometry\": {{\"mesh\": {{}}}}, \
         \"value_count\": 9, \"index_count\": 3}}}}"
    );
    Problem::at("piece.header", Reason::Missing, what)
}

fn incomplete(what: String) -> Problem {
    Problem::new(Reason::UploadIncomplete, format!("the upload is incomplete: {what}"))
}
