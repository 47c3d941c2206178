//! Many single questions on one stream: what thousand tasks ask at once costs each a fraction of a call of its own.
//!
//! # Method
//! A question takes a number and goes onto the stream; whoever asked waits for the answer of that number. What is sent
//! while the connection writes goes out together, and so do the answers. A stream that breaks fails what waits for it, and
//! the next question opens another.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::{mpsc, oneshot};
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Code, Request, Status, Streaming};
use tonic_types::{ErrorDetails, StatusExt};

use crate::client::Secured;
use crate::proto::query_service_client::QueryServiceClient;
use crate::proto::{self, answer::Answer, query_stream_request::Request as Asked, query_stream_response::Response};

/// Questions that wait for the network.
const UNSENT_QUESTIONS: usize = 1024;

/// A stream of questions that opens when it is needed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pipeline {
    current: Arc<Mutex<Option<Arc<Open>>>>,
}

impl Pipeline {
    /// The answer to a question.
    ///
    /// # Errors
    /// What the server says of it, or the stream broke.
    pub(crate) async fn ask(
        &self,
        questions: impl FnOnce() -> QueryServiceClient<Secured>,
        question: proto::question::Question,
    ) -> Result<Answer, Status> {
        let open = self.open(questions);
        let question = proto::Question { question: Some(question) };
        let waiting = open.send(Asked::Question(question)).await?;
        let answered = waiting.await.map_err(|_| broken())??;
        match answered {
            Response::Answer(proto::Answer { answer: Some(answer) }) => Ok(answer),
            Response::Problem(problem) => Err(status_of(problem)),
            _ => Err(Status::internal("the server answered another kind of question")),
        }
    }

    /// The stream that is open, or a new one.
    fn open(&self, questions: impl FnOnce() -> QueryServiceClient<Secured>) -> Arc<Open> {
        let mut current = self.current.lock().unwrap_or_else(PoisonError::into_inner);
        match current.as_ref().filter(|open| !open.unsent.is_closed()) {
            Some(open) => open.clone(),
            None => current.insert(Arc::new(Open::begin(questions()))).clone(),
        }
    }
}

/// A stream that is open, or about to be.
#[derive(Debug)]
struct Open {
    unsent: mpsc::Sender<proto::QueryStreamRequest>,
    waiting: Arc<Mutex<Waiting>>,
}

/// Who waits for which answer.
#[derive(Debug, Default)]
struct Waiting {
    last_id: u64,
    askers: HashMap<u64, oneshot::Sender<Result<Response, Status>>>,
    /// Why no answer will come any more.
    ended: Option<Status>,
}

impl Open {
    fn begin(mut questions: QueryServiceClient<Secured>) -> Self {
        let (unsent, requests) = mpsc::channel(UNSENT_QUESTIONS);
        let waiting = Arc::new(Mutex::new(Waiting::default()));
        let askers = waiting.clone();
        tokio::spawn(async move {
            let ended = match questions.query_stream(Request::new(ReceiverStream::new(requests))).await {
                Ok(answers) => hand_out(answers.into_inner(), &askers).await,
                Err(status) => status,
            };
            let mut waiting = lock(&askers);
            for (_, asker) in waiting.askers.drain() {
                // One who no longer waits needs no answer.
                let _ = asker.send(Err(ended.clone()));
            }
            waiting.ended = Some(ended);
        });
        Self { unsent, waiting }
    }

    /// Sends a question; the receiver gets its answer.
    async fn send(&self, asked: Asked) -> Result<oneshot::Receiver<Result<Response, Status>>, Status> {
        let (asker, answer) = oneshot::channel();
        let request_id = {
            let mut waiting = lock(&self.waiting);
            if let Some(ended) = &waiting.ended {
                return Err(ended.clone());
            }
            waiting.last_id += 1;
            let id = waiting.last_id;
            waiting.askers.insert(id, asker);
            id
        };
        let request = proto::QueryStreamRequest { request_id, request: Some(asked) };
        self.unsent.send(request).await.map_err(|_| broken())?;
        Ok(answer)
    }
}

/// Gives each answer to who asked, until there are no more. Returns why.
async fn hand_out(mut answers: Streaming<proto::QueryStreamResponse>, waiting: &Mutex<Waiting>) -> Status {
    loop {
        match answers.message().await {
            Ok(Some(answer)) => {
                let asker = lock(waiting).askers.remove(&answer.request_id);
                let response = answer.response.ok_or_else(|| Status::internal("the server sent an empty answer"));
                if let Some(asker) = asker {
                    // One who no longer waits needs no answer.
                    let _ = asker.send(response);
                }
            }
            Ok(None) => return broken(),
            Err(status) => return status,
        }
    }
}

fn lock(waiting: &Mutex<Waiting>) -> std::sync::MutexGuard<'_, Waiting> {
    waiting.lock().unwrap_or_else(PoisonError::into_inner)
}

fn broken() -> Status {
    Status::unavailable("the stream of questions ended before the answer came")
}

/// What a unary call would have failed with.
fn status_of(problem: proto::Problem) -> Status {
    let code = Code::from_i32(problem.code);
    let mut details = ErrorDetails::with_error_info(problem.reason, "calipers.v1", HashMap::new());
    if !problem.field.is_empty() {
        details.add_bad_request_violation(problem.field, problem.message.clone());
    }
    Status::with_error_details(code, problem.message, details)
}
