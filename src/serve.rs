//! The running server: one port for gRPC, gRPC-web, reflection, health and a plain page, and a door for clients in the
//! same process.
//!
//! # Limits
//! `TcpIncoming` sets TCP_NODELAY itself, because tonic ignores its own setting when it is given a listener; without it
//! a small call takes 40 ms and more.

use std::{io, net::SocketAddr, sync::Arc, time::Duration};

use axum::routing::get;
use hyper_util::rt::TokioIo;
use tokio::{net::TcpListener, sync::watch};
use tokio_stream::StreamExt;
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
    workers::{Connections, Idle, Workers},
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
/// After a connection could not be accepted: while the process has no file left for one, none can.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);
/// How long calls that were cut off have to say so to their clients.
const LAST_WORDS: Duration = Duration::from_millis(250);
/// Buffer of each direction of a connection within the process.
const IN_PROCESS_BUFFER: usize = 1 << 20;

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
    /// The system refuses the threads that serve.
    #[error("cannot begin the threads that serve: {0}")]
    Threads(#[source] io::Error),
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
    workers: Arc<Workers>,
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
    let (workers, idle) = Workers::new().map_err(StartError::Threads)?;
    let workers = Arc::new(workers);
    let (health, routes) = routes(&settings, &workers, &stop).await?;
    let begin = |(number, thread): (usize, Idle)| {
        let (routes, stop) = (routes.clone(), stop.clone());
        thread.begin(number, move |connections| serve(connections, routes, stop))
    };
    let ends: io::Result<Vec<_>> = idle.into_iter().enumerate().map(begin).collect();
    // Those that have begun end with the server.
    let ends = ends.map_err(StartError::Threads).inspect_err(|_| stop.abort.cancel())?;
    let accepting = tokio::spawn(accept(listener, workers.clone(), stop.clone()));
    let (tell_ended, ended) = watch::channel(false);
    tokio::spawn(async move {
        if let Err(error) = accepting.await {
            tracing::error!(%error, "accepting connections failed");
        }
        for end in ends {
            end.await;
        }
        let _ = tell_ended.send(true);
    });
    tracing::info!(address = %local_addr, "listening");
    Ok(Running {
        local_addr,
        workers,
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
        let workers = self.workers.clone();
        Endpoint::from_static("http://in-process").connect_with_connector_lazy(service_fn(move |_| {
            let workers = workers.clone();
            async move {
                let (here, there) = tokio::io::duplex(IN_PROCESS_BUFFER);
                workers.take_up_in_process(there).await.map(|()| TokioIo::new(here))
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
        // The threads end soon when they are aborted, so this wait needs no limit of its own.
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
async fn routes(
    settings: &Settings,
    workers: &Arc<Workers>,
    stop: &Stop,
) -> Result<(HealthReporter, Routes), StartError> {
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
    let gate = Arc::new(Gate::new(settings.max_in_flight, workers.clone(), stop.clone()));
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

/// Gives connections to the threads until the server drains.
async fn accept(listener: TcpListener, workers: Arc<Workers>, stop: Stop) {
    let mut incoming = TcpIncoming::from(listener).with_nodelay(Some(true)).with_keepalive(Some(KEEPALIVE_EVERY));
    while let Some(Some(accepted)) = stop.drain.run_until_cancelled(incoming.next()).await {
        let taken = match accepted {
            Ok(socket) => workers.take_up(socket).await,
            Err(error) => {
                tokio::time::sleep(ACCEPT_PAUSE).await;
                Err(error)
            }
        };
        if let Err(error) = taken {
            tracing::debug!(%error, "a connection was not taken up");
        }
    }
}

/// Serves the connections of a thread until the server has drained or aborts.
async fn serve(connections: Connections, routes: Routes, stop: Stop) {
    let (sockets, in_process) = connections.split();
    let drained = || stop.drain.clone().cancelled_owned();
    let sockets = server().add_routes(routes.clone()).serve_with_incoming_shutdown(sockets, drained());
    let in_process = server().add_routes(routes).serve_with_incoming_shutdown(in_process, drained());
    let mut both = std::pin::pin!(async { tokio::try_join!(sockets, in_process) });
    let served = match stop.abort.run_until_cancelled(&mut both).await {
        Some(served) => Some(served),
        None => {
            stop.drain.cancel();
            tokio::time::timeout(LAST_WORDS, both).await.ok()
        }
    };
    if let Some(Err(error)) = served {
        tracing::error!(%error, "serving failed");
    }
}
