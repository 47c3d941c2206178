//! Laws of compounds: they are the union of their parts, however these are put together.

use std::sync::Arc;

use collision::{
    DVec3,
    answer::Verdict,
    math::Pose,
    narrow::{NeedsDecomposition, Placed, distance, overlap, penetration, raycast},
    shape::{Form, Geometry, GeometryError, Limits, Part},
};

use crate::{
    agree::{EXACT, Tally, Twins, at, convex, motion_towards, ray_towards, rotation, work},
    whole::Numbers,
};

fn part(geometry: &Arc<Geometry>, pose: Pose) -> Part {
    Part { geometry: Arc::clone(geometry), pose }
}

fn place(numbers: &mut Numbers, spread: f64) -> Pose {
    Pose::new(numbers.shares() * spread, rotation(numbers))
}

/// Where the compound is: near, and far where f64 has few digits left.
fn far(round: usize) -> f64 {
    [0.0, 1e3, 1e8][round % 3]
}

/// A flat compound of convex parts is as far as its nearest part, is met where the first is met, and so on: here it is
/// unturned, so that its parts can be placed one by one without rounding.
#[test]
fn a_compound_is_its_parts_one_by_one() {
    let mut numbers = Numbers::new(501);
    let (mut hits, mut misses) = (0, 0);
    for round in 0..300 {
        let parts: Vec<Part> =
            (0..5).map(|_| part(&Arc::new(convex(&mut numbers)), place(&mut numbers, 0.8))).collect();
        let compound = Geometry::compound(parts.clone()).expect("a compound");
        let whole = at(&compound, Pose::IDENTITY);
        let form = convex(&mut numbers);
        let asker = at(&form, place(&mut numbers, 0.8));
        let alone: Vec<Placed<'_>> = parts.iter().map(|part| at(&part.geometry, part.pose)).collect();
        let found = distance(asker, whole, 9.0, &EXACT, &mut work()).expect("near");
        let apart: Vec<_> =
            alone.iter().map(|&part| distance(asker, part, 9.0, &EXACT, &mut work()).expect("near")).collect();
        let least = apart.iter().map(|one| one.distance).fold(f64::INFINITY, f64::min);
        assert!((found.distance - least).abs() < 1e-14, "round {round}");
        assert!(found.certificate.bound.lower <= least && least <= found.certificate.bound.upper);
        let index = found.feature_b.part.expect("a part") as usize;
        assert!(apart[index].certificate.bound.lower <= found.certificate.bound.upper, "round {round}");
        let verdict = overlap(asker, whole, &EXACT, &mut work()).verdict;
        let verdicts = alone.iter().map(|&part| overlap(asker, part, &EXACT, &mut work()).verdict);
        assert_eq!(verdict == Verdict::Hit, verdicts.clone().any(|one| one == Verdict::Hit), "round {round}");
        hits += u32::from(verdict == Verdict::Hit);
        misses += u32::from(verdict == Verdict::Miss);
        let contacts = penetration(asker, whole, 0.1, &EXACT, &mut work()).expect("convex parts");
        let touching: Vec<u32> = contacts.iter().filter_map(|contact| contact.feature_b.part).collect();
        let expected: Vec<u32> =
            (0..).zip(&apart).filter(|(_, one)| one.distance <= 0.1).map(|(index, _)| index).collect();
        assert_eq!(touching, expected, "round {round}");
    }
    assert!(hits > 90 && misses > 90, "{hits} hits, {misses} misses");
}

/// Where a part is within another is nobody's business: a compound of one part is that part, a nested one the flat one.
#[test]
fn nesting_changes_nothing() {
    let mut numbers = Numbers::new(503);
    let mut tally = Tally::default();
    for round in 0..400 {
        let forms: Vec<Arc<Geometry>> = (0..3).map(|_| Arc::new(convex(&mut numbers))).collect();
        let shift = numbers.vector(1 << 20);
        let shift = DVec3::from_array(shift.map(|part| part as f64 / f64::from(1 << 21)));
        let poses: Vec<Pose> = (0..3).map(|_| place(&mut numbers, 0.4)).collect();
        let inner = Geometry::compound(vec![part(&forms[1], poses[1]), part(&forms[2], poses[2])]).expect("inner");
        let nested = Geometry::compound(vec![part(&forms[0], poses[0]), part(&Arc::new(inner), Pose::at(shift))]);
        let nested = nested.expect("nested");
        let moved = |pose: Pose| Pose::new(pose.position + shift, pose.rotation);
        let flat = Geometry::compound(vec![
            part(&forms[0], poses[0]),
            part(&forms[1], moved(poses[1])),
            part(&forms[2], moved(poses[2])),
        ]);
        let flat = flat.expect("flat");
        let here = Pose::new(numbers.shares() * far(round), rotation(&mut numbers));
        let form = convex(&mut numbers);
        let asker = at(&form, Pose::new(here.position + numbers.shares() * 0.6, rotation(&mut numbers)));
        let twins = Twins { one: at(&nested, here), other: at(&flat, here), asker };
        let motion = motion_towards(&mut numbers, asker.pose.position, here.position, 1.0);
        let context = || format!("round {round}: {nested:?} at {here:?}, {form:?} at {:?}", asker.pose);
        twins.check(&motion, &mut tally, &context);
        twins.check_ray(&ray_towards(&mut numbers, here.position, 0.3), &mut tally, &context);
    }
    tally.assert_not_vacuous(1e-10);
}

