//! What a writer costs and what it takes from the readers: `cargo bench --bench versions`.
//!
//! A world of 10,000 shapes (half boxes, a quarter spheres, a quarter capsules, 0.2 to 2 m, about 5 % of the space filled).
//! One thread moves 1,000 of them by 0.1 m sixty times a second and publishes each tick by swapping a pointer; the other
//! cores take the newest version for each question and ask for the closest hit of a ray of 10 m. Stretches with and
//! without the writer take turns, so that a slow moment of the machine meets both.

mod dice;

use std::{
    error::Error,
    f64::consts::TAU,
    hint::black_box,
    io::{Write, stdout},
    num::NonZeroU64,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use arc_swap::ArcSwap;
use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    math::Pose,
    narrow::{Faces, Ray},
    shape::Geometry,
    world::{Edit, EditRule, Filter, HitMode, Meter, Raycast, Shape, Snapshot, Time, World},
};
use dice::Dice;

type Failure = Box<dyn Error + Send + Sync>;

const SHAPE_COUNT: u64 = 10_000;
/// Moves of a tick.
const MOVES: u64 = 1000;
/// How far each goes, metres.
const STEP: f64 = 0.1;
/// From one tick to the next.
const PERIOD: Duration = Duration::from_nanos(1_000_000_000 / 60);
/// How long the readers run with the writer, and how long without, in each round.
const STRETCH: Duration = Duration::from_secs(1);
const ROUNDS: usize = 9;
/// Length of rays, metres.
const RAY_LENGTH: f64 = 10.0;
/// Volume of a sphere of radius 1.
const SPHERE: f64 = 2.0 * TAU / 3.0;

fn main() -> Result<(), Failure> {
    // `cargo bench` hands over --bench; without it this is `cargo test --benches`, which wants no figures.
    if !std::env::args().any(|flag| flag == "--bench") {
        return Ok(());
    }
    let mut dice = Dice(7);
    let (mut world, side) = filled(&mut dice)?;
    let published = ArcSwap::new(world.newest());
    let readers = thread::available_parallelism().map_or(1, |cores| cores.get() - 1).max(1);
    let (mut publishing, mut applying) = (Vec::new(), Vec::new());
    let (mut quiet, mut busy) = (Vec::new(), Vec::new());
    // The first round warms up.
    for round in 0..=ROUNDS {
        let alone = read(&published, readers, side, || thread::sleep(STRETCH));
        let mut ticks = Vec::new();
        let beside = read(&published, readers, side, || ticks = write(&mut world, &published, &mut dice));
        if round > 0 {
            quiet.push(alone);
            busy.push(beside);
            applying.extend(ticks.iter().map(|tick| tick.apply.as_secs_f64()));
            publishing.extend(ticks.iter().map(|tick| tick.whole.as_secs_f64()));
        }
    }
    let ratios: Vec<f64> = busy.iter().zip(&quiet).map(|(busy, quiet)| busy / quiet).collect();
    let (applying, publishing) = (sorted(applying), sorted(publishing));
    let mut out = stdout();
    writeln!(out, "{SHAPE_COUNT} shapes in a cube of {side:.1} m, {readers} reading, {} ticks", publishing.len())?;
    let (p50, p99) = (at(&publishing, 0.5) * 1e3, at(&publishing, 0.99) * 1e3);
    writeln!(out, "publish {MOVES} moves: p50 {p50:.3} ms  p99 {p99:.3} ms  (goal: p50 at most 1 ms)")?;
    writeln!(out, "World::apply: {:.0} ns a move  (goal: at most 1000)", at(&applying, 0.5) * 1e9 / MOVES as f64)?;
    let (quiet, busy, ratio) = (at(&sorted(quiet), 0.5), at(&sorted(busy), 0.5), at(&sorted(ratios), 0.5));
    writeln!(
        out,
        "questions: {quiet:.0}/s alone, {busy:.0}/s beside the writer: {:.1} %  (goal: 95 %)",
        ratio * 100.0
    )?;
    Ok(())
}

