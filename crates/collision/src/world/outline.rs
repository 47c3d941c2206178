//! Where a subject surely is not, told by the canonical box of the other side alone.
//!
//! # Method
//! A subject that is turned fills little of its canonical box: a cube a third of it. Its local box, turned as it is, lies closer
//! around it, and so does a ball around a point. Three axes of the one or the distance from the middle of the other tell
//! of most boxes that only a corner of the canonical box touches that their shapes are clear of the subject, before anything
//! else of those shapes is read.
//!
//! # Source
//! Gottschalk, Lin, Manocha, "OBBTree" (1996), section 5: the three of the fifteen axes that are the subject's own.

use glam::{DMat3, DVec3};

use super::search::Side;
use crate::{
    math::Aabb,
    shape::{Core, Form},
    tolerance,
};

/// Where a subject is, as closely as can be told at little cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outline {
    /// Its canonical box.
    bounds: Aabb,
    within: Within,
}

/// What else it lies within.
#[derive(Clone, Copy, Debug)]
enum Within {
    /// Nothing that is smaller than the canonical box.
    Bounds,
    /// All points within a distance whose square is this of a point.
    Ball { center: DVec3, radius_sq: f64 },
    /// A box about the place `position`, between `low` and `high` along `axes`, which are the rows of a rotation.
    Turned { position: DVec3, axes: DMat3, low: DVec3, high: DVec3, magnitude: f64 },
}

impl Outline {
    /// Only the box.
    pub(super) fn of_box(bounds: Aabb) -> Self {
        Self { bounds, within: Within::Bounds }
    }

    /// That of a subject where it is.
    pub(super) fn of(subject: &Side<'_>) -> Self {
        let (geometry, pose) = (subject.placed.geometry, &subject.placed.pose);
        let within = match geometry.form() {
            Form::Convex(convex) if matches!(convex.core, Core::Point) => {
                let radius = geometry.reach() * tolerance::LENGTH_WIDENING;
                Within::Ball { center: pose.position, radius_sq: radius * radius * tolerance::LENGTH_WIDENING }
            }
            Form::Convex(_) | Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_)
                if pose.rotation.xyz() != DVec3::ZERO =>
            {
                let Aabb { min, max } = geometry.local_bounds();
                let magnitude = pose.position.abs().element_sum() + min.abs().max(max.abs()).element_sum();
                Within::Turned { position: pose.position, axes: pose.matrix(), low: min, high: max, magnitude }
            }
            Form::Convex(_) | Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_) | Form::HalfSpace(_) => {
                Within::Bounds
            }
        };
        Self { bounds: subject.bounds, within }
    }

    /// Its canonical box.
    pub(super) fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Whether what lies within `other` may touch the subject. If not, the two are proved to be apart.
    #[inline]
    pub(super) fn may_touch(&self, other: &Aabb) -> bool {
        let touches_bounds = self.bounds.intersects(*other);
        touches_bounds
            & match &self.within {
                Within::Bounds => true,
                Within::Ball { center, radius_sq } => {
                    let nearest = center.clamp(other.min, other.max);
                    let rounding = center.abs().max_element() * tolerance::OUTLINE;
                    let apart = ((*center - nearest).abs() - rounding).max(DVec3::ZERO);
                    apart.length_squared() <= *radius_sq
                }
                Within::Turned { position, axes, low, high, magnitude } => {
                    let (middle, half) = (other.center() - *position, (other.max - other.min) * 0.5);
                    let rounding =
                        (magnitude + other.min.abs().max(other.max.abs()).element_sum()) * tolerance::OUTLINE;
                    let along = DVec3::new(axes.x_axis.dot(middle), axes.y_axis.dot(middle), axes.z_axis.dot(middle));
                    let reach = |axis: DVec3| axis.abs().dot(half) + rounding;
                    let reach = DVec3::new(reach(axes.x_axis), reach(axes.y_axis), reach(axes.z_axis));
                    (along - reach).cmple(*high).all() & (along + reach).cmpge(*low).all()
                }
            }
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::{math::Pose, shape::Geometry};

    /// Turns by whole quaternions and lengths that are multiples of their squares: the places are whole numbers, exactly.
    #[test]
    fn what_touches_the_surface_is_looked_at() {
        let mut state = 3_u64;
        let mut next = |below: i64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as i64 % below
        };
        let mut clear = 0;
        for round in 0..20_000 {
            let [x, y, z, w] = [(); 4].map(|()| (next(9) - 4) as f64);
            let square = x * x + y * y + z * z + w * w;
            if x == 0.0 && y == 0.0 && z == 0.0 {
                continue;
            }
            let half = DVec3::from_array([(); 3].map(|()| (1 + next(50)) as f64));
            let mut local =
                DVec3::from_array([0, 1, 2].map(|axis| (next(2 * half[axis] as i64 + 1)) as f64 - half[axis]));
            let across = next(3) as usize;
            local[across] = half[across];
            let whole = DMat3::from_cols(
                DVec3::new(w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
                DVec3::new(2.0 * (x * y - w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z + w * x)),
                DVec3::new(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w - x * x - y * y + z * z),
            );
            let far = if round % 2 == 0 { 1 } else { 1 << 30 };
            let position = DVec3::from_array([(); 3].map(|()| ((next(2001) - 1000) * far) as f64));
            let geometry = Geometry::cuboid(half * square).expect("a box");
            let subject = Side::at(&geometry, Pose::new(position, DQuat::from_xyzw(x, y, z, w)), None);
            let (outline, touched) = (Outline::of(&subject), position + whole * local);
            let place = Aabb::new(touched, touched);
            assert!(outline.may_touch(&place), "{local} on {half} turned by {x} {y} {z} {w} at {position}");
            let beside = touched + whole * DVec3::AXES[across] * 1e-3;
            clear += usize::from(!outline.may_touch(&Aabb::new(beside, beside)) && far == 1);
        }
        assert!(clear > 9000, "vacuous: {clear}");
    }

    #[test]
    fn a_ball_is_clear_of_what_a_corner_of_its_box_touches() {
        let ball = Geometry::sphere(5.0).expect("a ball");
        let outline = Outline::of(&Side::at(&ball, Pose::at(DVec3::splat(1e6)), None));
        let at =
            |x: f64, y: f64| Aabb::new(DVec3::new(1e6 + x, 1e6 + y, 1e6), DVec3::new(1e6 + 9.0, 1e6 + 9.0, 1e6 + 9.0));
        assert!(outline.may_touch(&at(3.0, 4.0)) && !outline.may_touch(&at(3.0, 4.000_001)));
        assert!(!outline.may_touch(&at(5.1, 0.0)));
    }
}