/// A soup of triangles with corners that f64 adds up exactly.
fn soup(numbers: &mut Numbers) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let coarse = |numbers: &mut Numbers| numbers.vector(1 << 20).map(|part| part as f64 / f64::from(1 << 21));
    let points: Vec<DVec3> = (0..12).map(|_| DVec3::from_array(coarse(numbers))).collect();
    (points, (0..8).map(|first| [first, first + 2, first + 4]).collect())
}

#[test]
fn a_compound_of_meshes_is_the_mesh_of_all_their_triangles() {
    let mut numbers = Numbers::new(509);
    let mut tally = Tally::default();
    for round in 0..300 {
        let (mut vertices, mut triangles, mut parts) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..3 {
            let (points, indices) = soup(&mut numbers);
            let shift = DVec3::from_array(numbers.vector(4).map(|part| part as f64 / 8.0));
            let base = vertices.len() as u32;
            vertices.extend(points.iter().map(|&point| point + shift));
            triangles.extend(indices.iter().map(|triangle| triangle.map(|vertex| base + vertex)));
            let mesh = Arc::new(Geometry::mesh(&points, &indices).expect("a soup"));
            parts.push(part(&mesh, Pose::at(shift)));
        }
        let compound = Geometry::compound(parts).expect("a compound");
        let merged = Geometry::mesh(&vertices, &triangles).expect("a mesh");
        let here = Pose::new(numbers.shares() * far(round), rotation(&mut numbers));
        let form = convex(&mut numbers);
        let asker = at(&form, Pose::new(here.position + numbers.shares() * 0.7, rotation(&mut numbers)));
        let twins = Twins { one: at(&compound, here), other: at(&merged, here), asker };
        let motion = motion_towards(&mut numbers, asker.pose.position, here.position, 3.0);
        let context = || format!("round {round} at {here:?}, {form:?} at {:?}", asker.pose);
        twins.check(&motion, &mut tally, &context);
        twins.check_ray(&ray_towards(&mut numbers, here.position, 0.6), &mut tally, &context);
        let both = Twins { asker: at(&merged, asker.pose), ..twins };
        let mut apart = Tally::default();
        both.check(&motion, &mut apart, &context);
        let error = penetration(both.one, both.asker, 0.0, &EXACT, &mut work());
        assert_eq!(error.err(), Some(NeedsDecomposition), "two surfaces");
    }
    tally.assert_not_vacuous(1e-10);
}

/// Numbers and intervals of a compound that is a power of two times as large are as much larger, bit by bit.
#[test]
fn scale_scales_the_parts_and_where_they_are() {
    let mut numbers = Numbers::new(521);
    for _ in 0..60 {
        let mesh = soup(&mut numbers);
        let mesh = Arc::new(Geometry::mesh(&mesh.0, &mesh.1).expect("a soup"));
        let ball = Arc::new(convex(&mut numbers));
        let inner = Geometry::compound(vec![part(&ball, place(&mut numbers, 1.0))]).expect("inner");
        let parts = vec![part(&mesh, place(&mut numbers, 1.0)), part(&Arc::new(inner), place(&mut numbers, 1.0))];
        let compound = Geometry::compound(parts).expect("a compound");
        let (here, form) = (place(&mut numbers, 4.0), convex(&mut numbers));
        let there = Pose::new(here.position + numbers.shares() * 3.0, rotation(&mut numbers));
        let factor = 16.0;
        let ask = |compound: &Geometry, form: &Geometry, scale: f64| {
            let larger = |pose: Pose| Pose::new(pose.position * scale, pose.rotation);
            let found = distance(at(form, larger(there)), at(compound, larger(here)), 1e9, &EXACT, &mut work());
            let found = found.expect("no limit");
            [found.distance, found.certificate.bound.lower, found.certificate.bound.upper].map(|value| value / scale)
        };
        let larger = compound.clone().scaled(factor).expect("larger");
        let larger_form = form.clone().scaled(factor).expect("larger");
        assert_eq!(ask(&compound, &form, 1.0), ask(&larger, &larger_form, factor));
    }
}

