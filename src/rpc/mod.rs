//! The calls of the API: wire messages to checked questions, answers to wire messages. The only room besides `convert`
//! that knows protobuf.

mod geometries;
mod later;
mod questions;
mod sessions;
mod worlds;

use std::{pin::Pin, sync::Arc};

use tokio_stream::Stream;
use tonic::{Status, service::Routes};
use wire::v1 as pb;

use crate::{config::Settings, serve::Stop};

/// The gRPC names of the services, for health.
pub(crate) const SERVICE_NAMES: [&str; 4] = [
    "calipers.v1.SessionService",
    "calipers.v1.GeometryService",
    "calipers.v1.WorldService",
    "calipers.v1.QueryService",
];

/// Largest message that is taken.
const MESSAGE_BYTES: usize = 4 * 1024 * 1024;

/// The answers of a call that streams.
type Answers<T> = Pin<Box<dyn Stream<Item = Result<T, Status>> + Send>>;

/// What all calls share.
#[derive(Debug)]
pub(crate) struct Server {}

/// The routes of the four services.
pub(crate) fn routes(_settings: &Settings, _stop: &Stop) -> Routes {
    let server = Arc::new(Server {});
    let sessions = pb::session_service_server::SessionServiceServer::new(sessions::Sessions(server.clone()));
    let geometries = pb::geometry_service_server::GeometryServiceServer::new(geometries::Geometries(server.clone()));
    let worlds = pb::world_service_server::WorldServiceServer::new(worlds::Worlds(server.clone()));
    let questions = pb::query_service_server::QueryServiceServer::new(questions::Questions(server));
    Routes::new(sessions.max_decoding_message_size(MESSAGE_BYTES))
        .add_service(geometries.max_decoding_message_size(MESSAGE_BYTES))
        .add_service(worlds.max_decoding_message_size(MESSAGE_BYTES))
        .add_service(questions.max_decoding_message_size(MESSAGE_BYTES))
}
