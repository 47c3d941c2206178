//! How wrong answers are: ours by what they prove of themselves, the peer's by what ours prove.

use collision::answer::{Bound, Certificate, Verdict};

/// What an answer of ours proves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proof {
    verdict: Verdict,
    /// Where the true value lies, metres; unbounded where only the verdict was asked.
    range: Bound,
    /// How far the true value may be from ours, metres.
    error: f64,
}

impl Proof {
    /// There is nothing: no contact, no impact.
    pub(crate) const NONE: Self = Self { verdict: Verdict::Miss, range: Bound::UNBOUNDED, error: 0.0 };

    /// There is something that has no value.
    pub(crate) const SOME: Self = Self { verdict: Verdict::Hit, range: Bound::UNBOUNDED, error: 0.0 };

    /// Of an answer that is a verdict. An open one is as wrong as its interval is wide.
    pub(crate) fn of_verdict(certificate: &Certificate) -> Self {
        let error = if certificate.verdict == Verdict::Undecided { certificate.bound.width() } else { 0.0 };
        Self { verdict: certificate.verdict, range: Bound::UNBOUNDED, error }
    }

    /// Of a value in units of `unit` metres.
    pub(crate) fn of_value(certificate: &Certificate, value: f64, unit: f64) -> Self {
        let Bound { lower, upper } = certificate.bound;
        let range = Bound::new(lower * unit, upper * unit);
        Self { verdict: certificate.verdict, range, error: (value - lower).max(upper - value) * unit }
    }
}

/// How wrong the answers to a set are.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Errors {
    /// Part of the answers that are proved hits, 0 to 1.
    pub(crate) hit_share: f64,
    /// The greatest error that ours may have, metres.
    pub(crate) max_error: f64,
    /// How many of ours prove neither yes nor no.
    pub(crate) undecided_count: usize,
    /// How many answers of the peer say yes to a proved no, or no to a proved yes.
    pub(crate) peer_wrong_count: usize,
    /// How far the peer's values lie outside of the proved interval: 999 of 1000 at most this far, metres.
    pub(crate) peer_error_p999: f64,
    /// The same, the greatest.
    pub(crate) peer_error_max: f64,
}

impl Errors {
    /// Compares answers to the same questions; the peer's are metres, `None` where it says there is nothing.
    pub(crate) fn between(proofs: &[Proof], peer: &[Option<f64>]) -> Self {
        assert_eq!(proofs.len(), peer.len(), "the same questions");
        let mut errors = Self::default();
        let mut peer_errors = Vec::new();
        for (proof, value) in proofs.iter().zip(peer) {
            errors.max_error = errors.max_error.max(proof.error);
            match (proof.verdict, value) {
                (Verdict::Undecided, _) => errors.undecided_count += 1,
                (Verdict::Miss, None) => {}
                (Verdict::Miss, Some(_)) | (Verdict::Hit, None) => errors.peer_wrong_count += 1,
                (Verdict::Hit, Some(value)) => peer_errors.push(outside(proof.range, *value)),
            }
        }
        let hit_count = proofs.iter().filter(|proof| proof.verdict == Verdict::Hit).count();
        errors.hit_share = hit_count as f64 / proofs.len().max(1) as f64;
        peer_errors.sort_by(f64::total_cmp);
        if let Some(last) = peer_errors.len().checked_sub(1) {
            errors.peer_error_p999 = peer_errors[(last as f64 * 0.999) as usize];
            errors.peer_error_max = peer_errors[last];
        }
        errors
    }
}

/// How far `value` lies outside of `range`.
fn outside(range: Bound, value: f64) -> f64 {
    (range.lower - value).max(value - range.upper).max(0.0)
}

#[cfg(test)]
mod tests {
    use collision::answer::{Method, Model, Stop};

    use super::*;

    #[test]
    fn errors_are_counted_where_they_belong() {
        let certificate = |verdict, lower, upper| Certificate {
            verdict,
            bound: Bound::new(lower, upper),
            model: Model::EXACT,
            method: Method::Gjk,
            stop: Stop::Converged,
            iterations: 1,
        };
        let proofs = [
            Proof::of_value(&certificate(Verdict::Hit, 0.25, 0.5), 0.5, 2.0),
            Proof::of_value(&certificate(Verdict::Hit, 0.25, 0.5), 0.5, 2.0),
            Proof::of_verdict(&certificate(Verdict::Undecided, -0.125, 0.0)),
            Proof::of_verdict(&certificate(Verdict::Hit, -9.0, 0.0)),
            Proof::NONE,
        ];
        let errors = Errors::between(&proofs, &[Some(0.75), Some(1.5), None, None, Some(0.0)]);
        assert_eq!(errors.max_error, 0.5);
        assert_eq!(errors.undecided_count, 1);
        assert_eq!(errors.peer_wrong_count, 2);
        assert_eq!(errors.peer_error_max, 0.5);
        assert_eq!(errors.hit_share, 0.6);
    }
}
