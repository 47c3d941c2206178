//! What pierces: all up to the first certain blocker, as the list of all hits has it.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::{Bound, Verdict},
    math::Pose,
    narrow::InitialTouch,
    shape::Geometry,
    world::{Filter, Found, HitMode, Impact, Meter, Mobility, RayHit, Raycast, Shape, Snapshot, Subject, TimeOfImpact},
};

use crate::random::Random;
use crate::scene::{Frame, Question, id, random_questions, random_shapes, ray, shape, world_of};

/// A hit of either kind.
#[derive(Clone, Debug, PartialEq)]
struct Touch {
    value: f64,
    id: u64,
    verdict: Verdict,
    bound: Bound,
    pierced: bool,
}

fn of_ray(hit: &RayHit) -> Touch {
    let (value, certificate) = (hit.touch.distance, hit.touch.certificate);
    let (verdict, bound) = (certificate.verdict, certificate.bound);
    Touch { value, id: hit.id.expect("a shape").get(), verdict, bound, pierced: hit.pierced }
}

fn of_impact(hit: &Impact) -> Touch {
    let (value, certificate) = (hit.touch.fraction, hit.touch.certificate);
    let (verdict, bound) = (certificate.verdict, certificate.bound);
    Touch { value, id: hit.id.expect("a shape").get(), verdict, bound, pierced: hit.pierced }
}

fn touches<H>(found: &Found<H>, touch: fn(&H) -> Touch) -> Vec<Touch> {
    found.hits.iter().map(touch).collect()
}

/// The verdict, the hits and whether there are more, of a ray or a motion in this mode.
fn ask(world: &Snapshot, question: &Question, mode: HitMode) -> (Verdict, Vec<Touch>, bool) {
    let mut go_on = || true;
    let (meter, filter, accuracy) = (&mut Meter::new(&mut go_on), Filter::default(), Accuracy::default());
    match question {
        Question::Raycast(asked) => {
            let found =
                world.raycast(&Raycast { mode, ..asked.clone() }, &filter, &accuracy, meter).expect("an answer");
            (found.verdict, touches(&found, of_ray), found.truncated)
        }
        Question::TimeOfImpact(asked) => {
            let asked = TimeOfImpact { mode, ..asked.clone() };
            let found = world.time_of_impact(&asked, &filter, &accuracy, meter).expect("an answer");
            (found.verdict, touches(&found, of_impact), found.truncated)
        }
        other => panic!("{other:?} has no mode"),
    }
}

/// What the list of all hits says that a piercing question answers: whether it is blocked, and by what; and what comes before.
fn cut(all: &[Touch], pierced: impl Fn(u64) -> bool) -> (Verdict, Vec<Touch>, Option<Touch>) {
    let all: Vec<Touch> = all.iter().map(|touch| Touch { pierced: pierced(touch.id), ..touch.clone() }).collect();
    let is_blocker = |touch: &&Touch| touch.verdict == Verdict::Hit && !touch.pierced;
    let blocker = all.iter().find(is_blocker).cloned();
    let limit = all.iter().filter(is_blocker).map(|touch| touch.bound.upper).fold(f64::INFINITY, f64::min);
    let open = all.iter().any(|touch| !touch.pierced);
    let verdict = match (&blocker, open) {
        (Some(_), _) => Verdict::Hit,
        (None, true) => Verdict::Undecided,
        (None, false) => Verdict::Miss,
    };
    let before = all.into_iter().filter(|touch| !is_blocker(&touch) && touch.bound.lower <= limit).collect();
    (verdict, before, blocker)
}

#[test]
fn what_pierces_is_answered_as_all_hits_up_to_the_first_blocker() {
    let mut random = Random::new(77);
    let (mut blocked, mut went_through, mut cut_short, mut asked) = (0, 0, 0, 0);
    for round in 0..12_u32 {
        // The list of all impacts has no sensors: it is asked of the same world without any.
        let plain: Vec<Shape> = random_shapes(&mut random, Frame::UNIT, 60)
            .into_iter()
            .map(|shape| Shape { collides_with: u32::MAX, sensor: false, ..shape })
            .collect();
        let is_sensor = |id: u64| id.is_multiple_of(5);
        let sensing = plain.iter().map(|shape| Shape { sensor: is_sensor(shape.id.get()), ..shape.clone() });
        let (all_world, world) = (world_of(plain.clone()).newest(), world_of(sensing).newest());
        let layers = [0b001, 0b010, 0b101, 0b111][round as usize % 4];
        let pierced = |id: u64| is_sensor(id) || plain[id as usize - 1].layers & layers != 0;
        for _ in 0..25 {
            let [ray, _, _, impact, _] = random_questions(&mut random, Frame::UNIT, 60);
            for question in [ray, impact] {
                let (_, all, _) = ask(&all_world, &question, HitMode::All(usize::MAX));
                let (verdict, before, blocker) = cut(&all, pierced);
                let (answer, found, truncated) = ask(&world, &question, HitMode::Pierce { layers, most: usize::MAX });
                assert_eq!((answer, truncated), (verdict, false), "{question:?}");
                // What may block before it surely does is told besides; the list of all has one hit of each shape.
                let is_twice = |touch: &Touch| touch.verdict == Verdict::Undecided && !before.contains(touch);
                let (twice, once): (Vec<Touch>, Vec<Touch>) = found.into_iter().partition(is_twice);
                for touch in twice {
                    let certain = all.iter().find(|hit| hit.id == touch.id).expect("it is hit");
                    assert!(certain.verdict == Verdict::Hit && !touch.pierced, "{touch:?} {question:?}");
                }
                let expected: Vec<Touch> = before.iter().cloned().chain(blocker.clone()).collect();
                assert_eq!(once, expected, "{question:?}");
                asked += 1;
                blocked += usize::from(blocker.is_some());
                went_through += usize::from(blocker.is_some() && !before.is_empty());
                // With too little room, those that begin last are left out, and never the blocker.
                let (answer, few, truncated) = ask(&world, &question, HitMode::Pierce { layers, most: 1 });
                assert_eq!(answer, verdict, "a list that is cut does not change it");
                assert_eq!(few.last().filter(|last| last.verdict == Verdict::Hit && !last.pierced), blocker.as_ref());
                let first = before.iter().map(|touch| touch.bound.lower).fold(f64::INFINITY, f64::min);
                assert!(few.iter().all(|touch| Some(touch) == blocker.as_ref() || touch.bound.lower <= first));
                assert!(truncated || before.len() <= 1, "{before:?}");
                cut_short += usize::from(truncated);
            }
        }
    }
    let some = |count: usize| count * 10 > asked && count * 10 < asked * 9;
    assert!(some(blocked) && some(went_through) && some(cut_short), "{blocked} {went_through} {cut_short} of {asked}");
}

