//! A triangle as a ray sees it: on which side of each edge the ray passes, which side it faces, and when it is met.
//!
//! # Method
//! The triangle is seen along the ray; edge functions are then areas in the plane, each with its error. What the error leaves open
//! is decided exactly where the ray is known exactly.
//!
//! # Source
//! Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection" (2013), section 3: edge functions along the ray. It shears along the
//! ray's largest axis; two vectors across the ray take no branch: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1),
//! 2017. The error bounds, and expansions instead of a second precision, are ours.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};

use super::frame::{ExactRay, LocalRay};
use crate::{
    answer::Bound,
    math::{Norm, exact, expansion::ExactVector, larger, smaller},
    tolerance,
};

/// A sign as far as it is proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sign {
    Negative,
    Zero,
    Positive,
    Unknown,
}

impl Sign {
    fn of(value: f64, error: f64) -> Self {
        if value > error {
            Self::Positive
        } else if value < -error {
            Self::Negative
        } else {
            Self::Unknown
        }
    }

    /// The sign of the negative.
    pub(super) fn flipped(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Positive => Self::Negative,
            Self::Zero => Self::Zero,
            Self::Unknown => Self::Unknown,
        }
    }
}

impl From<Ordering> for Sign {
    fn from(order: Ordering) -> Self {
        match order {
            Ordering::Less => Self::Negative,
            Ordering::Equal => Self::Zero,
            Ordering::Greater => Self::Positive,
        }
    }
}

/// How a ray sees a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// For the side from each corner to the next: the side the ray passes it on. All are as `facing` within the triangle.
    pub edges: [Sign; 3],
    /// The sign of the ray's direction along the normal of the triangle.
    pub facing: Sign,
}

impl View {
    /// Whether the ray surely passes the triangle by (or, known exactly, runs in its plane).
    pub(super) fn is_missed(&self) -> bool {
        let has = |sign: Sign| self.edges.contains(&sign);
        self.facing == Sign::Zero || (has(Sign::Positive) && has(Sign::Negative))
    }

    /// Whether the ray surely goes through it. Edges and corners belong to it.
    pub(super) fn is_hit(&self) -> bool {
        !self.is_missed() && !self.edges.contains(&Sign::Unknown)
    }
}

/// When the plane of a triangle is met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// Metres along the ray.
    pub bound: Bound,
    pub best: f64,
}

/// A ray made ready to look at triangles.
pub(super) struct Sight<'a> {
    pub ray: &'a LocalRay,
    center: DVec3,
    /// Two unit vectors at right angles to the ray and to each other, so that the three are right-handed.
    pub across: [DVec3; 2],
    /// Bounds the error of a corner seen along them: the ray's own; 5 roundings of each of their components, 8 of the ray's direction, to
    /// which they are at right angles, and 3 of a product, times a distance of up to twice the ray's extent, which is less than that again.
    error: f64,
}

/// A triangle as the kernels need it.
struct Seen {
    corners: [DVec3; 3],
    /// Its corners seen from the foot of the ray.
    relative: [DVec3; 3],
    /// Twice the area long, and a bound of the error of each of its components.
    normal: DVec3,
    normal_error: f64,
}

impl<'a> Sight<'a> {
    #[inline]
    pub(super) fn new(ray: &'a LocalRay, center: DVec3) -> Self {
        Self { ray, center, across: across(ray.direction), error: 3.0 * ray.error }
    }

    #[inline(always)]
    fn seen(&self, corners: [DVec3; 3]) -> Seen {
        let relative = corners.map(|corner| (corner - self.center) - self.ray.foot);
        let (normal, normal_error) = normal(corners);
        Seen { corners, relative, normal, normal_error }
    }

    /// Looks at a triangle, given by its corners in the local frame: how the ray sees it, and when it meets its plane, should it go
    /// through. `None` if it surely passes it by.
    #[inline(always)]
    pub(super) fn look(&self, corners: [DVec3; 3]) -> Option<(View, Meeting)> {
        let seen = self.seen(corners);
        let edges = self.edges(&seen);
        if edges.contains(&Sign::Positive) && edges.contains(&Sign::Negative) {
            return None;
        }
        let view = self.whole_view(&seen, edges);
        (!view.is_missed()).then(|| (view, self.meeting(&seen)))
    }

