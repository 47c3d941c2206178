//! Laws of motions that turn: what the interval says is checked by asking the forms where they are at a time, and against
//! closed forms.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::random::{Body, Noise, pairs};
use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Stop, Verdict, Work},
    math::Pose,
    narrow::{self, ImpactTouch, InitialTouch, Motion},
    shape::Geometry,
};

pub(crate) const EXACT: Accuracy = Accuracy::of(Tier::Exact);

pub(crate) fn impact(a: &Body, b: &Body, motion: &Motion, accuracy: &Accuracy) -> Option<ImpactTouch> {
    narrow::impact(a.placed(), b.placed(), motion, accuracy, &mut Work::default())
}

/// Where a body is at a time.
pub(crate) fn moved(body: &Body, way: DVec3, turn: DVec3, time: f64) -> Body {
    let rotation = DQuat::from_scaled_axis(turn * time) * body.pose.unit_rotation();
    Body { geometry: body.geometry.clone(), pose: Pose::new(body.pose.position + way * time, rotation) }
}

/// Signed distance at a time: of cores that overlap, the depth.
fn signed(a: &Body, b: &Body, motion: &Motion, time: f64) -> f64 {
    let a = moved(a, motion.displacement_a, motion.rotation_a, time);
    let b = moved(b, motion.displacement_b, motion.rotation_b, time);
    let (a, b) = (a.placed(), b.placed());
    let contacts = narrow::penetration(a, b, f64::MAX, &EXACT, &mut Work::default()).expect("convex forms");
    -contacts[0].depth
}

/// Pairs with motions that bring about half of them together.
fn courses(seed: u64, count: usize) -> impl Iterator<Item = (Body, Body, Motion)> {
    let mut noise = Noise(seed);
    pairs(seed, count).map(move |[a, b]| {
        let b = b.moved(b.pose.position.normalize() * 1.5);
        let apart = b.pose.position - a.pose.position;
        let motion = Motion {
            displacement_a: apart * noise.between(0.0, 1.0) + noise.vector(),
            displacement_b: noise.vector(),
            rotation_a: noise.vector() * 2.0,
            rotation_b: if noise.signed() < 0.0 { noise.vector() * 4.0 } else { DVec3::ZERO },
            ..Motion::default()
        };
        (a, b, motion)
    })
}

fn ball(radius: f64, position: DVec3) -> Body {
    Body { geometry: Geometry::sphere(radius).expect("a size"), pose: Pose::at(position) }
}

fn stick(half_length: f64) -> Body {
    Body { geometry: Geometry::capsule(half_length, 0.0).expect("a size"), pose: Pose::IDENTITY }
}

#[test]
fn the_way_is_free_before_and_closed_after() {
    let asked = [EXACT, Accuracy { max_error: 5e-3, ..EXACT }, Accuracy { max_error_relative: 1e-3, ..EXACT }];
    let mut hits = 0;
    for (round, (a, b, motion)) in courses(21, 1500).enumerate() {
        let accuracy = &asked[round % asked.len()];
        let Some(touch) = impact(&a, &b, &motion, accuracy) else {
            for step in 0..=40 {
                assert!(signed(&a, &b, &motion, f64::from(step) / 40.0) > -1e-13, "round {round}");
            }
            continue;
        };
        hits += 1;
        let bound = touch.certificate.bound;
        assert_eq!(touch.certificate.verdict, Verdict::Hit, "round {round}: {touch:?}");
        assert!(bound.contains(touch.fraction), "round {round}: {touch:?}");
        assert!(signed(&a, &b, &motion, bound.upper) < 1e-13, "round {round}: {touch:?}");
        for step in 0..=40 {
            let time = bound.lower * f64::from(step) / 40.0;
            assert!(touch.initial || signed(&a, &b, &motion, time) > -1e-13, "round {round}: {touch:?} at {time}");
        }
        // The fastest point is at least that fast.
        let speed = (motion.displacement_a - motion.displacement_b).length();
        let widest = accuracy.max_error.max(accuracy.max_error_relative * touch.fraction * speed).max(1e-8);
        assert!(bound.width() * speed <= widest, "round {round}: {touch:?} is {} wide", bound.width() * speed);
    }
    assert!((500..1000).contains(&hits), "{hits} of 1500");
}

