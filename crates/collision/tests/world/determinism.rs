//! The same question on the same shapes has the same answer, bit by bit, whatever the world went through before.

use collision::{
    DVec3,
    world::{Edit, EditRule, Filter, Shape, Time, World},
};

use crate::random::Random;
use crate::scene::{
    Frame, ask, grid_shapes, id, random_filter, random_pose, random_questions, random_shapes, shape, world_of,
};

/// The same shapes in another order, moved to where they are through other places, among others that are gone.
pub(crate) fn by_detours(shapes: &[Shape], frame: Frame, random: &mut Random) -> World {
    let mut world = World::new(Time(0));
    let mut shuffled = shapes.to_vec();
    for last in (1..shuffled.len()).rev() {
        shuffled.swap(last, (random.bits() % (last as u64 + 1)) as usize);
    }
    let mut edits = Vec::new();
    for (number, wanted) in (10_000..).zip(&shuffled) {
        let stray = shape(number, wanted.geometry.clone(), random_pose(random, frame, 9.0));
        let mut elsewhere = wanted.clone();
        elsewhere.pose = random_pose(random, frame, 9.0);
        edits.extend([Edit::Insert(stray), Edit::Insert(elsewhere)]);
    }
    world.apply(edits, Time(0), EditRule::AllOrNothing).expect("a tick");
    for fraction in [0.3, 0.9, 1.0] {
        let moves = shuffled.iter().map(|wanted| {
            let offset = DVec3::ONE * (1.0 - fraction) * frame.scale;
            Edit::Move {
                id: wanted.id,
                position: Some(wanted.pose.position + offset),
                rotation: Some(wanted.pose.rotation),
                velocity: None,
                angular_velocity: None,
                teleport: false,
            }
        });
        world.apply(moves.collect(), Time(0), EditRule::AllOrNothing).expect("a tick");
    }
    let strays = (10_000..).zip(&shuffled).map(|(number, _)| Edit::Remove(id(number)));
    world.apply(strays.collect(), Time(0), EditRule::AllOrNothing).expect("a tick");
    world
}

/// The last one is for the grid.
pub(crate) const FRAMES: [Frame; 4] = [
    Frame::UNIT,
    Frame { scale: 1e-3, origin: DVec3::new(1e3, -2e3, 0.0) },
    Frame { scale: 1e5, origin: DVec3::new(0.0, 7e8, -1e9) },
    Frame::UNIT,
];

#[test]
fn answers_do_not_depend_on_what_the_world_went_through() {
    let mut random = Random::new(21);
    let mut hits = 0;
    let mut asked = 0;
    for scene in 0..8 {
        let frame = FRAMES[scene as usize % 4];
        let shapes = if scene % 4 == 3 { grid_shapes() } else { random_shapes(&mut random, frame, 40 + scene * 15) };
        let worlds =
            [world_of(shapes.clone()), world_of(shapes.iter().rev().cloned()), by_detours(&shapes, frame, &mut random)];
        let [first, others @ ..] = worlds.map(|world| world.newest());
        for _ in 0..60 {
            let filter = if random.unit() < 0.5 { Filter::default() } else { random_filter(&mut random) };
            for question in random_questions(&mut random, frame, shapes.len() as u64) {
                let answer = ask(&first, &question, &filter);
                asked += 1;
                hits += usize::from(answer.contains("verdict: Hit"));
                for other in &others {
                    assert_eq!(answer, ask(other, &question, &filter), "{question:?} with {filter:?}");
                }
            }
        }
    }
    assert!(hits * 10 > asked * 3 && hits * 10 < asked * 9, "vacuous: {hits} of {asked}");
}

/// Questions along the faces and through the corners of a grid of touching boxes, each of which is there twice.
#[test]
fn ties_are_settled_by_id() {
    let shapes = grid_shapes();
    let straight = world_of(shapes.clone()).newest();
    let reversed = world_of(shapes.into_iter().rev()).newest();
    let axes = [DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0), DVec3::ONE];
    for step in 0..9 {
        let offset = f64::from(step) * 0.25;
        for direction in axes {
            let origin = DVec3::new(-4.0, offset, 0.5);
            for mode in [collision::world::HitMode::Closest, collision::world::HitMode::All(7)] {
                let question = crate::scene::Question::Raycast(collision::world::Raycast {
                    ray: crate::scene::ray(origin, direction),
                    mode,
                });
                let filter = Filter::default();
                assert_eq!(ask(&straight, &question, &filter), ask(&reversed, &question, &filter), "{question:?}");
            }
        }
    }
}
