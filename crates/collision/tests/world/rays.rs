//! Many rays at a time answer as each does by itself, and take the same steps.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::Work,
    math::Pose,
    narrow::Ray,
    shape::Geometry,
    world::{
        Edit, EditRule, Filter, Found, HitMode, Meter, Mobility, Moment, QuestionError, RayHit, Raycast, Shape,
        ShapeId, Snapshot, Time, World,
    },
};

use crate::{
    history::world_with_history,
    random::Random,
    scene::{Frame, half_spaces, id, random_filter, random_mode, random_shapes, ray, shape},
};

/// So many that rays go side by side.
const SHAPES: u64 = 70_000;

/// Shapes of all kinds near the origin, among balls of which a third is static and every fourth lies `away`; and some that no tree holds.
fn crowd(random: &mut Random, away: DVec3) -> World {
    let mut shapes = random_shapes(random, Frame::UNIT, 60);
    let ball = Arc::new(Geometry::sphere(0.05).expect("a sphere"));
    for number in 61..=SHAPES {
        let offset = if number % 4 == 0 { away } else { DVec3::ZERO };
        let mobility = if number % 3 == 0 { Mobility::Static } else { Mobility::Dynamic };
        let place = Pose::at(offset + random.vector() * 12.0);
        shapes.push(Shape { mobility, sensor: number % 11 == 0, ..shape(number, Arc::clone(&ball), place) });
    }
    shapes.extend(half_spaces(random, Frame::UNIT, SHAPES + 1));
    let mut world = world_with_history(4);
    world.apply(shapes.into_iter().map(Edit::Insert).collect(), Time(1), EditRule::AllOrNothing).expect("a tick");
    world
}

fn rays(random: &mut Random, count: usize) -> Vec<(Raycast, Option<ShapeId>)> {
    let one = |random: &mut Random| {
        let max_distance = if random.unit() < 0.7 { random.unit() * 6.0 } else { 4e12 };
        let ray = Ray {
            min_distance: if random.unit() < 0.2 { 0.5 } else { 0.0 },
            max_distance,
            hollow: random.unit() < 0.3,
            ..ray(random.vector() * 9.0, random.vector())
        };
        let mode = match random.bits() % 5 {
            0 => HitMode::Any,
            1 => HitMode::Pierce { layers: 2, most: 5 },
            _ => random_mode(random),
        };
        (Raycast { ray, mode }, (random.unit() < 0.5).then(|| id(1 + random.bits() % 60)))
    };
    (0..count).map(|_| one(random)).collect()
}

/// The same rays one by one.
fn each(
    world: &Snapshot,
    rays: &[(Raycast, Option<ShapeId>)],
    filter: &Filter,
) -> Result<(Vec<Found<RayHit>>, Work), QuestionError> {
    let (mut found, mut work) = (Vec::new(), Work::default());
    for (question, unseen) in rays {
        let mut go_on = || true;
        let mut meter = Meter::new(&mut go_on);
        let exclude_ids = filter.exclude_ids.iter().copied().chain(*unseen).collect();
        let filter = Filter { exclude_ids, ..filter.clone() };
        found.push(world.raycast(question, &filter, &Accuracy::default(), &mut meter)?);
        work += meter.work;
    }
    Ok((found, work))
}

/// Checks groups of several sizes; returns how many rays hit something.
fn check(world: &Snapshot, random: &mut Random) -> usize {
    let mut hits = 0;
    for size in [0, 1, 5, 8, 9, 64, 200] {
        let (rays, filter) = (rays(random, size), random_filter(random));
        let (expected, work) = each(world, &rays, &filter).expect("answers");
        let mut go_on = || true;
        let mut meter = Meter::new(&mut go_on);
        let found = world.raycasts(&rays, &filter, &Accuracy::default(), &mut meter).expect("answers");
        assert_eq!(format!("{found:?}"), format!("{expected:?}"), "{size} rays");
        assert_eq!(meter.work, work, "{size} rays");
        hits += expected.iter().filter(|found| !found.hits.is_empty()).count();
    }
    hits
}

#[test]
fn rays_side_by_side_answer_and_cost_what_each_does_by_itself() {
    let mut random = Random::new(9);
    // Of one cell, and of two, which are too far apart for one.
    for away in [DVec3::ZERO, DVec3::X * 1e6] {
        let mut world = crowd(&mut random, away);
        let hits = check(&world.newest(), &mut random);
        assert!(hits > 100, "vacuous: {hits} hits");
        let moves = (61..5000).map(|number| Edit::Move {
            id: id(number),
            position: Some(random.vector() * 12.0),
            rotation: None,
            velocity: None,
            angular_velocity: None,
            teleport: false,
        });
        let moves = moves.collect();
        world.apply(moves, Time(2), EditRule::AllOrNothing).expect("a tick");
        let newest = world.newest();
        check(&newest, &mut random);
        let before = newest.at(Moment::Between(newest.oldest_tick().saturating_add(1), 0.25)).expect("held");
        check(&before, &mut random);
    }
    check(&World::new(Time(0)).newest(), &mut random);
}

#[test]
fn rays_side_by_side_end_when_their_caller_says() {
    let mut random = Random::new(3);
    let world = crowd(&mut random, DVec3::ZERO).newest();
    let rays = rays(&mut random, 500);
    let mut stop = || false;
    let found = world.raycasts(&rays, &Filter::default(), &Accuracy::default(), &mut Meter::new(&mut stop));
    assert_eq!(found.unwrap_err(), QuestionError::Interrupted);
    let mut go_on = || true;
    let mut meter = Meter::new(&mut go_on).with_limit(1000);
    let found = world.raycasts(&rays, &Filter::default(), &Accuracy::default(), &mut meter);
    assert_eq!(found.unwrap_err(), QuestionError::TooLong(1000));
}
