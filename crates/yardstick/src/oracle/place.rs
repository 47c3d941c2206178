//! Where a form is at a time of its motion, to 32 digits.
//!
//! # Method
//! A form moves in a straight line and turns about its local origin at constant speed: at the time `t` it is turned by
//! `exp(t·spin)` times its rotation at the start. Sine and cosine of the angle come from their series, after whole turns are
//! taken off with 2π to 48 digits and the rest is halved six times.
//!
//! # Limits
//! Right to about 1e-30 of the arm, times the number of turns over 1e15.

use glam::{DQuat, DVec3};

use super::{
    double::{Double, Number},
    form::PlacedSolid,
    space::{Turn, Vector, vector},
};

/// Where a form is, and how it moves over the time from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Where the local origin is at the start, metres.
    pub position: DVec3,
    /// How it is turned at the start: a quaternion of any length but 0.
    pub rotation: DQuat,
    /// Where in that the form is, if it is a part.
    pub part: Option<(DVec3, DQuat)>,
    /// How far it goes, metres.
    pub displacement: DVec3,
    /// How it turns about the local origin: the axis times the angle, radians.
    pub spin: DVec3,
}

impl Place {
    /// At rest.
    #[must_use]
    pub fn of(placed: &PlacedSolid) -> Self {
        let (position, rotation) = (placed.position, placed.rotation);
        Self { position, rotation, part: None, displacement: DVec3::ZERO, spin: DVec3::ZERO }
    }

    /// How far it and its part may be from where it begins, metres, by coordinates.
    pub(super) fn extent(&self) -> f64 {
        let part = self.part.map_or(DVec3::ZERO, |(position, _)| position);
        part.abs().element_sum() + self.displacement.abs().max_element()
    }

    /// The vector from the moving local origin to that of the part, in lengths of a frame, and how the part is turned.
    pub(super) fn stand(
        &self,
        time: Double,
        sizes: impl Fn(DVec3) -> Vector<Double>,
    ) -> (Vector<Double>, Turn<Double>) {
        let turn = spun(self.spin, time).after(Turn::of(self.rotation));
        match self.part {
            Some((position, rotation)) => (turn.out(sizes(position)), turn.after(Turn::of(rotation))),
            None => (Vector::zero(), turn),
        }
    }
}

/// The rotation by a vector times a number (Rodrigues' formula).
fn spun(spin: DVec3, time: Double) -> Turn<Double> {
    let one = Double::of(1.0);
    let zero = Double::of(0.0);
    let across = [vector(one, zero, zero), vector(zero, one, zero), vector(zero, zero, one)];
    let spin = Vector::of(spin);
    let Some(axis) = spin.unit() else { return Turn::from_axes(across) };
    let (sin, cos) = sin_cos(spin.length() * time);
    let rest = one - cos;
    Turn::from_axes(across.map(|v| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * rest)))
}

/// 2π in three numbers.
const TURN: [f64; 3] = [std::f64::consts::TAU, 2.449_293_598_294_706_4e-16, -5.989_539_619_436_679e-33];

/// How often the angle is halved, and the last power of the series.
const HALVINGS: i32 = 6;
const POWERS: u32 = 20;

fn sin_cos(angle: Double) -> (Double, Double) {
    let turns = (angle.nearest() / TURN[0]).round();
    let whole = Double::product(turns, TURN[0]) + Double::product(turns, TURN[1]) + Double::product(turns, TURN[2]);
    let small = (angle - whole).times_power_of_two(-HALVINGS);
    let one = Double::of(1.0);
    let (mut sin, mut cos, mut term) = (Double::of(0.0), one, one);
    for power in 1..=POWERS {
        term = term * small / Double::of(f64::from(power));
        match power % 4 {
            1 => sin = sin + term,
            2 => cos = cos - term,
            3 => sin = sin - term,
            _ => cos = cos + term,
        }
    }
    for _ in 0..HALVINGS {
        (sin, cos) = (sin * cos + sin * cos, one - (sin * sin + sin * sin));
    }
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_are_known() {
        for (angle, sin, cos) in [(0.0, 0.0, 1.0), (1.0, 0.841_470_984_807_896_5, 0.540_302_305_868_139_8)] {
            let found = sin_cos(Double::of(angle));
            assert!((found.0.nearest() - sin).abs() < 1e-16 && (found.1.nearest() - cos).abs() < 1e-16);
        }
        for angle in [0.3, -2.5, 77.0, 1e5] {
            let (sin, cos) = sin_cos(Double::of(angle));
            assert!((sin * sin + cos * cos - Double::of(1.0)).nearest().abs() < 1e-29, "{angle}");
            let (other_sin, other_cos) = sin_cos(Double::of(angle) + Double::of(0.25));
            // cos(0.25), to 32 digits: 0.96891242171064478414459544949419...
            let known = Double::of(0.968_912_421_710_644_7) + Double::of(5.071_436_662_403_936e-17);
            let difference = sin * other_sin + cos * other_cos - known;
            // The angle itself is rounded to 2⁻¹⁰⁴ of it.
            assert!(difference.nearest().abs() < 1e-29 + 1e-31 * angle.abs(), "{angle}: {difference:?}");
        }
    }

    #[test]
    fn a_quarter_turn_about_z_takes_x_to_y() {
        let spin = DVec3::Z * std::f64::consts::PI;
        let there = spun(spin, Double::of(0.5)).out(Vector::of(DVec3::X)).nearest();
        assert!((there - DVec3::Y).length() < 1e-15, "{there}");
    }
}
