//! Watchers against a plain list: at each tick, whatever happens to shapes, all regions and pairs are told as a list of all
//! of them tells.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use collision::{
    DVec3,
    accuracy::Accuracy,
    math::Pose,
    shape::{Form, Geometry},
    world::{
        Change, Changes, Edit, EditRule, Filter, Means, Meter, Moment, Passed, QuestionError, Region, RegionId,
        Settings, Shape, ShapeId, Snapshot, Time, Watch, WatchedPairs, Watcher, World,
    },
};

use crate::{
    random::Random,
    scene::{Frame, half_spaces, id, random_filter, random_geometry, random_pose, random_shapes, shape},
    watch_model::{Model, SHAPES, Tick, apply, went},
};

fn step(watcher: &mut Watcher, new: &Arc<Snapshot>) -> Changes {
    let mut go_on = || true;
    watcher.step(new, &mut Meter::new(&mut go_on)).expect("a step")
}

fn go_on(watcher: &mut Watcher, newest: &Arc<Snapshot>) -> Passed {
    let mut go_on = || true;
    watcher.go_on(newest, &mut Meter::new(&mut go_on)).expect("steps")
}

fn world(history_ticks: u32) -> World {
    World::with(Time(0), Settings { history_ticks, ..Settings::default() }, Means::default())
}

fn moved(id: ShapeId, pose: Pose, teleport: bool) -> Edit {
    Edit::Move {
        id,
        position: Some(pose.position),
        rotation: Some(pose.rotation),
        velocity: None,
        angular_velocity: None,
        teleport,
    }
}

/// Some edits of all kinds: moves a little and far, teleports, replaced forms and layers, removals; now and then many.
fn random_edits(newest: &Snapshot, random: &mut Random) -> Vec<Edit> {
    let count = if random.unit() < 0.2 { 2 * SHAPES } else { random.bits() % 8 };
    (0..count)
        .map(|_| {
            let number = 1 + random.bits() % SHAPES;
            let pose = random_pose(random, Frame::UNIT, 4.0);
            let here = newest.shape(id(number)).map(|shape| shape.into_owned());
            match (random.bits() % 40, here) {
                (0..8, _) => moved(id(number), pose, false),
                (8..12, _) => moved(id(number), pose, true),
                (12..20, Some(shape)) => {
                    let place = shape.pose.position + random.vector() * 0.2;
                    moved(id(number), Pose { position: place, ..shape.pose }, false)
                }
                (20..23, Some(shape)) => Edit::Insert(Shape { layers: 1 << (random.bits() % 3), ..shape }),
                (23..26, Some(shape)) => moved(id(number), shape.pose, false),
                (26..30, _) => Edit::Remove(id(number)),
                (39, _) if random.unit() < 0.1 => Edit::Clear,
                _ => Edit::Insert(Shape {
                    id: id(number),
                    bullet: random.unit() < 0.3,
                    ..random_shapes(random, Frame::UNIT, 1).remove(0)
                }),
            }
        })
        .collect()
}

/// Regions of all kinds, thin ones among them, some of them following shapes.
fn random_regions(random: &mut Random, count: u64) -> Vec<Region> {
    let mut regions: Vec<Region> = (1..=count)
        .map(|number| {
            let thin = Geometry::cuboid(DVec3::new(1e-3, random.unit() * 2.0 + 0.1, random.unit() * 2.0 + 0.1));
            let follows = random.unit() < 0.3;
            Region {
                id: id(number),
                geometry: if random.unit() < 0.3 {
                    Arc::new(thin.expect("a box"))
                } else {
                    random_geometry(random, Frame::UNIT)
                },
                pose: random_pose(random, Frame::UNIT, if follows { 1.5 } else { 4.0 }),
                follow: follows.then(|| id(1 + random.bits() % SHAPES)),
            }
        })
        .collect();
    let below = Geometry::half_space(DVec3::Y, -3.0).expect("a half space");
    regions.push(Region { id: id(count + 1), geometry: Arc::new(below), pose: Pose::IDENTITY, follow: None });
    regions
}

fn random_watch(random: &mut Random, region_count: u64) -> Watch {
    let budget = if random.unit() < 0.5 { 1 } else { Accuracy::default().budget };
    Watch {
        regions: random_regions(random, region_count),
        filter: if random.unit() < 0.5 { Filter::default() } else { random_filter(random) },
        pairs: match random.bits() % 3 {
            0 => WatchedPairs::Nothing,
            1 => WatchedPairs::All,
            _ => WatchedPairs::Of((1..=10).map(|_| id(1 + random.bits() % SHAPES)).collect()),
        },
        accuracy: Accuracy { budget, ..Accuracy::default() },
        hysteresis: if random.unit() < 0.5 { 0.0 } else { random.unit() },
    }
}

