//! Laws of the past: a tick answers later as it did when it was the newest, bit by bit, and a moment between two ticks
//! answers as a world of the interpolated shapes does.

use std::sync::Arc;

use collision::{
    DQuat, DVec3,
    math::Pose,
    world::{Edit, EditRule, Filter, Means, Mobility, Moment, Settings, Shape, Snapshot, Tick, Time, World},
};

use crate::{
    random::Random,
    scene::{
        Frame, Question, ask, half_spaces, id, random_filter, random_geometry, random_pose, random_questions,
        random_shapes, shape, world_of,
    },
};

pub(crate) const SHAPES: u64 = 60;
const HISTORY: u32 = 40;

pub(crate) fn world_with_history(ticks: u32) -> World {
    World::with(Time(0), Settings { history_ticks: ticks, ..Settings::default() }, Means::default())
}

fn random_move(random: &mut Random, frame: Frame, number: u64) -> Edit {
    let mut maybe = |chance: f64| random.unit() < chance;
    let (moves, turns, teleport, speeds) = (maybe(0.8), maybe(0.5), maybe(0.2), maybe(0.3));
    let pose = random_pose(random, frame, 4.0);
    Edit::Move {
        id: id(number),
        position: moves.then_some(pose.position),
        rotation: turns.then_some(pose.rotation),
        velocity: speeds.then_some(random.vector()),
        angular_velocity: speeds.then_some(random.vector()),
        teleport,
    }
}

/// What happens in a tick: moves, teleports, removals, returns of the same or of another form, other layers, sometimes
/// several to one shape, and now and then the end of everything.
pub(crate) fn random_tick(random: &mut Random, frame: Frame) -> Vec<Edit> {
    if random.unit() < 0.03 {
        let mut edits = vec![Edit::Clear];
        edits.extend(random_shapes(random, frame, SHAPES / 2).into_iter().map(Edit::Insert));
        return edits;
    }
    let mut edits = Vec::new();
    for _ in 0..random.bits() % 30 {
        let number = 1 + random.bits() % SHAPES;
        edits.push(match random.unit() {
            0.0..0.7 => random_move(random, frame, number),
            0.7..0.85 => Edit::Remove(id(number)),
            _ => Edit::Insert(Shape {
                layers: 1 << (random.bits() % 3),
                mobility: [Mobility::Static, Mobility::Dynamic, Mobility::Kinematic][(random.bits() % 3) as usize],
                sensor: random.unit() < 0.2,
                group: (random.bits() % 3) as u32,
                ..shape(number, random_geometry(random, frame), random_pose(random, frame, 4.0))
            }),
        });
    }
    edits
}

/// All that a snapshot says of a shape, of its geometry only which it is: that builds structures as it goes.
fn told(shape: &Shape) -> String {
    let Shape { id, geometry, pose, layers, collides_with, mobility, sensor, group, user_data, velocity, .. } = shape;
    let flags = (layers, collides_with, mobility, sensor, group, user_data);
    format!("{id} {:p} {pose:?} {flags:?} {velocity} {}", Arc::as_ptr(geometry), shape.angular_velocity)
}

/// All that a snapshot says of its shapes.
fn contents(snapshot: &Snapshot) -> Vec<String> {
    let singly = (1..=SHAPES + 9).filter_map(|number| snapshot.shape(id(number)));
    let singly: Vec<String> = singly.map(|shape| told(&shape)).collect();
    let listed = snapshot.shapes_after(None, usize::MAX, None);
    assert_eq!(listed.into_iter().map(told).collect::<Vec<_>>(), singly);
    let boxes = (1..=SHAPES + 9).map(|number| format!("{:?}", snapshot.bounds_of(id(number))));
    let summary = format!("{:?} {}", snapshot.time(), snapshot.len());
    singly.into_iter().chain(boxes).chain([summary]).collect()
}

struct Said {
    tick: Tick,
    contents: Vec<String>,
    answers: Vec<(Question, Filter, String)>,
}

