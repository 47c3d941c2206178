//! What filters let through, pairs that are named, limits that cut lists, and questions that are called off.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::Verdict,
    math::Pose,
    shape::Geometry,
    world::{
        Distance, Filter, Found, HitMode, Meter, Mobility, Overlap, OverlapHit, QuestionError, Raycast, Shape,
        Snapshot, Subject, TimeOfImpact,
    },
};

use crate::scene::{id, ray, shape, world_of};

fn ball() -> Arc<Geometry> {
    Arc::new(Geometry::sphere(1.0).expect("a sphere"))
}

/// Balls of radius 1 in a row: number `n` at x = 3 n, where nothing touches.
fn row(count: u64) -> Vec<Shape> {
    (1..=count).map(|number| shape(number, ball(), Pose::at(DVec3::X * (3 * number) as f64))).collect()
}

fn everything() -> Subject {
    Subject::Geometry { geometry: Arc::new(Geometry::sphere(1e6).expect("a sphere")), pose: Pose::IDENTITY }
}

fn overlap(snapshot: &Snapshot, subject: Subject, filter: &Filter, max_hits: usize) -> Found<OverlapHit> {
    let question = Overlap { subject, against: None, max_hits };
    let mut go_on = || true;
    snapshot.overlap(&question, filter, &Accuracy::default(), &mut Meter::new(&mut go_on)).expect("an answer")
}

fn seen(snapshot: &Snapshot, subject: Subject, filter: &Filter) -> Vec<u64> {
    overlap(snapshot, subject, filter, 1000).hits.iter().map(|hit| hit.id.expect("a shape").get()).collect()
}

#[test]
fn masks_must_agree_on_both_sides() {
    let mut shapes = row(4);
    (shapes[0].layers, shapes[0].collides_with) = (0b01, 0b11);
    (shapes[1].layers, shapes[1].collides_with) = (0b10, 0b11);
    (shapes[2].layers, shapes[2].collides_with) = (0b01, 0b10);
    (shapes[3].layers, shapes[3].collides_with) = (0, u32::MAX);
    let snapshot = world_of(shapes).newest();
    let filter = |layers, collides_with| Filter { layers, collides_with, ..Filter::default() };
    assert_eq!(seen(&snapshot, everything(), &filter(None, None)), [1, 2, 3], "a shape on no layer is never seen");
    assert_eq!(seen(&snapshot, everything(), &filter(Some(0b01), None)), [1, 2]);
    assert_eq!(seen(&snapshot, everything(), &filter(None, Some(0b01))), [1, 3]);
    assert_eq!(seen(&snapshot, everything(), &filter(Some(0b10), Some(0b10))), [2]);
    assert!(seen(&snapshot, everything(), &filter(Some(0), None)).is_empty());
}

#[test]
fn an_asker_of_the_world_brings_its_masks_and_sees_neither_itself_nor_its_group() {
    let mut shapes = row(5);
    shapes[0].geometry = Arc::new(Geometry::sphere(1e3).expect("a sphere"));
    shapes[0].group = 7;
    shapes[0].collides_with = 0b011;
    shapes[1].group = 7;
    shapes[2].layers = 0b100;
    shapes[3].collides_with = 0b110;
    let asker = |pose| Subject::Shape { id: id(1), pose };
    let snapshot = world_of(shapes).newest();
    assert_eq!(seen(&snapshot, asker(None), &Filter::default()), [5]);
    assert_eq!(seen(&snapshot, asker(Some(Pose::at(DVec3::Y))), &Filter::default()), [5], "nor does it elsewhere");
    let wider = Filter { layers: Some(u32::MAX), collides_with: Some(u32::MAX), ..Filter::default() };
    assert_eq!(seen(&snapshot, asker(None), &wider), [3, 4, 5], "masks that are given replace its own");
}