fn number(hit: &RayHit) -> u64 {
    hit.id.expect("a shape").get()
}

fn through(world: &Snapshot, layers: u32) -> Found<RayHit> {
    let question = Raycast { ray: ray(DVec3::X * -5.0, DVec3::X), mode: HitMode::Pierce { layers, most: 9 } };
    world
        .raycast(&question, &Filter::default(), &Accuracy::default(), &mut Meter::new(&mut || true))
        .expect("an answer")
}

/// Two balls of glass, a sensor and a wall one behind the other.
fn glass_and_wall() -> Vec<Shape> {
    let ball = Arc::new(Geometry::sphere(0.5).expect("a sphere"));
    let wall = Arc::new(Geometry::cuboid(DVec3::splat(0.5)).expect("a box"));
    let at = |number: u64, x: f64| shape(number, Arc::clone(&ball), Pose::at(DVec3::X * x));
    vec![
        Shape { layers: 0b10, ..at(1, 0.0) },
        Shape { layers: 0b110, ..at(2, 2.0) },
        Shape { sensor: true, ..at(3, 4.0) },
        Shape { mobility: Mobility::Static, ..shape(4, wall, Pose::at(DVec3::X * 6.0)) },
        at(5, 8.0),
    ]
}

#[test]
fn a_shot_goes_through_glass_to_the_wall() {
    let world = world_of(glass_and_wall()).newest();
    let found = through(&world, 0b10);
    let list: Vec<_> = found.hits.iter().map(|hit| (number(hit), hit.touch.distance, hit.pierced)).collect();
    assert_eq!(list, [(1, 4.5, true), (2, 6.5, true), (3, 8.5, true), (4, 10.5, false)]);
    assert_eq!(found.verdict, Verdict::Hit);
    let first = through(&world, 0);
    assert_eq!((first.hits.len(), first.hits[0].id, first.hits[0].pierced), (1, Some(id(1)), false));
    // Where everything is pierced nothing blocks, and the verdict says so.
    let free = through(&world, u32::MAX);
    assert_eq!((free.verdict, free.hits.len()), (Verdict::Miss, 5));
}

#[test]
fn what_stands_where_the_blocker_begins_is_not_behind_it() {
    let wall = Arc::new(Geometry::cuboid(DVec3::splat(0.5)).expect("a box"));
    let pane = Arc::new(Geometry::cuboid(DVec3::new(0.0, 0.5, 0.5)).expect("a pane"));
    let shapes = [
        shape(1, wall, Pose::IDENTITY),
        Shape { layers: 2, ..shape(2, Arc::clone(&pane), Pose::at(DVec3::X * -0.5)) },
        Shape { layers: 2, ..shape(3, pane, Pose::at(DVec3::X * -0.25)) },
    ];
    let found = through(&world_of(shapes).newest(), 2);
    assert_eq!(found.hits.iter().map(number).collect::<Vec<_>>(), [2, 1], "{found:?}");
}

#[test]
fn a_cast_meets_sensors_only_if_it_pierces_and_a_named_one_by_its_own_layers() {
    let world = world_of(glass_and_wall()).newest();
    let cast = |mode, against: Option<u64>| TimeOfImpact {
        subject: Subject::Geometry {
            geometry: Arc::new(Geometry::sphere(0.25).expect("a sphere")),
            pose: Pose::at(DVec3::X * -5.0),
        },
        displacement: DVec3::X * 20.0,
        rotation: DVec3::ZERO,
        against: against.map(|number| Subject::Shape { id: id(number), pose: None }),
        against_displacement: DVec3::ZERO,
        against_rotation: DVec3::ZERO,
        initial: InitialTouch::Counts,
        mode,
    };
    let ask = |mode, against| {
        let filter = Filter::default();
        let mut go_on = || true;
        let meter = &mut Meter::new(&mut go_on);
        let found =
            world.time_of_impact(&cast(mode, against), &filter, &Accuracy::default(), meter).expect("an answer");
        (found.verdict, found.hits.iter().map(|hit| (hit.id.expect("a shape").get(), hit.pierced)).collect::<Vec<_>>())
    };
    let pierce = HitMode::Pierce { layers: 0b10, most: 9 };
    assert_eq!(ask(pierce, None), (Verdict::Hit, vec![(1, true), (2, true), (3, true), (4, false)]));
    assert_eq!(ask(HitMode::All(9), None).1.len(), 4, "the sensor is passed over");
    assert_eq!(ask(pierce, Some(2)), (Verdict::Miss, vec![(2, true)]));
    assert_eq!(ask(pierce, Some(5)), (Verdict::Hit, vec![(5, false)]));
}
