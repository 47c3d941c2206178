//! What every call passes first: admission, its deadline, and the fence that panics do not pass.

use std::{
    panic::AssertUnwindSafe,
    sync::Arc,
    time::{Duration, Instant},
};

use axum::{
    extract::{Request, State},
    middleware::Next,
    response::Response,
};
use futures_util::FutureExt;
use tokio::sync::{Semaphore, SemaphorePermit};
use tonic::{Code, Status, body::Body};

use crate::{
    deadline::Deadline,
    drain::Draining,
    fence::caught,
    problem::{Checked, Problem, Reason},
    serve::Stop,
    workers::Workers,
};

/// How long a call may wait to be admitted before it is refused: a burst gets through, an overload does not queue up.
const ADMISSION_WAIT: Duration = Duration::from_millis(20);
/// Calls that live for long and do their work in small pieces; they are not counted.
const STREAMS: [&str; 5] = [
    "/calipers.v1.WorldService/EditStream",
    "/calipers.v1.WorldService/WatchOverlaps",
    "/calipers.v1.WorldService/WatchWorld",
    "/calipers.v1.GeometryService/UploadGeometry",
    "/calipers.v1.QueryService/QueryStream",
];
/// How the paths of this API begin.
const OWN: &str = "/calipers.v1.";
/// How tonic's refusal of a message that is too large begins.
const TOO_LARGE: &str = "Error, decoded message length too large";

/// The gate of a server.
#[derive(Debug)]
pub(crate) struct Gate {
    in_flight: Semaphore,
    limit: usize,
    workers: Arc<Workers>,
    stop: Stop,
}

impl Gate {
    /// A gate that lets so many unary calls be worked on at a time by these threads, and drops them all when the stop aborts.
    pub(crate) fn new(limit: usize, workers: Arc<Workers>, stop: Stop) -> Self {
        let limit = limit.min(Semaphore::MAX_PERMITS);
        Self { in_flight: Semaphore::new(limit), limit, workers, stop }
    }

    async fn admit(&self) -> Checked<SemaphorePermit<'_>> {
        match tokio::time::timeout(ADMISSION_WAIT, self.in_flight.acquire()).await {
            Ok(Ok(permit)) => Ok(permit),
            Ok(Err(_)) | Err(_) => {
                let limit = self.limit;
                let what = format!("the server is at its limit of {limit} calls at a time: try again a little later");
                Err(Problem::new(Reason::Overloaded, what).with("quota", "max_in_flight").with("limit", limit))
            }
        }
    }
}

/// Passes a call on.
pub(crate) async fn pass(State(gate): State<Arc<Gate>>, mut request: Request, next: Next) -> Response {
    let deadline = Deadline::of(request.headers());
    request.extensions_mut().insert(deadline);
    let uri = request.uri().clone();
    let is_counted = uri.path().starts_with(OWN) && !STREAMS.contains(&uri.path());
    let began = Instant::now();
    let call = async {
        let _permit = match is_counted {
            true => Some(gate.admit().await?),
            false => None,
        };
        let answered = AssertUnwindSafe(next.run(request)).catch_unwind();
        match gate.workers.answer(answered).await {
            Ok(Ok(response)) => Ok(response),
            Ok(Err(panic)) => Err(caught("answering a call", panic.as_ref())),
            Err(_) => Err(stopped()),
        }
    };
    let answered = tokio::select! {
        biased;
        answered = call => answered,
        () = deadline.passed() => Err(Deadline::problem()),
        () = gate.stop.abort.cancelled() => Err(stopped()),
    };
    tracing::debug!(call = uri.path(), elapsed_us = began.elapsed().as_micros(), refused = answered.is_err());
    match answered {
        Ok(response) if uri.path().starts_with(OWN) => with_the_code_of_a_quota(response),
        Ok(response) => {
            let drain = gate.stop.drain.clone();
            response.map(|body| axum::body::Body::new(Draining::new(body, drain)))
        }
        Err(problem) => refuse(problem.into()),
    }
}

fn stopped() -> Problem {
    Problem::new(Reason::Stopping, "the server has stopped: ask again elsewhere, or later")
}

/// A message that is too large is a passed quota to the API; tonic calls it OUT_OF_RANGE.
fn with_the_code_of_a_quota(response: Response) -> Response {
    match Status::from_header_map(response.headers()) {
        Some(status) if is_too_large(&status) => refuse(too_large(&status)),
        _ => response,
    }
}

/// Whether a status is tonic's refusal of a message that is too large.
fn is_too_large(status: &Status) -> bool {
    status.code() == Code::OutOfRange && status.message().starts_with(TOO_LARGE)
}

/// What the API says of a message that is too large.
fn too_large(status: &Status) -> Status {
    let what = format!(
        "the message is larger than 4 MiB, which is the most that is taken: send it in parts ({})",
        status.message()
    );
    Problem::new(Reason::QuotaExceeded, what)
        .with("quota", "message_bytes")
        .with("limit", crate::rpc::MESSAGE_BYTES)
        .into()
}

/// What the API says of a stream that cannot be read on.
pub(crate) fn the_api_says(status: Status) -> Status {
    if is_too_large(&status) { too_large(&status) } else { status }
}

fn refuse(status: Status) -> Response {
    let response: http::Response<Body> = status.into_http();
    response.map(axum::body::Body::new)
}
