//! Which sides of a surface count, and the weights of a triangle's corners where it is met.

mod whole;

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::Work,
    math::Pose,
    narrow::{Faces, Placed, Ray, RayTouches, raycast},
    shape::{Form, Geometry},
};
use whole::Numbers;

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, min_distance: 0.0, max_distance: 1e18, hollow: false, faces: Faces::Both }
}

fn cast(ray: &Ray, geometry: &Geometry, pose: Pose) -> RayTouches {
    raycast(ray, Placed { geometry, pose }, &Accuracy::default(), &mut Work::default())
}

fn pose(numbers: &mut Numbers) -> Pose {
    let [x, y, z, w] = [0; 4].map(|_| numbers.share());
    let rotation = if numbers.below(2) == 0 { DQuat::IDENTITY } else { DQuat::from_xyzw(x, y, z, w) };
    Pose::new(numbers.shares() * 10.0, rotation)
}

/// The surface of a hull as triangles, counter-clockwise from outside.
fn skin(hull: &Geometry) -> Geometry {
    let Form::Convex(convex) = hull.form() else { panic!("a hull") };
    let collision::shape::Core::Hull(hull) = &convex.core else { panic!("a hull") };
    let faces = hull.topology().faces.iter();
    let fan = |face: &collision::shape::Face| {
        let vertices = face.vertices.clone();
        (1..vertices.len() - 1).map(move |k| [vertices[0], vertices[k], vertices[k + 1]]).collect::<Vec<_>>()
    };
    Geometry::mesh(hull.vertices(), &faces.flat_map(fan).collect::<Vec<_>>()).expect("a mesh")
}

/// A closed mesh that is wound outwards and the body inside it agree on fronts and on backs, from outside and from within.
#[test]
fn a_body_and_its_skin_agree_on_fronts_and_backs() {
    let mut numbers = Numbers::new(71);
    let mut counts = [[0_u32; 2]; 2];
    for round in 0..2_000 {
        let points: Vec<DVec3> = (0..12).map(|_| numbers.shares()).collect();
        let hull = Geometry::hull(&points).expect("a hull");
        let mesh = skin(&hull);
        let pose = pose(&mut numbers);
        let away = if round % 2 == 0 { 5.0 } else { 0.3 };
        let origin = pose.position + numbers.shares() * away;
        let aim = pose.position + numbers.shares();
        for (index, faces) in [Faces::Front, Faces::Back].into_iter().enumerate() {
            let ray = Ray { faces, ..ray(origin, aim - origin) };
            let (body, surface) = (cast(&ray, &hull, pose).certain, cast(&ray, &mesh, pose).certain);
            assert_eq!(body.is_some(), surface.is_some(), "{ray:?} at {pose:?}: {body:?}, {surface:?}");
            counts[index][usize::from(body.is_some())] += 1;
            let Some((body, surface)) = body.zip(surface) else { continue };
            assert!((body.distance - surface.distance).abs() < 1e-13, "{body:?}, {surface:?}");
            assert!(!body.inside && body.normal.is_some_and(|normal| normal.dot(ray.direction) < 0.0));
        }
    }
    for [misses, hits] in counts {
        assert!(hits * 4 > misses && misses * 4 > hits, "{counts:?}");
    }
}

#[test]
fn both_is_the_nearer_of_front_and_back() {
    let mut numbers = Numbers::new(73);
    for _ in 0..3_000 {
        let points: Vec<DVec3> = (0..9).map(|_| numbers.shares()).collect();
        let mesh = Geometry::mesh(&points, &[[0, 1, 2], [2, 1, 3], [3, 4, 5], [6, 7, 8], [0, 4, 8]]).expect("a mesh");
        let pose = pose(&mut numbers);
        let origin = pose.position + numbers.shares() * 3.0;
        let both = ray(origin, pose.position + numbers.shares() * 0.4 - origin);
        let at = |faces: Faces| cast(&Ray { faces, ..both }, &mesh, pose).certain.map(|touch| touch.distance);
        let nearer = [at(Faces::Front), at(Faces::Back)].into_iter().flatten().reduce(f64::min);
        assert_eq!(at(Faces::Both), nearer);
    }
}

#[test]
fn a_triangle_has_its_front_where_it_goes_counter_clockwise() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let mesh = Geometry::mesh(&corners, &[[0, 1, 2]]).expect("a triangle");
    let above = ray(DVec3::new(0.25, 0.25, 1.0), -DVec3::Z);
    let below = ray(DVec3::new(0.25, 0.25, -1.0), DVec3::Z);
    let is_hit = |ray: Ray, faces: Faces| {
        let touches = cast(&Ray { faces, ..ray }, &mesh, Pose::IDENTITY);
        assert!(touches.undecided.is_none());
        touches.certain.is_some()
    };
    assert!(is_hit(above, Faces::Both) && is_hit(above, Faces::Front) && !is_hit(above, Faces::Back));
    assert!(is_hit(below, Faces::Both) && !is_hit(below, Faces::Front) && is_hit(below, Faces::Back));
}

