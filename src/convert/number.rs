//! Single numbers: finite, within their limits, counts in range, times.

use std::time::Duration;

use collision::{
    shape::Limits,
    world::{ShapeId, Time},
};

use crate::problem::{Checked, Problem, Reason};

/// The longest way that a question may look along, metres: it crosses every world.
pub(crate) const REACH: f64 = 4e12;
/// The same, in words.
pub(crate) const FROM_ZERO_TO_REACH: &str = "0 to 4e12 metres";

const NANOS_IN_SECOND: i64 = 1_000_000_000;

/// A finite number.
pub(crate) fn finite(field: &'static str, value: f64) -> Checked<f64> {
    if value.is_finite() { Ok(value) } else { Err(not_finite(field, value)) }
}

/// A coordinate: finite and within 1e12 metres of 0.
pub(crate) fn coordinate(field: &'static str, value: f64) -> Checked<f64> {
    within(field, value, -Limits::COORDINATE..=Limits::COORDINATE, "within 1e12 of 0")
}

/// A finite number in a range; `allowed` says in words which.
pub(crate) fn within(
    field: &'static str,
    value: f64,
    range: std::ops::RangeInclusive<f64>,
    allowed: &'static str,
) -> Checked<f64> {
    finite(field, value)?;
    if range.contains(&value) {
        Ok(value)
    } else {
        Err(Problem::at(field, Reason::OutOfLimits, format!("is {value}: it must be {allowed}")))
    }
}

/// What is said of NaN and infinities.
pub(crate) fn not_finite(field: impl Into<String>, value: f64) -> Problem {
    Problem::at(field, Reason::NotFinite, format!("is {value}: it must be a finite number, such as 1.5"))
}

/// A count from 1 to `most`, where 0 stands for `default`.
pub(crate) fn count(field: &'static str, sent: u32, default: usize, most: usize) -> Checked<usize> {
    let count = sent as usize;
    match count {
        0 => Ok(default),
        _ if count <= most => Ok(count),
        _ => {
            let what = format!("is {count}: it must be 1 to {most}, or 0 for {default}");
            Err(Problem::at(field, Reason::OutOfLimits, what))
        }
    }
}

/// Checks that a list is not too long.
pub(crate) fn at_most(field: &'static str, found: usize, most: usize) -> Checked<()> {
    if found <= most {
        return Ok(());
    }
    let what = format!("has {found} items: at most {most} are allowed");
    Err(Problem::at(field, Reason::TooManyItems, what))
}

/// An id of a shape.
pub(crate) fn shape_id(field: &'static str, id: u64) -> Checked<ShapeId> {
    ShapeId::new(id).ok_or_else(|| {
        let what = "is 0, which means \"no shape\": ids of shapes are 1 or more";
        Problem::at(field, Reason::OutOfLimits, what)
    })
}

/// What is said of an enum number that the API does not name.
pub(crate) fn unknown_enum(field: &'static str, found: i32, names: &str) -> Problem {
    Problem::at(field, Reason::OutOfLimits, format!("is {found}: it must be one of {names}"))
}

/// A point in time.
pub(crate) fn time(field: &'static str, sent: &prost_types::Timestamp) -> Checked<Time> {
    let nanos = i64::from(sent.nanos);
    let in_second = (0..NANOS_IN_SECOND).contains(&nanos);
    let total = sent.seconds.checked_mul(NANOS_IN_SECOND).and_then(|seconds| seconds.checked_add(nanos));
    match total {
        Some(total) if in_second => Ok(Time(total)),
        _ => {
            let what = format!(
                "is {} s and {nanos} ns: it must lie between the years 1678 and 2262, with 0 to 999999999 ns",
                sent.seconds
            );
            Err(Problem::at(field, Reason::OutOfLimits, what))
        }
    }
}

/// A point in time as it is sent.
pub(crate) fn timestamp(time: Time) -> prost_types::Timestamp {
    prost_types::Timestamp {
        seconds: time.0.div_euclid(NANOS_IN_SECOND),
        // Below 1e9, so it fits.
        nanos: time.0.rem_euclid(NANOS_IN_SECOND) as i32,
    }
}

/// A length of time as it is sent.
pub(crate) fn duration(length: Duration) -> prost_types::Duration {
    prost_types::Duration {
        seconds: i64::try_from(length.as_secs()).unwrap_or(i64::MAX),
        // Below 1e9, so it fits.
        nanos: length.subsec_nanos() as i32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_survive_the_way_there_and_back_also_before_1970() {
        for nanos in [0, 1, -1, 1_700_000_000_123_456_789, -1_500_000_000, i64::MAX, i64::MIN + 999_999_999] {
            let sent = timestamp(Time(nanos));
            assert!((0..1_000_000_000).contains(&sent.nanos));
            assert_eq!(time("time", &sent).unwrap(), Time(nanos), "{nanos}");
        }
        let late = prost_types::Timestamp { seconds: i64::MAX, nanos: 0 };
        time("time", &late).unwrap_err();
    }

    #[test]
    fn a_count_of_zero_is_the_default_and_one_too_many_is_an_error() {
        assert_eq!(count("max_hits", 0, 256, 10_000).unwrap(), 256);
        assert_eq!(count("max_hits", 10_000, 256, 10_000).unwrap(), 10_000);
        count("max_hits", 10_001, 256, 10_000).unwrap_err();
    }
}
