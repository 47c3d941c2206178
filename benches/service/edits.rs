//! What edits take beside questions: a client moves shapes 60 times a second while four others ask rays.

use std::time::{Duration, Instant};

use calipers_client::{Client, EditWriter, edit, proto};
use tokio::task::JoinSet;
use tokio::time::{MissedTickBehavior, interval};

use crate::Failure;
use crate::child::Server;
use crate::dice::Dice;
use crate::scene::Scene;

/// Moves of a tick.
const MOVES: usize = 10_000;
/// How far a shape goes in a tick at most, along each axis, metres.
const STEP: f64 = 0.1;
/// Different ticks, which come again and again.
const TICKS: usize = 4;
/// Between two ticks.
const TICK: Duration = Duration::from_nanos(16_666_667);
/// Clients that ask.
const ASKERS: usize = 4;
/// Between two rays of one of them.
const PAUSE: Duration = Duration::from_millis(1);

/// How the moves go over the wire.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Form {
    /// All of a tick as columns.
    Columns,
    /// Each an edit of its own.
    Nested,
}

/// What it took.
#[derive(Debug)]
pub(crate) struct Figures {
    /// From sending a tick to its acknowledgement, in ascending order.
    pub(crate) acknowledged: Vec<Duration>,
    /// From asking a ray to its answer, in ascending order.
    pub(crate) answered: Vec<Duration>,
    /// Processor time of the server for each tick and the rays meanwhile.
    pub(crate) cpu: Duration,
}

/// That of which so many of a hundred are below, of what ascends.
pub(crate) fn percentile(ascending: &[Duration], percent: usize) -> Duration {
    ascending.get(ascending.len() * percent / 100).copied().unwrap_or_default()
}

/// Moves and asks for some time.
pub(crate) async fn run(
    server: &Server,
    scene: &Scene,
    (form, rays): (Form, &[proto::RaycastRequest]),
    dice: &mut Dice,
    time: Duration,
) -> Result<Figures, Failure> {
    let ticks: Vec<Vec<proto::Edit>> = (0..TICKS).map(|_| moves(form, scene, dice)).collect();
    let (cpu, began) = (server.cpu()?, Instant::now());
    let mut askers = JoinSet::new();
    for asker in 0..ASKERS {
        let (client, rays) = (server.client().await?, rays.to_vec());
        askers.spawn(async move { ask(&client, rays.iter().cycle().skip(asker * 97), began, time).await });
    }
    let mut writer = EditWriter::open(&server.client().await?, "movers").await?;
    let (mut acknowledged, mut at) = (Vec::new(), paced(TICK));
    for edits in ticks.iter().cycle() {
        if began.elapsed() >= time {
            break;
        }
        let edits = edits.clone();
        at.tick().await;
        let sent = Instant::now();
        writer.commit(edits).await?;
        writer.flush().await?;
        acknowledged.push(sent.elapsed());
    }
    if let Some(problem) = writer.take_report().problems.first() {
        return Err(problem.message.clone().into());
    }
    let mut answered = Vec::new();
    while let Some(done) = askers.join_next().await {
        answered.extend(done??);
    }
    let cpu = (server.cpu()? - cpu) / u32::try_from(acknowledged.len().max(1))?;
    acknowledged.sort_unstable();
    answered.sort_unstable();
    Ok(Figures { acknowledged, answered, cpu })
}

/// Asks a ray now and then; returns how long each took.
async fn ask<'a>(
    client: &Client,
    rays: impl Iterator<Item = &'a proto::RaycastRequest>,
    began: Instant,
    time: Duration,
) -> Result<Vec<Duration>, calipers_client::Error> {
    let (mut times, mut at) = (Vec::new(), paced(PAUSE));
    for ray in rays {
        if began.elapsed() >= time {
            break;
        }
        at.tick().await;
        let asked = Instant::now();
        client.raycast(ray.clone()).await?;
        times.push(asked.elapsed());
    }
    Ok(times)
}

fn paced(period: Duration) -> tokio::time::Interval {
    let mut at = interval(period);
    at.set_missed_tick_behavior(MissedTickBehavior::Delay);
    at
}

/// A tick that puts the first shapes near where they were at the beginning.
fn moves(form: Form, scene: &Scene, dice: &mut Dice) -> Vec<proto::Edit> {
    let places: Vec<(u64, [f64; 3])> = scene.places().take(MOVES).map(|(id, place)| (id, near(place, dice))).collect();
    match form {
        Form::Nested => places.into_iter().map(|(id, place)| edit::move_to(id, place)).collect(),
        Form::Columns => {
            let positions = places.iter().flat_map(|(_, place)| place.map(|number| number as f32)).collect();
            let moves = proto::MoveColumns {
                ids: places.iter().map(|(id, _)| *id).collect(),
                poses: Some(proto::PoseColumns { positions, ..proto::PoseColumns::default() }),
                ..proto::MoveColumns::default()
            };
            vec![proto::Edit { op: Some(proto::edit::Op::Moves(moves)) }]
        }
    }
}

/// Singles, so that columns say the same.
fn near(place: [f64; 3], dice: &mut Dice) -> [f64; 3] {
    place.map(|number| f64::from((number + dice.between(-0.5 * STEP, 0.5 * STEP)) as f32))
}
