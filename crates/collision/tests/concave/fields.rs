//! Laws of height fields: they answer as the mesh of their skin does, and have an inside besides.

use std::sync::Arc;

use collision::{
    DVec3,
    answer::{Feature, Verdict},
    broad::{ALL_LAYERS, Tree},
    math::{Aabb, Pose},
    narrow::{Faces, InitialTouch, Motion, Ray, distance, impact, overlap, penetration, raycast},
    shape::{Form, Geometry, GeometryError, HeightField, Part, Terrain},
};

use crate::{
    agree::{EXACT, Tally, Twins, at, convex, motion_towards, ray_towards, rotation, work},
    terrain::{Land, contains},
    whole::Numbers,
};

fn inside_of(geometry: &Geometry) -> &HeightField {
    let Form::HeightField(field) = geometry.form() else { panic!("a height field") };
    field
}

/// A point of the terrain's own frame near its surface.
fn near_surface(numbers: &mut Numbers, land: &Land, spread: f64) -> DVec3 {
    let (column, row) = (numbers.below(land.columns as i128) as usize, numbers.below(land.rows as i128) as usize);
    land.sample(column, row) + numbers.shares() * spread
}

#[test]
fn a_field_answers_as_the_mesh_of_its_skin_and_what_is_in_it_touches_it() {
    let mut numbers = Numbers::new(601);
    let (mut tally, mut buried) = (Tally::default(), 0);
    for round in 0..700 {
        let land = Land::random(&mut numbers);
        let (field, mesh) = (land.field(), land.mesh());
        let here = Pose::new(numbers.shares() * [0.0, 1e3, 1e6][round % 3], rotation(&mut numbers));
        let form = convex(&mut numbers);
        let deeper = if round % 4 == 0 { DVec3::Y } else { DVec3::ZERO };
        let local = near_surface(&mut numbers, &land, 0.8) - deeper;
        let there = here.transform_point(local);
        let asker = at(&form, Pose::new(there, rotation(&mut numbers)));
        let twins = Twins { one: at(&field, here), other: at(&mesh, here), asker };
        let context =
            || format!("round {round}: {:?} {:?} {here:?} {form:?} {:?}", land.heights, land.holes, asker.pose);
        let motion = motion_towards(&mut numbers, there, there, 0.7);
        let skin = overlap(asker, twins.other, &EXACT, &mut work()).verdict;
        // The local origin is a point of each form here.
        let is_in = contains(&mesh, local) == Some(true);
        if skin == Verdict::Miss && is_in {
            buried += 1;
            check_buried(&twins, &context);
        } else if skin != Verdict::Miss || !is_in {
            twins.check_but_contacts(&motion, &mut tally, &context);
        }
        let ray = ray_towards(&mut numbers, there, 0.5);
        twins.check_ray(&Ray { hollow: true, ..ray }, &mut tally, &context);
    }
    assert!(buried > 40, "{buried}");
    tally.contacts += buried;
    tally.assert_not_vacuous(1e-10);
}

/// What touches no skin and lies inside.
fn check_buried(twins: &Twins<'_>, context: &dyn Fn() -> String) {
    let (field, asker) = (twins.one, twins.asker);
    for (a, b) in [(field, asker), (asker, field)] {
        assert_eq!(overlap(a, b, &EXACT, &mut work()).verdict, Verdict::Hit, "{}", context());
        let found = distance(a, b, 0.0, &EXACT, &mut work()).unwrap_or_else(|| panic!("{}", context()));
        assert_eq!((found.distance, found.certificate.verdict), (0.0, Verdict::Hit), "{}", context());
    }
    let contacts = penetration(asker, field, 0.0, &EXACT, &mut work()).expect("a body");
    assert_eq!(contacts.len(), 1, "{}", context());
    assert_eq!(contacts[0].certificate.verdict, Verdict::Hit, "{}", context());
    let up = field.pose.matrix() * DVec3::Y;
    assert!(contacts[0].depth > 0.0 && contacts[0].normal_b_to_a.dot(up) > 0.0, "{contacts:?} {}", context());
    let away = Motion { displacement_a: up * 50.0, ..Motion::default() };
    let touch = impact(asker, field, &away, &EXACT, &mut work()).unwrap_or_else(|| panic!("{}", context()));
    assert!(touch.initial && touch.fraction == 0.0 && touch.normal_b_to_a.is_none(), "{touch:?} {}", context());
    let ignored = Motion { initial: InitialTouch::IsIgnored, ..away };
    let touch = impact(asker, field, &ignored, &EXACT, &mut work());
    assert!(touch.is_none(), "it goes up and out: {touch:?} {}", context());
}

