//! Cylinders, cones, capsules and points about parallel axes: held against plane geometry and against hulls.

use crate::random::{Body, Noise};
use glam::DVec2;

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Certificate, Method, Verdict, Work},
    math::Pose,
    narrow::{self, Depth, Motion},
    shape::Geometry,
};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

fn depth(a: &Body, b: &Body) -> Depth {
    let depth = narrow::depth(a.placed(), b.placed(), 1e9, &EXACT, &mut Work::default());
    depth.expect("no limit")
}

fn overlap(a: &Body, b: &Body) -> Certificate {
    narrow::overlap(a.placed(), b.placed(), &EXACT, &mut Work::default())
}

fn cylinder(half_height: f64, radius: f64, pose: Pose) -> Body {
    Body { geometry: Geometry::cylinder(half_height, radius).expect("sizes"), pose }
}

fn cone(half_height: f64, radius: f64, pose: Pose) -> Body {
    Body { geometry: Geometry::cone(half_height, radius).expect("sizes"), pose }
}

fn ball(radius: f64, position: DVec3) -> Body {
    Body { geometry: Geometry::sphere(radius).expect("a size"), pose: Pose::at(position) }
}

/// Turned about y, and upside down for odd numbers: quaternions of whole numbers, so that the turn is exact.
fn upright(turn: u64) -> DQuat {
    let spins = [[0.0, 1.0], [3.0, 4.0], [-5.0, 12.0], [1.0, 0.0]];
    let [y, w] = spins[(turn / 2 % 4) as usize];
    let spin = DQuat::from_xyzw(0.0, y, 0.0, w);
    if turn.is_multiple_of(2) { spin } else { spin * DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0) }
}

/// The truth lies in the interval of the depth and in that of the overlap, to within `slack`, and both are narrow.
fn assert_signed(a: &Body, b: &Body, truth: f64, slack: f64) {
    let (found, verdict) = (depth(a, b), overlap(a, b));
    let Bound { lower, upper } = found.certificate.bound;
    assert!(lower - slack <= -truth && -truth <= upper + slack, "{truth:e} is not in {found:?}");
    assert!(upper - lower <= 1e-12 * (1.0 + truth.abs()), "{found:?}");
    assert!(verdict.bound.lower - slack <= truth && truth <= verdict.bound.upper + slack, "{truth:e}, {verdict:?}");
    if truth.abs() > 1e-11 {
        assert_eq!(verdict.verdict, if truth > 0.0 { Verdict::Miss } else { Verdict::Hit }, "{truth:e}, {verdict:?}");
    }
    let apart = (found.point_on_a - found.point_on_b).dot(found.normal_b_to_a);
    assert!((apart + found.depth).abs() <= slack + 1e-12, "points {apart:e} apart, depth {:e}", found.depth);
}

/// The signed distance of a point to a rectangle about the origin.
fn to_rectangle(half: DVec2, point: DVec2) -> f64 {
    let beyond = point.abs() - half;
    beyond.max(DVec2::ZERO).length() + beyond.max_element().min(0.0)
}

/// The signed distance of a point to the triangle of a cone's section.
fn to_triangle(half_height: f64, radius: f64, point: DVec2) -> f64 {
    let point = DVec2::new(point.x.abs(), point.y);
    let (apex, rim) = (DVec2::new(0.0, half_height), DVec2::new(radius, -half_height));
    let to_segment = |start: DVec2, end: DVec2| {
        let share = ((point - start).dot(end - start) / (end - start).length_squared()).clamp(0.0, 1.0);
        point.distance(start + (end - start) * share)
    };
    let boundary = to_segment(apex, rim).min(to_segment(rim, DVec2::new(0.0, -half_height)));
    let is_inside = point.y > -half_height && (rim - apex).perp_dot(point - apex) < 0.0;
    if is_inside { -boundary } else { boundary }
}

#[test]
fn points_and_balls_are_as_far_from_cylinders_and_cones_as_from_their_sections() {
    let mut noise = Noise(41);
    let mut hits = 0;
    for _ in 0..4000 {
        let (half_height, radius) = (noise.between(0.05, 1.0), noise.between(0.05, 1.0));
        let pose = Pose::new(noise.vector(), noise.rotation());
        let local = noise.vector() * DVec3::new(0.6, 0.8, 0.6);
        let place = pose.transform_point(local);
        let (other, rounding) = if noise.signed() < 0.0 {
            (Body { geometry: Geometry::point(), pose: Pose::at(place) }, 0.0)
        } else {
            (ball(0.1, place), 0.1)
        };
        let at = DVec2::new(local.x.hypot(local.z), local.y);
        let by_rectangle = to_rectangle(DVec2::new(radius, half_height), at) - rounding;
        assert_signed(&cylinder(half_height, radius, pose), &other, by_rectangle, 1e-14);
        assert_signed(&other, &cone(half_height, radius, pose), to_triangle(half_height, radius, at) - rounding, 1e-14);
        hits += usize::from(by_rectangle < 0.0);
    }
    assert!((1000..3000).contains(&hits), "{hits}");
}

