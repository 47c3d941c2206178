//! Laws of contact response: what is kept, what bounces, what slides, and what is corrected.

use collision::{
    DQuat, DVec3,
    math::Pose,
    response::{Motion, PointImpulse, Touch, corrections, impulses},
};
use glam::DMat3;
use smallvec::smallvec;

#[path = "broad/random.rs"]
mod random;

use random::Random;

fn unit(vector: DVec3) -> DVec3 {
    vector / vector.length()
}

/// A body at random: turned, with a centre that is not its origin. Every third of them does not turn, now or ever.
fn body(random: &mut Random) -> Motion {
    let turn = random.vector();
    let pose = Pose::new(random.vector() * 2.0, DQuat::from_xyzw(turn.x, turn.y, turn.z, random.unit() + 0.1));
    let inertia = (!random.bits().is_multiple_of(3)).then(|| random.vector().abs() + 0.1);
    Motion {
        velocity: random.vector() * 3.0,
        angular_velocity: if inertia.is_some() { random.vector() * 2.0 } else { DVec3::ZERO },
        ..Motion::of_body(&pose, 0.1 + 5.0 * random.unit().abs(), random.vector() * 0.2, inertia)
    }
}

fn touch(random: &mut Random, a: usize, b: usize) -> Touch {
    Touch {
        a,
        b,
        normal: unit(random.vector() + DVec3::new(0.0, 0.01, 0.0)),
        depth: random.unit().abs() * 0.1,
        points: (0..1 + random.bits() % 4).map(|_| random.vector()).collect(),
        friction: random.unit().abs(),
        restitution: random.unit().abs(),
    }
}

/// A heap of bodies in contact.
fn heap(random: &mut Random) -> (Vec<Motion>, Vec<Touch>) {
    let motions: Vec<Motion> = (0..6).map(|_| body(random)).collect();
    let touches = (0..8).map(|index| touch(random, index % 6, (index * 2 + 1 + index / 6) % 6)).collect::<Vec<_>>();
    (motions, touches.into_iter().filter(|touch: &Touch| touch.a != touch.b).collect())
}

fn momentum(motions: &[Motion]) -> DVec3 {
    motions.iter().filter(|motion| motion.inverse_mass > 0.0).map(|motion| motion.velocity / motion.inverse_mass).sum()
}

/// About the world's origin, of bodies that turn freely.
fn angular_momentum(motions: &[Motion]) -> DVec3 {
    let of = |motion: &Motion| {
        let spin = motion.inverse_inertia.inverse() * motion.angular_velocity;
        motion.center.cross(motion.velocity / motion.inverse_mass) + spin
    };
    motions.iter().map(of).sum()
}

fn energy(motions: &[Motion]) -> f64 {
    let of = |motion: &Motion| {
        let spin = match motion.inverse_inertia == DMat3::ZERO {
            true => 0.0,
            false => motion.angular_velocity.dot(motion.inverse_inertia.inverse() * motion.angular_velocity),
        };
        0.5 * (motion.velocity.length_squared() / motion.inverse_mass + spin)
    };
    motions.iter().filter(|motion| motion.inverse_mass > 0.0).map(of).sum()
}

#[test]
fn momentum_is_kept_and_friction_stays_in_its_cone() {
    let mut random = Random::new(1);
    let (mut pushed, mut slid, mut stuck) = (0, 0, 0);
    for _ in 0..300 {
        let (mut motions, touches) = heap(&mut random);
        let before = momentum(&motions);
        let found = impulses(&mut motions, &touches, 8);
        assert!((momentum(&motions) - before).length() < 1e-10);
        assert_eq!(found.len(), touches.iter().map(|touch| touch.points.len()).sum::<usize>());
        for impulse in found {
            let PointImpulse { touch, normal_impulse, friction_impulse, .. } = impulse;
            let touch = &touches[touch];
            let most = touch.friction * normal_impulse;
            assert!(normal_impulse >= 0.0 && friction_impulse.length() <= most * (1.0 + 1e-12), "{impulse:?}");
            assert!(friction_impulse.dot(touch.normal).abs() < 1e-12, "{impulse:?}");
            pushed += usize::from(normal_impulse > 0.0);
            let slides = friction_impulse.length() > most * (1.0 - 1e-9);
            slid += usize::from(normal_impulse > 0.0 && slides);
            stuck += usize::from(normal_impulse > 0.0 && !slides);
        }
    }
    assert!(pushed > 500 && slid > 100 && stuck > 100, "{pushed} {slid} {stuck}");
}

