//! Laws of the convex kernels: symmetry, scale, rigid motion, and agreement between the questions.

use crate::random::{Body, Noise, pairs};
use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Verdict, Work},
    math::Pose,
    narrow::{self, Contact, ImpactTouch, InitialTouch, Motion, Placed, Separation},
};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

fn overlap(a: &Body, b: &Body) -> collision::answer::Certificate {
    narrow::overlap(a.placed(), b.placed(), &EXACT, &mut Work::default())
}

fn distance(a: &Body, b: &Body) -> Separation {
    narrow::distance(a.placed(), b.placed(), f64::INFINITY, &EXACT, &mut Work::default()).expect("no limit")
}

fn contact(a: &Body, b: &Body, max_gap: f64) -> Option<Contact> {
    let contacts = narrow::penetration(a.placed(), b.placed(), max_gap, &EXACT, &mut Work::default());
    contacts.expect("convex forms").into_iter().next()
}

fn impact(a: &Body, way_a: DVec3, b: &Body, way_b: DVec3) -> Option<ImpactTouch> {
    let (a, b): (Placed<'_>, Placed<'_>) = (a.placed(), b.placed());
    let motion =
        Motion { displacement_a: way_a, displacement_b: way_b, initial: InitialTouch::Counts, ..Motion::default() };
    narrow::impact(a, b, &motion, &EXACT, &mut Work::default())
}

#[test]
fn about_half_of_the_random_pairs_overlap() {
    let hits = pairs(1, 2000).filter(|[a, b]| overlap(a, b).verdict == Verdict::Hit).count();
    assert!((600..1400).contains(&hits), "{hits} of 2000");
}

#[test]
fn swapping_the_arguments_swaps_the_answer_bit_by_bit() {
    for [a, b] in pairs(2, 1000) {
        assert_eq!(overlap(&a, &b), overlap(&b, &a));
        let (there, back) = (distance(&a, &b), distance(&b, &a));
        assert_eq!(there.certificate, back.certificate);
        assert_eq!([there.point_on_a, there.point_on_b], [back.point_on_b, back.point_on_a]);
        assert_eq!(there.normal_b_to_a, back.normal_b_to_a.map(|normal| -normal));
        let (there, back) = (contact(&a, &b, 0.0), contact(&b, &a, 0.0));
        assert_eq!(there.is_some(), back.is_some());
        if let (Some(there), Some(back)) = (there, back) {
            assert_eq!((there.depth, there.normal_b_to_a), (back.depth, -back.normal_b_to_a));
            assert_eq!(there.points.len(), back.points.len());
        }
    }
}

#[test]
fn powers_of_two_scale_the_answer_exactly() {
    for scale in [2f64.powi(-20), 2f64.powi(20)] {
        for [a, b] in pairs(3, 400) {
            let scaled = |body: &Body| Body {
                geometry: body.geometry.clone().scaled(scale).expect("within limits"),
                pose: Pose::new(body.pose.position * scale, body.pose.rotation),
            };
            let (small, large) = (distance(&a, &b), distance(&scaled(&a), &scaled(&b)));
            assert_eq!(small.distance * scale, large.distance);
            assert_eq!(small.certificate.bound.lower * scale, large.certificate.bound.lower);
            assert_eq!(small.certificate.bound.upper * scale, large.certificate.bound.upper);
            let depth = |contact: Option<Contact>| contact.map(|contact| contact.depth);
            assert_eq!(
                depth(contact(&a, &b, 0.0)).map(|depth| depth * scale),
                depth(contact(&scaled(&a), &scaled(&b), 0.0))
            );
        }
    }
}

#[test]
fn a_rigid_motion_leaves_a_common_truth_in_both_intervals() {
    let mut noise = Noise(4);
    for [a, b] in pairs(4, 1000) {
        let turn = Pose::new(noise.vector() * 10.0, noise.rotation());
        let turned = |body: &Body| Body {
            geometry: body.geometry.clone(),
            pose: Pose::new(turn.transform_point(body.pose.position), turn.unit_rotation() * body.pose.unit_rotation()),
        };
        let (before, after) =
            (distance(&a, &b).certificate.bound, distance(&turned(&a), &turned(&b)).certificate.bound);
        // The turned poses themselves are rounded: positions within 12 m by a few ulps.
        let slack = 1e-14;
        assert!(before.lower <= after.upper + slack && after.lower <= before.upper + slack, "{before:?} {after:?}");
    }
}

