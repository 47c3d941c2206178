//! Bodies of a world in contact: which contacts count, who can be pushed, and what is kept.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::Verdict,
    math::Pose,
    shape::Geometry,
    world::{
        Body, Filter, Impulse, Meter, Mobility, QuestionError, Resolve, Resolved, Shape, ShapeId, Snapshot, World,
    },
};

use crate::random::Random;
use crate::scene::{id, shape, world_of};

fn ball(number: u64, place: DVec3, velocity: DVec3) -> Shape {
    let geometry = Arc::new(Geometry::sphere(1.0).expect("a sphere"));
    Shape { velocity, ..shape(number, geometry, Pose::at(place)) }
}

fn floor(number: u64) -> Shape {
    let geometry = Arc::new(Geometry::cuboid(DVec3::new(20.0, 0.5, 20.0)).expect("a box"));
    Shape { mobility: Mobility::Static, ..shape(number, geometry, Pose::at(DVec3::Y * -0.5)) }
}

fn body(number: u64) -> Body {
    Body {
        id: id(number),
        mass: 2.0,
        center: DVec3::ZERO,
        inertia: Some(DVec3::splat(0.8)),
        velocity: None,
        angular_velocity: None,
        friction: 0.0,
        restitution: 0.0,
    }
}

fn resolve(world: &Snapshot, bodies: Vec<Body>) -> Resolved {
    try_resolve(world, bodies, &Filter::default()).expect("an answer")
}

fn try_resolve(world: &Snapshot, bodies: Vec<Body>, filter: &Filter) -> Result<Resolved, QuestionError> {
    let question = Resolve { bodies, passes: 32, allowed_depth: 0.0, correction: 1.0 };
    let mut keep_going = || true;
    world.resolve(&question, filter, &Accuracy::default(), &mut Meter::new(&mut keep_going))
}

fn pairs(resolved: &Resolved) -> Vec<(u64, u64)> {
    resolved.impulses.iter().map(|impulse| (impulse.id.get(), impulse.other_id.get())).collect()
}

#[test]
fn a_ball_that_falls_on_a_floor_bounces_and_is_lifted_out() {
    let world = world_of([floor(1), ball(2, DVec3::Y * 0.75, DVec3::new(1.0, -4.0, 0.0))]);
    let found = resolve(&world.newest(), vec![Body { restitution: 0.5, ..body(2) }]);
    assert_eq!((found.verdict, pairs(&found)), (Verdict::Hit, vec![(2, 1)]));
    let change = found.changes[0];
    assert!((change.velocity - DVec3::new(1.0, 2.0, 0.0)).length() < 1e-9, "{change:?}");
    assert!((change.translation - DVec3::Y * 0.25).length() < 1e-9, "{change:?}");
    assert!((found.impulses[0].impulse - DVec3::Y * 12.0).length() < 1e-9, "{:?}", found.impulses);
    // The world is as it was.
    assert_eq!(world.newest().shape(id(2)).expect("a ball").velocity, DVec3::new(1.0, -4.0, 0.0));
}

#[test]
fn two_bodies_have_one_contact_and_opposite_impulses() {
    let world = world_of([
        ball(3, DVec3::ZERO, DVec3::X * 3.0),
        ball(2, DVec3::X * 1.5, DVec3::X * -1.0),
        ball(9, DVec3::X * 90.0, DVec3::X),
    ]);
    let bodies = || vec![body(3), body(2), body(9)];
    let found = resolve(&world.newest(), bodies());
    assert_eq!(pairs(&found), [(2, 3)]);
    assert_eq!(found.changes.iter().map(|change| change.id.get()).collect::<Vec<_>>(), [3, 2, 9]);
    let velocities: Vec<DVec3> = found.changes.iter().map(|change| change.velocity).collect();
    assert!((velocities[0] - DVec3::X).length() < 1e-9 && (velocities[1] - DVec3::X).length() < 1e-9, "{velocities:?}");
    assert_eq!(velocities[2], DVec3::X);
    assert!((found.changes[0].translation + found.changes[1].translation).length() < 1e-12);
    // One that is not among the bodies goes its way.
    let alone = resolve(&world.newest(), vec![body(3)]);
    assert!((alone.changes[0].velocity + DVec3::X).length() < 1e-9, "{alone:?}");
    assert_eq!(pairs(&alone), [(3, 2)]);
}