#[test]
fn contacts_lead_out_of_the_terrain() {
    let mut numbers = Numbers::new(607);
    let (mut found, mut turned) = (0, 0);
    for round in 0..300 {
        let land = Land::random(&mut numbers);
        let (field, mesh) = (land.field(), land.mesh());
        let here = Pose::new(numbers.shares() * 9.0, rotation(&mut numbers));
        let form = convex(&mut numbers);
        let there = here.transform_point(near_surface(&mut numbers, &land, 0.3));
        let asker = at(&form, Pose::new(there, rotation(&mut numbers)));
        let contacts = penetration(asker, at(&field, here), 0.0, &EXACT, &mut work()).expect("a body");
        let of_mesh = penetration(asker, at(&mesh, here), 0.0, &EXACT, &mut work()).expect("one surface");
        let touched = of_mesh.iter().filter(|contact| contact.certificate.verdict == Verdict::Hit).count();
        let skin = land.skin();
        let pieces: Vec<Feature> = contacts.iter().map(|contact| contact.feature_b).collect();
        assert!(pieces.is_sorted() && contacts.len() >= touched, "round {round}");
        for contact in &contacts {
            let cell = contact.feature_b.face.expect("a cell");
            let corners = skin.iter().filter(|(of, _)| *of == cell).map(|(_, corners)| *corners);
            let apart =
                Pose::new(asker.pose.position + contact.normal_b_to_a * (contact.depth + 1e-9), asker.pose.rotation);
            let is_parted = corners.clone().any(|corners| {
                let outward = here.matrix() * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                let alone = Geometry::mesh(&corners, &[[0, 1, 2]]).expect("a triangle");
                let clear = overlap(at(&form, apart), at(&alone, here), &EXACT, &mut work()).verdict == Verdict::Miss;
                clear && contact.normal_b_to_a.dot(outward.normalize()) >= -1e-12
            });
            assert!(is_parted, "round {round}: {contact:?}");
            found += 1;
        }
        let against =
            of_mesh.iter().zip(&contacts).filter(|(of_mesh, contact)| of_mesh.normal_b_to_a != contact.normal_b_to_a);
        turned += against.count();
    }
    assert!(found > 500 && turned > 50, "{found} contacts, {turned} turned round");
}

#[test]
fn a_ray_that_begins_in_matter_begins_inside() {
    let mut numbers = Numbers::new(613);
    let mut tally = Tally::default();
    let (mut inside, mut outside) = (0, 0);
    for round in 0..800 {
        let land = Land::random(&mut numbers);
        let (field, mesh) = (land.field(), land.mesh());
        let here = Pose::new(numbers.shares() * [0.0, 1e3, 1e6][round % 3], rotation(&mut numbers));
        let local = near_surface(&mut numbers, &land, 0.3);
        let origin = here.transform_point(local);
        let direction = numbers.shares();
        let faces = [Faces::Both, Faces::Both, Faces::Front, Faces::Back][round % 4];
        let ray = Ray { origin, direction, min_distance: 0.0, max_distance: 1e9, hollow: false, faces };
        let twins = Twins { one: at(&field, here), other: at(&mesh, here), asker: at(&field, here) };
        let touches = raycast(&ray, twins.one, &EXACT, &mut work());
        match (contains(&mesh, local), faces) {
            (Some(true), Faces::Both) if touches.undecided.is_none() => {
                let touch = touches.certain.expect("inside");
                assert!(touch.inside && touch.distance == 0.0 && touch.normal.is_none(), "round {round}: {touch:?}");
                inside += 1;
            }
            _ => {
                outside += 1;
                twins.check_ray(&ray, &mut tally, &|| {
                    format!("round {round}: {:?} {:?} {here:?}", land.heights, land.holes)
                });
            }
        }
        if let Some(touch) = touches.certain.filter(|touch| !touch.inside) {
            let cell = touch.feature.face.expect("a cell");
            assert!(!land.holes.contains(&cell) && touch.barycentric.is_none(), "round {round}: {touch:?}");
        }
    }
    assert!(inside > 100 && outside > 300 && tally.rays > 100, "{inside} inside, {outside} outside, {tally:?}");
}

