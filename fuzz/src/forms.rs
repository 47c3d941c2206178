//! Forms of every kind from bytes, by the public constructors: their errors are accepted, their panics are found.

use collision::{
    DVec3,
    math::Pose,
    narrow::Placed,
    shape::{Convex, Core, Form, Geometry, GeometryError, Limits, MeshMode},
};

use crate::{
    concave,
    numbers::{Numbers, vector_code},
};

/// A form and the code that makes it.
#[derive(Clone)]
pub struct Made {
    /// The form.
    pub geometry: Geometry,
    /// Rust code for it, a `Geometry`.
    pub code: String,
}

impl Made {
    /// The form at a pose.
    #[must_use]
    pub fn at(&self, pose: Pose) -> Placed<'_> {
        Placed { geometry: &self.geometry, pose }
    }

    /// Its convex core and radius, if it has one.
    #[must_use]
    pub fn convex(&self) -> Option<&Convex> {
        match self.geometry.form() {
            Form::Convex(convex) => Some(convex),
            Form::Mesh(_) | Form::HalfSpace(_) | Form::Compound(_) | Form::HeightField(_) => None,
        }
    }

    /// Whether it is made of pieces: a mesh, a compound or a height field.
    #[must_use]
    pub fn is_concave(&self) -> bool {
        matches!(self.geometry.form(), Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_))
    }

    /// Whether some mesh in it is of such a mode.
    #[must_use]
    pub fn has_mode(&self, is_such: fn(MeshMode) -> bool) -> bool {
        fn has(geometry: &Geometry, is_such: fn(MeshMode) -> bool) -> bool {
            match geometry.form() {
                Form::Mesh(mesh) => is_such(mesh.mode()),
                Form::Compound(compound) => compound.parts().iter().any(|part| has(&part.geometry, is_such)),
                Form::Convex(_) | Form::HalfSpace(_) | Form::HeightField(_) => false,
            }
        }
        has(&self.geometry, is_such)
    }

    /// Whether there is a radius around its core.
    #[must_use]
    pub fn is_rounded(&self) -> bool {
        self.convex().is_some_and(|convex| convex.radius > 0.0)
    }

    /// Whether it is convex with flat faces or a point or a segment, with any radius.
    #[must_use]
    pub fn is_polytope(&self) -> bool {
        self.convex().is_some_and(|convex| {
            !matches!(convex.core, Core::Cylinder { .. } | Core::Cone { .. } | Core::Ellipsoid { .. })
        })
    }
}

/// The next form; none if its numbers are refused.
#[must_use]
pub fn form(numbers: &mut Numbers<'_>) -> Option<Made> {
    let (mut geometry, mut code) = plain(numbers);
    let modifiers = numbers.byte();
    if modifiers & 3 == 0 {
        let rounding = numbers.size_or_zero();
        geometry = geometry.and_then(|form| form.rounded(rounding));
        code += &format!(".and_then(|form| form.rounded({rounding:?}))");
    }
    if modifiers & 0x1c == 0 {
        let scale = if numbers.byte() & 1 == 0 { [0.5, 2.0, 1024.0, 0.1][numbers.below(4)] } else { numbers.number() };
        geometry = geometry.and_then(|form| form.scaled(scale));
        code += &format!(".and_then(|form| form.scaled({scale:?}))");
    }
    Some(Made { geometry: geometry.ok()?, code: code + ".unwrap()" })
}

/// What a constructor returns, and the code that calls it.
pub type Constructed = (Result<Geometry, GeometryError>, String);

fn plain(numbers: &mut Numbers<'_>) -> Constructed {
    match numbers.below(20) {
        16 | 17 => concave::compound(numbers, Limits::COMPOUND_DEPTH),
        18 => concave::height_field(numbers),
        _ if numbers.left() == 0 => (Ok(Geometry::point()), "Ok(Geometry::point())".into()),
        kind => convex_or_mesh(numbers, kind),
    }
}

