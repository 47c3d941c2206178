//! The calls of the API: wire messages to checked questions, answers to wire messages. The only room besides `convert`
//! that knows protobuf.

mod account;
mod answering;
mod answers;
mod batch;
mod create_session;
mod depenetrate;
mod describe_world;
mod distance;
mod distance_batch;
mod download;
mod edit;
mod edit_stream;
mod explain;
mod export_world;
mod first_touch;
mod fork_session;
mod geometries;
mod geometry;
mod import_world;
mod items;
mod line_of_sight;
mod list_shapes;
mod move_character;
mod overlap;
mod overlap_batch;
mod pairs;
mod penetration;
mod query_stream;
mod question;
mod questions;
mod raycast;
mod raycast_batch;
mod reading;
mod replay;
mod resolve;
mod scene;
mod session;
mod sessions;
mod time_of_impact;
mod time_of_impact_batch;
mod turns;
mod update_world;
mod upload;
mod watch_overlaps;
mod watch_world;
mod worlds;

use std::{pin::Pin, sync::Arc, time::Duration};

use prost::Message;
use tokio_stream::Stream;
use tokio_util::sync::CancellationToken;
use tonic::{Request, Status, service::Routes};
use wire::v1 as pb;

pub(crate) use import_world::read_export;
pub(crate) use replay::{FORMAT as REPLAY_FORMAT, ask_again};

use crate::{
    building::Workshop,
    deadline::Deadline,
    problem::{Checked, Problem, Reason},
    registry::Registry,
    session::Session,
    token::Role,
};

/// The gRPC names of the services, for health.
pub(crate) const SERVICE_NAMES: [&str; 4] = [
    "calipers.v1.SessionService",
    "calipers.v1.GeometryService",
    "calipers.v1.WorldService",
    "calipers.v1.QueryService",
];

/// Largest message that is taken or sent.
pub(crate) const MESSAGE_BYTES: usize = 4 * 1024 * 1024;

/// A client that takes nothing of an answer for so long is cut off.
const READER_PATIENCE: Duration = Duration::from_secs(10);

/// A client that sends no piece of what it has begun for so long is given up.
const WRITER_PATIENCE: Duration = Duration::from_secs(30);

/// The answers of a call that streams.
type Answers<T> = Pin<Box<dyn Stream<Item = Result<T, Status>> + Send>>;

/// What all calls share.
#[derive(Debug)]
pub(crate) struct Server {
    registry: Arc<Registry>,
    workshop: Arc<Workshop>,
    /// Cancelled when streams should end.
    drain: CancellationToken,
}

impl Server {
    /// The session of a call, for a caller who may do at least what `least` may.
    fn enter(&self, caller: &Caller, session: &str, least: Role) -> Checked<Arc<Session>> {
        let (session, _) = self.registry.enter(session, caller.token.as_deref(), least)?;
        Ok(session)
    }
}

/// Who calls, and how long the answer may take.
#[derive(Clone, Debug)]
struct Caller {
    token: Option<String>,
    deadline: Deadline,
}

impl Caller {
    fn of<T>(request: &Request<T>) -> Self {
        let authorization = request.metadata().get("authorization").and_then(|value| value.to_str().ok());
        let token = authorization.and_then(|text| text.split_once(' ')).and_then(|(scheme, token)| {
            let is_bearer = scheme.eq_ignore_ascii_case("bearer");
            is_bearer.then(|| token.trim().to_owned())
        });
        Self { token, deadline: request.extensions().get::<Deadline>().copied().unwrap_or_default() }
    }
}

/// Checks that an answer fits into one message.
///
/// # Errors
/// It does not; `remedy` says what the caller can do.
fn fitting<A: Message>(answer: A, remedy: &str) -> Checked<A> {
    fits(&answer, remedy).map(|()| answer)
}

/// The same, for who keeps the answer.
fn fits(answer: &impl Message, remedy: &str) -> Checked<()> {
    let bytes = answer.encoded_len();
    if bytes <= MESSAGE_BYTES {
        return Ok(());
    }
    let what = format!("the answer would have {bytes} bytes, and a message may have {MESSAGE_BYTES}: {remedy}");
    Err(Problem::new(Reason::QuotaExceeded, what).with("quota", "message_bytes").with("limit", MESSAGE_BYTES))
}

/// The routes of the four services.
pub(crate) fn routes(registry: Arc<Registry>, drain: CancellationToken) -> Routes {
    let server = Arc::new(Server { registry, workshop: Arc::new(Workshop::new(drain.clone())), drain });
    let sessions = pb::session_service_server::SessionServiceServer::new(sessions::Sessions(server.clone()));
    let geometries = pb::geometry_service_server::GeometryServiceServer::new(geometries::Geometries(server.clone()));
    let worlds = pb::world_service_server::WorldServiceServer::new(worlds::Worlds(server.clone()));
    let questions = pb::query_service_server::QueryServiceServer::new(questions::Questions(server));
    Routes::new(sessions.max_decoding_message_size(MESSAGE_BYTES))
        .add_service(geometries.max_decoding_message_size(MESSAGE_BYTES))
        .add_service(worlds.max_decoding_message_size(MESSAGE_BYTES))
        .add_service(questions.max_decoding_message_size(MESSAGE_BYTES))
}
