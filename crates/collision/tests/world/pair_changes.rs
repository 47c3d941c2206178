//! How pairs begin, go on and end: the changes are those of the whole lists, whoever kept what.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::Accuracy,
    math::Pose,
    shape::Geometry,
    world::{
        Edit, EditRule, Filter, Meter, Pair, PairChanges, PairKeeper, QuestionError, Shape, ShapeId, Snapshot, Time,
        World,
    },
};

use crate::pairs::pairs;
use crate::random::Random;
use crate::scene::{
    Frame, half_spaces, id, random_filter, random_geometry, random_pose, random_shapes, shape, world_of,
};

const SHAPES: u64 = 60;

fn since(new: &Snapshot, old: &Snapshot, filter: &Filter) -> PairChanges {
    let mut go_on = || true;
    new.pairs_since(old, filter, &Accuracy::default(), &mut Meter::new(&mut go_on)).expect("an answer")
}

fn step(keeper: &mut PairKeeper, new: &Arc<Snapshot>) -> PairChanges {
    let mut go_on = || true;
    keeper.step(new, &mut Meter::new(&mut go_on)).expect("an answer")
}

fn moved(id: ShapeId, position: DVec3) -> Edit {
    Edit::Move {
        id,
        position: Some(position),
        rotation: None,
        velocity: Some(DVec3::X),
        angular_velocity: None,
        teleport: false,
    }
}

fn apply(world: &mut World, edits: Vec<Edit>) -> Arc<Snapshot> {
    world.apply(edits, Time(0), EditRule::LeaveOutWrong).expect("a tick");
    world.newest()
}

/// Some edits of all kinds, moves a little and far; now and then many.
fn random_edits(newest: &Snapshot, random: &mut Random) -> Vec<Edit> {
    let count = if random.unit() < 0.2 { 2 * SHAPES } else { random.bits() % 6 };
    (0..count)
        .map(|_| {
            let number = 1 + random.bits() % SHAPES;
            let pose = random_pose(random, Frame::UNIT, 4.0);
            match random.bits() % 40 {
                0..8 => moved(id(number), pose.position),
                8..25 => {
                    let place = newest.shape(id(number)).map_or(DVec3::ZERO, |shape| shape.pose.position);
                    moved(id(number), place + random.vector() * 0.2)
                }
                25..30 => Edit::Remove(id(number)),
                39 if random.unit() < 0.1 => Edit::Clear,
                _ => Edit::Insert(Shape { id: id(number), ..random_shapes(random, Frame::UNIT, 1).remove(0) }),
            }
        })
        .collect()
}

/// The law: what did not end is there still, with what began, and nothing else; what is not listed did not change a bit.
fn check(changes: &PairChanges, old: &Snapshot, new: &Snapshot, filter: &Filter) {
    let (before, after) = (pairs(old, filter), pairs(new, filter));
    let mut rebuilt: Vec<Pair> = before.iter().filter(|pair| !changes.ended.contains(pair)).copied().collect();
    assert_eq!(rebuilt.len() + changes.ended.len(), before.len());
    for persisted in &changes.persisted {
        let at = rebuilt.iter().position(|pair| (pair.a, pair.b) == (persisted.pair.a, persisted.pair.b));
        let known = &mut rebuilt[at.expect("it was there")];
        assert_eq!(known.certificate, persisted.before);
        *known = persisted.pair;
    }
    rebuilt.extend(&changes.began);
    rebuilt.sort_unstable_by_key(|pair| (pair.a, pair.b));
    assert_eq!(rebuilt, after);
}