#[test]
fn angular_momentum_is_kept_by_bodies_that_turn() {
    let mut random = Random::new(2);
    for _ in 0..200 {
        let (mut motions, touches) = heap(&mut random);
        for motion in &mut motions {
            if motion.inverse_inertia == DMat3::ZERO {
                motion.inverse_inertia = DMat3::from_diagonal(random.vector().abs() + 0.2);
            }
        }
        let before = angular_momentum(&motions);
        let _ = impulses(&mut motions, &touches, 8);
        assert!((angular_momentum(&motions) - before).length() < 1e-9 * (1.0 + before.length()));
    }
}

/// Two bodies that touch in one point come apart as fast as their restitution says, and on ice they gain no energy. (With
/// friction, Newton's restitution may add some: Kane and Levinson, "Dynamics" (1985), section 5.8.)
#[test]
fn a_single_point_bounces_by_its_restitution_and_loses_the_rest() {
    let mut random = Random::new(3);
    let mut met = 0;
    for _ in 0..500 {
        let mut motions = vec![body(&mut random), body(&mut random)];
        let point = random.vector();
        let mut single = Touch { points: smallvec![point], ..touch(&mut random, 0, 1) };
        let is_ice = random.bits().is_multiple_of(2);
        if is_ice {
            single.friction = 0.0;
        }
        let speed = |motions: &[Motion]| {
            let at = |motion: &Motion| motion.velocity + motion.angular_velocity.cross(point - motion.center);
            (at(&motions[0]) - at(&motions[1])).dot(single.normal)
        };
        let (before, energy_before) = (speed(&motions), energy(&motions));
        // Friction and normal push each other about: passes settle that.
        let found = impulses(&mut motions, std::slice::from_ref(&single), 200);
        assert!(!is_ice || energy(&motions) <= energy_before * (1.0 + 1e-9), "{single:?}");
        if before >= 0.0 {
            assert_eq!(found[0].normal_impulse, 0.0);
            continue;
        }
        met += 1;
        let wanted = -single.restitution * before;
        assert!((speed(&motions) - wanted).abs() < 1e-6 * (1.0 - before), "{} is not {wanted}", speed(&motions));
    }
    assert!((150..350).contains(&met), "{met}");
}

#[test]
fn equal_balls_swap_their_speeds_and_a_wall_gives_a_ball_its_speed_back() {
    let ball = |x: f64, speed: f64| Motion {
        velocity: DVec3::X * speed,
        ..Motion::of_body(&Pose::at(DVec3::X * x), 2.0, DVec3::ZERO, Some(DVec3::ONE))
    };
    let touch = |restitution| Touch {
        a: 0,
        b: 1,
        normal: DVec3::X,
        depth: 0.0,
        points: smallvec![DVec3::ZERO],
        friction: 0.0,
        restitution,
    };
    let mut motions = vec![ball(1.0, -3.0), ball(-1.0, 1.0)];
    let found = impulses(&mut motions, &[touch(1.0)], 1);
    assert_eq!((motions[0].velocity.x, motions[1].velocity.x), (1.0, -3.0));
    assert_eq!(found[0].normal_impulse, 8.0);
    let mut motions = vec![ball(1.0, -3.0), Motion::unmoved(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO)];
    let _ = impulses(&mut motions, &[touch(0.5)], 1);
    assert_eq!((motions[0].velocity.x, motions[1].velocity.x), (1.5, 0.0));
    // A platform that rises takes along what rests on it.
    let mut motions = vec![ball(1.0, 0.0), Motion::unmoved(DVec3::ZERO, DVec3::X * 2.0, DVec3::ZERO)];
    let _ = impulses(&mut motions, &[touch(0.0)], 1);
    assert_eq!(motions[0].velocity, DVec3::X * 2.0);
}

