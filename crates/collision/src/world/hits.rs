//! Which hits are kept while a question runs, and what need not be looked at any more.
//!
//! # Method
//! What is kept may not depend on the order in which a tree offers shapes. So a shape may be passed over only if the
//! lower bound of its canonical box is above a number that is the same in any order at the end: the least upper bound
//! of all certain hits, or the value of the last hit that still has a place in the list. All lower bounds are raised to
//! that of the canonical box, so that nothing passed over could have been kept.

use std::{cmp::Ordering, collections::BinaryHeap};

use super::{Found, HitMode, ShapeId, first::First};
use crate::answer::{Certificate, Verdict};

/// A hit that has a value to be ordered by.
pub(super) trait Hit {
    /// Metres, or a fraction of the motion.
    fn value(&self) -> f64;
    /// The shape.
    fn id(&self) -> Option<ShapeId>;
    /// What the value is worth.
    fn certificate(&self) -> &Certificate;
    /// The same, to be widened.
    fn certificate_mut(&mut self) -> &mut Certificate;
    /// Whether it blocks nothing.
    fn is_pierced(&self) -> bool {
        false
    }
}

/// By value, equal ones by id.
pub(super) fn order<H: Hit>(a: &H, b: &H) -> Ordering {
    a.value().total_cmp(&b.value()).then_with(|| a.id().cmp(&b.id()))
}

/// `Hit` if one is certain, `Undecided` if one is open, else `Miss`.
pub(super) fn verdict<'a>(certificates: impl Iterator<Item = &'a Certificate>) -> Verdict {
    certificates.fold(Verdict::Miss, |all, certificate| match (all, certificate.verdict) {
        (Verdict::Hit, _) | (_, Verdict::Hit) => Verdict::Hit,
        (Verdict::Undecided, _) | (_, Verdict::Undecided) => Verdict::Undecided,
        (Verdict::Miss, Verdict::Miss) => Verdict::Miss,
    })
}

/// Raises a lower bound, and the value with it, to what the canonical box proves.
pub(super) fn raise(value: &mut f64, certificate: &mut Certificate, least: f64) {
    if certificate.bound.lower < least {
        certificate.bound.lower = least;
        certificate.bound.upper = certificate.bound.upper.max(least);
        *value = value.max(least);
    }
}

/// The best hits by value and id, a given number of them.
pub(super) struct Best<H> {
    most: usize,
    worst_first: BinaryHeap<Ranked<H>>,
}

struct Ranked<H>(H);

impl<H: Hit> Ord for Ranked<H> {
    fn cmp(&self, other: &Self) -> Ordering {
        order(&self.0, &other.0)
    }
}

impl<H: Hit> PartialOrd for Ranked<H> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<H: Hit> PartialEq for Ranked<H> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<H: Hit> Eq for Ranked<H> {}

impl<H: Hit> Best<H> {
    /// None yet, and `most` at the end.
    pub(super) fn new(most: usize) -> Self {
        Self { most, worst_first: BinaryHeap::new() }
    }

    /// Takes a hit, and gives up the worst if there are too many.
    pub(super) fn add(&mut self, hit: H) {
        self.worst_first.push(Ranked(hit));
        if self.worst_first.len() > self.most {
            self.worst_first.pop();
        }
    }

    /// A hit whose value is above this has no place.
    pub(super) fn limit(&self) -> f64 {
        if self.worst_first.len() < self.most {
            return f64::INFINITY;
        }
        self.worst_first.peek().map_or(f64::NEG_INFINITY, |worst| worst.0.value())
    }

    /// Whether a hit of this value and id would be kept.
    pub(super) fn has_place(&self, value: f64, id: Option<ShapeId>) -> bool {
        let worst = self.worst_first.peek().filter(|_| self.worst_first.len() >= self.most);
        worst.is_none_or(|Ranked(worst)| value.total_cmp(&worst.value()).then_with(|| id.cmp(&worst.id())).is_lt())
    }

    /// The best first.
    pub(super) fn into_sorted(self) -> Vec<H> {
        self.worst_first.into_sorted_vec().into_iter().map(|ranked| ranked.0).collect()
    }
}

/// The hits of a ray or a motion, as its mode wants them.
pub(super) enum Gathered<H> {
    /// As [`HitMode::Closest`].
    Closest {
        /// The first certain one.
        certain: First<H>,
        /// Those that may come before it.
        undecided: Vec<H>,
    },
    /// As [`HitMode::Any`].
    Any {
        /// The first that was found.
        certain: Option<H>,
        /// Those found before.
        undecided: Vec<H>,
    },
    /// As [`HitMode::All`], with one more, which says that there are more.
    All(Best<H>),
    /// As [`HitMode::Pierce`].
    Pierce {
        /// The first certain blocker.
        blocker: First<H>,
        /// What may come before it, with one more, which says that there are more.
        before: Best<Beginning<H>>,
        /// What may block, if nothing surely does.
        open: Openness,
    },
}