#[test]
fn exclusions_exclude() {
    let mut shapes = row(5);
    shapes[0].sensor = true;
    shapes[1].mobility = Mobility::Static;
    shapes[2].group = 9;
    let snapshot = world_of(shapes).newest();
    let filter = Filter {
        exclude_sensors: true,
        exclude_static: true,
        exclude_groups: vec![4, 9],
        exclude_ids: vec![id(77), id(5), id(5)],
        ..Filter::default()
    };
    assert_eq!(seen(&snapshot, everything(), &filter), [4]);
    let no_group = Filter { exclude_groups: vec![0], ..Filter::default() };
    assert_eq!(seen(&snapshot, everything(), &no_group), [1, 2, 3, 4, 5], "0 is no group");
}

#[test]
fn lists_are_cut_where_asked_and_say_so() {
    let snapshot = world_of(row(6).into_iter().rev()).newest();
    let found = overlap(&snapshot, everything(), &Filter::default(), 4);
    let ids: Vec<u64> = found.hits.iter().filter_map(|hit| hit.id).map(|id| id.get()).collect();
    assert_eq!((ids, found.truncated, found.verdict), (vec![1, 2, 3, 4], true, Verdict::Hit));
    assert!(!overlap(&snapshot, everything(), &Filter::default(), 6).truncated);

    let mut go_on = || true;
    let meter = &mut Meter::new(&mut go_on);
    let mut cast = |most| {
        let question = Raycast { ray: ray(DVec3::ZERO, DVec3::X * 1e-3), mode: HitMode::All(most) };
        snapshot.raycast(&question, &Filter::default(), &Accuracy::default(), meter).expect("an answer")
    };
    let found = cast(2);
    let distances: Vec<f64> = found.hits.iter().map(|hit| hit.touch.distance).collect();
    assert!((distances[0] - 2.0).abs() < 1e-12 && (distances[1] - 5.0).abs() < 1e-12 && distances.len() == 2);
    assert!(found.truncated && !cast(6).truncated && cast(0).hits.is_empty() && cast(0).truncated);
}

#[test]
fn a_sensor_blocks_nothing_unless_it_is_named() {
    let mut shapes = row(2);
    shapes[0].sensor = true;
    let snapshot = world_of(shapes).newest();
    let mut go_on = || true;
    let meter = &mut Meter::new(&mut go_on);
    let mut impact = |against: Option<Subject>, against_displacement| {
        let question = TimeOfImpact {
            subject: Subject::Geometry { geometry: ball(), pose: Pose::IDENTITY },
            displacement: DVec3::X * 10.0,
            rotation: DVec3::ZERO,
            against,
            against_displacement,
            against_rotation: DVec3::ZERO,
            initial: collision::narrow::InitialTouch::Counts,
            mode: HitMode::Closest,
        };
        let found = snapshot.time_of_impact(&question, &Filter::default(), &Accuracy::default(), meter);
        let hit = found.expect("an answer").hits.remove(0);
        (hit.id.map(|id| id.get()), hit.user_data, hit.touch.fraction)
    };
    let near = |found: (Option<u64>, u64, f64), id, user_data, fraction: f64| {
        assert_eq!((found.0, found.1), (id, user_data));
        assert!((found.2 - fraction).abs() < 1e-9, "{found:?}");
    };
    near(impact(None, DVec3::X), Some(2), 20, 0.4);
    let first = Subject::Shape { id: id(1), pose: None };
    near(impact(Some(first), DVec3::ZERO), Some(1), 10, 0.1);
    let elsewhere = Subject::Geometry { geometry: ball(), pose: Pose::at(DVec3::X * 12.0) };
    near(impact(Some(elsewhere), DVec3::X * -10.0), None, 0, 0.5);
}

