//! Each question against the obvious way to answer it: the kernel on every shape, one after the other.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::{Certificate, Verdict, Work},
    math::Pose,
    narrow::{self, NeedsDecomposition, Placed},
    shape::Geometry,
    world::{
        Distance, Filter, Found, HitMode, Meter, Mobility, Overlap, Penetration, QuestionError, Raycast, Shape,
        ShapeId, Snapshot, Subject, TimeOfImpact,
    },
};

use crate::random::Random;
use crate::scene::{
    Frame, Question, half_spaces, id, random_filter, random_questions, random_shapes, ray, shape, world_of,
};

const ACCURACY: Accuracy = Accuracy::of(collision::accuracy::Tier::Standard);

/// The world as a list.
struct Brute<'a> {
    shapes: &'a [Shape],
    filter: &'a Filter,
    frame: Frame,
    work: Work,
}

fn placed(shape: &Shape) -> Placed<'_> {
    Placed { geometry: &shape.geometry, pose: shape.pose }
}

impl<'a> Brute<'a> {
    fn seen_by(&self, asker: Option<&Shape>) -> Vec<&'a Shape> {
        let layers = self.filter.layers.or(asker.map(|shape| shape.layers)).unwrap_or(u32::MAX);
        let wanted = self.filter.collides_with.or(asker.map(|shape| shape.collides_with)).unwrap_or(u32::MAX);
        let seen = |shape: &&Shape| {
            let is_asker = asker.is_some_and(|asker| asker.id == shape.id);
            let is_of_group = asker.is_some_and(|asker| asker.group != 0 && asker.group == shape.group);
            let f = self.filter;
            (shape.layers & wanted) != 0
                && (shape.collides_with & layers) != 0
                && !is_asker
                && !is_of_group
                && !f.exclude_ids.contains(&shape.id)
                && (shape.group == 0 || !f.exclude_groups.contains(&shape.group))
                && (!f.exclude_sensors || !shape.sensor)
                && (!f.exclude_static || shape.mobility != Mobility::Static)
        };
        self.shapes.iter().filter(seen).collect()
    }

    fn subject<'s>(&self, subject: &'s Subject) -> (Placed<'s>, Option<&'a Shape>)
    where
        'a: 's,
    {
        match subject {
            Subject::Geometry { geometry, pose } => (Placed { geometry, pose: *pose }, None),
            Subject::Shape { id, pose } => {
                let shape = self.shapes.iter().find(|shape| shape.id == *id).expect("it is there");
                let pose: Pose = pose.unwrap_or(shape.pose);
                let geometry = &shape.geometry;
                (Placed { geometry, pose }, Some(shape))
            }
        }
    }

    /// Value and id of all certain touches, least first; and of the undecided ones.
    fn rays(&mut self, question: &Raycast) -> (Touches, Touches) {
        let (mut certain, mut undecided) = (Vec::new(), Vec::new());
        for shape in self.seen_by(None) {
            let touches = narrow::raycast(&question.ray, placed(shape), &ACCURACY, &mut self.work);
            certain.extend(touches.certain.map(|touch| (touch.distance, shape.id)));
            undecided.extend(touches.undecided.map(|touch| (touch.distance, shape.id)));
        }
        (sorted(certain), sorted(undecided))
    }

    fn impacts(&mut self, question: &TimeOfImpact) -> (Touches, Touches) {
        let (subject, asker) = self.subject(&question.subject);
        let (mut certain, mut undecided) = (Vec::new(), Vec::new());
        for shape in self.seen_by(asker).into_iter().filter(|shape| !shape.sensor) {
            let motion = narrow::Motion {
                displacement_a: question.displacement,
                displacement_b: question.against_displacement,
                rotation_a: question.rotation,
                rotation_b: question.against_rotation,
                initial: question.initial,
            };
            let touch = narrow::impact(subject, placed(shape), &motion, &ACCURACY, &mut self.work);
            let Some(touch) = touch else {
                continue;
            };
            let list = if touch.certificate.verdict == Verdict::Hit { &mut certain } else { &mut undecided };
            list.push((touch.fraction, shape.id));
        }
        (sorted(certain), sorted(undecided))
    }

    fn overlaps(&mut self, question: &Overlap) -> Vec<ShapeId> {
        let (subject, asker) = self.subject(&question.subject);
        let mut seen = self.seen_by(asker);
        seen.sort_by_key(|shape| shape.id);
        let mut touch =
            |shape: &Shape| narrow::overlap(subject, placed(shape), &ACCURACY, &mut self.work).verdict != Verdict::Miss;
        seen.into_iter().filter(|shape| touch(shape)).map(|shape| shape.id).collect()
    }

    /// `Err` names the first mesh that a mesh may touch.
    fn contacts(&mut self, question: &Penetration) -> Result<Touches, ShapeId> {
        let (subject, asker) = self.subject(&question.subject);
        let bounds = subject.geometry.bounds(&subject.pose).inflated(question.max_gap);
        let mut depths = Vec::new();
        let mut seen = self.seen_by(asker);
        seen.sort_by_key(|shape| shape.id);
        for shape in seen {
            let other = placed(shape);
            match narrow::penetration(subject, other, question.max_gap, &ACCURACY, &mut self.work) {
                Ok(contacts) => depths.extend(contacts.into_iter().map(|contact| (-contact.depth, shape.id))),
                Err(NeedsDecomposition) if other.geometry.bounds(&other.pose).intersects(bounds) => {
                    return Err(shape.id);
                }
                Err(NeedsDecomposition) => {}
            }
        }
        Ok(sorted(depths))
    }

    fn distances(&mut self, question: &Distance) -> Touches {
        let (subject, asker) = self.subject(&question.subject);
        let mut distances = Vec::new();
        for shape in self.seen_by(asker) {
            let found = narrow::distance(subject, placed(shape), question.max_distance, &ACCURACY, &mut self.work);
            distances.extend(found.map(|separation| (separation.distance, shape.id)));
        }
        sorted(distances)
    }
}

