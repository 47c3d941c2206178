//! What a question asks of its answer: how wide its interval may be and how much work it may take.

/// A named point of the trade of speed for accuracy: where the defaults of an [`Accuracy`] come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tier {
    /// Relative error 0.1, budget 64.
    Fast,
    /// Relative error 1e-6, budget 128.
    #[default]
    Standard,
    /// As narrow as the arithmetic allows, budget 4096.
    Exact,
}

/// How exact an answer must be. An interval is narrow enough if its width is within `max_error` **or** within
/// `max_error_relative` of the value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// The tier whose defaults fill what was left out.
    pub tier: Tier,
    /// Widest interval to accept, in metres, at least 0. For times: the way that the fastest point covers in it.
    pub max_error: f64,
    /// Widest interval to accept as a part of the value itself, 0 to 1.
    pub max_error_relative: f64,
    /// Most iterations for each pair of convex pieces, at least 1.
    pub budget: u32,
}

impl Accuracy {
    /// The defaults of a tier.
    ///
    /// ```
    /// use collision::accuracy::{Accuracy, Tier};
    /// assert_eq!(Accuracy::of(Tier::Standard).budget, 128);
    /// ```
    #[must_use]
    pub const fn of(tier: Tier) -> Self {
        let (max_error_relative, budget) = match tier {
            Tier::Fast => (0.1, 64),
            Tier::Standard => (1e-6, 128),
            Tier::Exact => (0.0, 4096),
        };
        Self { tier, max_error: 0.0, max_error_relative, budget }
    }

    /// Whether a simpler form may stand in for a geometry: if an error is named that is above the standard tier's, and the tier
    /// is not [`Tier::Exact`]. The fast tier's defaults name one.
    ///
    /// ```
    /// use collision::accuracy::{Accuracy, Tier};
    /// assert!(!Accuracy::default().may_stand_in() && Accuracy::of(Tier::Fast).may_stand_in());
    /// assert!(Accuracy { max_error: 0.01, ..Accuracy::default() }.may_stand_in());
    /// assert!(!Accuracy { max_error: 0.01, ..Accuracy::of(Tier::Exact) }.may_stand_in());
    /// ```
    #[must_use]
    pub fn may_stand_in(&self) -> bool {
        let names_error = self.max_error > 0.0 || self.max_error_relative > Self::of(Tier::Standard).max_error_relative;
        names_error && self.tier != Tier::Exact
    }
}

impl Default for Accuracy {
    fn default() -> Self {
        Self::of(Tier::default())
    }
}
