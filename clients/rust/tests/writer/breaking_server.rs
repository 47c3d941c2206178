//! A server of edit streams alone, which breaks them as planned and remembers what it applied.

use std::collections::VecDeque;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use calipers_client::proto::{self, world_service_server::WorldService, world_service_server::WorldServiceServer};
use tokio::sync::{mpsc, watch};
use tokio::task::JoinHandle;
use tokio_stream::wrappers::ReceiverStream;
use tonic::transport::{Server, server::TcpIncoming};
use tonic::{Request, Response, Status, Streaming};

/// What the server does.
#[derive(Debug, Default)]
pub(crate) struct Plan {
    /// Messages that may be unacknowledged.
    pub(crate) window: u32,
    /// After how many messages each stream in turn breaks; later ones do not.
    pub(crate) breaks_after: Vec<usize>,
}

#[derive(Debug, Default)]
struct State {
    window: u32,
    breaks_after: VecDeque<usize>,
    acked_sequence: u64,
    ticks: Vec<Vec<proto::Edit>>,
    most_unacknowledged: u64,
    refusal: Option<String>,
}

#[derive(Clone, Debug)]
struct Breaking {
    state: Arc<Mutex<State>>,
    interrupt: watch::Receiver<u32>,
}

/// A server that listens until it is stopped or dropped.
#[derive(Debug)]
pub(crate) struct BreakingServer {
    address: SocketAddr,
    state: Arc<Mutex<State>>,
    interrupt: watch::Sender<u32>,
    task: JoinHandle<()>,
}

impl BreakingServer {
    pub(crate) async fn start(plan: Plan) -> Self {
        let state = Arc::new(Mutex::new(State {
            window: plan.window,
            breaks_after: plan.breaks_after.into(),
            ..State::default()
        }));
        let (interrupt, interrupted) = watch::channel(0);
        let service = Breaking { state: Arc::clone(&state), interrupt: interrupted };
        let incoming = TcpIncoming::bind("127.0.0.1:0".parse().expect("an address")).expect("a free port");
        let address = incoming.local_addr().expect("a bound address");
        let server = Server::builder().add_service(WorldServiceServer::new(service)).serve_with_incoming(incoming);
        let task = tokio::spawn(async move { server.await.expect("the server runs") });
        Self { address, state, interrupt, task }
    }

    pub(crate) fn address(&self) -> String {
        self.address.to_string()
    }

    /// The edits of each committed tick.
    pub(crate) fn ticks(&self) -> Vec<Vec<proto::Edit>> {
        lock(&self.state).ticks.clone()
    }

    /// The most messages that a client ever left unacknowledged.
    pub(crate) fn most_unacknowledged(&self) -> u64 {
        lock(&self.state).most_unacknowledged
    }

    /// Ends the open stream, and refuses every later one.
    pub(crate) fn refuse(&self, why: &str) {
        lock(&self.state).refusal = Some(why.to_owned());
        self.interrupt.send_modify(|count| *count += 1);
    }

    /// Forgets the writer, as a server does that was started anew, and breaks the open stream.
    pub(crate) fn forget_and_break(&self) {
        lock(&self.state).acked_sequence = 0;
        self.interrupt.send_modify(|count| *count += 1);
    }

    /// Goes away, connections and all.
    pub(crate) async fn stop(self) {
        self.interrupt.send_modify(|count| *count += 1);
        self.task.abort();
        // Aborted is what it should be.
        let _ = self.task.await;
    }
}

impl Breaking {
    /// One stream, until it breaks.
    async fn serve(
        mut self,
        mut messages: Streaming<proto::EditStreamRequest>,
        answers: mpsc::Sender<Result<proto::EditStreamResponse, Status>>,
    ) {
        let (mut sequence, breaks_after) = {
            let mut state = lock(&self.state);
            (state.acked_sequence, state.breaks_after.pop_front())
        };
        let mut open_tick = Vec::new();
        // The first message, which only names the writer, is not among those that a plan counts.
        let mut received_count = 0;
        let end = loop {
            if let Some(why) = lock(&self.state).refusal.clone() {
                break Status::aborted(why);
            }
            if breaks_after.is_some_and(|count| received_count > count) {
                break Status::unavailable("broken on purpose");
            }
            let message = tokio::select! {
                _ = self.interrupt.changed() => match lock(&self.state).refusal.clone() {
                    Some(why) => break Status::aborted(why),
                    None => break Status::unavailable("interrupted on purpose"),
                },
                message = messages.message() => message,
            };
            let Ok(Some(message)) = message else { return };
            let answer = self.take(message, &mut sequence, &mut open_tick);
            received_count += 1;
            match answer {
                Ok(None) => {}
                Ok(Some(answer)) => {
                    if answers.send(Ok(answer)).await.is_err() {
                        return;
                    }
                }
                Err(status) => break status,
            }
        };
        // The client may be gone already, which is what a break means.
        let _ = answers.send(Err(end)).await;
    }

