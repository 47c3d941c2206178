//! A triangle as a ray sees it: on which side of each edge the ray passes, which side it faces, and when it is met.
//!
//! # Method
//! The triangle is sheared along the ray's largest axis so that the ray becomes the axis; edge functions are then areas in
//! the plane, each with its error. What the error leaves open is decided exactly where the ray is known exactly.
//!
//! # Source
//! Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection" (2013), section 3: the shear. The error bounds, and
//! expansions instead of a second precision, are ours.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};

use super::frame::{ExactRay, LocalRay};
use crate::{
    answer::Bound,
    math::{Norm, exact, expansion::ExactVector},
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
    /// What a corner is multiplied by to be sheared: no more than picking coordinates, without asking which.
    across: [DVec3; 2],
    /// Sign of the ray's largest component.
    along: f64,
    /// Bounds the error of a sheared corner.
    error: f64,
}

impl<'a> Sight<'a> {
    pub(super) fn new(ray: &'a LocalRay, center: DVec3) -> Self {
        let largest = ray.direction.abs().max_position();
        let [x, y] = [(largest + 1) % 3, (largest + 2) % 3];
        let d = ray.direction;
        let along = DVec3::AXES[largest];
        Self {
            ray,
            center,
            across: [x, y].map(|axis| DVec3::AXES[axis] - along * (d[axis] / d[largest])),
            along: d[largest].signum(),
            error: 3.0 * ray.error,
        }
    }

    /// Whether it surely passes a triangle by, told from one error for all sides: true of most that a tree offers, though not of
    /// all that [`Sight::view`] would find.
    pub(super) fn passes(&self, corners: [DVec3; 3]) -> bool {
        let [a, b, c] = corners.map(|corner| self.sheared(corner));
        let (ab, bc, ca) = (a.perp_dot(b), b.perp_dot(c), c.perp_dot(a));
        let farthest = a.abs().max(b.abs()).max(c.abs()).max_element();
        let doubt = self.error * (4.0 * farthest + 2.0 * self.error) + 8.0 * tolerance::ROUNDING * farthest * farthest;
        ab.min(bc).min(ca) < -doubt && ab.max(bc).max(ca) > doubt
    }

    /// Looks at a triangle, given by its corners in the local frame. If the ray surely passes it by, no more is found out.
    pub(super) fn view(&self, corners: [DVec3; 3]) -> View {
        let edges = self.edges(corners);
        if edges.contains(&Sign::Positive) && edges.contains(&Sign::Negative) {
            let facing = Sign::Unknown;
            return View { edges, facing };
        }
        self.whole_view(corners, edges)
    }

    /// Looks at a neighbour, of which more must be known than that the ray passes it by.
    pub(super) fn view_of_neighbour(&self, corners: [DVec3; 3]) -> View {
        self.whole_view(corners, self.edges(corners))
    }

    fn edges(&self, [a, b, c]: [DVec3; 3]) -> [Sign; 3] {
        let (a, b, c) = (self.sheared(a), self.sheared(b), self.sheared(c));
        [self.side(a, b), self.side(b, c), self.side(c, a)]
    }

    fn whole_view(&self, corners: [DVec3; 3], mut edges: [Sign; 3]) -> View {
        if let Some(exact) = &self.ray.exact {
            for k in 0..3 {
                if edges[k] == Sign::Unknown {
                    edges[k] = exact_side(exact, corners[k], corners[(k + 1) % 3]);
                }
            }
        }
        let facing = self.facing(corners);
        View { edges, facing }
    }

    #[inline]
    fn sheared(&self, corner: DVec3) -> DVec2 {
        let relative = (corner - self.center) - self.ray.foot;
        let [x, y] = self.across;
        DVec2::new(x.dot(relative), y.dot(relative))
    }

    /// Twice the area between the ray and a side. Its error: corners are off by `error`, and two products and a
    /// difference round four times.
    #[inline]
    fn side(&self, a: DVec2, b: DVec2) -> Sign {
        let (left, right) = (a.x * b.y, a.y * b.x);
        let spread = a.x.abs() + a.y.abs() + b.x.abs() + b.y.abs() + 2.0 * self.error;
        let error = self.error * spread + 4.0 * tolerance::ROUNDING * (left.abs() + right.abs());
        Sign::of((left - right) * self.along, error)
    }

