//! What may be set about a world.

use crate::shape::Clock;

/// What its user may set about a world; none of it changes an answer about the newest version.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Ticks kept besides the newest, at most [`Settings::HISTORY_TICKS_MAX`]; 0, the default, keeps nothing of the past.
    pub history_ticks: u32,
    /// How far a shape may move before the tree changes, metres, at least 0; `None` tunes it for each shape from how it
    /// moves. Changes work, never results.
    pub margin: Option<f64>,
}

impl Settings {
    /// Most ticks of history.
    pub const HISTORY_TICKS_MAX: u32 = 65_536;
}

/// What a world may use.
#[derive(Clone, Copy, Debug)]
pub struct Means {
    /// What the history may hold, bytes; at the bound the oldest tick goes first.
    pub history_bytes: u64,
    /// What may be held that questions to the past had built, bytes; the one used last is kept whatever it holds.
    pub past_bytes: u64,
    /// A clock, nanoseconds since any moment, to tell what building things takes; no answer depends on it.
    pub clock: Option<Clock>,
}

impl Default for Means {
    /// 256 MiB for either, and no clock.
    fn default() -> Self {
        Self { history_bytes: 256 << 20, past_bytes: 256 << 20, clock: None }
    }
}
