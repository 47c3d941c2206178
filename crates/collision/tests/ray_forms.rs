//! Rays against cylinders, cones and ellipsoids, compared with numbers of twice the digits: every interval must hold the
//! truth, no verdict may contradict it, and undecided answers must be rare where the ray is near.
//!
//! `CALIPERS_RAY_SWEEP=1` with `--release` asks 300,000 rays of each form instead of a few thousand.

mod double;
mod whole;

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Pose,
    narrow::{Faces, Placed, Ray, RayTouches, raycast},
    shape::Geometry,
};
use double::{D3, Double, Line, dot, roots, stretch};
use whole::Numbers;

/// A form about y by the half extents of its box; `x` and `z` are equal but for ellipsoids.
#[derive(Clone, Copy, Debug)]
enum Body {
    Cylinder(DVec3),
    Cone(DVec3),
    Ellipsoid(DVec3),
}

impl Body {
    fn half(self) -> DVec3 {
        match self {
            Self::Cylinder(half) | Self::Cone(half) | Self::Ellipsoid(half) => half,
        }
    }

    fn geometry(self) -> Geometry {
        let form = match self {
            Self::Cylinder(half) => Geometry::cylinder(half.y, half.x),
            Self::Cone(half) => Geometry::cone(half.y, half.x),
            Self::Ellipsoid(half) => Geometry::ellipsoid(half),
        };
        form.expect("within the limits")
    }

    /// Where the line is inside.
    fn truth(self, line: &Line) -> Option<(f64, f64)> {
        let half = double::vector(self.half());
        let (o, d) = (line.start, line.direction);
        let across = |a: D3, b: D3| a[0] * b[0] + a[2] * b[2];
        let at_height = |y: Double| (y - o[1]) / d[1];
        let level = [-half[1], half[1]].map(at_height).into_iter().filter(|t| t.to_f64().is_finite());
        let square = |value: Double| value * value;
        match self {
            Self::Cylinder(_) => {
                let side = roots(across(d, d), across(o, d), across(o, o) - square(half[0]));
                let inside = |p: D3| across(p, p) <= square(half[0]) && p[1].abs() <= half[1];
                stretch(line, side.into_iter().chain(level).collect(), inside)
            }
            Self::Cone(_) => {
                let (tall, wide) = (square(half[1] + half[1]), square(half[0]));
                let depth = half[1] - o[1];
                let a = across(d, d) * tall - square(d[1]) * wide;
                let half_b = across(o, d) * tall + depth * d[1] * wide;
                let side = roots(a, half_b, across(o, o) * tall - square(depth) * wide);
                let inside = |p: D3| across(p, p) * tall <= square(half[1] - p[1]) * wide && p[1].abs() <= half[1];
                stretch(line, side.into_iter().chain(level).collect(), inside)
            }
            Self::Ellipsoid(_) => {
                let scaled = |p: D3| [p[0] / half[0], p[1] / half[1], p[2] / half[2]];
                let (o, d, one) = (scaled(o), scaled(d), Double::from(1.0));
                let walls = roots(dot(d, d), dot(o, d), dot(o, o) - one);
                stretch(line, walls, |p| dot(scaled(p), scaled(p)) <= one)
            }
        }
    }
}

fn pose(numbers: &mut Numbers, far: f64) -> Pose {
    let [x, y, z, w] = [0; 4].map(|_| numbers.share());
    let rotation = if numbers.below(3) == 0 { DQuat::IDENTITY } else { DQuat::from_xyzw(x, y, z, w) };
    Pose::new(numbers.shares() * far, rotation)
}

/// How extreme the scenes are.
#[derive(Clone, Copy)]
struct Spread {
    /// Sizes are between ten to the minus this and ten to this.
    scale: f64,
    /// Largest aspect, as a power of ten.
    aspect: f64,
    /// The origin is up to ten to this times the size away.
    away: f64,
}

/// Half extents: the largest is the size of the form.
fn half_extents(numbers: &mut Numbers, spread: Spread, is_round: bool) -> DVec3 {
    let size = numbers.magnitude(-spread.scale, spread.scale);
    let part = |numbers: &mut Numbers| (size * numbers.magnitude(-spread.aspect, 0.0)).max(1e-9);
    let mut half = DVec3::new(part(numbers), part(numbers), part(numbers));
    half[numbers.below(3) as usize] = size;
    if is_round {
        half.x = if numbers.below(2) == 0 { size } else { half.x };
        half.z = half.x;
    }
    half
}