fn random_world(random: &mut Random, history_ticks: u32) -> World {
    let mut world = world(history_ticks);
    let mut shapes = random_shapes(random, Frame::UNIT, SHAPES);
    shapes.extend(half_spaces(random, Frame::UNIT, SHAPES - 3));
    let edits = shapes.into_iter().map(|shape| Edit::Insert(Shape { bullet: random.unit() < 0.2, ..shape }));
    world.apply(edits.collect(), Time(0), EditRule::AllOrNothing).expect("a tick");
    world
}

#[test]
fn at_every_tick_it_says_what_a_list_of_all_says_and_late_ones_lose_nothing() {
    let mut random = Random::new(71);
    let mut sums = [0; 5];
    for round in 0..24 {
        let mut world = random_world(&mut random, 40);
        let watch = random_watch(&mut random, 40);
        let mut model = Model::new(watch.clone());
        let [mut watcher, mut late] = [(); 2].map(|()| Watcher::new(watch.clone()));
        let first = Tick::first(world.newest());
        assert_eq!(step(&mut watcher, &world.newest()), model.step(&first), "round {round}");
        step(&mut late, &world.newest());
        let mut since_late = model.clone();
        let mut resumable = None;
        for tick in 0..30 {
            let edits = random_edits(&world.newest(), &mut random);
            let tick_made = apply(&mut world, edits);
            let expected = model.step(&tick_made);
            since_late.step(&tick_made);
            assert_eq!(step(&mut watcher, &world.newest()), expected, "round {round}, tick {tick}");
            assert_eq!(watcher.all(), model.all());
            assert_eq!(watcher.is_proved(), model.kept_count() == 0);
            for change in expected.regions.values().chain(expected.pairs.values()) {
                sums[*change as usize] += 1;
            }
            sums[3] += model.kept_count();
            if random.unit() < 0.3 {
                let passed = go_on(&mut late, &world.newest());
                assert_eq!((passed.changes, passed.missed), (since_late.merged(), false), "round {round}, tick {tick}");
                assert_eq!(late.all(), model.all());
                since_late = model.clone();
            }
            if watcher.is_proved() {
                resumable = Some((watcher.tick().expect("it saw one"), model.clone()));
            } else if let Some((_, model)) = &mut resumable {
                model.step(&tick_made);
            }
        }
        if let Some((tick, model)) = resumable {
            sums[4] += 1;
            let mut resumed = Watcher::new(watch);
            step(&mut resumed, &world.newest().at(Moment::Tick(tick)).expect("it is held"));
            assert_eq!(go_on(&mut resumed, &world.newest()).changes, model.merged(), "round {round}");
            assert_eq!(resumed.all(), watcher.all());
        }
    }
    assert!(sums[..4].iter().all(|&sum| sum > 200) && sums[4] > 5, "vacuous: {sums:?}");
}

#[test]
fn a_thousand_regions_are_told_as_one_by_one() {
    let mut random = Random::new(72);
    let mut world = random_world(&mut random, 1);
    let mut watch = random_watch(&mut random, 1000);
    (watch.filter, watch.hysteresis) = (Filter::default(), 0.0);
    let mut model = Model::new(watch.clone());
    let mut watcher = Watcher::new(watch);
    assert_eq!(step(&mut watcher, &world.newest()), model.step(&Tick::first(world.newest())));
    let mut sum = 0;
    for _ in 0..10 {
        let edits = random_edits(&world.newest(), &mut random);
        let expected = model.step(&apply(&mut world, edits));
        sum += expected.len();
        assert_eq!(step(&mut watcher, &world.newest()), expected);
    }
    assert!(sum > 1000, "vacuous: {sum}");
}

fn region(geometry: Geometry, pose: Pose, follow: Option<ShapeId>) -> Region {
    Region { id: id(1), geometry: Arc::new(geometry), pose, follow }
}

fn watch(regions: Vec<Region>) -> Watch {
    Watch {
        regions,
        filter: Filter::default(),
        pairs: WatchedPairs::Nothing,
        accuracy: Accuracy::default(),
        hysteresis: 0.0,
    }
}

fn ball(number: u64, x: f64) -> Edit {
    Edit::Insert(shape(number, Arc::new(Geometry::sphere(0.1).expect("a ball")), Pose::at(DVec3::X * x)))
}

