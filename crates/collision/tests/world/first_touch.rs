//! First touches of the past against what a question at each of many moments says.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::Verdict,
    math::Pose,
    shape::Geometry,
    world::{
        Distance, Edit, EditRule, Filter, FirstTouch, Found, HistoryError, Meter, Moment, Overlap, PastTouch,
        QuestionError, Shape, Snapshot, Subject, Tick, Time, World,
    },
};

use crate::history::world_with_history;
use crate::random::Random;
use crate::scene::{Frame, id, random_geometry, random_pose, random_shapes, shape};

fn tick(number: u64) -> Tick {
    Tick::new(number).expect("ticks begin at 1")
}

fn ball() -> Arc<Geometry> {
    Arc::new(Geometry::sphere(0.5).expect("a sphere"))
}

fn named(number: u64) -> Subject {
    Subject::Shape { id: id(number), pose: None }
}

fn at(number: u64, place: DVec3) -> Edit {
    Edit::Insert(shape(number, ball(), Pose::at(place)))
}

fn to(number: u64, place: DVec3, teleport: bool) -> Edit {
    Edit::Move {
        id: id(number),
        position: Some(place),
        rotation: None,
        velocity: None,
        angular_velocity: None,
        teleport,
    }
}

/// A world that went through these ticks, the first of which is 2.
fn played(ticks: Vec<Vec<Edit>>) -> World {
    let mut world = world_with_history(64);
    for (number, edits) in (1..).zip(ticks) {
        world.apply(edits, Time(number), EditRule::AllOrNothing).expect("a tick");
    }
    world
}

fn try_ask(world: &Arc<Snapshot>, question: &FirstTouch) -> Result<Found<PastTouch>, QuestionError> {
    world.first_touch(question, &Filter::default(), &Accuracy::default(), &mut Meter::new(&mut || true))
}

fn first(world: &World, subject: Subject, against: Option<Subject>, ticks: [u64; 2]) -> Found<PastTouch> {
    let question = FirstTouch { subject, against, from: tick(ticks[0]), to: tick(ticks[1]) };
    try_ask(&world.newest(), &question).expect("an answer")
}

/// Tick, fraction and the other's id of a certain touch.
fn when(found: &Found<PastTouch>) -> (u64, f64, Option<u64>) {
    let hit = found.hits.last().expect("a touch");
    assert_eq!((found.verdict, hit.impact.touch.certificate.verdict), (Verdict::Hit, Verdict::Hit));
    assert!(hit.impact.touch.certificate.bound.contains(hit.impact.touch.fraction));
    (hit.tick.get(), hit.impact.touch.fraction, hit.impact.id.map(|id| id.get()))
}

#[track_caller]
fn assert_when(found: &Found<PastTouch>, (tick, fraction, other): (u64, f64, u64)) {
    let (number, value, id) = when(found);
    assert_eq!((number, id), (tick, Some(other)));
    assert!((value - fraction).abs() < 1e-12, "{value} is not {fraction}");
}

#[test]
fn two_that_met_within_a_tick_are_found_there_and_from_later_ticks_on_where_they_are() {
    let x = DVec3::X;
    // Both move, through each other and away within one tick: no tick shows it.
    let world = played(vec![
        vec![at(1, x * -4.0), at(2, x * 4.0)],
        vec![to(1, x * -2.0, false)],
        vec![to(1, x * 6.0, false), to(2, x * -4.0, false)],
        vec![to(1, x * 9.0, false)],
    ]);
    let pair = |ticks| first(&world, named(1), Some(named(2)), ticks);
    // At tick 3 they are 6 m apart, less both radii, and close 16 m in the tick.
    let (number, fraction, other) = when(&pair([2, 5]));
    assert_eq!((number, other), (3, Some(2)));
    assert!((fraction - 5.0 / 16.0).abs() < 1e-12, "{fraction}");
    assert_eq!(when(&first(&world, named(2), None, [2, 5])).0, 3, "either of them may ask");
    assert_eq!((pair([2, 3]).verdict, pair([4, 5]).verdict), (Verdict::Miss, Verdict::Miss));
    assert_eq!(pair([3, 3]).verdict, Verdict::Miss, "a tick by itself is asked as it is");
}

