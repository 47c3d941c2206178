//! What a server answers in a second, over a real socket: `cargo bench --bench service`.
//!
//! The world has 10,000 shapes (half boxes, a quarter spheres, a quarter capsules, 0.2 to 2 m, about 5 % of the space
//! filled), rays are 10 m long. Client and server share this machine's cores, so the figures are those of both.

mod dice;

use std::error::Error;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::io::{Write, stdout};
use std::time::{Duration, Instant};

use calipers::{config::Settings, serve};
use calipers_client::{Client, EditWriter, ask, edit, proto, shape};
use dice::Dice;
use proto::question::Question;
use tokio::task::JoinSet;

type Failure = Box<dyn Error + Send + Sync>;

const SHAPE_COUNT: u64 = 10_000;
const RAY_LENGTH: f64 = 10.0;
/// Rays of a batch.
const BATCH: usize = 1024;
/// Moves of a message of the edit stream, which is one tick.
const MOVES: u64 = 1000;
/// Volume of a sphere of radius 1.
const SPHERE: f64 = 2.0 * TAU / 3.0;
/// How long each figure is measured, after a tenth of it to warm up.
const MEASURED: Duration = Duration::from_secs(4);

fn main() -> Result<(), Failure> {
    // `cargo bench` hands over --bench; without it this is `cargo test --benches`, which wants no figures.
    if !std::env::args().any(|flag| flag == "--bench") {
        return Ok(());
    }
    tokio::runtime::Builder::new_multi_thread().enable_all().build()?.block_on(run())
}

async fn run() -> Result<(), Failure> {
    let settings = Settings { listen: "127.0.0.1:0".parse()?, ..Settings::default() };
    let running = serve::start(settings).await?;
    let client = Client::connect(&running.local_addr().to_string()).await?;
    let mut dice = Dice(7);
    let side = fill(&client, &mut dice).await?;
    let rays: Vec<proto::RaycastRequest> = (0..4096).map(|_| dice.ray(side)).collect();

    let mut hit_count = 0;
    for ray in &rays[..1000] {
        hit_count += usize::from(!client.raycast(ray.clone()).await?.hits.is_empty());
    }
    let mut out = stdout();
    writeln!(out, "{SHAPE_COUNT} shapes in a cube of {side:.1} m; {} % of the rays hit", hit_count / 10)?;
    for in_flight in [1, 16] {
        let mut times = unary(&client, &rays, in_flight).await?;
        let rate = times.len() as f64 / MEASURED.as_secs_f64();
        times.sort_unstable();
        let at = |share: f64| times[(share * (times.len() - 1) as f64) as usize].as_secs_f64() * 1e6;
        let (p50, p99) = (at(0.5), at(0.99));
        writeln!(out, "unary raycast, {in_flight:2} in flight: {rate:9.0}/s  p50 {p50:7.0} µs  p99 {p99:7.0} µs")?;
    }
    let (batches, p50) = batched(&client, &rays).await?;
    let rays_rate = batches * BATCH as f64;
    writeln!(out, "batch of {BATCH} raycasts:   {rays_rate:9.0} rays/s  {batches:.0} batches/s  p50 {p50:.2} ms")?;
    let (edits, ticks) = streamed(&client, side, &mut dice).await?;
    writeln!(out, "edit stream, {MOVES} moves a tick: {edits:9.0} moves/s  {ticks:.0} ticks/s")?;
    running.stop().await;
    Ok(())
}

