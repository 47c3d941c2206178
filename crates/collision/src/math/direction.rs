//! Unit vectors.

use glam::DVec3;

/// The unit vector along `v`, however short or long it is; `None` for 0. No square in it vanishes or overflows.
#[must_use]
pub fn try_unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (largest > 0.0).then(|| (v / largest).normalize())
}