#[test]
fn what_is_free_is_not_pushed_and_sensors_push_nothing() {
    let sensor = Shape { sensor: true, ..ball(5, DVec3::X * 0.5, DVec3::ZERO) };
    let world = world_of([ball(2, DVec3::ZERO, DVec3::X), sensor]);
    let found = resolve(&world.newest(), vec![body(2)]);
    assert_eq!((found.verdict, found.impulses.len()), (Verdict::Miss, 0));
    assert_eq!((found.changes[0].velocity, found.changes[0].translation), (DVec3::X, DVec3::ZERO));
}

#[test]
fn static_and_kinematic_bodies_lend_their_surface_and_stay() {
    let platform = Shape { mobility: Mobility::Kinematic, velocity: DVec3::Y * 2.0, ..floor(1) };
    let world = world_of([platform, ball(2, DVec3::Y * 0.9, DVec3::ZERO)]);
    let found = resolve(&world.newest(), vec![Body { restitution: 1.0, ..body(1) }, body(2)]);
    assert_eq!(found.changes[0].velocity, DVec3::Y * 2.0);
    assert_eq!(found.changes[0].translation, DVec3::ZERO);
    assert!((found.changes[1].velocity - DVec3::Y * 4.0).length() < 1e-9, "{found:?}");
}

#[test]
fn friction_is_the_mean_of_two_and_turns_what_can_turn() {
    let world = world_of([floor(1), ball(2, DVec3::Y * 0.999, DVec3::new(3.0, -1.0, 0.0))]);
    let sliding = |friction, of_floor| {
        let bodies = vec![Body { friction, ..body(2) }, Body { friction: of_floor, ..body(1) }];
        let found = resolve(&world.newest(), bodies);
        let [Impulse { impulse, .. }] = found.impulses[..] else { panic!("{found:?}") };
        // It acts on the floor, whose id is the lower one; the opposite acts on the ball.
        (-impulse, found.changes[0])
    };
    let (impulse, change) = sliding(0.04, 0.25);
    assert!((impulse - DVec3::new(-0.2, 2.0, 0.0)).length() < 1e-3, "{impulse}");
    assert!(change.angular_velocity.z < -0.1 && change.velocity.x < 3.0, "{change:?}");
    let (impulse, change) = sliding(0.0, 0.25);
    assert!(impulse.x.abs() < 1e-12 && change.angular_velocity.length() < 1e-12, "{impulse}");
}

#[test]
fn momentum_is_kept_in_a_heap() {
    let mut random = Random::new(3);
    let balls: Vec<Shape> = (1..=30).map(|number| ball(number, random.vector() * 3.0, random.vector() * 2.0)).collect();
    let before: DVec3 = balls.iter().map(|ball| ball.velocity * 2.0).sum();
    let world = world_of(balls);
    let bodies: Vec<Body> = (1..=30).map(|number| Body { friction: 0.5, restitution: 0.3, ..body(number) }).collect();
    let found = resolve(&world.newest(), bodies.clone());
    let after: DVec3 = found.changes.iter().map(|change| change.velocity * 2.0).sum();
    assert!((after - before).length() < 1e-9 && found.impulses.len() > 30, "{} impulses", found.impulses.len());
    let order: Vec<(ShapeId, ShapeId)> = found.impulses.iter().map(|impulse| (impulse.id, impulse.other_id)).collect();
    assert!(order.is_sorted());
    // In whatever order the bodies are given, it is the same answer.
    let reversed = resolve(&world.newest(), bodies.into_iter().rev().collect());
    for (change, other) in found.changes.iter().zip(reversed.changes.iter().rev()) {
        assert_eq!((change.id, change.velocity, change.translation), (other.id, other.velocity, other.translation));
    }
}

#[test]
fn a_body_that_is_not_there_is_told() {
    let world: World = world_of([floor(1)]);
    let refusal = try_resolve(&world.newest(), vec![body(7)], &Filter::default()).expect_err("it is not there");
    assert_eq!(refusal, QuestionError::SubjectNotFound(id(7)));
}