#[test]
fn they_are_those_of_the_whole_lists_and_a_keeper_says_the_same() {
    let mut random = Random::new(17);
    let mut sums = [0; 3];
    for _ in 0..20 {
        let filter = if random.unit() < 0.5 { Filter::default() } else { random_filter(&mut random) };
        let mut shapes = random_shapes(&mut random, Frame::UNIT, SHAPES);
        shapes.extend(half_spaces(&mut random, Frame::UNIT, SHAPES - 3));
        let mut world = world_of(shapes);
        let mut keeper = PairKeeper::new(filter.clone(), Accuracy::default());
        let first = step(&mut keeper, &world.newest());
        assert_eq!(first.began, pairs(&world.newest(), &filter));
        let mut versions = vec![world.newest()];
        for _ in 0..25 {
            let edits = random_edits(&world.newest(), &mut random);
            let new = apply(&mut world, edits);
            let old = &versions[versions.len() - 1];
            let changes = since(&new, old, &filter);
            check(&changes, old, &new, &filter);
            // Bit by bit: NaN cannot be in it, and −0 is told from 0.
            assert_eq!(format!("{changes:?}"), format!("{:?}", step(&mut keeper, &new)));
            assert!(keeper.pairs().eq(pairs(&new, &filter)));
            assert_eq!((keeper.len(), keeper.is_empty()), (keeper.pairs().count(), keeper.pairs().next().is_none()));
            for (sum, more) in sums.iter_mut().zip([&changes.began, &changes.ended].map(Vec::len)) {
                *sum += more;
            }
            sums[2] += changes.persisted.len();
            versions.push(new);
        }
        // Any two versions, back in time too, and versions of worlds that share nothing.
        let (early, late) = (&versions[3], &versions[20]);
        check(&since(early, late, &filter), late, early, &filter);
        let other = world_of(random_shapes(&mut random, Frame::UNIT, 30)).newest();
        check(&since(&other, late, &filter), late, &other, &filter);
    }
    assert!(sums.iter().all(|&sum| sum > 200), "vacuous: {sums:?}");
}

#[test]
fn what_did_not_change_is_not_asked_again() {
    let mut random = Random::new(5);
    let mut world = world_of(random_shapes(&mut random, Frame::UNIT, 2000));
    let old = world.newest();
    let mut go_on = || true;
    let mut meter = Meter::new(&mut go_on);
    let mut ask = |new: &Snapshot| {
        let before = meter.work;
        let changes = new.pairs_since(&old, &Filter::default(), &Accuracy::default(), &mut meter).expect("an answer");
        (changes, meter.work.shapes_tested - before.shapes_tested, meter.work.nodes_visited - before.nodes_visited)
    };
    // A new velocity, and the same place again.
    let place = old.shape(id(7)).expect("it is there").pose.position;
    let unmoved = apply(&mut world, vec![moved(id(7), place)]);
    assert_eq!(ask(&unmoved), (PairChanges::default(), 0, 0));
    let shape = unmoved.shape(id(7)).expect("it is there").into_owned();
    let replaced = apply(&mut world, vec![Edit::Remove(id(7)), Edit::Remove(id(8)), Edit::Insert(shape)]);
    let (changes, tested, visited) = ask(&replaced);
    assert!(changes.began.is_empty() && changes.persisted.is_empty() && !changes.ended.is_empty());
    assert!(changes.ended.iter().all(|pair| pair.a == id(8) || pair.b == id(8)));
    let all = pairs(&old, &Filter::default()).len() as u64;
    assert!(tested < all / 50 && visited < 2000, "{tested} of {all} pairs, {visited} nodes");
}

#[test]
fn after_an_error_a_keeper_is_where_it_was() {
    let mut random = Random::new(8);
    let mut world = world_of(random_shapes(&mut random, Frame::UNIT, 600));
    let mut keeper = PairKeeper::new(Filter::default(), Accuracy::default());
    step(&mut keeper, &world.newest());
    let old = world.newest();
    let moves = (1..=600).map(|number| moved(id(number), random.vector() * 4.0)).collect();
    let new = apply(&mut world, moves);
    let mut stop = || false;
    let interrupted = keeper.step(&new, &mut Meter::new(&mut stop));
    assert_eq!(interrupted.expect_err("stopped"), QuestionError::Interrupted);
    assert!(keeper.pairs().eq(pairs(&old, &Filter::default())));
    assert_eq!(step(&mut keeper, &new), since(&new, &old, &Filter::default()));
    let ball = Arc::new(Geometry::sphere(0.1).expect("a sphere"));
    let heap = (1000..4000).map(|number| Edit::Insert(shape(number, Arc::clone(&ball), Pose::at(DVec3::ONE * 50.0))));
    let heaped = apply(&mut world, heap.collect());
    let mut go_on = || true;
    let refused = keeper.step(&heaped, &mut Meter::new(&mut go_on));
    assert_eq!(refused.expect_err("4.5 million pairs"), QuestionError::TooManyPairs);
    assert!(keeper.pairs().eq(pairs(&new, &Filter::default())));
    let geometry = random_geometry(&mut random, Frame::UNIT);
    let healed = apply(&mut world, vec![Edit::Clear, Edit::Insert(shape(1, geometry, Pose::IDENTITY))]);
    assert_eq!(step(&mut keeper, &healed).ended.len(), pairs(&new, &Filter::default()).len());
    assert!(keeper.is_empty());
}
