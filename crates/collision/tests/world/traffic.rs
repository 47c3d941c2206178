//! Bullets among others that move in the same tick: the report is that of asking each pair by itself.

use std::sync::Arc;

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Pose,
    narrow::{self, ImpactTouch, Motion, Placed},
    shape::{Form, Geometry},
    world::{Edit, Mobility, Shape, ShapeId, SweepHit, Swept, World},
};

use crate::bullets::{ball, bullet, teleport, tick, to};
use crate::random::Random;
use crate::scene::{Frame, half_spaces, id, random_geometry, random_pose, random_shapes, shape, world_of};

/// The hits of a bullet: the other, the fraction, its bounds and the verdict.
fn hits_of(swept: &Swept, number: u64) -> Vec<&SweepHit> {
    swept.hits.iter().filter(|hit| hit.bullet == id(number)).collect()
}

#[test]
fn two_that_cross_report_each_other_at_the_same_time() {
    let mut random = Random::new(71);
    for _ in 0..200 {
        // All numbers are eighths, so that the truth is off by one rounding at most.
        let mut eighths = |most: u64| (1 + random.bits() % most) as f64 / 8.0;
        let (radius_a, radius_b, gap) = (eighths(8), eighths(8), eighths(64));
        let (way_a, way_b) = (eighths(64) + gap, eighths(64));
        let start = gap + radius_a + radius_b;
        let mut world = world_of([bullet(ball(1, radius_a, DVec3::ZERO)), bullet(ball(2, radius_b, DVec3::Z * start))]);
        let moves = vec![to(2, Pose::at(DVec3::Z * (start - way_b))), to(1, Pose::at(DVec3::Z * way_a))];
        let swept = tick(&mut world, moves);
        let truth = gap / (way_a + way_b);
        let [a, b] = [1, 2].map(|number| &hits_of(&swept, number)[0].impact);
        assert_eq!((swept.hits.len(), a.id, b.id), (2, Some(id(2)), Some(id(1))));
        let (a, b) = (&a.touch, &b.touch);
        assert_eq!((a.fraction, a.certificate, a.initial), (b.fraction, b.certificate, b.initial));
        assert_eq!((a.normal_b_to_a, b.normal_b_to_a), (Some(-DVec3::Z), Some(DVec3::Z)));
        assert_eq!(a.certificate.verdict, Verdict::Hit);
        let bound = a.certificate.bound;
        assert!(bound.lower <= truth.next_up() && truth.next_down() <= bound.upper, "{truth} in {bound:?}");
    }
}

/// How each shape is at the start of a tick, how it moves, and whether it is asked about.
struct Actor {
    shape: Shape,
    displacement: DVec3,
    rotation: DVec3,
    is_swept: bool,
}

/// Random edits of a tick, and what each shape of the new version does in it.
fn random_tick(world: &World, random: &mut Random) -> (Vec<Edit>, Vec<Actor>) {
    let (mut edits, mut actors) = (Vec::new(), Vec::new());
    for shape in world.newest().shapes_after(None, 1000, None) {
        let mut actor =
            Actor { shape: shape.clone(), displacement: DVec3::ZERO, rotation: DVec3::ZERO, is_swept: false };
        let number = shape.id.get();
        let mut end = random_pose(random, Frame::UNIT, 4.0);
        if random.unit() < 0.5 {
            end.rotation = -shape.pose.rotation;
        }
        match random.bits() % 10 {
            0..6 => {
                edits.push(to(number, end));
                actor.displacement = end.position - shape.pose.position;
                actor.rotation = shape.pose.rotation_vector_to(&end);
                actor.is_swept = shape.bullet;
            }
            6 => {
                edits.push(teleport(number, end.position));
                actor.shape.pose.position = end.position;
            }
            7 => {
                actor.shape.geometry = random_geometry(random, Frame::UNIT);
                actor.shape.pose = end;
                edits.push(Edit::Insert(actor.shape.clone()));
            }
            8 if random.unit() < 0.2 => {
                edits.push(Edit::Remove(shape.id));
                continue;
            }
            _ => {}
        }
        actors.push(actor);
    }
    (edits, actors)
}

fn touch_of(a: &Actor, b: &Actor) -> Option<ImpactTouch> {
    let [placed_a, placed_b] = [a, b].map(|it| Placed { geometry: &it.shape.geometry, pose: it.shape.pose });
    let motion = Motion {
        displacement_a: a.displacement,
        displacement_b: b.displacement,
        rotation_a: a.rotation,
        rotation_b: b.rotation,
        ..Motion::default()
    };
    narrow::impact(placed_a, placed_b, &motion, &Accuracy::default(), &mut Work::default())
}

