//! What each kind of question costs beside a plain ray, in the same world: `cargo bench --bench questions`.
//!
//! 10,000 boxes of 0.2 to 2 m that fill about 5 % of the space, after 48 ticks in which 1,000 of them move. All kinds are asked by turns,
//! so that a slow moment of the machine meets them all. Rays go 10 m; a character is a capsule of 1.8 m that walks 0.1 m, from places
//! where some stand in something; what is moved out is a box of 1 m anywhere; bodies are the 16 shapes around a place; touches of the past
//! are those of a ball of 1 m in the 8 ticks before.

mod dice;
mod traffic;

use std::{
    error::Error,
    hint::black_box,
    io::{Write, stdout},
    sync::Arc,
};

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::Work,
    math::Pose,
    shape::Geometry,
    world::{
        Body, Depenetrate, Distance, Filter, FirstTouch, HitMode, Meter, MoveCharacter, QuestionError, Raycast,
        Resolve, Seen, Sight, Snapshot, Subject, Tick,
    },
};
use dice::Dice;
use traffic::{QUESTIONS, SHAPE_COUNT, balls, filled, median, moves, rays, tick, timed_value};

type Failure = Box<dyn Error + Send + Sync>;

const TICKS: u32 = 48;
const ROUNDS: usize = 9;
/// Ticks that a touch of the past is sought in.
const BACK: u64 = 8;
/// Bodies that are resolved together.
const BODIES: usize = 16;

/// Asks the question of a number; returns whether that found something.
type Ask<'a> = Box<dyn Fn(usize, &mut Meter<'_>) -> Result<bool, QuestionError> + 'a>;

/// A kind of question.
struct Kind<'a> {
    name: &'static str,
    /// How many are asked.
    count: usize,
    ask: Ask<'a>,
}

fn main() -> Result<(), Failure> {
    // `cargo bench` hands over --bench; without it this is `cargo test --benches`, which wants no figures.
    if !std::env::args().any(|flag| flag == "--bench") {
        return Ok(());
    }
    let mut dice = Dice(7);
    let (mut world, side) = filled("box", &mut dice, TICKS)?;
    for _ in 0..TICKS {
        let moves = moves(&world.newest(), &mut dice);
        tick(&mut world, moves)?;
    }
    let newest = world.newest();
    let rays = rays(side, &mut dice);
    let mut kinds = of_rays(&newest, &rays);
    kinds.extend(of_places(&newest, side, &mut dice)?);
    kinds.extend(of_many(&newest, side, &mut dice)?);
    let mut out = stdout();
    writeln!(out, "{SHAPE_COUNT} boxes in a cube of {side:.1} m\n")?;
    writeln!(out, "| question | ns | of a ray | nodes | shapes | iterations | found |\n|---|---|---|---|---|---|---|")?;
    let mut times: Vec<Vec<f64>> = kinds.iter().map(|_| Vec::new()).collect();
    for _ in 0..ROUNDS {
        for (kind, times) in kinds.iter().zip(&mut times) {
            // What others left in the caches is not this kind's to pay for.
            all(kind)?;
            let (seconds, asked) = timed_value(|| all(kind));
            black_box(asked?);
            times.push(seconds / kind.count as f64 * 1e9);
        }
    }
    let times: Vec<f64> = times.into_iter().map(median).collect();
    for (kind, ns) in kinds.iter().zip(&times) {
        let (work, found) = all(kind)?;
        let each = |total: u64| total as f64 / kind.count as f64;
        writeln!(
            out,
            "| {} | {ns:.0} | {:.2} | {:.1} | {:.1} | {:.1} | {:.0} % |",
            kind.name,
            ns / times[0],
            each(work.nodes_visited),
            each(work.shapes_tested),
            each(work.iterations),
            100.0 * each(found)
        )?;
    }
    Ok(())
}

/// Asks all questions of a kind.
fn all(kind: &Kind<'_>) -> Result<(Work, u64), QuestionError> {
    let mut keep_going = || true;
    let (mut work, mut found) = (Work::default(), 0);
    for number in 0..kind.count {
        let mut meter = Meter::new(&mut keep_going);
        found += u64::from((kind.ask)(number, &mut meter)?);
        work += meter.work;
    }
    Ok((work, found))
}

/// Rays of all modes, and lines of sight along them.
fn of_rays<'a>(world: &'a Snapshot, rays: &'a [Raycast]) -> Vec<Kind<'a>> {
    let modes = [
        ("ray, closest", HitMode::Closest),
        ("ray, any", HitMode::Any),
        ("ray, all", HitMode::All(64)),
        // Nothing blocks: all that is on the way is told.
        ("ray, pierce", HitMode::Pierce { layers: u32::MAX, most: 64 }),
    ];
    let of_mode = modes.into_iter().map(|(name, mode)| {
        let ask = move |number: usize, meter: &mut Meter<'_>| {
            let question = Raycast { ray: rays[number].ray, mode };
            let found = world.raycast(&question, &Filter::default(), &Accuracy::default(), meter)?;
            Ok(!found.hits.is_empty())
        };
        Kind { name, count: rays.len(), ask: Box::new(ask) }
    });
    let sight = |number: usize, meter: &mut Meter<'_>| {
        let ray = &rays[number].ray;
        let point = ray.origin + ray.direction.normalize_or_zero() * ray.max_distance;
        let sight = Sight { eye: ray.origin, point, max_distance: 2.0 * ray.max_distance };
        let seen = world.sight(&sight, &Filter::default(), &Accuracy::default(), meter)?;
        Ok(seen == Seen::Hidden)
    };
    let mut kinds: Vec<Kind<'a>> = of_mode.collect();
    kinds.push(Kind { name: "line of sight", count: rays.len(), ask: Box::new(sight) });
    kinds
}

