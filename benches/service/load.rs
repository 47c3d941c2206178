//! What the bench asks of a server, and how fast that goes.

use std::hint::black_box;
use std::time::{Duration, Instant};

use calipers_client::{Client, ask, proto};
use proto::{query_stream_request::Request as Asked, question::Question};
use tokio::sync::mpsc;
use tokio::task::JoinSet;
use tokio_stream::wrappers::ReceiverStream;

use crate::Failure;
use crate::child::Server;

/// How the rays go over the wire.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Way {
    /// Each a call, so many at a time.
    Unary(usize),
    /// Each a message of one stream, so many unanswered.
    Stream(usize),
    /// So many a call of `Batch`.
    Batch(usize),
    /// So many a call of `RaycastBatch`.
    Columns(usize),
    /// So many a message of one stream, as columns, with eight of them unanswered.
    ColumnStream(usize),
}

impl std::fmt::Display for Way {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unary(in_flight) => write!(f, "unary, {in_flight} in flight"),
            Self::Stream(window) => write!(f, "stream, window {window}"),
            Self::Batch(size) => write!(f, "batch of {size}"),
            Self::Columns(size) => write!(f, "columns of {size}"),
            Self::ColumnStream(size) => write!(f, "stream of columns of {size}"),
        }
    }
}

/// What a run of some time gave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Figures {
    /// Rays answered in a second.
    pub(crate) rate: f64,
    /// Processor time of the server for each ray, nanoseconds.
    pub(crate) cpu_ns: f64,
}

/// Asks a server in this way for some time.
pub(crate) async fn run(
    server: &Server,
    way: Way,
    rays: &[proto::RaycastRequest],
    time: Duration,
) -> Result<Figures, Failure> {
    let client = server.client().await?;
    // Connections, caches and branch predictors warm up first.
    ask_for(&client, way, rays, time / 8).await?;
    let (cpu, began) = (server.cpu()?, Instant::now());
    let count = ask_for(&client, way, rays, time).await?;
    let (took, cpu) = (began.elapsed(), server.cpu()? - cpu);
    Ok(Figures { rate: count as f64 / took.as_secs_f64(), cpu_ns: cpu.as_nanos() as f64 / count as f64 })
}

async fn ask_for(client: &Client, way: Way, rays: &[proto::RaycastRequest], time: Duration) -> Result<u64, Failure> {
    match way {
        Way::Unary(in_flight) => unary(client, rays, in_flight, time).await.map(|times| times.len() as u64),
        Way::Stream(window) => {
            let questions: Vec<Asked> = rays
                .iter()
                .map(|ray| Asked::Question(proto::Question { question: Some(Question::Raycast(ray.clone())) }))
                .collect();
            stream(client, &questions, window, time).await
        }
        Way::ColumnStream(size) => {
            let questions: Vec<Asked> = rays.chunks(size).map(|rays| Asked::from(columns(rays))).collect();
            Ok(stream(client, &questions, 8, time).await? * size as u64)
        }
        Way::Batch(size) => {
            let batches: Vec<_> =
                rays.chunks(size).map(|rays| ask::batch(rays.iter().cloned().map(Question::Raycast))).collect();
            let began = Instant::now();
            let mut count = 0;
            for batch in batches.iter().cycle() {
                if began.elapsed() >= time {
                    break;
                }
                count += client.batch(batch.clone()).await?.answers.len() as u64;
            }
            Ok(count)
        }
        Way::Columns(size) => {
            let batches: Vec<_> = rays.chunks(size).map(columns).collect();
            by_columns(client, &batches, time).await
        }
    }
}

/// Asks the same columns again and again.
pub(crate) async fn columns_for(
    client: &Client,
    rays: &[proto::RaycastRequest],
    time: Duration,
) -> Result<u64, Failure> {
    by_columns(client, &[columns(rays)], time).await
}

async fn by_columns(client: &Client, batches: &[proto::RaycastBatchRequest], time: Duration) -> Result<u64, Failure> {
    let began = Instant::now();
    let mut count = 0;
    for batch in batches.iter().cycle() {
        if began.elapsed() >= time {
            break;
        }
        let hits = client.raycast_batch(batch.clone()).await?.hits.unwrap_or_default();
        count += hits.verdicts.len() as u64;
    }
    Ok(count)
}

/// The same rays as columns.
fn columns(rays: &[proto::RaycastRequest]) -> proto::RaycastBatchRequest {
    let numbers = |vector: Option<proto::Vec3>| {
        let vector = vector.unwrap_or_default();
        [vector.x as f32, vector.y as f32, vector.z as f32]
    };
    proto::RaycastBatchRequest {
        origins: rays.iter().flat_map(|ray| numbers(ray.origin)).collect(),
        directions: rays.iter().flat_map(|ray| numbers(ray.direction)).collect(),
        max_distances: rays[0].max_distance.map(|length| length as f32).into_iter().collect(),
        ..proto::RaycastBatchRequest::default()
    }
}

/// Asks one ray a call from as many tasks as are in flight; returns how long each call took.
pub(crate) async fn unary(
    client: &Client,
    rays: &[proto::RaycastRequest],
    in_flight: usize,
    time: Duration,
) -> Result<Vec<Duration>, Failure> {
    let began = Instant::now();
    let mut tasks = JoinSet::new();
    for task in 0..in_flight {
        let (client, rays) = (client.clone(), rays.to_vec());
        tasks.spawn(async move {
            let mut times = Vec::new();
            for ray in rays.iter().cycle().skip(task * 97) {
                if began.elapsed() >= time {
                    break;
                }
                let asked = Instant::now();
                black_box(client.raycast(ray.clone()).await?);
                times.push(asked.elapsed());
            }
            Ok::<_, calipers_client::Error>(times)
        });
    }
    let mut times = Vec::new();
    while let Some(done) = tasks.join_next().await {
        times.extend(done??);
    }
    Ok(times)
}

/// Sends messages on one stream, with at most so many unanswered; returns how many were answered.
async fn stream(client: &Client, questions: &[Asked], window: usize, time: Duration) -> Result<u64, Failure> {
    let (sender, unsent) = mpsc::channel(window);
    let answers = client.questions().query_stream(ReceiverStream::new(unsent)).await?;
    let mut answers = answers.into_inner();
    let began = Instant::now();
    let (mut sent, mut answered) = (0_u64, 0_u64);
    let mut next = questions.iter().cycle();
    loop {
        while sent - answered < window as u64 && began.elapsed() < time {
            let request = next.next().cloned();
            sent += 1;
            sender.send(proto::QueryStreamRequest { request_id: sent, request }).await?;
        }
        if sent == answered {
            return Ok(answered);
        }
        match answers.message().await? {
            Some(answer) => {
                black_box(answer);
                answered += 1;
            }
            None => return Err("the stream ended early".into()),
        }
    }
}