    /// How the ray sees a neighbour, which may be that it passes it by.
    pub(super) fn view_of_neighbour(&self, corners: [DVec3; 3]) -> View {
        let seen = self.seen(corners);
        self.whole_view(&seen, self.edges(&seen))
    }

    /// When the plane of a triangle is met.
    pub(super) fn meeting_of_neighbour(&self, corners: [DVec3; 3]) -> Bound {
        self.meeting(&self.seen(corners)).bound
    }

    #[inline(always)]
    fn edges(&self, seen: &Seen) -> [Sign; 3] {
        let [u, v] = self.across;
        let [a, b, c] = seen.relative.map(|corner| DVec2::new(u.dot(corner), v.dot(corner)));
        // Most that are looked at are hit, which one error for all three sides tells as well.
        let (ab, bc, ca) = (a.perp_dot(b), b.perp_dot(c), c.perp_dot(a));
        let farthest = a.abs().max(b.abs()).max(c.abs()).max_element();
        let doubt = self.error * (4.0 * farthest + 2.0 * self.error) + 8.0 * tolerance::ROUNDING * farthest * farthest;
        if (ab > doubt) & (bc > doubt) & (ca > doubt) {
            return [Sign::Positive; 3];
        }
        if (ab < -doubt) & (bc < -doubt) & (ca < -doubt) {
            return [Sign::Negative; 3];
        }
        [self.side(a, b), self.side(b, c), self.side(c, a)]
    }

    #[inline(always)]
    fn whole_view(&self, seen: &Seen, mut edges: [Sign; 3]) -> View {
        if edges.contains(&Sign::Unknown)
            && let Some(exact) = &self.ray.exact()
        {
            for (k, edge) in edges.iter_mut().enumerate().filter(|(_, edge)| **edge == Sign::Unknown) {
                *edge = exact_side(exact, seen.corners[k], seen.corners[(k + 1) % 3]);
            }
        }
        View { edges, facing: self.facing(seen) }
    }

    /// Twice the area between the ray and a side. Its error: corners are off by `error`, and two products and a
    /// difference round four times.
    fn side(&self, a: DVec2, b: DVec2) -> Sign {
        let (left, right) = (a.x * b.y, a.y * b.x);
        let spread = a.x.abs() + a.y.abs() + b.x.abs() + b.y.abs() + 2.0 * self.error;
        let error = self.error * spread + 4.0 * tolerance::ROUNDING * (left.abs() + right.abs());
        Sign::of(left - right, error)
    }

    #[inline(always)]
    fn facing(&self, seen: &Seen) -> Sign {
        let sign = Sign::of(seen.normal.dot(self.ray.direction), self.speed_error(seen));
        if sign == Sign::Unknown
            && let Some(exact) = self.ray.exact()
        {
            let direction = ExactVector::difference(exact.direction, DVec3::ZERO);
            return exact_normal(seen.corners).map_or(Sign::Unknown, |normal| normal.dot(&direction).sign().into());
        }
        sign
    }

    #[inline]
    fn speed_error(&self, seen: &Seen) -> f64 {
        2.0 * seen.normal_error + self.ray.direction_error * seen.normal.norm()
    }

    /// When the plane is met, should the ray go through the triangle: from the plane, and never outside of the
    /// stretch where its corners lie.
    #[inline(always)]
    fn meeting(&self, seen: &Seen) -> Meeting {
        let ray = self.ray;
        let [a, b, c] = seen.relative.map(|corner| corner.dot(ray.direction));
        let range = Bound::new(smaller(smaller(a, b), c) - 2.0 * ray.error, larger(larger(a, b), c) + 2.0 * ray.error);
        let (normal, first) = (seen.normal, seen.relative[0]);
        let speed = normal.dot(ray.direction);
        let speed_error = self.speed_error(seen);
        let spare = speed.abs() - speed_error;
        let mut bound = range;
        let mut best = 0.5 * range.lower + 0.5 * range.upper;
        if spare > 0.0 {
            best = normal.dot(first) / speed;
            let error =
                (normal.norm() * ray.error + 2.0 * seen.normal_error * first.norm() + best.abs() * speed_error) / spare;
            bound = Bound::new(larger(best - error, range.lower), smaller(best + error, range.upper));
        }
        let is_wide = spare <= 0.0 || bound.width() > tolerance::RAY_GRAZING * ray.error;
        if is_wide
            && let Some(exact) = ray.exact()
            && let Some(meeting) = exact_meeting(&exact, seen.corners)
        {
            return meeting;
        }
        let bound = if bound.lower <= bound.upper { bound } else { range };
        let bound = Bound::new(bound.lower + ray.shift - ray.error, bound.upper + ray.shift + ray.error);
        Meeting { bound, best: (best + ray.shift).clamp(bound.lower, bound.upper) }
    }

