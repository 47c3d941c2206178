//! Random convex forms, plain and awkward.

use glam::DVec3;

use crate::{
    oracle::{Core, Solid},
    scene::Random,
};

/// The kinds of forms a pair is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The local origin.
    Point,
    /// A rounded point.
    Sphere,
    /// A rounded segment, or a segment.
    Capsule,
    /// A box, sometimes flat, sometimes rounded.
    Box,
    /// A hull with volume: clouds, grids, duplicates, nearly flat ones; sometimes rounded.
    Hull,
    /// A hull without volume: a polygon, a line, a point; or one that misses being so by rounding.
    Flat,
    /// A hull that is very long or very thin.
    Needle,
    /// Sometimes rounded, as the next ones.
    Cylinder,
    /// See above.
    Cone,
    /// See above.
    Ellipsoid,
    /// Only with others: two of them overlap without end.
    HalfSpace,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Point,
        Self::Sphere,
        Self::Capsule,
        Self::Box,
        Self::Hull,
        Self::Flat,
        Self::Needle,
        Self::Cylinder,
        Self::Cone,
        Self::Ellipsoid,
        Self::HalfSpace,
    ];

    /// Its name in reports and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Sphere => "sphere",
            Self::Capsule => "capsule",
            Self::Box => "box",
            Self::Hull => "hull",
            Self::Flat => "flat",
            Self::Needle => "needle",
            Self::Cylinder => "cylinder",
            Self::Cone => "cone",
            Self::Ellipsoid => "ellipsoid",
            Self::HalfSpace => "half_space",
        }
    }

    /// The kind of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// How the numbers of a form are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Style {
    /// Any numbers, proportions up to 10.
    Plain,
    /// Proportions up to 1e6.
    Stretched,
    /// Multiples of 1/8 of the size, so that sums are exact.
    Dyadic,
    /// With coordinates that are subnormal.
    Denormal,
}

/// Sizes that the limits of the service allow, with some room for sums.
const SIZE_MIN: f64 = 1e-9;
const SIZE_MAX: f64 = 5e8;

/// A form of about a size, metres.
pub(super) fn form(random: &mut Random, kind: Kind, style: Style, size: f64) -> Solid {
    if kind == Kind::HalfSpace {
        return Solid { core: half_space(random, style, size), radius: 0.0 };
    }
    let mut core_size = |most: f64| {
        let part = match style {
            Style::Plain | Style::Denormal => random.uniform(0.1, 1.0),
            Style::Stretched => power_of_ten(random, -6.0, 0.0),
            Style::Dyadic => (random.uniform(1.0, 9.0)).floor() / 8.0,
        };
        (part * most).clamp(SIZE_MIN, SIZE_MAX)
    };
    let core = match kind {
        Kind::Point => Core::Point,
        Kind::Sphere => return Solid { core: Core::Point, radius: core_size(size) },
        Kind::Capsule => {
            let half_height = core_size(size);
            let radius = if core_size(1.0) < 0.15 { 0.0 } else { core_size(size) };
            return Solid { core: Core::Segment { half_height }, radius };
        }
        Kind::Box => {
            let mut half_extents = DVec3::new(core_size(size), core_size(size), core_size(size));
            let flat = random.bits() % 16;
            if flat < 3 {
                half_extents[flat as usize] = 0.0;
            }
            Core::Cuboid { half_extents }
        }
        Kind::Hull => Core::Hull(hull(random, style, size)),
        Kind::Flat => Core::Hull(flat(random, style, size)),
        Kind::Needle => {
            let thin = DVec3::new(1.0, power_of_ten(random, -6.0, -2.0), power_of_ten(random, -6.0, 0.0));
            Core::Hull(cloud(random, size).into_iter().map(|point| point * thin).collect())
        }
        Kind::Cylinder => Core::Cylinder { half_height: core_size(size), radius: core_size(size) },
        Kind::Cone => Core::Cone { half_height: core_size(size), radius: core_size(size) },
        Kind::Ellipsoid => {
            let radii = DVec3::new(core_size(size), core_size(size), core_size(size));
            // Balls and ellipsoids of revolution have whole circles of least width.
            let radii = match random.bits() % 8 {
                0 => DVec3::splat(radii.x),
                1 => DVec3::new(radii.x, radii.y, radii.x),
                _ => radii,
            };
            Core::Ellipsoid { radii }
        }
        // Returned above.
        Kind::HalfSpace => Core::Point,
    };
    let radius = rounding(random, kind, style, size);
    match core {
        // Such an ellipsoid is a ball, whose radius with a rounding is a sum that is rounded.
        Core::Ellipsoid { radii } if radii.min_element() == radii.max_element() => Solid { core, radius: 0.0 },
        core => Solid { core, radius },
    }
}

fn rounding(random: &mut Random, kind: Kind, style: Style, size: f64) -> f64 {
    if kind == Kind::Point || !random.one_in(4) {
        return 0.0;
    }
    let part = if style == Style::Dyadic { 0.125 } else { power_of_ten(random, -4.0, 0.0) };
    (part * size).clamp(SIZE_MIN, SIZE_MAX)
}

