//! Laws that rays obey whatever they hit: the point lies on ray and surface, motion and scale change nothing, limits are
//! kept, walls come in order, and round bodies lie between hulls.

mod whole;

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Verdict, Work},
    math::Pose,
    narrow::{Faces, Placed, Ray, RayTouch, RayTouches, distance, raycast},
    shape::{Geometry, GeometryError, Hull},
};
use whole::Numbers;

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

fn at(geometry: &Geometry, pose: Pose) -> Placed<'_> {
    Placed { geometry, pose }
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, min_distance: 0.0, max_distance: 1e18, hollow: false, faces: Faces::Both }
}

fn cast(ray: &Ray, target: Placed<'_>) -> RayTouches {
    raycast(ray, target, &EXACT, &mut Work::default())
}

/// One of each kind of form, of a size of about 1, rounded ones and flat ones among them.
fn forms(numbers: &mut Numbers) -> Vec<(&'static str, Geometry)> {
    let size = |numbers: &mut Numbers| 0.2 + 0.8 * numbers.share().abs();
    let points: Vec<DVec3> = (0..12).map(|_| numbers.shares()).collect();
    let flat: Vec<DVec3> = points.iter().map(|point| DVec3::new(point.x, point.y, 0.25)).collect();
    let half = DVec3::new(size(numbers), size(numbers), size(numbers));
    let forms = [
        ("ball", Geometry::sphere(size(numbers))),
        ("capsule", Geometry::capsule(size(numbers), size(numbers))),
        ("box", Geometry::cuboid(half)),
        ("rounded box", Geometry::cuboid(half).and_then(|form| form.rounded(0.3))),
        ("plate", Geometry::cuboid(DVec3::new(half.x, 0.0, half.z))),
        ("rounded plate", Geometry::cuboid(DVec3::new(half.x, 0.0, half.z)).and_then(|form| form.rounded(0.1))),
        ("rounded stick", Geometry::cuboid(DVec3::new(half.x, 0.0, 0.0)).and_then(|form| form.rounded(0.4))),
        ("hull", Geometry::hull(&points)),
        ("rounded hull", Geometry::hull(&points).and_then(|form| form.rounded(0.2))),
        ("flat hull", Geometry::hull(&flat)),
        ("rounded flat hull", Geometry::hull(&flat).and_then(|form| form.rounded(0.2))),
        ("rounded straight hull", Geometry::hull(&points[..2]).and_then(|form| form.rounded(0.4))),
        ("rounded point hull", Geometry::hull(&points[..1]).and_then(|form| form.rounded(0.5))),
        ("cylinder", Geometry::cylinder(half.x, half.y)),
        ("cone", Geometry::cone(half.x, half.y)),
        ("ellipsoid", Geometry::ellipsoid(half)),
        ("rounded cylinder", Geometry::cylinder(half.x, half.y).and_then(|form| form.rounded(0.2))),
        ("rounded cone", Geometry::cone(half.x, half.y).and_then(|form| form.rounded(0.2))),
        ("rounded ellipsoid", Geometry::ellipsoid(half).and_then(|form| form.rounded(0.2))),
        ("mesh", Geometry::mesh(&points, &[[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11], [0, 5, 10]])),
    ];
    forms.map(|(name, form)| (name, form.expect(name))).into_iter().collect()
}

fn pose(numbers: &mut Numbers, far: f64) -> Pose {
    let [x, y, z, w] = [0; 4].map(|_| numbers.share());
    Pose::new(numbers.shares() * far, DQuat::from_xyzw(x, y, z, w))
}

/// How far a point is from a placed form.
fn gap(target: Placed<'_>, point: DVec3) -> f64 {
    let probe = Geometry::point();
    let found = distance(at(&probe, Pose::at(point)), target, f64::INFINITY, &EXACT, &mut Work::default());
    found.expect("no limit").distance
}

