//! The task behind a writer: one stream after another, and what has to be sent again on the next.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use tokio::sync::{mpsc, watch};
use tokio::time::{Instant, sleep, timeout};
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Status, Streaming};

use super::{Report, WriterOptions};
use crate::{Client, Error, proto};

/// Messages on their way into the transport.
const OUTGOING_MESSAGES: usize = 16;
/// Problems, and likewise sweep hits, that a report holds before further ones are only counted.
const REPORT_ENTRIES: usize = 4096;
/// Longest wait for the server's first response.
const OPEN_WAIT: Duration = Duration::from_secs(10);
/// Longest wait for the server to end a stream that the writer has ended.
const CLOSE_WAIT: Duration = Duration::from_secs(5);
/// First and longest pause before connecting again; each is twice the one before.
pub(crate) const PAUSE_FIRST: Duration = Duration::from_millis(20);
pub(crate) const PAUSE_MAX: Duration = Duration::from_secs(1);

/// How far the server got.
#[derive(Clone, Debug)]
pub(super) struct Progress {
    pub(super) acked_sequence: u64,
    pub(super) tick: u64,
    pub(super) window: u32,
    pub(super) resumed_count: u64,
    /// Why there will be no more progress.
    pub(super) end: Option<Error>,
}

/// One stream.
#[derive(Debug)]
pub(super) struct Stream {
    outgoing: mpsc::Sender<proto::EditStreamRequest>,
    incoming: Streaming<proto::EditStreamResponse>,
    /// How many of the kept messages went out on this stream.
    sent_count: usize,
}

/// What connects, sends, keeps and resumes.
#[derive(Debug)]
pub(super) struct Link {
    client: Client,
    name: String,
    options: WriterOptions,
    queue: mpsc::Receiver<proto::EditStreamRequest>,
    progress: watch::Sender<Progress>,
    report: Arc<Mutex<Report>>,
    /// What is not acknowledged, in order. The writer's window bounds it.
    kept: VecDeque<proto::EditStreamRequest>,
    /// Sequence number of the last message that was ever kept.
    last_sequence: u64,
    /// Since when there was no progress, because the stream broke.
    stuck_since: Option<Instant>,
}

impl Link {
    /// Opens the first stream and learns where the writer stands.
    pub(super) async fn open(
        client: Client,
        name: &str,
        options: WriterOptions,
        queue: mpsc::Receiver<proto::EditStreamRequest>,
        report: Arc<Mutex<Report>>,
    ) -> Result<(Self, watch::Receiver<Progress>, Stream), Error> {
        let start = Progress { acked_sequence: 0, tick: 0, window: 1, resumed_count: 0, end: None };
        let (progress, seen) = watch::channel(start);
        let mut link = Self {
            client,
            name: name.to_owned(),
            options,
            queue,
            progress,
            report,
            kept: VecDeque::new(),
            last_sequence: 0,
            stuck_since: None,
        };
        let (stream, first) = link.connect().await?;
        link.last_sequence = first.acked_sequence;
        link.note(first);
        Ok((link, seen, stream))
    }

    /// Runs until the writer is dropped or the stream ends for good.
    pub(super) async fn run(mut self, mut stream: Stream) {
        let end = loop {
            let broke = match self.pump(&mut stream).await {
                Ok(()) => break Error::Closed,
                Err(error) => error,
            };
            match self.resume(broke).await {
                Ok(next) => stream = next,
                Err(error) => break error,
            }
        };
        // What the writer still wants to send is refused from here on, with the reason.
        self.progress.send_modify(|progress| progress.end = Some(end));
        if self.queue.is_closed() {
            self.finish(stream).await;
        }
    }

    /// Opens a stream. Its first message carries no edits: it only names the writer.
    async fn connect(&self) -> Result<(Stream, proto::EditStreamResponse), Error> {
        let (outgoing, messages) = mpsc::channel(OUTGOING_MESSAGES);
        let hello = proto::EditStreamRequest {
            session: self.client.session().to_owned(),
            writer: self.name.clone(),
            durability: self.options.durability.into(),
            ..Default::default()
        };
        outgoing.send(hello).await.map_err(|_| Error::Closed)?;
        let opening = async {
            let mut incoming = self.client.world().edit_stream(ReceiverStream::new(messages)).await?.into_inner();
            let first = incoming.message().await?;
            let first = first.ok_or_else(|| Status::unavailable("the server ended the stream at once"))?;
            Ok::<_, Error>((incoming, first))
        };
        let late = |_| Status::unavailable("the server did not answer an opened edit stream within 10 s");
        let (incoming, first) = timeout(OPEN_WAIT, opening).await.map_err(late)??;
        Ok((Stream { outgoing, incoming, sent_count: 0 }, first))
    }