fn half_space(random: &mut Random, style: Style, size: f64) -> Core {
    let length = power_of_ten(random, -5.0, 5.0);
    let (normal, part) = (random.direction() * length, random.uniform(-1.0, 1.0));
    let (normal, part) = match style {
        Style::Plain | Style::Stretched => (normal, part),
        // Planes across axes, and with normals of which the length is a whole number or an inexact root.
        Style::Dyadic => {
            let normals = [DVec3::X, DVec3::Y, DVec3::NEG_Z, DVec3::new(3.0, 4.0, 0.0), DVec3::new(0.0, 1.0, -1.0)];
            (normals[(random.bits() % 5) as usize] * 0.5, (part * 8.0).round() / 8.0)
        }
        Style::Denormal => {
            let tiny = if random.one_in(2) { 1e-300 } else { 1.0 };
            (with_subnormals(random, normal * tiny) + DVec3::Y * 5e-324, part * 1e-310)
        }
    };
    Core::HalfSpace { normal, offset: part * size }
}

/// Ten to the power of a uniform number.
pub(super) fn power_of_ten(random: &mut Random, low: f64, high: f64) -> f64 {
    10f64.powf(random.uniform(low, high))
}

fn in_cube(random: &mut Random, half: f64) -> DVec3 {
    let mut coordinate = || random.uniform(-half, half);
    DVec3::new(coordinate(), coordinate(), coordinate())
}

/// Most hulls have few corners, since the oracle's time is cubic in them; some have more.
fn corner_count(random: &mut Random) -> usize {
    let most = if random.one_in(8) { 17 } else { 9 };
    4 + (random.bits() % (most - 4)) as usize
}

fn cloud(random: &mut Random, size: f64) -> Vec<DVec3> {
    (0..corner_count(random)).map(|_| in_cube(random, size)).collect()
}

fn hull(random: &mut Random, style: Style, size: f64) -> Vec<DVec3> {
    let mut points = cloud(random, size);
    let choice = if style == Style::Dyadic { 0 } else { random.bits() % 8 };
    match choice {
        // Points of a grid: many in one plane, on one line, and twice.
        0 => {
            for point in &mut points {
                *point = (*point * (2.0 / size)).round() * (0.5 * size);
            }
            // The corner of a cube makes sure of a volume.
            points.extend([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|point| point * size));
        }
        // On a sphere, as far from its own origin as it is large or much farther.
        1 => {
            let center = in_cube(random, size) * power_of_ten(random, -1.0, 3.0);
            points = points.iter().map(|_| center + random.direction() * size).collect();
        }
        // Nearly flat.
        2 => {
            let thin = power_of_ten(random, -16.0, -8.0);
            points.iter_mut().for_each(|point| point.y *= thin);
        }
        // The same point again, and once more a little off.
        3 => {
            let first = points[0];
            points.extend([first, first + in_cube(random, size) * power_of_ten(random, -16.0, -6.0)]);
        }
        _ => {}
    }
    if style == Style::Denormal {
        points.iter_mut().for_each(|point| *point = with_subnormals(random, *point));
    }
    points
}

/// Some coordinates replaced by numbers next to 0.
fn with_subnormals(random: &mut Random, point: DVec3) -> DVec3 {
    let mut part = |value: f64| match random.bits() % 6 {
        0 => value * 1e-310,
        1 => value.signum() * 5e-324,
        2 => value.signum() * 0.0,
        3 => value * 1e-160,
        _ => value,
    };
    DVec3::new(part(point.x), part(point.y), part(point.z))
}

fn flat(random: &mut Random, style: Style, size: f64) -> Vec<DVec3> {
    let mut points = cloud(random, size);
    let (u, v) = (random.direction(), random.direction());
    match random.bits() % 8 {
        // In a plane across an axis, exactly.
        0..=2 => {
            let axis = (random.bits() % 3) as usize;
            let height = if random.one_in(2) { 0.0 } else { random.uniform(-size, size) };
            points.iter_mut().for_each(|point| point[axis] = height);
        }
        // In a leaning plane, to within rounding.
        3 | 4 => points.iter_mut().for_each(|point| *point = u * point.x + v * point.y),
        // On an axis, and on a leaning line to within rounding.
        5 => points.iter_mut().for_each(|point| *point = DVec3::X * point.x),
        6 => points.iter_mut().for_each(|point| *point = u * point.x),
        // The same point, over and over.
        _ => {
            let first = points[0];
            points.iter_mut().for_each(|point| *point = first);
        }
    }
    match style {
        Style::Dyadic => points.iter().map(|point| (*point * (4.0 / size)).round() * (0.25 * size)).collect(),
        Style::Denormal => points.iter().map(|point| with_subnormals(random, *point)).collect(),
        Style::Plain | Style::Stretched => points,
    }
}