impl<H: Hit> Gathered<H> {
    /// Nothing yet.
    pub(super) fn new(mode: HitMode) -> Self {
        match mode {
            HitMode::Closest => Self::Closest { certain: First::new(), undecided: Vec::new() },
            HitMode::Any => Self::Any { certain: None, undecided: Vec::new() },
            HitMode::All(most) => Self::All(Best::new(most.saturating_add(1))),
            HitMode::Pierce { most, .. } => {
                let before = Best::new(most.saturating_add(1));
                Self::Pierce { blocker: First::new(), before, open: Openness::Nothing }
            }
        }
    }

    /// Takes what was found on one shape: a certain hit, and an undecided one that may come before it.
    pub(super) fn add(&mut self, found_certain: Option<H>, found_undecided: Option<H>) {
        match self {
            Self::Closest { certain, undecided } => {
                undecided.extend(found_undecided);
                found_certain.into_iter().for_each(|hit| certain.add(hit));
            }
            Self::Any { certain, undecided } => {
                undecided.extend(found_undecided);
                *certain = certain.take().or(found_certain);
            }
            Self::All(best) => {
                if let Some(hit) = found_certain.or(found_undecided) {
                    best.add(hit);
                }
            }
            Self::Pierce { blocker, before, open } => match found_certain {
                Some(hit) if hit.is_pierced() => before.add(Beginning(hit)),
                certain => {
                    if let Some(hit) = found_undecided {
                        if !hit.is_pierced() {
                            *open = Openness::Something;
                        }
                        before.add(Beginning(hit));
                    }
                    certain.into_iter().for_each(|hit| blocker.add(hit));
                }
            },
        }
    }

    /// Takes the one thing that was found on a shape, if anything was, as what its verdict says.
    pub(super) fn take(&mut self, found: Option<H>) {
        match found {
            Some(hit) if hit.certificate().verdict == Verdict::Hit => self.add(Some(hit), None),
            found => self.add(None, found),
        }
    }

    /// What lies surely beyond this need not be looked at.
    pub(super) fn limit(&self) -> f64 {
        match self {
            Self::Closest { certain: first, .. } | Self::Pierce { blocker: first, .. } => first.limit(),
            Self::Any { certain: Some(_), .. } => f64::NEG_INFINITY,
            Self::Any { certain: None, .. } => f64::INFINITY,
            Self::All(best) => best.limit(),
        }
    }

    /// The answer.
    pub(super) fn finish(self) -> Found<H> {
        let (hits, truncated) = match self {
            Self::Pierce { blocker, before, open } => return finish_pierced(blocker, before, open),
            Self::Closest { certain, mut undecided } => {
                undecided.retain(|hit| hit.certificate().bound.lower < certain.limit());
                undecided.sort_by(order);
                let certain = certain.into_named();
                // Most often it is the only one, and a hit is large.
                undecided.reserve_exact(usize::from(certain.is_some()));
                undecided.extend(certain);
                (undecided, false)
            }
            Self::Any { certain: Some(certain), .. } => (vec![certain], false),
            Self::Any { certain: None, mut undecided } => {
                undecided.sort_by(order);
                (undecided, false)
            }
            Self::All(best) => {
                let most = best.most - 1;
                let mut hits = best.into_sorted();
                let truncated = hits.len() > most;
                hits.truncate(most);
                (hits, truncated)
            }
        };
        Found { verdict: verdict(hits.iter().map(Hit::certificate)), hits, truncated }
    }
}

fn finish_pierced<H: Hit>(blocker: First<H>, before: Best<Beginning<H>>, open: Openness) -> Found<H> {
    let (limit, blocker) = (blocker.limit(), blocker.into_named());
    let most = before.most - 1;
    let mut hits: Vec<H> = before.into_sorted().into_iter().map(|Beginning(hit)| hit).collect();
    // What lies behind was offered or not, as it came; it begins after all that does not.
    hits.retain(|hit| hit.certificate().bound.lower <= limit);
    let truncated = hits.len() > most;
    hits.truncate(most);
    hits.sort_by(order);
    let verdict = match (&blocker, open) {
        (Some(_), _) => Verdict::Hit,
        (None, Openness::Something) => Verdict::Undecided,
        (None, Openness::Nothing) => Verdict::Miss,
    };
    hits.extend(blocker);
    Found { verdict, hits, truncated }
}

/// Whether something undecided was found that blocks should it touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Openness {
    /// No.
    Nothing,
    /// Yes.
    Something,
}

