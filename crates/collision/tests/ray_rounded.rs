//! Rays against rounded bodies, compared with a search in numbers of twice the digits: the distance from the core is convex
//! along the ray, so its least value is bracketed and both walls are bisected.
//!
//! `CALIPERS_RAY_SWEEP=1` with `--release` asks 20,000 rays of each form instead of a few hundred.

mod double;
mod whole;

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::{Stop, Work},
    math::Pose,
    narrow::{Faces, Placed, Ray, raycast},
    shape::{Geometry, GeometryError},
};
use double::{D3, Double, Line};
use whole::Numbers;

#[derive(Clone, Copy, Debug)]
enum Core {
    Cuboid,
    Cylinder,
    Cone,
    Ellipsoid,
}

fn least(a: Double, b: Double) -> Double {
    if a < b { a } else { b }
}

fn above_zero(a: Double) -> Double {
    if a.is_negative() { Double::ZERO } else { a }
}

impl Core {
    fn geometry(self, half: DVec3, radius: f64) -> Result<Geometry, GeometryError> {
        let core = match self {
            Self::Cuboid => Geometry::cuboid(half),
            Self::Cylinder => Geometry::cylinder(half.y, half.x),
            Self::Cone => Geometry::cone(half.y, half.x),
            Self::Ellipsoid => Geometry::ellipsoid(half),
        };
        core?.rounded(radius)
    }

    /// From a point to the core, 0 inside.
    fn distance(self, half: D3, p: D3) -> Double {
        let out = (p[0] * p[0] + p[2] * p[2]).sqrt();
        let length = |x: Double, y: Double| (x * x + y * y).sqrt();
        match self {
            Self::Cuboid => {
                let beyond = [0, 1, 2].map(|axis| above_zero(p[axis].abs() - half[axis]));
                double::dot(beyond, beyond).sqrt()
            }
            Self::Cylinder => length(above_zero(out - half[0]), above_zero(p[1].abs() - half[1])),
            Self::Cone => {
                // From the apex down the side, and the base.
                let (side_out, side_down) = (half[0], half[1] + half[1]);
                let down = half[1] - p[1];
                let is_beside = (out * side_down - down * side_out) > Double::ZERO;
                if !is_beside && down <= side_down {
                    return Double::ZERO;
                }
                let along = (out * side_out + down * side_down) / (side_out * side_out + side_down * side_down);
                let along = least(above_zero(along), Double::from(1.0));
                let beside = length(out - side_out * along, down - side_down * along);
                let below = length(above_zero(out - half[0]), down - side_down);
                if is_beside { least(beside, below) } else { below }
            }
            Self::Ellipsoid => distance_to_ellipsoid(half, p),
        }
    }

    /// From where to where the rounded core is met, metres along the ray.
    fn truth(self, half: DVec3, radius: f64, line: &Line) -> Option<(f64, f64)> {
        let (core, radius, end) = (double::vector(half), Double::from(radius), 2.0 * half.length() + 2.0 * radius);
        let at = |t: Double| self.distance(core, line.at(t));
        let (mut low, mut high) = (Double::from(-end), Double::from(end));
        let third = Double::from(1.0) / Double::from(3.0);
        for _ in 0..130 {
            let (a, b) = (low + (high - low) * third, high - (high - low) * third);
            // The inside is as good as any of its points.
            if at(a) < at(b) || at(a) == Double::ZERO { high = b } else { low = a }
        }
        let middle = low * Double::from(0.5) + high * Double::from(0.5);
        if at(middle) > radius {
            return None;
        }
        let wall = |outside: f64| {
            let (mut outside, mut inside) = (Double::from(outside), middle);
            for _ in 0..90 {
                let half_way = outside * Double::from(0.5) + inside * Double::from(0.5);
                if at(half_way) <= radius { inside = half_way } else { outside = half_way }
            }
            (inside + line.shift).to_f64()
        };
        Some((wall(-end), wall(end)))
    }
}

/// By Newton's method on the λ with `|r·p / (r² + λ)| = 1`, from one digit to all of them.
fn distance_to_ellipsoid(radii: D3, p: D3) -> Double {
    let one = Double::from(1.0);
    let squares = radii.map(|radius| radius * radius);
    let mut lambda = Double::ZERO;
    for step in 0..60 {
        let share = [0, 1, 2].map(|axis| p[axis] / (squares[axis] + lambda));
        let on_ball = [0, 1, 2].map(|axis| radii[axis] * share[axis]);
        let size = double::dot(on_ball, on_ball).sqrt();
        if step == 0 && size <= one {
            return Double::ZERO;
        }
        let slope = [0, 1, 2].map(|axis| on_ball[axis] * on_ball[axis] / (squares[axis] + lambda));
        let next = lambda + (size - one) * size * size / (slope[0] + slope[1] + slope[2]);
        if (next - lambda).abs() <= next.abs() * Double::from(1e-29) {
            break;
        }
        lambda = next;
    }
    let nearest = [0, 1, 2].map(|axis| squares[axis] * p[axis] / (squares[axis] + lambda));
    let away = double::minus(p, nearest);
    double::dot(away, away).sqrt()
}

