//! Laws of seeing: it is mutual, it is what a ray says, and what one is oneself hides nothing.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::Work,
    math::Pose,
    narrow::{self, Placed},
    shape::Geometry,
    world::{Filter, Meter, Seen, SeenCount, Shape, Sight, Snapshot},
};

use crate::random::Random;
use crate::scene::{Frame, id, random_filter, random_shapes, ray, shape, world_of};

fn look(world: &Snapshot, eye: DVec3, point: DVec3, filter: &Filter) -> Seen {
    let sight = Sight { eye, point, max_distance: 4e12 };
    world.sight(&sight, filter, &Accuracy::default(), &mut Meter::new(&mut || true)).expect("an answer")
}

/// What the kernels say of each shape that may hide.
fn brute(shapes: &[Shape], eye: DVec3, point: DVec3) -> Seen {
    let mut seen = Seen::Visible;
    for shape in shapes.iter().filter(|shape| !shape.sensor) {
        let mut ray = ray(eye, point - eye);
        ray.max_distance = (point - eye).length();
        let there = Placed { geometry: &shape.geometry, pose: shape.pose };
        let touches = narrow::raycast(&ray, there, &Accuracy::default(), &mut Work::default());
        if touches.certain.is_some() {
            return Seen::Hidden;
        }
        if touches.undecided.is_some() {
            seen = Seen::Undecided;
        }
    }
    seen
}

#[test]
fn seeing_is_mutual_and_what_the_kernels_say_of_each_shape() {
    let mut random = Random::new(5);
    let (mut visible, mut asked) = (0, 0);
    for frame in [Frame::UNIT, Frame { scale: 1e-3, origin: DVec3::new(1e3, -5e3, 2e3) }] {
        for _ in 0..6 {
            let shapes = random_shapes(&mut random, frame, 40);
            let world = world_of(shapes.clone()).newest();
            for _ in 0..60 {
                let [eye, point] = [(); 2].map(|()| frame.origin + random.vector() * 6.0 * frame.scale);
                let seen = look(&world, eye, point, &Filter::default());
                assert_eq!(seen, look(&world, point, eye, &Filter::default()), "{eye} {point}");
                let expected = brute(&shapes, eye, point);
                // From the other end rounding may leave open what it does not from this one.
                let is_open = [seen, expected].contains(&Seen::Undecided);
                assert!(seen == expected || is_open, "{seen:?} is not {expected:?}: {eye} {point}");
                let filter = random_filter(&mut random);
                assert_eq!(look(&world, eye, point, &filter), look(&world, point, eye, &filter));
                // What fewer shapes may hide is seen if it was.
                assert!(seen != Seen::Visible || look(&world, eye, point, &filter) == Seen::Visible);
                asked += 1;
                visible += usize::from(seen == Seen::Visible);
            }
        }
    }
    assert!((asked * 3..asked * 7).contains(&(visible * 10)), "vacuous: {visible} of {asked}");
}

#[test]
fn one_does_not_hide_from_oneself_sensors_hide_nothing_and_touching_the_end_does() {
    let ball = Arc::new(Geometry::sphere(1.0).expect("a sphere"));
    let at = |number: u64, x: f64| shape(number, Arc::clone(&ball), Pose::at(DVec3::X * x));
    let world = world_of([at(1, 0.0), at(2, 10.0), Shape { sensor: true, ..at(3, 5.0) }]).newest();
    let (eye, point) = (DVec3::ZERO, DVec3::X * 10.0);
    assert_eq!(look(&world, eye, point, &Filter::default()), Seen::Hidden, "each is in a ball");
    let without =
        |ids: &[u64]| Filter { exclude_ids: ids.iter().map(|&number| id(number)).collect(), ..Filter::default() };
    assert_eq!(look(&world, eye, point, &without(&[1])), Seen::Hidden);
    assert_eq!(look(&world, eye, point, &without(&[1, 2])), Seen::Visible);
    // A surface that goes through the point is not proved to leave it free; a hand's breadth before, it is seen.
    assert_ne!(look(&world, DVec3::X * 3.0, DVec3::X * 9.0, &Filter::default()), Seen::Visible);
    assert_eq!(look(&world, DVec3::X * 3.0, DVec3::X * 9.001, &Filter::default()), Seen::Hidden);
    assert_eq!(look(&world, DVec3::X * 3.0, DVec3::X * 8.9, &Filter::default()), Seen::Visible);
    // From a place to itself there is nothing but what is there.
    assert_eq!(look(&world, DVec3::X * 5.0, DVec3::X * 5.0, &Filter::default()), Seen::Visible);
    assert_eq!(look(&world, point, point, &Filter::default()), Seen::Hidden);
}

#[test]
fn what_is_too_far_is_not_looked_at_and_counted_nowhere() {
    let world = world_of([]).newest();
    let mut count = SeenCount::default();
    for (max_distance, expected) in [(5.0, Seen::Visible), (4.9, Seen::Beyond)] {
        let sight = Sight { eye: DVec3::ZERO, point: DVec3::new(3.0, 4.0, 0.0), max_distance };
        let mut go_on = || true;
        let meter = &mut Meter::new(&mut go_on);
        let seen = world.sight(&sight, &Filter::default(), &Accuracy::default(), meter).expect("an answer");
        assert_eq!(seen, expected);
        count.add(seen);
    }
    [Seen::Hidden, Seen::Undecided, Seen::Hidden].into_iter().for_each(|seen| count.add(seen));
    assert_eq!(count, SeenCount { visible: 1, hidden: 2, undecided: 1 });
}