    /// One message: dropped if it is known, refused if one is missing before it, acknowledged if it ends a tick.
    fn take(
        &self,
        message: proto::EditStreamRequest,
        sequence: &mut u64,
        open_tick: &mut Vec<proto::Edit>,
    ) -> Result<Option<proto::EditStreamResponse>, Status> {
        let mut state = lock(&self.state);
        let answer = |state: &State, problems| proto::EditStreamResponse {
            acked_sequence: state.acked_sequence,
            tick: state.ticks.len() as u64,
            window: state.window,
            problems,
            ..Default::default()
        };
        if message.sequence == 0 {
            assert_eq!(message.writer, "arm", "the first message names the writer");
            return Ok(Some(answer(&state, vec![])));
        }
        if message.sequence <= *sequence {
            return Ok(None);
        }
        if message.sequence != *sequence + 1 {
            return Err(Status::aborted(format!("SEQUENCE_GAP: {} after {sequence}", message.sequence)));
        }
        *sequence = message.sequence;
        state.most_unacknowledged = state.most_unacknowledged.max(*sequence - state.acked_sequence);
        open_tick.extend(message.edits);
        if !message.commit {
            return Ok(None);
        }
        let is_wrong = |edit: &proto::Edit| matches!(&edit.op, Some(proto::edit::Op::Move(change)) if change.id == 0);
        let wrong_count = open_tick.iter().filter(|edit| is_wrong(edit)).count();
        open_tick.retain(|edit| !is_wrong(edit));
        state.ticks.push(std::mem::take(open_tick));
        state.acked_sequence = *sequence;
        let problem = proto::Problem { sequence: *sequence, reason: "OUT_OF_LIMITS".to_owned(), ..Default::default() };
        Ok(Some(answer(&state, vec![problem; wrong_count])))
    }
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes the service: the stream, and the calls that this server does not have.
macro_rules! edit_streams_alone {
    ($($rpc:ident($request:ty) -> $response:ty;)*) => {
        #[tonic::async_trait]
        impl WorldService for Breaking {
            type EditStreamStream = ReceiverStream<Result<proto::EditStreamResponse, Status>>;
            type WatchOverlapsStream = ReceiverStream<Result<proto::WatchOverlapsResponse, Status>>;
            type WatchWorldStream = ReceiverStream<Result<proto::WatchWorldResponse, Status>>;
            type ExportWorldStream = ReceiverStream<Result<proto::ExportWorldResponse, Status>>;

            async fn edit_stream(
                &self,
                request: Request<Streaming<proto::EditStreamRequest>>,
            ) -> Result<Response<Self::EditStreamStream>, Status> {
                let (answers, outgoing) = mpsc::channel(4);
                tokio::spawn(self.clone().serve(request.into_inner(), answers));
                Ok(Response::new(ReceiverStream::new(outgoing)))
            }

            $(async fn $rpc(&self, _: Request<$request>) -> Result<Response<$response>, Status> {
                Err(Status::unimplemented("this server has edit streams alone"))
            })*
        }
    };
}

edit_streams_alone! {
    edit(proto::EditRequest) -> proto::EditResponse;
    get_shape(proto::GetShapeRequest) -> proto::GetShapeResponse;
    list_shapes(proto::ListShapesRequest) -> proto::ListShapesResponse;
    describe_world(proto::DescribeWorldRequest) -> proto::DescribeWorldResponse;
    update_world(proto::UpdateWorldRequest) -> proto::UpdateWorldResponse;
    watch_overlaps(proto::WatchOverlapsRequest) -> Self::WatchOverlapsStream;
    watch_world(proto::WatchWorldRequest) -> Self::WatchWorldStream;
    explain(proto::ExplainRequest) -> proto::ExplainResponse;
    export_world(proto::ExportWorldRequest) -> Self::ExportWorldStream;
    import_world(Streaming<proto::ImportWorldRequest>) -> proto::ImportWorldResponse;
}