#[test]
fn what_jumps_comes_goes_or_changes_its_form_stands_until_then() {
    let x = DVec3::X;
    let sensor = Shape { sensor: true, ..shape(5, ball(), Pose::at(x * 20.0)) };
    let large = Arc::new(Geometry::sphere(3.0).expect("a sphere"));
    let world = played(vec![
        vec![at(1, DVec3::ZERO), at(2, x * 9.0), at(3, DVec3::Y * 3.0), Edit::Insert(sensor)],
        // Over shape 3's other side by a jump: nothing is touched on the way.
        vec![to(3, DVec3::Y * -3.0, true)],
        // Shape 2 becomes so large that it nearly touches shape 1, and at the next tick does.
        vec![Edit::Insert(shape(2, large.clone(), Pose::at(x * 4.0)))],
        vec![Edit::Insert(shape(2, large, Pose::at(x * 3.0)))],
        vec![Edit::Remove(id(2)), Edit::Remove(id(3))],
        vec![to(1, x * 30.0, false)],
    ]);
    let pair = |number, ticks| first(&world, named(1), Some(named(number)), ticks);
    assert_eq!(pair(3, [2, 5]).verdict, Verdict::Miss, "a jump passes nothing");
    assert_eq!(pair(2, [2, 4]).verdict, Verdict::Miss, "4 - 3 - 0.5 m apart");
    let found = pair(2, [2, 7]);
    assert_eq!(when(&found), (5, 0.0, Some(2)));
    assert!(found.hits[0].impact.touch.initial);
    // What was removed in tick 6 is not passed on the way that begins there; a sensor is.
    assert_when(&first(&world, named(1), None, [6, 7]), (6, 19.0 / 30.0, 5));
    assert_eq!(pair(2, [5, 6]).verdict, Verdict::Hit);
    assert_eq!(try_ask(&world.newest(), &question(2, [6, 7])).unwrap_err(), QuestionError::AgainstNotFound(id(2)));
    assert_eq!(try_ask(&world.newest(), &question(9, [2, 7])).unwrap_err(), QuestionError::AgainstNotFound(id(9)));
    // A place that somebody comes through.
    let gate = Subject::Geometry { geometry: ball(), pose: Pose::at(x * 11.0) };
    assert_when(&first(&world, gate, None, [2, 7]), (6, 10.0 / 30.0, 1));
}

fn question(against: u64, ticks: [u64; 2]) -> FirstTouch {
    FirstTouch { subject: named(1), against: Some(named(against)), from: tick(ticks[0]), to: tick(ticks[1]) }
}

#[test]
fn a_tick_that_is_not_held_is_told() {
    let mut world = world_with_history(2);
    for number in 1..6 {
        let edits = vec![at(1, DVec3::X * number as f64), at(2, DVec3::Y * 9.0)];
        world.apply(edits, Time(number), EditRule::AllOrNothing).expect("a tick");
    }
    let (oldest, newest) = (tick(4), tick(6));
    let gone = QuestionError::History(HistoryError::Gone { asked: tick(3), oldest, newest });
    assert_eq!(try_ask(&world.newest(), &question(2, [3, 6])).unwrap_err(), gone);
    let unmade = QuestionError::History(HistoryError::NotMade { asked: tick(7), oldest, newest });
    assert_eq!(try_ask(&world.newest(), &question(2, [4, 7])).unwrap_err(), unmade);
    assert_eq!(try_ask(&world.newest(), &question(2, [4, 6])).expect("held").verdict, Verdict::Miss);
}

/// Random ticks of all kinds of edits.
fn random_world(random: &mut Random, shapes: u64, ticks: u64) -> World {
    // Of no group, so that each sees all others.
    let first =
        random_shapes(random, Frame::UNIT, shapes).into_iter().map(|shape| Edit::Insert(Shape { group: 0, ..shape }));
    let mut played = vec![first.collect::<Vec<_>>()];
    for _ in 0..ticks {
        let edits = (1..=shapes).filter_map(|number| {
            let pose = random_pose(random, Frame::UNIT, 4.0);
            Some(match random.bits() % 12 {
                0..5 => Edit::Move {
                    id: id(number),
                    position: (random.unit() < 0.8).then_some(pose.position),
                    rotation: (random.unit() < 0.5).then_some(pose.rotation),
                    velocity: None,
                    angular_velocity: None,
                    teleport: random.unit() < 0.2,
                },
                5 => Edit::Insert(shape(number, random_geometry(random, Frame::UNIT), pose)),
                6 => Edit::Remove(id(number)),
                _ => return None,
            })
        });
        played.push(edits.collect());
    }
    let mut world = world_with_history(64);
    for (number, edits) in (1..).zip(played) {
        world.apply(edits, Time(number), EditRule::LeaveOutWrong).expect("a tick");
    }
    world
}

