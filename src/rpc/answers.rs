//! The answers of a call that streams: they wait in a short queue for their reader, and what ends the call comes last.

use futures_util::{StreamExt, stream::iter};
use tokio::{
    sync::mpsc::{self, error::TrySendError},
    time::timeout,
};
use tokio_stream::wrappers::ReceiverStream;
use tonic::Status;

use super::{Answers, READER_PATIENCE};

/// Where the work of a call puts its answers.
pub(super) type Unread<T> = mpsc::Sender<Result<T, Status>>;

/// Begins the work of a call, which may be ahead of its reader by so many answers. What it fails with is told to the reader.
pub(super) fn stream<T, W>(most_unread: usize, work: impl FnOnce(Unread<T>) -> W) -> Answers<T>
where
    T: Send + 'static,
    W: Future<Output = Result<(), Status>> + Send + 'static,
{
    Box::pin(begin(most_unread, work))
}

/// The same for work that hands over several answers at a time, at most so many lists of them ahead: to wake a reader costs more
/// than a small answer does.
pub(super) fn stream_of_lists<T, W>(most_unread: usize, work: impl FnOnce(Unread<Vec<T>>) -> W) -> Answers<T>
where
    T: Send + 'static,
    W: Future<Output = Result<(), Status>> + Send + 'static,
{
    let one_by_one = |list: Result<Vec<T>, Status>| match list {
        Ok(list) => iter(list).map(Ok).left_stream(),
        Err(status) => iter([Err(status)]).right_stream(),
    };
    Box::pin(begin(most_unread, work).flat_map(one_by_one))
}

fn begin<T, W>(most_unread: usize, work: impl FnOnce(Unread<T>) -> W) -> ReceiverStream<Result<T, Status>>
where
    T: Send + 'static,
    W: Future<Output = Result<(), Status>> + Send + 'static,
{
    let (answers, unread) = mpsc::channel(most_unread);
    let work = work(answers.clone());
    tokio::spawn(async move {
        if let Err(status) = work.await {
            // A client that has gone needs no reason.
            let _ = timeout(READER_PATIENCE, answers.send(Err(status))).await;
        }
    });
    ReceiverStream::new(unread)
}

/// What became of an answer that was handed to its reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Handed {
    /// It waits for its reader, or is read.
    Over,
    /// The reader has gone.
    Gone,
    /// The reader made no room for it in its time.
    TooSlow,
}

/// Hands an answer to its reader, who is waited for; one that keeps up costs no timer.
pub(super) async fn hand<T>(answers: &Unread<T>, answer: T) -> Handed {
    let answer = match answers.try_send(Ok(answer)) {
        Ok(()) => return Handed::Over,
        Err(TrySendError::Closed(_)) => return Handed::Gone,
        Err(TrySendError::Full(answer)) => answer,
    };
    match timeout(READER_PATIENCE, answers.send(answer)).await {
        Ok(Ok(())) => Handed::Over,
        Ok(Err(_)) => Handed::Gone,
        Err(_) => Handed::TooSlow,
    }
}
