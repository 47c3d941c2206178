//! Compounds in whole numbers: the truth is known exactly, however poses are put together.

use std::sync::Arc;

use collision::{
    DQuat, DVec3,
    answer::Verdict,
    math::Pose,
    narrow::{Faces, Motion, Ray, distance, impact, overlap, penetration, raycast},
    shape::{Geometry, Part},
};

use crate::{
    agree::{EXACT, at, work},
    whole::{Numbers, V3, to_f64, turned},
};

type Q = [i128; 4];

fn norm(q: Q) -> i128 {
    q.iter().map(|part| part * part).sum()
}

fn quat([x, y, z, w]: Q) -> DQuat {
    DQuat::from_xyzw(x as f64, y as f64, z as f64, w as f64)
}

fn plus(a: V3, b: V3) -> V3 {
    [0, 1, 2].map(|axis| a[axis] + b[axis])
}

fn times(a: V3, factor: i128) -> V3 {
    a.map(|part| part * factor)
}

/// A box that is part of a part of a compound, and a ball above a face of it at an exactly known height.
struct Scene {
    compound: Geometry,
    place: Pose,
    ball: Geometry,
    center: DVec3,
    /// Outward normal of the face, exactly, and its length.
    normal: V3,
    unit: i128,
    height: f64,
}

/// Not 0, so that it is a rotation.
fn rotation(numbers: &mut Numbers) -> Q {
    loop {
        let q = [0; 4].map(|_| numbers.within(2));
        if norm(q) > 0 {
            return q;
        }
    }
}

/// Three rotations inside each other; the box is a whole number times what makes all of its corners whole.
fn scene(numbers: &mut Numbers, round: usize) -> Scene {
    let [outer, middle, inner] = [0; 3].map(|_| rotation(numbers));
    let unit = norm(outer) * norm(middle) * norm(inner);
    let half = 10 * unit;
    let radius = (1 + numbers.below(10)) * unit;
    // In units of the length of the normal: touching exactly, just apart, just overlapping, and far from any doubt.
    let gap = [0, 1, -1, 100, -10][round % 5] * if round % 5 > 2 { unit } else { 1 };
    let gap = gap.max(-radius);
    let through = |v: V3| turned(outer, turned(middle, turned(inner, v)));
    let on_face = numbers.vector(9);
    let on_face = through([on_face[0], on_face[1], 10]);
    let normal = through([0, 0, 1]);
    // Parts may lie far from the middle of what they are in, and all of it far from the origin of the world.
    let offset = [1 << [4, 30][round / 5 % 2], 1 << [4, 30][round / 10 % 2], 1 << [4, 44][round / 20 % 2]];
    let offset = offset.map(|limit| numbers.vector(limit));
    let inner_at = times(offset[0], norm(outer) * norm(middle));
    let middle_at = times(offset[1], norm(outer));
    let box_at = plus(offset[2], plus(turned(outer, offset[1]), turned(outer, turned(middle, offset[0]))));
    // The normal has the length `unit`: whole multiples of its `unit`-th part along it are rounded to whole coordinates only if
    // they are multiples of the normal itself, so the small gaps are made by the radius of the ball.
    let center = plus(plus(box_at, on_face), times(normal, radius / unit + gap.div_euclid(unit)));
    let rest = gap.rem_euclid(unit);
    let cube = Arc::new(Geometry::cuboid(DVec3::splat(half as f64)).expect("a box"));
    let part = |geometry: Arc<Geometry>, at: V3, q: Q| Part { geometry, pose: Pose::new(to_f64(at), quat(q)) };
    let within = Geometry::compound(vec![part(cube, inner_at, inner)]).expect("within");
    let compound = Geometry::compound(vec![part(Arc::new(within), middle_at, middle)]).expect("a compound");
    Scene {
        compound,
        place: Pose::new(to_f64(offset[2]), quat(outer)),
        ball: Geometry::sphere((radius - rest) as f64).expect("a ball"),
        center: to_f64(center),
        normal,
        unit,
        height: gap as f64,
    }
}