#[test]
fn distance_says_how_far_and_proves_that_nothing_is_nearer() {
    let snapshot = world_of(row(9)).newest();
    let mut go_on = || true;
    let meter = &mut Meter::new(&mut go_on);
    let mut nearest = |max_distance, max_hits| {
        let question = Distance {
            subject: Subject::Geometry { geometry: Arc::new(Geometry::point()), pose: Pose::IDENTITY },
            against: None,
            max_distance,
            max_hits,
        };
        let found = snapshot.distance(&question, &Filter::default(), &Accuracy::default(), meter).expect("an answer");
        (found.verdict, found.hits.iter().filter_map(|hit| hit.id).map(|id| id.get()).collect::<Vec<_>>())
    };
    assert_eq!(nearest(1.9, 3), (Verdict::Miss, vec![]));
    assert_eq!(nearest(5.5, 3), (Verdict::Hit, vec![1, 2]));
    assert_eq!(nearest(4e12, 3), (Verdict::Hit, vec![1, 2, 3]));
}

#[test]
fn a_question_is_called_off_when_its_caller_says_so() {
    let snapshot = world_of((1..=2000).map(|number| shape(number, ball(), Pose::IDENTITY))).newest();
    let question = Overlap { subject: everything(), against: None, max_hits: 10_000 };
    let mut checks = 0;
    let mut go_on = || {
        checks += 1;
        checks < 3
    };
    let mut meter = Meter::new(&mut go_on);
    let found = snapshot.overlap(&question, &Filter::default(), &Accuracy::default(), &mut meter);
    assert_eq!(found.expect_err("it is called off"), QuestionError::Interrupted);
    let work = meter.work;
    assert!(work.nodes_visited + work.shapes_tested <= 3 * 256, "{work:?} before the third check");
    let mut go_on = || true;
    let mut meter = Meter::new(&mut go_on);
    let found = snapshot.overlap(&question, &Filter::default(), &Accuracy::default(), &mut meter).expect("an answer");
    assert_eq!((found.hits.len(), meter.work.shapes_tested), (2000, 2000));
    assert!(meter.work.pairs_tested >= 2000 && meter.work.nodes_visited >= 250);
}

#[test]
fn a_question_ends_at_its_limit_of_steps_and_not_before() {
    let snapshot = world_of((1..=2000).map(|number| shape(number, ball(), Pose::IDENTITY))).newest();
    let question = Overlap { subject: everything(), against: None, max_hits: 10_000 };
    let mut go_on = || true;
    let mut ask = |steps_max: u64| {
        let mut meter = Meter::new(&mut go_on).with_limit(steps_max);
        let found = snapshot.overlap(&question, &Filter::default(), &Accuracy::default(), &mut meter);
        (found.map(|found| found.hits.len()), meter.work.steps())
    };
    let (found, steps) = ask(u64::MAX);
    assert_eq!(found, Ok(2000));
    assert_eq!(ask(steps).0, Ok(2000));
    let (refused, spent) = ask(steps / 2);
    assert_eq!(refused, Err(QuestionError::TooLong(steps / 2)));
    assert!(spent >= steps / 2 && spent < steps, "{spent} of {steps}");
}

/// A static wall before a crowd: the limit that the static tree found holds in the dynamic one too.
#[test]
fn what_is_behind_a_wall_costs_nothing() {
    let wall = Shape {
        mobility: Mobility::Static,
        ..shape(1, Arc::new(Geometry::cuboid(DVec3::new(0.1, 50.0, 50.0)).expect("a box")), Pose::IDENTITY)
    };
    let crowd = (2..2000).map(|number| shape(number, ball(), Pose::at(DVec3::X * number as f64)));
    let snapshot = world_of(crowd.chain([wall])).newest();
    let question = Raycast { ray: ray(DVec3::X * -5.0, DVec3::X), mode: HitMode::Closest };
    let mut go_on = || true;
    let mut meter = Meter::new(&mut go_on);
    let found = snapshot.raycast(&question, &Filter::default(), &Accuracy::default(), &mut meter).expect("an answer");
    assert_eq!(found.hits.first().map(|hit| hit.id), Some(Some(id(1))));
    assert!(meter.work.nodes_visited <= 2 && meter.work.shapes_tested == 1, "{:?}", meter.work);
}