/// A block that slides on a floor is slowed by friction times the impulse that bears it, and no faster than to a stop.
#[test]
fn a_block_is_slowed_by_its_friction() {
    let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let floor = |friction| Touch {
        a: 0,
        b: 1,
        normal: DVec3::Y,
        depth: 0.0,
        points: corners.iter().map(|(x, z)| DVec3::new(*x, 0.0, *z)).collect(),
        friction,
        restitution: 0.0,
    };
    for (friction, after) in [(0.0, 5.0), (0.25, 4.5), (10.0, 0.0)] {
        let block = Motion::of_body(&Pose::at(DVec3::Y * 0.01), 4.0, DVec3::ZERO, None);
        let mut motions = vec![
            Motion { velocity: DVec3::new(5.0, -2.0, 0.0), ..block },
            Motion::unmoved(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO),
        ];
        let _ = impulses(&mut motions, &[floor(friction)], 50);
        assert!((motions[0].velocity - DVec3::X * after).length() < 1e-9, "{friction}: {}", motions[0].velocity);
    }
}

#[test]
fn swapping_the_sides_of_a_touch_swaps_nothing_else() {
    let mut random = Random::new(5);
    for _ in 0..100 {
        let mut motions = vec![body(&mut random), body(&mut random)];
        let one = touch(&mut random, 0, 1);
        let other = Touch { a: 1, b: 0, normal: -one.normal, ..one.clone() };
        let mut swapped = motions.clone();
        let _ = impulses(&mut motions, &[one], 8);
        let _ = impulses(&mut swapped, &[other], 8);
        for (a, b) in motions.iter().zip(&swapped) {
            assert!(
                (a.velocity - b.velocity).length() < 1e-9 && (a.angular_velocity - b.angular_velocity).length() < 1e-9
            );
        }
    }
}

#[test]
fn corrections_part_what_is_too_deep_and_move_the_light_one_more() {
    let motion = |mass: f64| Motion::of_body(&Pose::IDENTITY, mass, DVec3::ZERO, None);
    let touch = |a, b, depth| Touch {
        a,
        b,
        normal: DVec3::Y,
        depth,
        points: smallvec![DVec3::ZERO],
        friction: 0.0,
        restitution: 0.0,
    };
    let pair = corrections(&[motion(1.0), motion(3.0)], &[touch(0, 1, 0.5)], 0.1, 0.5, 4);
    assert!((pair[0] - DVec3::Y * 0.15).length() < 1e-15 && (pair[1] + DVec3::Y * 0.05).length() < 1e-15, "{pair:?}");
    // A stack on a floor: passes settle it, and the floor stays.
    let floor = Motion::unmoved(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
    let stack = [motion(1.0), motion(1.0), floor];
    let moved = corrections(&stack, &[touch(0, 1, 0.2), touch(1, 2, 0.1)], 0.0, 1.0, 64);
    assert!((moved[0].y - 0.3).abs() < 1e-6 && (moved[1].y - 0.1).abs() < 1e-6, "{moved:?}");
    assert_eq!(moved[2], DVec3::ZERO);
    // What is not too deep is left alone.
    assert_eq!(corrections(&[motion(1.0), floor], &[touch(0, 1, 0.05)], 0.1, 1.0, 4), [DVec3::ZERO; 2]);
}

/// What cannot be pushed is left alone, whatever meets it.
#[test]
fn two_that_cannot_be_pushed_get_no_impulse() {
    let wall = |speed| Motion::unmoved(DVec3::ZERO, DVec3::X * speed, DVec3::ZERO);
    let mut motions = vec![wall(-1.0), wall(1.0)];
    let touch = Touch {
        a: 0,
        b: 1,
        normal: DVec3::X,
        depth: 1.0,
        points: smallvec![DVec3::ZERO],
        friction: 1.0,
        restitution: 1.0,
    };
    let found = impulses(&mut motions, std::slice::from_ref(&touch), 8);
    assert_eq!((found[0].normal_impulse, motions[0].velocity.x, motions[1].velocity.x), (0.0, -1.0, 1.0));
    assert_eq!(corrections(&motions, &[touch], 0.0, 1.0, 8), [DVec3::ZERO; 2]);
}