/// Every touch lies on the surface and on the ray, the way to it is free, and where there is none the whole way is.
#[test]
fn the_touch_is_on_the_surface_and_the_way_to_it_is_free() {
    let mut numbers = Numbers::new(31);
    let mut counts = std::collections::BTreeMap::<&str, [u32; 3]>::new();
    for round in 0..160 {
        let far = [1.0, 1.0, 1e3, 1e6][round % 4];
        let away = [3.0, 30.0, 3e3, 1e6][round / 4 % 4];
        for (name, form) in forms(&mut numbers) {
            let pose = pose(&mut numbers, far);
            let target = at(&form, pose);
            let origin = pose.position + numbers.shares() * away;
            let aim = pose.position + numbers.shares() * 0.9;
            let ray = ray(origin, (aim - origin) * 0.37);
            let touches = cast(&ray, target);
            let size = away + far + 4.0;
            let unit = ray.direction.normalize();
            let count = counts.entry(name).or_default();
            let free_until = match (touches.certain, touches.undecided) {
                (Some(touch), _) => {
                    count[0] += 1;
                    let off = gap(target, touch.point);
                    assert!(off <= 1e-13 * size, "{name}: {off} off the surface, {ray:?}, {pose:?}: {touch:?}");
                    let along = origin + unit * touch.distance;
                    assert!((along - touch.point).length() <= 1e-13 * size, "{name}: off the ray: {touch:?}");
                    assert!(touch.certificate.bound.contains(touch.distance), "{name}: {touch:?}");
                    assert!(touch.inside == touch.normal.is_none(), "{name}: {touch:?}");
                    assert!(touch.normal.is_none_or(|normal| normal.dot(unit) < 1e-9), "{name}: {touch:?}");
                    touch.certificate.bound.lower
                }
                (None, Some(open)) => {
                    count[2] += 1;
                    open.certificate.bound.lower
                }
                (None, None) => {
                    count[1] += 1;
                    2.0 * size
                }
            };
            // A form of a size below 4, so that a hundred steps around the nearest point see it.
            let nearest = (pose.position - origin).dot(unit);
            for step in -50..50 {
                let way = nearest + f64::from(step) / 25.0;
                if way > 0.0 && way < free_until - 1e-12 * size {
                    assert!(
                        gap(target, origin + unit * way) > 0.0,
                        "{name}: met at {way}: {ray:?}, {pose:?}: {touches:?}"
                    );
                }
            }
        }
    }
    for (name, [hits, misses, open]) in counts {
        let part = f64::from(hits) / f64::from(hits + misses + open);
        assert!((0.1..0.95).contains(&part) && open * 100 <= hits, "{name}: {hits} hits, {misses} misses, {open} open");
    }
}

fn assert_same_bits(name: &str, a: Option<RayTouch>, b: Option<RayTouch>, scale: f64) {
    let Some((a, b)) = a.zip(b) else {
        assert_eq!(a.is_some(), b.is_some(), "{name}");
        return;
    };
    assert_eq!(a.certificate.verdict, b.certificate.verdict, "{name}");
    assert_eq!((a.distance * scale).to_bits(), b.distance.to_bits(), "{name}");
    assert_eq!(a.point * scale, b.point, "{name}");
    assert_eq!((a.normal, a.inside, a.feature), (b.normal, b.inside, b.feature), "{name}");
    let (inner, outer) = (a.certificate.bound, b.certificate.bound);
    assert_eq!((inner.lower * scale, inner.upper * scale), (outer.lower, outer.upper), "{name}");
}

#[test]
fn scaling_by_a_power_of_two_changes_no_other_bit() {
    let mut numbers = Numbers::new(41);
    for _ in 0..300 {
        for (name, form) in forms(&mut numbers) {
            let scale = [2.0_f64.powi(-19), 2.0_f64.powi(19)][numbers.below(2) as usize];
            let here = pose(&mut numbers, 10.0);
            let there = Pose::new(here.position * scale, here.rotation);
            let larger = form.clone().scaled(scale).expect("within the limits");
            let origin = numbers.shares() * 20.0;
            let direction = here.position + numbers.shares() - origin;
            let a = cast(&ray(origin, direction), at(&form, here));
            let b = cast(&ray(origin * scale, direction), at(&larger, there));
            assert_same_bits(name, a.certain, b.certain, scale);
            assert_same_bits(name, a.undecided, b.undecided, scale);
        }
    }
}

#[test]
fn the_length_of_the_direction_and_of_the_quaternion_do_not_matter() {
    let mut numbers = Numbers::new(43);
    for _ in 0..300 {
        for (name, form) in forms(&mut numbers) {
            let here = pose(&mut numbers, 10.0);
            let origin = numbers.shares() * 20.0;
            let direction = here.position + numbers.shares() - origin;
            let a = cast(&ray(origin, direction), at(&form, here));
            for length in [2.0_f64.powi(-900), 2.0_f64.powi(900)] {
                let there = Pose::new(here.position, here.rotation * (1.0 / 1024.0));
                let b = cast(&ray(origin, direction * length), at(&form, there));
                assert_same_bits(name, a.certain, b.certain, 1.0);
                assert_same_bits(name, a.undecided, b.undecided, 1.0);
            }
        }
    }
}

