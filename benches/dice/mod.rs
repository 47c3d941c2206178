//! Numbers that look random and are the same on every run.

/// xorshift64*.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let number = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D);
        low + (high - low) * (number >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In a cube around the origin.
    pub(crate) fn point(&mut self, side: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-0.5 * side, 0.5 * side))
    }
}
