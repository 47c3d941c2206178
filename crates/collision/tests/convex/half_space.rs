//! Half spaces: exact heights, agreement with a huge box, symmetry, scale, exact touch, motions, pairs of them.

use crate::random::{Body, Noise};
use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::{Bound, Certificate, Verdict, Work},
    math::{Pose, expansion::Expansion},
    narrow::{self, Contact, ImpactTouch, InitialTouch, Motion, Separation},
    shape::Geometry,
};

fn body(geometry: Geometry, position: DVec3) -> Body {
    Body { geometry, pose: Pose::at(position) }
}

fn space(normal: DVec3, offset: f64) -> Geometry {
    Geometry::half_space(normal, offset).expect("a half space")
}

fn cuboid(x: f64, y: f64, z: f64) -> Geometry {
    Geometry::cuboid(DVec3::new(x, y, z)).expect("a size")
}

fn overlap(a: &Body, b: &Body) -> Certificate {
    narrow::overlap(a.placed(), b.placed(), &Accuracy::default(), &mut Work::default())
}

fn distance(a: &Body, b: &Body) -> Separation {
    narrow::distance(a.placed(), b.placed(), f64::INFINITY, &Accuracy::default(), &mut Work::default())
        .expect("no limit")
}

fn contacts(a: &Body, b: &Body, max_gap: f64) -> Vec<Contact> {
    let (a, b) = (a.placed(), b.placed());
    narrow::penetration(a, b, max_gap, &Accuracy::default(), &mut Work::default()).expect("no two meshes").into_vec()
}

fn impact(a: &Body, way_a: DVec3, b: &Body, way_b: DVec3, initial: InitialTouch) -> Option<ImpactTouch> {
    let motion = Motion { displacement_a: way_a, displacement_b: way_b, initial, ..Motion::default() };
    narrow::impact(a.placed(), b.placed(), &motion, &Accuracy::default(), &mut Work::default())
}

fn mesh_of_a_cube() -> Geometry {
    let corner = |bits: u8| DVec3::from_array([0, 1, 2].map(|axis| if bits >> axis & 1 == 0 { -1.0 } else { 1.0 }));
    let corners: Vec<DVec3> = (0..8).map(corner).collect();
    let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Geometry::mesh(&corners, &triangles).expect("a cube")
}

/// A whole vector turned by an integer quaternion, times the square of its length.
fn rotated([x, y, z, w]: [i64; 4], [a, b, c]: [i64; 3]) -> [i64; 3] {
    let (dot, s) = (x * a + y * b + z * c, w * w - x * x - y * y - z * z);
    let cross = [y * c - z * b, z * a - x * c, x * b - y * a];
    [
        s * a + 2 * dot * x + 2 * w * cross[0],
        s * b + 2 * dot * y + 2 * w * cross[1],
        s * c + 2 * dot * z + 2 * w * cross[2],
    ]
}

fn dot(a: [i64; 3], b: [i64; 3]) -> i128 {
    (0..3).map(|axis| i128::from(a[axis]) * i128::from(b[axis])).sum()
}

fn vector(a: [i64; 3]) -> DVec3 {
    DVec3::from_array(a.map(|value| value as f64))
}

/// The sign of `bound * denominator - numerator`, exactly.
fn excess(bound: f64, denominator: i128, numerator: i128) -> f64 {
    let mut exact = Expansion::default();
    exact.add_product(&Expansion::difference(bound, 0.0), &Expansion::difference(denominator as f64, 0.0));
    let high = numerator as f64;
    exact.add(-high);
    exact.add(-((numerator - high as i128) as f64));
    exact.estimate()
}

