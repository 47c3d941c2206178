//! Ways out: what is moved overlaps nothing then or is told to, never ends deeper than it began, and goes no farther than it must.

use std::sync::Arc;

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Pose,
    narrow::{self, Placed},
    shape::Geometry,
    world::{
        Contact, Depenetrate, Depenetrated, Distance, Filter, Found, Meter, Overlap, Penetration, QuestionError, Shape,
        Snapshot, Subject,
    },
};

use crate::random::Random;
use crate::scene::{Frame, half_spaces, id, random_geometry, random_pose, random_shapes, shape, world_of};

const EXACT: Accuracy = Accuracy::of(collision::accuracy::Tier::Exact);

fn form(geometry: &Arc<Geometry>, pose: Pose) -> Subject {
    Subject::Geometry { geometry: geometry.clone(), pose }
}

fn out_of(subject: Subject) -> Depenetrate {
    Depenetrate { subject, against: None, gap: 0.0, max_distance: 4e12, max_passes: 8 }
}

fn push(world: &Snapshot, question: &Depenetrate) -> Depenetrated {
    try_push(world, question).expect("an answer")
}

fn try_push(world: &Snapshot, question: &Depenetrate) -> Result<Depenetrated, QuestionError> {
    world.depenetrate(question, &Filter::default(), &Accuracy::default(), &mut Meter::new(&mut || true))
}

fn contacts(world: &Snapshot, subject: Subject) -> Found<Contact> {
    let question = Penetration { subject, against: None, max_gap: 0.0, max_contacts: 4096 };
    let filter = Filter { exclude_sensors: true, ..Filter::default() };
    world.penetration(&question, &filter, &EXACT, &mut Meter::new(&mut || true)).expect("an answer")
}

fn block(number: u64, half: DVec3, center: DVec3) -> Shape {
    shape(number, Arc::new(Geometry::cuboid(half).expect("a box")), Pose::at(center))
}

fn cube(half: f64) -> Arc<Geometry> {
    Arc::new(Geometry::cuboid(DVec3::splat(half)).expect("a box"))
}

#[track_caller]
fn assert_near(found: DVec3, expected: DVec3) {
    assert!((found - expected).length() < 1e-9, "{found} is not {expected}");
}

/// Whether each shape by itself is proved to be clear of a form.
fn is_clear_of_each(shapes: &[Shape], geometry: &Geometry, pose: Pose) -> bool {
    let here = Placed { geometry, pose };
    shapes.iter().filter(|shape| !shape.sensor).all(|shape| {
        let there = Placed { geometry: &shape.geometry, pose: shape.pose };
        narrow::overlap(here, there, &EXACT, &mut Work::default()).verdict == Verdict::Miss
    })
}

fn convex(random: &mut Random, frame: Frame) -> Arc<Geometry> {
    loop {
        let geometry = random_geometry(random, frame);
        if matches!(geometry.form(), collision::shape::Form::Convex(_)) {
            return geometry;
        }
    }
}

fn compare_in(frame: Frame) {
    let mut random = Random::new(9);
    let (mut asked, mut stuck, mut freed) = (0, 0, 0);
    for round in 0..10_u64 {
        let count = 4 + 2 * round;
        let mut shapes = random_shapes(&mut random, frame, count);
        if round % 2 == 1 {
            shapes.extend(half_spaces(&mut random, frame, count + 1));
        }
        let world = world_of(shapes.clone()).newest();
        for _ in 0..30 {
            let (geometry, pose) = (convex(&mut random, frame), random_pose(&mut random, frame, 4.0));
            let question = out_of(form(&geometry, pose));
            let out = push(&world, &question);
            let begin = contacts(&world, form(&geometry, pose));
            let deepest = |found: &Found<Contact>| {
                found.hits.iter().map(|hit| hit.certificate.bound.upper).fold(f64::NEG_INFINITY, f64::max)
            };
            assert_eq!(out.position, pose.position + out.translation);
            assert!(out.depth.upper <= deepest(&begin).max(0.0), "{out:?} {begin:?}");
            asked += 1;
            if begin.hits.is_empty() {
                assert_eq!((out.translation, out.passes, out.verdict), (DVec3::ZERO, 0, Verdict::Miss));
                assert!(out.moved_out_of.is_empty());
                continue;
            }
            stuck += 1;
            let end = Pose { position: out.position, ..pose };
            let left = contacts(&world, form(&geometry, end));
            let depth = left.hits.first().map(|contact| contact.depth);
            assert!(depth.is_none_or(|depth| out.depth.contains(depth)), "{depth:?} {out:?}");
            assert!(begin.hits.iter().all(|hit| hit.id.is_some_and(|id| out.moved_out_of.contains(&id))));
            if out.verdict == Verdict::Miss {
                freed += 1;
                assert!(is_clear_of_each(&shapes, &geometry, end), "{out:?}");
                assert!(out.depth.upper <= 0.0);
                // It had to go at least as far as out of the deepest.
                let least = begin.hits.iter().map(|hit| hit.certificate.bound.lower).fold(0.0, f64::max);
                let parts = begin.hits.iter().filter(|hit| hit.feature.face.is_none()).count();
                assert!(
                    parts < begin.hits.len() || out.translation.length() >= least * (1.0 - 1e-9),
                    "{out:?} {least}"
                );
            }
            // The same question has the same answer.
            let again = push(&world, &question);
            assert_eq!(format!("{out:?}"), format!("{again:?}"));
        }
    }
    assert!(stuck * 10 > asked * 3 && stuck < asked, "vacuous: {stuck} of {asked}");
    assert!(freed * 10 > stuck * 8, "only {freed} of {stuck} got out");
}