#[test]
fn intervals_of_parts_of_parts_hold_the_exact_answer() {
    let mut numbers = Numbers::new(557);
    let (mut hits, mut misses, mut open) = (0, 0, 0);
    for round in 0..2_000 {
        let Scene { compound, place, ball, center, normal, unit, height } = scene(&mut numbers, round);
        let (whole, asker) = (at(&compound, place), at(&ball, Pose::at(center)));
        let context = || format!("round {round}: height {height}, {place:?}, {ball:?} at {center:?}");
        let verdict = overlap(asker, whole, &EXACT, &mut work()).verdict;
        match verdict {
            Verdict::Hit => hits += u32::from(height <= 0.0),
            Verdict::Miss => misses += u32::from(height > 0.0),
            Verdict::Undecided => open += 1,
        }
        assert!(verdict != Verdict::Hit || height <= 0.0, "{}", context());
        assert!(verdict != Verdict::Miss || height > 0.0, "{}", context());
        let found = distance(asker, whole, f64::INFINITY, &EXACT, &mut work()).expect("no limit");
        assert!(found.certificate.bound.contains(height.max(0.0)), "{found:?} {}", context());
        let contacts = penetration(asker, whole, 1e12, &EXACT, &mut work()).expect("convex parts");
        assert!(contacts[0].certificate.bound.contains(-height), "{contacts:?} {}", context());

        // A ray and the ball itself go at the face along its normal, twice as far as it is.
        let down = DVec3::ZERO - to_f64(normal);
        let radius = ball.reach();
        let ray = Ray {
            origin: center,
            direction: down,
            min_distance: 0.0,
            max_distance: 1e15,
            hollow: false,
            faces: Faces::Both,
        };
        let touch = raycast(&ray, whole, &EXACT, &mut work()).certain.unwrap_or_else(|| panic!("{}", context()));
        assert!(touch.certificate.bound.contains((height + radius).max(0.0)), "{touch:?} {}", context());
        if height > 0.0 {
            let times = 2 * (height as i128 / unit + 1);
            let motion = Motion { displacement_a: down * times as f64, ..Motion::default() };
            let touch = impact(asker, whole, &motion, &EXACT, &mut work()).unwrap_or_else(|| panic!("{}", context()));
            let fraction = height / (times * unit) as f64;
            assert!(touch.certificate.bound.lower <= fraction * (1.0 + 1e-15), "{touch:?} {fraction} {}", context());
            assert!(touch.certificate.bound.upper >= fraction * (1.0 - 1e-15), "{touch:?} {fraction} {}", context());
        }
    }
    assert!(hits > 600 && misses > 300 && open > 100, "{hits} hits, {misses} misses, {open} open");
}

/// A ball on an arm that turns about the origin of a compound: it comes down to a floor when its middle is as high as it is
/// wide, which a search through the motion finds as well.
#[test]
fn a_part_goes_round_with_the_whole() {
    let mut numbers = Numbers::new(563);
    let (mut touches, mut free) = (0, 0);
    for round in 0..400 {
        let radius = 0.05 + 0.2 * numbers.share().abs();
        let ball = Arc::new(Geometry::sphere(radius).expect("a ball"));
        let arm = numbers.shares() * 2.0;
        let inner = Geometry::compound(vec![Part { geometry: ball, pose: Pose::at(arm * 0.5) }]).expect("inner");
        let part = Part { geometry: Arc::new(inner), pose: Pose::at(arm * 0.5) };
        let club = Geometry::compound(vec![part]).expect("a compound");
        let start = Pose::new(numbers.shares() * 100.0, quat(rotation(&mut numbers)));
        let (turn, way) = (numbers.shares() * 4.0, numbers.shares() * 0.5);
        let floor = start.position.y - 1.0 - numbers.share();
        let height = |time: f64| {
            let turned = DQuat::from_scaled_axis(turn * time) * start.unit_rotation() * arm;
            (start.position + way * time + turned).y - radius - floor
        };
        if height(0.0) < 1e-9 {
            continue;
        }
        let steps = 4_096;
        let time = |step: usize| step as f64 / steps as f64;
        let first = (1..=steps).find(|&step| height(time(step)) < 0.0).map(|step| {
            let (mut before, mut after) = (time(step - 1), time(step));
            for _ in 0..60 {
                let middle = 0.5 * (before + after);
                if height(middle) < 0.0 { after = middle } else { before = middle }
            }
            before
        });
        let motion = Motion { displacement_a: way, rotation_a: turn, ..Motion::default() };
        let space = Geometry::half_space(DVec3::Y, 0.0).expect("a half space");
        let slab = Geometry::cuboid(DVec3::splat(20.0)).expect("a box");
        let space = at(&space, Pose::at(DVec3::Y * floor));
        let slab = at(&slab, Pose::at(DVec3::new(start.position.x, floor - 20.0, start.position.z)));
        for ground in [space, slab] {
            let found = impact(at(&club, start), ground, &motion, &EXACT, &mut work());
            match (first, found) {
                (Some(first), Some(touch)) => {
                    // Where it but grazes the floor, the time is known to the root of what the height is.
                    assert!((touch.fraction - first).abs() < 1e-6, "round {round}: {first} {touch:?}");
                    let bottom = touch.point.y - floor;
                    assert!(bottom.abs() < 1e-6, "round {round}: {bottom} {touch:?}");
                    touches += 1;
                }
                (None, None) => free += 1,
                (first, found) => {
                    let low = (0..=steps).map(|step| height(time(step))).fold(f64::INFINITY, f64::min);
                    assert!(low.abs() < 1e-6, "round {round}: {first:?} {found:?}, lowest {low}");
                }
            }
        }
    }
    assert!(touches > 150 && free > 100, "{touches} touches, {free} free");
}
