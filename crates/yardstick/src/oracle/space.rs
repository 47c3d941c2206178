//! Vectors and rotations of any precision.

use std::ops::{Add, Mul, Neg, Sub};

use glam::{DQuat, DVec3};

use super::double::{Double, Number};

/// Three numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vector<T> {
    /// First coordinate.
    pub(super) x: T,
    /// Second coordinate.
    pub(super) y: T,
    /// Third coordinate.
    pub(super) z: T,
}

/// A vector.
pub(super) const fn vector<T>(x: T, y: T, z: T) -> Vector<T> {
    Vector { x, y, z }
}

impl<T: Number> Vector<T> {
    /// Exactly this vector.
    #[must_use]
    pub(super) fn of(v: DVec3) -> Self {
        vector(T::of(v.x), T::of(v.y), T::of(v.z))
    }

    /// The nearest vector of f64.
    #[must_use]
    pub(super) fn nearest(self) -> DVec3 {
        DVec3::new(self.x.nearest(), self.y.nearest(), self.z.nearest())
    }

    /// The same in another precision.
    #[must_use]
    pub(super) fn rounded(self) -> Vector<f64> {
        Vector::of(self.nearest())
    }

    pub(super) fn zero() -> Self {
        vector(T::of(0.0), T::of(0.0), T::of(0.0))
    }

    #[inline]
    pub(super) fn dot(self, other: Self) -> T {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline]
    pub(super) fn cross(self, other: Self) -> Self {
        vector(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    #[inline]
    pub(super) fn length(self) -> T {
        self.dot(self).root()
    }

    /// The same direction with length 1; `None` if the length is 0 or too small for its square to have all its digits.
    #[inline]
    pub(super) fn unit(self) -> Option<Self> {
        let length = self.length();
        (length.nearest() > SHORTEST).then(|| self * (T::of(1.0) / length))
    }

    /// Less its part along a unit vector, twice, so that nothing of it is left that rounding could have kept.
    pub(super) fn across(self, along: Self) -> Self {
        let once = self - along * self.dot(along);
        once - along * once.dot(along)
    }
}

/// What is shorter is taken for nothing: squares and their errors stay in the range of f64.
const SHORTEST: f64 = 1e-60;

impl<T: Number> Add for Vector<T> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        vector(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<T: Number> Sub for Vector<T> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        vector(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<T: Number> Neg for Vector<T> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        vector(-self.x, -self.y, -self.z)
    }
}

impl<T: Number> Mul<T> for Vector<T> {
    type Output = Self;

    #[inline]
    fn mul(self, factor: T) -> Self {
        vector(self.x * factor, self.y * factor, self.z * factor)
    }
}

/// A rotation by the local axes in the frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn<T> {
    axes: [Vector<T>; 3],
}

impl Turn<Double> {
    /// The rotation of a quaternion of any length: its polynomial over its squared length, so that no root is taken.
    pub(super) fn of(rotation: DQuat) -> Self {
        let largest = rotation.to_array().iter().fold(0.0_f64, |most, part| most.max(part.abs()));
        let exponent = -exponent_of(largest);
        let [x, y, z, w] = rotation.to_array().map(|part| Double::of(times_power_of_two(part, exponent)));
        let (xx, yy, zz, ww) = (x * x, y * y, z * z, w * w);
        let one = Double::of(1.0) / (xx + yy + zz + ww);
        let two = one + one;
        Self {
            axes: [
                vector((ww + xx - yy - zz) * one, (x * y + z * w) * two, (x * z - y * w) * two),
                vector((x * y - z * w) * two, (ww - xx + yy - zz) * one, (y * z + x * w) * two),
                vector((x * z + y * w) * two, (y * z - x * w) * two, (ww - xx - yy + zz) * one),
            ],
        }
    }

    pub(super) fn rounded(self) -> Turn<f64> {
        Turn { axes: self.axes.map(Vector::rounded) }
    }
}

impl<T: Number> Turn<T> {
    /// A local vector in the frame.
    pub(super) fn out(self, local: Vector<T>) -> Vector<T> {
        self.axes[0] * local.x + self.axes[1] * local.y + self.axes[2] * local.z
    }

    /// A vector of the frame in local axes.
    pub(super) fn back(self, v: Vector<T>) -> Vector<T> {
        vector(self.axes[0].dot(v), self.axes[1].dot(v), self.axes[2].dot(v))
    }

    /// By where it takes the axes.
    pub(super) fn from_axes(axes: [Vector<T>; 3]) -> Self {
        Self { axes }
    }

    /// This rotation after another.
    pub(super) fn after(self, first: Self) -> Self {
        Self { axes: first.axes.map(|axis| self.out(axis)) }
    }

    pub(super) fn axis(self, index: usize) -> Vector<T> {
        self.axes[index]
    }
}

/// The exponent of a number's highest bit; 0 for 0.
pub(super) fn exponent_of(value: f64) -> i32 {
    let (value, shift) = if value.abs() < f64::MIN_POSITIVE { (value * 2f64.powi(64), -64) } else { (value, 0) };
    if value == 0.0 {
        return 0;
    }
    let biased = (value.to_bits() >> 52) & 0x7FF;
    i32::try_from(biased).map_or(0, |biased| biased - 1023 + shift)
}

/// `value · 2^exponent`, in two steps so that neither factor leaves the range of f64.
pub(super) fn times_power_of_two(value: f64, exponent: i32) -> f64 {
    let half = exponent / 2;
    value * 2f64.powi(half) * 2f64.powi(exponent - half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_length_of_a_quaternion_is_the_same_rotation() {
        let rotation = DQuat::from_xyzw(0.1, -0.7, 0.4, 0.3);
        let turned =
            |scale: f64| Turn::of(rotation * scale).out(vector(Double::of(1.0), Double::of(2.0), Double::of(3.0)));
        let plain = turned(1.0);
        for exponent in [-500, -60, 60, 500] {
            assert_eq!(turned(2f64.powi(exponent)), plain);
        }
        let length = plain.length() * plain.length() - Double::of(14.0);
        assert!(length.nearest().abs() < 1e-29);
        let there = Turn::of(rotation).back(plain) - vector(Double::of(1.0), Double::of(2.0), Double::of(3.0));
        assert!(there.length().nearest() < 1e-29);
    }

    #[test]
    fn powers_of_two_are_found_and_applied() {
        for (value, exponent) in [(1.0, 0), (0.75, -1), (5.0, 2), (5e-324, -1074), (0.0, 0)] {
            assert_eq!(exponent_of(value), exponent, "{value}");
        }
        assert_eq!(times_power_of_two(5e-324, 1074), 1.0);
        assert_eq!(times_power_of_two(1.0, -1074), 5e-324);
    }
}
