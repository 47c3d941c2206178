//! Bullets: what is swept and what is not, and what the report says of one bullet on its way.

use std::{f64::consts::FRAC_PI_2, sync::Arc};

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::{Method, Verdict, Work},
    math::Pose,
    narrow::InitialTouch,
    shape::Geometry,
    world::{
        BULLET_HITS_MAX, Edit, EditRule, Filter, HitMode, Meter, Mobility, Shape, Subject, SweepHit, SweepRule, Swept,
        Time, TimeOfImpact, World,
    },
};

use crate::random::Random;
use crate::scene::{Frame, half_spaces, id, random_pose, random_shapes, shape, world_of};

pub(crate) fn ball(number: u64, radius: f64, position: DVec3) -> Shape {
    shape(number, Arc::new(Geometry::sphere(radius).expect("a sphere")), Pose::at(position))
}

pub(crate) fn bullet(shape: Shape) -> Shape {
    Shape { bullet: true, ..shape }
}

/// A wall across x, as thin as told.
fn fence(number: u64, thickness: f64, x: f64) -> Shape {
    let geometry = Geometry::cuboid(DVec3::new(0.5 * thickness, 4.0, 4.0)).expect("a box");
    shape(number, Arc::new(geometry), Pose::at(DVec3::X * x))
}

pub(crate) fn to(number: u64, pose: Pose) -> Edit {
    Edit::Move {
        id: id(number),
        position: Some(pose.position),
        rotation: Some(pose.rotation),
        velocity: None,
        angular_velocity: None,
        teleport: false,
    }
}

pub(crate) fn teleport(number: u64, position: DVec3) -> Edit {
    Edit::Move {
        id: id(number),
        position: Some(position),
        rotation: None,
        velocity: None,
        angular_velocity: None,
        teleport: true,
    }
}

pub(crate) fn tick(world: &mut World, edits: Vec<Edit>) -> Swept {
    world.apply(edits, Time(0), EditRule::AllOrNothing).expect("a tick").swept
}

fn touched(swept: &Swept) -> Vec<(u64, u64)> {
    let ids = |hit: &SweepHit| (hit.bullet.get(), hit.impact.id.expect("a shape of the world").get());
    swept.hits.iter().map(ids).collect()
}

const FAR: Pose = Pose::at(DVec3::new(5.0, 0.0, 0.0));

#[test]
fn what_no_pose_shows_is_reported_with_its_time() {
    let mut world = world_of([bullet(ball(1, 0.1, DVec3::X * -5.0)), fence(2, 1e-3, 0.0)]);
    let swept = tick(&mut world, vec![to(1, FAR)]);
    assert_eq!(touched(&swept), [(1, 2)]);
    let touch = &swept.hits[0].impact.touch;
    let truth = (5.0 - 0.1 - 5e-4) / 10.0;
    assert!((touch.fraction - truth).abs() < 1e-14 && touch.certificate.verdict == Verdict::Hit, "{touch:?}");
    assert!(touch.certificate.bound.lower <= truth + 1e-16 && truth - 1e-16 <= touch.certificate.bound.upper);
    assert_eq!((touch.normal_b_to_a, touch.initial), (Some(-DVec3::X), false));
    assert_eq!(swept.hits[0].impact.user_data, 20);
    // Back by another way.
    let around = tick(&mut world, vec![to(1, Pose::at(DVec3::new(5.0, 9.0, 0.0)))]);
    assert!(around.hits.is_empty() && around.work != Work::default());
}

#[test]
fn a_turn_is_swept_too() {
    // A stick along y turns by 2 radians about z: after a quarter turn it touches the ball from above.
    let stick = shape(1, Arc::new(Geometry::capsule(1.0, 0.0).expect("a stick")), Pose::IDENTITY);
    let mut world = world_of([bullet(stick), ball(2, 0.25, DVec3::new(-0.5, -0.25, 0.0))]);
    let turned = DQuat::from_xyzw(0.0, 0.0, 1.0_f64.sin(), 1.0_f64.cos());
    let swept = tick(&mut world, vec![to(1, Pose::new(DVec3::ZERO, turned))]);
    assert_eq!(touched(&swept), [(1, 2)]);
    let touch = &swept.hits[0].impact.touch;
    assert!((touch.fraction - FRAC_PI_2 / 2.0).abs() < 1e-5, "{touch:?}");
    let bound = touch.certificate.bound;
    assert!(bound.lower <= FRAC_PI_2 / 2.0 + 1e-15 && FRAC_PI_2 / 2.0 - 1e-15 <= bound.upper, "{bound:?}");
}

