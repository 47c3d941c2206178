//! What a watcher costs and how soon it tells: `cargo bench --bench watch`.
//!
//! 10,000 balls, boxes and capsules of 0.2 to 1 m move by 0.3 m in each tick, turning, in a cube of 200 m with 1,000 regions of
//! 2 to 10 m, of which 100 follow shapes. First the crate alone: what a tick costs the writer, and what it costs the watcher.
//! Then the server, over a socket: a client sends 30 ticks a second as columns, another watches; the latency is from the sending
//! of a tick to the end of the message that tells it.

mod dice;

use std::{
    error::Error,
    io::{Write, stdout},
    num::NonZeroU64,
    sync::Arc,
    time::{Duration, Instant},
};

use calipers::{config::Settings as ServerSettings, serve};
use calipers_client::{Client, proto};
use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    math::Pose,
    shape::Geometry,
    world::{
        Edit, EditRule, Filter, Means, Meter, Region, Settings, Shape, ShapeId, Time, Watch, WatchedPairs, Watcher,
        World,
    },
};
use dice::Dice;

type Failure = Box<dyn Error + Send + Sync>;

const SHAPES: u64 = 10_000;
const REGIONS: u64 = 1000;
/// Every so many regions one follows a shape.
const FOLLOWING: u64 = 10;
/// Edge of the world, metres.
const SIDE: f64 = 200.0;
/// How far a shape goes in a tick, metres.
const STEP: f64 = 0.3;
const TICKS: usize = 300;
/// From one tick to the next.
const PERIOD: Duration = Duration::from_nanos(1_000_000_000 / 30);

fn main() -> Result<(), Failure> {
    // `cargo bench` hands over --bench; without it this is `cargo test --benches`, which wants no figures.
    if !std::env::args().any(|flag| flag == "--bench") {
        return Ok(());
    }
    let mut out = stdout();
    for pairs in [WatchedPairs::Nothing, WatchedPairs::All] {
        let name = if pairs == WatchedPairs::All { "regions and all pairs" } else { "regions" };
        let (applied, stepped, told) = alone(pairs)?;
        writeln!(
            out,
            "{name}: a tick costs the writer p50 {:.2} ms, the watcher p50 {:.2} ms p99 {:.2} ms; {told:.0} changes a tick",
            at(&applied, 0.5),
            at(&stepped, 0.5),
            at(&stepped, 0.99),
        )?;
    }
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let (latency, merged) = runtime.block_on(served())?;
    writeln!(
        out,
        "served at 30 Hz: from the edit to the event p50 {:.2} ms  p99 {:.2} ms; {merged} of {} messages were of several ticks",
        at(&latency, 0.5),
        at(&latency, 0.99),
        latency.len()
    )?;
    Ok(())
}

/// Where shapes are and where they go.
struct Traffic {
    places: Vec<DVec3>,
    ways: Vec<DVec3>,
    turns: Vec<DQuat>,
}

impl Traffic {
    fn new(dice: &mut Dice) -> Self {
        let count = 0..SHAPES;
        Self {
            places: count.clone().map(|_| DVec3::from_array(dice.point(SIDE))).collect(),
            ways: count.clone().map(|_| DVec3::from_array(dice.point(1.0)).normalize_or_zero() * STEP).collect(),
            turns: count.map(|_| DQuat::from_scaled_axis(DVec3::from_array(dice.point(0.2)))).collect(),
        }
    }

    /// On by a tick; what would leave the world turns back.
    fn go_on(&mut self) {
        for (place, way) in self.places.iter_mut().zip(&mut self.ways) {
            for axis in 0..3 {
                if (place[axis] + way[axis]).abs() > 0.5 * SIDE {
                    way[axis] = -way[axis];
                }
            }
            *place += *way;
        }
    }
}

fn id(number: u64) -> ShapeId {
    NonZeroU64::MIN.saturating_add(number)
}

fn form(number: u64, dice: &mut Dice) -> Result<Geometry, Failure> {
    let [a, b, c] = std::array::from_fn(|_| dice.between(0.1, 0.5));
    Ok(match number % 4 {
        0 | 1 => Geometry::cuboid(DVec3::new(a, b, c))?,
        2 => Geometry::sphere(a)?,
        _ => Geometry::capsule(a, 0.5 * b)?,
    })
}

fn regions(dice: &mut Dice) -> Result<Vec<Region>, Failure> {
    (0..REGIONS)
        .map(|number| {
            let [a, b, c] = std::array::from_fn(|_| dice.between(1.0, 5.0));
            let follow = (number % FOLLOWING == 0).then(|| id(number));
            let place = if follow.is_some() { DVec3::ZERO } else { DVec3::from_array(dice.point(SIDE)) };
            let geometry = if number % 2 == 0 { Geometry::sphere(a) } else { Geometry::cuboid(DVec3::new(a, b, c)) };
            Ok(Region { id: id(number), geometry: Arc::new(geometry?), pose: Pose::at(place), follow })
        })
        .collect()
}