/// A form of a kind below 16 that holds no other; beyond, a hull.
pub fn convex_or_mesh(numbers: &mut Numbers<'_>, kind: usize) -> Constructed {
    match kind {
        0 => (Ok(Geometry::point()), "Ok(Geometry::point())".into()),
        1 => {
            let radius = numbers.size();
            (Geometry::sphere(radius), format!("Geometry::sphere({radius:?})"))
        }
        2 | 3 => {
            let half = DVec3::new(numbers.size_or_zero(), numbers.size(), numbers.size());
            (Geometry::cuboid(half), format!("Geometry::cuboid({})", vector_code(half)))
        }
        4 => {
            let (half_height, radius) = (numbers.size_or_zero(), numbers.size_or_zero());
            (Geometry::capsule(half_height, radius), format!("Geometry::capsule({half_height:?}, {radius:?})"))
        }
        5 | 6 => {
            let (half_height, radius) = (numbers.size(), numbers.size());
            (Geometry::cylinder(half_height, radius), format!("Geometry::cylinder({half_height:?}, {radius:?})"))
        }
        7 => {
            let (half_height, radius) = (numbers.size(), numbers.size());
            (Geometry::cone(half_height, radius), format!("Geometry::cone({half_height:?}, {radius:?})"))
        }
        8 | 9 => {
            let radii = DVec3::new(numbers.size(), numbers.size(), numbers.size());
            (Geometry::ellipsoid(radii), format!("Geometry::ellipsoid({})", vector_code(radii)))
        }
        10 => {
            let (normal, offset) =
                (if numbers.byte() & 1 == 0 { numbers.direction() } else { numbers.vector() }, numbers.number());
            (Geometry::half_space(normal, offset), format!("Geometry::half_space({}, {offset:?})", vector_code(normal)))
        }
        11 | 12 => concave::mesh(numbers),
        _ => {
            let points = points(numbers, 24);
            (Geometry::hull(&points), format!("Geometry::hull(&{})", points_code(&points)))
        }
    }
}

/// A list of points as code.
#[must_use]
pub fn points_code(points: &[DVec3]) -> String {
    let points: Vec<String> = points.iter().map(|&point| vector_code(point)).collect();
    format!("[{}]", points.join(", "))
}

/// From 1 to about `most` points: free ones and such as make degenerate hulls.
#[must_use]
pub fn points(numbers: &mut Numbers<'_>, most: usize) -> Vec<DVec3> {
    let mut points: Vec<DVec3> = match numbers.below(8) {
        0 => {
            let half = DVec3::new(numbers.size(), numbers.size(), numbers.size());
            (0..8).map(|i| DVec3::from([i & 1, i >> 1 & 1, i >> 2].map(|bit| f64::from(2 * bit - 1))) * half).collect()
        }
        1 => {
            let (count, size, height) = (3 + numbers.below(40), numbers.size(), numbers.size_or_zero());
            let at = |i: usize| (i / 2) as f64 / count as f64 * std::f64::consts::TAU;
            (0..2 * count)
                .map(|i| DVec3::new(at(i).cos() * size, if i % 2 == 0 { -height } else { height }, at(i).sin() * size))
                .collect()
        }
        2 => {
            let (count, size) = (4 + numbers.below(120), DVec3::new(numbers.size(), numbers.size(), numbers.size()));
            let golden = 2.399_963_229_728_653;
            let point = |i: usize| {
                let height = 1.0 - (2 * i + 1) as f64 / count as f64;
                let ring = (1.0 - height * height).sqrt();
                DVec3::new((golden * i as f64).cos() * ring, height, (golden * i as f64).sin() * ring) * size
            };
            (0..count).map(point).collect()
        }
        3 => {
            let size = numbers.size();
            let count = 1 + numbers.below(most);
            let mut part = || f64::from(numbers.byte() % 5) - 2.0;
            (0..count).map(|_| DVec3::new(part(), part(), part()) * size).collect()
        }
        _ => {
            let count = 1 + numbers.below(most);
            (0..count).map(|_| numbers.vector()).collect()
        }
    };
    bend(numbers, &mut points);
    for point in &mut points {
        *point = point.clamp(DVec3::splat(-Limits::COORDINATE), DVec3::splat(Limits::COORDINATE));
    }
    points
}

/// Flattens, moves, doubles or blurs points.
fn bend(numbers: &mut Numbers<'_>, points: &mut Vec<DVec3>) {
    match numbers.below(10) {
        0 => {
            let (axis, at) = (numbers.below(3), numbers.number());
            points.iter_mut().for_each(|point| point[axis] = at);
        }
        1 => {
            let (axis, flatness) = (numbers.below(3), numbers.number());
            points.iter_mut().for_each(|point| point[axis] *= flatness);
        }
        2 => {
            let away = numbers.vector();
            points.iter_mut().for_each(|point| *point += away);
        }
        3 => {
            let (from, along) = (numbers.vector(), numbers.vector());
            for point in points.iter_mut() {
                *point = from + along * (point.x % 16.0);
            }
        }
        4 => {
            for index in 0..points.len().min(16) {
                let mut twin = points[index];
                let axis = numbers.below(3);
                twin[axis] = if numbers.byte() & 1 == 0 { twin[axis].next_up() } else { twin[axis].next_down() };
                points.push(twin);
            }
        }
        5 => {
            for index in 2..points.len() {
                if numbers.byte() & 1 == 0 {
                    points[index] = points[index - 1] * 0.5 + points[index - 2] * 0.5;
                }
            }
        }
        _ => {}
    }
    points.retain(|point| point.is_finite());
    if points.is_empty() {
        points.push(DVec3::ZERO);
    }
}
