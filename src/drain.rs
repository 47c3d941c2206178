//! Streams that others serve (health watches, reflection) end soon after a stop has begun, instead of holding it up.

use std::{
    pin::Pin,
    task::{Context, Poll},
    time::Duration,
};

use axum::body::Body;
use bytes::Bytes;
use http_body::Frame;
use tokio_util::sync::CancellationToken;
use tonic::Status;

use crate::problem::{Problem, Reason};

/// How long such a stream lasts beyond the begin of a stop: long enough for a health watch to say NOT_SERVING.
const LAST_WORDS: Duration = Duration::from_millis(200);

/// A body that ends with UNAVAILABLE when a stop has begun.
pub(crate) struct Draining {
    inner: Body,
    over: Pin<Box<dyn Future<Output = ()> + Send>>,
    is_over: bool,
}

impl Draining {
    /// `inner`, until soon after `drain` is cancelled.
    pub(crate) fn new(inner: Body, drain: CancellationToken) -> Self {
        Self {
            inner,
            over: Box::pin(async move {
                drain.cancelled().await;
                tokio::time::sleep(LAST_WORDS).await;
            }),
            is_over: false,
        }
    }
}

impl http_body::Body for Draining {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        if self.is_over {
            return Poll::Ready(None);
        }
        if let Poll::Ready(frame) = Pin::new(&mut self.inner).poll_frame(context) {
            return Poll::Ready(frame);
        }
        if self.over.as_mut().poll(context).is_pending() {
            return Poll::Pending;
        }
        self.is_over = true;
        let status =
            Status::from(Problem::new(Reason::Stopping, "the server is stopping: ask again elsewhere, or later"));
        let mut trailers = http::HeaderMap::new();
        Poll::Ready(match status.add_header(&mut trailers) {
            Ok(()) => Some(Ok(Frame::trailers(trailers))),
            Err(_) => None,
        })
    }
}