type Touches = Vec<(f64, ShapeId)>;

fn sorted(mut touches: Touches) -> Touches {
    touches.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    touches
}

/// By how much a canonical box may raise a value: what rounds its corners, as a part of the frame's scale.
fn rounding(frame: Frame) -> f64 {
    64.0 * f64::EPSILON * (1.0 + frame.origin.abs().max_element() / frame.scale)
}

/// Ids in order, and values but for what canonical boxes raised them by.
fn assert_same(found: &Touches, expected: &[(f64, ShapeId)], tolerance: f64, what: &Question) {
    assert_eq!(found.len(), expected.len(), "{found:?} for {expected:?}: {what:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.1, expected.1, "{what:?}");
        assert!((found.0 - expected.0).abs() <= tolerance, "{found:?} {expected:?}: {what:?}");
    }
}

fn assert_mode<H>(
    found: &Found<H>,
    value: impl Fn(&H) -> ((f64, ShapeId), Certificate),
    (certain, undecided): (Touches, Touches),
    mode: HitMode,
    tolerance: f64,
    what: &Question,
) {
    let list: Touches = found.hits.iter().map(|hit| value(hit).0).collect();
    for (touch, certificate) in found.hits.iter().map(&value) {
        assert!(certificate.bound.contains(touch.0), "{touch:?} not in {certificate:?}");
    }
    let verdict = if !certain.is_empty() {
        Verdict::Hit
    } else if !undecided.is_empty() {
        Verdict::Undecided
    } else {
        Verdict::Miss
    };
    match mode {
        HitMode::Closest => {
            assert_eq!(found.verdict, verdict, "{what:?}");
            if let Some(best) = certain.first() {
                assert_same(&list[list.len() - 1..].to_vec(), &[*best], tolerance, what);
                assert!(list[..list.len() - 1].iter().all(|hit| undecided.iter().any(|open| open.1 == hit.1)));
            } else {
                assert_same(&list, &undecided, tolerance, what);
            }
        }
        HitMode::Any => {
            assert_eq!(found.verdict, verdict, "{what:?}");
            assert!(certain.is_empty() || certain.iter().any(|hit| hit.1 == list[0].1));
        }
        HitMode::All(most) => {
            let open = undecided.into_iter().filter(|open| certain.iter().all(|hit| hit.1 != open.1));
            let all = sorted(certain.iter().copied().chain(open).collect());
            assert_eq!(found.truncated, all.len() > most, "{what:?}");
            assert_same(&list, &all[..all.len().min(most)], tolerance, what);
        }
        HitMode::Pierce { .. } => unreachable!("laws of its own: pierce.rs"),
    }
}

