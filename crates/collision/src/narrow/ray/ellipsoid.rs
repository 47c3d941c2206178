//! Rays against ellipsoids.
//!
//! # Method
//! Divided by the half axes, the ellipsoid is a ball, and the chord is measured from the point of the line nearest to its
//! middle *there*. Coordinates are rounded before they are divided, so that the aspect of the ellipsoid costs nothing; what
//! is rounded after it is a part of the chord's own size.
//!
//! An ellipsoid moved out by an error is no ellipsoid. Those between which it lies are chosen for each wall: with w the
//! distance from the middle to the tangent plane at a point and e the error,
//!
//! ```text
//!   R² = r² ± e·(r²/w + w) + e²        w |<------|  tangent plane
//!                                        | .--.  |
//!                                        +(----)-|
//! ```
//!
//! has at a tangent plane at distance h a distance of `h ± e` or more: the squares differ by `e·(h − w)²/w`, nothing at that
//! very point. One choice for all points would be wider by half the root of the aspect, scaling as a whole by the aspect.
//!
//! # Source
//! Outer and inner ellipsoids of a sum: Kurzhanski, Vályi, "Ellipsoidal Calculus for Estimation and Control" (1997),
//! section 2.2, here for an ellipsoid and a ball.
//!
//! # Limits
//! Where the least half axis is not above the error, nothing is surely hit.

use glam::DVec3;

use super::{
    crossing::Crossing,
    frame::LocalRay,
    stretch::{Nested, Stretch},
};
use crate::math::Norm;

/// Where the line crosses an ellipsoid about the centre; `None` if surely nowhere.
pub(super) fn crossing(ray: &LocalRay, radii: DVec3) -> Option<Crossing> {
    let best = Chord::new(ray, radii);
    let walls = [best.stretch().begin, best.stretch().end].map(|at| {
        let point = ray.foot + ray.direction * at;
        tangent_distance(point, radii)
    });
    let error = 2.0 * ray.error;
    let [first, second] = walls.map(|w| Chord::new(ray, larger(radii, error, w)).inside());
    let outer = first?.and(second?)?;
    let inner = walls.map(|w| Chord::new(ray, smaller(radii, error, w)?).inside());
    let nested = Nested { outer, inner: inner.into_iter().flatten().reduce(Stretch::hull), best: best.stretch() };
    Some(nested.crossing(ray, |point| point / (radii * radii)))
}

/// How far from the middle the tangent plane is that touches where the ray from the middle through `point` leaves.
fn tangent_distance(point: DVec3, radii: DVec3) -> f64 {
    let on_ball = point / radii;
    let normal = (on_ball / radii).norm();
    let distance = on_ball.norm() / normal;
    if distance.is_finite() { distance.clamp(radii.min_element(), radii.max_element()) } else { radii.min_element() }
}

/// An ellipsoid that holds all points within `error` of the one of `radii`.
fn larger(radii: DVec3, error: f64, w: f64) -> DVec3 {
    let squares = radii * radii;
    squares_root(squares + (squares / w + w) * error + error * error)
}

/// An ellipsoid whose points are all `error` within the one of `radii`. `w` is lowered as far as the least half axis needs.
fn smaller(radii: DVec3, error: f64, w: f64) -> Option<DVec3> {
    let least = radii.min_element();
    if least <= error {
        return None;
    }
    let w = w.min(least.max(0.5 * least / error * least));
    // The same as above, as a product of two factors above 0.
    let squares = radii * radii - w * error;
    (squares.min_element() > 0.0 && w > error).then(|| squares_root(squares * ((w - error) / w)))
}

fn squares_root(squares: DVec3) -> DVec3 {
    DVec3::new(squares.x.sqrt(), squares.y.sqrt(), squares.z.sqrt())
}

/// How a line goes by an ellipsoid.
struct Chord {
    /// Where it is nearest to the middle in the ball's measure, metres from the foot.
    middle: f64,
    /// From there to the surface; `None` if it passes by.
    half: Option<f64>,
}

impl Chord {
    fn new(ray: &LocalRay, radii: DVec3) -> Self {
        let scaled = ray.direction / radii;
        let speed = scaled.norm();
        let direction = scaled / speed;
        let shift = -(ray.foot / radii).dot(direction) / speed;
        let nearest = (ray.foot + ray.direction * shift) / radii;
        // The shift is rounded, so a little may be left along the line.
        let along = nearest.dot(direction);
        let distance = (nearest - direction * along).norm();
        let half = (distance <= 1.0).then(|| ((1.0 - distance) * (1.0 + distance)).sqrt() / speed);
        Self { middle: shift - along / speed, half }
    }

    fn inside(&self) -> Option<Stretch> {
        let half = self.half?;
        Some(Stretch { begin: self.middle - half, end: self.middle + half })
    }

    /// The stretch inside, or the point nearest to it.
    fn stretch(&self) -> Stretch {
        self.inside().unwrap_or(Stretch { begin: self.middle, end: self.middle })
    }
}