#[test]
fn against_a_half_space_and_in_a_compound_it_is_its_skin() {
    let mut numbers = Numbers::new(617);
    let mut tally = Tally::default();
    for round in 0..200 {
        let land = Land::random(&mut numbers);
        let (field, mesh) = (land.field(), land.mesh());
        let here = Pose::new(numbers.shares() * [0.0, 1e3, 1e6][round % 3], rotation(&mut numbers));
        let context = || format!("round {round}: {:?} {:?} {here:?}", land.heights, land.holes);
        let floor = Geometry::half_space(numbers.shares(), 0.0).expect("a half space");
        let middle = field.local_bounds().center();
        let below = here.transform_point(middle) + numbers.shares() * 3.5;
        let asker = at(&floor, Pose::new(below, rotation(&mut numbers)));
        let motion = motion_towards(&mut numbers, below, below, 0.7);
        Twins { one: at(&field, here), other: at(&mesh, here), asker }.check(&motion, &mut tally, &context);
        let part = Part { geometry: Arc::new(field.clone()), pose: Pose::at(DVec3::new(0.5, -2.0, 8.0)) };
        let compound = Geometry::compound(vec![part]).expect("a compound");
        let moved = here.transform_point(DVec3::new(0.5, -2.0, 8.0));
        let form = convex(&mut numbers);
        let there = moved + here.matrix() * near_surface(&mut numbers, &land, 0.4);
        let asker = at(&form, Pose::new(there, rotation(&mut numbers)));
        let plain = Pose::new(moved, here.rotation);
        let found = overlap(asker, at(&compound, here), &EXACT, &mut work()).verdict;
        let expected = overlap(asker, at(&field, plain), &EXACT, &mut work()).verdict;
        assert!(found == expected || found == Verdict::Undecided || expected == Verdict::Undecided, "{}", context());
        let ray = ray_towards(&mut numbers, there, 0.5);
        tally.rays += u32::from(round % 2 == 0);
        let [found, expected] =
            [at(&compound, here), at(&field, plain)].map(|form| raycast(&ray, form, &EXACT, &mut work()));
        let far =
            |touches: collision::narrow::RayTouches| touches.certain.map_or(f64::INFINITY, |touch| touch.distance);
        let (a, b) = (far(found), far(expected));
        assert!(
            a.to_bits() == b.to_bits() || (a - b).abs() < 1e-9 || found.undecided.is_some(),
            "{a} {b} {}",
            context()
        );
    }
    tally.assert_not_vacuous(1e-10);
}