#[test]
fn what_is_told_to_be_free_is_free_and_nothing_ends_deeper() {
    compare_in(Frame::UNIT);
}

#[test]
fn so_it_is_among_small_shapes_far_out_and_among_large_ones() {
    compare_in(Frame { scale: 1e-3, origin: DVec3::new(1e3, 5e3, -2e3) });
    compare_in(Frame { scale: 1e6, origin: DVec3::new(9e10, -9e10, 5e10) });
}

#[test]
fn out_of_one_convex_shape_it_goes_the_shortest_way() {
    let mut random = Random::new(4);
    let mut moved = 0;
    for _ in 0..200 {
        let (a, b) = (convex(&mut random, Frame::UNIT), convex(&mut random, Frame::UNIT));
        let (pose, there) = (random_pose(&mut random, Frame::UNIT, 0.5), random_pose(&mut random, Frame::UNIT, 0.5));
        let world = world_of([shape(1, b, there)]).newest();
        let begin = contacts(&world, form(&a, pose));
        let Some(contact) = begin.hits.first() else { continue };
        let out = push(&world, &out_of(form(&a, pose)));
        let (bound, way) = (contact.certificate.bound, out.translation.length());
        assert!(bound.lower <= way && way <= bound.upper + 4.0 * bound.width() + 1e-12, "{way} {bound:?}");
        assert_eq!((out.verdict, out.moved_out_of.as_slice()), (Verdict::Miss, &[id(1)][..]), "{out:?}");
        moved += 1;
    }
    assert!(moved > 100, "vacuous: {moved}");
}

#[test]
fn out_of_a_corner_it_goes_along_all_three_walls() {
    let wall = |number: u64, normal: DVec3| {
        let geometry = Arc::new(Geometry::half_space(normal, 0.0).expect("a half space"));
        shape(number, geometry, Pose::IDENTITY)
    };
    let world = world_of([wall(1, DVec3::X), wall(2, DVec3::Y), wall(3, DVec3::Z)]).newest();
    let out = push(&world, &out_of(form(&cube(1.0), Pose::at(DVec3::new(0.75, 0.5, 0.875)))));
    assert_near(out.translation, DVec3::new(0.25, 0.5, 0.125));
    assert_eq!((out.verdict, out.passes, out.moved_out_of.len()), (Verdict::Miss, 1, 3));
    assert!(out.depth.upper == 0.0 && out.contacts.is_empty(), "{out:?}");
}

#[test]
fn two_that_push_to_and_fro_are_passed_together() {
    // A wedge of two tilted boxes: out of the one leads into the other, and back.
    let tilted = |number: u64, side: f64| {
        let geometry = Arc::new(Geometry::cuboid(DVec3::new(0.5, 9.0, 9.0)).expect("a box"));
        shape(number, geometry, Pose::new(DVec3::X * side, DQuat::from_xyzw(0.0, 0.0, -0.1 * side.signum(), 1.0)))
    };
    let world = world_of([tilted(1, -1.5), tilted(2, 1.5)]).newest();
    let out = push(&world, &out_of(form(&cube(1.0), Pose::at(DVec3::new(0.4, 0.5, 0.0)))));
    assert_eq!((out.verdict, out.moved_out_of.len()), (Verdict::Miss, 2), "{out:?}");
    // Straight up the wedge, to its middle.
    assert!(out.passes <= 2 && out.position.x.abs() < 1e-9 && out.translation.length() < 2.0, "{out:?}");
}

