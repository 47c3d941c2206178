//! Every number that decides geometry, each with its reason, what gets worse when it changes, and the test that pins it.
//!
//! Kernels work on a pair scaled so that its extent `S` lies in [1, 2), so these numbers have no unit.

/// Half a unit in the last place of 1: one rounded f64 operation is off by at most this part of its result.
pub const ROUNDING: f64 = f64::EPSILON / 2.0;
