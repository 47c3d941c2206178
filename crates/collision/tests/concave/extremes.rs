//! Concave forms of all sizes, far and near: intervals still meet, and powers of two change nothing.

use std::sync::Arc;

use collision::{
    DVec3,
    math::Pose,
    narrow::{Motion, distance, impact, penetration},
    shape::{Geometry, Part},
};

use crate::{
    agree::{EXACT, Tally, Twins, at, convex, motion_towards, ray_towards, rotation, work},
    terrain::Land,
    whole::Numbers,
};

/// A field and its skin as a mesh, from a micrometre to a megametre, up to a gigametre from the origin of the world.
#[test]
fn fields_of_all_sizes_answer_as_their_skins() {
    let mut numbers = Numbers::new(641);
    let mut tally = Tally::default();
    for round in 0..400 {
        let mut land = Land::random(&mut numbers);
        let scale = [1e-6, 1e-3, 1.0, 1e3, 1e6][round % 5];
        // Cells far longer than wide, and steep.
        let stretch = [DVec3::ONE, DVec3::new(50.0, 1.0, 1.0), DVec3::new(1.0, 40.0, 1.0)][round % 3];
        land.spacing *= stretch * scale;
        let (field, mesh) = (land.field(), land.mesh());
        let far = [0.0, 1e3, 1e9][round / 5 % 3];
        let here = Pose::new(numbers.shares() * far, rotation(&mut numbers));
        let form = convex(&mut numbers).scaled(scale).expect("a form of that size");
        let (column, row) = (numbers.below(land.columns as i128) as usize, numbers.below(land.rows as i128) as usize);
        let there = here.transform_point(land.sample(column, row)) + numbers.shares() * (0.5 * scale);
        let asker = at(&form, Pose::new(there, rotation(&mut numbers)));
        let twins = Twins { one: at(&field, here), other: at(&mesh, here), asker };
        let context =
            || format!("round {round}: {:?} {:?} {:?} {here:?} {form:?}", land.heights, land.holes, land.spacing);
        let touch = distance(asker, twins.other, f64::INFINITY, &EXACT, &mut work()).expect("no limit");
        let in_field = distance(asker, twins.one, f64::INFINITY, &EXACT, &mut work()).expect("no limit");
        assert!(in_field.certificate.bound.lower <= touch.certificate.bound.upper, "{}", context());
        let ray = ray_towards(&mut numbers, there, 0.5 * scale);
        let ray = collision::narrow::Ray { hollow: true, ..ray };
        twins.check_ray(&ray, &mut tally, &context);
        if in_field.certificate.bound.lower > 0.0 || touch.certificate.bound.upper <= 0.0 {
            let motion = motion_towards(&mut numbers, there, there, 0.7 * scale);
            let [one, other] = [twins.one, twins.other].map(|form| impact(asker, form, &motion, &EXACT, &mut work()));
            if let (Some(one), Some(other)) = (one, other) {
                let (a, b) = (one.certificate.bound, other.certificate.bound);
                assert!(a.lower <= b.upper && b.lower <= a.upper, "{one:?} {other:?} {}", context());
                tally.impacts += 1;
            }
        }
    }
    assert!(tally.rays > 80 && tally.impacts > 80, "{tally:?}");
}

/// A compound with a field, a mesh and a ball in it, and all that is asked of it, 64 times as large: bit by bit.
#[test]
fn powers_of_two_change_nothing_but_lengths() {
    let mut numbers = Numbers::new(643);
    for _ in 0..60 {
        let land = Land::random(&mut numbers);
        let place = |numbers: &mut Numbers| Pose::new(numbers.shares(), rotation(numbers));
        let forms = [land.field(), land.mesh(), convex(&mut numbers)];
        let parts = forms.map(|form| Part { geometry: Arc::new(form), pose: place(&mut numbers) });
        let compound = Geometry::compound(parts.to_vec()).expect("a compound");
        let (here, form) = (place(&mut numbers), convex(&mut numbers));
        let there = Pose::new(here.position + numbers.shares() * 2.0, rotation(&mut numbers));
        let (way, turn) = (numbers.shares(), numbers.shares());
        let ask = |scale: f64| {
            let compound = compound.clone().scaled(scale).expect("larger");
            let form = form.clone().scaled(scale).expect("larger");
            let larger = |pose: Pose| Pose::new(pose.position * scale, pose.rotation);
            let (a, b) = (at(&form, larger(there)), at(&compound, larger(here)));
            let apart = distance(a, b, f64::INFINITY, &EXACT, &mut work()).expect("no limit");
            let motion = Motion { displacement_a: way * scale, rotation_a: turn, ..Motion::default() };
            let touch = impact(a, b, &motion, &EXACT, &mut work()).map(|touch| touch.fraction);
            let contacts = penetration(a, b, 0.1 * scale, &EXACT, &mut work()).expect("a convex form");
            let depths: Vec<f64> = contacts.iter().map(|contact| contact.depth / scale).collect();
            (apart.distance / scale, apart.certificate.bound.upper / scale, apart.feature_b, touch, depths)
        };
        assert_eq!(ask(1.0), ask(64.0));
    }
}