    /// Connects again after a break, with pauses, and finds out what has to be sent again.
    async fn resume(&mut self, broke: Error) -> Result<Stream, Error> {
        let mut last = broke;
        let stuck_since = *self.stuck_since.get_or_insert_with(Instant::now);
        let mut pause = PAUSE_FIRST;
        loop {
            if self.name.is_empty() || !last.is_passing() {
                return Err(last);
            }
            let waited = stuck_since.elapsed();
            if waited + pause > self.options.patience {
                return Err(Error::GaveUp { waited, last: Box::new(last) });
            }
            sleep(pause).await;
            pause = (pause * 2).min(PAUSE_MAX);
            match self.connect().await {
                Ok((stream, first)) => {
                    self.check_resumable(&first)?;
                    self.progress.send_modify(|progress| progress.resumed_count += 1);
                    self.note(first);
                    if self.kept.is_empty() {
                        self.stuck_since = None;
                    }
                    return Ok(stream);
                }
                Err(error) => last = error,
            }
        }
    }

    /// The server must know at least what it acknowledged, and nothing that this writer did not send.
    fn check_resumable(&self, first: &proto::EditStreamResponse) -> Result<(), Error> {
        let known = first.acked_sequence;
        let acked = self.progress.borrow().acked_sequence;
        if known < acked {
            return Err(Error::Forgotten { known, acked });
        }
        if known > self.last_sequence {
            let message = format!("message {known} of writer {:?} was sent by another client of that name", self.name);
            return Err(Status::aborted(message).into());
        }
        Ok(())
    }

    /// Sends and receives on one stream. Ok when the writer was dropped and everything is sent.
    async fn pump(&mut self, stream: &mut Stream) -> Result<(), Error> {
        loop {
            let unsent = self.kept.get(stream.sent_count);
            if unsent.is_none() && self.queue.is_closed() && self.queue.is_empty() {
                return Ok(());
            }
            tokio::select! {
                response = stream.incoming.message() => {
                    let ended = || Status::unavailable("the server ended the edit stream");
                    let dropped_count = self.note(response?.ok_or_else(ended)?);
                    stream.sent_count = stream.sent_count.saturating_sub(dropped_count);
                }
                permit = stream.outgoing.reserve(), if unsent.is_some() => match (permit, unsent) {
                    (Ok(permit), Some(message)) => {
                        permit.send(message.clone());
                        stream.sent_count += 1;
                    }
                    // The transport let go of the stream: the reason comes the other way.
                    _ => return Err(reason_of_end(&mut stream.incoming).await),
                },
                message = self.queue.recv(), if unsent.is_none() => {
                    if let Some(message) = message {
                        self.last_sequence = message.sequence;
                        self.kept.push_back(message);
                    }
                }
            }
        }
    }

    /// Ends the stream in good order: what was sent arrives before the connection may go.
    async fn finish(mut self, stream: Stream) {
        let Stream { outgoing, mut incoming, .. } = stream;
        drop(outgoing);
        let drain = async {
            while let Ok(Some(response)) = incoming.message().await {
                self.note(response);
            }
        };
        // Nobody is left to be told that the server was slower than this.
        let _ = timeout(CLOSE_WAIT, drain).await;
    }

    /// Takes in an acknowledgement; returns how many kept messages it lets go.
    fn note(&mut self, response: proto::EditStreamResponse) -> usize {
        let acked_sequence = response.acked_sequence;
        let before = self.kept.len();
        while self.kept.front().is_some_and(|message| message.sequence <= acked_sequence) {
            self.kept.pop_front();
        }
        let dropped_count = before - self.kept.len();
        if dropped_count > 0 {
            self.stuck_since = None;
        }
        {
            let mut report = self.report.lock().unwrap_or_else(PoisonError::into_inner);
            let mut left_out_count = keep_some(&mut report.problems, response.problems);
            left_out_count += keep_some(&mut report.sweep_hits, response.sweep_hits);
            report.sweep_hits_truncated |= response.sweep_hits_truncated;
            report.left_out_count += left_out_count;
        }
        self.progress.send_modify(|progress| {
            progress.acked_sequence = progress.acked_sequence.max(acked_sequence);
            progress.tick = progress.tick.max(response.tick);
            if response.window > 0 {
                progress.window = response.window;
            }
        });
        dropped_count
    }
}

/// Appends as far as there is room, and says how many entries found none.
fn keep_some<T>(entries: &mut Vec<T>, more: Vec<T>) -> u64 {
    let room = REPORT_ENTRIES.saturating_sub(entries.len());
    let left_out_count = more.len().saturating_sub(room);
    entries.extend(more.into_iter().take(room));
    left_out_count as u64
}

/// Why the server ended a stream that no longer takes messages.
async fn reason_of_end(incoming: &mut Streaming<proto::EditStreamResponse>) -> Error {
    let end = async {
        loop {
            match incoming.message().await {
                Ok(Some(_)) => {}
                Ok(None) => return Status::unavailable("the server ended the edit stream"),
                Err(status) => return status,
            }
        }
    };
    timeout(CLOSE_WAIT, end).await.unwrap_or_else(|_| Status::unavailable("the edit stream broke")).into()
}