#[test]
fn distance_and_points_agree() {
    for [a, b] in pairs(5, 1000) {
        let answer = distance(&a, &b);
        assert!(answer.certificate.bound.contains(answer.distance));
        assert!(((answer.point_on_a - answer.point_on_b).length() - answer.distance).abs() < 1e-13);
        match answer.normal_b_to_a {
            Some(normal) => {
                let reached = answer.point_on_b + normal * answer.distance;
                // The normal of a tiny gap is the direction of the features, the points' difference has rounding.
                assert!(reached.distance(answer.point_on_a) < 1e-7, "{reached} {}", answer.point_on_a);
            }
            None => assert_eq!(answer.distance, 0.0),
        }
        let verdict = overlap(&a, &b).verdict;
        assert_eq!(verdict == Verdict::Hit, answer.certificate.bound.upper == 0.0);
    }
}

#[test]
fn the_depth_is_a_way_out_and_the_least_one() {
    for [a, b] in pairs(6, 1000) {
        let Some(contact) = contact(&a, &b, 0.0) else {
            assert_eq!(overlap(&a, &b).verdict, Verdict::Miss);
            continue;
        };
        let way_out = contact.normal_b_to_a * (contact.certificate.bound.upper + 1e-13);
        assert_ne!(overlap(&a.moved(way_out), &b).verdict, Verdict::Hit, "{contact:?}");
        let less = contact.normal_b_to_a * (contact.certificate.bound.lower - 1e-9);
        if contact.certificate.bound.lower > 1e-9 {
            assert_eq!(overlap(&a.moved(less), &b).verdict, Verdict::Hit, "{contact:?}");
        }
        let mut noise = Noise(contact.depth.to_bits());
        for _ in 0..20 {
            let elsewhere = noise.vector().normalize() * (contact.certificate.bound.lower - 1e-13).max(0.0);
            assert_ne!(overlap(&a.moved(elsewhere), &b).verdict, Verdict::Miss, "a shorter way out than {contact:?}");
        }
    }
}

#[test]
fn an_impact_lies_between_a_free_and_a_touching_instant() {
    let mut noise = Noise(7);
    let mut hits = 0;
    for [a, b] in pairs(7, 1000) {
        let a = a.moved(-b.pose.position.normalize() * 2.0);
        let way = (b.pose.position - a.pose.position + noise.vector()) * noise.between(0.3, 1.5);
        let drift = noise.vector() * 0.1;
        let at = |time: f64| overlap(&a.moved((way + drift) * time), &b.moved(drift * time));
        let Some(touch) = impact(&a, way + drift, &b, drift) else {
            for step in 0..=50 {
                assert_ne!(at(f64::from(step) / 50.0).verdict, Verdict::Hit);
            }
            continue;
        };
        hits += usize::from(touch.certificate.verdict == Verdict::Hit);
        let bound = touch.certificate.bound;
        assert!(bound.contains(touch.fraction) && bound.width() * way.length() < 1e-9, "{bound:?}");
        assert_ne!(at(bound.upper).verdict, Verdict::Miss);
        for step in 0..50 {
            assert_ne!(at(bound.lower * f64::from(step) / 50.0 - 1e-13).verdict, Verdict::Hit);
        }
        let (a, b) = (a.moved((way + drift) * touch.fraction), b.moved(drift * touch.fraction));
        let point = Body { geometry: collision::shape::Geometry::point(), pose: Pose::at(touch.point) };
        assert!(distance(&point, &a).distance < 1e-9 && distance(&point, &b).distance < 1e-9, "{}", touch.point);
    }
    assert!((300..700).contains(&hits), "{hits} of 1000");
}

#[test]
fn with_the_start_ignored_convex_forms_that_touch_at_it_never_touch_again() {
    for [a, b] in pairs(8, 500) {
        let way = DVec3::new(0.3, -2.0, 0.7);
        let (first, second) = (a.placed(), b.placed());
        let motion = Motion {
            displacement_a: way,
            displacement_b: DVec3::ZERO,
            initial: InitialTouch::IsIgnored,
            ..Motion::default()
        };
        let again = narrow::impact(first, second, &motion, &EXACT, &mut Work::default());
        match overlap(&a, &b).verdict {
            Verdict::Hit => assert!(again.is_none()),
            _ => assert_eq!(again.map(|t| t.fraction), impact(&a, way, &b, DVec3::ZERO).map(|t| t.fraction)),
        }
    }
}