/// Shapes at random in a cube of which they fill a twentieth, and its side.
fn filled(dice: &mut Dice) -> Result<(World, f64), Failure> {
    let mut volume = 0.0;
    let geometries: Vec<Geometry> = (0..SHAPE_COUNT)
        .map(|number| {
            let [a, b, c] = std::array::from_fn(|_| dice.between(0.1, 1.0));
            match number % 4 {
                0 | 1 => {
                    volume += 8.0 * a * b * c;
                    Geometry::cuboid(DVec3::new(a, b, c))
                }
                2 => {
                    volume += SPHERE * a * a * a;
                    Geometry::sphere(a)
                }
                _ => {
                    let (half_height, radius) = (0.5 * a, 0.5 * b);
                    volume += SPHERE * radius.powi(3) + TAU * radius * radius * half_height;
                    Geometry::capsule(half_height, radius)
                }
            }
        })
        .collect::<Result<_, _>>()?;
    let side = (20.0 * volume).cbrt();
    let mut edits = Vec::new();
    for (number, geometry) in (1..).zip(geometries) {
        let pose = Pose::new(DVec3::from_array(dice.point(side)), dice.rotation());
        edits.push(Edit::Insert(Shape::new(id(number), Arc::new(geometry), pose)));
    }
    let mut world = World::new(Time(0));
    world.apply(edits, Time(0), EditRule::AllOrNothing)?;
    Ok((world, side))
}

fn id(number: u64) -> NonZeroU64 {
    NonZeroU64::MIN.saturating_add(number - 1)
}

/// Questions a second of all readers together, while `meanwhile` runs.
fn read(published: &ArcSwap<Snapshot>, readers: usize, side: f64, meanwhile: impl FnOnce()) -> f64 {
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let began = Instant::now();
        let counts: Vec<_> = (0..readers as u64)
            .map(|reader| {
                let stop = &stop;
                scope.spawn(move || {
                    let rays = rays(side, &mut Dice(1000 + reader));
                    let (accuracy, filter, mut count) = (Accuracy::default(), Filter::default(), 0_u64);
                    for ray in rays.iter().cycle() {
                        if stop.load(Ordering::Relaxed) {
                            break;
                        }
                        let version = published.load_full();
                        black_box(version.raycast(ray, &filter, &accuracy, &mut Meter::new(&mut || true)).is_ok());
                        count += 1;
                    }
                    count
                })
            })
            .collect();
        meanwhile();
        stop.store(true, Ordering::Relaxed);
        let count: u64 = counts.into_iter().map(|reader| reader.join().unwrap_or(0)).sum();
        count as f64 / began.elapsed().as_secs_f64()
    })
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
    (0..4096).map(|_| Raycast { ray: ray(), mode: HitMode::Closest }).collect()
}

/// What a tick took.
struct Tick {
    /// Applying the edits.
    apply: Duration,
    /// That, and handing the version over.
    whole: Duration,
}

/// Ticks at their period for one stretch.
fn write(world: &mut World, published: &ArcSwap<Snapshot>, dice: &mut Dice) -> Vec<Tick> {
    let began = Instant::now();
    let mut ticks = Vec::new();
    let mut next = began;
    while began.elapsed() < STRETCH {
        let newest = world.newest();
        let first = (dice.between(0.0, 1.0) * (SHAPE_COUNT / MOVES) as f64) as u64;
        // Every tenth: spread over all pages, as the movers of a world are.
        let moves = (0..MOVES).filter_map(|number| {
            let id = id(1 + first + number * (SHAPE_COUNT / MOVES));
            let place = newest.shape(id)?.pose.position + DVec3::from_array(dice.point(2.0)).normalize_or_zero() * STEP;
            let (rotation, velocity, angular_velocity) = (None, None, None);
            Some(Edit::Move { id, position: Some(place), rotation, velocity, angular_velocity, teleport: false })
        });
        let moves: Vec<Edit> = moves.collect();
        let time = Time(newest.time().0 + PERIOD.as_nanos() as i64);
        drop(newest);
        let start = Instant::now();
        let applied = world.apply(moves, time, EditRule::AllOrNothing);
        let apply = start.elapsed();
        published.store(world.newest());
        let whole = start.elapsed();
        assert!(applied.is_ok_and(|report| report.changed_count == MOVES), "all shapes are there");
        ticks.push(Tick { apply, whole });
        next += PERIOD;
        thread::sleep(next.saturating_duration_since(Instant::now()));
    }
    ticks
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// The value that a share of the sorted ones is at or below.
fn at(values: &[f64], share: f64) -> f64 {
    values[(share * (values.len() - 1) as f64) as usize]
}

impl Dice {
    /// Not evenly spread over all rotations, but over many.
    fn rotation(&mut self) -> DQuat {
        let mut part = || self.between(-1.0, 1.0);
        DQuat::from_xyzw(part(), part(), part(), part())
    }
}