#[test]
fn a_rigid_motion_of_everything_keeps_the_answer_within_its_bounds() {
    let mut numbers = Numbers::new(47);
    for _ in 0..300 {
        for (name, form) in forms(&mut numbers) {
            let here = pose(&mut numbers, 10.0);
            let origin = numbers.shares() * 20.0;
            let direction = here.position + numbers.shares() - origin;
            let motion = pose(&mut numbers, 100.0);
            let moved = Pose::new(motion.transform_point(here.position), motion.unit_rotation() * here.unit_rotation());
            let a = cast(&ray(origin, direction), at(&form, here));
            let b = cast(&ray(motion.transform_point(origin), motion.matrix() * direction), at(&form, moved));
            // The moved numbers are rounded, so intervals may differ by that, and by more where the ray grazes.
            if let (Some(a), Some(b)) = (a.certain, b.certain)
                && let Some((normal, _)) = a.normal.zip(b.normal)
            {
                let incidence = normal.dot(direction.normalize()).abs();
                let apart = (a.distance - b.distance).abs();
                assert!(apart <= 1e-12 / incidence.max(1e-6).powi(2), "{name}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn winding_and_order_of_triangles_do_not_matter() {
    let mut numbers = Numbers::new(53);
    let mut hits = 0;
    for round in 0..2_000 {
        let points: Vec<DVec3> = (0..8).map(|_| numbers.shares()).collect();
        let triangles = [[0, 1, 2], [2, 1, 3], [3, 4, 5], [5, 4, 6], [6, 7, 0]];
        let reversed = triangles.map(|[a, b, c]| [a, c, b]);
        let here = if round % 2 == 0 { Pose::at(numbers.shares()) } else { pose(&mut numbers, 1.0) };
        let origin = numbers.shares() * 10.0;
        let aim = points[round % 8] * numbers.share();
        let ray = ray(origin, here.transform_point(aim) - origin);
        let touches = [triangles, reversed].map(|triangles| {
            let mesh = Geometry::mesh(&points, &triangles).expect("a mesh");
            cast(&ray, at(&mesh, here))
        });
        hits += u32::from(touches[0].certain.is_some());
        assert_same_bits("reversed", touches[0].certain, touches[1].certain, 1.0);
        assert_same_bits("reversed", touches[0].undecided, touches[1].undecided, 1.0);
    }
    assert!((600..1_400).contains(&hits), "{hits} hits");
}

#[test]
fn limits_are_kept_and_walls_come_in_order() {
    let ball = Geometry::sphere(1.0).expect("a ball");
    let cuboid = Geometry::cuboid(DVec3::ONE).expect("a box");
    let rounded = Geometry::cuboid(DVec3::splat(0.5)).and_then(|form| form.rounded(0.5)).expect("a rounded box");
    for form in [&ball, &cuboid, &rounded] {
        let target = at(form, Pose::at(DVec3::new(5.0, 0.0, 0.0)));
        let from = |first: f64, last: f64, hollow: bool| Ray {
            min_distance: first,
            max_distance: last,
            hollow,
            ..ray(DVec3::ZERO, DVec3::X * 3.0)
        };
        let near = |touches: RayTouches, expected: f64| {
            let touch = touches.certain.expect("a hit");
            assert!(touches.undecided.is_none() && (touch.distance - expected).abs() < 1e-12, "{touches:?}");
            touch
        };
        let outside = near(cast(&from(0.0, 10.0, false), target), 4.0);
        assert!(!outside.inside && outside.normal.is_some_and(|normal| (normal + DVec3::X).length() < 1e-9));
        assert!(cast(&from(0.0, 3.9, false), target).certain.is_none());
        assert!(cast(&from(0.0, 3.9, false), target).undecided.is_none());
        let within_rounding = cast(&from(0.0, 4.0, true), target);
        let verdict = within_rounding.certain.or(within_rounding.undecided).map(|touch| touch.certificate.verdict);
        assert!(verdict.is_some_and(|verdict| verdict != Verdict::Miss));
        let inside = near(cast(&from(4.5, 10.0, false), target), 4.5);
        assert!(inside.inside && inside.normal.is_none());
        let far_wall = near(cast(&from(4.5, 10.0, true), target), 6.0);
        assert!(far_wall.normal.is_some_and(|normal| (normal + DVec3::X).length() < 1e-9), "towards the asker");
        assert!(cast(&from(4.5, 5.5, true), target).certain.is_none());
        let behind = Ray { direction: -DVec3::X, ..from(0.0, 10.0, false) };
        assert!(cast(&behind, target).certain.is_none() && cast(&behind, target).undecided.is_none());
    }
}

#[test]
fn sticks_and_points_are_never_surely_hit_nor_surely_missed_in_exact_incidence() {
    let stick = Geometry::capsule(1.0, 0.0).expect("a segment");
    let point = Geometry::point();
    let line = Geometry::hull(&[DVec3::ZERO, DVec3::Y]).expect("a segment");
    for form in [&stick, &point, &line] {
        let through = cast(&ray(DVec3::new(-3.0, 0.0, 0.0), DVec3::X), at(form, Pose::IDENTITY));
        let open = through.undecided.expect("exact incidence");
        assert!(through.certain.is_none() && open.certificate.bound.contains(3.0), "{open:?}");
        let beside = cast(&ray(DVec3::new(-3.0, 0.0, 1e-12), DVec3::X), at(form, Pose::IDENTITY));
        assert!(beside.certain.is_none() && beside.undecided.is_none());
    }
}

#[test]
fn a_ray_in_the_plane_of_a_triangle_passes_it_and_hits_what_stands_there() {
    let vertices = [
        DVec3::ZERO,
        DVec3::X,
        DVec3::Y,
        DVec3::new(0.5, 0.0, -1.0),
        DVec3::new(0.5, 0.0, 1.0),
        DVec3::new(0.5, 1.0, 0.0),
    ];
    let mesh = Geometry::mesh(&vertices, &[[0, 1, 2], [3, 4, 5]]).expect("a mesh");
    let flat = cast(&ray(DVec3::new(-1.0, 0.25, 0.0), DVec3::X), at(&mesh, Pose::IDENTITY));
    let touch = flat.certain.expect("the second triangle");
    assert_eq!((touch.distance, touch.feature.face, flat.undecided.is_none()), (1.5, Some(1), true));
    let alone = Geometry::mesh(&vertices[..3], &[[0, 1, 2]]).expect("a mesh");
    let flat = cast(&ray(DVec3::new(-1.0, 0.25, 0.0), DVec3::X), at(&alone, Pose::IDENTITY));
    assert!(flat.certain.is_none() && flat.undecided.is_none());
}

/// Hulls of points on the surface of a round body, and the same drawn around it.
fn brackets(numbers: &mut Numbers) -> Vec<(&'static str, [Result<Geometry, GeometryError>; 3])> {
    let half = DVec3::new(0.2 + numbers.share().abs(), 0.2 + numbers.share().abs(), 0.2 + numbers.share().abs());
    let around = |k: u32| f64::from(k) * std::f64::consts::TAU / 24.0;
    let ring = |radius: f64, y: f64| {
        (0..24).map(move |k| DVec3::new(around(k).cos() * radius, y, around(k).sin() * radius)).collect::<Vec<_>>()
    };
    let wider = half.x / (std::f64::consts::PI / 24.0).cos() * (1.0 + 1e-12);
    let narrower = half.x * (1.0 - 1e-12);
    let apex = [DVec3::Y * half.y];
    let ball: Vec<DVec3> = (0..200).map(|_| numbers.shares().normalize_or(DVec3::X)).collect();
    let unit = Hull::new(&ball);
    let least = unit.topology().faces.iter().map(|face| face.offset).fold(1.0, f64::min) * (1.0 - 1e-12);
    let scaled = |by: f64| ball.iter().map(|&point| point * half * by).collect::<Vec<_>>();
    let cylinder = |radius: f64| Geometry::hull(&[ring(radius, half.y), ring(radius, -half.y)].concat());
    let cone = |radius: f64| Geometry::hull(&[&ring(radius, -half.y)[..], &apex].concat());
    vec![
        ("cylinder", [cylinder(narrower), Geometry::cylinder(half.y, half.x), cylinder(wider)]),
        ("cone", [cone(narrower), Geometry::cone(half.y, half.x), cone(wider)]),
        (
            "ellipsoid",
            [Geometry::hull(&scaled(1.0 - 1e-12)), Geometry::ellipsoid(half), Geometry::hull(&scaled(1.0 / least))],
        ),
    ]
}

#[test]
fn a_round_body_is_met_between_a_hull_inside_and_one_around_it() {
    let mut numbers = Numbers::new(59);
    let mut hits = 0;
    for round in 0..500 {
        for (name, forms) in brackets(&mut numbers) {
            let radius = if round % 3 == 0 { 0.3 } else { 0.0 };
            let forms = forms.map(|form| form.and_then(|form| form.rounded(radius)).expect(name));
            let here = pose(&mut numbers, 10.0);
            let origin = here.position + numbers.shares() * 9.0;
            let asked = ray(origin, here.position + numbers.shares() * 1.2 - origin);
            let [inside, body, outside] = [0, 1, 2].map(|index| cast(&asked, at(&forms[index], here)));
            let bound = |touches: RayTouches| Some(touches.certain.or(touches.undecided)?.certificate.bound);
            if let Some(inside) = inside.certain {
                let found = bound(body).expect(name);
                assert!(found.lower <= inside.certificate.bound.upper, "{name}: {asked:?} {found:?} {inside:?}");
            }
            if let Some(body) = body.certain {
                hits += 1;
                let found = bound(outside).expect(name);
                assert!(found.lower <= body.certificate.bound.upper, "{name}: {asked:?} {found:?} {body:?}");
            }
        }
    }
    assert!((450..1_050).contains(&hits), "{hits} hits of 1500");
}