    fn facing(&self, corners: [DVec3; 3]) -> Sign {
        let (normal, normal_error) = normal(corners);
        let error = self.speed_error(normal, normal_error);
        match (Sign::of(normal.dot(self.ray.direction), error), &self.ray.exact) {
            (Sign::Unknown, Some(exact)) => {
                let direction = ExactVector::difference(exact.direction, DVec3::ZERO);
                exact_normal(corners).map_or(Sign::Unknown, |normal| normal.dot(&direction).sign().into())
            }
            (sign, _) => sign,
        }
    }

    fn speed_error(&self, normal: DVec3, normal_error: f64) -> f64 {
        2.0 * normal_error + self.ray.direction_error * normal.norm()
    }

    /// When the plane is met, should the ray go through the triangle: from the plane, and never outside of the
    /// stretch where its corners lie.
    pub(super) fn meeting(&self, corners: [DVec3; 3]) -> Meeting {
        let ray = self.ray;
        let relative = |corner: DVec3| (corner - self.center) - ray.foot;
        let first = relative(corners[0]);
        let (a, b, c) = (
            first.dot(ray.direction),
            relative(corners[1]).dot(ray.direction),
            relative(corners[2]).dot(ray.direction),
        );
        let range = Bound::new(a.min(b).min(c) - 2.0 * ray.error, a.max(b).max(c) + 2.0 * ray.error);
        let (normal, normal_error) = normal(corners);
        let speed = normal.dot(ray.direction);
        let speed_error = self.speed_error(normal, normal_error);
        let spare = speed.abs() - speed_error;
        let mut bound = range;
        let mut best = 0.5 * range.lower + 0.5 * range.upper;
        if spare > 0.0 {
            best = normal.dot(first) / speed;
            let error =
                (normal.norm() * ray.error + 2.0 * normal_error * first.norm() + best.abs() * speed_error) / spare;
            bound = Bound::new((best - error).max(range.lower), (best + error).min(range.upper));
        }
        let is_wide = spare <= 0.0 || bound.width() > tolerance::RAY_GRAZING * ray.error;
        if let (true, Some(exact)) = (is_wide, &ray.exact)
            && let Some(meeting) = exact_meeting(exact, corners)
        {
            return meeting;
        }
        let bound = if bound.lower <= bound.upper { bound } else { range };
        let bound = Bound::new(bound.lower + ray.shift - ray.error, bound.upper + ray.shift + ray.error);
        Meeting { bound, best: (best + ray.shift).clamp(bound.lower, bound.upper) }
    }

    /// Whether the plane is met at the origin of the ray or after it; `None` if that is not known exactly.
    pub(super) fn is_ahead(&self, corners: [DVec3; 3]) -> Option<bool> {
        let exact = self.ray.exact.as_ref()?;
        let normal = exact_normal(corners)?;
        let height = normal.dot(&ExactVector::difference(corners[0], exact.origin)).sign();
        let speed = normal.dot(&ExactVector::difference(exact.direction, DVec3::ZERO)).sign();
        Some(height == Ordering::Equal || height == speed)
    }
}

/// The weights of the corners whose mean is `point`, which is in the triangle but for rounding; `None` if the square of its
/// area vanishes.
pub(super) fn weights([a, b, c]: [DVec3; 3], point: DVec3) -> Option<DVec3> {
    let normal = exact::cross(b - a, c - a);
    let (a, b, c) = (a - point, b - point, c - point);
    let areas = DVec3::new(normal.dot(b.cross(c)), normal.dot(c.cross(a)), normal.dot(a.cross(b))).max(DVec3::ZERO);
    let sum = areas.element_sum();
    (sum > 0.0 && sum.is_finite()).then(|| areas / sum + DVec3::ZERO)
}

/// The normal, twice the area long, and a bound of the error of each of its components.
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