#[test]
fn intervals_hold_the_exact_height() {
    let normals: [([i64; 3], i64); 5] =
        [([1, 2, 2], 3), ([0, -3, 4], 5), ([2, 3, -6], 7), ([0, 1, 0], 1), ([-8, 1, 4], 9)];
    let mut noise = Noise(11);
    let mut within = |most: f64| (noise.signed() * most) as i64;
    let mut widest = 0.0f64;
    for round in 0..20_000 {
        let (normal, length) = normals[round % 5];
        let turn = |round: usize, q: [i64; 4]| if round == 0 || q == [0; 4] { [0, 0, 0, 1] } else { q };
        let q = turn(round / 5 % 3, [0; 4].map(|_| within(5.0)));
        let p = turn(round / 15 % 2, [0; 4].map(|_| within(5.0)));
        let far = if round % 2 == 0 { 1e9 } else { 20.0 };
        let (place, plane_place) = ([0; 3].map(|_| within(far)), [0; 3].map(|_| within(far)));
        let half = [0; 3].map(|_| within(8.0).abs() + 1);
        let offset = within(far);
        let form = Body {
            geometry: cuboid(half[0] as f64, half[1] as f64, half[2] as f64),
            pose: Pose::new(vector(place), DQuat::from_array(q.map(|c| c as f64))),
        };
        let plane = Body {
            geometry: space(vector(normal) * 0.125, offset as f64),
            pose: Pose::new(vector(plane_place), DQuat::from_array(p.map(|c| c as f64))),
        };
        let (norm_q, norm_p) = (dot4(q), dot4(p));
        let outward = rotated(p, normal);
        let apart = [0, 1, 2].map(|axis| place[axis] - plane_place[axis]);
        let corner = |bits: usize| [0, 1, 2].map(|axis| if bits >> axis & 1 == 0 { half[axis] } else { -half[axis] });
        let lowest = (0..8).map(|bits| dot(outward, rotated(q, corner(bits)))).min().expect("eight");
        let denominator = norm_p * norm_q * i128::from(length);
        let numerator = norm_q * dot(outward, apart) + lowest - i128::from(offset) * denominator;
        let found = overlap(&form, &plane).bound;
        assert!(excess(found.lower, denominator, numerator) <= 0.0, "{found:?} {round}");
        assert!(excess(found.upper, denominator, numerator) >= 0.0, "{found:?} {round}");
        widest = widest.max(found.width() / (1.0 + found.lower.abs()));
    }
    assert!(widest < 1e-12, "{widest}");
}

fn dot4(q: [i64; 4]) -> i128 {
    q.iter().map(|&c| i128::from(c) * i128::from(c)).sum()
}

/// Random convex forms above and below a turned half space, which is seen by a huge box as well.
fn pairs(count: usize) -> impl Iterator<Item = [Body; 3]> {
    let mut noise = Noise(12);
    (0..count).map(move |i| {
        let geometry = match i % 7 {
            4 => Geometry::cylinder(noise.between(0.1, 1.0), noise.between(0.1, 1.0)),
            5 => Geometry::cone(noise.between(0.1, 1.0), noise.between(0.1, 1.0)),
            6 => Geometry::ellipsoid(noise.vector().abs() + 0.05),
            kind => Ok(noise.convex(kind)),
        };
        let geometry = geometry.and_then(|form| form.rounded(if i % 3 == 0 { 0.25 } else { 0.0 })).expect("a form");
        let form = Body { geometry, pose: Pose::new(noise.vector(), noise.rotation()) };
        let pose = Pose::new(noise.vector() * 0.1, noise.rotation());
        let form = form.moved(pose.matrix() * DVec3::Y * 0.8);
        let slab = Geometry::cuboid(DVec3::new(1000.0, 10.0, 1000.0)).expect("a slab");
        let slab = Body { geometry: slab, pose: Pose::new(pose.transform_point(DVec3::Y * -10.0), pose.rotation) };
        [form, Body { geometry: space(DVec3::Y, 0.0), pose }, slab]
    })
}

