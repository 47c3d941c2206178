//! Random concave forms, plain and awkward, and where another form is put beside one.

use collision::shape::MeshMode;
use glam::{DQuat, DVec3};

use super::{
    forms::{Kind, Style, form, power_of_ten},
    whole::{PlacedWhole, Whole},
};
use crate::{
    oracle::{Core, Place, Solid, Union},
    scene::Random,
};

/// The classes that are made here, and a convex form of so many corners that simpler ones may stand in for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    Mesh,
    OneSided,
    Solid,
    Field,
    Compound,
    LargeHull,
}

impl Class {
    pub(super) const ALL: [Self; 6] =
        [Self::Mesh, Self::OneSided, Self::Solid, Self::Field, Self::Compound, Self::LargeHull];
}

/// A form of a class, of about a size.
pub(super) fn whole(random: &mut Random, class: Class, size: f64) -> Whole {
    match class {
        Class::Mesh => surface(random, MeshMode::TwoSided, size),
        Class::OneSided => surface(random, MeshMode::OneSided, size),
        Class::Solid => solid(random, size),
        Class::Field => field(random, size),
        Class::Compound => compound(random, size),
        Class::LargeHull => large_hull(random, size),
    }
}

fn surface(random: &mut Random, mode: MeshMode, size: f64) -> Whole {
    let (vertices, triangles) = if random.one_in(3) { soup(random, size) } else { sheet(random, size) };
    Whole::Mesh { mode, vertices, triangles }
}

/// Triangles anyhow, needles among them.
fn soup(random: &mut Random, size: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let count = 1 + (random.bits() % 8) as u32;
    let mut vertices = Vec::new();
    for _ in 0..count {
        let middle = random.direction() * (size * random.uniform(0.0, 0.7));
        let thin = if random.one_in(4) { power_of_ten(random, -6.0, 0.0) } else { 1.0 };
        let (along, across) = (random.direction() * (0.6 * size), random.direction() * (0.6 * size * thin));
        vertices.extend([middle, middle + along, middle + across]);
    }
    (vertices, (0..count).map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner)).collect())
}

/// A grid over x and z that looks up, flat or hilly.
fn sheet(random: &mut Random, size: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let cells = 1 + (random.bits() % 4) as u32;
    let hilly = if random.one_in(3) { 0.0 } else { power_of_ten(random, -9.0, 0.0) * size };
    let edge = 2.0 * size / f64::from(cells);
    let side = cells + 1;
    let vertex = |index: u32, height: f64| {
        DVec3::new(f64::from(index % side) * edge - size, height, f64::from(index / side) * edge - size)
    };
    let vertices = (0..side * side).map(|index| vertex(index, hilly * random.uniform(-1.0, 1.0))).collect();
    let cell = |index: u32| {
        let a = index / cells * side + index % cells;
        [[a, a + side, a + side + 1], [a, a + side + 1, a + 1]]
    };
    (vertices, (0..cells * cells).flat_map(cell).collect())
}

/// A closed surface: rings of a body around y, of any radii, so that it has waists.
fn solid(random: &mut Random, size: f64) -> Whole {
    let (rings, sides) = (2 + (random.bits() % 3) as u32, 3 + (random.bits() % 3) as u32);
    let squeeze = if random.one_in(4) { power_of_ten(random, -5.0, 0.0) } else { 1.0 };
    let mut vertices = vec![DVec3::Y * (-size * squeeze), DVec3::Y * (size * squeeze)];
    for ring in 0..rings {
        let height = (f64::from(ring + 1) / f64::from(rings + 1) * 2.0 - 1.0) * size * squeeze;
        let radius = size * random.uniform(0.2, 1.0);
        for side in 0..sides {
            let (sin, cos) = (f64::from(side) / f64::from(sides) * std::f64::consts::TAU).sin_cos();
            vertices.push(DVec3::new(radius * cos, height, radius * sin));
        }
    }
    let at = |ring: u32, side: u32| 2 + ring * sides + side % sides;
    let mut triangles = Vec::new();
    for side in 0..sides {
        triangles.push([0, at(0, side), at(0, side + 1)]);
        triangles.push([1, at(rings - 1, side + 1), at(rings - 1, side)]);
        for ring in 0..rings - 1 {
            let [a, b, c, d] = [at(ring, side), at(ring, side + 1), at(ring + 1, side), at(ring + 1, side + 1)];
            triangles.extend([[a, d, b], [a, c, d]]);
        }
    }
    Whole::Mesh { mode: MeshMode::Solid, vertices, triangles }
}

