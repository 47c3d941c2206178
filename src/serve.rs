//! The running server: one port for gRPC, gRPC-web, reflection, health and a plain page, and a door for clients in the
//! same process.
//!
//! # Limits
//! `TcpIncoming` sets TCP_NODELAY itself, because tonic ignores its own setting when it is given a listener; without it
//! a small call takes 40 ms and more.

use std::{io, net::SocketAddr, sync::Arc, time::Duration};

use axum::routing::get;
use hyper_util::rt::TokioIo;
use tokio::{
    io::DuplexStream,
    net::TcpListener,
    sync::{mpsc, watch},
    task::JoinHandle,
};
use tokio_stream::{StreamExt, wrappers::ReceiverStream};
use tokio_util::sync::CancellationToken;
use tonic::{
    service::Routes,
    transport::{Channel, Endpoint, Server, server::TcpIncoming},
};
use tonic_health::{ServingStatus, server::HealthReporter};
use tower::service_fn;

use crate::{
    config::{ConfigError, Settings},
    gate::{self, Gate},
    registry::Registry,
    rpc,
};

const MEBIBYTE: u32 = 1024 * 1024;
/// Calls and streams that one connection may have open.
const CONCURRENT_STREAMS: u32 = 128;
/// What may be under way to the server in one stream, and in one connection.
const STREAM_WINDOW: u32 = 4 * MEBIBYTE;
const CONNECTION_WINDOW: u32 = 16 * MEBIBYTE;
/// All headers of one call together.
const HEADER_LIST_BYTES: u32 = 16 * 1024;
/// A connection that has been silent for so long is asked whether it lives, and closed if it does not say so in time.
const KEEPALIVE_EVERY: Duration = Duration::from_secs(20);
const KEEPALIVE_ANSWER: Duration = Duration::from_secs(10);
/// Buffer of each direction of a connection within the process.
const IN_PROCESS_BUFFER: usize = 1 << 20;
/// Connections within the process that wait to be taken up.
const IN_PROCESS_BACKLOG: usize = 64;

/// Why a server did not start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// A setting is refused.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The address cannot be listened on.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// Which.
        address: SocketAddr,
        /// Why.
        source: io::Error,
    },
    /// The open session cannot be made.
    #[error("the session \"default\" cannot be made: {0}")]
    Session(String),
    /// The descriptors of the API cannot be served.
    #[error("reflection cannot be offered: {0}")]
    Reflection(#[from] tonic_reflection::server::Error),
}

/// A server that runs. Dropping it stops the server without waiting for its calls.
#[derive(Debug)]
pub struct Running {
    local_addr: SocketAddr,
    doors: mpsc::Sender<DuplexStream>,
    stop: Stop,
    health: HealthReporter,
    ended: watch::Receiver<bool>,
    drain_limit: Duration,
    _stop_on_drop: tokio_util::sync::DropGuard,
}

/// The two steps of a stop: streams are told to end, then whatever is left is cut off.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stop {
    /// Cancelled when no new work is taken and streams should end.
    pub(crate) drain: CancellationToken,
    /// Cancelled when whatever still runs is dropped.
    pub(crate) abort: CancellationToken,
}

/// Starts a server and returns when it listens.
///
/// # Errors
/// A setting that is refused, an address that cannot be listened on.
pub async fn start(settings: Settings) -> Result<Running, StartError> {
    settings.check()?;
    let listener = TcpListener::bind(settings.listen)
        .await
        .map_err(|source| StartError::Listen { address: settings.listen, source })?;
    let local_addr = listener.local_addr().map_err(|source| StartError::Listen { address: settings.listen, source })?;
    let stop = Stop::default();
    let (health, routes) = routes(&settings, &stop).await?;
    let (doors, incoming_doors) = mpsc::channel(IN_PROCESS_BACKLOG);
    let sockets = serve_sockets(listener, routes.clone(), stop.clone());
    let in_process = serve_in_process(incoming_doors, routes, stop.clone());
    let (tell_ended, ended) = watch::channel(false);
    tokio::spawn(async move {
        for task in [sockets, in_process] {
            if let Err(error) = task.await {
                tracing::error!(%error, "a serving task failed");
            }
        }
        let _ = tell_ended.send(true);
    });
    tracing::info!(address = %local_addr, "listening");
    Ok(Running {
        local_addr,
        doors,
        _stop_on_drop: stop.abort.clone().drop_guard(),
        stop,
        health,
        ended,
        drain_limit: settings.drain_limit,
    })
}

impl Running {
    /// Where it listens; with port 0 in the settings, the port that was taken.
    #[must_use]
    pub fn local_addr(&self) -> SocketAddr {
        self.local_addr
    }

    /// A channel to this server that crosses no socket. It connects when it is first used, and again if need be.
    #[must_use]
    pub fn connect_in_process(&self) -> Channel {
        let doors = self.doors.clone();
        Endpoint::from_static("http://in-process").connect_with_connector_lazy(service_fn(move |_| {
            let doors = doors.clone();
            async move {
                let (here, there) = tokio::io::duplex(IN_PROCESS_BUFFER);
                match doors.send(there).await {
                    Ok(()) => Ok(TokioIo::new(here)),
                    Err(_) => Err(io::Error::new(io::ErrorKind::ConnectionRefused, "the server has stopped")),
                }
            }
        }))
    }