/// A hit in order of where it may begin, so that what surely lies behind a limit comes after all that does not.
pub(super) struct Beginning<H>(H);

impl<H: Hit> Hit for Beginning<H> {
    fn value(&self) -> f64 {
        self.certificate().bound.lower
    }

    fn id(&self) -> Option<ShapeId> {
        self.0.id()
    }

    fn certificate(&self) -> &Certificate {
        self.0.certificate()
    }

    fn certificate_mut(&mut self) -> &mut Certificate {
        self.0.certificate_mut()
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU64;

    use super::*;
    use crate::answer::{Bound, Method, Model, Stop};

    /// A touch that a kernel would find, and the lower bound that its canonical box proves.
    #[derive(Clone, Debug, PartialEq)]
    struct Touch {
        id: ShapeId,
        value: f64,
        certificate: Certificate,
        least: f64,
        pierced: bool,
    }

    impl Hit for Touch {
        fn value(&self) -> f64 {
            self.value
        }

        fn id(&self) -> Option<ShapeId> {
            Some(self.id)
        }

        fn certificate(&self) -> &Certificate {
            &self.certificate
        }

        fn certificate_mut(&mut self) -> &mut Certificate {
            &mut self.certificate
        }

        fn is_pierced(&self) -> bool {
            self.pierced
        }
    }

    /// Small whole numbers, so that bounds often tie and often cross.
    fn touch(number: u64, mut next: impl FnMut(u64) -> u64) -> Touch {
        let least = next(8) as f64;
        let lower = least - 2.0 + next(4) as f64;
        let value = lower.max(least) + next(3) as f64;
        Touch {
            id: NonZeroU64::new(number).expect("not 0"),
            value,
            certificate: Certificate {
                verdict: if next(3) == 0 { Verdict::Undecided } else { Verdict::Hit },
                bound: Bound::new(lower, value + next(4) as f64),
                model: Model::EXACT,
                method: Method::Gjk,
                stop: Stop::Budget,
                iterations: 0,
            },
            least,
            pierced: next(2) == 0,
        }
    }

    /// As a question does it: what lies beyond the limit is passed over, the rest is raised and taken.
    fn gather(mode: HitMode, touches: &[Touch]) -> Found<Touch> {
        let mut gathered = Gathered::new(mode);
        for touch in touches {
            if touch.least > gathered.limit() {
                continue;
            }
            let mut touch = touch.clone();
            raise(&mut touch.value, &mut touch.certificate, touch.least);
            gathered.take(Some(touch));
        }
        gathered.finish()
    }

    #[test]
    fn what_is_kept_does_not_depend_on_the_order() {
        let mut state = 7_u64;
        let mut next = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        let (mut several, mut several_certain) = (0, 0);
        for _ in 0..3000 {
            let mut touches: Vec<Touch> = (1..=2 + next(7)).map(|number| touch(number, &mut next)).collect();
            let pierce = |most| HitMode::Pierce { layers: 0, most };
            for mode in [HitMode::Closest, HitMode::All(next(4) as usize), pierce(9), pierce(next(4) as usize)] {
                let first = gather(mode, &touches);
                several += usize::from(first.hits.len() > 1);
                for last in (1..touches.len()).rev() {
                    touches.swap(last, next(last as u64 + 1) as usize);
                }
                if mode == HitMode::Closest {
                    several_certain += usize::from(reaches_to_the_first(&first, &touches));
                }
                let second = gather(mode, &touches);
                assert_eq!(first.hits, second.hits, "{mode:?} of {touches:?}");
                assert_eq!((first.verdict, first.truncated), (second.verdict, second.truncated));
            }
        }
        assert!(several > 3000 && several_certain > 200, "vacuous: {several}, {several_certain}");
    }

    /// Checks that the interval of the closest certain hit holds the first of all certain ones, wherever in their intervals they are;
    /// returns whether another might come before it.
    fn reaches_to_the_first(found: &Found<Touch>, touches: &[Touch]) -> bool {
        let bounds = |touch: &Touch| (touch.certificate.bound.lower.max(touch.least), touch.certificate.bound.upper);
        let certain = || touches.iter().filter(|touch| touch.certificate.verdict == Verdict::Hit);
        let Some(named) = found.hits.last().filter(|hit| hit.certificate.verdict == Verdict::Hit) else { return false };
        let earliest = certain().map(|touch| bounds(touch).0).fold(f64::INFINITY, f64::min);
        let latest = certain().map(|touch| bounds(touch).1.max(touch.least)).fold(f64::INFINITY, f64::min);
        let bound = named.certificate.bound;
        assert!(bound.lower <= earliest && latest <= bound.upper, "{named:?} of {touches:?}");
        certain().any(|touch| touch.id == named.id && bound.lower < bounds(touch).0)
    }
}