#[test]
fn parallel_cylinders_are_as_far_apart_as_their_sections() {
    let mut noise = Noise(42);
    for round in 0..2000 {
        let [h, r, k, s] = [(); 4].map(|()| noise.between(0.05, 1.0));
        let way = noise.vector() * DVec3::new(1.0, 1.6, 1.0);
        let (a, b) = (cylinder(h, r, Pose::IDENTITY), cylinder(k, s, Pose::new(way, upright(round))));
        let truth = to_rectangle(DVec2::new(r + s, h + k), DVec2::new(way.x.hypot(way.z), way.y));
        assert_signed(&a, &b, truth, 1e-14);
        let capsule = Body { geometry: Geometry::capsule(k, s).expect("sizes"), ..b };
        let core = to_rectangle(DVec2::new(r, h + k), DVec2::new(way.x.hypot(way.z), way.y));
        assert_signed(&a, &capsule, core - s, 1e-14);
    }
}

/// A hull of points on the rims, and how far the form reaches beyond it.
fn inscribed(half_height: f64, top: f64, bottom: f64) -> (Geometry, f64) {
    const CORNERS: usize = 48;
    let ring = |radius: f64, y: f64| {
        (0..CORNERS).map(move |i| {
            let angle = std::f64::consts::TAU * i as f64 / CORNERS as f64;
            DVec3::new(radius * angle.cos(), y, radius * angle.sin())
        })
    };
    let points: Vec<DVec3> = ring(top, half_height).chain(ring(bottom, -half_height)).collect();
    let beyond = (1.0 - (std::f64::consts::PI / CORNERS as f64).cos()) * top.max(bottom);
    (Geometry::hull(&points).expect("points"), beyond)
}

#[test]
fn parallel_forms_are_nearer_than_hulls_in_them_by_no_more_than_what_those_leave_out() {
    let mut noise = Noise(43);
    let mut hits = 0;
    for round in 0..160 {
        let mut form = |kind: u64| {
            let (half_height, radius) = (noise.between(0.1, 1.0), noise.between(0.1, 1.0));
            match kind % 2 {
                0 => (Geometry::cone(half_height, radius), inscribed(half_height, 0.0, radius)),
                _ => (Geometry::cylinder(half_height, radius), inscribed(half_height, radius, radius)),
            }
        };
        let ((a, (hull_a, beyond_a)), (b, (hull_b, beyond_b))) = (form(round), form(round / 2));
        let pose_a = Pose::new(noise.vector(), DQuat::IDENTITY);
        let pose_b = Pose::new(pose_a.position + noise.vector() * 1.3, upright(round / 4));
        let (a, b) =
            (Body { geometry: a.expect("sizes"), pose: pose_a }, Body { geometry: b.expect("sizes"), pose: pose_b });
        let hulls = depth(&Body { geometry: hull_a, ..a.clone() }, &Body { geometry: hull_b, ..b.clone() });
        let found = depth(&a, &b);
        assert_eq!(found.certificate.method, Method::ClosedForm);
        let more = found.depth - hulls.depth;
        assert!((-1e-13..=beyond_a + beyond_b + 1e-13).contains(&more), "{found:?}, hulls {hulls:?}");
        hits += usize::from(found.depth > 0.0);
    }
    assert!((48..112).contains(&hits), "{hits}");
}

#[test]
fn forms_about_one_axis_have_their_full_depth() {
    for turn in 0..8 {
        let pose = Pose::new(DVec3::ZERO, upright(turn));
        assert_signed(&cylinder(1.0, 0.25, Pose::IDENTITY), &cylinder(2.0, 0.5, pose), -0.75, 1e-15);
        assert_signed(&cylinder(0.25, 1.0, Pose::IDENTITY), &cylinder(0.5, 2.0, pose), -0.75, 1e-15);
    }
    // Out of a cone sideways: its slant is 3 : 4, and the axis is 3 from it at the middle of the height.
    let wide = cone(4.0, 6.0, Pose::IDENTITY);
    assert_signed(&wide, &Body { geometry: Geometry::point(), pose: Pose::IDENTITY }, -2.4, 1e-14);
    // Upside down into a cylinder: its tip is 1 below the top, and up is the shortest way out.
    let tip = cone(4.0, 6.0, Pose::new(DVec3::Y * 7.0, upright(1)));
    assert_signed(&cylinder(4.0, 1.0, Pose::IDENTITY), &tip, -1.0, 1e-14);
}

