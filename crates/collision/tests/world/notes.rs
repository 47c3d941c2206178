//! What a question notes of itself changes nothing, adds up, and is all that its answer depends on.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Pose,
    narrow::{self, InitialTouch, Placed, Ray},
    shape::Geometry,
    world::{Filter, HitMode, Meter, Note, Notes, Raycast, ShapeId, Snapshot, Subject, TimeOfImpact},
};

use crate::{
    determinism::FRAMES,
    random::Random,
    scene::{Question, ask, ask_by, random_filter, random_questions, random_shapes, ray, shape, world_of},
};

/// Its answer, what it noted, at most `most`, and what it cost.
fn noted(world: &Snapshot, question: &Question, filter: &Filter, most: usize) -> (String, Notes, Work) {
    let mut go_on = || true;
    let mut notes = Notes::new(most);
    let mut meter = Meter::new(&mut go_on).noting(&mut notes);
    let answer = ask_by(&mut meter, world, question, filter);
    let work = meter.work;
    (answer, notes, work)
}

fn subject_of(question: &Question) -> Option<&Subject> {
    match question {
        Question::Raycast(_) => None,
        Question::Overlap(question) => Some(&question.subject),
        Question::Penetration(question) => Some(&question.subject),
        Question::TimeOfImpact(question) => Some(&question.subject),
        Question::Distance(question) => Some(&question.subject),
    }
}

fn sum(notes: &[Note]) -> Work {
    notes.iter().fold(Work::default(), |mut all, note| {
        all += note.work;
        all
    })
}

#[test]
fn notes_change_no_answer_and_name_all_that_it_depends_on() {
    let mut random = Random::new(77);
    let (mut apart, mut touching, mut smaller) = (0, 0, 0);
    for scene in 0..6 {
        let frame = FRAMES[scene % 3];
        let shapes = random_shapes(&mut random, frame, 60);
        let world = world_of(shapes.clone()).newest();
        for _ in 0..40 {
            let filter = random_filter(&mut random);
            for question in random_questions(&mut random, frame, shapes.len() as u64) {
                let plain = ask(&world, &question, &filter);
                let (answer, notes, work) = noted(&world, &question, &filter, usize::MAX);
                assert_eq!(plain, answer, "{question:?}");
                assert_eq!(notes.list.len() as u64, work.shapes_tested, "{question:?}");
                let of_pairs = sum(&notes.list);
                assert_eq!(of_pairs.pairs_tested, work.pairs_tested, "what kernels do is done for some pair");
                assert_eq!(of_pairs.iterations, work.iterations);
                assert!(of_pairs.nodes_visited <= work.nodes_visited);

                let mut named: Vec<_> = notes.list.iter().filter_map(|note| note.id).collect();
                if let Some(Subject::Shape { id, .. }) = subject_of(&question) {
                    named.push(*id);
                }
                let few = world_of(shapes.iter().filter(|shape| named.contains(&shape.id)).cloned()).newest();
                smaller += usize::from(few.len() < world.len());
                assert_eq!(plain, ask(&few, &question, &filter), "{question:?} of {named:?} alone");
                apart += notes.list.iter().filter(|note| note.verdict == Verdict::Miss).count();
                touching += notes.list.iter().filter(|note| note.verdict == Verdict::Hit).count();
            }
        }
    }
    assert!(smaller > 1000 && apart > 1000 && touching > 1000, "vacuous: {smaller}, {apart}, {touching}");
}

/// The first are kept, the others counted.
#[test]
fn no_more_notes_are_kept_than_asked_for() {
    let mut random = Random::new(78);
    let frame = FRAMES[0];
    let shapes = random_shapes(&mut random, frame, 80);
    let world = world_of(shapes).newest();
    let filter = collision::world::Filter::default();
    let mut cut = 0;
    for _ in 0..20 {
        for question in random_questions(&mut random, frame, 80) {
            let (answer, all, work) = noted(&world, &question, &filter, usize::MAX);
            let (same, some, same_work) = noted(&world, &question, &filter, 2);
            assert_eq!((answer, work), (same, same_work));
            assert_eq!(some.list.len() as u64 + some.left_out_count, all.list.len() as u64);
            let ids = |notes: &Notes| notes.list.iter().take(2).map(|note| note.id).collect::<Vec<_>>();
            assert_eq!(ids(&some), ids(&all));
            cut += usize::from(some.left_out_count > 0);
        }
    }
    assert!(cut > 20, "vacuous: {cut}");
}