/// Two terrains, and a terrain and a mesh: what touches by the skins touches, what is apart is as far as the skins, and
/// what is within the other touches too.
#[test]
fn pairs_of_concave_forms() {
    let mut numbers = Numbers::new(619);
    let (mut hits, mut misses, mut within) = (0, 0, 0);
    for round in 0..300 {
        let lands = [(); 2].map(|()| Land::random(&mut numbers));
        let [one, other] = [0, 1].map(|index| lands[index].field());
        let skins = [0, 1].map(|index| lands[index].mesh());
        let here = Pose::new(numbers.shares() * 9.0, rotation(&mut numbers));
        let small = if round % 3 == 0 { 1.0 / 16.0 } else { 1.0 };
        let (other, skin) = (other.scaled(small).expect("smaller"), skins[1].clone().scaled(small).expect("smaller"));
        let spread = if round % 3 == 0 { 0.6 } else { 2.5 };
        let place = here.transform_point(one.local_bounds().center()) + numbers.shares() * spread;
        let there = Pose::new(place, rotation(&mut numbers));
        let by_skin = overlap(at(&skins[0], here), at(&skin, there), &EXACT, &mut work()).verdict;
        for (second, ..) in [(&other, 0), (&skin, 1)] {
            let found = overlap(at(&one, here), at(second, there), &EXACT, &mut work());
            let back = overlap(at(second, there), at(&one, here), &EXACT, &mut work());
            assert_eq!(found.verdict, back.verdict, "round {round}");
            let apart = distance(at(&one, here), at(second, there), 1e9, &EXACT, &mut work()).expect("no limit");
            match (found.verdict, by_skin) {
                (Verdict::Miss, _) => {
                    misses += 1;
                    let skins =
                        distance(at(&skins[0], here), at(&skin, there), 1e9, &EXACT, &mut work()).expect("no limit");
                    assert!(
                        by_skin != Verdict::Hit && (apart.distance - skins.distance).abs() < 1e-12,
                        "round {round}"
                    );
                }
                (Verdict::Hit, Verdict::Miss) => {
                    within += 1;
                    assert_eq!(apart.distance, 0.0, "round {round}");
                }
                (Verdict::Hit, _) => hits += 1,
                (Verdict::Undecided, _) => {}
            }
            assert!(penetration(at(&one, here), at(second, there), 0.0, &EXACT, &mut work()).is_ok());
        }
    }
    assert!(hits > 100 && misses > 100 && within > 20, "{hits} hits, {misses} misses, {within} within");
}

#[test]
fn the_tree_offers_what_touches_a_box_and_the_nearest_first() {
    let mut numbers = Numbers::new(631);
    for _ in 0..100 {
        let land = Land::random(&mut numbers);
        let field = land.field();
        let skin = land.skin();
        let middle = near_surface(&mut numbers, &land, 0.5);
        let half = numbers.shares().abs() * 0.5;
        let query = Aabb::new(middle - half, middle + half);
        let boxes = skin.iter().map(|(_, [a, b, c])| Aabb::new(a.min(*b).min(*c), a.max(*b).max(*c)));
        let mut found = 0;
        let Ok(()) = inside_of(&field).visit_box(query, ALL_LAYERS, &mut work(), |_, _| {
            found += 1;
            Ok::<_, std::convert::Infallible>(std::ops::ControlFlow::Continue(()))
        });
        assert_eq!(found, boxes.clone().filter(|bounds| bounds.intersects(query)).count());
        let mut pairs = 0;
        let Ok(()) = inside_of(&field).visit_pairs(&mut work(), |_, _, _| {
            pairs += 1;
            Ok::<_, std::convert::Infallible>(())
        });
        let all: Vec<Aabb> = boxes.collect();
        let expected = (0..all.len()).map(|at| all[at + 1..].iter().filter(|other| other.intersects(all[at])).count());
        assert_eq!(pairs, expected.sum::<usize>());
        assert_eq!(inside_of(&field).bounds(), Some(field.local_bounds()));
    }
}

#[test]
fn a_million_cells_store_no_triangle_and_build_nothing_before_they_are_asked() {
    let side = 1_001_usize;
    let heights: Vec<f32> = (0..side * side).map(|index| (index % 97) as f32 * 0.1).collect();
    let terrain = Terrain { columns: side, rows: side, heights: &heights, spacing: DVec3::ONE, holes: &[500_500] };
    let field = Geometry::height_field(&terrain).expect("a terrain");
    let bytes = 4 * (side * side) as u64;
    assert!(field.memory_bytes() < bytes + bytes / 16, "{} for {bytes} of heights", field.memory_bytes());
    assert_eq!(field.structures_built(), []);
    let larger = field.clone().scaled(2.0).expect("larger");
    assert_eq!(inside_of(&larger).heights().as_ptr(), inside_of(&field).heights().as_ptr(), "shared");
    let down = |x: f64, z: f64| Ray {
        origin: DVec3::new(x, 99.0, z),
        direction: -DVec3::Y,
        min_distance: 0.0,
        max_distance: 1e3,
        hollow: false,
        faces: Faces::Both,
    };
    let mut cost = work();
    let touch = raycast(&down(250.25, 250.5), at(&field, Pose::IDENTITY), &EXACT, &mut cost).certain.expect("a hit");
    assert_eq!(touch.feature.face, Some(250 * 1000 + 250));
    assert!(cost.nodes_visited < 60 && cost.pairs_tested < 40, "{cost:?}");
    let built = field.structures_built().first().expect("the pyramid").memory_bytes;
    assert!(built < bytes / 4, "{built}");
    assert!(raycast(&down(500.5, 500.5), at(&field, Pose::IDENTITY), &EXACT, &mut work()).certain.is_none(), "a hole");
}

