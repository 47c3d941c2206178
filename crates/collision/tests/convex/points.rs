//! Contact points of faces, rims and lines that lie on each other.

use crate::random::{Body, Noise};
use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::Work,
    math::Pose,
    narrow::{self, Contact, Faces, Ray},
    shape::Geometry,
};

/// A form of about unit size times `size`, and an outward direction across which it is flat, or any if it is nowhere.
fn form(noise: &mut Noise, kind: usize, size: f64) -> (Geometry, DVec3) {
    let mut length = || noise.between(0.2, 1.0) * size;
    let (x, y, z) = (length(), length(), length());
    let turn = noise.between(0.0, std::f64::consts::TAU);
    let around = DVec3::new(turn.cos(), 0.0, turn.sin());
    let end = DVec3::Y * noise.signed().signum();
    let (form, out) = match kind {
        0 => (Geometry::cuboid(DVec3::new(x, y, z)), end),
        1 => (Geometry::cylinder(x, y), end),
        2 => (Geometry::cylinder(x, y), around),
        3 => (Geometry::cone(x, y), DVec3::NEG_Y),
        4 => (Geometry::cone(x, y), around * 2.0 * x + DVec3::Y * y),
        5 => (Geometry::ellipsoid(DVec3::new(x, y, z)), around + end * noise.between(0.0, 2.0)),
        6 => (Geometry::capsule(x, y), around),
        7 => (Geometry::sphere(x), end),
        _ => {
            let corners =
                [DVec3::new(x, -y, z), DVec3::new(-x, -y, z), DVec3::new(0.0, -y, -x), DVec3::new(0.0, z, 0.0)];
            (Geometry::hull(&corners), DVec3::NEG_Y)
        }
    };
    let form = form.expect("sizes within limits");
    let is_rounded = noise.signed() > 0.3 && kind != 6 && kind != 7;
    let form = if is_rounded { form.rounded(noise.between(0.01, 0.5) * size).expect("a radius") } else { form };
    (form, out.normalize())
}

/// Forms with a flat side of each against the other, turned by at most a millionth or exactly, near or deep in each other.
fn face_to_face(noise: &mut Noise, kinds: [usize; 2], size: f64) -> [Body; 2] {
    let [(form_a, out_a), (form_b, out_b)] = kinds.map(|kind| form(noise, kind, size));
    let turn_a = if noise.signed() > 0.0 { DQuat::IDENTITY } else { noise.rotation().normalize() };
    let out = turn_a * out_a;
    let lean = if noise.signed() > 0.5 { 0.0 } else { noise.between(-17.0, -0.5) };
    let lean = if lean == 0.0 { DQuat::IDENTITY } else { DQuat::from_scaled_axis(noise.vector() * 10f64.powf(lean)) };
    let spin = DQuat::from_axis_angle(out, noise.between(0.0, 6.0));
    let spin = if noise.signed() > 0.3 { DQuat::IDENTITY } else { spin };
    let turn_b = lean * spin * DQuat::from_rotation_arc(out_b, -out);
    let beside = noise.vector().reject_from(out) * noise.between(0.0, 0.8) * size;
    let beside = if noise.signed() > 0.5 { DVec3::ZERO } else { beside };
    let a = Body { geometry: form_a, pose: Pose::new(DVec3::ZERO, turn_a) };
    let b = Body { geometry: form_b, pose: Pose::new(out * 8.0 * size + beside, turn_b) };
    let apart = narrow::distance(a.placed(), b.placed(), f64::INFINITY, &Accuracy::default(), &mut Work::default());
    let apart = apart.expect("convex forms").distance;
    let depth = match (noise.between(0.0, 3.0)) as u32 {
        0 => 0.0,
        1 => noise.signed() * 0.3 * size,
        _ => noise.signed().signum() * 10f64.powf(noise.between(-17.0, -1.0)) * size,
    };
    let b = b.moved(-out * (apart + depth));
    [a, b]
}

fn contacts(a: &Body, b: &Body, max_gap: f64) -> Vec<Contact> {
    let contacts = narrow::penetration(a.placed(), b.placed(), max_gap, &Accuracy::default(), &mut Work::default());
    contacts.expect("convex forms").into_iter().collect()
}

/// Bounds of how deep the surfaces of two forms are in each other along a normal, on the line through a place that is at most
/// four times `size` from them; `None` if it is not certain that the line meets both.
fn depth_there(a: &Body, b: &Body, normal: DVec3, place: DVec3, size: f64) -> Option<[f64; 2]> {
    let height = |body: &Body, outward: DVec3| {
        let ray = Ray {
            origin: place + outward * 4.0 * size,
            direction: -outward,
            min_distance: 0.0,
            max_distance: 1e18,
            hollow: false,
            faces: Faces::Both,
        };
        let touches = narrow::raycast(&ray, body.placed(), &Accuracy::default(), &mut Work::default());
        let bound = touches.certain?.certificate.bound;
        Some([4.0 * size - bound.upper, 4.0 * size - bound.lower])
    };
    let ([low_a, high_a], [low_b, high_b]) = (height(a, -normal)?, height(b, normal)?);
    Some([low_a + low_b, high_a + high_b])
}

/// All contacts of pairs that lie face to face, in both orders, with the size of the pair.
fn contacts_face_to_face(seed: u64, count: usize) -> impl Iterator<Item = ([Body; 2], f64, Contact)> {
    let mut noise = Noise(seed);
    (0..count).flat_map(move |i| {
        let size = 10f64.powf(noise.between(-4.0, 4.0));
        let [a, b] = face_to_face(&mut noise, [i % 9, i / 9 % 9], size);
        [[a.clone(), b.clone()], [b, a]].into_iter().flat_map(move |[a, b]| {
            let contacts = contacts(&a, &b, 0.1 * size);
            contacts.into_iter().map(move |contact| ([a.clone(), b.clone()], size, contact))
        })
    })
}

/// The formula for forms whose axes are all but parallel gave points that were off by the lean.
#[test]
fn no_point_is_surely_deeper_than_the_contact() {
    for ([a, b], size, contact) in contacts_face_to_face(77, 80_000) {
        let upper = contact.certificate.bound.upper;
        for point in &contact.points {
            assert!(point.bound.lower <= upper, "{:e}\n{a:?}\n{b:?}\n{contact:?}", (point.bound.lower - upper) / size);
        }
    }
}

/// Over a face that leaned a little the other surface's point was put beside that face, off by the lean; and over a rounded face
/// that leans more the surface lies higher than above a corner of it.
#[test]
fn intervals_of_points_hold_how_deep_the_surfaces_are_there() {
    // A line through an edge may miss it by rounding, so it is moved in by a little.
    const INWARD: f64 = 1e-11;
    let mut seen = 0;
    for ([a, b], size, contact) in contacts_face_to_face(78, 20_000) {
        let points = &contact.points;
        let middle = points.iter().map(|point| point.point_on_b).sum::<DVec3>() / points.len() as f64;
        for point in points.iter().filter(|_| points.len() > 1) {
            let place = point.point_on_b + (middle - point.point_on_b) * INWARD;
            let Some([low, high]) = depth_there(&a, &b, contact.normal_b_to_a, place, size) else { continue };
            let off = (point.bound.lower - high).max(low - point.bound.upper) / size;
            assert!(off <= 10.0 * INWARD, "{off:e} {low} {high}\n{a:?}\n{b:?}\n{contact:?}");
            seen += 1;
        }
    }
    assert!(seen > 20_000, "only {seen} points were measured");
}