#[test]
fn a_huge_box_gives_the_same_answers() {
    let mut hits = 0;
    for [form, plane, slab] in pairs(2000) {
        let (by_plane, by_slab) = (overlap(&form, &plane), overlap(&form, &slab));
        assert_eq!(by_plane.verdict, by_slab.verdict);
        hits += usize::from(by_plane.verdict == Verdict::Hit);
        let (near, apart) = (distance(&form, &plane), distance(&form, &slab));
        let (narrow, wide) = (near.certificate.bound, apart.certificate.bound);
        // The box is a kilometre wide, and where it lies is rounded.
        let slack = 1e-12;
        assert!(narrow.lower <= wide.upper + slack && wide.lower <= narrow.upper + slack, "{near:?} {apart:?}");
        assert!(near.certificate.bound.contains(near.distance) && near.certificate.bound.width() < 1e-13);
        assert!(((near.point_on_a - near.point_on_b).length() - near.distance).abs() < 1e-14);
        if let Some(contact) = contacts(&form, &plane, 0.5).first() {
            let deepest = contact.points.iter().map(|point| point.depth).fold(f64::NEG_INFINITY, f64::max);
            assert!((deepest - contact.depth).abs() < 1e-14, "{contact:?}");
            assert!((1..=4).contains(&contact.points.len()));
            assert_eq!(contact.certificate.verdict, by_plane.verdict);
        } else {
            assert!(near.distance > 0.5);
        }
    }
    assert!((600..1400).contains(&hits), "{hits} of 2000");
}

#[test]
fn swapping_the_arguments_swaps_the_answer_bit_by_bit() {
    for [form, plane, _] in pairs(500) {
        assert_eq!(overlap(&form, &plane), overlap(&plane, &form));
        let (there, back) = (distance(&form, &plane), distance(&plane, &form));
        assert_eq!(there.certificate, back.certificate);
        assert_eq!([there.point_on_a, there.point_on_b], [back.point_on_b, back.point_on_a]);
        assert_eq!(there.normal_b_to_a, back.normal_b_to_a.map(|normal| -normal));
        let (there, back) = (contacts(&form, &plane, 1.0), contacts(&plane, &form, 1.0));
        assert_eq!(there.len(), back.len());
        for (there, back) in there.iter().zip(&back) {
            assert_eq!((there.depth, there.normal_b_to_a), (back.depth, -back.normal_b_to_a));
            assert_eq!(there.points[0].feature_pair, back.points[0].feature_pair.rotate_left(16));
        }
        let way = DVec3::new(0.3, -2.0, 0.1);
        let (there, back) = (
            impact(&form, way, &plane, -way, InitialTouch::Counts),
            impact(&plane, -way, &form, way, InitialTouch::Counts),
        );
        assert_eq!(there.map(|touch| touch.certificate), back.map(|touch| touch.certificate));
    }
}

#[test]
fn powers_of_two_scale_the_answer_exactly() {
    for scale in [2f64.powi(-20), 2f64.powi(20)] {
        for [form, plane, _] in pairs(300) {
            let scaled = |body: &Body| Body {
                geometry: body.geometry.clone().scaled(scale).expect("within limits"),
                pose: Pose::new(body.pose.position * scale, body.pose.rotation),
            };
            let (small, large) = (distance(&form, &plane), distance(&scaled(&form), &scaled(&plane)));
            let times = |bound: Bound| Bound::new(bound.lower * scale, bound.upper * scale);
            assert_eq!(times(small.certificate.bound), large.certificate.bound);
            assert_eq!(small.distance * scale, large.distance);
        }
    }
}

