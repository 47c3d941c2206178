//! The friction of one contact point.

use glam::{DMat2, DMat3, DVec2, DVec3};

use crate::math::Norm;

/// The friction impulse across `normal` that stops `slides`, the velocity at the point after the friction `before` acted, or
/// as much of it as `most` allows. `yielding` is what an impulse there changes of the velocity.
pub(super) fn impulse(yielding: &DMat3, normal: DVec3, slides: DVec3, before: DVec3, most: f64) -> DVec3 {
    if most <= 0.0 {
        return DVec3::ZERO;
    }
    let (first, second) = normal.any_orthonormal_pair();
    let along = |vector: DVec3| DVec2::new(vector.dot(first), vector.dot(second));
    let (of_first, of_second) = (along(*yielding * first), along(*yielding * second));
    let matrix = DMat2::from_cols(of_first, of_second);
    let determinant = matrix.determinant();
    if determinant <= 0.0 {
        return before;
    }
    let slides = along(slides);
    let change = DVec2::new(
        (slides.y * of_second.x - slides.x * of_second.y) / determinant,
        (slides.x * of_first.y - slides.y * of_first.x) / determinant,
    );
    let wanted = along(before) + change;
    let length = wanted.norm();
    let wanted = if length > most { wanted * (most / length) } else { wanted };
    first * wanted.x + second * wanted.y
}