#[test]
fn against_a_half_space_each_part_counts() {
    let mut numbers = Numbers::new(523);
    let mut tally = Tally::default();
    for round in 0..300 {
        let (points, indices) = soup(&mut numbers);
        let shift = DVec3::from_array(numbers.vector(4).map(|part| part as f64 / 8.0));
        let mesh = Arc::new(Geometry::mesh(&points, &indices).expect("a soup"));
        let compound = Geometry::compound(vec![part(&mesh, Pose::at(shift))]).expect("a compound");
        let moved: Vec<DVec3> = points.iter().map(|&point| point + shift).collect();
        let merged = Geometry::mesh(&moved, &indices).expect("a mesh");
        let here = Pose::new(numbers.shares() * far(round), rotation(&mut numbers));
        let floor = Geometry::half_space(numbers.shares(), numbers.share() * 0.5).expect("a half space");
        let below = here.position + numbers.shares() * 3.0;
        let asker = at(&floor, Pose::new(below, rotation(&mut numbers)));
        let twins = Twins { one: at(&compound, here), other: at(&merged, here), asker };
        let motion = motion_towards(&mut numbers, below, below, 0.8);
        twins.check(&motion, &mut tally, &|| format!("round {round}"));
        let hollow = distance(at(&floor, asker.pose), at(&compound, here), 0.0, &EXACT, &mut work());
        assert!(hollow.is_none_or(|found| found.feature_b.part == Some(0)));
        tally.rays += u32::from(round % 2 == 0);
    }
    tally.assert_not_vacuous(1e-10);
}

#[test]
fn nothing_is_built_before_it_is_asked_and_parts_are_shared() {
    let mut numbers = Numbers::new(541);
    let (points, indices) = soup(&mut numbers);
    let mesh = Arc::new(Geometry::mesh(&points, &indices).expect("a soup"));
    let parts: Vec<Part> = (0..1000).map(|x| part(&mesh, Pose::at(DVec3::X * f64::from(x)))).collect();
    let compound = Geometry::compound(parts).expect("a compound");
    let Form::Compound(inside) = compound.form() else { panic!("a compound") };
    let Form::Mesh(triangles) = mesh.form() else { panic!("a mesh") };
    assert!(inside.built_tree().is_none() && triangles.built_tree().is_none());
    let before = compound.memory_bytes();
    assert!(before < mesh.memory_bytes() + 1000 * 150, "each part costs its place: {before}");
    let ray = ray_towards(&mut numbers, DVec3::X * 500.0, 0.1);
    let aside = collision::narrow::Ray { origin: DVec3::Y * 90.0, direction: DVec3::Y, ..ray };
    raycast(&aside, at(&compound, Pose::IDENTITY), &EXACT, &mut work());
    assert!(triangles.built_tree().is_none(), "no part was near");
    raycast(&ray, at(&compound, Pose::IDENTITY), &EXACT, &mut work());
    assert!(inside.built_tree().is_some() && triangles.built_tree().is_some());
    let larger = compound.clone().scaled(2.0).expect("larger");
    let Form::Compound(larger) = larger.form() else { panic!("a compound") };
    assert!(larger.parts().iter().all(|part| Arc::ptr_eq(&part.geometry, &larger.parts()[0].geometry)));
}

#[test]
fn refusals_name_the_part() {
    let ball = Arc::new(Geometry::sphere(1.0).expect("a ball"));
    let floor = Arc::new(Geometry::half_space(DVec3::Y, 0.0).expect("a half space"));
    let field = |parts: Vec<Part>| match Geometry::compound(parts) {
        Err(
            GeometryError::Bad { field, .. }
            | GeometryError::NotFinite { field, .. }
            | GeometryError::OutOfLimits { field, .. }
            | GeometryError::TooMany { field, .. },
        ) => field,
        other => panic!("{other:?}"),
    };
    let here = |geometry: &Arc<Geometry>| part(geometry, Pose::IDENTITY);
    assert_eq!(field(vec![]), "parts");
    assert_eq!(field(vec![here(&ball), here(&floor)]), "parts[1].geometry");
    let nowhere = part(&ball, Pose::at(DVec3::new(0.0, f64::NAN, 0.0)));
    assert_eq!(field(vec![here(&ball), nowhere]), "parts[1].pose.position.y");
    let unturnable = part(&ball, Pose::new(DVec3::ZERO, collision::DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0)));
    assert_eq!(field(vec![unturnable]), "parts[0].pose.rotation");
    let mut deep = Arc::clone(&ball);
    for _ in 0..Limits::COMPOUND_DEPTH {
        deep = Arc::new(Geometry::compound(vec![here(&deep)]).expect("not too deep"));
    }
    assert_eq!(field(vec![here(&ball), here(&deep)]), "parts[1].geometry");
    let many = Arc::new(Geometry::compound(vec![here(&ball); 1 << 15]).expect("many"));
    assert!(Geometry::compound(vec![here(&many), here(&many)]).is_ok());
    assert_eq!(field(vec![here(&many), here(&many), here(&ball)]), "parts[2]");
}