#[test]
fn far_away_and_tiny_nothing_is_lost() {
    // Far out on a slope of 3 in 4, above a plane whose offset is as large: only the form's own size is rounded.
    let plane = body(space(DVec3::new(3.0, 4.0, 0.0), 1e9), DVec3::new(-4e9, 3e9, 7e8));
    for size in [1e-6, 1.0] {
        let place = DVec3::new(6e8 - 4e9, 8e8 + 3e9, -2e8);
        let ball = Geometry::sphere(size).expect("a ball");
        for (lift, verdict) in [(0.5, Verdict::Hit), (2.0, Verdict::Miss)] {
            let ball = body(ball.clone(), place + DVec3::new(0.6, 0.8, 0.0) * (lift * size));
            // The position itself is rounded at 4e9: take what it became.
            let lifted = ((ball.pose.position.x + 4e9 - 6e8) * 3.0 + (ball.pose.position.y - 3e9 - 8e8) * 4.0) / 5.0;
            let found = overlap(&ball, &plane);
            if size == 1.0 {
                assert_eq!(found.verdict, verdict);
            }
            let truth = lifted - size;
            assert!(found.bound.lower <= truth + 1e-15 && found.bound.upper >= truth - 1e-15, "{found:?} {truth}");
            assert!(found.bound.width() <= 1e-14 * size + 1e-15, "{found:?}");
        }
    }
}

#[test]
fn exact_touch_is_a_touch_and_the_next_number_is_none() {
    let floor = body(space(DVec3::Y * 7.0, 0.1), DVec3::new(3.0, 0.2, 1e9));
    let floor_height = |form: &Geometry, low: f64, height: f64| {
        let at = body(form.clone(), DVec3::new(0.0, height, 0.0));
        (overlap(&at, &floor).verdict, distance(&at, &floor).distance, low)
    };
    let forms = [
        (cuboid(0.7, 0.7, 0.2), 0.7),
        (Geometry::sphere(0.7).expect("a ball"), 0.7),
        (Geometry::cylinder(0.7, 3.0).expect("sizes"), 0.7),
        (Geometry::cone(0.7, 3.0).expect("sizes"), 0.7),
        (Geometry::ellipsoid(DVec3::new(0.1, 0.7, 0.3)).expect("sizes"), 0.7),
    ];
    for (form, low) in forms {
        // 0.1 + 0.2 + 0.7 is no f64: the two neighbours are told apart.
        let mut sum = Expansion::difference(0.2, -0.1);
        sum.add(low);
        let nearest = sum.estimate();
        for height in [nearest.next_down(), nearest, nearest.next_up()] {
            let mut above = Expansion::difference(height, 0.0);
            [0.1, 0.2, low].iter().for_each(|&part| above.add(-part));
            let verdict = if above.sign().is_gt() { Verdict::Miss } else { Verdict::Hit };
            assert_eq!(floor_height(&form, low, height).0, verdict, "{form:?} at {height}");
        }
    }
    let ramp = body(space(DVec3::new(-3.0, 4.0, 0.0), 2.0), DVec3::ZERO);
    let ball = body(Geometry::sphere(3.0).expect("a ball"), DVec3::new(-3.0, 4.0, 9.0));
    assert_eq!(overlap(&ball, &ramp).verdict, Verdict::Hit);
    assert_eq!(overlap(&ball, &ramp).bound, Bound::new(0.0, 0.0));
    assert_eq!(overlap(&ball.moved(DVec3::Y * f64::EPSILON * 4.0), &ramp).verdict, Verdict::Miss);
}

#[test]
fn a_box_on_a_plane_stands_on_its_four_corners_whose_names_stay() {
    let floor = body(space(DVec3::Y, 0.0), DVec3::ZERO);
    let at = |x: f64| {
        let contact = contacts(&body(cuboid(0.5, 0.5, 0.5), DVec3::new(x, 0.49, 2.0)), &floor, 0.0).remove(0);
        assert_eq!(contact.normal_b_to_a, DVec3::Y);
        assert!((contact.depth - 0.01).abs() < 1e-15 && contact.points.len() == 4);
        assert!(contact.points.iter().all(|point| (point.depth - 0.01).abs() < 1e-15 && point.point_on_b.y == 0.0));
        contact.points.iter().map(|point| point.feature_pair).collect::<Vec<_>>()
    };
    assert_eq!(at(0.0), at(1e8));
    let mut names = at(0.0);
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 4);
}