/// Moments of a tick that are asked one by one.
const MOMENTS: u64 = 24;

/// The question at a moment: whether the two touch there.
fn touch_at(world: &Arc<Snapshot>, moment: Moment, pair: [u64; 2]) -> Option<Verdict> {
    let then = world.at(moment).expect("held");
    let question = Overlap { subject: named(pair[0]), against: Some(named(pair[1])), max_hits: 1 };
    let found = then.overlap(&question, &Filter::default(), &Accuracy::default(), &mut Meter::new(&mut || true));
    found.ok().map(|found| found.verdict)
}

/// How far apart the two surely are at a moment.
fn gap_at(world: &Arc<Snapshot>, moment: Moment, pair: [u64; 2]) -> f64 {
    let then = world.at(moment).expect("held");
    let against = Some(named(pair[1]));
    let question = Distance { subject: named(pair[0]), against, max_distance: 4e12, max_hits: 1 };
    let found = then.distance(&question, &Filter::default(), &Accuracy::default(), &mut Meter::new(&mut || true));
    found.expect("they are there").hits[0].separation.certificate.bound.lower
}

#[test]
fn a_first_touch_is_that_of_all_moments_one_by_one_and_that_of_the_world_the_first_of_all_pairs() {
    let mut random = Random::new(41);
    let (mut hits, mut within, mut asked) = (0, 0, 0);
    for _ in 0..10 {
        let world = random_world(&mut random, 7, 18);
        let (newest, [from, to]) = (world.newest(), [2, 20]);
        let mut earliest: Option<(u64, f64)> = None;
        for other in 2..=7 {
            let Ok(found) = try_ask(&newest, &question(other, [from, to])) else { continue };
            asked += 1;
            let certain = found.hits.iter().find(|hit| hit.impact.touch.certificate.verdict == Verdict::Hit);
            let lower = found.hits.first().map(|hit| (hit.tick.get(), hit.impact.touch.certificate.bound.lower));
            for moment in 0..=(to - from) * MOMENTS {
                let (number, part) = (from + moment / MOMENTS, (moment % MOMENTS) as f64 / MOMENTS as f64);
                if lower.is_none_or(|lower| (number, part) < lower) {
                    let touch = touch_at(&newest, Moment::Between(tick(number), part), [1, other]);
                    assert_ne!(touch, Some(Verdict::Hit), "{found:?} is not before {number} {part}");
                }
            }
            let Some(hit) = certain else { continue };
            hits += 1;
            let bound = hit.impact.touch.certificate.bound;
            within += usize::from(bound.upper > 0.0 && bound.lower > 0.0);
            let moment = Moment::Between(hit.tick, hit.impact.touch.fraction);
            assert!(gap_at(&newest, moment, [1, other]) < 1e-5, "{hit:?}");
            let is_seen = newest.at(Moment::Tick(hit.tick)).expect("held").shape(id(other)).is_some();
            assert!(is_seen, "{hit:?}");
            let value = (hit.tick.get(), hit.impact.touch.fraction);
            if earliest.is_none_or(|earliest| value < earliest) {
                earliest = Some(value);
            }
        }
        let all = FirstTouch { subject: named(1), against: None, from: tick(from), to: tick(to) };
        // All that is there, whatever the shape itself would see.
        let filter = Filter { layers: Some(u32::MAX), collides_with: Some(u32::MAX), ..Filter::default() };
        let found = newest.first_touch(&all, &filter, &Accuracy::default(), &mut Meter::new(&mut || true));
        let certain =
            found.expect("an answer").hits.into_iter().find(|hit| hit.impact.touch.certificate.verdict == Verdict::Hit);
        let value = certain.map(|hit| (hit.tick.get(), hit.impact.touch.fraction));
        assert_eq!(value.map(|value| value.0), earliest.map(|value| value.0));
        let difference = value.zip(earliest).map_or(0.0, |(a, b)| a.1 - b.1);
        assert!(difference.abs() < 1e-9, "{value:?} {earliest:?}");
    }
    assert!(asked > 40 && hits * 10 > asked * 3 && hits < asked, "vacuous: {hits} of {asked}");
    assert!(within * 4 > hits, "vacuous: {within} of {hits} within a tick");
}