/// A ray through two points of a box a little larger than the form, or at one of them from anywhere.
fn random_ray(numbers: &mut Numbers, half: DVec3, pose: &Pose, spread: Spread) -> Ray {
    let aim = numbers.shares() * half * 1.4;
    let size = half.max_element();
    let from = match numbers.below(2) {
        0 => numbers.shares() * half * 1.4,
        _ => aim + numbers.shares() * size,
    };
    let way = (aim - from).normalize_or(DVec3::X);
    let origin = aim - way * size * numbers.magnitude(-0.5, spread.away);
    let origin = pose.transform_point(origin);
    Ray {
        origin,
        direction: (pose.transform_point(aim) - origin) * numbers.magnitude(-3.0, 3.0),
        min_distance: 0.0,
        max_distance: 1e18,
        hollow: false,
        faces: Faces::Both,
    }
}

#[derive(Debug, Default)]
struct Tally {
    hits: u32,
    misses: u32,
    undecided: u32,
    /// Widths across the surface, as parts of the size and the way to it.
    widths: Vec<f64>,
}

impl Tally {
    fn take(&mut self, touches: RayTouches, truth: Option<f64>, scale: f64, direction: DVec3, context: &str) {
        let context = || format!("{context}: truth {truth:?}, {touches:?}");
        let holds = |touch: &collision::narrow::RayTouch| {
            let bound = touch.certificate.bound;
            assert!(bound.contains(touch.distance) && touch.point.is_finite(), "{}", context());
            let slack = truth.map_or(0.0, |truth| 3e-16 * truth);
            let is_in = |truth| bound.lower - slack <= truth && truth <= bound.upper + slack;
            assert!(truth.is_none_or(is_in), "not in the interval: {}", context());
        };
        touches.undecided.iter().for_each(holds);
        match (touches.certain, truth) {
            (Some(touch), Some(_)) => {
                self.hits += 1;
                holds(&touch);
                assert_eq!(touch.certificate.verdict, Verdict::Hit);
                if let Some(normal) = touch.normal {
                    let across = normal.dot(direction.normalize()).abs();
                    self.widths.push(touch.certificate.bound.width() * across / scale);
                }
            }
            (Some(_), None) => panic!("a hit that is none: {}", context()),
            (None, Some(_)) if touches.undecided.is_none() => panic!("missed: {}", context()),
            (None, _) if touches.undecided.is_some() => self.undecided += 1,
            (None, _) => self.misses += 1,
        }
    }

    fn report(&mut self, name: &str) -> (f64, f64) {
        self.widths.sort_by(f64::total_cmp);
        let count = self.widths.len();
        let (p99, most) = (self.widths[count * 99 / 100], self.widths[count - 1]);
        let Self { hits, misses, undecided, .. } = self;
        eprintln!("{name}: {hits} hits, {misses} misses, {undecided} undecided, width p99 {p99:.1e}, most {most:.1e}");
        (p99, most)
    }
}

fn is_long_sweep() -> bool {
    std::env::var_os("CALIPERS_RAY_SWEEP").is_some()
}

/// The body, entry and exit, as a full and as a hollow one and by its fronts and backs.
fn sweep(name: &str, body: fn(DVec3) -> Body, seed: u64, spread: Spread) -> Tally {
    let mut numbers = Numbers::new(seed);
    let mut tally = Tally::default();
    for _ in 0..if is_long_sweep() { 300_000 } else { 2_500 } {
        let half = half_extents(&mut numbers, spread, !matches!(body(DVec3::ONE), Body::Ellipsoid(_)));
        let body = body(half);
        let far = half.max_element() * numbers.magnitude(-1.0, 3.0);
        let pose = pose(&mut numbers, far.min(1e11));
        let ray = random_ray(&mut numbers, half, &pose, spread);
        let truth = body.truth(&Line::new(ray.origin, ray.direction, &pose));
        let geometry = body.geometry();
        let ask = |ray: &Ray| {
            let target = Placed { geometry: &geometry, pose };
            raycast(ray, target, &Accuracy::default(), &mut Work::default())
        };
        let scale = half.length() + (ray.origin - pose.position).length();
        let context = format!("{name} {body:?} at {pose:?}, {ray:?}");
        let ahead = truth.filter(|&(_, exit)| exit >= 0.0);
        let entry = ahead.map(|(entry, _)| entry.max(0.0));
        tally.take(ask(&ray), entry, scale, ray.direction, &context);
        let mut others = Tally::default();
        let wall = |wall: Option<f64>| wall.filter(|&wall| wall >= 0.0);
        let front = wall(ahead.map(|(entry, _)| entry));
        let back = wall(ahead.map(|(_, exit)| exit));
        let hollow = Ray { hollow: true, ..ray };
        let is_clear = ahead.is_none_or(|(entry, exit)| entry.abs().min(exit) > 1e-12 * scale);
        if is_clear {
            others.take(ask(&hollow), front.or(back), scale, ray.direction, &context);
            others.take(ask(&Ray { faces: Faces::Front, ..ray }), front, scale, ray.direction, &context);
            others.take(ask(&Ray { faces: Faces::Back, ..ray }), back, scale, ray.direction, &context);
        }
    }
    tally
}