#[test]
fn only_moves_of_bullets_are_swept_and_nothing_else_costs_anything() {
    let nothing = |swept: &Swept| swept.hits.is_empty() && !swept.truncated && swept.work == Work::default();
    let plain = ball(1, 0.1, DVec3::X * -5.0);
    let mut world = world_of([plain.clone(), fence(2, 0.1, 0.0)]);
    assert!(nothing(&tick(&mut world, vec![to(1, FAR)])), "no bullet");
    // A bullet that comes, replaces another, is teleported, teleported before it is moved, or is not moved.
    let mut world = world_of([fence(2, 0.1, 0.0)]);
    assert!(nothing(&tick(&mut world, vec![Edit::Insert(bullet(plain.clone())), to(1, FAR)])));
    assert!(nothing(&tick(&mut world, vec![Edit::Insert(bullet(plain.clone()))])));
    assert!(nothing(&tick(&mut world, vec![Edit::Remove(id(1)), Edit::Insert(bullet(plain.clone())), to(1, FAR)])));
    assert!(nothing(&tick(&mut world, vec![teleport(1, DVec3::X * -5.0)])));
    assert!(nothing(&tick(&mut world, vec![teleport(1, DVec3::X * -6.0), to(1, FAR)])));
    assert!(nothing(&tick(&mut world, vec![to(2, Pose::at(DVec3::X * 9.0))])));
    assert!(nothing(&tick(&mut world, vec![to(1, Pose::IDENTITY), Edit::Remove(id(1))])));
    assert!(nothing(&tick(&mut world, vec![Edit::Clear, Edit::Insert(bullet(plain)), to(1, FAR)])));
    assert!(!nothing(&tick(&mut world, vec![to(1, Pose::IDENTITY)])), "this one is");
    assert!(nothing(&tick(&mut world, vec![Edit::Remove(id(1))])));
    assert!(nothing(&tick(&mut world, vec![Edit::Insert(ball(1, 0.1, DVec3::ZERO)), to(1, FAR)])));
}

#[test]
fn shapes_faster_than_a_share_of_their_size_are_swept_where_that_is_set() {
    let mut world = world_of([ball(1, 0.5, DVec3::X * -2.0), fence(2, 0.1, 0.0)]);
    let mut fly = |rule, x: f64| {
        world.set_sweep_rule(rule);
        let edits = vec![to(1, Pose::at(DVec3::X * x))];
        let found = touched(&tick(&mut world, edits));
        tick(&mut world, vec![teleport(1, DVec3::X * -2.0)]);
        found
    };
    // Its least extent is 1 m.
    assert!(fly(SweepRule::Bullets, 2.0).is_empty());
    assert_eq!(fly(SweepRule::FasterThan(2.0), 2.0), [(1, 2)]);
    assert!(fly(SweepRule::FasterThan(4.5), 2.0).is_empty());
    assert_eq!(fly(SweepRule::FasterThan(0.0), 2.0), [(1, 2)]);
}

#[test]
fn who_is_a_pair_is_touched_and_sensors_are() {
    let start = bullet(ball(1, 0.1, DVec3::X * -5.0));
    let others = [
        Shape { sensor: true, ..fence(2, 0.1, 0.0) },
        Shape { layers: 2, ..fence(3, 0.1, 1.0) },
        Shape { collides_with: 4, ..fence(4, 0.1, 2.0) },
        Shape { group: 7, ..fence(5, 0.1, 3.0) },
        Shape { mobility: Mobility::Static, ..fence(6, 0.1, -1.0) },
    ];
    let fly = |shape: Shape| {
        let mut world = world_of(others.iter().cloned().chain([shape]));
        touched(&tick(&mut world, vec![to(1, FAR)]))
    };
    assert_eq!(fly(Shape { collides_with: 1, group: 7, ..start.clone() }), [(1, 6), (1, 2)]);
    assert_eq!(fly(Shape { mobility: Mobility::Static, sensor: true, ..start }), [(1, 2), (1, 3), (1, 5)]);
}