fn are_a_pair(a: &Shape, b: &Shape) -> bool {
    let one_wants = |a: &Shape, b: &Shape| a.collides_with & b.layers != 0;
    let stand = a.mobility == Mobility::Static && b.mobility == Mobility::Static;
    a.id != b.id && one_wants(a, b) && one_wants(b, a) && (a.group == 0 || a.group != b.group) && !stand
}

/// The report on one bullet is what the kernels find for each pair; lower bounds may be raised by what boxes prove.
fn check(hits: &[&SweepHit], bullet: &Actor, actors: &[Actor]) -> usize {
    let others = actors.iter().filter(|other| are_a_pair(&bullet.shape, &other.shape));
    let mut expected: Vec<(ShapeId, ImpactTouch)> =
        others.filter_map(|other| Some((other.shape.id, touch_of(bullet, other)?))).collect();
    assert!(hits.is_sorted_by_key(|hit| (hit.impact.touch.fraction, hit.impact.id)));
    assert_eq!(hits.len(), expected.len());
    for hit in hits {
        let at = expected.iter().position(|(id, _)| Some(*id) == hit.impact.id).expect("a pair that touches, once");
        let (_, kernel) = expected.swap_remove(at);
        let (found, asked) = (hit.impact.touch.certificate, kernel.certificate);
        assert_eq!((found.verdict, found.bound.upper), (asked.verdict, asked.bound.upper.max(found.bound.lower)));
        assert!(found.bound.lower >= asked.bound.lower && hit.impact.touch.fraction >= kernel.fraction);
        assert!(hit.impact.touch.fraction <= kernel.fraction.max(found.bound.lower));
        assert_eq!(hit.impact.touch.normal_b_to_a, kernel.normal_b_to_a);
    }
    hits.len()
}

#[test]
fn every_pair_is_what_it_is_by_itself_in_any_order_of_edits() {
    let mut random = Random::new(72);
    let (mut bullet_count, mut hit_count) = (0, 0);
    // With few bullets, and with so many that their ways get a tree.
    for share in [0.1, 0.2, 1.0] {
        let mut shapes = random_shapes(&mut random, Frame::UNIT, 120);
        for shape in &mut shapes {
            shape.bullet = random.unit() < share;
            shape.pose.position *= 2.0;
        }
        shapes.extend(half_spaces(&mut random, Frame::UNIT, 201));
        for _ in 0..3 {
            let mut world = world_of(shapes.clone());
            let (edits, actors) = random_tick(&world, &mut random);
            let mut shuffled = edits.clone();
            for last in (1..shuffled.len()).rev() {
                shuffled.swap(last, (random.bits() % (last as u64 + 1)) as usize);
            }
            let swept = tick(&mut world, edits);
            let again = tick(&mut world_of(shapes.iter().rev().cloned()), shuffled);
            assert_eq!(format!("{:?}", swept.hits), format!("{:?}", again.hits));
            assert!(!swept.truncated && swept.hits.is_sorted_by_key(|hit| hit.bullet));
            for bullet in &actors {
                let hits = hits_of(&swept, bullet.shape.id.get());
                assert!(bullet.is_swept || hits.is_empty());
                if bullet.is_swept {
                    bullet_count += 1;
                    hit_count += check(&hits, bullet, &actors);
                }
            }
        }
    }
    assert!(bullet_count > 200 && hit_count > 2 * bullet_count, "vacuous: {hit_count} of {bullet_count}");
}

#[test]
fn what_moves_away_in_time_is_not_touched_and_what_comes_is() {
    // A bullet along x, and balls that cross its way before it comes, with it, and after.
    let across = |number: u64, x: f64| ball(number, 0.5, DVec3::new(x, 0.0, -8.0));
    let mut world = world_of([
        bullet(ball(1, 0.5, DVec3::X * -8.0)),
        across(2, -6.0),
        across(3, 0.0),
        across(4, 6.0),
        ball(5, 0.5, DVec3::X * 4.0),
    ]);
    let mut edits: Vec<Edit> =
        [(2, -6.0), (3, 0.0), (4, 6.0)].map(|(number, x)| to(number, Pose::at(DVec3::new(x, 0.0, 8.0)))).to_vec();
    edits.push(to(1, Pose::at(DVec3::X * 8.0)));
    // It stood in the way, but the bullet is through there before it is gone: it was put elsewhere, and stands there.
    edits.push(teleport(5, DVec3::X * -40.0));
    let swept = tick(&mut world, edits);
    let [hit] = &hits_of(&swept, 1)[..] else { panic!("{swept:?}") };
    assert_eq!(hit.impact.id, Some(id(3)));
    // Both come to the middle at half time, each with 16 m a tick at right angles.
    let truth = 0.5 - 1.0 / 16.0 / 2.0_f64.sqrt();
    assert!((hit.impact.touch.fraction - truth).abs() < 1e-14, "{hit:?}");
}

