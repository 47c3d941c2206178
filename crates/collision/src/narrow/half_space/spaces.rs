//! Two half spaces.
//!
//! # Method
//! Unless their normals are exactly opposite, they overlap, however far away. Normals are proved not to be opposite by
//! their sum, and proved to be by exact products where both half spaces are turned alike. Opposite ones are apart by what
//! lies between two parallel planes.
//!
//! # Limits
//! Two half spaces that are not opposite are parted by no way at all: their contact has a depth whose bound is open
//! above. Opposite within rounding, but not provably so, is left open.

use std::cmp::Ordering;

use glam::DVec3;
use smallvec::smallvec;

use super::{
    ExactPlane, Signed,
    impact::{closing, meeting},
    plane::{Plane, difference},
};
use crate::{
    answer::{Bound, Feature, Stop, Verdict, Work},
    math::{
        Pose,
        expansion::{ExactVector, is_in_range},
        scaled_by_power_of_two,
        twofold::Twofold,
    },
    narrow::{Contact, ContactPoint, ImpactTouch, InitialTouch, Motion, Separation},
    shape::HalfSpace,
    tolerance::{ROUNDING, TWOFOLD_HEIGHT},
};

/// Two half spaces, in a fixed order, so that swapping them swaps the answer bit by bit.
pub(in crate::narrow) struct Spaces<'a> {
    a: &'a HalfSpace,
    b: &'a HalfSpace,
    pose_a: Pose,
    pose_b: Pose,
    plane_a: Plane,
    plane_b: Plane,
    order: Order,
}

/// How the two stand as compared with the question.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    AsAsked,
    Swapped,
}

/// How the normals of two half spaces lie to each other.
#[derive(Clone, Copy, PartialEq)]
enum Normals {
    Opposite,
    NotOpposite,
    Open,
}

impl<'a> Spaces<'a> {
    pub(super) fn new(first: (&'a HalfSpace, Pose), second: (&'a HalfSpace, Pose)) -> Self {
        let is_swapped = compare(first, second) == Ordering::Greater;
        let ((a, pose_a), (b, pose_b)) = if is_swapped { (second, first) } else { (first, second) };
        Self {
            a,
            b,
            pose_a,
            pose_b,
            plane_a: Plane::new(a, &pose_a),
            plane_b: Plane::new(b, &pose_b),
            order: if is_swapped { Order::Swapped } else { Order::AsAsked },
        }
    }

    fn normals(&self) -> Normals {
        if self.plane_a.sum_of_normals(&self.plane_b) > 2.0 * TWOFOLD_HEIGHT {
            return Normals::NotOpposite;
        }
        let sent = [self.a.normal, self.b.normal].map(scaled_by_power_of_two);
        if self.pose_a.rotation != self.pose_b.rotation || !sent.into_iter().all(is_in_range) {
            return Normals::Open;
        }
        let [a, b] = sent.map(|normal| ExactVector::difference(normal, DVec3::ZERO));
        if a.cross(&b).is_zero() { Normals::Opposite } else { Normals::NotOpposite }
    }

    /// The gap between the planes if their normals are opposite.
    fn gap(&self) -> Signed {
        let height = self.plane_b.height(&difference(self.pose_a.position, self.pose_b.position));
        let best = (height.value - Twofold::of(self.a.offset)).high;
        let error = height.error + TWOFOLD_HEIGHT * self.a.offset.abs() + 2.0 * ROUNDING * best.abs();
        Signed::new(best - error, best, best + error)
    }

    /// The exact sign of that gap after the two have gone these ways.
    fn exact_sign(&self, ways: [DVec3; 2]) -> Option<Ordering> {
        let exact = ExactPlane::new(self.b, &self.pose_b)?;
        exact.sign(self.pose_a.position, DVec3::ZERO, self.a.offset, ways)
    }

    /// The signed distance; open below where no way parts the two.
    pub(super) fn signed(&self) -> Signed {
        let gap = self.gap();
        match self.normals() {
            Normals::Opposite if gap.verdict == Verdict::Undecided => gap.with_sign(self.exact_sign([DVec3::ZERO; 2])),
            Normals::Opposite => gap,
            Normals::NotOpposite => {
                Signed { lower: f64::NEG_INFINITY, best: gap.best.min(0.0), upper: 0.0, verdict: Verdict::Hit }
            }
            Normals::Open => {
                let verdict = if gap.verdict == Verdict::Hit { Verdict::Hit } else { Verdict::Undecided };
                Signed { lower: f64::NEG_INFINITY, verdict, ..gap }
            }
        }
    }

