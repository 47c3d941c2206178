//! What the server costs beyond the wire and the library: `cargo bench --bench service`.
//!
//! Two servers run in processes of their own: the real one, over a world of 100,000 shapes, and an echo, which says the same answer
//! to everything. Both are asked in turn, and in between the library alone, A B C A B C, which asks the same rays of the same world in
//! this process. Processor time of the servers is their own, so that what the client takes does not count. A goal is met if the
//! real server takes no more than the echo and the library together, and a ninth of that.
//!
//! `cargo bench --bench service -- --check` ends with 1 if a goal is missed; `--shapes N` and `--seconds S` change the size of the world
//! and how long each figure is measured; `--only TEXT` measures only what has it in its name.

mod child;
#[path = "../dice/mod.rs"]
mod dice;
mod echo;
mod edits;
mod load;
mod scene;

use std::error::Error;
use std::io::{Write, stdout};
use std::process::ExitCode;
use std::time::Duration;

use calipers_client::{EditWriter, edit};

use child::{Kind, Server};
use dice::Dice;
use load::{Figures, Way};
use scene::{Library, RAY_LENGTH, Scene};

type Failure = Box<dyn Error + Send + Sync>;

/// For how many times the time that is given a figure is measured.
const ROUNDS: u32 = 3;
/// Into how many parts that time is divided.
const PARTS: u32 = 5;
/// Moves of a message of the edit stream, which is one tick.
const MOVES: u64 = 1000;
/// What the real server may take of what echo and library take together.
const OF_THE_SUM: f64 = 1.0 / 0.9;
/// Calls a second of the real server, at least this part of echo's.
const OF_ECHO: f64 = 0.8;
/// What is measured besides the ways of rays.
const BESIDE: &str = "a ray beside batches of 10 ms";
const STREAMED: &str = "edit stream";
const TICKS: &str = "10,000 moves at 60 Hz, four clients ask";
/// A small question beside batches of ten milliseconds, 99 of 100.
const SMALL_P99: Duration = Duration::from_micros(150);

