//! A lower bound of the depth from capsules inside the two forms.
//!
//! # Method
//! A cylinder holds the capsule along its axis that touches its side, an ellipsoid the ball of its least half axis. Two forms
//! are at least as deep in each other as what they hold: `r + s` less the distance of the capsules' segments. Where round
//! forms have one axis, and every direction across it is an equally short way out, this is the depth itself, which no
//! polytope inside the difference can prove.
//!
//! ```text
//!    .-------------.
//!    |(-----------)|   the capsule reaches the side all along, so the way out sideways is no shorter
//!    '-------------'
//! ```
//!
//! # Limits
//! Only forms with a round core are looked at: for polytopes the expanding polytope is exact.

use glam::DVec3;

use super::{body::Body, frame::Pair};
use crate::{math::Norm, shape::Core, tolerance::PAIR_ROUNDING};

/// All points within `radius` of a segment about `middle`, in the pair's frame.
struct Capsule {
    middle: DVec3,
    /// From the middle to one end.
    half: DVec3,
    radius: f64,
}

/// The depth of the two rounded forms is not below this; negative infinity if neither has a round core.
pub(super) fn depth_lower(pair: &Pair<'_>) -> f64 {
    if pair.a.core.is_polytope() && pair.b.core.is_polytope() {
        return f64::NEG_INFINITY;
    }
    match (capsule(&pair.a), capsule(&pair.b)) {
        (Some(a), Some(b)) => a.radius + b.radius - segment_distance(&a, &b) - 2.0 * PAIR_ROUNDING,
        _ => f64::NEG_INFINITY,
    }
}

fn capsule(body: &Body<'_>) -> Option<Capsule> {
    let (half_height, radius) = match body.core {
        Core::Point => (0.0, 0.0),
        Core::Segment { half_height } => (*half_height, 0.0),
        Core::Cylinder { half_height, radius } => {
            let radius = radius.min(*half_height);
            (half_height - radius, radius)
        }
        Core::Cuboid { half_extents } => (0.0, half_extents.min_element()),
        Core::Ellipsoid { radii } => (0.0, radii.min_element()),
        Core::Hull(_) | Core::Triangle(_) | Core::Cone { .. } => return None,
    };
    Some(Capsule {
        middle: body.position,
        half: body.turn(DVec3::Y * (half_height * body.scale)),
        radius: radius * body.scale + body.radius,
    })
}

/// The distance of two segments, never less than the true one but for rounding: that of two points on them.
fn segment_distance(a: &Capsule, b: &Capsule) -> f64 {
    let apart = b.middle - a.middle;
    let (u, v) = (a.half, b.half);
    let (uu, vv, uv) = (u.length_squared(), v.length_squared(), u.dot(v));
    let (du, dv) = (apart.dot(u), apart.dot(v));
    let share = |along: f64, whole: f64| if whole > 0.0 { (along / whole).clamp(-1.0, 1.0) } else { 0.0 };
    // The nearest points of the lines, then each clamped in turn; parallel ones keep the middle.
    let area = uu * vv - uv * uv;
    let start = if area > 0.0 { ((du * vv - dv * uv) / area).clamp(-1.0, 1.0) } else { 0.0 };
    let on_a = share(share(start * uv - dv, vv) * uv + du, uu);
    let on_b = share(on_a * uv - dv, vv);
    (apart + v * on_b - u * on_a).norm()
}
