//! No reader ever sees half a tick while a writer runs.

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
};

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::Verdict,
    math::Pose,
    shape::Geometry,
    world::{
        Distance, Edit, EditRule, Filter, HitMode, Meter, Mobility, Raycast, Shape, Snapshot, Subject, Time, World,
    },
};

use crate::{
    random::Random,
    scene::{id, ray, shape},
};

/// Pairs of balls that always move together: the second is 10 m above the first.
const PAIRS: u64 = 200;
const TICKS: i64 = 400;
const APART: DVec3 = DVec3::new(0.0, 10.0, 0.0);

fn pair_at(pair: u64, geometry: &Arc<Geometry>, position: DVec3, mobility: Mobility) -> [Shape; 2] {
    [(2 * pair + 1, position), (2 * pair + 2, position + APART)]
        .map(|(number, position)| Shape { mobility, ..shape(number, Arc::clone(geometry), Pose::at(position)) })
}

/// A batch that moves some pairs and replaces others, first halves before all second halves.
fn tick(random: &mut Random, geometry: &Arc<Geometry>) -> Vec<Edit> {
    let (mut first_halves, mut second_halves) = (Vec::new(), Vec::new());
    for pair in 0..PAIRS {
        let position = random.vector() * 50.0;
        match random.bits() % 4 {
            0 => {}
            1 => {
                let mobility = if random.unit() < 0.5 { Mobility::Static } else { Mobility::Dynamic };
                let [first, second] = pair_at(pair, geometry, position, mobility);
                first_halves.extend([Edit::Remove(first.id), Edit::Insert(first)]);
                second_halves.push(Edit::Insert(second));
            }
            _ => {
                let move_to = |number, position| Edit::Move {
                    id: id(number),
                    position: Some(position),
                    rotation: None,
                    velocity: None,
                    angular_velocity: None,
                    teleport: false,
                };
                first_halves.push(move_to(2 * pair + 1, position));
                second_halves.push(move_to(2 * pair + 2, position + APART));
            }
        }
    }
    first_halves.extend(second_halves);
    first_halves
}

/// Through `shape()`, and through a ray and a distance, which go through the trees.
fn assert_whole(snapshot: &Snapshot, pair: u64) {
    let (first, second) = (id(2 * pair + 1), id(2 * pair + 2));
    let position = snapshot.shape(first).expect("it is always there").pose.position;
    let above = snapshot.shape(second).expect("it is always there").pose.position;
    assert_eq!(above, position + APART, "half of tick {}", snapshot.tick());
    assert_eq!(snapshot.len() as u64, 2 * PAIRS);

    let filter = Filter::default();
    let accuracy = Accuracy::default();
    let mut go_on = || true;
    let meter = &mut Meter::new(&mut go_on);
    let question = Raycast { ray: ray(above, -DVec3::Y), mode: HitMode::All(usize::MAX) };
    let found = snapshot.raycast(&question, &filter, &accuracy, meter).expect("an answer");
    for (id, distance) in [(first, 9.5), (second, 0.0)] {
        let hit = found.hits.iter().find(|hit| hit.id == Some(id)).expect("the ray goes through both");
        assert!((hit.touch.distance - distance).abs() < 1e-9, "{hit:?}");
    }
    let question = Distance {
        subject: Subject::Shape { id: first, pose: Some(Pose::at(above)) },
        against: None,
        max_distance: 0.0,
        max_hits: usize::MAX,
    };
    let found = snapshot.distance(&question, &filter, &accuracy, meter).expect("an answer");
    assert_eq!(found.verdict, Verdict::Hit);
    assert!(found.hits.iter().any(|hit| hit.id == Some(second)));
}

#[test]
fn no_reader_sees_half_a_tick() {
    let geometry = Arc::new(Geometry::sphere(0.5).expect("a sphere"));
    let mut random = Random::new(41);
    let mut world = World::new(Time(0));
    let pairs = (0..PAIRS).flat_map(|pair| pair_at(pair, &geometry, random.vector() * 50.0, Mobility::Dynamic));
    world.apply(pairs.map(Edit::Insert).collect(), Time(0), EditRule::AllOrNothing).expect("a tick");

    let published = Mutex::new(world.newest());
    let is_over = AtomicBool::new(false);
    let looks = AtomicU64::new(0);
    thread::scope(|scope| {
        for reader in 0..3 {
            let (published, is_over, looks) = (&published, &is_over, &looks);
            scope.spawn(move || {
                let mut random = Random::new(100 + reader);
                let mut kept: Option<Arc<Snapshot>> = None;
                let mut last = 0;
                while !is_over.load(Ordering::Relaxed) {
                    let snapshot = Arc::clone(&published.lock().expect("no reader panicked"));
                    assert!(snapshot.tick().get() >= last, "time does not run backwards");
                    last = snapshot.tick().get();
                    for _ in 0..5 {
                        assert_whole(&snapshot, random.bits() % PAIRS);
                    }
                    looks.fetch_add(1, Ordering::Relaxed);
                    // An old version is looked at again while the writer reuses what it may.
                    assert_whole(kept.get_or_insert_with(|| Arc::clone(&snapshot)), random.bits() % PAIRS);
                    if random.unit() < 0.06 {
                        kept = None;
                    }
                }
            });
        }
        let mut ticks = 0;
        // So that a slow machine's readers get their turn too.
        while ticks < TICKS || looks.load(Ordering::Relaxed) < 100 {
            ticks += 1;
            let edits = tick(&mut random, &geometry);
            world.apply(edits, Time(ticks), EditRule::AllOrNothing).expect("a tick");
            *published.lock().expect("no reader panicked") = world.newest();
            if published.is_poisoned() || ticks > 1_000_000 {
                break;
            }
        }
        is_over.store(true, Ordering::Relaxed);
    });
    assert!(looks.into_inner() >= 100);
}
