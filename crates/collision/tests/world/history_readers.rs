//! Readers of the past while a writer goes on: what they find is whole, and it is that of the moment they asked for.

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
};

use collision::{
    DVec3,
    math::Pose,
    shape::Geometry,
    world::{Edit, EditRule, Filter, HitMode, Moment, Raycast, Snapshot, Tick, Time},
};

use crate::{
    history::world_with_history,
    random::Random,
    scene::{Question, ask, id, ray, shape},
};

const SHAPES: u64 = 300;
const TICKS: i64 = 300;

/// Where a shape is at a tick: up by a metre a tick, and every seventh shape rests.
fn place(number: u64, tick: f64) -> DVec3 {
    let height = if number.is_multiple_of(7) { 0.0 } else { tick };
    DVec3::new(number as f64 * 3.0, height, 0.0)
}

fn assert_right(past: &Snapshot, number: u64) {
    let wanted = place(number, past.tick().get() as f64 + past.fraction());
    let position = past.shape(id(number)).expect("it is always there").pose.position;
    assert!((position - wanted).length() < 1e-9, "{position} at {} + {}", past.tick(), past.fraction());
    // Down onto it, past where it is at other ticks.
    let question = Raycast { ray: ray(DVec3::new(wanted.x, 1e6, 0.0), -DVec3::Y), mode: HitMode::Closest };
    let answer = ask(past, &Question::Raycast(question), &Filter::default());
    let distance = 1e6 - wanted.y - 0.5;
    let found = answer.split("distance: ").nth(1).and_then(|rest| rest.split(',').next()).expect("a hit");
    assert!((found.parse::<f64>().expect("a number") - distance).abs() < 1e-6, "{answer}");
}

#[test]
fn readers_of_the_past_find_it_whole_while_a_writer_goes_on() {
    let geometry = Arc::new(Geometry::sphere(0.5).expect("a sphere"));
    let mut world = world_with_history(50);
    let shapes = (1..=SHAPES).map(|number| shape(number, Arc::clone(&geometry), Pose::at(place(number, 2.0))));
    world.apply(shapes.map(Edit::Insert).collect(), Time(2), EditRule::AllOrNothing).expect("a tick");
    let published = Mutex::new(world.newest());
    let (is_over, looks) = (AtomicBool::new(false), AtomicU64::new(0));
    thread::scope(|scope| {
        for reader in 0..3 {
            let (published, is_over, looks) = (&published, &is_over, &looks);
            scope.spawn(move || {
                let mut random = Random::new(200 + reader);
                let mut kept: Option<Arc<Snapshot>> = None;
                while !is_over.load(Ordering::Relaxed) {
                    let newest = Arc::clone(&published.lock().expect("no reader panicked"));
                    // An old version asks for what the newest no longer holds.
                    for version in [Arc::clone(kept.get_or_insert_with(|| Arc::clone(&newest))), newest] {
                        let (oldest, tick) = (version.oldest_tick().max(Tick::MIN.saturating_add(1)), version.tick());
                        let asked = oldest.saturating_add(random.bits() % (tick.get() - oldest.get() + 1));
                        let moment = match random.bits() % 3 {
                            0 => Moment::Tick(asked),
                            1 => Moment::Time(Time(asked.get() as i64)),
                            _ if asked < tick => Moment::Between(asked, random.unit() * 0.99),
                            _ => Moment::Tick(tick),
                        };
                        let past = version.at(moment).expect("it is held");
                        assert_eq!(past.tick(), asked);
                        assert_right(&past, 1 + random.bits() % SHAPES);
                    }
                    looks.fetch_add(1, Ordering::Relaxed);
                    if random.unit() < 0.05 {
                        kept = None;
                    }
                }
            });
        }
        let mut tick = 2;
        while tick < TICKS || looks.load(Ordering::Relaxed) < 300 {
            tick += 1;
            let moving = (1..=SHAPES).filter(|number| !number.is_multiple_of(7));
            let moves = moving.map(|number| Edit::Move {
                id: id(number),
                position: Some(place(number, tick as f64)),
                rotation: None,
                velocity: None,
                angular_velocity: None,
                teleport: false,
            });
            world.apply(moves.collect(), Time(tick), EditRule::AllOrNothing).expect("a tick");
            *published.lock().expect("no reader panicked") = world.newest();
            if published.is_poisoned() || tick > 1_000_000 {
                break;
            }
        }
        is_over.store(true, Ordering::Relaxed);
    });
    assert!(looks.into_inner() >= 300);
}