#[test]
fn a_fall_ends_where_height_over_speed_says() {
    let floor = body(space(DVec3::Y, 0.0), DVec3::ZERO);
    let crate_above = body(cuboid(0.5, 0.5, 0.5), DVec3::Y * 2.5);
    let fall = |way: f64| impact(&crate_above, DVec3::Y * way, &floor, DVec3::ZERO, InitialTouch::Counts);
    let touch = fall(-8.0).expect("a touch");
    assert_eq!((touch.fraction, touch.normal_b_to_a, touch.initial), (0.25, Some(DVec3::Y), false));
    assert!(touch.certificate.bound.contains(0.25) && touch.certificate.bound.width() < 1e-14);
    assert_eq!(touch.certificate.verdict, Verdict::Hit);
    assert!(fall(-1.99).is_none() && fall(3.0).is_none());
    // To the very floor in one step: the end is decided exactly.
    assert_eq!(fall(-2.0).map(|touch| touch.certificate.verdict), Some(Verdict::Hit));
    assert!(fall((-2.0f64).next_up()).is_none());
    let sunk = crate_above.moved(DVec3::Y * -2.25);
    let rise = impact(&sunk, DVec3::Y, &floor, DVec3::ZERO, InitialTouch::Counts).expect("a touch at the start");
    assert_eq!((rise.fraction, rise.initial, rise.normal_b_to_a), (0.0, true, None));
    assert!(impact(&sunk, DVec3::Y, &floor, DVec3::ZERO, InitialTouch::IsIgnored).is_none());
    let lying = crate_above.moved(DVec3::Y * -2.0);
    let resting = impact(&lying, DVec3::X, &floor, DVec3::ZERO, InitialTouch::Counts).expect("it rests on it");
    assert_eq!((resting.fraction, resting.normal_b_to_a), (0.0, Some(DVec3::Y)));
}

#[test]
fn an_impact_lies_between_a_free_and_a_touching_instant() {
    let mut noise = Noise(13);
    let mut hits = 0;
    for [form, plane, _] in pairs(1000) {
        let up = plane.pose.matrix() * DVec3::Y;
        let (form, way) = (form.moved(up * 1.5), (noise.vector() - up) * 2.0);
        let drift = noise.vector() * 0.3;
        let at = |time: f64| overlap(&form.moved(way * time), &plane.moved(drift * time));
        match impact(&form, way, &plane, drift, InitialTouch::Counts) {
            None => assert!((0..=20).all(|step| at(f64::from(step) / 20.0).verdict != Verdict::Hit)),
            Some(touch) => {
                let bound = touch.certificate.bound;
                hits += usize::from(touch.certificate.verdict == Verdict::Hit && !touch.initial);
                assert!(bound.contains(touch.fraction) && bound.width() * way.length() < 1e-9, "{bound:?}");
                assert_ne!(at(bound.upper).verdict, Verdict::Miss);
                assert!(
                    (0..20).all(|step| at(bound.lower * f64::from(step) / 20.0 - 1e-13).verdict != Verdict::Hit
                        || touch.initial)
                );
            }
        }
    }
    assert!((150..700).contains(&hits), "{hits} of 1000");
}