#[test]
fn a_stick_meets_a_ball_at_the_angle_that_geometry_says() {
    let mut noise = Noise(22);
    for round in 0..200 {
        let (distance, radius) = (noise.between(0.3, 1.1), noise.between(0.01, 0.25));
        if distance - radius > 1.0 {
            continue;
        }
        let place = noise.between(1.1, 2.1);
        let ball = ball(radius, DVec3::new(-place.sin(), place.cos(), 0.0) * distance);
        // The stick's side touches where the foot of the ball's centre lies within it, else its end does.
        let foot = (distance * distance - radius * radius).sqrt();
        let before = if foot <= 1.0 {
            (radius / distance).asin()
        } else {
            ((1.0 + distance * distance - radius * radius) / (2.0 * distance)).acos()
        };
        for turns in [0.0, 3.0, 50.0] {
            let angle = turns * TAU + 3.3;
            let motion = Motion { rotation_a: DVec3::Z * angle, ..Motion::default() };
            let touch = impact(&stick(1.0), &ball, &motion, &EXACT)
                .unwrap_or_else(|| panic!("{distance} {radius} {place} {turns}"));
            // Either end may come first: the other is half a turn behind.
            let truth = (place - before).rem_euclid(PI);
            assert_eq!(touch.certificate.verdict, Verdict::Hit, "round {round}");
            let off = touch.fraction * angle - truth;
            assert!(off.abs() < 2e-13 + 1e-15 * angle, "round {round}, {turns} turns: {off:e}");
            let bound = touch.certificate.bound;
            let slack = 4e-16;
            assert!(
                bound.lower * angle <= truth + slack && truth <= bound.upper * angle + slack,
                "round {round}: {bound:?} {truth}"
            );
        }
    }
}

#[test]
fn round_cores_turn_as_well() {
    let mut noise = Noise(29);
    let mut hits = 0;
    for (round, (_, b, motion)) in courses(30, 600).enumerate() {
        let mut size = || noise.between(0.5, 1.3);
        let form = match round % 3 {
            0 => Geometry::cylinder(size(), size()),
            1 => Geometry::cone(size(), size()),
            _ => Geometry::ellipsoid(DVec3::new(size(), size(), size())),
        };
        let a = Body { geometry: form.expect("sizes"), pose: Pose::new(DVec3::ZERO, noise.rotation()) };
        let Some(touch) = impact(&a, &b, &motion, &EXACT) else {
            for step in 0..=40 {
                assert!(signed(&a, &b, &motion, f64::from(step) / 40.0) > -1e-9, "round {round}");
            }
            continue;
        };
        hits += 1;
        let bound = touch.certificate.bound;
        assert_eq!(touch.certificate.verdict, Verdict::Hit, "round {round}: {touch:?}");
        assert!(signed(&a, &b, &motion, bound.upper) < 1e-13, "round {round}: {touch:?}");
        assert!(bound.width() < 1e-6, "round {round}: {touch:?}");
        for step in 0..=40 {
            let time = bound.lower * f64::from(step) / 40.0;
            assert!(touch.initial || signed(&a, &b, &motion, time) > -1e-9, "round {round}: {touch:?} at {time}");
        }
    }
    assert!((200..420).contains(&hits), "{hits} of 600");
}

#[test]
fn many_turns_end_where_they_should() {
    // Far out of reach of the spinning stick for all but the last part of the way.
    for turns in [1.0, 10.0, 50.0] {
        let ball = ball(0.25, DVec3::X * 9.0);
        let motion =
            Motion { displacement_b: DVec3::X * -9.0, rotation_a: DVec3::Z * TAU * turns, ..Motion::default() };
        let touch = impact(&stick(1.0), &ball, &motion, &EXACT).expect("they meet");
        assert_eq!(touch.certificate.verdict, Verdict::Hit);
        let bound = touch.certificate.bound;
        assert!(signed(&stick(1.0), &ball, &motion, bound.upper) < 1e-11);
        for step in 0..1000 {
            assert!(signed(&stick(1.0), &ball, &motion, bound.lower * f64::from(step) / 1000.0) > -1e-11);
        }
    }
}

#[test]
fn swapped_arguments_give_the_same_bytes() {
    for (a, b, motion) in courses(23, 600) {
        let back = Motion {
            displacement_a: motion.displacement_b,
            displacement_b: motion.displacement_a,
            rotation_a: motion.rotation_b,
            rotation_b: motion.rotation_a,
            ..motion
        };
        let (there, back) = (impact(&a, &b, &motion, &EXACT), impact(&b, &a, &back, &EXACT));
        assert_eq!(there.is_some(), back.is_some());
        if let (Some(there), Some(back)) = (there, back) {
            assert_eq!(there.certificate, back.certificate);
            assert_eq!((there.fraction, there.point), (back.fraction, back.point));
            assert_eq!(there.normal_b_to_a, back.normal_b_to_a.map(|normal| DVec3::ZERO - normal));
        }
    }
}

