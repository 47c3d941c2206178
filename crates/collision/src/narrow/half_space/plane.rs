//! The plane of a half space where it is, and how high things are above it.
//!
//! # Method
//! The unit normal in the world is computed in numbers of twice the length, and so is the height of a point that is given
//! by exact differences of what was sent. So a form that stands on a plane a thousand kilometres from everything is
//! measured as finely as one at the origin.

use glam::DVec3;

use crate::{
    math::{Pose, scaled_by_power_of_two, twofold::Twofold},
    shape::HalfSpace,
    tolerance::TWOFOLD_HEIGHT,
};

/// A vector in numbers of twice the length.
pub(in crate::narrow) type Vector = [Twofold; 3];

/// A half space in the world.
#[derive(Clone, Copy)]
pub(in crate::narrow) struct Plane {
    /// Outward unit normal, world axes, each component the nearest f64.
    pub(in crate::narrow) normal: DVec3,
    axis: Vector,
    offset: f64,
}

/// A number and how far it may be from the true one.
#[derive(Clone, Copy, Debug)]
pub(in crate::narrow) struct Height {
    pub(in crate::narrow) value: Twofold,
    pub(in crate::narrow) error: f64,
}

impl Plane {
    pub(in crate::narrow) fn new(half_space: &HalfSpace, pose: &Pose) -> Self {
        let sent = scaled_by_power_of_two(half_space.normal);
        let axis = if pose.rotation.xyz() != DVec3::ZERO {
            unit(turned(pose, sent))
        } else {
            unit(sent.to_array().map(Twofold::of))
        };
        let normal = DVec3::from_array(axis.map(|component| component.high)) + DVec3::ZERO;
        Self { normal, axis, offset: half_space.offset }
    }

    /// Height above the plane of what is `from_origin` away from the half space's local origin.
    pub(in crate::narrow) fn height(&self, from_origin: &Vector) -> Height {
        let height = self.along(from_origin);
        Height {
            value: height.value - Twofold::of(self.offset),
            error: height.error + TWOFOLD_HEIGHT * self.offset.abs(),
        }
    }

    /// Largest component of the sum of the unit normals, to within twice [`TWOFOLD_HEIGHT`].
    pub(super) fn sum_of_normals(&self, other: &Self) -> f64 {
        [0, 1, 2].map(|axis| (self.axis[axis] + other.axis[axis]).high.abs()).into_iter().fold(0.0, f64::max)
    }

    /// How far a vector goes along the unit normal.
    pub(in crate::narrow) fn along(&self, vector: &Vector) -> Height {
        let [x, y, z] = [0, 1, 2].map(|axis| self.axis[axis] * vector[axis]);
        let size: f64 = vector.iter().map(|component| component.high.abs()).sum();
        Height { value: x + y + z, error: TWOFOLD_HEIGHT * size }
    }
}

/// Exactly `a - b`.
pub(in crate::narrow) fn difference(a: DVec3, b: DVec3) -> Vector {
    [0, 1, 2].map(|axis| Twofold::difference(a[axis], b[axis]))
}

/// The vector along `v` of length 1; `v` is not 0, its largest component between 1 and 64.
pub(in crate::narrow) fn unit(v: Vector) -> Vector {
    let along_axis = (0..3).find(|&axis| (0..3).all(|other| other == axis || v[other] == Twofold::default()));
    if let Some(axis) = along_axis {
        let mut unit = Vector::default();
        unit[axis] = Twofold::of(1f64.copysign(v[axis].high));
        return unit;
    }
    let length = dot(&v, &v).sqrt();
    v.map(|component| component / length)
}

/// `v` turned, and as many times longer as the largest component of the quaternion is taken to be 1 to 2:
/// `(w² − u²) v + 2 (u·v) u + 2 w (u × v)` for a quaternion `u + w`.
fn turned(pose: &Pose, v: DVec3) -> Vector {
    let [x, y, z, w] = scaled_rotation(pose);
    let (u, v) = ([x, y, z].map(Twofold::of), v.to_array().map(Twofold::of));
    let (w, two) = (Twofold::of(w), Twofold::of(2.0));
    let stretch = w * w - dot(&u, &u);
    let along = two * dot(&u, &v);
    let across = cross(&u, &v).map(|component| two * w * component);
    [0, 1, 2].map(|axis| stretch * v[axis] + along * u[axis] + across[axis])
}

/// The quaternion times a power of two.
fn scaled_rotation(pose: &Pose) -> [f64; 4] {
    let [x, y, z, w] = pose.rotation.to_array();
    let largest = x.abs().max(y.abs()).max(z.abs()).max(w.abs());
    let scaled = |a: f64, b: f64| scaled_by_power_of_two(DVec3::new(a, b, largest));
    let (first, second) = (scaled(x, y), scaled(z, w));
    [first.x, first.y, second.x, second.y]
}

fn dot(a: &Vector, b: &Vector) -> Twofold {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    let component = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [component(1, 2), component(2, 0), component(0, 1)]
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    #[test]
    fn a_turned_normal_is_right_to_twice_the_digits() {
        // By hand, from M(q)/|q|² with |q|² = 25.
        let pose = Pose::new(DVec3::ZERO, DQuat::from_xyzw(1.0, 2.0, 2.0, 4.0));
        let space = HalfSpace { normal: DVec3::Y * 1e-200, offset: 0.0 };
        let plane = Plane::new(&space, &pose);
        let truth = [-12.0, 15.0, 16.0].map(|numerator| Twofold::of(numerator) / Twofold::of(25.0));
        for (found, exact) in plane.axis.into_iter().zip(truth) {
            let miss = found - exact;
            assert!(miss.high.abs() < TWOFOLD_HEIGHT / 4.0, "{found:?} is off by {}", miss.high);
        }
    }
}
