//! The point of a triangle that is nearest to another, with a proof on both sides of how near that is.
//!
//! # Method
//! The weights of the nearest point come from plain arithmetic. Whatever they are, the point that they name is in the
//! triangle, so its distance bounds from above; and a triangle lies beyond the plane across the way to it through its lowest
//! corner, so that plane's distance bounds from below.
//!
//! # Source
//! The regions of a triangle: Ericson, "Real-Time Collision Detection" (2005), section 5.1.5.
//!
//! # Limits
//! Of needles the weights lose digits, and the two bounds then stand apart.

use glam::DVec3;

use crate::{
    math::Norm,
    tolerance::{FOOT_ROUNDING, LENGTH_WIDENING, SQUARE_MIN},
};

/// How far a point is from a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    /// Not above the true distance.
    pub(crate) lower: f64,
    /// Not below it.
    pub(crate) upper: f64,
    /// From the point to the nearest of the triangle.
    pub(crate) way: DVec3,
}

/// The foot of `point` on a triangle, in about 30 ns.
pub(crate) fn foot(point: DVec3, corners: [DVec3; 3]) -> Foot {
    let to = corners.map(|corner| corner - point);
    let [u, v, w] = weights(to);
    let way = to[0] * u + to[1] * v + to[2] * w;
    let size = to[0].abs().max(to[1].abs()).max(to[2].abs()).element_sum();
    let (length_sq, slack) = (way.length_squared(), size * FOOT_ROUNDING);
    if length_sq < SQUARE_MIN {
        return Foot { lower: 0.0, upper: way.abs().element_sum() + slack, way };
    }
    let length = length_sq.sqrt();
    let lowest = way.dot(to[0]).min(way.dot(to[1])).min(way.dot(to[2]));
    Foot { lower: (lowest / length - slack).max(0.0), upper: length * LENGTH_WIDENING + slack, way }
}

/// Weights of the point of a triangle that is nearest to the origin, each at least 0, their sum 1 to within rounding.
fn weights([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (-ab.dot(a), -ac.dot(a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (d3, d4) = (-ab.dot(b), -ac.dot(b));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let share = part_of(d1, d1 - d3);
        return [1.0 - share, share, 0.0];
    }
    let (d5, d6) = (-ab.dot(c), -ac.dot(c));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let share = part_of(d2, d2 - d6);
        return [1.0 - share, 0.0, share];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let share = part_of(d4 - d3, (d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - share, share];
    }
    let total = va + vb + vc;
    if total > 0.0 { [va / total, vb / total, vc / total] } else { [1.0, 0.0, 0.0] }
}

/// A quotient from 0 to 1; 0 if there is none.
fn part_of(part: f64, whole: f64) -> f64 {
    let share = part / whole;
    if share > 0.0 { share.min(1.0) } else { 0.0 }
}

/// The radius of a ball about `center` that holds points, rounded up.
pub(crate) fn radius_up(center: DVec3, points: &[DVec3]) -> f64 {
    points.iter().map(|&point| (point - center).norm()).fold(0.0, f64::max) * LENGTH_WIDENING
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        accuracy::{Accuracy, Tier},
        answer::Work,
        math::Pose,
        narrow::{Placed, distance},
        shape::Geometry,
    };

    /// Both this interval and that of the kernel for pairs hold the truth, so they have a number in common; and this one is narrow
    /// unless the triangle is a needle.
    #[test]
    fn a_foot_is_bounded_on_both_sides() {
        let mut state = 0x0DD5_EED5_u64;
        let mut signed = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut narrow = 0;
        for round in 0..4000 {
            let mut vector = || DVec3::new(signed(), signed(), signed());
            let (a, along) = (vector(), vector());
            let thin = [1.0, 1e-3, 1e-7, 1e-12][round % 4];
            let corners = [a, a + along, a + along * 0.3 + vector() * thin];
            let on_it = a + along * 0.6 + (corners[2] - a) * 0.2;
            let point = if round % 3 == 0 { on_it + vector() * 1e-9 } else { vector() * 3.0 };
            let Ok(triangle) = Geometry::mesh(&corners, &[[0, 1, 2]]) else { continue };
            let here = Placed { geometry: &Geometry::point(), pose: Pose::at(point) };
            let there = Placed { geometry: &triangle, pose: Pose::IDENTITY };
            let known = distance(here, there, f64::INFINITY, &Accuracy::of(Tier::Exact), &mut Work::default());
            let known = known.expect("no limit").certificate.bound;
            let found = foot(point, corners);
            assert!(
                found.lower <= known.upper && known.lower <= found.upper,
                "{point} {corners:?} {known:?} {found:?}"
            );
            narrow += u32::from(found.upper - found.lower < 1e-13);
        }
        assert!(narrow > 2500, "{narrow}");
    }
}