#[test]
fn powers_of_two_leave_the_fraction_as_it_is() {
    for scale in [2f64.powi(-20), 2f64.powi(20)] {
        for (a, b, motion) in courses(24, 300) {
            let scaled = |body: &Body| Body {
                geometry: body.geometry.clone().scaled(scale).expect("within limits"),
                pose: Pose::new(body.pose.position * scale, body.pose.rotation),
            };
            let large = Motion {
                displacement_a: motion.displacement_a * scale,
                displacement_b: motion.displacement_b * scale,
                ..motion
            };
            let touches = [impact(&a, &b, &motion, &EXACT), impact(&scaled(&a), &scaled(&b), &large, &EXACT)];
            let [small, large] = touches.map(|touch| touch.map(|touch| (touch.fraction, touch.certificate)));
            assert_eq!(small, large);
        }
    }
}

#[test]
fn what_turns_into_itself_moves_as_if_it_did_not_turn() {
    for (a, b, motion) in courses(25, 400) {
        let straight = Motion { rotation_a: DVec3::ZERO, rotation_b: DVec3::ZERO, ..motion };
        // A ball, whatever is sent: the same bytes.
        let ball = ball(0.5, a.pose.position);
        let spinning = Motion { rotation_a: motion.rotation_a * 100.0, ..straight };
        let [there, here] = [straight, spinning].map(|motion| impact(&ball, &b, &motion, &EXACT));
        assert_eq!(there.map(|touch| touch.certificate), here.map(|touch| touch.certificate));
        // A capsule about its own axis: the same truth.
        let capsule = Body { geometry: Geometry::capsule(0.5, 0.25).expect("sizes"), pose: Pose::at(a.pose.position) };
        let rolling = Motion { rotation_a: DVec3::Y * 5.0, ..straight };
        let [there, here] = [straight, rolling].map(|motion| impact(&capsule, &b, &motion, &EXACT));
        assert_eq!(there.is_some(), here.is_some());
        if let (Some(there), Some(here)) = (there, here) {
            let (there, here) = (there.certificate.bound, here.certificate.bound);
            assert!(there.lower <= here.upper && here.lower <= there.upper, "{there:?} {here:?}");
        }
    }
}

#[test]
fn a_graze_is_never_wrong_and_a_later_touch_is_found() {
    let mut noise = Noise(26);
    for round in 0..300 {
        // The tip of the stick passes the ball at a depth of a few roundings, or at none; a wall waits behind.
        let excess = f64::from(round % 7 - 3) * 1e-15;
        let place = noise.between(0.5, 1.5);
        let ball = ball(0.25, DVec3::new(-place.sin(), place.cos(), 0.0) * (1.25 + excess));
        let motion = Motion { rotation_a: DVec3::Z * 3.0, ..Motion::default() };
        if let Some(touch) = impact(&stick(1.0), &ball, &motion, &EXACT) {
            let bound = touch.certificate.bound;
            assert!(
                bound.lower * 3.0 <= place + 1e-12 && bound.upper * 3.0 >= place - 1e-12,
                "round {round}: {touch:?}"
            );
            assert!(bound.width() < 1e-5, "round {round}: {touch:?}");
        }
        // A hull of ball and wall: the graze, then the certain touch.
        let tip = DVec3::new(-place.sin(), place.cos(), 0.0) * (1.0 + excess);
        let hook = Geometry::hull(&[tip, tip * 3.0, DVec3::new(-3.0, -9.0, 0.5), DVec3::new(-3.0, -9.0, -0.5)]);
        let hook = Body { geometry: hook.expect("points"), pose: Pose::IDENTITY };
        let touch = impact(&stick(1.0), &hook, &motion, &EXACT);
        let bound = touch.map(|touch| touch.certificate.bound);
        assert!(bound.is_none_or(|bound| bound.lower * 3.0 <= place + 1e-6), "round {round}: {bound:?}");
    }
}

#[test]
fn a_spent_budget_leaves_the_answer_open() {
    let (mut open, mut rounds) = (0, 0);
    for (a, b, motion) in courses(27, 400) {
        for budget in [1, 4, 16] {
            let asked = impact(&a, &b, &motion, &Accuracy { budget, ..EXACT });
            let truth = impact(&a, &b, &motion, &EXACT);
            rounds += 1;
            let Some(touch) = asked else {
                assert!(truth.is_none());
                continue;
            };
            let bound = touch.certificate.bound;
            if let Some(truth) = truth {
                let truth = truth.certificate.bound;
                assert!(bound.lower <= truth.upper && truth.lower <= bound.upper, "{touch:?} {truth:?}");
            }
            if touch.certificate.verdict == Verdict::Undecided {
                assert_eq!((touch.certificate.stop, bound.upper), (Stop::Budget, 1.0));
                open += 1;
            }
        }
    }
    assert!(open > rounds / 4, "{open} of {rounds}");
}