    pub(super) fn distance(&self, limit: f64) -> Option<Separation> {
        let signed = self.signed();
        let (lower, upper) = (signed.lower.max(0.0), signed.upper.max(0.0));
        if lower > limit {
            return None;
        }
        let best = if signed.verdict == Verdict::Hit { 0.0 } else { signed.best.clamp(lower, upper) };
        let point_on_a = self.point(signed);
        let normal = self.plane_b.normal;
        let found = Separation {
            distance: best,
            point_on_a,
            point_on_b: point_on_a - normal * best + DVec3::ZERO,
            normal_b_to_a: (best > 0.0).then_some(normal),
            feature_a: Feature::default(),
            feature_b: Feature::default(),
            certificate: Signed { lower, upper, ..signed }
                .certificate(if upper <= limit { Verdict::Hit } else { Verdict::Undecided }, Stop::Converged),
        };
        Some(if self.order == Order::Swapped { found.swapped() } else { found })
    }

    pub(super) fn contact(&self, max_gap: f64, work: &mut Work) -> Option<Contact> {
        super::count(work);
        let signed = self.signed();
        if signed.lower > max_gap || signed.verdict == Verdict::Miss && max_gap <= 0.0 {
            return None;
        }
        let depth = Signed { lower: -signed.upper, best: -signed.best, upper: -signed.lower, ..signed };
        let normal = self.plane_b.normal;
        let point_on_a = self.point(signed);
        let point_on_b = point_on_a + normal * depth.best + DVec3::ZERO;
        let contact = Contact {
            normal_b_to_a: normal,
            depth: depth.best + 0.0,
            points: smallvec![ContactPoint {
                point_on_a,
                point_on_b,
                depth: depth.best + 0.0,
                bound: Bound::new(depth.lower, depth.upper),
                feature_pair: 0,
            }],
            feature_a: Feature::default(),
            feature_b: Feature::default(),
            certificate: depth.certificate(signed.verdict, Stop::Converged),
        };
        Some(if self.order == Order::Swapped { contact.swapped() } else { contact })
    }

    pub(super) fn impact(&self, motion: &Motion) -> Option<ImpactTouch> {
        let ways = match self.order {
            Order::AsAsked => [motion.displacement_a, motion.displacement_b],
            Order::Swapped => [motion.displacement_b, motion.displacement_a],
        };
        let start = self.signed();
        if start.verdict != Verdict::Miss && motion.initial == InitialTouch::IsIgnored {
            return None;
        }
        let meeting = meeting(start, closing(&self.plane_b, ways), || self.exact_sign(ways))?;
        let point = self.point(start) + ways[0] * meeting.best() + DVec3::ZERO;
        let touch = meeting.touch(start, point, self.plane_b.normal);
        Some(match self.order {
            Order::AsAsked => touch,
            Order::Swapped => {
                ImpactTouch { normal_b_to_a: touch.normal_b_to_a.map(|normal| DVec3::ZERO - normal), ..touch }
            }
        })
    }

    /// Of a motion in which one turns: they touch as soon as their normals are not opposite, so that only a touch at the
    /// start is ever certain.
    pub(super) fn turning_impact(&self, motion: &Motion) -> Option<ImpactTouch> {
        let start = self.signed();
        if start.verdict == Verdict::Hit {
            return self.impact(motion);
        }
        let open = Signed { lower: 0.0, best: 0.0, upper: 1.0, verdict: Verdict::Undecided };
        Some(ImpactTouch {
            fraction: 0.0,
            point: self.point(start),
            normal_b_to_a: None,
            initial: start.verdict == Verdict::Undecided,
            feature_b: Feature::default(),
            certificate: open.certificate(Verdict::Undecided, Stop::Converged),
        })
    }

    /// A point of `a`: where the planes are parallel, on its own; where the two overlap otherwise, a common one.
    fn point(&self, signed: Signed) -> DVec3 {
        let (n, m) = (self.plane_a.normal, self.plane_b.normal);
        let height_a = self.a.offset;
        let height_b = -self.plane_b.height(&difference(self.pose_a.position, self.pose_b.position)).value.high;
        let (cosine, sine_squared) = (n.dot(m), n.cross(m).length_squared());
        let own = n * height_a;
        let relative = if signed.lower.is_finite() || m.dot(own) <= height_b || sine_squared == 0.0 {
            own
        } else if n.dot(m * height_b) <= height_a {
            m * height_b
        } else {
            (n * (height_a - cosine * height_b) + m * (height_b - cosine * height_a)) / sine_squared
        };
        self.pose_a.position + relative + DVec3::ZERO
    }
}

fn compare((a, pose_a): (&HalfSpace, Pose), (b, pose_b): (&HalfSpace, Pose)) -> Ordering {
    let numbers = |space: &HalfSpace, pose: Pose| {
        let ([x, y, z], [p, q, r]) = (space.normal.to_array(), pose.position.to_array());
        let [i, j, k, w] = pose.rotation.to_array();
        [x, y, z, space.offset, p, q, r, i, j, k, w]
    };
    let pairs = numbers(a, pose_a).into_iter().zip(numbers(b, pose_b));
    pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}
