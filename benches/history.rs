//! What the past of a world costs, in memory and in time: `cargo bench --bench history`.
//!
//! Worlds of 10,000 spheres and of 10,000 boxes, of 0.2 to 2 m, that fill about 5 % of the space; each tick moves another
//! 1,000 of them by 0.1 m and turns them a little. Memory is what `describe` says of it. Questions are closest hits of rays
//! of 10 m and overlaps of a ball of 2 m: the same ones at the newest tick, 32 ticks before and half a tick after that,
//! by turns, so that a slow moment of the machine meets them all. The first question to a time, which prepares the ticks
//! around it, is timed alone, and so is the next, which finds them ready.

mod dice;

use std::{
    error::Error,
    hint::black_box,
    io::{Write, stdout},
    num::NonZeroU64,
    sync::Arc,
    time::Instant,
};

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    math::Pose,
    narrow::{Faces, Ray},
    shape::Geometry,
    world::{
        Edit, EditRule, Filter, HitMode, Means, Meter, Moment, Overlap, Raycast, Settings, Shape, Snapshot, Subject,
        Tick, Time, World,
    },
};
use dice::Dice;

type Failure = Box<dyn Error + Send + Sync>;

const SHAPE_COUNT: u64 = 10_000;
/// Moves of a tick.
const MOVES: u64 = 1000;
/// How far each goes, metres.
const STEP: f64 = 0.1;
/// Ticks of history.
const HISTORY: u32 = 64;
/// How far back the past is asked.
const BACK: u64 = 32;
/// Length of rays, metres.
const RAY_LENGTH: f64 = 10.0;
const QUESTIONS: usize = 2000;
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

fn tick(world: &mut World, moves: Vec<Edit>) -> Result<(), Failure> {
    let time = Time(world.newest().time().0 + 16_666_667);
    world.apply(moves, time, EditRule::AllOrNothing)?;
    Ok(())
}

/// Every tenth shape, from a random one on: spread over all pages, as the movers of a world are.
fn moves(newest: &Snapshot, dice: &mut Dice) -> Vec<Edit> {
    let stride = SHAPE_COUNT / MOVES;
    let first = (dice.between(0.0, 1.0) * stride as f64) as u64;
    let mut moves = Vec::new();
    for number in 0..MOVES {
        let id = id(1 + first + number * stride);
        if let Some(shape) = newest.shape(id) {
            let turn = DQuat::from_xyzw(0.02, dice.between(-0.02, 0.02), 0.0, 1.0);
            moves.push(Edit::Move {
                id,
                position: Some(shape.pose.position + DVec3::from_array(dice.point(2.0)).normalize_or_zero() * STEP),
                rotation: Some(turn * shape.pose.unit_rotation()),
                velocity: None,
                angular_velocity: None,
                teleport: false,
            });
        }
    }
    moves
}

/// Shapes at random in a cube of which they fill a twentieth, and its side.
fn filled(name: &str, dice: &mut Dice, history_ticks: u32) -> Result<(World, f64), Failure> {
    let mut geometries = Vec::new();
    let mut volume = 0.0;
    for _ in 0..SHAPE_COUNT {
        let half = DVec3::from_array(std::array::from_fn(|_| dice.between(0.1, 1.0)));
        if name == "sphere" {
            volume += std::f64::consts::TAU * 2.0 / 3.0 * half.x.powi(3);
            geometries.push(Geometry::sphere(half.x)?);
        } else {
            volume += 8.0 * half.element_product();
            geometries.push(Geometry::cuboid(half)?);
        }
    }
    let side = (20.0 * volume).cbrt();
    let inserts = (1..).zip(geometries).map(|(number, geometry)| {
        let pose =
            Pose::new(DVec3::from_array(dice.point(side)), DQuat::from_xyzw(dice.between(-1.0, 1.0), 0.3, 0.2, 1.0));
        Edit::Insert(Shape::new(id(number), Arc::new(geometry), pose))
    });
    let settings = Settings { history_ticks, ..Settings::default() };
    let mut world = World::with(Time(0), settings, Means::default());
    world.apply(inserts.collect(), Time(0), EditRule::AllOrNothing)?;
    Ok((world, side))
}

fn id(number: u64) -> NonZeroU64 {
    NonZeroU64::MIN.saturating_add(number - 1)
}

fn rays(side: f64, dice: &mut Dice) -> Vec<Raycast> {
    let mut ray = || Ray {
        origin: DVec3::from_array(dice.point(side)),
        direction: DVec3::from_array(dice.point(1.0)),
        min_distance: 0.0,
        max_distance: RAY_LENGTH,
        hollow: false,
        faces: Faces::Both,
    };
    (0..QUESTIONS).map(|_| Raycast { ray: ray(), mode: HitMode::Closest }).collect()
}

fn balls(side: f64, dice: &mut Dice) -> Result<Vec<Overlap>, Failure> {
    let ball = Arc::new(Geometry::sphere(2.0)?);
    let subject = |pose| Subject::Geometry { geometry: Arc::clone(&ball), pose };
    let places = (0..QUESTIONS).map(|_| Pose::at(DVec3::from_array(dice.point(side))));
    Ok(places.map(|pose| Overlap { subject: subject(pose), against: None, max_hits: 1000 }).collect())
}

/// Seconds that something takes that may fail.
fn timed(work: impl FnOnce() -> Result<(), Failure>) -> Result<f64, Failure> {
    let (seconds, done) = timed_value(work);
    done.map(|()| seconds)
}

/// Seconds that something takes, and what it gives.
fn timed_value<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let begin = Instant::now();
    let value = work();
    (begin.elapsed().as_secs_f64(), value)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
