//! Numbers, vectors and rotations from bytes: few of them plain, most at or beside a place where arithmetic bends.

use collision::{DQuat, DVec3, math::Pose, shape::Limits};

/// Bytes, read as numbers of the classes that break things. Past its end there are zeros.
pub struct Numbers<'a> {
    rest: &'a [u8],
    /// What lengths are relative to, metres.
    scale: f64,
    /// Numbers and rotations given out before, to be near to.
    recent: [f64; 8],
    given: usize,
    rotation: DQuat,
}

impl<'a> Numbers<'a> {
    /// The first byte says how large everything is.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        let mut numbers = Self { rest: bytes, scale: 1.0, recent: [1.0; 8], given: 0, rotation: DQuat::IDENTITY };
        const SCALES: [f64; 12] = [1.0, 1.0, 1.0, 1.0, 1e-3, 1e3, 1e-6, 1e6, 1e-8, 1e8, 9.5367431640625e-7, 1048576.0];
        numbers.scale = SCALES[numbers.below(12)];
        numbers
    }

    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.rest.split_first() else { return 0 };
        self.rest = rest;
        first
    }

    /// From 0 to less than `count`, which is at most 256.
    pub fn below(&mut self, count: usize) -> usize {
        usize::from(self.byte()) * count / 256
    }

    /// How many bytes are left.
    #[must_use]
    pub fn left(&self) -> usize {
        self.rest.len()
    }

    /// Two bytes as a number in [-1, 1).
    fn signed(&mut self) -> f64 {
        f64::from(i16::from_le_bytes([self.byte(), self.byte()])) / 32768.0
    }

    /// Eight bytes as they are.
    fn raw(&mut self) -> f64 {
        f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte())))
    }

    fn known(&mut self) -> f64 {
        self.recent[self.below(8)]
    }

    /// A coordinate within the limits, metres.
    pub fn number(&mut self) -> f64 {
        let found = match self.below(20) {
            0 => 0.0,
            1 => -0.0,
            2 | 3 => f64::from(self.byte() as i8) / 8.0 * self.scale,
            4 | 5 => self.signed() * self.scale,
            6 => f64::from(self.byte() as i8).exp2() * self.scale.signum(),
            7 | 8 => self.known(),
            9 => -self.known(),
            10 => self.known().next_up(),
            11 => self.known().next_down(),
            12 => self.known() * (1.0 + f64::from(self.byte() as i8) * f64::EPSILON),
            13 => self.known() + self.signed() * 1e-12 * self.scale,
            14 => self.known() + self.signed() * 1e-8 * self.scale,
            15 => self.known() * [0.5, 2.0, 1e-6, 1e6, 3.0, 1.0 / 3.0][self.below(6)],
            16 => [1e-9, 1e9, 1e12, -1e12, 1e-300, -1e-160, 1e-100, 1e6][self.below(8)],
            17 => f64::from_bits(u64::from(self.byte())) * if self.byte() & 1 == 0 { 1.0 } else { -1.0 },
            _ => self.raw(),
        };
        let found = within(found);
        self.recent[self.given % 8] = found;
        self.given += 1;
        found
    }

    /// A size that is accepted, but for one class of all that there are.
    pub fn size(&mut self) -> f64 {
        let found = match self.below(16) {
            0 => Limits::SIZE_MIN,
            1 => Limits::SIZE_MAX,
            2 => return self.number(),
            3..=7 => (f64::from(self.byte()) + 1.0) / 64.0 * self.scale,
            _ => self.number().abs(),
        };
        let found = if found == 0.0 { self.scale } else { found.clamp(Limits::SIZE_MIN, Limits::SIZE_MAX) };
        self.recent[self.given % 8] = found;
        self.given += 1;
        found
    }

    /// A size or, one time in four, 0.
    pub fn size_or_zero(&mut self) -> f64 {
        if self.below(4) == 0 { 0.0 } else { self.size() }
    }

    /// At least 0, at most `most`; infinite now and then.
    pub fn length(&mut self, most: f64) -> f64 {
        match self.below(6) {
            0 => 0.0,
            1 => most,
            2 => f64::INFINITY,
            _ => self.number().abs().min(most),
        }
    }

    /// A point.
    pub fn vector(&mut self) -> DVec3 {
        match self.below(6) {
            0 => DVec3::splat(self.number()),
            1 => [DVec3::X, DVec3::Y, DVec3::Z][self.below(3)] * self.number(),
            2 => DVec3::new(self.signed(), self.signed(), self.signed()) * self.scale,
            _ => DVec3::new(self.number(), self.number(), self.number()),
        }
    }

    /// A vector of about length 1, often along an axis.
    pub fn direction(&mut self) -> DVec3 {
        let found = match self.below(4) {
            0 => [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z][self.below(6)],
            1 => DVec3::new(self.below(3) as f64 - 1.0, self.below(3) as f64 - 1.0, self.below(3) as f64 - 1.0),
            _ => DVec3::new(self.signed(), self.signed(), self.signed()),
        };
        if found == DVec3::ZERO { DVec3::Y } else { found }
    }

    /// A quaternion of any length but 0.
    pub fn rotation(&mut self) -> DQuat {
        let tilt = |numbers: &mut Self| {
            let power = -f64::from(numbers.byte() % 20);
            numbers.signed() * 10f64.powf(power)
        };
        let found = match self.below(14) {
            0..=2 => DQuat::IDENTITY,
            3 => DQuat::from_xyzw(0.0, 0.0, 0.0, self.number()),
            4 => {
                let mut part = || self.below(3) as f64 - 1.0;
                DQuat::from_xyzw(part(), part(), part(), part())
            }
            5 => DQuat::from_xyzw(tilt(self), tilt(self), tilt(self), 1.0),
            6 => self.rotation,
            7 => self.rotation * [2.0, -1.0, 0.3, 1e-160, 1e160][self.below(5)],
            8 => {
                let mut parts = self.rotation.to_array();
                let slot = self.below(4);
                parts[slot] = parts[slot].next_up();
                DQuat::from_array(parts)
            }
            9 => DQuat::from_xyzw(tilt(self), tilt(self), tilt(self), tilt(self)) + self.rotation,
            10 => DQuat::from_xyzw(self.number(), self.number(), self.number(), self.number()),
            11 => {
                let mut any = || Some(self.raw()).filter(|value| value.is_finite()).unwrap_or(1.0);
                DQuat::from_xyzw(any(), any(), any(), any())
            }
            _ => DQuat::from_xyzw(self.signed(), self.signed(), self.signed(), self.signed()),
        };
        let is_rotation = found.is_finite() && found.to_array() != [0.0; 4];
        self.rotation = if is_rotation { found } else { DQuat::IDENTITY };
        self.rotation
    }

    /// A pose.
    pub fn pose(&mut self) -> Pose {
        let position = if self.below(4) == 0 { DVec3::ZERO } else { self.vector() };
        Pose::new(position, self.rotation())
    }
}

/// Any number as a coordinate within the limits.
#[must_use]
pub fn within(value: f64) -> f64 {
    if value.is_finite() { value.clamp(-Limits::COORDINATE, Limits::COORDINATE) } else { 0.0 }
}

/// The same for each component.
#[must_use]
pub fn vector_within(vector: DVec3) -> DVec3 {
    DVec3::from_array(vector.to_array().map(within))
}

/// A vector as code.
#[must_use]
pub fn vector_code(v: DVec3) -> String {
    format!("DVec3::new({:?}, {:?}, {:?})", v.x, v.y, v.z)
}

/// A pose as code.
#[must_use]
pub fn pose_code(pose: &Pose) -> String {
    let [x, y, z, w] = pose.rotation.to_array();
    format!("Pose::new({}, DQuat::from_xyzw({x:?}, {y:?}, {z:?}, {w:?}))", vector_code(pose.position))
}
