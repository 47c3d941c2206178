//! What nobody needs is not built, and what is built is shown.

use std::sync::atomic::{AtomicI64, Ordering};

use collision::{
    DVec3,
    math::Pose,
    world::{
        BuiltStructure, Edit, EditRule, Filter, HitMode, Means, Mobility, Moment, Raycast, Settings, Shape, Tick, Time,
        World,
    },
};

use crate::{
    random::Random,
    scene::{Frame, Question, ask, id, random_geometry, ray, shape},
};

fn built(world: &World) -> Vec<BuiltStructure> {
    world.newest().describe().built
}

fn names(world: &World) -> Vec<&'static str> {
    built(world).iter().map(|built| built.name).collect()
}

/// Shapes of one mobility, none of them a mesh.
fn edits(mobility: Mobility) -> Vec<Edit> {
    let mut random = Random::new(51);
    let geometries = std::iter::repeat_with(|| random_geometry(&mut random, Frame::UNIT));
    let bodies = geometries.filter(|geometry| !matches!(geometry.form(), collision::shape::Form::Mesh(_)));
    let shapes = (1..)
        .zip(bodies.take(100))
        .map(|(number, geometry)| Shape { mobility, ..shape(number, geometry, Pose::at(DVec3::X * number as f64)) });
    shapes.map(Edit::Insert).collect()
}

fn shift(number: u64) -> Edit {
    Edit::Move {
        id: id(number),
        position: Some(DVec3::Y * number as f64),
        rotation: None,
        velocity: None,
        angular_velocity: None,
        teleport: false,
    }
}

fn ask_something(world: &World) {
    let question = Question::Raycast(Raycast { ray: ray(DVec3::ZERO, DVec3::X), mode: HitMode::Closest });
    ask(&world.newest(), &question, &Filter::default());
}

fn apply(world: &mut World, edits: Vec<Edit>) {
    let time = world.newest().time();
    world.apply(edits, Time(time.0 + 1), EditRule::AllOrNothing).expect("a tick");
}

/// A clock that goes on by a microsecond whenever it is read.
fn clock() -> i64 {
    static NOW: AtomicI64 = AtomicI64::new(0);
    NOW.fetch_add(1000, Ordering::Relaxed)
}

fn world(history_ticks: u32) -> World {
    let means = Means { clock: Some(clock), ..Means::default() };
    World::with(Time(0), Settings { history_ticks, margin: None }, means)
}

#[test]
fn a_static_world_never_builds_the_dynamic_tree() {
    let mut world = world(0);
    apply(&mut world, edits(Mobility::Static));
    assert!(names(&world).is_empty(), "nobody asked");
    ask_something(&world);
    apply(&mut world, vec![shift(3), Edit::Remove(id(4))]);
    ask_something(&world);
    ask_something(&world);
    let [tree] = &built(&world)[..] else { panic!("{:?}", names(&world)) };
    assert_eq!((tree.name, tree.count), ("static_tree", 1));
    assert_eq!(tree.build_ns, Some(2000), "it was built twice, a microsecond each");
    assert_eq!(tree.first_tick, Tick::new(2));
    assert_eq!(world.newest().describe().tree_depth, 0);
}

#[test]
fn a_world_without_history_keeps_none() {
    let mut world = world(0);
    apply(&mut world, edits(Mobility::Dynamic));
    let before = world.newest().describe().memory_bytes;
    for _ in 0..200 {
        apply(&mut world, (1..=100).map(shift).collect());
        ask_something(&world);
    }
    assert_eq!(names(&world), ["dynamic_tree"]);
    let after = world.newest().describe().memory_bytes;
    assert!(after.abs_diff(before) < 100 * 64, "not even one tick was kept: {before}, then {after} bytes");
    let since = built(&world)[0].first_tick;
    assert_eq!(since, Tick::new(2));
}

#[test]
fn what_nobody_asks_about_the_past_is_not_built() {
    let mut world = world(16);
    apply(&mut world, edits(Mobility::Dynamic));
    for _ in 0..30 {
        apply(&mut world, (1..=100).map(shift).collect());
        ask_something(&world);
    }
    assert_eq!(names(&world), ["dynamic_tree", "history"]);
    let history = built(&world).swap_remove(1);
    assert_eq!((history.count, history.first_tick), (16, Tick::new(2)));
    let moves = 16 * 100 * 64;
    // Whole versions among them take half as much again, and among so few ticks may be one more.
    assert!((moves..2 * moves).contains(&history.memory_bytes), "{}", history.memory_bytes);
    let past = world.newest().at(Moment::Tick(Tick::MIN.saturating_add(20))).expect("it is held");
    assert_eq!(past.tick().get(), 21);
    let trees = built(&world).swap_remove(2);
    assert_eq!((trees.name, trees.count, trees.build_ns), ("past_trees", 1, Some(1000)));
    assert_eq!(trees.first_tick, Some(world.newest().tick()));
    world.newest().at(Moment::Between(Tick::MIN.saturating_add(21), 0.5)).expect("it is held");
    assert_eq!(built(&world)[2].build_ns, Some(1000), "the same span serves");
}

#[test]
fn the_past_shares_the_tree_of_static_shapes_that_did_not_change() {
    let mut world = world(16);
    apply(&mut world, edits(Mobility::Static));
    apply(
        &mut world,
        vec![Edit::Insert(shape(500, random_geometry(&mut Random::new(5), Frame::UNIT), Pose::IDENTITY))],
    );
    for _ in 0..10 {
        apply(&mut world, vec![shift(500)]);
    }
    let past = world.newest().at(Moment::Tick(Tick::MIN.saturating_add(2))).expect("it is held");
    let question = Question::Raycast(Raycast { ray: ray(DVec3::ZERO, DVec3::X), mode: HitMode::All(1000) });
    let [then, now] = [&past, &world.newest()].map(|version| ask(version, &question, &Filter::default()));
    assert_ne!(then, now, "shape 500 was on the way");
    let tree = built(&world).into_iter().find(|built| built.name == "static_tree").expect("it was asked");
    assert_eq!(tree.build_ns, Some(1000), "one tree serves both");
}

#[test]
fn answers_do_not_depend_on_a_set_margin() {
    let mut wide = world(0);
    wide.set(Settings { margin: Some(3.0), ..wide.settings() });
    let mut tuned = world(0);
    for world in [&mut wide, &mut tuned] {
        apply(world, edits(Mobility::Dynamic));
        apply(world, (1..=100).map(shift).collect());
    }
    for height in 0..100 {
        let question = Question::Raycast(Raycast {
            ray: ray(DVec3::Y * f64::from(height) + DVec3::X, -DVec3::X),
            mode: HitMode::All(9),
        });
        let answers = [&wide, &tuned].map(|world| ask(&world.newest(), &question, &Filter::default()));
        assert_eq!(answers[0], answers[1]);
    }
}