const NEAR: Spread = Spread { scale: 6.0, aspect: 1.0, away: 3.0 };
const SLIM: Spread = Spread { scale: 2.0, aspect: 4.0, away: 0.5 };
const EXTREME: Spread = Spread { scale: 3.0, aspect: 6.0, away: 9.0 };

/// Near: decided, in the middle between hit and miss. Slim: as narrow as for a ball. Extreme: never wrong.
fn check(name: &str, body: fn(DVec3) -> Body) {
    for (kind, spread, seed) in [("near", NEAR, 3), ("slim", SLIM, 5), ("extreme", EXTREME, 7)] {
        let mut tally = sweep(&format!("{name}, {kind}"), body, seed, spread);
        let (_, most) = tally.report(&format!("{name}, {kind}"));
        let Tally { hits, misses, undecided, .. } = tally;
        let all = hits + misses + undecided;
        if kind == "extreme" {
            assert!(hits * 5 > all && misses * 20 > all, "{name}: {hits} hits and {misses} misses of {all}");
            continue;
        }
        assert!((0.3..0.75).contains(&(f64::from(hits) / f64::from(all))), "{name}: {hits} of {all} hit");
        assert!(undecided * 500 <= all, "{name}, {kind}: {undecided} of {all} are undecided");
        assert!(most < 1e-12, "{name}, {kind}: a width of {most}");
    }
}

#[test]
fn cylinders() {
    check("cylinder", Body::Cylinder);
}

#[test]
fn cones() {
    check("cone", Body::Cone);
}

#[test]
fn ellipsoids() {
    check("ellipsoid", Body::Ellipsoid);
}

/// A point of the surface where `normal` is an outward normal.
fn farthest(body: Body, normal: DVec3) -> DVec3 {
    let half = body.half();
    let rim = DVec3::new(normal.x, 0.0, normal.z).normalize_or(DVec3::X) * half.x;
    match body {
        Body::Cylinder(_) => rim + DVec3::Y * half.y * normal.y.signum(),
        Body::Cone(_) => {
            let (apex, rim) = (DVec3::Y * half.y, rim - DVec3::Y * half.y);
            if apex.dot(normal) > rim.dot(normal) { apex } else { rim }
        }
        Body::Ellipsoid(_) => half * (half * normal).normalize(),
    }
}

/// The normal of a body that is met at a place of its own kind: the side, an edge, an apex, anywhere.
fn some_normal(numbers: &mut Numbers, body: Body) -> DVec3 {
    let out = numbers.shares().normalize_or(DVec3::Y);
    match (body, numbers.below(3)) {
        (Body::Cylinder(_), 0) => DVec3::new(out.x, 0.0, out.z).normalize_or(DVec3::X),
        (Body::Cone(half), 0) => {
            let around = DVec3::new(out.x, 0.0, out.z).normalize_or(DVec3::X);
            (around * 2.0 * half.y + DVec3::Y * half.x).normalize()
        }
        (Body::Ellipsoid(half), 0 | 1) => (out / half).normalize(),
        _ => out,
    }
}