    /// Stops: health says NOT_SERVING, streams are told, calls may end, up to the drain limit of the settings; what
    /// then still runs is cut off.
    pub async fn stop(self) {
        tracing::info!("stopping");
        for service in rpc::SERVICE_NAMES.into_iter().chain([""]) {
            self.health.set_service_status(service, ServingStatus::NotServing).await;
        }
        self.stop.drain.cancel();
        let drained = tokio::time::timeout(self.drain_limit, self.stopped()).await;
        if drained.is_err() {
            tracing::warn!(limit = ?self.drain_limit, "calls still ran at the drain limit and were cut off");
        }
        self.stop.abort.cancel();
        // The serving tasks end at once when they are aborted, so this wait needs no limit of its own.
        self.stopped().await;
        tracing::info!("stopped");
    }

    /// Returns when the server no longer serves, for whatever reason.
    pub async fn stopped(&self) {
        // An error means that the serving tasks are gone, which is what is waited for.
        let _ = self.ended.clone().wait_for(|ended| *ended).await;
    }
}

/// Everything that is served on the port, and how health is told.
async fn routes(settings: &Settings, stop: &Stop) -> Result<(HealthReporter, Routes), StartError> {
    let (health, health_service) = tonic_health::server::health_reporter();
    for service in rpc::SERVICE_NAMES.into_iter().chain([""]) {
        health.set_service_status(service, ServingStatus::Serving).await;
    }
    let reflection = || {
        tonic_reflection::server::Builder::configure()
            .register_encoded_file_descriptor_set(wire::v1::FILE_DESCRIPTOR_SET)
            .register_encoded_file_descriptor_set(tonic_health::pb::FILE_DESCRIPTOR_SET)
            // So that grpcurl can print the details of an error.
            .register_encoded_file_descriptor_set(tonic_types::pb::FILE_DESCRIPTOR_SET)
    };
    let registry = Registry::new(settings.clone()).map_err(|problem| StartError::Session(problem.to_string()))?;
    let registry = Arc::new(registry);
    let sweeper = registry.clone();
    let until = stop.clone();
    tokio::spawn(async move { until.abort.run_until_cancelled(sweeper.sweep_leases()).await });
    let gate = Arc::new(Gate::new(settings.max_in_flight, stop.clone()));
    let grpc = rpc::routes(registry, stop.drain.clone())
        .add_service(reflection().build_v1()?)
        .add_service(reflection().build_v1alpha()?)
        .add_service(health_service)
        .into_axum_router()
        .layer(axum::middleware::from_fn_with_state(gate, gate::pass))
        // Round the gRPC routes only: round the page it would answer a plain GET with 400.
        .layer(tonic_web::GrpcWebLayer::new());
    let page = axum::Router::new().route("/", get(page));
    Ok((health, Routes::from(grpc.merge(page))))
}

async fn page() -> String {
    format!(
        "Calipers {} answers collision questions over gRPC on this port; try `grpcurl -plaintext HOST:PORT list`.\n",
        env!("CARGO_PKG_VERSION")
    )
}

fn server() -> Server {
    Server::builder()
        .accept_http1(true)
        .max_concurrent_streams(CONCURRENT_STREAMS)
        .initial_stream_window_size(STREAM_WINDOW)
        .initial_connection_window_size(CONNECTION_WINDOW)
        .http2_max_header_list_size(HEADER_LIST_BYTES)
        .http2_keepalive_interval(Some(KEEPALIVE_EVERY))
        .http2_keepalive_timeout(Some(KEEPALIVE_ANSWER))
}

fn serve_sockets(listener: TcpListener, routes: Routes, stop: Stop) -> JoinHandle<()> {
    let incoming = TcpIncoming::from(listener).with_nodelay(Some(true)).with_keepalive(Some(KEEPALIVE_EVERY));
    tokio::spawn(async move {
        let serving = server().add_routes(routes).serve_with_incoming_shutdown(incoming, stop.drain.cancelled_owned());
        run_until_aborted(serving, &stop.abort).await;
    })
}

fn serve_in_process(doors: mpsc::Receiver<DuplexStream>, routes: Routes, stop: Stop) -> JoinHandle<()> {
    let incoming = ReceiverStream::new(doors).map(Ok::<_, io::Error>);
    tokio::spawn(async move {
        let serving = server().add_routes(routes).serve_with_incoming_shutdown(incoming, stop.drain.cancelled_owned());
        run_until_aborted(serving, &stop.abort).await;
    })
}

async fn run_until_aborted(
    serving: impl Future<Output = Result<(), tonic::transport::Error>>,
    abort: &CancellationToken,
) {
    if let Some(Err(error)) = abort.run_until_cancelled(serving).await {
        tracing::error!(%error, "serving failed");
    }
}