fn scene(numbers: &mut Numbers, core: Core, round: usize) -> (DVec3, f64, Pose, Ray) {
    let aspect = [1.0, 1.0, 4.0][round % 3];
    let size = numbers.magnitude(-3.0, 3.0);
    let mut half = DVec3::new(1.0, numbers.magnitude(-aspect, 0.0), numbers.magnitude(-aspect, 0.0)) * size;
    if round.is_multiple_of(2) {
        (half.x, half.y) = (half.y, half.x);
    }
    if matches!(core, Core::Cylinder | Core::Cone) {
        half.z = half.x;
    }
    let radius = size * numbers.magnitude(-aspect, 0.5);
    let rotation = DQuat::from_xyzw(numbers.share(), numbers.share(), numbers.share(), numbers.share());
    let pose = Pose::new(numbers.shares() * size * 3.0, rotation);
    let reach = half + radius;
    let (from, aim) = (numbers.shares() * reach * 2.2, numbers.shares() * reach * 2.2);
    let way = (aim - from).normalize_or(DVec3::X);
    let origin = pose.transform_point(aim - way * reach.length() * numbers.magnitude(0.5, 3.0));
    let direction = pose.transform_point(aim) - origin;
    let (min_distance, max_distance) = (0.0, 1e18);
    (half, radius, pose, Ray { origin, direction, min_distance, max_distance, hollow: false, faces: Faces::Both })
}

fn check(core: Core, seed: u64) {
    let mut numbers = Numbers::new(seed);
    let (mut hits, mut misses, mut open, mut widest) = (0, 0, 0, 0.0_f64);
    let count = if std::env::var_os("CALIPERS_RAY_SWEEP").is_some() { 20_000 } else { 240 };
    for round in 0..count {
        let (half, radius, pose, ray) = scene(&mut numbers, core, round);
        let geometry = core.geometry(half, radius).expect("within the limits");
        let truth = core.truth(half, radius, &Line::new(ray.origin, ray.direction, &pose));
        let context = format!("{core:?} {half:?} + {radius} at {pose:?}, {ray:?}: truth {truth:?}");
        let scale = half.length() + radius + (ray.origin - pose.position).length();
        for (faces, wall) in [(Faces::Front, truth.map(|walls| walls.0)), (Faces::Back, truth.map(|walls| walls.1))] {
            let target = Placed { geometry: &geometry, pose };
            let touches = raycast(&Ray { faces, ..ray }, target, &Accuracy::default(), &mut Work::default());
            assert!(touches.certain.is_none() || wall.is_some(), "no hit: {context}: {touches:?}");
            let touch = touches.certain.or(touches.undecided);
            assert!(touch.is_some() || wall.is_none(), "missed: {context}");
            open += u32::from(touches.undecided.is_some());
            let Some((touch, wall)) = touch.zip(wall) else {
                misses += 1;
                continue;
            };
            hits += 1;
            let bound = touch.certificate.bound;
            let slack = 3e-16 * wall;
            assert!(bound.lower - slack <= wall && wall <= bound.upper + slack, "{context}: {touch:?}");
            assert_eq!(touch.certificate.stop, Stop::Converged, "{context}");
            let across = touch.normal.map_or(1.0, |normal| normal.dot(ray.direction.normalize()).abs());
            widest = widest.max(bound.width() * across / scale);
        }
    }
    eprintln!("{core:?}: {hits} hits, {misses} misses, {open} open, widest {widest:.1e}");
    assert!(hits * 3 > misses && misses * 3 > hits && open * 200 <= hits, "{hits} hits, {misses} misses, {open} open");
    assert!(widest < 1e-12, "{core:?}: {widest}");
}

#[test]
fn rounded_boxes() {
    check(Core::Cuboid, 101);
}

#[test]
fn rounded_cylinders() {
    check(Core::Cylinder, 103);
}

#[test]
fn rounded_cones() {
    check(Core::Cone, 107);
}

#[test]
fn rounded_ellipsoids() {
    check(Core::Ellipsoid, 109);
}

/// A radius that is less than the error of a far ray: what goes through the core is hit, what passes it is missed.
#[test]
fn a_thin_rounding_seen_from_far_away_is_no_doubt() {
    for core in [Core::Cuboid, Core::Cylinder, Core::Cone, Core::Ellipsoid] {
        let body = core.geometry(DVec3::new(1.0, 1.5, 1.0), 1e-9).expect("within the limits");
        let target = Placed { geometry: &body, pose: Pose::IDENTITY };
        let cast = |z: f64| {
            let (origin, direction) = (DVec3::new(-1e7, -1.0, z), DVec3::X);
            let (min_distance, max_distance) = (0.0, 4e12);
            let ray = Ray { origin, direction, min_distance, max_distance, hollow: false, faces: Faces::Both };
            raycast(&ray, target, &Accuracy::default(), &mut Work::default())
        };
        let through = cast(0.01);
        assert!(through.undecided.is_none(), "{core:?}: {through:?}");
        assert!(through.certain.is_some_and(|touch| (touch.distance - 1e7).abs() < 2.0), "{core:?}: {through:?}");
        let beside = cast(1.1);
        assert!(beside.certain.is_none() && beside.undecided.is_none(), "{core:?}: {beside:?}");
    }
}