/// Rays that pass a surface within `gap`, outside of it or below it, some of them along the side of a cone or by its apex.
#[test]
fn grazing_rays_hit_above_their_error_and_miss_below_it() {
    for (name, body) in
        [("cylinder", Body::Cylinder as fn(DVec3) -> Body), ("cone", Body::Cone), ("ellipsoid", Body::Ellipsoid)]
    {
        let mut numbers = Numbers::new(61);
        let (mut open, mut near) = ([0; 2], Tally::default());
        for round in 0..if is_long_sweep() { 200_000 } else { 3_000 } {
            let spread = [NEAR, SLIM, EXTREME][round % 3];
            let half = half_extents(&mut numbers, spread, name != "ellipsoid");
            let body = body(half);
            let pose = pose(&mut numbers, half.max_element());
            let size = half.max_element();
            let normal = some_normal(&mut numbers, body);
            // Along the side of a cone, or in any direction in the tangent plane.
            let touched = farthest(body, normal);
            let down = (DVec3::Y * half.y - touched).normalize_or(DVec3::X);
            let aside = numbers.shares().cross(normal).normalize_or(DVec3::X);
            let is_along = numbers.below(3) == 0 && down.dot(normal).abs() < 0.9;
            let way = if is_along { down } else { aside };
            let way = (way - normal * way.dot(normal)).normalize_or(DVec3::X);
            let gap = numbers.magnitude(-18.0, -9.0) * if numbers.below(2) == 0 { size } else { -size };
            let away = size * numbers.magnitude(-0.5, 1.5);
            let aim = touched + normal * gap;
            let origin = pose.transform_point(aim - way * away);
            let ray = Ray {
                origin,
                direction: pose.matrix() * way,
                min_distance: 0.0,
                max_distance: 1e18,
                hollow: false,
                faces: Faces::Both,
            };
            let truth = body.truth(&Line::new(ray.origin, ray.direction, &pose));
            let entry = truth.filter(|&(_, exit)| exit >= 0.0).map(|(entry, _)| entry.max(0.0));
            let geometry = body.geometry();
            let target = Placed { geometry: &geometry, pose };
            let touches = raycast(&ray, target, &Accuracy::default(), &mut Work::default());
            let scale = half.length() + away + pose.position.length();
            let context = format!("{name}: gap {gap}, {body:?} at {pose:?}, {ray:?}");
            near.take(touches, entry, scale, ray.direction, &context);
            let is_wide = gap.abs() > 1e-12 * scale;
            open[usize::from(is_wide)] += u32::from(touches.undecided.is_some());
            assert!(!is_wide || gap < 0.0 || touches.undecided.is_none(), "an open miss: {context}: {touches:?}");
        }
        let Tally { hits, misses, .. } = near;
        eprintln!("{name}: {hits} hits, {misses} misses, open within 1e-12 {}, beyond {}", open[0], open[1]);
        assert!(hits * 10 > misses && misses * 10 > hits && open[0] > 10 * open[1], "{name}: {near:?}");
    }
}

/// The ray, from an origin, along a direction, with nothing else asked.
fn plain(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, min_distance: 0.0, max_distance: 4e12, hollow: false, faces: Faces::Both }
}

#[test]
fn normals_are_those_of_the_part_that_is_met() {
    let (x, y) = (DVec3::X, DVec3::Y);
    let cylinder = Geometry::cylinder(2.0, 1.0).expect("a cylinder");
    let cone = Geometry::cone(1.0, 1.0).expect("a cone");
    let ellipsoid = Geometry::ellipsoid(DVec3::new(1.0, 2.0, 4.0)).expect("an ellipsoid");
    let side = DVec3::new(2.0, 1.0, 0.0).normalize();
    let cases = [
        (&cylinder, plain(x * 9.0 + y, -x), 8.0, x),
        (&cylinder, plain(y * 9.0 + x * 0.5, -y), 7.0, y),
        (&cylinder, plain(y * -9.0 + x * 0.5, y), 7.0, -y),
        (&cone, plain(x * 9.0, -x), 8.5, side),
        (&cone, plain(y * -9.0 + x * 0.5, y), 8.0, -y),
        (&cone, plain(y * 9.0, -y), 8.0, y),
        (&cone, plain(y * 9.0 + x * 0.5, -y), 9.0, side),
        (&ellipsoid, plain(DVec3::Z * -9.0, DVec3::Z), 5.0, -DVec3::Z),
        (&ellipsoid, plain(y * 9.0, -y), 7.0, y),
    ];
    for (geometry, ray, distance, normal) in cases {
        let target = Placed { geometry, pose: Pose::IDENTITY };
        let touch = raycast(&ray, target, &Accuracy::default(), &mut Work::default());
        let touch = touch.certain.or(touch.undecided).expect("a touch");
        assert!((touch.distance - distance).abs() < 1e-14, "{ray:?}: {touch:?}");
        assert!((touch.normal.expect("a normal") - normal).length() < 1e-14, "{ray:?}: {touch:?}");
        assert_eq!(touch.feature.face, None, "round forms have no numbered faces");
    }
}