/// Characters, and what is to be moved out, at random places.
fn of_places<'a>(world: &'a Snapshot, side: f64, dice: &mut Dice) -> Result<Vec<Kind<'a>>, Failure> {
    let places: Vec<DVec3> = (0..QUESTIONS).map(|_| DVec3::from_array(dice.point(side))).collect();
    let at = |geometry: Geometry| {
        let (geometry, places) = (Arc::new(geometry), places.clone());
        move |number: usize| Subject::Geometry { geometry: Arc::clone(&geometry), pose: Pose::at(places[number]) }
    };
    let (character, cube) = (at(Geometry::capsule(0.5, 0.4)?), at(Geometry::cuboid(DVec3::splat(0.5))?));
    let walk = move |number: usize, meter: &mut Meter<'_>| {
        let question = MoveCharacter {
            subject: character(number),
            translation: DVec3::new(0.1, -0.02, 0.0),
            up: DVec3::Y,
            max_slope: 0.8,
            step_height: 0.3,
            snap_distance: 0.2,
            skin: 0.01,
            max_slides: 4,
            max_push: 1.0,
        };
        let moved = world.move_character(&question, &Filter::default(), &Accuracy::default(), meter)?;
        Ok(!moved.hits.is_empty())
    };
    let push = move |number: usize, meter: &mut Meter<'_>| {
        let subject = cube(number);
        let question = Depenetrate { subject, against: None, gap: 0.0, max_distance: 2.0, max_passes: 8 };
        let pushed = world.depenetrate(&question, &Filter::default(), &Accuracy::default(), meter)?;
        Ok(pushed.passes > 0)
    };
    Ok(vec![
        Kind { name: "move character", count: QUESTIONS, ask: Box::new(walk) },
        Kind { name: "depenetrate", count: QUESTIONS, ask: Box::new(push) },
    ])
}

/// Bodies, touches of the past, and all pairs.
fn of_many<'a>(world: &'a Arc<Snapshot>, side: f64, dice: &mut Dice) -> Result<Vec<Kind<'a>>, Failure> {
    let heaps: Vec<Resolve> =
        (0..QUESTIONS / BODIES).map(|_| heap(world, DVec3::from_array(dice.point(side)))).collect::<Result<_, _>>()?;
    let places = balls(side, dice)?;
    let from = Tick::MIN.saturating_add(world.tick().get() - 1 - BACK);
    let resolve = move |number: usize, meter: &mut Meter<'_>| {
        let resolved = world.resolve(&heaps[number], &Filter::default(), &Accuracy::default(), meter)?;
        Ok(!resolved.impulses.is_empty())
    };
    let touch = move |number: usize, meter: &mut Meter<'_>| {
        let subject = places[number].subject.clone();
        let question = FirstTouch { subject, against: None, from, to: world.tick() };
        let found = world.first_touch(&question, &Filter::default(), &Accuracy::default(), meter)?;
        Ok(!found.hits.is_empty())
    };
    let pairs =
        |_, meter: &mut Meter<'_>| Ok(!world.pairs(&Filter::default(), &Accuracy::default(), meter)?.is_empty());
    Ok(vec![
        Kind { name: "resolve, 16 bodies", count: QUESTIONS / BODIES, ask: Box::new(resolve) },
        Kind { name: "first touch, 8 ticks", count: QUESTIONS, ask: Box::new(touch) },
        Kind { name: "pairs", count: 1, ask: Box::new(pairs) },
    ])
}

/// The bodies around a place.
fn heap(world: &Snapshot, place: DVec3) -> Result<Resolve, Failure> {
    let subject = Subject::Geometry { geometry: Arc::new(Geometry::sphere(0.1)?), pose: Pose::at(place) };
    let near = Distance { subject, against: None, max_distance: 4e12, max_hits: BODIES };
    let near = world.distance(&near, &Filter::default(), &Accuracy::default(), &mut Meter::new(&mut || true))?;
    let body = |id| Body {
        id,
        mass: 1.0,
        center: DVec3::ZERO,
        inertia: Some(DVec3::splat(0.2)),
        velocity: None,
        angular_velocity: None,
        friction: 0.5,
        restitution: 0.2,
    };
    let bodies = near.hits.iter().filter_map(|hit| hit.id).map(body).collect();
    Ok(Resolve { bodies, passes: 8, allowed_depth: 0.0, correction: 1.0 })
}
