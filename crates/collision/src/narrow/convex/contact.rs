//! The contact of two convex forms.

use std::cmp::Ordering;

use glam::DVec3;
use smallvec::SmallVec;

use super::{
    PlacedConvex,
    depth::{self, Ask, Touch},
    frame::Pair,
    manifold, order, touch,
    warm::{Resting, Seed, Warm},
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Feature, Model, Verdict, Work},
    narrow::{Contact, ContactPoint, Depth},
    tolerance::POINT_DEPTH,
};

/// The contact of two convex forms; `None` if they are proved to be more than `max_gap` metres apart.
pub(crate) fn penetration(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Contact> {
    let (first, second, is_swapped) = order::in_order(a, b);
    judge(first, second, max_gap, accuracy, &mut None, work, |judged| judged.contact(is_swapped))
}

/// The same from what was remembered; the same question again has the same answer without any search.
pub(crate) fn penetration_warm(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    warm: &mut Warm,
    work: &mut Work,
) -> Option<Contact> {
    let resting = Resting { poses: [*a.pose, *b.pose], max_gap, accuracy: *accuracy };
    if let Some(known) = warm.contact_at(&resting) {
        work.pairs_tested += 1;
        return known.clone();
    }
    let (first, second, is_swapped) = order::in_order(a, b);
    let seed = warm.seed(is_swapped);
    let contact = judge(first, second, max_gap, accuracy, seed, work, |judged| judged.contact(is_swapped));
    warm.rest(resting, contact.clone());
    contact
}

/// The depth of two convex forms; `None` if they are proved to be more than `max_gap` metres apart.
pub(crate) fn depth(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Depth> {
    let (first, second, is_swapped) = order::in_order(a, b);
    let depth = judge(first, second, max_gap, accuracy, &mut None, work, |judged| judged.depth())?;
    Some(if is_swapped { depth.swapped() } else { depth })
}

/// What is said of a pair that may be no more than `max_gap` metres apart. The pair and its touch stay where they are made:
/// they are large to copy.
#[inline(always)]
pub(super) fn judge<Answer>(
    a: PlacedConvex<'_>,
    b: PlacedConvex<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    seed: &mut Option<Seed>,
    work: &mut Work,
    answer: impl FnOnce(&Judged<'_>) -> Answer,
) -> Option<Answer> {
    let pair = Pair::new(a, b, 0.0);
    let mut touch = depth::touch(&pair, &Ask::of(&pair, max_gap, accuracy), seed);
    work.pairs_tested += 1;
    work.iterations += touch.as_ref().map_or(1, |touch| u64::from(touch.iterations));
    let touch = touch.as_mut()?;
    let mut verdict = Bound::new(-touch.upper, -touch.lower).touch_verdict();
    if verdict == Verdict::Undecided
        && let Some(sign) = touch::sign(a, b)
    {
        if sign == Ordering::Greater && max_gap <= 0.0 {
            return None;
        }
        verdict = touch.bounded_by(sign);
    }
    Some(answer(&Judged { pair: &pair, touch, verdict }))
}

/// How a pair touches, and what that proves.
pub(super) struct Judged<'p> {
    pub(super) pair: &'p Pair<'p>,
    pub(super) touch: &'p Touch,
    pub(super) verdict: Verdict,
}

impl Judged<'_> {
    /// The contact, with the arguments swapped if the pair's were.
    pub(super) fn contact(&self, is_swapped: bool) -> Contact {
        let Self { pair, touch, .. } = self;
        // Points are put where they stay: they are large to copy.
        let mut contact = Contact {
            normal_b_to_a: pair.direction_out(touch.normal),
            depth: pair.length_out(touch.best),
            points: SmallVec::new(),
            feature_a: Feature::default(),
            feature_b: Feature::default(),
            certificate: self.certificate(),
        };
        for point in &manifold::points(pair, touch) {
            let depth = (point.on_b - point.on_a).dot(touch.normal);
            // Nowhere is the way between the surfaces along the normal longer than both forms are wide together.
            let upper = (depth + point.beyond + POINT_DEPTH).min((depth + POINT_DEPTH).max(touch.upper));
            contact.points.push(ContactPoint {
                point_on_a: pair.point_out(point.on_a),
                point_on_b: pair.point_out(point.on_b),
                depth: pair.length_out(depth),
                bound: pair.bound_out(depth - POINT_DEPTH, upper),
                feature_pair: point.feature_pair,
            });
        }
        if is_swapped {
            contact.swap();
        }
        contact
    }

    fn depth(&self) -> Depth {
        let Self { pair, touch, .. } = self;
        let (on_a, on_b) = manifold::deepest(pair, touch);
        Depth {
            depth: pair.length_out(touch.best),
            normal_b_to_a: pair.direction_out(touch.normal),
            point_on_a: pair.point_out(on_a),
            point_on_b: pair.point_out(on_b),
            certificate: self.certificate(),
        }
    }

    fn certificate(&self) -> Certificate {
        let Touch { lower, upper, method, stop, iterations, .. } = *self.touch;
        let bound = self.pair.bound_out(lower, upper);
        Certificate { verdict: self.verdict, bound, model: Model::EXACT, method, stop, iterations }
    }
}

impl Contact {
    /// The same contact with the arguments swapped.
    pub(in crate::narrow) fn swapped(mut self) -> Self {
        self.swap();
        self
    }

    /// Swaps the arguments.
    pub(in crate::narrow) fn swap(&mut self) {
        self.normal_b_to_a = DVec3::ZERO - self.normal_b_to_a;
        std::mem::swap(&mut self.feature_a, &mut self.feature_b);
        for point in &mut self.points {
            std::mem::swap(&mut point.point_on_a, &mut point.point_on_b);
            point.feature_pair = point.feature_pair.rotate_left(16);
        }
    }
}

impl Depth {
    /// The same depth with the arguments swapped.
    fn swapped(self) -> Self {
        Self {
            normal_b_to_a: DVec3::ZERO - self.normal_b_to_a,
            point_on_a: self.point_on_b,
            point_on_b: self.point_on_a,
            ..self
        }
    }
}
