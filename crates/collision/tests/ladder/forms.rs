//! Geometries that have stand-ins, and some that have none, at random places.

use std::sync::Arc;

use collision::{
    DQuat, DVec3,
    math::Pose,
    narrow::Placed,
    shape::{Geometry, MeshMode, Part, Terrain},
};

/// Pseudo-random numbers (xorshift64).
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    /// Uniform in [low, high).
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Uniform in the cube of half edge 1.
    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    fn one_of<T, const N: usize>(&mut self, all: [T; N]) -> T {
        let at = self.between(0.0, N as f64) as usize;
        all.into_iter().nth(at).expect("one of them")
    }

    pub(crate) fn unit(&mut self) -> DVec3 {
        self.vector().normalize_or(DVec3::X)
    }

    /// A pose whose position is within `far` of the origin along each axis.
    pub(crate) fn pose(&mut self, far: f64) -> Pose {
        let [x, y, z, w] = [(); 4].map(|()| self.between(-1.0, 1.0));
        Pose::new(self.vector() * far, DQuat::from_xyzw(x, y, z, w))
    }
}

/// A form and where it is.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) geometry: Arc<Geometry>,
    pub(crate) pose: Pose,
}

impl Body {
    pub(crate) fn placed(&self) -> Placed<'_> {
        Placed { geometry: &self.geometry, pose: self.pose }
    }
}

/// A large hull, about `scale` metres in size.
pub(crate) fn large_hull(noise: &mut Noise, scale: f64) -> Geometry {
    let (axes, off) = (noise.vector().abs() + 0.2, noise.vector());
    let points: Vec<DVec3> = (0..520).map(|_| (noise.unit() * axes + off) * scale).collect();
    Geometry::hull(&points).expect("a hull")
}

/// A closed surface with bumps and hollows, of 2·12·6 triangles, about `scale` metres in size.
pub(crate) fn bumpy(noise: &mut Noise, scale: f64) -> Geometry {
    const AROUND: u32 = 12;
    const DOWN: u32 = 6;
    let (axes, off) = (noise.vector().abs() + 0.3, noise.vector());
    let mut vertices = Vec::new();
    for i in 0..=DOWN {
        for j in 0..AROUND {
            let (down, around) = (f64::from(i) / f64::from(DOWN), f64::from(j) / f64::from(AROUND));
            let (height, turn) = ((down * std::f64::consts::PI).sin_cos(), (around * std::f64::consts::TAU).sin_cos());
            let out = noise.between(0.5, 1.0);
            vertices.push((DVec3::new(height.0 * turn.0, height.1, height.0 * turn.1) * axes * out + off) * scale);
        }
    }
    let at = |i: u32, j: u32| i * AROUND + j % AROUND;
    let cells = (0..DOWN).flat_map(|i| (0..AROUND).map(move |j| (i, j)));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Geometry::mesh(&vertices, &triangles).expect("a mesh")
}

/// A closed prism over an L, which two convex parts fill.
pub(crate) fn l_prism() -> Geometry {
    l_prism_as(MeshMode::TwoSided, 1.0)
}

fn l_prism_as(mode: MeshMode, scale: f64) -> Geometry {
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let level = |z: f64| outline.map(|[x, y]| DVec3::new(x, y, z) - DVec3::splat(0.5));
    let vertices: Vec<DVec3> = level(0.0).into_iter().chain(level(1.0)).map(|vertex| vertex * scale).collect();
    let caps = (1..5).flat_map(|i| [[0, i + 1, i], [6, i + 6, i + 7]]);
    let sides = (0..6).flat_map(|i| [[i, (i + 1) % 6, (i + 1) % 6 + 6], [i, (i + 1) % 6 + 6, i + 6]]);
    Geometry::mesh_as(mode, &vertices, &caps.chain(sides).collect::<Vec<_>>()).expect("a mesh")
}

/// A terrain of about `scale` metres, with hollows.
fn terrain(noise: &mut Noise, scale: f64) -> Geometry {
    let heights: Vec<f32> = (0..20).map(|_| noise.between(0.0, 1.0) as f32).collect();
    let spacing = DVec3::splat(0.3 * scale);
    let field = Terrain { columns: 5, rows: 4, heights: &heights, spacing, holes: &[] };
    Geometry::height_field(&field).expect("a terrain")
}

/// How many kinds of form there are.
pub(crate) const KINDS: usize = 11;

/// A form of about `scale` metres: most have stand-ins.
pub(crate) fn form(noise: &mut Noise, kind: usize, scale: f64) -> Geometry {
    let made = match kind % KINDS {
        0 | 1 => Ok(large_hull(noise, scale)),
        2 => large_hull(noise, scale).rounded(noise.between(0.05, 0.3) * scale),
        3 | 4 => Ok(bumpy(noise, scale)),
        5 => {
            let part = |geometry, noise: &mut Noise| Part {
                geometry: Arc::new(geometry),
                pose: Pose { position: noise.vector() * scale, ..noise.pose(0.0) },
            };
            let mesh = bumpy(noise, scale * 0.5);
            let parts = vec![
                part(mesh, noise),
                part(Geometry::capsule(0.4 * scale, 0.2 * scale).expect("a capsule"), noise),
                part(Geometry::cone(0.4 * scale, 0.3 * scale).expect("a cone"), noise),
            ];
            Geometry::compound(parts)
        }
        9 => {
            let mode = noise.one_of([MeshMode::Solid, MeshMode::OneSided]);
            Ok(l_prism_as(mode, 0.7 * scale))
        }
        10 => {
            let place = |noise: &mut Noise| Pose { position: noise.vector() * scale, ..noise.pose(0.0) };
            let parts = [terrain(noise, scale), l_prism_as(MeshMode::Solid, 0.5 * scale)];
            let part = |geometry| Part { geometry: Arc::new(geometry), pose: place(noise) };
            Geometry::compound(parts.map(part).into())
        }
        6 => Geometry::sphere(noise.between(0.1, 1.0) * scale),
        7 => Geometry::cuboid((noise.vector().abs() + 0.1) * scale),
        _ => Geometry::capsule(noise.between(0.1, 1.0) * scale, noise.between(0.1, 0.6) * scale),
    };
    made.expect("within limits")
}

/// A pair of which one has stand-ins, from deep in each other to far apart.
pub(crate) fn pair(noise: &mut Noise, number: usize) -> [Body; 2] {
    let scale = noise.one_of([1.0, 1e-3, 1e4]);
    let far = noise.one_of([1.0, 3.0, 10.0, 60.0]) * scale;
    let origin = noise.one_of([DVec3::ZERO, DVec3::new(1e6, -3e5, 2e6)]) * scale;
    let first = [0, 1, 2, 3, 5, 9, 10][number % 7];
    [first, number / 7 % KINDS].map(|kind| {
        let geometry = Arc::new(form(noise, kind, scale));
        let pose = noise.pose(far);
        Body { geometry, pose: Pose { position: pose.position + origin, ..pose } }
    })
}