#[test]
fn bodies_are_entered_by_their_fronts_and_left_by_their_backs() {
    let forms = [
        Geometry::sphere(1.0),
        Geometry::capsule(0.5, 1.0),
        Geometry::cuboid(DVec3::ONE),
        Geometry::cylinder(1.0, 1.0),
        Geometry::cone(2.0, 2.0),
        Geometry::ellipsoid(DVec3::new(1.0, 2.0, 3.0)),
        Geometry::cuboid(DVec3::new(0.5, 0.6, 0.7)).and_then(|form| form.rounded(0.5)),
        Geometry::cylinder(0.5, 0.5).and_then(|form| form.rounded(0.5)),
    ];
    for form in forms {
        let form = form.expect("within the limits");
        let at = |x: f64, faces: Faces| {
            let asked = Ray { faces, ..ray(DVec3::X * x, DVec3::X) };
            let touches = cast(&asked, &form, Pose::IDENTITY);
            assert!(touches.undecided.is_none(), "{touches:?}");
            touches.certain.map(|touch| {
                assert!(!touch.inside && (touch.normal.expect("a normal").x < 0.0), "{touch:?}");
                // To the metre: the walls are at −1 and 1 of each form.
                (touch.distance * 1e9).round() / 1e9
            })
        };
        assert_eq!((at(-5.0, Faces::Front), at(-5.0, Faces::Back)), (Some(4.0), Some(6.0)), "{form:?}");
        assert_eq!((at(0.5, Faces::Front), at(0.5, Faces::Back)), (None, Some(0.5)), "{form:?}");
        assert_eq!((at(5.0, Faces::Front), at(5.0, Faces::Back)), (None, None), "{form:?}");
    }
}

/// The weights are what the point was made of, near and far, for any triangle but the narrowest.
#[test]
fn weights_are_those_of_the_corners_in_the_order_sent() {
    let mut numbers = Numbers::new(79);
    let mut worst = 0.0_f64;
    for round in 0..4_000 {
        let away = [3.0, 1e3, 1e6][round % 3];
        let points: Vec<DVec3> = (0..3).map(|_| numbers.shares()).collect();
        let order = [[0, 1, 2], [1, 2, 0], [2, 1, 0]][numbers.below(3) as usize];
        let mesh = Geometry::mesh(&points, &[order]).expect("a triangle");
        let (s, t) = (numbers.share().abs(), numbers.share().abs());
        let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
        let weights = DVec3::new(1.0 - s - t, s, t);
        let [a, b, c] = order.map(|index| points[index as usize]);
        let pose = pose(&mut numbers);
        let aim = pose.transform_point(a * weights.x + b * weights.y + c * weights.z);
        let origin = aim + numbers.shares() * away;
        let direction = aim - origin;
        let Some(touch) = cast(&ray(origin, direction), &mesh, pose).certain else { continue };
        let found = touch.barycentric.expect("a triangle");
        assert!(found.min_element() >= 0.0 && found.max_element() <= 1.0, "{found}");
        assert!((found.element_sum() - 1.0).abs() <= 4e-16, "{found}");
        let incidence = touch.normal.expect("a normal").dot(direction.normalize()).abs();
        let height = (b - a).cross(c - a).length() / (b - a).length().max((c - a).length()).max((c - b).length());
        let error = (found - weights).abs().max_element();
        let allowed = 2e-15 * (away + 20.0) / incidence / height;
        worst = worst.max(error / allowed);
    }
    assert!((1e-3..1.0).contains(&worst), "the largest error is {worst} of what rounding moves the point");
    let ball = Geometry::sphere(1.0).expect("a ball");
    let touch = cast(&ray(DVec3::X * -5.0, DVec3::X), &ball, Pose::IDENTITY).certain.expect("a hit");
    assert_eq!(touch.barycentric, None, "a body has no corners");
}

/// At a corner and on an edge, hit exactly, the others weigh nothing.
#[test]
fn weights_at_corners_and_edges_are_exact() {
    let corners = [DVec3::new(0.1, 0.7, 0.3), DVec3::new(1.1, 0.7, 0.3), DVec3::new(0.1, 2.7, 0.3)];
    let mesh = Geometry::mesh(&corners, &[[0, 1, 2]]).expect("a triangle");
    let units = [DVec3::X, DVec3::Y, DVec3::Z];
    for (corner, unit) in corners.into_iter().zip(units) {
        let touch = cast(&ray(corner + DVec3::Z * 4.0, -DVec3::Z), &mesh, Pose::IDENTITY).certain.expect("a hit");
        let found = touch.barycentric.expect("a triangle");
        assert!((found - unit).abs().max_element() < 1e-15, "{found}");
    }
}
