//! Sums rounded in a chosen direction, so that a bound stays a bound.

use super::exact::two_sum;

/// The largest f64 not above the exact `a + b`.
#[must_use]
pub fn add_down(a: f64, b: f64) -> f64 {
    let (sum, error) = two_sum(a, b);
    if error < 0.0 { sum.next_down() } else { sum }
}

/// The least f64 not below the exact `a + b`.
#[must_use]
pub fn add_up(a: f64, b: f64) -> f64 {
    let (sum, error) = two_sum(a, b);
    if error > 0.0 { sum.next_up() } else { sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_enclose_the_exact_one_and_exact_sums_stay() {
        assert_eq!((add_down(0.5, 0.25), add_up(0.5, 0.25)), (0.75, 0.75));
        let tiny = 1e-30;
        assert!(add_down(1.0, tiny) == 1.0 && add_up(1.0, tiny) == 1.0_f64.next_up());
        assert!(add_down(1.0, -tiny) == 1.0_f64.next_down() && add_up(1.0, -tiny) == 1.0);
    }
}