#[test]
fn an_ignored_start_ends_where_the_forms_part_and_a_second_touch_counts() {
    // A stick lies on one ball, is turned away from it, and meets another half a turn later.
    let motion = Motion { rotation_a: DVec3::Z * 3.5, initial: InitialTouch::IsIgnored, ..Motion::default() };
    let long = Body { geometry: Geometry::cuboid(DVec3::new(0.05, 1.0, 0.05)).expect("sizes"), pose: Pose::IDENTITY };
    let near = ball(0.2, DVec3::Y * 0.8);
    let again = impact(&long, &near, &motion, &EXACT).expect("its other end comes round");
    assert_eq!((again.certificate.verdict, again.initial), (Verdict::Hit, false));
    // The far side of the box is 0.05 from its axis: it meets the ball's rim that much before half a turn.
    let before = (0.25f64 / 0.8).asin();
    assert!((again.fraction * 3.5 - (PI - before)).abs() < 1e-9, "{again:?}");
    let counted = Motion { initial: InitialTouch::Counts, ..motion };
    let counted = impact(&long, &near, &counted, &EXACT).expect("a touch");
    assert_eq!((counted.fraction, counted.initial, counted.certificate.verdict), (0.0, true, Verdict::Hit));
    let short = Motion { rotation_a: DVec3::Z * 0.1, ..motion };
    assert!(impact(&long, &near, &short, &EXACT).is_none(), "they never part");
    let parted = Motion { rotation_a: DVec3::Z * FRAC_PI_2, ..motion };
    assert!(impact(&long, &near, &parted, &EXACT).is_none(), "they part and do not meet again");
}

#[test]
fn extremes_give_numbers() {
    let mut noise = Noise(28);
    let mut decided = 0;
    for round in 0..600 {
        let scale = 10f64.powi(round % 13 - 6);
        let far = if round % 3 == 0 { noise.vector() * 1e9 } else { DVec3::ZERO };
        let mut body = |kind: usize| Body {
            geometry: noise.convex(kind).scaled(scale).expect("within limits"),
            pose: Pose::new(far + noise.vector() * 2.0 * scale, noise.rotation()),
        };
        let (a, b) = (body(round as usize), body(round as usize / 4));
        let fast = 10f64.powi(round % 5 - 2);
        let motion = Motion {
            displacement_a: noise.vector() * scale * fast,
            rotation_a: noise.vector() * fast,
            rotation_b: noise.vector() * 3.0,
            initial: if round % 2 == 0 { InitialTouch::Counts } else { InitialTouch::IsIgnored },
            ..Motion::default()
        };
        let Some(touch) = impact(&a, &b, &motion, &EXACT) else {
            decided += 1;
            continue;
        };
        let bound = touch.certificate.bound;
        assert!(bound.contains(touch.fraction) && bound.lower >= 0.0 && bound.upper <= 1.0, "round {round}: {touch:?}");
        assert!(touch.point.is_finite(), "round {round}: {touch:?}");
        assert!(touch.normal_b_to_a.is_none_or(|normal| (normal.length() - 1.0).abs() < 1e-15), "round {round}");
        decided += usize::from(touch.certificate.verdict == Verdict::Hit);
    }
    assert!(decided > 540, "{decided} of 600");
}

/// Who asks for hardly anything still has an interval behind which little can hide; and no narrower one is worked for.
#[test]
fn whatever_is_asked_an_interval_is_a_small_part_of_the_way() {
    let anything = Accuracy { max_error: 1e9, max_error_relative: 1.0, ..EXACT };
    let (mut soon, mut late) = (0.0_f64, 0.0_f64);
    for (a, b, motion) in courses(97, 3_000) {
        let Some(touch) = impact(&a, &b, &motion, &anything) else { continue };
        let bound = touch.certificate.bound;
        if touch.certificate.verdict != Verdict::Hit || touch.certificate.stop != Stop::Tolerance {
            continue;
        }
        let allowed = (1.0_f64 / 256.0).max(bound.lower / 64.0);
        assert!(bound.width() <= allowed, "{bound:?} is wider than {allowed}: {motion:?}");
        let share = bound.width() / allowed;
        if bound.lower < 0.25 { soon = soon.max(share) } else { late = late.max(share) }
    }
    assert!(soon > 0.75 && late > 0.75, "{soon} of what is allowed soon after the start, {late} later");
}
