//! Numbers of twice the digits of f64, and what a line does to a body in them: slow, obvious, and none of the crate's.
#![allow(dead_code, reason = "each test file uses its part of it")]

use std::{
    cmp::Ordering,
    ops::{Add, Div, Mul, Neg, Sub},
};

use collision::{DVec3, math::Pose};

/// The sum of two f64 that do not overlap: about 32 digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Double {
    high: f64,
    low: f64,
}

pub(crate) type D3 = [Double; 3];

impl Double {
    pub(crate) const ZERO: Self = Self { high: 0.0, low: 0.0 };

    fn of_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let back = high - a;
        Self { high, low: (a - (high - back)) + (b - back) }
    }

    pub(crate) fn to_f64(self) -> f64 {
        self.high + self.low
    }

    pub(crate) fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        let near = Self::from(self.high.sqrt());
        near + (self - near * near) / (near + near)
    }

    pub(crate) fn is_negative(self) -> bool {
        self.high < 0.0
    }

    pub(crate) fn abs(self) -> Self {
        if self.is_negative() { -self } else { self }
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (Self::of_sum(self.high, other.high), Self::of_sum(self.low, other.low));
        let sum = Self::of_sum(high.high, high.low + low.high);
        Self::of_sum(sum.high, sum.low + low.low)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = self.high * other.high;
        let error = self.high.mul_add(other.high, -product);
        Self::of_sum(product, error + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * first.into();
        let second = rest.high / other.high;
        let rest = rest - other * second.into();
        Self::of_sum(first, second) + (rest.high / other.high).into()
    }
}

impl PartialOrd for Double {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        (*self - *other).high.partial_cmp(&0.0)
    }
}

pub(crate) fn vector(v: DVec3) -> D3 {
    v.to_array().map(Double::from)
}

pub(crate) fn dot(a: D3, b: D3) -> Double {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn minus(a: D3, b: D3) -> D3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + b * t`.
pub(crate) fn along(a: D3, b: D3, t: Double) -> D3 {
    [a[0] + b[0] * t, a[1] + b[1] * t, a[2] + b[2] * t]
}

/// The vector turned back by a pose's rotation, as if its quaternion were normalised exactly.
fn turned_back(pose: &Pose, v: D3) -> D3 {
    let [x, y, z, w] = pose.rotation.to_array().map(Double::from);
    let (xx, yy, zz, ww) = (x * x, y * y, z * z, w * w);
    let twice = |value: Double| value + value;
    let norm = xx + yy + zz + ww;
    let rows = [
        [ww + xx - yy - zz, twice(x * y + w * z), twice(x * z - w * y)],
        [twice(x * y - w * z), ww - xx + yy - zz, twice(y * z + w * x)],
        [twice(x * z + w * y), twice(y * z - w * x), ww - xx - yy + zz],
    ];
    rows.map(|row| dot(row, v) / norm)
}

/// A line in the frame of its target: `start + direction * t`, `t` in metres from where the ray begins plus `shift`.
pub(crate) struct Line {
    pub(crate) start: D3,
    pub(crate) direction: D3,
    pub(crate) shift: Double,
}

impl Line {
    /// From the point nearest to the target's origin.
    pub(crate) fn new(origin: DVec3, direction: DVec3, pose: &Pose) -> Self {
        let far = turned_back(pose, minus(vector(origin), vector(pose.position)));
        let direction = turned_back(pose, vector(direction));
        let length = dot(direction, direction).sqrt();
        let direction = direction.map(|part| part / length);
        let shift = -dot(far, direction);
        Self { start: along(far, direction, shift), direction, shift }
    }

    pub(crate) fn at(&self, t: Double) -> D3 {
        along(self.start, self.direction, t)
    }
}

/// The roots of `a t² + 2 b t + c`.
pub(crate) fn roots(a: Double, half_b: Double, c: Double) -> Vec<Double> {
    let discriminant = half_b * half_b - a * c;
    if discriminant.is_negative() {
        return Vec::new();
    }
    let root = discriminant.sqrt();
    let q = if half_b.is_negative() { root - half_b } else { -half_b - root };
    let mut found = Vec::new();
    if a != Double::ZERO {
        found.push(q / a);
    }
    if q != Double::ZERO {
        found.push(c / q);
    }
    found
}

/// From where to where a line is inside a convex body: between two of the walls it meets, if it is inside midway. Metres from
/// where the ray begins.
pub(crate) fn stretch(line: &Line, mut walls: Vec<Double>, inside: impl Fn(D3) -> bool) -> Option<(f64, f64)> {
    walls.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    let half = Double::from(0.5);
    let within = walls.windows(2).filter(|pair| inside(line.at(pair[0] * half + pair[1] * half)));
    let found = within.map(|pair| (pair[0], pair[1])).reduce(|first, last| (first.0, last.1))?;
    Some(((found.0 + line.shift).to_f64(), (found.1 + line.shift).to_f64()))
}