fn listen(snapshot: &Snapshot, random: &mut Random, frame: Frame) -> Said {
    let mut answers = Vec::new();
    for _ in 0..2 {
        let filter = if random.unit() < 0.5 { Filter::default() } else { random_filter(random) };
        for question in random_questions(random, frame, SHAPES) {
            let answer = ask(snapshot, &question, &filter);
            answers.push((question, filter.clone(), answer));
        }
    }
    Said { tick: snapshot.tick(), contents: contents(snapshot), answers }
}

fn first_shapes(random: &mut Random, frame: Frame) -> Vec<Edit> {
    let shapes = random_shapes(random, frame, SHAPES).into_iter().chain(half_spaces(random, frame, SHAPES + 1));
    shapes.map(Edit::Insert).collect()
}

const FRAMES: [Frame; 3] = [
    Frame::UNIT,
    Frame { scale: 1e-3, origin: DVec3::new(1e3, -2e3, 0.0) },
    Frame { scale: 1e5, origin: DVec3::new(0.0, 7e8, -1e9) },
];

#[test]
fn a_tick_answers_later_as_it_did_when_it_was_the_newest() {
    let mut random = Random::new(31);
    let (mut hits, mut asked) = (0, 0);
    for frame in FRAMES {
        let mut world = world_with_history(HISTORY);
        world.apply(first_shapes(&mut random, frame), Time(0), EditRule::AllOrNothing).expect("a tick");
        let mut said = vec![listen(&world.newest(), &mut random, frame)];
        for number in 1..150 {
            let edits = random_tick(&mut random, frame);
            world.apply(edits, Time(number * 1000), EditRule::LeaveOutWrong).expect("a tick");
            let newest = world.newest();
            // Some ticks are asked soon, some late, some never, and some again and again.
            for back in [1, 3, 9, 17, 33, u64::from(HISTORY)] {
                let Some(then) = said.iter().find(|then| then.tick.get() + back == newest.tick().get()) else {
                    continue;
                };
                if random.unit() < 0.5 {
                    continue;
                }
                let past = newest.at(Moment::Tick(then.tick)).expect("it is held");
                assert_eq!((past.tick(), past.fraction()), (then.tick, 0.0));
                assert_eq!(contents(&past), then.contents, "{back} ticks before {}", newest.tick());
                for (question, filter, answer) in &then.answers {
                    assert_eq!(ask(&past, question, filter), *answer, "{question:?} {back} before {}", newest.tick());
                    asked += 1;
                    hits += usize::from(answer.contains("verdict: Hit"));
                }
            }
            said.push(listen(&newest, &mut random, frame));
        }
    }
    assert!(asked > 3000 && hits * 10 > asked * 3 && hits * 10 < asked * 9, "vacuous: {hits} of {asked}");
}

/// The shapes between two versions, by the rules of `ReadAt`: `later` says which shapes went all the way in its tick.
fn interpolated(before: &Snapshot, after: &Snapshot, fraction: f64, edits: &[Edit]) -> Vec<Shape> {
    let broken = |wanted: &Shape| {
        edits.iter().any(|edit| match edit {
            Edit::Insert(shape) => shape.id == wanted.id,
            Edit::Move { id, teleport, .. } => *id == wanted.id && *teleport,
            Edit::Remove(id) => *id == wanted.id,
            Edit::Clear => true,
        })
    };
    let shapes = before.shapes_after(None, usize::MAX, None).into_iter().map(|shape| {
        let end = after.shape(shape.id).filter(|_| !broken(shape)).map_or(shape.pose, |end| end.pose);
        let pose = if end == shape.pose { shape.pose } else { shape.pose.between(&end, fraction) };
        Shape { pose, ..shape.clone() }
    });
    shapes.collect()
}

