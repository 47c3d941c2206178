//! A level with a few hundred moving shapes that the program makes itself, to try things on.
//!
//! It is an ordinary client of the server in the same process: what it does, any client can do over the network. The
//! level and the ways of the shapes are made from one number, so that the same number makes the same demo.
//!
//! # Never
//! It decides no collision itself: balls ask the server what they hit.

mod balls;
mod dice;
mod floor_plan;
mod ground;
mod level;
mod movers;
mod walker;

use std::net::SocketAddr;
use std::time::Duration;

use calipers::config::Settings;
use calipers::serve::Running;
use calipers_client::{Client, EditWriter, proto};
use tokio::sync::watch;
use tokio::task::JoinHandle;
use tokio::time::{MissedTickBehavior, interval};

use self::dice::Dice;
use self::floor_plan::FloorPlan;
use self::movers::Movers;
use super::Failure;

/// Ticks a second.
const TICK_RATE: f64 = 30.0;
/// The session of a server that has no open one.
const SESSION: &str = "demo";
/// No call of the demo should take longer.
const DEADLINE: Duration = Duration::from_secs(10);

/// The demo that runs.
#[derive(Debug)]
pub(crate) struct Demo {
    mover_count: usize,
    level_count: usize,
    /// The demo's session and a token for it, where `default` is not open.
    key: Option<(String, String)>,
    stop: watch::Sender<bool>,
    task: JoinHandle<()>,
}

/// Makes the level in a server's world, and begins to move what moves.
///
/// # Errors
/// What the server refuses.
pub(crate) async fn start(running: &Running, settings: &Settings, seed: u64) -> Result<Demo, Failure> {
    let mut client = Client::from_channel(running.connect_in_process()).with_deadline(DEADLINE);
    let mut key = None;
    if !settings.has_default_session() {
        let request = proto::CreateSessionRequest { session: SESSION.to_owned(), ..Default::default() };
        let made = client.create_session(request).await?;
        client = client.with_session(SESSION).with_token(&made.token)?;
        key = Some((SESSION.to_owned(), made.token));
    }
    let mut dice = Dice::new(seed);
    let plan = FloorPlan::new(&mut dice);
    let mut writer = EditWriter::open(&client, "demo").await?;
    let fixed = level::make(&client, &plan, &mut dice).await?;
    let level_count = fixed.len();
    let movers = Movers::new(&plan, &mut dice);
    let moving = movers.inserts();
    let mover_count = moving.len();
    writer.commit(fixed.into_iter().chain(moving)).await?;
    writer.flush().await?;
    if let Some(problem) = writer.take_report().problems.first() {
        return Err(Failure::new(format!("the server refused a part of the demo: {}", problem.message)));
    }
    let (stop, stopped) = watch::channel(false);
    let task = tokio::spawn(run(client, writer, movers, stopped));
    Ok(Demo { mover_count, level_count, key, stop, task })
}

impl Demo {
    /// What there is to see, and lines that can be pasted. The ray hits whatever happens: a floor is below it.
    pub(crate) fn about(&self, address: SocketAddr) -> String {
        let header = self.key.as_ref().map(|(_, token)| format!(" -H 'authorization: Bearer {token}'"));
        let header = header.unwrap_or_default();
        let session = self.key.as_ref().map(|(session, _)| format!(r#""session":"{session}","#)).unwrap_or_default();
        let flags = self.key.as_ref().map(|(session, token)| format!(" --session {session} --token {token}"));
        let flags = flags.unwrap_or_default();
        let ray = format!(r#"{{{session}"origin":{{"x":5,"y":20,"z":5}},"direction":{{"y":-1}}}}"#);
        format!(
            "{}\n{} shapes stand still, {} move at {TICK_RATE} Hz. Ask what a ray from above hits:\n  grpcurl \
             -plaintext{header} -d '{ray}' {address} calipers.v1.QueryService/Raycast\n  calipers raycast 5,20,5 \
             0,-1,0 --server {address}{flags}",
            level::ABOUT,
            self.level_count,
            self.mover_count
        )
    }

    /// Stops moving; the shapes stay where they are.
    pub(crate) async fn stop(self) {
        // An error means that the task has ended by itself, which its log line told.
        let _ = self.stop.send(true);
        let _ = self.task.await;
    }
}

/// Moves everything, tick after tick, until it is stopped.
async fn run(client: Client, mut writer: EditWriter, mut movers: Movers, mut stop: watch::Receiver<bool>) {
    let mut due = interval(Duration::from_secs_f64(1.0 / TICK_RATE));
    // A late tick is left out: catching up would make everything run.
    due.set_missed_tick_behavior(MissedTickBehavior::Skip);
    loop {
        tokio::select! {
            _ = stop.changed() => break,
            _ = due.tick() => {}
        }
        let moved = match movers.step(&client, 1.0 / TICK_RATE).await {
            Ok(moves) => writer.commit(moves).await,
            Err(error) => Err(error),
        };
        if let Err(error) = moved {
            tracing::error!(%error, "the demo no longer moves");
            return;
        }
        for problem in writer.take_report().problems {
            tracing::warn!(message = problem.message, "the server left a move of the demo out");
        }
    }
    if let Err(error) = writer.close().await {
        tracing::warn!(%error, "the demo's last moves were lost");
    }
}