fn compare(snapshot: &Snapshot, brute: &mut Brute<'_>, question: &Question) -> Verdict {
    let mut go_on = || true;
    let meter = &mut Meter::new(&mut go_on);
    let filter = brute.filter;
    let length = rounding(brute.frame) * brute.frame.scale;
    match question {
        Question::Raycast(raycast) => {
            let found = snapshot.raycast(raycast, filter, &ACCURACY, meter).expect("an answer");
            let expected = brute.rays(raycast);
            let value = |hit: &collision::world::RayHit| {
                ((hit.touch.distance, hit.id.expect("a shape")), hit.touch.certificate)
            };
            assert_mode(&found, value, expected, raycast.mode, length, question);
            found.verdict
        }
        Question::TimeOfImpact(impact) => {
            let found = snapshot.time_of_impact(impact, filter, &ACCURACY, meter).expect("an answer");
            let expected = brute.impacts(impact);
            let value = |hit: &collision::world::Impact| {
                ((hit.touch.fraction, hit.id.expect("a shape")), hit.touch.certificate)
            };
            assert_mode(&found, value, expected, impact.mode, rounding(brute.frame), question);
            found.verdict
        }
        Question::Overlap(overlap) => {
            let found = snapshot.overlap(overlap, filter, &ACCURACY, meter).expect("an answer");
            let mut expected = brute.overlaps(overlap);
            assert_eq!(found.truncated, expected.len() > overlap.max_hits);
            expected.truncate(overlap.max_hits);
            assert_eq!(found.hits.iter().filter_map(|hit| hit.id).collect::<Vec<_>>(), expected, "{question:?}");
            found.verdict
        }
        Question::Penetration(penetration) => {
            let found = snapshot.penetration(penetration, filter, &ACCURACY, meter);
            compare_contacts(found, brute, penetration, question)
        }
        Question::Distance(distance) => {
            let found = snapshot.distance(distance, filter, &ACCURACY, meter).expect("an answer");
            let expected = brute.distances(distance);
            let value = |hit: &collision::world::Neighbor| (hit.separation.distance, hit.id.expect("a shape"));
            let list = found.hits.iter().map(value).collect();
            assert_same(&list, &expected[..expected.len().min(distance.max_hits)], length, question);
            found.verdict
        }
    }
}

fn compare_contacts(
    found: Result<Found<collision::world::Contact>, QuestionError>,
    brute: &mut Brute<'_>,
    asked: &Penetration,
    question: &Question,
) -> Verdict {
    let length = rounding(brute.frame) * brute.frame.scale;
    let expected = match brute.contacts(asked) {
        Ok(expected) => expected,
        Err(id) => {
            assert_eq!(found.expect_err("two meshes"), QuestionError::NeedsDecomposition(Some(id)));
            return Verdict::Undecided;
        }
    };
    let found = found.expect("an answer");
    let list = found.hits.iter().map(|hit| (-hit.depth, hit.id.expect("a shape"))).collect();
    assert_eq!(found.truncated, expected.len() > asked.max_contacts);
    assert_same(&list, &expected[..expected.len().min(asked.max_contacts)], length, question);
    found.verdict
}