#[test]
fn between_two_ticks_it_answers_as_a_world_of_the_interpolated_shapes() {
    let mut random = Random::new(32);
    let (mut hits, mut asked) = (0, 0);
    for frame in FRAMES {
        let mut world = world_with_history(HISTORY);
        world.apply(first_shapes(&mut random, frame), Time(0), EditRule::AllOrNothing).expect("a tick");
        let mut versions = vec![(world.newest(), Vec::new())];
        for number in 1..60 {
            let edits = random_tick(&mut random, frame);
            world.apply(edits.clone(), Time(number * 1000), EditRule::LeaveOutWrong).expect("a tick");
            versions.push((world.newest(), edits));
            let back = (random.bits() % 20) as usize;
            if back + 2 > versions.len() {
                continue;
            }
            let [(before, _), (after, edits)] = &versions[versions.len() - back - 2..versions.len() - back] else {
                continue;
            };
            let fraction = [0.5, 1e-9, 0.999_999, random.unit()][(random.bits() % 4) as usize];
            let past = world.newest().at(Moment::Between(before.tick(), fraction)).expect("it is held");
            let fresh = world_of(interpolated(before, after, fraction, edits)).newest();
            let fork = World::fork(&past).newest();
            for _ in 0..3 {
                for question in random_questions(&mut random, frame, SHAPES) {
                    let answer = ask(&fresh, &question, &Filter::default());
                    assert_eq!(ask(&past, &question, &Filter::default()), answer, "{question:?} at {fraction}");
                    assert_eq!(ask(&fork, &question, &Filter::default()), answer);
                    asked += 1;
                    hits += usize::from(answer.contains("verdict: Hit"));
                }
            }
        }
    }
    assert!(asked > 1000 && hits * 10 > asked * 3 && hits * 10 < asked * 9, "vacuous: {hits} of {asked}");
}

#[test]
fn a_fork_goes_its_own_way_from_the_same_tick() {
    let mut random = Random::new(33);
    let mut world = world_with_history(HISTORY);
    world.apply(first_shapes(&mut random, Frame::UNIT), Time(5), EditRule::AllOrNothing).expect("a tick");
    for number in 0..20 {
        let edits = random_tick(&mut random, Frame::UNIT);
        world.apply(edits, Time(10 + number), EditRule::LeaveOutWrong).expect("a tick");
    }
    let newest = world.newest();
    let before = contents(&newest);
    let past = newest.at(Moment::Tick(Tick::MIN.saturating_add(7))).expect("it is held");
    for origin in [Arc::clone(&newest), past] {
        let mut fork = World::fork(&origin);
        let begun = fork.newest();
        assert_eq!((begun.tick(), begun.time(), begun.oldest_tick()), (origin.tick(), origin.time(), origin.tick()));
        assert_eq!(contents(&begun), contents(&origin));
        assert_eq!(fork.settings(), world.settings());
        fork.apply(vec![Edit::Clear], origin.time(), EditRule::AllOrNothing).expect("a tick");
        assert!(fork.newest().is_empty());
        assert_eq!(fork.newest().oldest_tick(), origin.tick(), "its own history begins where it does");
        let again = fork.newest().at(Moment::Tick(origin.tick())).expect("it is held");
        assert_eq!(contents(&again), contents(&origin));
    }
    assert_eq!(contents(&newest), before);
    assert_eq!(contents(&world.newest()), before, "what a fork does nobody else sees");
}

#[test]
fn a_shape_goes_straight_and_turns_evenly_between_two_ticks() {
    let mut world = world_with_history(2);
    let insert = Edit::Insert(shape(1, random_geometry(&mut Random::new(1), Frame::UNIT), Pose::IDENTITY));
    world.apply(vec![insert], Time(100), EditRule::AllOrNothing).expect("a tick");
    let half_turn = DQuat::from_xyzw(0.0, 2.0, 0.0, 2.0);
    let to = Edit::Move {
        id: id(1),
        position: Some(DVec3::new(8.0, 0.0, -4.0)),
        rotation: Some(half_turn),
        velocity: None,
        angular_velocity: None,
        teleport: false,
    };
    world.apply(vec![to], Time(300), EditRule::AllOrNothing).expect("a tick");
    let past = world.newest().at(Moment::Time(Time(150))).expect("it is held");
    assert_eq!((past.tick().get(), past.fraction(), past.time()), (2, 0.25, Time(150)));
    let pose = past.shape(id(1)).expect("it is there").pose;
    assert_eq!(pose.position, DVec3::new(2.0, 0.0, -1.0));
    let angle = std::f64::consts::FRAC_PI_8;
    let wanted = DVec3::new(angle.cos(), 0.0, -angle.sin());
    assert!((pose.transform_point(DVec3::X) - pose.position - wanted).length() < 1e-15);
}