#[test]
fn a_floor_that_rises_is_a_bullet_too() {
    let [floor, ..] = half_spaces(&mut Random::new(1), Frame::UNIT, 1);
    let floor = Shape { mobility: Mobility::Kinematic, ..bullet(floor) };
    let mut world = world_of([floor, ball(9, 0.5, DVec3::ZERO), bullet(ball(10, 0.5, DVec3::Y * 3.0))]);
    // From −3.5 m to 0.5 m, while one ball stands and the other falls from 3 m to −1 m.
    let swept = tick(&mut world, vec![to(1, Pose::at(DVec3::Y * 4.0)), to(10, Pose::at(-DVec3::Y))]);
    let found = |number| -> Vec<_> {
        hits_of(&swept, number).iter().map(|hit| (hit.impact.id, hit.impact.touch.fraction)).collect()
    };
    assert_eq!(found(1), [(Some(id(9)), 0.75), (Some(id(10)), 0.75)]);
    assert_eq!(found(10), [(Some(id(9)), 0.5), (Some(id(1)), 0.75)]);
}

#[test]
fn turns_of_both_are_swept() {
    let mut random = Random::new(73);
    let stick = |number, pose| shape(number, Arc::new(Geometry::capsule(1.0, 0.05).expect("a stick")), pose);
    // Two sticks side by side that turn towards each other about z: their tips meet in the middle, at the same angle.
    let apart = 1.2;
    let mut world = world_of([bullet(stick(1, Pose::IDENTITY)), bullet(stick(2, Pose::at(DVec3::X * apart)))]);
    let turned = |angle: f64| DQuat::from_xyzw(0.0, 0.0, (0.5 * angle).sin(), (0.5 * angle).cos());
    let swept = tick(
        &mut world,
        vec![to(1, Pose::new(DVec3::ZERO, turned(-1.0))), to(2, Pose::new(DVec3::X * apart, turned(1.0)))],
    );
    let [a, b] = [1, 2].map(|number| &hits_of(&swept, number)[0].impact.touch);
    let truth = ((0.5 * apart - 0.05) / 1.0_f64).asin();
    assert!((a.fraction - truth).abs() < 1e-5, "{a:?}, {truth}");
    assert!(a.certificate.bound.lower <= truth + 1e-15 && truth - 1e-15 <= a.certificate.bound.upper);
    assert_eq!((a.fraction, a.certificate), (b.fraction, b.certificate));
    // Of turns at random, roles may be swapped too.
    let mut pair_count = 0;
    for _ in 0..100 {
        let shapes = [1, 2].map(|number| {
            bullet(shape(number, random_geometry(&mut random, Frame::UNIT), random_pose(&mut random, Frame::UNIT, 2.0)))
        });
        // Which of the triangles that two meshes touch with at once gives the place is not the same both ways.
        let are_meshes = shapes.iter().all(|shape| matches!(shape.geometry.form(), Form::Mesh(_)));
        let ends = [1, 2].map(|number| to(number, random_pose(&mut random, Frame::UNIT, 2.0)));
        let swept = tick(&mut world_of(shapes), ends.to_vec());
        let [a, b] = [1, 2].map(|number| hits_of(&swept, number));
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            let (a, b) = (&a.impact.touch, &b.impact.touch);
            assert_eq!((a.fraction, a.certificate, a.initial), (b.fraction, b.certificate, b.initial));
            if !are_meshes {
                assert_eq!(a.point, b.point);
                assert_eq!(a.normal_b_to_a, b.normal_b_to_a.map(|normal| DVec3::ZERO - normal));
            }
            pair_count += 1;
        }
    }
    assert!((30..=70).contains(&pair_count), "vacuous: {pair_count}");
}