    /// Whether the plane is met at the origin of the ray or after it; `None` if that is not known exactly.
    pub(super) fn is_ahead(&self, corners: [DVec3; 3]) -> Option<bool> {
        let exact = self.ray.exact()?;
        let normal = exact_normal(corners)?;
        let height = normal.dot(&ExactVector::difference(corners[0], exact.origin)).sign();
        let speed = normal.dot(&ExactVector::difference(exact.direction, DVec3::ZERO)).sign();
        Some(height == Ordering::Equal || height == speed)
    }
}

/// Two unit vectors at right angles to a third and to each other, so that the three are right-handed. They are right to a few roundings.
#[inline]
pub(super) fn across(unit: DVec3) -> [DVec3; 2] {
    let DVec3 { x, y, z } = unit;
    let sign = 1.0_f64.copysign(z);
    let part = -1.0 / (sign + z);
    let both = x * y * part;
    [DVec3::new(1.0 + sign * x * x * part, sign * both, -sign * x), DVec3::new(both, sign + y * y * part, -y)]
}

/// The weights of the corners whose mean is `point`, which is in the triangle but for rounding; `None` if the square of its
/// area vanishes.
#[inline(always)]
pub(super) fn weights([a, b, c]: [DVec3; 3], point: DVec3) -> Option<DVec3> {
    let (plain, error) = normal([a, b, c]);
    // How it leans counts only times how far the point is off the plane, which is some roundings: it matters for slivers alone.
    let is_sliver = error * (tolerance::SLIVER_CROSS / tolerance::CROSS_PRODUCT) >= plain.abs().max_element();
    let normal = if is_sliver { exact::cross(b - a, c - a) } else { plain };
    let (a, b, c) = (a - point, b - point, c - point);
    let areas = DVec3::new(normal.dot(b.cross(c)), normal.dot(c.cross(a)), normal.dot(a.cross(b))).max(DVec3::ZERO);
    let sum = areas.element_sum();
    (sum > 0.0 && sum.is_finite()).then(|| areas / sum + DVec3::ZERO)
}

/// The normal, twice the area long, and a bound of the error of each of its components.
#[inline]
pub(super) fn normal([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let (along, across) = (b - a, c - a);
    let largest = along.abs().max_element() * across.abs().max_element();
    (along.cross(across), tolerance::CROSS_PRODUCT * largest)
}

/// `None` if the numbers are too large or too small for exact products.
fn exact_normal([a, b, c]: [DVec3; 3]) -> Option<ExactVector> {
    let (along, across) = (ExactVector::difference(b, a), ExactVector::difference(c, a));
    (along.is_in_range() && across.is_in_range()).then(|| along.cross(&across))
}

fn exact_side(exact: &ExactRay, a: DVec3, b: DVec3) -> Sign {
    let from_origin = |corner: DVec3| ExactVector::difference(corner, exact.origin);
    let (a, b) = (from_origin(a), from_origin(b));
    if !(a.is_in_range() && b.is_in_range()) {
        return Sign::Unknown;
    }
    a.cross(&b).dot(&ExactVector::difference(exact.direction, DVec3::ZERO)).sign().into()
}

/// From exact sums: an estimate of each is off by an ulp or two whatever cancels, and so is the length of the direction.
fn exact_meeting(exact: &ExactRay, corners: [DVec3; 3]) -> Option<Meeting> {
    let normal = exact_normal(corners)?;
    let height = normal.dot(&ExactVector::difference(corners[0], exact.origin)).estimate();
    let speed = normal.dot(&ExactVector::difference(exact.direction, DVec3::ZERO)).estimate();
    if speed == 0.0 {
        return None;
    }
    let best = height / speed * exact.direction.norm();
    let error = best.abs() * tolerance::EXACT_MEETING;
    Some(Meeting { bound: Bound::new(best - error, best + error), best })
}
