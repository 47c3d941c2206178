//! Random numbers and placed forms for tests: the same on every machine.

use collision::{DQuat, DVec3, math::Pose, narrow::Placed, shape::Geometry};

/// Pseudo-random numbers (xorshift64).
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    /// Uniform in [-1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Uniform in [low, high).
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.signed() * 0.5 + 0.5)
    }

    /// Uniform in the cube of half edge 1.
    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// A rotation, not normalised.
    pub(crate) fn rotation(&mut self) -> DQuat {
        DQuat::from_xyzw(self.signed(), self.signed(), self.signed(), self.signed())
    }

    /// A convex form of about unit size: sphere, box, capsule or hull in turn.
    pub(crate) fn convex(&mut self, kind: usize) -> Geometry {
        let form = match kind % 4 {
            0 => Geometry::sphere(self.between(0.2, 1.0)),
            1 => Geometry::cuboid(DVec3::new(self.between(0.1, 1.0), self.between(0.1, 1.0), self.between(0.1, 1.0))),
            2 => Geometry::capsule(self.between(0.1, 1.0), self.between(0.1, 0.6)),
            _ => {
                let points: Vec<DVec3> = (0..16).map(|_| self.vector()).collect();
                Geometry::hull(&points)
            }
        };
        form.expect("sizes within limits")
    }
}

/// A form and where it is.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) geometry: Geometry,
    pub(crate) pose: Pose,
}

impl Body {
    pub(crate) fn placed(&self) -> Placed<'_> {
        Placed { geometry: &self.geometry, pose: self.pose }
    }

    pub(crate) fn moved(&self, way: DVec3) -> Self {
        Self { geometry: self.geometry.clone(), pose: Pose::new(self.pose.position + way, self.pose.rotation) }
    }
}

/// Pairs of convex forms near each other, about half of them overlapping.
pub(crate) fn pairs(seed: u64, count: usize) -> impl Iterator<Item = [Body; 2]> {
    let mut noise = Noise(seed);
    (0..count).map(move |i| {
        let mut body =
            |kind: usize, place: DVec3| Body { geometry: noise.convex(kind), pose: Pose::new(place, noise.rotation()) };
        let a = body(i % 4, DVec3::ZERO);
        let b = body(i / 4 % 4, DVec3::ZERO);
        let place = noise.vector().normalize() * noise.between(0.2, 2.2);
        [a, b.moved(place)]
    })
}
