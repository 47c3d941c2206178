//! Watches that go on after the connection broke.
//!
//! # Method
//!
//! When the stream breaks, it is opened again, with pauses: a watch of overlaps where its last turn ended, by the server's
//! token, and if the server no longer holds that, with a snapshot; a watch of a world always with a snapshot. Several messages
//! of one turn of overlaps are put together before they are handed out, so that nothing is told twice. So who takes in each
//! turn, and forgets everything at a snapshot, knows what there is, whatever happened in between.

use std::ops::ControlFlow;
use std::time::Duration;

use tokio::time::{Instant, sleep};
use tonic::{Status, Streaming};

use crate::Error;
use crate::client::Client;
use crate::proto::{self, PairColumns, WatchOverlapsResponse, WatchWorldResponse};
use crate::writer::{PAUSE_FIRST, PAUSE_MAX};

/// How long a broken watch is tried to be taken up, unless something else is said.
const PATIENCE: Duration = Duration::from_secs(30);

/// A watch that opens its stream again when that breaks.
///
/// ```no_run
/// # async fn example(client: calipers_client::Client) -> Result<(), calipers_client::Error> {
/// use std::collections::BTreeSet;
/// use calipers_client::proto::{Region, WatchOverlapsRequest};
///
/// let gate = Region { id: 1, geometry: Some(calipers_client::geometry::sphere(2.0)), ..Region::default() };
/// let mut watch = client.follow_overlaps(WatchOverlapsRequest { regions: vec![gate], ..Default::default() }).await?;
/// let mut inside = BTreeSet::new();
/// loop {
///     let turn = watch.next().await?;
///     if turn.snapshot {
///         inside.clear();
///     }
///     for id in turn.left.unwrap_or_default().b {
///         inside.remove(&id);
///     }
///     inside.extend(turn.entered.unwrap_or_default().b);
///     println!("{inside:?}");
/// }
/// # }
/// ```
#[derive(Debug)]
pub struct Watch<T: Turn> {
    client: Client,
    request: T::Request,
    stream: Option<Streaming<T>>,
    /// What has come of a turn whose end has not.
    begun: Option<T>,
    patience: Duration,
    /// Since when there is no stream.
    broken_since: Option<Instant>,
    resumed_count: u64,
}

impl Client {
    /// What enters and leaves regions, and which shapes begin and cease to overlap, over breaks of the connection.
    ///
    /// # Errors
    ///
    /// What the server says is wrong with the request, or that it is not there.
    pub async fn follow_overlaps(
        &self,
        request: proto::WatchOverlapsRequest,
    ) -> Result<Watch<WatchOverlapsResponse>, Error> {
        Watch::open(self.clone(), request).await
    }

    /// What a viewer draws, over breaks of the connection, after each of which everything is told anew.
    ///
    /// # Errors
    ///
    /// As [`follow_overlaps`](Self::follow_overlaps).
    pub async fn follow_world(&self, request: proto::WatchWorldRequest) -> Result<Watch<WatchWorldResponse>, Error> {
        Watch::open(self.clone(), request).await
    }
}

impl<T: Turn> Watch<T> {
    async fn open(client: Client, request: T::Request) -> Result<Self, Error> {
        let stream = Some(T::open(&client, request.clone()).await?);
        Ok(Self { client, request, stream, begun: None, patience: PATIENCE, broken_since: None, resumed_count: 0 })
    }

    /// Gives up when a break lasts longer than this; at first that is 30 seconds. 0 means not to connect again.
    #[must_use]
    pub fn with_patience(self, patience: Duration) -> Self {
        Self { patience, ..self }
    }

    /// How often the stream was opened again.
    pub fn resumed_count(&self) -> u64 {
        self.resumed_count
    }

    /// The next turn; of overlaps it is whole, so that its `more` is never set. A call whose future is dropped has lost nothing.
    ///
    /// # Errors
    ///
    /// [`Error::GaveUp`] if a break lasts longer than the patience; what the server refuses the request for now, such as a session
    /// that has ended.
    pub async fn next(&mut self) -> Result<T, Error> {
        loop {
            match self.turn().await {
                Ok(turn) => {
                    turn.resume(&mut self.request);
                    return Ok(turn);
                }
                Err(broke) => self.resume(broke).await?,
            }
        }
    }