#[test]
fn a_ball_that_stands_on_flat_ground_touches_it_exactly() {
    let terrain = Terrain { columns: 3, rows: 3, heights: &[0.5; 9], spacing: DVec3::new(4.0, 2.0, 4.0), holes: &[3] };
    let field = Geometry::height_field(&terrain).expect("flat");
    let ball = Geometry::sphere(1.0).expect("a ball");
    let at_height = |y: f64| {
        distance(at(&ball, Pose::at(DVec3::new(1.0, y, 2.0))), at(&field, Pose::IDENTITY), 9.0, &EXACT, &mut work())
    };
    assert!((at_height(4.0).expect("near").distance - 2.0).abs() < 1e-14);
    assert!(at_height(2.0).expect("near").certificate.bound.contains(0.0));
    assert_eq!(at_height(-3.0).expect("in it").distance, 0.0);
    assert_eq!(inside_of(&field).floor(), 1.0 - 8.0);
    let in_hole = at(&ball, Pose::at(DVec3::new(6.0, 0.5, 6.0)));
    let found = distance(in_hole, at(&field, Pose::IDENTITY), 9.0, &EXACT, &mut work()).expect("near");
    assert!((found.distance - 1.0).abs() < 1e-14, "the walls of the hole are 2 m away: {found:?}");
}

#[test]
fn refusals_name_the_number() {
    let flat = [0.0_f32; 6];
    let fine = Terrain { columns: 2, rows: 3, heights: &flat, spacing: DVec3::ONE, holes: &[] };
    assert!(Geometry::height_field(&fine).is_ok());
    let field = |terrain: &Terrain<'_>| match Geometry::height_field(terrain) {
        Err(
            GeometryError::Bad { field, .. }
            | GeometryError::NotFinite { field, .. }
            | GeometryError::OutOfLimits { field, .. }
            | GeometryError::ColumnLength { field, .. }
            | GeometryError::TooMany { field, .. }
            | GeometryError::NotSolid { field, .. },
        ) => field,
        Ok(_) => panic!("{terrain:?}"),
    };
    assert_eq!(field(&Terrain { columns: 1, ..fine }), "columns");
    assert_eq!(field(&Terrain { rows: 0, ..fine }), "rows");
    assert_eq!(field(&Terrain { rows: usize::MAX, ..fine }), "heights");
    assert_eq!(field(&Terrain { columns: 3, ..fine }), "heights");
    assert_eq!(field(&Terrain { heights: &[0.0, 0.0, f32::NAN, 0.0, 0.0, 0.0], ..fine }), "heights[2]");
    assert_eq!(field(&Terrain { heights: &[f32::MAX; 6], ..fine }), "heights");
    assert_eq!(field(&Terrain { spacing: DVec3::new(1.0, 1.0, -1.0), ..fine }), "spacing.z");
    assert_eq!(field(&Terrain { holes: &[0, 2], ..fine }), "holes[1]");
    assert_eq!(field(&Terrain { holes: &[0, 1], ..fine }), "holes");
    let one = Geometry::height_field(&Terrain { holes: &[1, 1], ..fine }).expect("one cell");
    assert_eq!(one.id(), Geometry::height_field(&Terrain { holes: &[1], ..fine }).expect("the same").id());
}