/// Of two that are proved apart, how far apart they are at least is above what was asked.
#[test]
fn what_is_proved_apart_is_measured() {
    let mut random = Random::new(79);
    let mut measured = 0;
    let frame = FRAMES[0];
    let world = world_of(random_shapes(&mut random, frame, 80)).newest();
    for _ in 0..200 {
        for question in random_questions(&mut random, frame, 80) {
            let (least, sign) = match &question {
                Question::Distance(question) => (question.max_distance, 1.0),
                Question::Penetration(question) if question.max_gap == 0.0 => (0.0, -1.0),
                Question::Penetration(_) => continue,
                Question::Raycast(_) | Question::Overlap(_) | Question::TimeOfImpact(_) => continue,
            };
            let (_, notes, _) = noted(&world, &question, &collision::world::Filter::default(), usize::MAX);
            for note in notes.list.iter().filter(|note| note.verdict == Verdict::Miss) {
                let bound = note.certificate.expect("two forms are some way apart").bound;
                assert!(sign * bound.lower > least || sign * bound.upper > least, "{bound:?} of {question:?}");
                measured += 1;
            }
        }
    }
    assert!(measured > 100, "vacuous: {measured}");
}

/// How far from the middle of a ball a ray passes, less the radius.
fn gap(ray: &Ray, middle: DVec3, radius: f64) -> f64 {
    let direction = ray.direction.normalize();
    let along = (middle - ray.origin).dot(direction).clamp(ray.min_distance, ray.max_distance);
    (ray.origin + direction * along).distance(middle) - radius
}

#[test]
fn of_a_ray_that_passes_by_it_is_told_how_far() {
    let mut random = Random::new(31);
    let (mut passed, mut short) = (0, 0);
    for scale in [1e-3, 1.0, 1e5] {
        for _ in 0..2500 {
            let (middle, radius) = (random.vector() * 3.0 * scale, (0.2 + random.unit()) * scale);
            let ball = Arc::new(Geometry::sphere(radius).expect("a ball"));
            let world = world_of([shape(1, ball, Pose::at(middle))]).newest();
            let max_distance = if random.unit() < 0.5 { 4e12 } else { random.unit() * 5.0 * scale };
            let aim = middle + random.vector() * 2.0 * scale;
            let origin = random.vector() * 6.0 * scale;
            let question = Raycast { ray: Ray { max_distance, ..ray(origin, aim - origin) }, mode: HitMode::Closest };
            let mut go_on = || true;
            let mut notes = Notes::new(9);
            let mut meter = Meter::new(&mut go_on).noting(&mut notes);
            let found = world.raycast(&question, &Filter::default(), &Accuracy::default(), &mut meter).expect("found");
            let Some(note) = notes.list.first().filter(|_| found.verdict == Verdict::Miss) else { continue };
            let certificate = note.certificate.expect("it is measured");
            let expected = gap(&question.ray, middle, radius);
            let slack = 1e-14 * scale;
            let bound = certificate.bound;
            assert!(
                bound.lower <= expected + slack && expected <= bound.upper + slack,
                "{question:?}: {expected}, {bound:?}"
            );
            assert!(bound.lower >= 0.0 && bound.width() < 1e-12 * scale, "{question:?}: {bound:?}");
            assert_eq!(certificate.verdict, Verdict::Miss);
            passed += 1;
            short += usize::from((middle - origin).length() - radius > max_distance);
        }
    }
    assert!(passed > 300 && short > 5, "vacuous: {passed} passed by, {short} of them ended before");
}

/// What a motion against shape 1 notes of it, if it passes it by.
fn passing(world: &Snapshot, question: &TimeOfImpact) -> Option<Note> {
    let mut go_on = || true;
    let mut notes = Notes::new(9);
    let mut meter = Meter::new(&mut go_on).noting(&mut notes);
    let found = world.time_of_impact(question, &Filter::default(), &Accuracy::default(), &mut meter).expect("found");
    notes.list.pop().filter(|_| found.verdict == Verdict::Miss)
}