#[test]
fn a_mesh_is_as_high_as_its_lowest_vertex() {
    let floor = body(space(DVec3::Y, 0.0), DVec3::ZERO);
    let mesh = body(mesh_of_a_cube(), DVec3::Y * 3.0);
    let apart = distance(&mesh, &floor);
    assert_eq!((apart.distance, apart.point_on_a.y, apart.point_on_b.y), (2.0, 2.0, 0.0));
    assert!(apart.feature_a.face.is_some() && apart.feature_b.face.is_none());
    assert_eq!(overlap(&mesh, &floor).verdict, Verdict::Miss);
    assert_eq!(overlap(&mesh.moved(DVec3::Y * -2.0), &floor).verdict, Verdict::Hit);
    let sunk = contacts(&mesh.moved(DVec3::Y * -2.5), &floor, 0.0);
    assert_eq!(sunk.len(), 10, "all but the two of the lid");
    assert!(sunk.iter().all(|contact| contact.depth == 0.5 && contact.feature_a.face.is_some()));
    let way = DVec3::Y * -4.0;
    let touch = impact(&mesh, way, &floor, DVec3::ZERO, InitialTouch::Counts).expect("a touch");
    assert_eq!(touch.fraction, 0.5);
    // With the sunk triangles passed over, the lid comes next.
    let sunk = mesh.moved(DVec3::Y * -2.5);
    let lid = impact(&sunk, way, &floor, DVec3::ZERO, InitialTouch::IsIgnored).expect("the lid");
    assert_eq!((lid.fraction, lid.initial), (0.375, false));
}

#[test]
fn two_half_spaces_overlap_unless_they_are_opposite() {
    let below = body(space(DVec3::Y, 0.0), DVec3::ZERO);
    let above = body(space(DVec3::Y * -3.0, -2.0), DVec3::X);
    assert_eq!((distance(&below, &above).distance, distance(&above, &below).distance), (2.0, 2.0));
    assert_eq!(distance(&below, &above).normal_b_to_a, Some(-DVec3::Y));
    assert_eq!(overlap(&below, &above).verdict, Verdict::Miss);
    let met = above.moved(DVec3::Y * -2.0);
    assert_eq!(overlap(&below, &met).bound, Bound::new(0.0, 0.0));
    let falling = impact(&above, DVec3::Y * -4.0, &below, DVec3::ZERO, InitialTouch::Counts).expect("a touch");
    assert_eq!((falling.fraction, falling.normal_b_to_a), (0.5, Some(DVec3::Y)));
    let leaning = body(space(DVec3::new(1e-30, -3.0, 0.0), -2.0), DVec3::X);
    let crossing = overlap(&below, &leaning);
    assert_eq!((crossing.verdict, crossing.bound), (Verdict::Hit, Bound::new(f64::NEG_INFINITY, 0.0)));
    let contact = contacts(&leaning, &below, 0.0).remove(0);
    assert_eq!((contact.certificate.verdict, contact.certificate.bound.upper), (Verdict::Hit, f64::INFINITY));
    let common = distance(&leaning, &below);
    assert!(common.distance == 0.0 && common.point_on_a.is_finite() && common.point_on_a == common.point_on_b);
    // A half turn makes them opposite, which is not decided between different rotations.
    let turned = Body { pose: Pose::new(DVec3::Y * 2.0, DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0)), ..below.clone() };
    let found = distance(&turned, &below);
    assert!(found.certificate.bound.lower == 0.0 && found.certificate.bound.upper >= 2.0, "{found:?}");
}

#[test]
fn depth_margin_and_warm_questions_agree_with_the_contact() {
    let accuracy = Accuracy::default();
    for [form, plane, _] in pairs(500) {
        let mut work = Work::default();
        let contact = contacts(&form, &plane, 1.0).into_iter().next();
        let depth = narrow::depth(form.placed(), plane.placed(), 1.0, &accuracy, &mut work);
        assert_eq!(contact.as_ref().map(|c| c.certificate), depth.map(|depth| depth.certificate));
        let mut warm = narrow::Warm::default();
        let again = narrow::distance_warm(form.placed(), plane.placed(), 4.0, &accuracy, &mut warm, &mut work);
        let apart = distance(&form, &plane);
        assert_eq!(again.map(|found| found.certificate.bound), Some(apart.certificate.bound));
        for (margin, verdict) in [(apart.distance + 0.01, Verdict::Hit), (apart.distance - 0.01, Verdict::Miss)] {
            let within = narrow::within(form.placed(), plane.placed(), margin, &accuracy, &mut work);
            if margin >= 0.0 {
                assert_eq!(within.map(|found| found.verdict), Some(verdict));
            }
        }
    }
}
