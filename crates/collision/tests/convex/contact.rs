//! Contact points: how many, where, and that their names stay from tick to tick.

use crate::random::{Body, pairs};
use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::Work,
    math::Pose,
    narrow::{self, Contact},
    shape::Geometry,
};

fn body(geometry: Geometry, position: DVec3) -> Body {
    Body { geometry, pose: Pose::at(position) }
}

fn cuboid(x: f64, y: f64, z: f64) -> Geometry {
    Geometry::cuboid(DVec3::new(x, y, z)).expect("a size")
}

fn contact(a: &Body, b: &Body) -> Contact {
    let contacts = narrow::penetration(a.placed(), b.placed(), 0.0, &Accuracy::default(), &mut Work::default());
    contacts.expect("convex forms").into_iter().next().expect("they overlap")
}

/// The points on `a`, sorted, rounded to a millionth.
fn places(contact: &Contact) -> Vec<[f64; 3]> {
    let round = |x: f64| (x * 1e6).round() / 1e6 + 0.0;
    let mut places: Vec<[f64; 3]> = contact.points.iter().map(|p| p.point_on_a.to_array().map(round)).collect();
    places.sort_by(|p, q| p.partial_cmp(q).expect("finite"));
    places
}

#[test]
fn a_box_on_a_floor_stands_on_its_four_corners() {
    let crate_on_floor = body(cuboid(0.5, 0.5, 0.5), DVec3::new(3.0, 0.49, 2.0));
    let floor = body(cuboid(10.0, 1.0, 10.0), DVec3::new(0.0, -1.0, 0.0));
    let contact = contact(&crate_on_floor, &floor);
    assert_eq!(contact.normal_b_to_a, DVec3::Y);
    assert_eq!(places(&contact), [[2.5, -0.01, 1.5], [2.5, -0.01, 2.5], [3.5, -0.01, 1.5], [3.5, -0.01, 2.5]]);
    assert!(contact.points.iter().all(|point| (point.depth - 0.01).abs() < 1e-14));
}

#[test]
fn crossed_boxes_touch_in_the_corners_of_their_common_square() {
    let (beam, other) = (body(cuboid(2.0, 0.1, 0.1), DVec3::ZERO), body(cuboid(0.1, 0.1, 2.0), DVec3::Y * 0.19));
    let contact = contact(&beam, &other);
    assert_eq!(places(&contact), [[-0.1, 0.1, -0.1], [-0.1, 0.1, 0.1], [0.1, 0.1, -0.1], [0.1, 0.1, 0.1]]);
}

#[test]
fn a_lying_capsule_touches_in_two_points_a_standing_one_in_one() {
    let floor = body(cuboid(10.0, 1.0, 10.0), DVec3::new(0.0, -1.0, 0.0));
    let capsule = Geometry::capsule(1.0, 0.25).expect("sizes");
    let mut lying = body(capsule.clone(), DVec3::Y * 0.24);
    lying.pose.rotation = DQuat::from_xyzw(0.0, 0.0, 1.0, 1.0);
    let two = contact(&lying, &floor);
    assert_eq!(places(&two), [[-1.0, -0.01, 0.0], [1.0, -0.01, 0.0]]);
    let standing = contact(&body(capsule, DVec3::Y * 1.24), &floor);
    assert_eq!(places(&standing), [[0.0, -0.01, 0.0]]);
    assert!((standing.depth - 0.01).abs() < 1e-14);
}

#[test]
fn capsules_side_by_side_touch_along_their_common_length() {
    let capsule = Geometry::capsule(1.0, 0.25).expect("sizes");
    let (a, b) = (body(capsule.clone(), DVec3::ZERO), body(capsule, DVec3::new(0.49, 0.5, 0.0)));
    assert_eq!(places(&contact(&a, &b)), [[0.25, -0.5, 0.0], [0.25, 1.0, 0.0]]);
}

#[test]
fn crossed_edges_touch_in_one_point() {
    let mut beam = body(cuboid(2.0, 0.1, 0.1), DVec3::ZERO);
    beam.pose.rotation = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_4);
    let mut other = body(cuboid(0.1, 0.1, 2.0), DVec3::Y * (0.02f64.sqrt() * 2.0 - 0.01));
    other.pose.rotation = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_4);
    let contact = contact(&beam, &other);
    assert_eq!(contact.points.len(), 1);
    assert!((contact.depth - 0.01).abs() < 1e-14);
    let point = contact.points[0];
    assert!((point.point_on_a - DVec3::Y * 0.02f64.sqrt()).length() < 1e-14, "{point:?}");
    assert!((point.point_on_b - DVec3::Y * (0.02f64.sqrt() - 0.01)).length() < 1e-14, "{point:?}");
}

#[test]
fn names_of_points_stay_while_their_features_do() {
    let floor = body(cuboid(10.0, 1.0, 10.0), DVec3::new(0.0, -1.0, 0.0));
    let at = |x: f64| {
        let contact = contact(&body(cuboid(0.5, 0.5, 0.5), DVec3::new(x, 0.49, 0.0)), &floor);
        let mut names: Vec<u32> = contact.points.iter().map(|point| point.feature_pair).collect();
        names.sort_unstable();
        names
    };
    assert_eq!(at(0.0), at(0.125));
    let mut distinct = at(0.0);
    distinct.dedup();
    assert_eq!(distinct.len(), 4);
}

#[test]
fn contacts_have_one_to_four_points_no_deeper_than_the_contact() {
    for [a, b] in pairs(12, 2000) {
        let contacts = narrow::penetration(a.placed(), b.placed(), 0.5, &Accuracy::default(), &mut Work::default());
        for contact in contacts.expect("convex forms") {
            assert!((1..=4).contains(&contact.points.len()));
            for point in &contact.points {
                assert!(point.depth <= contact.certificate.bound.upper + 1e-13, "{point:?} {contact:?}");
            }
        }
    }
}
