//! The signed distance of a point and an ellipsoid, by the root of one equation.
//!
//! # Method
//! The point `q` of the surface that is nearest to `p` has `qᵢ = rᵢ²pᵢ / dᵢ` with `dᵢ = rᵢ² − r₀² + s`, where `r₀` is the least
//! radius and `s ≥ 0` the only root of `|w| = 1`, `wᵢ = rᵢpᵢ / dᵢ`. The reciprocal of `|w|` is all but straight and bends
//! downwards, so Newton's steps from the left never go too far, and a few are enough. Inside, near the middle of the other
//! radii, `s` is 0 and `q` lies off `p` along the least radius.
//!
//! ```text
//!        .---x---.      two points of the surface are equally near to a point in the middle:
//!      /     |     \    of the two the one on the positive side is taken
//!     |      p      |
//! ```
//!
//! Nothing rests on the root: the direction `pᵢ / dᵢ` bounds the signed distance from below by its plane, whatever it is.
//! From above it is bounded by a point of the surface, outside; inside by a ball about `p` that is proved to lie in the ellipsoid:
//! for any `λ = r₀² − s` from 0 to `r₀²` the square of its radius is no less than `λ(1 − Σ pᵢ²/dᵢ)`, since that is the least
//! value of `|q − p|² + λ(1 − Σ qᵢ²/rᵢ²)` over all `q`, which points of the surface and beyond cannot go below.
//!
//! # Source
//! Eberly, "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid" (2013): the equation and its cases.
//! Moré, Sorensen, "Computing a trust region step" (1983), section 3: Newton's method on the reciprocal, which needs no
//! bracket. The proof from both sides is ours.

use glam::DVec3;

use super::{
    formula::{Signed, plane},
    frame::Pair,
};
use crate::{
    math::Norm,
    shape::Core,
    tolerance::{BALL_INSIDE, ON_AXIS, PAIR_ROUNDING, ROUNDING},
};

/// Most steps towards the root: 5 to 10 do, and answers stay proved without.
const STEPS_MAX: usize = 48;

/// The signed distance, if the first core is an ellipsoid and the second a point.
pub(super) fn signed(pair: &Pair<'_>) -> Option<Signed> {
    let (Core::Ellipsoid { radii }, Core::Point) = (pair.a.core, pair.b.core) else { return None };
    let radii = *radii * pair.a.scale;
    let point = pair.b.position;
    let root = Root::of(radii, point);
    let outward = root.outward()?;
    let normal = DVec3::ZERO - outward;
    let on_a = pair.a.support(outward).point;
    let lower = plane(pair, normal);
    let is_outside = lower + PAIR_ROUNDING >= 0.0;
    let upper = PAIR_ROUNDING + if is_outside { (point - on_a).norm() } else { -root.ball() };
    Some(Signed { lower: lower.min(upper), upper, normal, on_a, on_b: point, common: point, corners: [0; 2] })
}

/// The radius of the greatest ball about a point that is proved to lie in the ellipsoid of these radii about the origin, 0 if none is,
/// and the unit vector to where the surface is nearest.
pub(super) fn ball_about(radii: DVec3, point: DVec3) -> Option<(f64, DVec3)> {
    let root = Root::of(radii, point);
    Some((root.ball(), root.outward()?))
}

/// The root and what it belongs to. Components where the point is 0 count for nothing.
struct Root {
    radii: DVec3,
    point: DVec3,
    /// `rᵢ² − r₀²`.
    beyond_least: DVec3,
    /// `r₀`
    least: f64,
    /// `s`, never above the root but for rounding.
    s: f64,
}

impl Root {
    fn of(radii: DVec3, point: DVec3) -> Self {
        let point = DVec3::from_array(point.to_array().map(|at| if at.abs() <= ON_AXIS { 0.0 } else { at }));
        let least = radii.min_element();
        let beyond_least = (radii - least) * (radii + least);
        // Where one of the wᵢ alone is 1.
        let start = (radii * point.abs() - beyond_least).max_element().max(0.0);
        let mut root = Self { radii, point, beyond_least, least, s: start };
        for _ in 0..STEPS_MAX {
            let [length_sq, slope] = root.weight();
            let next = root.s + (length_sq.sqrt() - 1.0) * length_sq / slope;
            // NaN (a point in the middle) ends it as well.
            if length_sq > 1.0 && next > root.s {
                root.s = next;
            } else {
                break;
            }
        }
        root
    }

    /// Each component's part by its coordinate and `dᵢ`.
    fn parts(&self, part: impl Fn(f64, f64) -> f64) -> DVec3 {
        let of = |i: usize| {
            let at = self.point[i];
            if at == 0.0 { 0.0 } else { part(at, self.beyond_least[i] + self.s) }
        };
        DVec3::new(of(0), of(1), of(2))
    }

    /// `|w|²`, and `Σ wᵢ²/dᵢ`.
    fn weight(&self) -> [f64; 2] {
        let weights = self.radii * self.parts(|at, d| at / d);
        let by_d = self.parts(|_, d| 1.0 / d);
        let squares = weights * weights;
        [squares.element_sum(), squares.dot(by_d)]
    }

    /// The direction of the surface's normal at the nearest point.
    fn outward(&self) -> Option<DVec3> {
        let mut direction = self.parts(|at, d| at / d);
        if self.s == 0.0 {
            let rest = (1.0 - (self.radii * direction).length_squared()).max(0.0).sqrt();
            let axis = self.radii.to_array().iter().position(|&radius| radius == self.least)?;
            direction[axis] += rest / self.least;
        }
        direction.try_unit()
    }

    /// The radius of a ball about the point that lies in the ellipsoid; 0 if none is proved to.
    fn ball(&self) -> f64 {
        let lambda = self.least * self.least * (1.0 - 4.0 * ROUNDING) - self.s;
        let rest = 1.0 - self.parts(|at, d| at * at / d).element_sum() - BALL_INSIDE;
        if lambda > 0.0 && rest > 0.0 { (lambda * rest).sqrt() * (1.0 - 4.0 * ROUNDING) } else { 0.0 }
    }
}
