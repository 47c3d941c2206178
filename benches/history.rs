//! What the past of a world costs, in memory and in time: `cargo bench --bench history`.
//!
//! Worlds of 10,000 spheres and of 10,000 boxes, of 0.2 to 2 m, that fill about 5 % of the space; each tick moves another
//! 1,000 of them by 0.1 m and turns them a little. Memory is what `describe` says of it. Questions are closest hits of rays
//! of 10 m and overlaps of a ball of 2 m: the same ones at the newest tick, 32 ticks before and half a tick after that,
//! by turns, so that a slow moment of the machine meets them all. The first question to a time, which prepares the ticks
//! around it, is timed alone, and so is the next, which finds them ready.

mod dice;
mod traffic;

use std::{
    error::Error,
    hint::black_box,
    io::{Write, stdout},
    sync::Arc,
};

use collision::{
    accuracy::Accuracy,
    world::{Filter, Meter, Moment, Overlap, Raycast, Snapshot, Tick, World},
};
use dice::Dice;
use traffic::{MOVES, QUESTIONS, SHAPE_COUNT, balls, filled, median, moves, rays, tick, timed_value};

type Failure = Box<dyn Error + Send + Sync>;

/// Ticks of history.
const HISTORY: u32 = 64;
/// How far back the past is asked.
const BACK: u64 = 32;
const ROUNDS: usize = 15;
/// Times that a first question is timed, each to another span.
const FIRSTS: usize = 60;

fn main() -> Result<(), Failure> {
    // `cargo bench` hands over --bench; without it this is `cargo test --benches`, which wants no figures.
    if !std::env::args().any(|flag| flag == "--bench") {
        return Ok(());
    }
    let mut out = stdout();
    for name in ["sphere", "box"] {
        let mut dice = Dice(7);
        let (mut bare, side) = filled(name, &mut dice, 0)?;
        let (mut kept, _) = filled(name, &mut Dice(7), HISTORY)?;
        for _ in 0..HISTORY + 16 {
            let moves = moves(&kept.newest(), &mut dice);
            tick(&mut bare, moves.clone())?;
            tick(&mut kept, moves)?;
        }
        let bytes = |world: &World| world.newest().describe().memory_bytes as f64 / SHAPE_COUNT as f64;
        writeln!(out, "{SHAPE_COUNT} shapes ({name}) in a cube of {side:.1} m, {MOVES} moves a tick")?;
        writeln!(
            out,
            "memory: {:.0} bytes a shape without history, {:.0} with {HISTORY} ticks of it",
            bytes(&bare),
            bytes(&kept)
        )?;
        applying(&mut out, &mut bare, &mut kept, &mut dice)?;
        firsts(&mut out, &mut kept, side, &mut dice)?;
        questions(&mut out, &kept.newest(), side, &mut dice)?;
        writeln!(out, "memory: {:.0} bytes a shape with what the questions had built", bytes(&kept))?;
    }
    Ok(())
}

/// What a tick takes with history and without, by turns.
fn applying(out: &mut impl Write, bare: &mut World, kept: &mut World, dice: &mut Dice) -> Result<(), Failure> {
    let (mut without, mut with) = (Vec::new(), Vec::new());
    for _ in 0..60 {
        let moves = moves(&kept.newest(), dice);
        without.push(timed(|| tick(bare, moves.clone()))?);
        with.push(timed(|| tick(kept, moves.clone()))?);
    }
    let (without, with) = (median(without), median(with));
    writeln!(
        out,
        "tick: {:.3} ms without history, {:.3} ms with it ({:.2}x)",
        without * 1e3,
        with * 1e3,
        with / without
    )?;
    Ok(())
}

/// The first question to a time, and the next.
fn firsts(out: &mut impl Write, world: &mut World, side: f64, dice: &mut Dice) -> Result<(), Failure> {
    let rays = rays(side, dice);
    let (mut first, mut next) = (Vec::new(), Vec::new());
    for ray in rays.iter().cycle().take(FIRSTS) {
        // On to a span that nobody asked for yet.
        for _ in 0..8 {
            tick(world, moves(&world.newest(), dice))?;
        }
        let newest = world.newest();
        for times in [&mut first, &mut next] {
            let past = timed_value(|| newest.at(Moment::Tick(before(&newest))).map(|past| asked_ray(&past, ray)));
            past.1?;
            times.push(past.0);
        }
    }
    let least = first.iter().copied().fold(f64::INFINITY, f64::min) * 1e3;
    let (first, next) = (median(first) * 1e3, median(next) * 1e3);
    writeln!(out, "first question {BACK} ticks before: {first:.3} ms (least {least:.3} ms), the next: {next:.4} ms")?;
    Ok(())
}

/// The same questions now and then.
fn questions(out: &mut impl Write, newest: &Arc<Snapshot>, side: f64, dice: &mut Dice) -> Result<(), Failure> {
    let (rays, balls) = (rays(side, dice), balls(side, dice)?);
    let moments = [Moment::Tick(newest.tick()), Moment::Tick(before(newest)), Moment::Between(before(newest), 0.5)];
    type Asked<'a> = (&'static str, Box<dyn Fn(&Snapshot) -> usize + 'a>);
    let all: [Asked<'_>; 2] = [
        ("ray", Box::new(|past| rays.iter().map(|ray| asked_ray(past, ray)).sum())),
        ("overlap", Box::new(|past| balls.iter().map(|ball| asked_ball(past, ball)).sum())),
    ];
    for (name, ask) in all {
        let mut times = [Vec::new(), Vec::new(), Vec::new()];
        for _ in 0..ROUNDS {
            for (moment, times) in moments.iter().zip(&mut times) {
                let past = newest.at(*moment)?;
                times.push(timed_value(|| black_box(ask(&past))).0);
            }
        }
        let [now, then, between] = times.map(|times| median(times) / QUESTIONS as f64 * 1e9);
        writeln!(
            out,
            "{name}: {now:.0} ns now, {then:.0} ns {BACK} ticks before ({:.2}x, goal 2), {between:.0} ns between ticks \
             ({:.2}x)",
            then / now,
            between / now
        )?;
    }
    Ok(())
}

fn asked_ray(snapshot: &Snapshot, ray: &Raycast) -> usize {
    let found = snapshot.raycast(ray, &Filter::default(), &Accuracy::default(), &mut Meter::new(&mut || true));
    found.map_or(0, |found| found.hits.len())
}

fn asked_ball(snapshot: &Snapshot, ball: &Overlap) -> usize {
    let found = snapshot.overlap(ball, &Filter::default(), &Accuracy::default(), &mut Meter::new(&mut || true));
    found.map_or(0, |found| found.hits.len())
}

/// The tick that is asked, so many before the newest.
fn before(newest: &Snapshot) -> Tick {
    Tick::MIN.saturating_add(newest.tick().get() - 1 - BACK)
}

/// Seconds that something takes that may fail.
fn timed(work: impl FnOnce() -> Result<(), Failure>) -> Result<f64, Failure> {
    let (seconds, done) = timed_value(work);
    done.map(|()| seconds)
}