fn field(random: &mut Random, size: f64) -> Whole {
    let (columns, rows) = (2 + (random.bits() % 3) as usize, 2 + (random.bits() % 3) as usize);
    let steep = if random.one_in(4) { 0.0 } else { power_of_ten(random, -4.0, 0.0) };
    #[allow(clippy::cast_possible_truncation, reason = "any height will do")]
    let heights = (0..columns * rows).map(|_| (steep * random.uniform(-1.0, 1.0)) as f32).collect();
    let spacing = DVec3::new(size * random.uniform(0.3, 1.0), size, size * random.uniform(0.3, 1.0));
    let cells = ((columns - 1) * (rows - 1)) as u64;
    let holes = if cells > 1 && random.one_in(3) { vec![(random.bits() % cells) as u32] } else { Vec::new() };
    Whole::Field { columns, heights, spacing: spacing.max(DVec3::splat(1e-9)), holes }
}

fn compound(random: &mut Random, size: f64) -> Whole {
    let kinds = [Kind::Sphere, Kind::Capsule, Kind::Box, Kind::Hull, Kind::Cylinder, Kind::Cone, Kind::Ellipsoid];
    let count = 2 + random.bits() % 3;
    let parts = (0..count).map(|_| {
        let kind = kinds[(random.bits() % kinds.len() as u64) as usize];
        let small = size * random.uniform(0.2, 0.6);
        let part = if random.one_in(6) {
            surface(random, MeshMode::TwoSided, small)
        } else {
            Whole::Convex(form(random, kind, Style::Plain, small))
        };
        (part, random.direction() * (size * random.uniform(0.0, 0.8)), random.rotation())
    });
    Whole::Compound(parts.collect())
}

/// Points on an ellipsoid.
fn large_hull(random: &mut Random, size: f64) -> Whole {
    let count = 520 + random.bits() % 200;
    let stretch = DVec3::new(1.0, random.uniform(0.2, 1.0), random.uniform(0.2, 1.0)) * size;
    let points = (0..count).map(|_| random.direction() * stretch).collect();
    Whole::Convex(Solid { core: Core::Hull(points), radius: 0.0 })
}

/// What is hard about a pair of which one is concave.
pub(super) const HARD: [&str; 8] =
    ["generic", "near_touch", "far_offset", "deep_inside", "tiny", "huge", "size_ratio", "concentric"];

/// A concave form and another, with what is hard about them.
pub(super) fn placed_wholes(
    random: &mut Random,
    class: Class,
    kind: Kind,
    extreme: Option<&'static str>,
) -> (&'static str, [PlacedWhole; 2]) {
    let any = HARD[(random.bits() % HARD.len() as u64) as usize];
    let hard = extreme.unwrap_or(any);
    let size = match hard {
        "tiny" => power_of_ten(random, -7.5, -6.0),
        "huge" => power_of_ten(random, 6.0, 8.0),
        _ if random.one_in(2) => 1.0,
        _ => power_of_ten(random, -5.0, 5.0),
    };
    let first = whole(random, class, size);
    let small = match hard {
        "size_ratio" => power_of_ten(random, -5.0, -2.0),
        "deep_inside" => power_of_ten(random, -2.0, -0.7),
        _ => random.uniform(0.1, 1.0),
    };
    let small = (small * size).max(1e-9);
    let second = if kind != Kind::HalfSpace && random.one_in(8) {
        let class = Class::ALL[(random.bits() % 5) as usize];
        whole(random, class, small)
    } else {
        Whole::Convex(form(random, kind, Style::Plain, small))
    };
    let offset = if hard == "far_offset" { random.direction() * power_of_ten(random, 3.0, 9.0) } else { DVec3::ZERO };
    let position = random.direction() * size + offset;
    let rotation = if random.one_in(4) { DQuat::IDENTITY } else { random.rotation() };
    let first = PlacedWhole { whole: first, position, rotation };
    let far = match hard {
        "concentric" => 0.0,
        "deep_inside" => random.uniform(0.0, 0.4),
        _ => random.uniform(0.1, 1.6),
    };
    let beside = position + random.direction() * (size * far);
    let mut second = PlacedWhole { whole: second, position: beside, rotation: random.rotation() };
    if hard == "near_touch" || hard == "size_ratio" || random.one_in(4) {
        let gap = power_of_ten(random, -13.0, -1.0) * size * if random.one_in(2) { 1.0 } else { -1.0 };
        put_at(&first, &mut second, gap);
    }
    (hard, if random.one_in(2) { [first, second] } else { [second, first] })
}

/// Where a form is, at rest.
pub(super) fn place_of(placed: &PlacedWhole) -> Place {
    let (position, rotation) = (placed.position, placed.rotation);
    Place { position, rotation, part: None, displacement: DVec3::ZERO, spin: DVec3::ZERO }
}

/// Moves the second form to a gap along the direction along which it is nearest.
fn put_at(first: &PlacedWhole, second: &mut PlacedWhole, gap: f64) {
    let (a, b): (Union, Union) = (first.whole.union(), second.whole.union());
    if let Some((truth, _)) = Union::nearest((&a, &place_of(first)), (&b, &place_of(second)))
        && truth.nearest().is_finite()
    {
        second.position += truth.normal_a_to_b() * (gap - truth.nearest());
    }
}
