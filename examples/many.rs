//! One world, used by many: two writers and three readers on one session, each with a connection and a token of its own.
//!
//! ```text
//! cargo run --release --example many                  # starts a server of its own
//! cargo run --release --example many 127.0.0.1:7070   # uses one that runs
//! ```
//!
//! Every writer moves its row of spheres with each commit: after its k-th commit all of them are k steps along x. Each
//! commit is one tick, so at every tick T the two rows satisfy k_a + k_b = T - (the tick at which it began). The readers
//! ask without pause and check that law on whatever tick they get, for all spheres: a reader that ever saw half a tick,
//! an edit too early or one too late would find a sphere out of step.

use std::error::Error;
use std::io::Write;
use std::time::Duration;

use calipers_client::{Client, EditWriter, ask, edit, proto, shape};
use tokio::task::JoinSet;
use tokio::time::{MissedTickBehavior, interval};

/// Any error, of any task.
pub(crate) type Failure = Box<dyn Error + Send + Sync>;

const WRITERS: [&str; 2] = ["a", "b"];
const READER_COUNT: usize = 3;
/// Spheres of each writer.
const ROW_LENGTH: u64 = 8;
const RADIUS: f64 = 0.25;
/// Metres along x with each commit: a power of two, so that positions and distances are exact and can be compared.
const STEP: f64 = 1.0 / 64.0;
/// Where along x the readers measure distances from.
const GAUGE: f64 = -1.0;

/// How much is done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    /// Commits of each writer.
    pub(crate) commit_count: u64,
    /// Commits a second of each writer.
    pub(crate) rate: f64,
}

/// What the readers saw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Seen {
    /// Answers that were checked, of all readers.
    pub(crate) answer_count: u64,
    /// Different ticks that the reader with the fewest saw.
    pub(crate) tick_count: u64,
    /// The tick that every reader saw last.
    pub(crate) last_tick: u64,
}

#[tokio::main]
async fn main() -> Result<(), Failure> {
    let plan = Plan { commit_count: 300, rate: 30.0 };
    let mut out = std::io::stdout();
    let (address, own) = match std::env::args().nth(1) {
        Some(address) => (address, None),
        None => {
            let settings = calipers::config::Settings { listen: "127.0.0.1:0".parse()?, ..Default::default() };
            let running = calipers::serve::start(settings).await?;
            (running.local_addr().to_string(), Some(running))
        }
    };
    writeln!(out, "two writers at {} Hz and three readers on {address}", plan.rate)?;
    let Seen { answer_count, tick_count, last_tick } = run(&address, plan).await?;
    writeln!(out, "{answer_count} answers, every one in step with what was written")?;
    writeln!(out, "each reader saw {tick_count} ticks at least, and all of them the last, {last_tick}")?;
    if let Some(running) = own {
        running.stop().await;
    }
    Ok(())
}

/// Runs writers and readers to their end, over real sockets.
///
/// # Errors
/// What the server refuses, and the first answer that is out of step.
pub(crate) async fn run(address: &str, plan: Plan) -> Result<Seen, Failure> {
    let owner = Client::connect(address).await?.open_session(proto::CreateSessionRequest::default()).await?;
    let began = owner.describe_world(proto::DescribeWorldRequest::default()).await?.tick;
    let mut writers = JoinSet::new();
    for (index, name) in WRITERS.into_iter().enumerate() {
        let client = guest(address, &owner, proto::Role::Writer).await?;
        writers.spawn(write(client, name, index as u64, plan));
    }
    let end = began + WRITERS.len() as u64 * plan.commit_count;
    let mut readers = JoinSet::new();
    for _ in 0..READER_COUNT {
        readers.spawn(read(guest(address, &owner, proto::Role::Reader).await?, began, end));
    }
    while let Some(done) = writers.join_next().await {
        done??;
    }
    let mut seen = Seen { answer_count: 0, tick_count: u64::MAX, last_tick: end };
    while let Some(done) = readers.join_next().await {
        let Seen { answer_count, tick_count, .. } = done??;
        seen.answer_count += answer_count;
        seen.tick_count = seen.tick_count.min(tick_count);
    }
    owner.delete_session(proto::DeleteSessionRequest::default()).await?;
    Ok(seen)
}

/// A client with a connection of its own, which may do no more than its role.
async fn guest(address: &str, owner: &Client, role: proto::Role) -> Result<Client, Failure> {
    let request = proto::CreateTokenRequest { role: role.into(), ..Default::default() };
    let token = owner.create_token(request).await?.token;
    let client = Client::connect(address).await?.with_session(owner.session()).with_deadline(Duration::from_secs(10));
    Ok(client.with_token(&token)?)
}

/// The id of a sphere.
fn id(writer: u64, place: u64) -> u64 {
    1 + writer * ROW_LENGTH + place
}

/// Where a sphere is after its writer's k-th commit: what is agreed between writers and readers.
fn position(writer: u64, place: u64, commit: u64) -> [f64; 3] {
    [STEP * commit as f64, 4.0 * writer as f64, place as f64]
}

