//! How long a call may take: the gRPC deadline of its caller.

use std::time::{Duration, Instant};

use http::HeaderMap;

use crate::problem::{Problem, Reason};

/// What is kept of a deadline for the answer's way back, a twentieth of it up to this: a caller who learns why there is no
/// answer can do more than one whose own clock ran out.
const WAY_BACK_MAX: Duration = Duration::from_millis(10);

/// When the answer must be there; `None` is for ever.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Deadline(Option<Instant>);

impl Deadline {
    /// The deadline of a call that comes in now. A header that cannot be read counts as none, as gRPC demands of servers
    /// that want to be lenient.
    pub(crate) fn of(headers: &HeaderMap) -> Self {
        let timeout = headers.get("grpc-timeout").and_then(|value| value.to_str().ok()).and_then(parse);
        let timeout = timeout.map(|timeout| timeout - (timeout / 20).min(WAY_BACK_MAX));
        Self(timeout.and_then(|timeout| Instant::now().checked_add(timeout)))
    }

    /// Whether there is time left.
    pub(crate) fn is_ahead(self) -> bool {
        self.0.is_none_or(|at| Instant::now() < at)
    }

    /// Waits until it is over; for ever without a deadline.
    pub(crate) async fn passed(self) {
        match self.0 {
            Some(at) => tokio::time::sleep_until(at.into()).await,
            None => std::future::pending().await,
        }
    }

    /// What a caller is told whose deadline is over.
    pub(crate) fn problem() -> Problem {
        Problem::new(
            Reason::Deadline,
            "the call's deadline passed before the answer was found: allow more time, or ask for less",
        )
    }
}

/// At most eight digits and a unit.
fn parse(text: &str) -> Option<Duration> {
    let (digits, unit) = text.split_at_checked(text.len().checked_sub(1)?)?;
    if digits.len() > 8 {
        return None;
    }
    let count: u64 = digits.parse().ok()?;
    match unit {
        "H" => Some(Duration::from_secs(count * 3600)),
        "M" => Some(Duration::from_secs(count * 60)),
        "S" => Some(Duration::from_secs(count)),
        "m" => Some(Duration::from_millis(count)),
        "u" => Some(Duration::from_micros(count)),
        "n" => Some(Duration::from_nanos(count)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_is_read_and_nonsense_is_no_deadline() {
        assert_eq!(parse("2H"), Some(Duration::from_secs(7200)));
        assert_eq!(parse("3M"), Some(Duration::from_secs(180)));
        assert_eq!(parse("4S"), Some(Duration::from_secs(4)));
        assert_eq!(parse("99999999m"), Some(Duration::from_millis(99_999_999)));
        assert_eq!(parse("6u"), Some(Duration::from_micros(6)));
        assert_eq!(parse("7n"), Some(Duration::from_nanos(7)));
        for nonsense in ["", "S", "1", "1x", "123456789m", "-1S", "µ"] {
            assert_eq!(parse(nonsense), None, "{nonsense}");
        }
        assert!(Deadline::of(&HeaderMap::new()).is_ahead());
    }
}