    async fn turn(&mut self) -> Result<T, Error> {
        let Some(stream) = &mut self.stream else {
            return Err(Status::unavailable("the watch broke").into());
        };
        loop {
            let ended = || Status::unavailable("the server ended the watch");
            let message = stream.message().await?.ok_or_else(ended)?;
            self.broken_since = None;
            match T::with(self.begun.take(), message) {
                ControlFlow::Break(whole) => return Ok(whole),
                ControlFlow::Continue(begun) => self.begun = Some(begun),
            }
        }
    }

    /// Opens the stream again, with pauses.
    async fn resume(&mut self, broke: Error) -> Result<(), Error> {
        let mut last = broke;
        self.stream = None;
        self.begun = None;
        let broken_since = *self.broken_since.get_or_insert_with(Instant::now);
        let mut pause = PAUSE_FIRST;
        loop {
            let waited = broken_since.elapsed();
            if !last.is_passing() {
                return Err(last);
            }
            if waited + pause > self.patience {
                return Err(Error::GaveUp { waited, last: Box::new(last) });
            }
            sleep(pause).await;
            pause = (pause * 2).min(PAUSE_MAX);
            match T::open(&self.client, self.request.clone()).await {
                Ok(stream) => {
                    self.stream = Some(stream);
                    self.resumed_count += 1;
                    return Ok(());
                }
                Err(error) => last = error,
            }
        }
    }
}

/// What a watch tells at a time; of messages of the API only.
pub trait Turn: sealed::Sealed + Sized {
    /// What opens the stream.
    type Request: Clone + std::fmt::Debug;
    /// Opens it.
    #[doc(hidden)]
    fn open(client: &Client, request: Self::Request) -> impl Future<Output = Result<Streaming<Self>, Error>> + Send;
    /// What has come of a turn with the next message of it; breaks when that is to be handed out.
    #[doc(hidden)]
    fn with(begun: Option<Self>, next: Self) -> ControlFlow<Self, Self>;
    /// Has the request go on after this turn.
    #[doc(hidden)]
    fn resume(&self, request: &mut Self::Request);
}

mod sealed {
    /// Nothing else tells turns.
    pub trait Sealed {}
    impl Sealed for crate::proto::WatchOverlapsResponse {}
    impl Sealed for crate::proto::WatchWorldResponse {}
}

impl Turn for WatchOverlapsResponse {
    type Request = proto::WatchOverlapsRequest;

    async fn open(client: &Client, request: Self::Request) -> Result<Streaming<Self>, Error> {
        client.watch_overlaps(request).await
    }

    fn with(begun: Option<Self>, next: Self) -> ControlFlow<Self, Self> {
        let is_last = !next.more;
        let turn = match begun {
            None => next,
            // The first message says whether it is a snapshot, the last one where to resume and how many ticks there were.
            Some(begun) => Self {
                snapshot: begun.snapshot,
                entered: joined(begun.entered, next.entered),
                left: joined(begun.left, next.left),
                began: joined(begun.began, next.began),
                ended: joined(begun.ended, next.ended),
                ..next
            },
        };
        if is_last { ControlFlow::Break(turn) } else { ControlFlow::Continue(turn) }
    }

    fn resume(&self, request: &mut Self::Request) {
        request.resume_token.clone_from(&self.resume_token);
        // Should the server not be able to go on from there, it has to say what there is.
        request.skip_snapshot = false;
    }
}

impl Turn for WatchWorldResponse {
    type Request = proto::WatchWorldRequest;

    async fn open(client: &Client, request: Self::Request) -> Result<Streaming<Self>, Error> {
        client.watch_world(request).await
    }

    /// Each message by itself: a break in the middle is followed by a snapshot, which takes back all of them.
    fn with(_begun: Option<Self>, next: Self) -> ControlFlow<Self, Self> {
        ControlFlow::Break(next)
    }

    fn resume(&self, _request: &mut Self::Request) {}
}

fn joined(pairs: Option<PairColumns>, more: Option<PairColumns>) -> Option<PairColumns> {
    match (pairs, more) {
        (Some(mut pairs), Some(more)) => {
            pairs.a.extend(more.a);
            pairs.b.extend(more.b);
            Some(pairs)
        }
        (pairs, more) => pairs.or(more),
    }
}