/// Puts a row in with the first commit, and moves it with every further one.
async fn write(client: Client, name: &'static str, index: u64, plan: Plan) -> Result<(), Failure> {
    let mut writer = EditWriter::open(&client, name).await?;
    let mut due = interval(Duration::from_secs_f64(1.0 / plan.rate));
    due.set_missed_tick_behavior(MissedTickBehavior::Delay);
    for commit in 1..=plan.commit_count {
        due.tick().await;
        let row = (0..ROW_LENGTH).map(|place| {
            let at = position(index, place, commit);
            if commit == 1 {
                shape::sphere(id(index, place), RADIUS).at(at).insert()
            } else {
                edit::move_to(id(index, place), at)
            }
        });
        writer.commit(row.collect::<Vec<_>>()).await?;
    }
    writer.flush().await?;
    match writer.take_report().problems.first() {
        Some(problem) => Err(format!("writer {name}: {}", problem.message).into()),
        None => Ok(()),
    }
}

/// Reads until the last tick, and checks every answer.
async fn read(client: Client, began: u64, end: u64) -> Result<Seen, Failure> {
    let mut seen = Seen::default();
    let mut last = began;
    while last < end {
        // Waits for a tick that it has not seen, and takes the newest there is.
        let wanted = last + 1;
        let tick = check_places(&client, wanted, began).await?;
        if tick < wanted {
            return Err(format!("tick {wanted} was asked for, and {tick} answered").into());
        }
        let measured = check_distances(&client, tick, began).await?;
        if measured < tick {
            return Err(format!("tick {tick} was asked for, and {measured} answered").into());
        }
        seen.answer_count += 2;
        seen.tick_count += 1 + u64::from(measured > tick);
        last = measured;
    }
    seen.last_tick = last;
    Ok(seen)
}

/// Lists all shapes, and holds their positions to what was written.
async fn check_places(client: &Client, min_tick: u64, began: u64) -> Result<u64, Failure> {
    let request = proto::ListShapesRequest { read_at: ask::seeing_tick(min_tick).read_at, ..Default::default() };
    let answer = client.list_shapes(request).await?;
    let tick = answer.info.ok_or("the answer names no tick")?.tick;
    let mut steps = [0; WRITERS.len()];
    for writer in 0..WRITERS.len() as u64 {
        let of_writer = |shape: &&proto::Shape| (id(writer, 0)..id(writer + 1, 0)).contains(&shape.id);
        let row: Vec<&proto::Shape> = answer.shapes.iter().filter(of_writer).collect();
        let Some(first) = row.first() else { continue };
        let steps_of = |shape: &proto::Shape| shape.pose.and_then(|pose| pose.position).unwrap_or_default().x / STEP;
        let commit = steps_of(first) as u64;
        for (place, shape) in (0..ROW_LENGTH).zip(&row) {
            let at = shape.pose.and_then(|pose| pose.position).unwrap_or_default();
            if shape.id != id(writer, place) || [at.x, at.y, at.z] != position(writer, place, commit) {
                return Err(format!("tick {tick}: shape {} is at {at:?} after commit {commit}", shape.id).into());
            }
        }
        if row.len() as u64 != ROW_LENGTH {
            return Err(format!("tick {tick}: {} of {ROW_LENGTH} shapes of a row are there", row.len()).into());
        }
        steps[writer as usize] = commit;
    }
    in_step(tick, began, steps)
}

/// Measures how far every sphere is, and holds the distances to what was written.
async fn check_distances(client: &Client, min_tick: u64, began: u64) -> Result<u64, Failure> {
    let spheres = || (0..WRITERS.len() as u64).flat_map(|writer| (0..ROW_LENGTH).map(move |place| (writer, place)));
    let question = |(writer, place)| {
        let [_, y, z] = position(writer, place, 0);
        let mut question = ask::distance(ask::point([GAUGE, y, z]));
        question.against = Some(Box::new(ask::shape(id(writer, place))));
        question.options = Some(ask::exactly());
        proto::question::Question::Distance(Box::new(question))
    };
    let mut batch = ask::batch(spheres().map(question));
    batch.options = Some(ask::seeing_tick(min_tick));
    let answer = client.batch(batch).await?;
    let tick = answer.info.ok_or("the answer names no tick")?.tick;
    let mut commits = [None; WRITERS.len()];
    for ((writer, place), answer) in spheres().zip(&answer.answers) {
        let commit = match &answer.answer {
            Some(proto::answer::Answer::Distance(answer)) => {
                let distance = answer.hits.first().and_then(|hit| hit.distance);
                let distance = distance.ok_or_else(|| format!("tick {tick}: no distance to {}", id(writer, place)))?;
                (distance + GAUGE + RADIUS) / STEP
            }
            // Before the first commit of its writer, a shape is not there.
            Some(proto::answer::Answer::Problem(problem)) if problem.reason == "SHAPE_NOT_FOUND" => 0.0,
            other => return Err(format!("tick {tick}: {other:?} is no distance").into()),
        };
        if *commits[writer as usize].get_or_insert(commit) != commit {
            return Err(format!("tick {tick}: shape {} is {commit} steps on, its row is not", id(writer, place)).into());
        }
    }
    let whole = |commit: Option<f64>| commit.unwrap_or_default();
    if commits.iter().any(|commit| whole(*commit).fract() != 0.0) {
        return Err(format!("tick {tick}: {commits:?} steps are no whole numbers").into());
    }
    in_step(tick, began, commits.map(|commit| whole(commit) as u64))
}

/// Every commit is one tick.
fn in_step(tick: u64, began: u64, steps: [u64; WRITERS.len()]) -> Result<u64, Failure> {
    if began + steps.iter().sum::<u64>() == tick {
        Ok(tick)
    } else {
        Err(format!("tick {tick} is out of step: the rows are {steps:?} commits on from tick {began}").into())
    }
}