#[test]
fn swapping_and_scaling_parallel_forms_swaps_and_scales_the_answer_bit_by_bit() {
    let mut noise = Noise(44);
    for round in 0..400 {
        let place = Pose::new(noise.vector(), upright(round));
        let sizes = [(); 4].map(|()| noise.between(0.1, 1.0));
        let (a, b) = (cylinder(sizes[0], sizes[1], Pose::IDENTITY), cone(sizes[2], sizes[3], place));
        let (there, back) = (depth(&a, &b), depth(&b, &a));
        assert_eq!((there.depth, there.certificate), (back.depth, back.certificate));
        assert_eq!((there.point_on_a, there.point_on_b), (back.point_on_b, back.point_on_a));
        assert_eq!(there.normal_b_to_a, DVec3::ZERO - back.normal_b_to_a);
        let scale = 2f64.powi(round as i32 % 41 - 20);
        let scaled = |body: &Body| Body {
            geometry: body.geometry.clone().scaled(scale).expect("within limits"),
            pose: Pose::new(body.pose.position * scale, body.pose.rotation),
        };
        let large = depth(&scaled(&a), &scaled(&b));
        assert_eq!((large.depth, large.point_on_a), (there.depth * scale, there.point_on_a * scale));
        assert_eq!(large.normal_b_to_a, there.normal_b_to_a);
    }
}

#[test]
fn a_lean_widens_the_depth_by_no_more_than_itself() {
    let mut noise = Noise(45);
    for round in 0..300 {
        let lean = 10f64.powi(-(round % 14) - 3);
        let half = noise.vector() * (0.5 * lean / 3.0);
        let turn = DQuat::from_xyzw(half.x, 0.0, half.z, 1.0);
        let (a, way) = (cylinder(0.5, 0.7, Pose::IDENTITY), noise.vector() * 0.3);
        let upright = depth(&a, &cone(0.6, 0.4, Pose::at(way)));
        let leaning = depth(&a, &cone(0.6, 0.4, Pose::new(way, turn)));
        let Bound { lower, upper } = leaning.certificate.bound;
        assert!(upper - lower <= 2.0 * lean + 2e-13, "lean {lean:e}: {leaning:?}");
        assert!((leaning.depth - upright.depth).abs() <= lean + 1e-13, "lean {lean:e}: {upright:?}, {leaning:?}");
    }
}

/// The nearest points that a formula knows are off by the lean: a proof of touch that took them for points of the forms claimed
/// some that there is not.
#[test]
fn a_touch_is_proved_of_no_rod_that_passes_the_rim_it_leans_beside() {
    let mut noise = Noise(46);
    let mut proved = 0;
    for round in 0..6_000_u32 {
        // The base rim reaches to 0.5 in the plane of the rod, which is there at x + half the lean.
        let half_lean = f64::from(round % 40 + 1) * if round % 2 == 0 { 5e-15 } else { -5e-15 };
        let gap = f64::from(round / 40 % 50) * 4e-15 - 1e-13;
        let turn = noise.rotation();
        let rim = if round % 3 == 0 { cylinder(0.5, 0.5, Pose::IDENTITY) } else { cone(0.5, 0.5, Pose::IDENTITY) };
        let place = turn.normalize() * DVec3::X * (0.5 + gap - half_lean);
        let rod = Geometry::capsule(1.0, 0.0).expect("sizes");
        let rod = Body { geometry: rod, pose: Pose::new(place, turn * DQuat::from_xyzw(0.0, 0.0, half_lean, 1.0)) };
        let rim = Body { pose: Pose::new(DVec3::ZERO, turn), ..rim };
        // A cylinder's other rim may reach farther.
        let gap = if round % 3 == 0 { gap.min(gap - 2.0 * half_lean) } else { gap };
        let touch = narrow::impact(rod.placed(), rim.placed(), &Motion::default(), &EXACT, &mut Work::default());
        let verdict = touch.map_or(Verdict::Miss, |touch| touch.certificate.verdict);
        let wrong = if gap > 0.0 { Verdict::Hit } else { Verdict::Miss };
        assert!(verdict != wrong || gap.abs() < 5e-15, "round {round}: {gap:e} apart, lean {half_lean:e}: {touch:?}");
        proved += u32::from(verdict != Verdict::Undecided);
    }
    assert!(proved > 1_000, "{proved}");
}

#[test]
fn a_cylinder_lands_on_a_cone_and_a_cone_on_its_tip_in_time() {
    let floor = cylinder(0.5, 4.0, Pose::IDENTITY);
    let fall = |body: &Body, truth: f64| {
        let motion = Motion { displacement_a: DVec3::Y * -4.0, ..Motion::default() };
        let touch = narrow::impact(body.placed(), floor.placed(), &motion, &EXACT, &mut Work::default());
        let touch = touch.expect("it lands");
        assert_eq!(touch.certificate.verdict, Verdict::Hit);
        assert!((touch.fraction - truth).abs() < 1e-13, "{touch:?}");
    };
    let place = DVec3::new(1.0, 3.0, -2.0);
    fall(&cylinder(0.5, 1.0, Pose::at(place)), 0.5);
    fall(&cone(0.5, 1.0, Pose::at(place)), 0.5);
    fall(&cone(0.5, 1.0, Pose::new(place, upright(3))), 0.5);
}