#[test]
fn through_a_world_that_stands_it_is_a_time_of_impact() {
    let mut random = Random::new(61);
    let (mut asked, mut hit_count) = (0, 0);
    for frame in [Frame::UNIT, Frame { scale: 1e-3, origin: DVec3::new(1e3, -2e3, 0.0) }] {
        let mut shapes = random_shapes(&mut random, frame, 50);
        shapes.extend(half_spaces(&mut random, frame, 51));
        shapes.iter_mut().for_each(|shape| shape.sensor = false);
        let mut world = world_of(shapes);
        for _ in 0..150 {
            let number = 1 + random.bits() % 50;
            let old = world.newest();
            let flown = old.shape(id(number)).expect("it is there").into_owned();
            let mut end = random_pose(&mut random, frame, 5.0);
            if random.unit() < 0.5 {
                end.rotation = flown.pose.rotation;
            }
            let flown = Shape { bullet: true, mobility: Mobility::Kinematic, ..flown };
            tick(&mut world, vec![Edit::Insert(flown.clone())]);
            let swept = tick(&mut world, vec![to(number, end)]);
            let question = TimeOfImpact {
                subject: Subject::Shape { id: flown.id, pose: Some(flown.pose) },
                displacement: end.position - flown.pose.position,
                rotation: flown.pose.rotation_vector_to(&end),
                against: None,
                against_displacement: DVec3::ZERO,
                against_rotation: DVec3::ZERO,
                initial: InitialTouch::Counts,
                mode: HitMode::All(BULLET_HITS_MAX),
            };
            let mut go_on = || true;
            let meter = &mut Meter::new(&mut go_on);
            let found = world.newest().time_of_impact(&question, &Filter::default(), &Accuracy::default(), meter);
            let found = found.expect("an answer");
            let impacts: Vec<_> = swept.hits.into_iter().map(|hit| hit.impact).collect();
            assert_eq!(format!("{impacts:?}"), format!("{:?}", found.hits));
            asked += 1;
            hit_count += impacts.len();
            tick(&mut world, vec![Edit::Insert(Shape { bullet: false, ..flown })]);
        }
    }
    assert!(hit_count > 2 * asked, "vacuous: {hit_count} of {asked}");
}

#[test]
fn the_first_touches_are_listed_and_a_crowd_costs_no_more_than_those() {
    let fences = (0..5000_u32).map(|i| fence(u64::from(i) + 10, 0.1, f64::from(i) * 0.5));
    let mut world = world_of(fences.chain([bullet(ball(1, 0.01, DVec3::X * -5.0))]));
    let swept = tick(&mut world, vec![to(1, Pose::at(DVec3::X * 3000.0))]);
    let expected: Vec<_> = (10..10 + BULLET_HITS_MAX as u64).map(|number| (1, number)).collect();
    assert_eq!((touched(&swept), swept.truncated), (expected, true));
    assert!(swept.work.shapes_tested < 70, "{:?}", swept.work);
}

#[test]
fn a_tick_with_too_much_to_sweep_says_so_and_ends() {
    // A thousand bullets in one place, each of which touches all others at once.
    let heap = (1..=1200).map(|number| bullet(ball(number, 1.0, DVec3::ZERO)));
    let mut world = world_of(heap);
    let moves: Vec<Edit> = (1..=1200).map(|number| to(number, Pose::at(DVec3::Y * number as f64))).collect();
    let swept = tick(&mut world, moves);
    assert!(swept.truncated);
    assert_eq!(swept.hits.len(), collision::world::SWEEP_HITS_MAX);
    assert!(swept.work.shapes_tested + swept.work.pairs_tested < 1 << 23);
    assert!(swept.hits.iter().all(|hit| hit.impact.touch.initial && hit.impact.touch.fraction == 0.0));
    assert!(swept.hits.iter().all(|hit| hit.impact.touch.certificate.method != Method::Bounds));
}