fn ball_to(number: u64, x: f64) -> Edit {
    moved(id(number), Pose::at(DVec3::X * x), false)
}

fn one(shape: u64, change: Change) -> BTreeMap<(RegionId, ShapeId), Change> {
    [((id(1), id(shape)), change)].into()
}

#[test]
fn a_thin_fence_that_is_crossed_in_a_tick_is_not_missed_but_teleports_pass() {
    let fence = Geometry::cuboid(DVec3::new(1e-6, 1.0, 1.0)).expect("a box");
    let mut watcher = Watcher::new(watch(vec![region(fence, Pose::IDENTITY, None)]));
    let mut world = world(4);
    let mut tick = |edits: Vec<Edit>| {
        apply(&mut world, edits);
        step(&mut watcher, &world.newest()).regions
    };
    assert!(tick(vec![ball(1, -100.0)]).is_empty());
    assert_eq!(tick(vec![ball_to(1, 100.0)]), one(1, Change::CameAndWent));
    assert!(tick(vec![moved(id(1), Pose::at(DVec3::X * -100.0), true)]).is_empty());
    assert_eq!(tick(vec![ball_to(1, 0.0)]), one(1, Change::Came));
    assert_eq!(tick(vec![ball_to(1, 100.0)]), one(1, Change::Went));
    // Beside the fence, and past its top while turning.
    assert!(tick(vec![moved(id(1), Pose::at(DVec3::new(100.0, 1.2, 0.0)), false)]).is_empty());
    assert!(tick(vec![moved(id(1), Pose::at(DVec3::new(-100.0, 1.2, 0.0)), false)]).is_empty());
}

#[test]
fn a_region_that_follows_goes_along_and_is_empty_while_its_shape_is_gone() {
    let arm = region(Geometry::sphere(0.1).expect("a ball"), Pose::at(DVec3::X * 1.0), Some(id(1)));
    let mut watcher = Watcher::new(watch(vec![arm]));
    let mut world = world(4);
    let mut tick = |edits: Vec<Edit>| {
        apply(&mut world, edits);
        step(&mut watcher, &world.newest()).regions
    };
    assert!(tick(vec![ball(2, 5.0), ball(3, 1.0)]).is_empty());
    // It comes with its shape, which it does not see even where it is.
    assert_eq!(tick(vec![ball(1, 0.0)]), one(3, Change::Came));
    // On to 9, over the ball at 5, which stands.
    let mut both = one(2, Change::CameAndWent);
    both.extend(one(3, Change::Went));
    assert_eq!(tick(vec![ball_to(1, 8.0)]), both);
    assert_eq!(tick(vec![ball_to(3, 9.0)]), one(3, Change::Came));
    // Together they go on.
    assert!(tick(vec![ball_to(1, 20.0), ball_to(3, 21.0)]).is_empty());
    assert_eq!(tick(vec![Edit::Remove(id(1))]), one(3, Change::Went));
    assert!(tick(vec![ball_to(3, 0.0)]).is_empty());
    assert_eq!(tick(vec![ball(1, -1.0)]), one(3, Change::Came));
}

#[test]
fn it_leaves_when_it_is_farther_than_the_hysteresis() {
    let zone = region(Geometry::sphere(0.9).expect("a ball"), Pose::IDENTITY, None);
    let mut watcher = Watcher::new(Watch { hysteresis: 0.5, pairs: WatchedPairs::All, ..watch(vec![zone]) });
    let mut world = world(4);
    let mut tick = |edits: Vec<Edit>| {
        apply(&mut world, edits);
        let Changes { regions, pairs } = step(&mut watcher, &world.newest());
        (regions, pairs, watcher.is_proved())
    };
    let nothing = BTreeMap::new();
    // Balls of 0.1 m: at 1 m they touch the zone, at 1.5 m they are half a metre off.
    assert_eq!(tick(vec![ball(1, 1.2), ball(2, 1.35)]), (nothing.clone(), one(2, Change::Came), true));
    assert_eq!(tick(vec![ball_to(1, 0.95), ball_to(2, 0.95)]).0.len(), 2);
    assert_eq!(tick(vec![ball_to(1, 1.45), ball_to(2, 1.0)]), (nothing.clone(), nothing.clone(), false));
    assert_eq!(tick(vec![ball_to(1, 1.55)]), (one(1, Change::Went), nothing.clone(), false));
    assert_eq!(tick(vec![ball_to(1, 1.75)]), (nothing.clone(), one(2, Change::Went), true));
    assert_eq!(tick(vec![ball_to(1, 1.45)]), (nothing.clone(), nothing, true));
}