#[test]
fn a_gap_is_kept_and_what_was_nearer_is_moved_away() {
    let world = world_of([block(1, DVec3::new(9.0, 0.5, 9.0), DVec3::Y * -0.5)]).newest();
    for height in [0.9, 1.0, 1.1] {
        let question = Depenetrate { gap: 0.25, ..out_of(form(&cube(1.0), Pose::at(DVec3::Y * height))) };
        let out = push(&world, &question);
        assert_near(out.position, DVec3::Y * 1.25);
        assert_eq!((out.verdict, out.passes), (Verdict::Miss, 1));
        let subject = form(&cube(1.0), Pose::at(out.position));
        let near = Distance { subject, against: None, max_distance: 9.0, max_hits: 1 };
        let near = world.distance(&near, &Filter::default(), &EXACT, &mut Meter::new(&mut || true)).expect("an answer");
        assert!(near.hits[0].separation.certificate.bound.lower >= 0.25);
        assert!(out.depth.upper <= -0.25);
    }
    let far = Depenetrate { gap: 0.25, ..out_of(form(&cube(1.0), Pose::at(DVec3::Y * 1.5))) };
    assert_eq!(push(&world, &far).passes, 0);
}

#[test]
fn what_is_squeezed_goes_over_what_squeezes_it_or_stays_and_is_told_how_deep() {
    let low = [block(1, DVec3::new(9.0, 3.0, 9.0), DVec3::X * -9.5), block(2, DVec3::splat(9.0), DVec3::X * 9.25)];
    let out = push(&world_of(low).newest(), &out_of(form(&cube(0.5), Pose::IDENTITY)));
    assert_eq!(out.verdict, Verdict::Miss, "{out:?}");
    // Out of the taller wall to the side, over the lower one.
    assert!((3.4..9.6).contains(&out.translation.length()), "{out:?}");
    let wall = |number: u64, normal: DVec3| {
        shape(number, Arc::new(Geometry::half_space(normal, -0.375).expect("a half space")), Pose::IDENTITY)
    };
    let world = world_of([wall(1, DVec3::X), wall(2, DVec3::NEG_X)]).newest();
    let narrow = world_of([wall(1, DVec3::X)]).newest();
    assert_eq!(push(&narrow, &out_of(form(&cube(0.5), Pose::IDENTITY))).verdict, Verdict::Miss);
    let out = push(&world, &out_of(form(&cube(0.5), Pose::IDENTITY)));
    assert_eq!(out.verdict, Verdict::Hit, "{out:?}");
    assert!(out.depth.lower > 0.0 && out.depth.upper <= 0.125 + 1e-9, "{out:?}");
    assert!(!out.contacts.is_empty());
    // Too short a leash, too few passes: where it was, with the depth there.
    let one = world_of([block(1, DVec3::splat(9.0), DVec3::X * -9.5)]).newest();
    for held in [
        Depenetrate { max_distance: 0.1, ..out_of(form(&cube(0.75), Pose::IDENTITY)) },
        Depenetrate { max_passes: 0, ..out_of(form(&cube(0.75), Pose::IDENTITY)) },
    ] {
        let out = push(&one, &held);
        assert_eq!((out.verdict, out.translation, out.passes), (Verdict::Hit, DVec3::ZERO, 0));
        assert!(out.depth.contains(0.25), "{out:?}");
    }
    let enough = Depenetrate { max_distance: 0.3, ..out_of(form(&cube(0.75), Pose::IDENTITY)) };
    assert_near(push(&one, &enough).translation, DVec3::X * 0.25);
}

#[test]
fn a_shape_leaves_all_but_itself_and_sensors_or_the_one_that_is_named() {
    let mut sensor = block(3, DVec3::ONE, DVec3::ZERO);
    sensor.sensor = true;
    let floor = block(2, DVec3::new(9.0, 0.5, 9.0), DVec3::Y * -1.25);
    let wall = block(4, DVec3::new(0.5, 9.0, 9.0), DVec3::X * 1.25);
    let world = world_of([block(1, DVec3::ONE, DVec3::ZERO), floor, sensor, wall]).newest();
    let subject = Subject::Shape { id: id(1), pose: None };
    let out = push(&world, &out_of(subject.clone()));
    assert_near(out.translation, DVec3::new(-0.25, 0.25, 0.0));
    let against = |number| Some(Subject::Shape { id: id(number), pose: None });
    let alone = Depenetrate { against: against(2), ..out_of(subject.clone()) };
    let out = push(&world, &alone);
    assert_near(out.translation, DVec3::Y * 0.25);
    assert_eq!((out.verdict, out.moved_out_of), (Verdict::Miss, vec![id(2)]));
    let question = Overlap { subject, against: against(2), max_hits: 1 };
    let touch = world.overlap(&question, &Filter::default(), &EXACT, &mut Meter::new(&mut || true)).expect("an answer");
    assert_eq!(touch.verdict, Verdict::Hit, "nothing was moved");
    let gone = out_of(Subject::Shape { id: id(9), pose: None });
    assert_eq!(try_push(&world, &gone).unwrap_err(), QuestionError::SubjectNotFound(id(9)));
    let gone = Depenetrate { against: against(9), ..out_of(Subject::Shape { id: id(1), pose: None }) };
    assert_eq!(try_push(&world, &gone).unwrap_err(), QuestionError::AgainstNotFound(id(9)));
}