fn compare_in(frame: Frame) {
    let mut random = Random::new(31);
    let mut hits = [0; 5];
    let mut asked = 0;
    for (round, count) in [1, 3, 10, 40, 90, 150].into_iter().enumerate() {
        let mut shapes = random_shapes(&mut random, frame, count);
        if round % 2 == 1 {
            shapes.extend(half_spaces(&mut random, frame, count + 1));
        }
        let snapshot = world_of(shapes.clone()).newest();
        for _ in 0..60 {
            let filter = if random.unit() < 0.5 { Filter::default() } else { random_filter(&mut random) };
            let mut brute = Brute { shapes: &shapes, filter: &filter, frame, work: Work::default() };
            asked += 1;
            for (kind, question) in random_questions(&mut random, frame, count).iter().enumerate() {
                hits[kind] += usize::from(compare(&snapshot, &mut brute, question) == Verdict::Hit);
            }
        }
    }
    assert!(hits.iter().all(|&hits| hits * 10 > asked * 2 && hits < asked), "vacuous: {hits:?} of {asked}");
}

#[test]
fn questions_answer_what_the_kernel_on_every_shape_answers() {
    compare_in(Frame::UNIT);
}

#[test]
fn so_they_do_among_small_shapes_far_out() {
    compare_in(Frame { scale: 1e-4, origin: DVec3::new(1e3, 5e3, -2e3) });
}

#[test]
fn so_they_do_among_large_shapes_at_the_end_of_the_world() {
    compare_in(Frame { scale: 1e6, origin: DVec3::new(9e11, -9e11, 5e11) });
}

#[test]
fn a_shape_that_is_not_there_is_named() {
    let ball = Arc::new(Geometry::sphere(1.0).expect("a sphere"));
    let snapshot = world_of([shape(1, ball, Pose::IDENTITY)]).newest();
    let (gone, there) = (Subject::Shape { id: id(77), pose: None }, Subject::Shape { id: id(1), pose: None });
    let mut go_on = || true;
    let meter = &mut Meter::new(&mut go_on);
    let mut ask = |subject: &Subject, against: &Subject| {
        let question = Overlap { subject: subject.clone(), against: Some(against.clone()), max_hits: 9 };
        snapshot.overlap(&question, &Filter::default(), &ACCURACY, meter).map(|found| found.verdict)
    };
    let plane = Arc::new(Geometry::half_space(DVec3::Y, -2.0).expect("a half space"));
    let plane = Subject::Geometry { geometry: plane, pose: Pose::IDENTITY };
    assert_eq!(ask(&plane, &there), Err(QuestionError::SubjectUnbounded(None)));
    assert_eq!(ask(&there, &plane), Ok(Verdict::Miss));
    assert_eq!(ask(&gone, &there), Err(QuestionError::SubjectNotFound(id(77))));
    assert_eq!(ask(&there, &gone), Err(QuestionError::AgainstNotFound(id(77))));
    assert_eq!(ask(&there, &there), Ok(Verdict::Hit), "a pair that is named is asked, be it a shape and itself");
}

/// A ray against one shape is what the ray says of it in a world of that shape alone.
#[test]
fn a_ray_against_one_is_a_ray_in_a_world_of_that_one() {
    let mut random = Random::new(12);
    let (mut hits, mut asked) = (0, 0);
    for _ in 0..20 {
        let shapes = random_shapes(&mut random, Frame::UNIT, 12);
        let world = world_of(shapes.clone()).newest();
        for one in shapes {
            let against = Subject::Shape { id: one.id, pose: None };
            let origin = random.vector() * 8.0;
            let towards = one.pose.position + random.vector() * 1.2 - origin;
            let question = Raycast { ray: ray(origin, towards), mode: HitMode::Closest };
            let mut go_on = || true;
            let meter = &mut Meter::new(&mut go_on);
            let found = world.raycast_against(&question, &against, &ACCURACY, meter).expect("an answer");
            let alone = world_of([one]).newest().raycast(&question, &Filter::default(), &ACCURACY, meter);
            assert_eq!(format!("{found:?}"), format!("{:?}", alone.expect("an answer")));
            asked += 1;
            hits += usize::from(found.verdict == Verdict::Hit);
        }
    }
    assert!(hits * 10 > asked * 3 && hits * 10 < asked * 9, "vacuous: {hits} of {asked}");
}
