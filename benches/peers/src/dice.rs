//! Random numbers: the same on every machine and for every run.

use collision::{DQuat, DVec3};

/// A generator (splitmix64).
#[derive(Clone, Debug)]
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// Uniform from `low` to `high`.
    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// Uniform below `count`.
    pub(crate) fn index(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    /// Uniform in a cube around the origin.
    pub(crate) fn point(&mut self, half_width: f64) -> DVec3 {
        let mut coordinate = || self.within(-half_width, half_width);
        DVec3::new(coordinate(), coordinate(), coordinate())
    }

    /// A uniform unit vector: a point of the ball, made longer (no platform's sine is asked).
    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.point(1.0);
            let square = point.length_squared();
            if (0.01..=1.0).contains(&square) {
                return point / square.sqrt();
            }
        }
    }

    /// A uniform rotation: a point of the ball in four dimensions, made longer.
    pub(crate) fn rotation(&mut self) -> DQuat {
        loop {
            let [x, y, z, w] = [(); 4].map(|()| self.within(-1.0, 1.0));
            let square = x * x + y * y + z * z + w * w;
            if (0.01..=1.0).contains(&square) {
                let length = square.sqrt();
                return DQuat::from_xyzw(x / length, y / length, z / length, w / length);
            }
        }
    }
}