/// Fills a cube about the origin, and returns its side: the volume of the shapes is about 5 % of it.
async fn fill(client: &Client, dice: &mut Dice) -> Result<f64, Failure> {
    let mut shapes = Vec::new();
    let mut volume = 0.0;
    for id in 1..=SHAPE_COUNT {
        // Sizes from 0.2 to 2 m are those of the whole shape.
        let half = |dice: &mut Dice| dice.between(0.1, 1.0);
        let (form, size) = match id % 4 {
            0 | 1 => {
                let [x, y, z] = [half(dice), half(dice), half(dice)];
                (shape::cuboid(id, [x, y, z]), 8.0 * x * y * z)
            }
            2 => {
                let radius = half(dice);
                (shape::sphere(id, radius), SPHERE * radius.powi(3))
            }
            _ => {
                let radius = 0.5 * half(dice);
                let half_height = half(dice) - 0.09;
                (shape::capsule(id, half_height, radius), (TAU * half_height + SPHERE * radius) * radius.powi(2))
            }
        };
        volume += size;
        shapes.push(form);
    }
    let side = (volume / 0.05).cbrt();
    let inserts = shapes.into_iter().map(|form| form.at(dice.point(side)).rotated(dice.rotation()).insert());
    client.edit(inserts.collect::<Vec<_>>()).await?;
    Ok(side)
}

/// Asks one ray a call from as many tasks as are in flight; returns how long each call took.
async fn unary(client: &Client, rays: &[proto::RaycastRequest], in_flight: usize) -> Result<Vec<Duration>, Failure> {
    let begin = Instant::now() + MEASURED / 10;
    let mut tasks = JoinSet::new();
    for task in 0..in_flight {
        let (client, rays) = (client.clone(), rays.to_vec());
        tasks.spawn(async move {
            let mut times = Vec::new();
            for ray in rays.iter().cycle().skip(task * 97) {
                let asked = Instant::now();
                if asked >= begin + MEASURED {
                    break;
                }
                black_box(client.raycast(ray.clone()).await?);
                if asked >= begin {
                    times.push(asked.elapsed());
                }
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

/// Asks a batch a call, one after the other; returns batches a second and the median time of one in milliseconds.
async fn batched(client: &Client, rays: &[proto::RaycastRequest]) -> Result<(f64, f64), Failure> {
    let batch = ask::batch(rays[..BATCH].iter().cloned().map(Question::Raycast));
    client.batch(batch.clone()).await?;
    let mut times = Vec::new();
    let began = Instant::now();
    while began.elapsed() < MEASURED {
        let asked = Instant::now();
        let answer = client.batch(batch.clone()).await?;
        if answer.answers.len() != BATCH {
            return Err(format!("{} answers to {BATCH} questions", answer.answers.len()).into());
        }
        times.push(asked.elapsed());
    }
    let rate = times.len() as f64 / began.elapsed().as_secs_f64();
    times.sort_unstable();
    Ok((rate, times[times.len() / 2].as_secs_f64() * 1e3))
}

/// Moves shapes over the stream as fast as it is acknowledged; returns moves and ticks a second.
async fn streamed(client: &Client, side: f64, dice: &mut Dice) -> Result<(f64, f64), Failure> {
    let ticks: Vec<Vec<proto::Edit>> = (0..16)
        .map(|tick| {
            let ids = (0..MOVES).map(|index| 1 + (tick * MOVES + index) % SHAPE_COUNT);
            ids.map(|id| edit::move_to(id, dice.point(side))).collect()
        })
        .collect();
    let mut writer = EditWriter::open(client, "bench").await?;
    let began = Instant::now();
    let mut tick_count = 0;
    for moves in ticks.iter().cycle() {
        if began.elapsed() >= MEASURED {
            break;
        }
        writer.commit(moves.iter().cloned()).await?;
        tick_count += 1;
    }
    writer.flush().await?;
    let ticks_rate = f64::from(tick_count) / began.elapsed().as_secs_f64();
    match writer.take_report().problems.first() {
        Some(problem) => Err(problem.message.clone().into()),
        None => Ok((ticks_rate * MOVES as f64, ticks_rate)),
    }
}

impl Dice {
    /// Not evenly spread over all rotations, but over many.
    fn rotation(&mut self) -> [f64; 4] {
        std::array::from_fn(|_| self.between(-1.0, 1.0))
    }

    fn ray(&mut self, side: f64) -> proto::RaycastRequest {
        let direction = std::array::from_fn(|_| self.between(-1.0, 1.0));
        let mut ray = ask::ray(self.point(side), direction);
        ray.max_distance = Some(RAY_LENGTH);
        ray
    }
}
