//! Keeps a world up to date over a stream of edits.
//!
//! # Method
//!
//! Every message has a sequence number. The writer keeps each until the server acknowledges that it is in a committed
//! tick; when the stream breaks, it connects again, learns how far the server got, and sends the rest once more. The
//! server drops what it has seen, so nothing is lost and nothing is applied twice. The server's window bounds what is
//! kept: a writer that is too fast waits.

mod link;

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use tokio::sync::{mpsc, watch};

use self::link::{Link, Progress};
pub(crate) use self::link::{PAUSE_FIRST, PAUSE_MAX};
use crate::{Client, Error, proto};

/// Messages between the writer and its task; the server's window is what really bounds them.
const QUEUE_MESSAGES: usize = 64;

/// How a writer behaves.
#[derive(Clone, Debug)]
pub struct WriterOptions {
    /// Acknowledge only ticks that are this safe.
    pub durability: proto::Durability,
    /// How long a broken stream may stay without progress before the writer gives up; 0 means not to reconnect.
    pub patience: Duration,
}

impl Default for WriterOptions {
    fn default() -> Self {
        Self { durability: proto::Durability::Unspecified, patience: Duration::from_secs(30) }
    }
}

/// What the server said about edits beside acknowledging them.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Edits that were left out, with the reason, the field and the sequence number of the message.
    pub problems: Vec<proto::Problem>,
    /// What bullet shapes touched on their way.
    pub sweep_hits: Vec<proto::SweepHit>,
    /// A bullet touched more than the server lists.
    pub sweep_hits_truncated: bool,
    /// Entries that found no room here, because the report was not taken for too long.
    pub left_out_count: u64,
}

/// A named writer of a world.
///
/// [`send`](Self::send) adds edits to the open tick, [`commit`](Self::commit) ends it, [`flush`](Self::flush) waits until
/// all of it is in the world. A second writer of the same name and session replaces the first. A call whose future is
/// dropped before it is done has sent nothing.
///
/// ```no_run
/// # async fn example(client: calipers_client::Client) -> Result<(), calipers_client::Error> {
/// use calipers_client::{EditWriter, ask, edit, shape};
///
/// let mut writer = EditWriter::open(&client, "robot-arm").await?;
/// writer.commit([shape::sphere(1, 0.5).insert()]).await?;
/// for step in 1..=100 {
///     writer.commit([edit::move_to(1, [0.1 * f64::from(step), 0.0, 0.0])]).await?;
/// }
/// let tick = writer.flush().await?;
/// assert!(writer.take_report().problems.is_empty());
///
/// let mut ray = ask::ray([10.0, 0.0, -5.0], [0.0, 0.0, 1.0]);
/// ray.options = Some(ask::seeing_tick(tick));
/// assert_eq!(client.raycast(ray).await?.hits[0].distance, Some(4.5));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct EditWriter {
    messages: mpsc::Sender<proto::EditStreamRequest>,
    progress: watch::Receiver<Progress>,
    report: Arc<Mutex<Report>>,
    /// Of the message sent last.
    sequence: u64,
    /// Of the last message that ended a tick.
    committed_sequence: u64,
}

impl EditWriter {
    /// Opens the stream. An empty name means that nothing is resumed after a break.
    ///
    /// # Errors
    ///
    /// [`Error::Status`] if the server refuses it, or does not answer within 10 seconds.
    pub async fn open(client: &Client, name: &str) -> Result<Self, Error> {
        Self::open_with(client, name, WriterOptions::default()).await
    }