fn main() -> Result<ExitCode, Failure> {
    let flags: Vec<String> = std::env::args().skip(1).collect();
    let has = |flag: &str| flags.iter().any(|given| given == flag);
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    for kind in [Kind::Echo, Kind::Real] {
        if has(kind.flag()) {
            runtime.block_on(child::serve(kind))?;
            return Ok(ExitCode::SUCCESS);
        }
    }
    // `cargo bench` hands over --bench; without it this is `cargo test --benches`, which wants no figures.
    if !has("--bench") {
        return Ok(ExitCode::SUCCESS);
    }
    let number = |flag: &str, default: f64| -> Result<f64, Failure> {
        let place = flags.iter().position(|given| given == flag);
        let given = place.and_then(|place| flags.get(place + 1));
        Ok(given.map_or(Ok(default), |given| given.parse())?)
    };
    let shape_count = number("--shapes", 100_000.0)? as u64;
    let time = Duration::from_secs_f64(number("--seconds", 2.0)?);
    let only = flags.iter().position(|given| given == "--only").and_then(|place| flags.get(place + 1));
    let only = only.map_or("", String::as_str);
    let missed = runtime.block_on(run(shape_count, time, only))?;
    let fails = has("--check") && missed > 0;
    Ok(if fails { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

/// Prints all figures; returns how many goals were missed.
async fn run(shape_count: u64, time: Duration, only: &str) -> Result<usize, Failure> {
    let mut out = stdout();
    let mut dice = Dice(7);
    let scene = Scene::new(shape_count, &mut dice);
    let rays = scene.rays(8192, &mut dice);
    let library = scene.library(&rays)?;
    let (alone, hit_share) = library.ray(time)?;
    writeln!(
        out,
        "{shape_count} shapes in a cube of {:.1} m, rays of {RAY_LENGTH} m, {:.0} % hit\n",
        scene.side,
        100.0 * hit_share
    )?;
    let (echo, real) = (Server::start(Kind::Echo)?, Server::start(Kind::Real)?);
    scene.fill(&real.client().await?).await?;
    let mut missed = 0;
    let mut judge = |is_met: bool| {
        missed += usize::from(!is_met);
        if is_met { "met" } else { "missed" }
    };
    writeln!(
        out,
        "| rays by | echo/s | server/s | library ns | echo CPU ns | server CPU ns | goal | |\n|---|---|---|---|---|---|---|---|"
    )?;
    let ways = [
        Way::Unary(1),
        Way::Unary(16),
        Way::Stream(128),
        Way::Batch(256),
        Way::Batch(1024),
        Way::Columns(1024),
        Way::Columns(4096),
        Way::ColumnStream(64),
        Way::ColumnStream(1024),
    ];
    for way in ways.into_iter().filter(|way| way.to_string().contains(only)) {
        let (of_echo, of_real, library_ns) = all(&echo, &real, &library, (way, &rays), time).await?;
        let most = (of_echo.cpu_ns + library_ns) * OF_THE_SUM;
        let (goal, verdict) = match way {
            Way::Unary(_) => {
                let least = of_echo.rate * OF_ECHO;
                (format!("{least:.0}/s"), judge(of_real.rate >= least))
            }
            _ => (format!("{most:.0} ns"), judge(of_real.cpu_ns <= most)),
        };
        writeln!(
            out,
            "| {way} | {:.0} | {:.0} | {library_ns:.0} | {:.0} | {:.0} | {goal} | {verdict} |",
            of_echo.rate, of_real.rate, of_echo.cpu_ns, of_real.cpu_ns
        )?;
    }
    if BESIDE.contains(only) {
        let mut small = Duration::MAX;
        for _ in 0..ROUNDS {
            small = small.min(beside_batches(&real, &rays, alone, time).await?);
        }
        let verdict = judge(small <= SMALL_P99);
        let (small, most) = (small.as_micros(), SMALL_P99.as_micros());
        writeln!(out, "\n{BESIDE}: p99 {small} µs, goal {most} µs: {verdict}")?;
    }
    if STREAMED.contains(only) {
        let moves = streamed(&real, &scene, &mut dice, time).await?;
        writeln!(out, "{STREAMED}, {MOVES} moves a tick: {moves:.0} moves/s")?;
    }
    if TICKS.contains(only) {
        beside_questions(&mut out, &real, &scene, &rays, &mut dice, time).await?;
    }
    Ok(missed)
}

/// Of many short rounds, one after the other, the middle one of each: of echo, of the real server, and nanoseconds of the library alone.
/// What else the machine does changes from one second to the next, and meets all three alike so.
async fn all(
    echo: &Server,
    real: &Server,
    library: &Library,
    (way, rays): (Way, &[calipers_client::proto::RaycastRequest]),
    time: Duration,
) -> Result<(Figures, Figures, f64), Failure> {
    let time = time / PARTS;
    let (mut of_echo, mut of_real, mut of_library) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..ROUNDS * PARTS {
        of_echo.push(load::run(echo, way, rays, time).await?);
        of_real.push(load::run(real, way, rays, time).await?);
        of_library.push(library.ray(time)?.0.as_nanos() as f64);
    }
    let of = |figures: &[Figures]| Figures {
        rate: middle(figures.iter().map(|figures| figures.rate)),
        cpu_ns: middle(figures.iter().map(|figures| figures.cpu_ns)),
    };
    Ok((of(&of_echo), of(&of_real), middle(of_library.into_iter())))
}

/// The one in the middle; there is one at least.
fn middle(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_unstable_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// How long 99 of 100 single rays take while another client asks batches of ten milliseconds.
async fn beside_batches(
    real: &Server,
    rays: &[calipers_client::proto::RaycastRequest],
    library: Duration,
    time: Duration,
) -> Result<Duration, Failure> {
    let size = (Duration::from_millis(10).as_nanos() / library.as_nanos().max(1)) as usize;
    let many: Vec<_> = rays.iter().cycle().take(size).cloned().collect();
    let beside = real.client().await?;
    let heavy = tokio::spawn(async move { load::columns_for(&beside, &many, time).await });
    let client = real.client().await?;
    let mut times = load::unary(&client, rays, 1, time).await?;
    heavy.await??;
    times.sort_unstable();
    Ok(times[times.len() * 99 / 100])
}

/// Prints what ticks of moves take while others ask.
async fn beside_questions(
    out: &mut impl Write,
    real: &Server,
    scene: &Scene,
    rays: &[calipers_client::proto::RaycastRequest],
    dice: &mut Dice,
    time: Duration,
) -> Result<(), Failure> {
    writeln!(
        out,
        "\n| {TICKS} | acknowledged p50 | p99 | rays p50 | p99 | server CPU a tick |\n|---|---|---|---|---|---|"
    )?;
    for (name, form) in [("as columns", edits::Form::Columns), ("each an edit", edits::Form::Nested)] {
        let figures = edits::run(real, scene, (form, rays), dice, time * ROUNDS).await?;
        let of = |times: &[Duration], percent| edits::percentile(times, percent).as_secs_f64() * 1e3;
        let (acknowledged, answered) = (&figures.acknowledged, &figures.answered);
        writeln!(
            out,
            "| {name} | {:.2} ms | {:.2} ms | {:.2} ms | {:.2} ms | {:.2} ms |",
            of(acknowledged, 50),
            of(acknowledged, 99),
            of(answered, 50),
            of(answered, 99),
            figures.cpu.as_secs_f64() * 1e3
        )?;
    }
    Ok(())
}

/// Moves shapes over the stream as fast as it is acknowledged; returns moves a second.
async fn streamed(real: &Server, scene: &Scene, dice: &mut Dice, time: Duration) -> Result<f64, Failure> {
    let ticks: Vec<Vec<_>> = (0..16)
        .map(|tick| (0..MOVES).map(|index| edit::move_to(1 + tick * MOVES + index, dice.point(scene.side))).collect())
        .collect();
    let mut writer = EditWriter::open(&real.client().await?, "movers").await?;
    let began = std::time::Instant::now();
    let mut tick_count = 0;
    for moves in ticks.iter().cycle() {
        if began.elapsed() >= time {
            break;
        }
        writer.commit(moves.iter().cloned()).await?;
        tick_count += 1;
    }
    writer.flush().await?;
    let took = began.elapsed().as_secs_f64();
    match writer.take_report().problems.first() {
        Some(problem) => Err(problem.message.clone().into()),
        None => Ok(f64::from(tick_count) * MOVES as f64 / took),
    }
}
