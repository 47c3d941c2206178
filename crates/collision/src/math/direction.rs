//! Unit vectors, and vectors near them.

use glam::DVec3;

use super::Norm;

/// The unit vector along `v`, however short or long it is; `None` for 0. No square in it vanishes or overflows.
#[must_use]
pub fn try_unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (largest > 0.0).then(|| {
        let scaled = v / largest;
        scaled * (1.0 / scaled.norm())
    })
}

/// A vector of any length but 0, times a power of two so that its largest component lies in [1, 2), but for components
/// that become too small for it.
#[must_use]
pub fn scaled_by_power_of_two(direction: DVec3) -> DVec3 {
    let largest = direction.abs().max_element();
    let (direction, largest) = if largest < f64::MIN_POSITIVE {
        let up = power_of_two(600);
        (direction * up, largest * up)
    } else {
        (direction, largest)
    };
    let exponent = ((largest.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    let half = -exponent / 2;
    direction * power_of_two(half) * power_of_two(-exponent - half)
}

/// 2 to an exponent from −1022 to 1023.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_any_length_are_scaled_without_loss() {
        for length in [1.0, 3e-310, 1e-30, 7e300, f64::MAX, f64::from_bits(1)] {
            let scaled = scaled_by_power_of_two(DVec3::new(0.0, -length, 0.0));
            assert!((1.0..2.0).contains(&-scaled.y), "{length} became {scaled}");
            let bits = |value: f64| value / power_of_two(((value.to_bits() >> 52) & 0x7ff) as i32 - 1023);
            if length >= f64::MIN_POSITIVE {
                assert_eq!(bits(length), -scaled.y);
            }
        }
    }
}