    /// Opens the stream, with options.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    pub async fn open_with(client: &Client, name: &str, options: WriterOptions) -> Result<Self, Error> {
        let (messages, queue) = mpsc::channel(QUEUE_MESSAGES);
        let report = Arc::new(Mutex::new(Report::default()));
        let (link, progress, stream) = Link::open(client.clone(), name, options, queue, Arc::clone(&report)).await?;
        let sequence = progress.borrow().acked_sequence;
        tokio::spawn(link.run(stream));
        Ok(Self { messages, progress, report, sequence, committed_sequence: sequence })
    }

    /// Adds edits, at most 65,536, to the tick that is open, and returns the message's sequence number. Waits while the
    /// window is full.
    ///
    /// # Errors
    ///
    /// [`Error::WindowFull`] if the window holds nothing but messages of this open tick; otherwise the error that ended
    /// the stream.
    pub async fn send(&mut self, edits: impl IntoIterator<Item = proto::Edit>) -> Result<u64, Error> {
        self.push(proto::EditStreamRequest { edits: edits.into_iter().collect(), ..Default::default() }).await
    }

    /// Adds edits, possibly none, and ends the tick: everything since the last commit is seen at once. Returns the
    /// message's sequence number; waits while the window is full.
    ///
    /// # Errors
    ///
    /// As [`send`](Self::send).
    pub async fn commit(&mut self, edits: impl IntoIterator<Item = proto::Edit>) -> Result<u64, Error> {
        let edits = edits.into_iter().collect();
        self.push(proto::EditStreamRequest { edits, commit: true, ..Default::default() }).await
    }

    /// Waits until everything sent is in the world, and returns the tick that holds it; 0 if nothing was ever sent. A
    /// tick that is still open is committed first.
    ///
    /// # Errors
    ///
    /// As [`send`](Self::send).
    pub async fn flush(&mut self) -> Result<u64, Error> {
        if self.sequence > self.committed_sequence {
            self.commit([]).await?;
        }
        let sequence = self.sequence;
        Ok(self.reached(|progress| progress.acked_sequence >= sequence).await?.tick)
    }

    /// Waits until everything sent is in the world, and ends the stream. Returns the last tick, as
    /// [`flush`](Self::flush) does. A writer that is merely dropped sends what it holds, but does not say how it went.
    ///
    /// # Errors
    ///
    /// As [`send`](Self::send).
    pub async fn close(mut self) -> Result<u64, Error> {
        self.flush().await
    }

    /// Sequence number of the last message that is known to be in a committed tick.
    pub fn acked_sequence(&self) -> u64 {
        self.progress.borrow().acked_sequence
    }

    /// The newest tick that is known to hold messages of this writer; 0 if none does.
    pub fn acked_tick(&self) -> u64 {
        self.progress.borrow().tick
    }

    /// How often the stream broke and was resumed.
    pub fn resumed_count(&self) -> u64 {
        self.progress.borrow().resumed_count
    }

    /// What the server said beside acknowledging, since this was last asked.
    pub fn take_report(&self) -> Report {
        std::mem::take(&mut *self.report.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Numbers a message and hands it over once the window has room.
    async fn push(&mut self, mut message: proto::EditStreamRequest) -> Result<u64, Error> {
        let sequence = self.sequence + 1;
        let committed_sequence = self.committed_sequence;
        let fits = |progress: &Progress| sequence - progress.acked_sequence <= u64::from(progress.window);
        let progress = self.reached(|now| fits(now) || now.acked_sequence >= committed_sequence).await?;
        if !fits(&progress) {
            return Err(Error::WindowFull { window: progress.window });
        }
        // Room is reserved before anything is numbered: a caller that drops this future leaves no gap behind.
        let Ok(room) = self.messages.reserve().await else {
            return Err(self.progress.borrow().end.clone().unwrap_or(Error::Closed));
        };
        message.sequence = sequence;
        if message.commit {
            self.committed_sequence = sequence;
        }
        self.sequence = sequence;
        room.send(message);
        Ok(sequence)
    }

    /// Waits until the progress is as wished.
    async fn reached(&mut self, wished: impl Fn(&Progress) -> bool) -> Result<Progress, Error> {
        loop {
            let progress = self.progress.borrow_and_update().clone();
            if let Some(end) = progress.end {
                return Err(end);
            }
            if wished(&progress) {
                return Ok(progress);
            }
            self.progress.changed().await.map_err(|_| Error::Closed)?;
        }
    }
}
