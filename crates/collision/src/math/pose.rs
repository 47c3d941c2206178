//! A rigid transform: rotate, then translate.

use glam::{DMat3, DQuat, DVec2, DVec3};

use super::Norm;
use crate::tolerance::SQUARE_MIN;

/// A rigid transform: rotate, then translate. The rotation is kept as it was sent, of any length but 0, and
/// normalised where it is used, so that what was stored can be read back bit by bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Translation in metres.
    pub position: DVec3,
    /// Rotation, of any length but 0.
    pub rotation: DQuat,
}

impl Pose {
    /// The origin, unrotated.
    pub const IDENTITY: Self = Self { position: DVec3::ZERO, rotation: DQuat::IDENTITY };

    /// A pose; the numbers must be finite and the quaternion not 0, which the caller has checked.
    #[must_use]
    pub const fn new(position: DVec3, rotation: DQuat) -> Self {
        Self { position, rotation }
    }

    /// A pose without rotation.
    #[must_use]
    pub const fn at(position: DVec3) -> Self {
        Self::new(position, DQuat::IDENTITY)
    }

    /// The rotation as a unit quaternion. The largest component is scaled to 1 first, so that no square overflows or
    /// vanishes.
    #[must_use]
    pub fn unit_rotation(&self) -> DQuat {
        let [x, y, z, w] = self.rotation.to_array();
        let largest = x.abs().max(y.abs()).max(z.abs()).max(w.abs());
        let (x, y, z, w) = (x / largest, y / largest, z / largest, w / largest);
        let length = (x * x + y * y + z * z + w * w).sqrt();
        DQuat::from_xyzw(x / length, y / length, z / length, w / length)
    }

    /// The rotation as a matrix whose columns are the local axes in the world: that of the unit quaternion, made without
    /// its root, since a matrix needs products of two components only. Each entry is right to 32 roundings: at most 4 for
    /// the square of the length, 1 for the quotient, 3 for a sum of two products, on values of up to 2, and 1 for 1 less that.
    #[must_use]
    #[inline(always)]
    pub fn matrix(&self) -> DMat3 {
        let length_sq = self.rotation.length_squared();
        if !(SQUARE_MIN..1.0 / SQUARE_MIN).contains(&length_sq) {
            return self.matrix_of_unit();
        }
        let twice = 2.0 / length_sq;
        let [x, y, z, w] = self.rotation.to_array();
        let (x2, y2, z2) = (x * twice, y * twice, z * twice);
        let (xx, yy, zz) = (x * x2, y * y2, z * z2);
        let (xy, xz, yz) = (x * y2, x * z2, y * z2);
        let (wx, wy, wz) = (w * x2, w * y2, w * z2);
        DMat3::from_cols(
            DVec3::new(1.0 - (yy + zz), xy + wz, xz - wy),
            DVec3::new(xy - wz, 1.0 - (xx + zz), yz + wx),
            DVec3::new(xz + wy, yz - wx, 1.0 - (xx + yy)),
        )
    }

    /// [`Pose::matrix`] where the quaternion's square leaves the range in which f64 has all its digits.
    #[cold]
    fn matrix_of_unit(&self) -> DMat3 {
        DMat3::from_quat(self.unit_rotation())
    }

    /// The turn from this rotation to that of `end` along the shorter arc, as a rotation vector: the axis times the angle,
    /// radians, in the axes of the world, at most half a turn. Exactly 0 between equal rotations, written with either sign.
    /// Which way half a turn goes follows from the signs sent. The vector is right to 64 roundings of 1, which the kernels
    /// for motions count in.
    ///
    /// ```
    /// use collision::{DQuat, DVec3, math::Pose};
    /// let turned = |z, w| Pose::new(DVec3::ZERO, DQuat::from_xyzw(0.0, 0.0, z, w));
    /// let quarter = turned(0.0, 1.0).rotation_vector_to(&turned(-3.0, 3.0));
    /// assert!((quarter - DVec3::Z * -std::f64::consts::FRAC_PI_2).length() < 1e-15);
    /// assert_eq!(turned(1.0, 1.0).rotation_vector_to(&turned(-2.0, -2.0)), DVec3::ZERO);
    /// ```
    #[must_use]
    pub fn rotation_vector_to(&self, end: &Self) -> DVec3 {
        let (from, to) = (self.unit_rotation(), end.unit_rotation());
        if from == to || from == -to {
            return DVec3::ZERO;
        }
        let cosine = from.x * to.x + from.y * to.y + from.z * to.z + from.w * to.w;
        let to = if cosine < 0.0 { -to } else { to };
        // The vector part of `to` times the inverse of `from`: the axis times the sine of half the angle.
        let along = to.xyz() * from.w - from.xyz() * to.w - to.xyz().cross(from.xyz());
        let sine = along.norm();
        if sine <= 0.0 {
            return DVec3::ZERO;
        }
        let half = DVec2::new(cosine.abs(), sine).to_angle();
        along / sine * (2.0 * half)
    }

    /// The pose on the way to `end`, `fraction` of the way from 0 to 1: the position in a straight line, the rotation by
    /// constant angular velocity along the shorter arc. At 0 it is this one as it is.
    ///
    /// ```
    /// use collision::{DQuat, DVec3, math::Pose};
    /// let quarter = DQuat::from_xyzw(0.0, 1.0, 0.0, 1.0);
    /// let half_way = Pose::IDENTITY.between(&Pose::new(DVec3::X * 4.0, quarter), 0.5);
    /// assert_eq!(half_way.position, DVec3::X * 2.0);
    /// let turned = half_way.transform_point(DVec3::X) - half_way.position;
    /// assert!((turned - DVec3::new(0.5_f64.sqrt(), 0.0, -(0.5_f64.sqrt()))).length() < 1e-15);
    /// ```
    #[must_use]
    pub fn between(&self, end: &Self, fraction: f64) -> Self {
        if fraction <= 0.0 {
            return *self;
        }
        let rotation = self.rotation_after(self.rotation_vector_to(end), fraction);
        Self { position: self.position + (end.position - self.position) * fraction, rotation }
    }

    /// The rotation after a part of a turn, which is a rotation vector in the axes of the world.
    #[must_use]
    pub(crate) fn rotation_after(&self, turn: DVec3, fraction: f64) -> DQuat {
        match turn.try_unit() {
            Some(axis) => DQuat::from_axis_angle(axis, turn.norm() * fraction) * self.unit_rotation(),
            None => self.rotation,
        }
    }

    /// The square of the distance of both unit quaternions, of the two of equal rotation the nearer ones: 0 for equal
    /// rotations, 2 for half a turn.
    #[must_use]
    pub(crate) fn chord_sq(&self, end: &Self) -> f64 {
        let (from, to) = (self.unit_rotation(), end.unit_rotation());
        (from - to).length_squared().min((from + to).length_squared())
    }

    /// Takes a local point into the world.
    #[must_use]
    pub fn transform_point(&self, local: DVec3) -> DVec3 {
        self.matrix() * local + self.position
    }
}