/// What ticks cost the writer and the watcher, milliseconds, sorted; and how many changes a tick makes.
fn alone(pairs: WatchedPairs) -> Result<(Vec<f64>, Vec<f64>, f64), Failure> {
    let mut dice = Dice(7);
    let mut traffic = Traffic::new(&mut dice);
    let mut world = World::with(Time(0), Settings::default(), Means::default());
    let inserts = (0..SHAPES).map(|number| {
        let pose = Pose::at(traffic.places[number as usize]);
        Ok(Edit::Insert(Shape::new(id(number), Arc::new(form(number, &mut dice)?), pose)))
    });
    let inserts = inserts.collect::<Result<Vec<_>, Failure>>()?;
    world.apply(inserts, Time(0), EditRule::AllOrNothing)?;
    let (filter, accuracy) = (Filter::default(), Accuracy::default());
    let watch = Watch { regions: regions(&mut dice)?, filter, pairs, accuracy, hysteresis: 0.0 };
    let mut watcher = Watcher::new(watch);
    watcher.step(&world.newest(), &mut Meter::new(&mut || true))?;
    let (mut applied, mut stepped, mut told) = (Vec::new(), Vec::new(), 0);
    for _ in 0..TICKS {
        traffic.go_on();
        let newest = world.newest();
        let moves = (0..SHAPES).zip(&traffic.places).zip(&traffic.turns).map(|((number, place), turn)| Edit::Move {
            id: id(number),
            position: Some(*place),
            rotation: newest.shape(id(number)).map(|shape| *turn * shape.pose.rotation),
            velocity: None,
            angular_velocity: None,
            teleport: false,
        });
        let moves = moves.collect();
        drop(newest);
        let begin = Instant::now();
        world.apply(moves, Time(0), EditRule::AllOrNothing)?;
        applied.push(begin.elapsed().as_secs_f64() * 1e3);
        let begin = Instant::now();
        told += watcher.step(&world.newest(), &mut Meter::new(&mut || true))?.len();
        stepped.push(begin.elapsed().as_secs_f64() * 1e3);
    }
    Ok((sorted(applied), sorted(stepped), told as f64 / TICKS as f64))
}

/// Latencies, milliseconds, sorted; and how many messages told several ticks.
async fn served() -> Result<(Vec<f64>, usize), Failure> {
    let settings = ServerSettings { listen: "127.0.0.1:0".parse()?, ..ServerSettings::default() };
    let server = serve::start(settings).await?;
    let address = server.local_addr().to_string();
    let (writer, reader) = (Client::connect(&address).await?, Client::connect(&address).await?);
    let mut dice = Dice(7);
    let mut traffic = Traffic::new(&mut dice);
    let like = proto::Shape { geometry: Some(calipers_client::geometry::sphere(0.3)), ..proto::Shape::default() };
    let ids: Vec<u64> = (0..SHAPES).map(|number| id(number).get()).collect();
    let inserts = proto::InsertColumns { like: Some(like), ids: ids.clone(), poses: Some(poses(&traffic)) };
    writer.edit([proto::Edit { op: Some(proto::edit::Op::Inserts(inserts)) }]).await?;
    let watched = regions(&mut dice)?.iter().map(region).collect();
    let request = proto::WatchOverlapsRequest { regions: watched, ..proto::WatchOverlapsRequest::default() };
    let mut messages = reader.watch_overlaps(request).await?;
    messages.message().await?.ok_or("it ended")?;
    let watching = tokio::spawn(async move {
        let mut seen = Vec::new();
        while let Some(message) = messages.message().await? {
            let tick = message.info.map_or(0, |info| info.tick);
            seen.push((tick, message.merged_ticks, Instant::now()));
            if tick == TICKS as u64 + 2 {
                break;
            }
        }
        Ok::<_, Failure>(seen)
    });
    let mut sent = Vec::new();
    let mut next = Instant::now();
    for _ in 0..TICKS {
        traffic.go_on();
        let moves = proto::MoveColumns { ids: ids.clone(), poses: Some(poses(&traffic)), ..Default::default() };
        tokio::time::sleep_until(next.into()).await;
        next += PERIOD;
        sent.push(Instant::now());
        writer.edit([proto::Edit { op: Some(proto::edit::Op::Moves(moves)) }]).await?;
    }
    let seen = tokio::time::timeout(Duration::from_secs(60), watching).await???;
    let merged = seen.iter().filter(|(_, ticks, _)| *ticks > 1).count();
    let latency = seen.iter().filter_map(|(tick, _, at)| Some((at, sent.get(tick.checked_sub(3)? as usize)?)));
    Ok((sorted(latency.map(|(at, sent)| (*at - *sent).as_secs_f64() * 1e3).collect()), merged))
}

fn poses(traffic: &Traffic) -> proto::PoseColumns {
    let positions = traffic.places.iter().flat_map(|place| place.to_array()).map(|value| value as f32).collect();
    proto::PoseColumns { positions, ..proto::PoseColumns::default() }
}

fn region(region: &Region) -> proto::Region {
    let [x, y, z] = region.pose.position.to_array();
    let half = region.geometry.local_bounds().max;
    proto::Region {
        id: region.id.get(),
        geometry: Some(calipers_client::geometry::cuboid(half.to_array())),
        pose: Some(proto::Pose { position: Some(proto::Vec3 { x, y, z }), rotation: None }),
        follow_id: region.follow.map_or(0, NonZeroU64::get),
    }
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// The value that a share of the sorted ones is at or below.
fn at(values: &[f64], share: f64) -> f64 {
    values[(share * (values.len() - 1) as f64) as usize]
}
