//! The gap between a segment or a point and a box, by formula. A segment and a point are boxes too, thin ones.
//!
//! # Method
//! Along the segment the squared distance to the box is convex and made of at most seven parabolas, which meet where the
//! segment crosses the planes of the box's faces. Its slope only rises, so each of the six crossings tells on which side of
//! it the nearest point lies; between the last two the slope is a straight line.
//!
//! ```text
//!            slope                      +------+
//!               |      ./               | box  |
//!               |    ./                 +------+ x
//!      ---------+--o/------ t                  \  nearest
//!          .---/                         -------o-------- segment
//! ```
//!
//! The plane across the two nearest points then bounds the gap from below, and where rounding leaves it loose (a gap that is
//! all but none) the general search is asked instead.
//!
//! # Source
//! Ericson, Real-Time Collision Detection (2005), 5.1.9, for segments; the slope that rises through the planes is ours.

use glam::DVec3;

use super::{
    boxes::half_extents,
    frame::Pair,
    gjk::Gap,
    simplex::{Simplex, Vertex},
};
use crate::{
    answer::{Method, Stop},
    math::Norm,
    shape::Core,
    tolerance::PAIR_ROUNDING,
};

/// Whether the formula is meant for the two cores.
pub(super) fn applies(pair: &Pair<'_>) -> bool {
    matches!(pair.b.core, Core::Point | Core::Segment { .. }) && half_extents(&pair.a).is_some()
}

/// The gap, if the second core is a segment or a point and the first one is these or a box, and if the formula is exact.
pub(super) fn gap(pair: &Pair<'_>) -> Option<Gap> {
    let half_a = half_extents(&pair.a)?;
    let along = match pair.b.core {
        Core::Point => DVec3::ZERO,
        Core::Segment { half_height } => pair.b.rotation.y_axis * (half_height * pair.b.scale),
        _ => return None,
    };
    let rod = Rod { middle: pair.b.position, along, half_a };
    let share = rod.nearest();
    let on_b = rod.middle + along * share;
    let on_a = on_b.clamp(-half_a, half_a);
    let apart = on_a - on_b;
    let length = apart.norm();
    let mut proved = (0.0, DVec3::ZERO);
    if length > PAIR_ROUNDING {
        let normal = apart / length;
        let plane = -normal.abs().dot(half_a) - normal.dot(rod.middle) - normal.dot(along).abs() - PAIR_ROUNDING;
        let is_exact = length - plane <= 3.0 * PAIR_ROUNDING;
        if !is_exact {
            return None;
        }
        proved = (plane.max(0.0), normal);
    }
    Some(Gap {
        lower: proved.0,
        upper: length + PAIR_ROUNDING,
        length,
        normal: proved.1,
        simplex: Simplex::of(Vertex { point: apart, on_a, corners: [rod.region(on_b), end(share)] }),
        inside: 0.0,
        iterations: 1,
        method: Method::ClosedForm,
        stop: Stop::Converged,
    })
}

/// A segment beside a box about the origin.
struct Rod {
    middle: DVec3,
    /// From the middle to one end.
    along: DVec3,
    half_a: DVec3,
}

impl Rod {
    /// Half the slope of the squared distance at `middle + along * share`.
    fn slope(&self, share: f64) -> f64 {
        let at = self.middle + self.along * share;
        (at - at.clamp(-self.half_a, self.half_a)).dot(self.along)
    }

    /// Where along the segment the box is nearest, from −1 to 1; the last of where it is equally near.
    fn nearest(&self) -> f64 {
        if self.along == DVec3::ZERO {
            return 0.0;
        }
        let (mut low, mut high) = ((-1.0, self.slope(-1.0)), (1.0, self.slope(1.0)));
        if low.1 > 0.0 {
            return low.0;
        }
        if high.1 < 0.0 {
            return high.0;
        }
        let inverse = self.along.recip();
        let (entries, exits) = ((-self.half_a - self.middle) * inverse, (self.half_a - self.middle) * inverse);
        for share in entries.to_array().into_iter().chain(exits.to_array()) {
            // NaN (a plane in which the segment lies) is between nothing.
            if share > low.0 && share < high.0 {
                let slope = self.slope(share);
                if slope <= 0.0 {
                    low = (share, slope);
                } else {
                    high = (share, slope);
                }
            }
        }
        if high.1 > low.1 { low.0 + (high.0 - low.0) * (-low.1 / (high.1 - low.1)) } else { low.0 }
    }

    /// Names the face, edge or corner of the box that a point lies over.
    fn region(&self, point: DVec3) -> u32 {
        let side =
            |axis: usize| 1 + u32::from(point[axis] > self.half_a[axis]) - u32::from(point[axis] < -self.half_a[axis]);
        side(0) + 3 * side(1) + 9 * side(2)
    }
}

/// Names the end of a segment, or what is between.
fn end(share: f64) -> u32 {
    if share <= -1.0 {
        0
    } else if share >= 1.0 {
        1
    } else {
        2
    }
}