/// The law is checked at random by the model; here it is seen once, step by step.
#[test]
fn what_is_undecided_stays_what_it_was() {
    let mut random = Random::new(9);
    let accuracy = Accuracy { budget: 1, ..Accuracy::default() };
    let mut found = 0;
    for _ in 0..2000 {
        let [zone, other] = [(); 2].map(|()| random_geometry(&mut random, Frame::UNIT));
        if matches!(zone.form(), Form::Mesh(_)) || matches!(other.form(), Form::Mesh(_)) {
            continue;
        }
        let pose = random_pose(&mut random, Frame::UNIT, 1.5);
        let zone = Region { id: id(1), geometry: zone, pose: Pose::IDENTITY, follow: None };
        let mut watcher = Watcher::new(Watch { accuracy, ..watch(vec![zone.clone()]) });
        let mut model = Model::new(Watch { accuracy, ..watch(vec![zone]) });
        let mut world = world(4);
        let at = |pose| vec![Edit::Insert(shape(1, Arc::clone(&other), pose))];
        let places = [Pose::at(DVec3::X * 99.0), pose, Pose::IDENTITY, pose, Pose::at(DVec3::X * 99.0)];
        let told: Vec<_> = places
            .iter()
            .map(|&place| {
                let tick = apply(&mut world, at(place));
                model.step(&tick);
                step(&mut watcher, &world.newest()).regions.values().copied().next()
            })
            .collect();
        if model.undecided_count() == 2 {
            found += 1;
            assert_eq!(told, [None, None, Some(Change::Came), None, Some(Change::Went)]);
        }
    }
    assert!(found > 10, "vacuous: {found}");
}

#[test]
fn what_is_no_longer_held_is_said_to_be_missed_and_nothing_else_is_lost() {
    let mut random = Random::new(74);
    let mut went_by = 0;
    for _ in 0..10 {
        let mut world = random_world(&mut random, 3);
        let watch = Watch { hysteresis: 0.0, accuracy: Accuracy::default(), ..random_watch(&mut random, 30) };
        let mut late = Watcher::new(watch.clone());
        step(&mut late, &world.newest());
        let before = late.all();
        for _ in 0..9 {
            let edits = random_edits(&world.newest(), &mut random);
            apply(&mut world, edits);
        }
        let passed = go_on(&mut late, &world.newest());
        assert!(passed.missed);
        let mut fresh = Watcher::new(watch);
        let now = step(&mut fresh, &world.newest());
        assert_eq!(late.all(), now);
        went_by += went(&passed.changes);
        // What is told leads from what there was to what there is.
        let mut told: BTreeSet<_> = before.regions.into_keys().collect();
        for (key, change) in passed.changes.regions {
            match change {
                Change::Came => assert!(told.insert(key)),
                Change::Went => assert!(told.remove(&key)),
                Change::CameAndWent => {}
            }
        }
        assert!(told.into_iter().eq(now.regions.into_keys()));
    }
    assert!(went_by > 50, "vacuous: {went_by}");
}

#[test]
fn what_did_not_change_is_not_asked_again_and_after_an_error_it_is_where_it_was() {
    let mut random = Random::new(75);
    let mut world = random_world(&mut random, 4);
    let watch = Watch { pairs: WatchedPairs::All, ..watch(random_regions(&mut random, 300)) };
    let mut watcher = Watcher::new(watch);
    step(&mut watcher, &world.newest());
    let newest = world.newest();
    let stay = (1..SHAPES - 3).filter_map(|number| newest.shape(id(number)));
    let edits = stay.map(|shape| moved(shape.id, shape.pose, false)).collect();
    apply(&mut world, edits);
    let mut go_on = || true;
    let mut meter = Meter::new(&mut go_on);
    assert!(watcher.step(&world.newest(), &mut meter).expect("a step").is_empty());
    assert_eq!(meter.work.steps(), 0);
    let all = watcher.all();
    let moves: Vec<Edit> =
        (1..SHAPES - 3).map(|number| moved(id(number), random_pose(&mut random, Frame::UNIT, 4.0), true)).collect();
    apply(&mut world, moves);
    let mut stop = || false;
    let error = watcher.step(&world.newest(), &mut Meter::new(&mut stop)).expect_err("stopped");
    assert_eq!(error, QuestionError::Interrupted);
    assert_eq!(watcher.all(), all);
    assert!(!step(&mut watcher, &world.newest()).is_empty());
}