fn motion(subject: Subject, displacement: DVec3, rotation: DVec3) -> TimeOfImpact {
    TimeOfImpact {
        subject,
        displacement,
        rotation,
        against: Some(Subject::Shape { id: ShapeId::new(1).expect("not 0"), pose: None }),
        against_displacement: DVec3::ZERO,
        against_rotation: DVec3::ZERO,
        initial: InitialTouch::Counts,
        mode: HitMode::Closest,
    }
}

#[test]
fn of_a_motion_that_passes_by_it_is_told_how_near_it_comes() {
    let mut random = Random::new(37);
    let mut passed = 0;
    for scale in [1e-3, 1.0, 1e5] {
        for _ in 0..700 {
            let (middle, radii) = (random.vector() * 3.0 * scale, [0.2 + random.unit(), 0.2 + random.unit()]);
            let [ball, moving] = radii.map(|radius| Arc::new(Geometry::sphere(radius * scale).expect("a ball")));
            let world = world_of([shape(1, ball, Pose::at(middle))]).newest();
            let (begin, way) = (random.vector() * 6.0 * scale, random.vector() * 8.0 * scale);
            let against_displacement = random.vector() * 3.0 * scale;
            let subject = Subject::Geometry { geometry: moving, pose: Pose::at(begin) };
            let question = TimeOfImpact { against_displacement, ..motion(subject, way, DVec3::ZERO) };
            let Some(note) = passing(&world, &question) else { continue };
            let bound = note.certificate.expect("it is measured").bound;
            let (apart, relative) = (begin - middle, way - against_displacement);
            let time = (-apart.dot(relative) / relative.length_squared()).clamp(0.0, 1.0);
            let expected = (apart + relative * time).length() - (radii[0] + radii[1]) * scale;
            let slack = 1e-13 * scale;
            assert!(
                bound.lower <= expected + slack && expected <= bound.upper + slack,
                "{question:?}: {expected}, {bound:?}"
            );
            assert!(bound.width() <= 0.05 * expected + 0.03 * scale, "{question:?}: {expected}, {bound:?}");
            passed += 1;
        }
    }
    assert!(passed > 700, "vacuous: {passed}");
}

#[test]
fn of_a_turning_motion_that_passes_by_it_is_told_how_near_it_comes() {
    let mut random = Random::new(41);
    let mut passed = 0;
    let cuboid = |random: &mut Random| {
        Arc::new(
            Geometry::cuboid(DVec3::new(0.1 + random.unit(), 0.1 + random.unit(), 0.1 + random.unit())).expect("a box"),
        )
    };
    for _ in 0..150 {
        let [fixed, moving] = [cuboid(&mut random), cuboid(&mut random)];
        let world = world_of([shape(1, Arc::clone(&fixed), Pose::IDENTITY)]).newest();
        let (begin, way, turn) = (random.vector() * 5.0, random.vector() * 6.0, random.vector() * 4.0);
        let subject = Subject::Geometry { geometry: Arc::clone(&moving), pose: Pose::at(begin) };
        let Some(note) = passing(&world, &motion(subject, way, turn)) else { continue };
        let bound = note.certificate.expect("it is measured").bound;
        let end = |time: f64| Pose::new(begin + way * time, collision::DQuat::from_scaled_axis(turn * time));
        let sampled = (0..=400).map(|at| {
            let a = Placed { geometry: &moving, pose: end(f64::from(at) / 400.0) };
            let b = Placed { geometry: &fixed, pose: Pose::IDENTITY };
            let found = narrow::distance(a, b, 4e12, &Accuracy::default(), &mut Work::default());
            found.expect("they are some way apart").certificate.bound.upper
        });
        let nearest = sampled.fold(f64::INFINITY, f64::min);
        // Samples are a hundredth of a metre apart at most, and so is what they miss.
        assert!(bound.lower <= nearest && bound.upper >= nearest - 0.05, "{nearest}, {bound:?}");
        assert!(bound.width() <= 0.05 * nearest + 0.1, "{nearest}, {bound:?}");
        passed += 1;
    }
    assert!(passed > 50, "vacuous: {passed}");
}
