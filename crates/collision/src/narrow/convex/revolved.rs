//! The signed distance of two bodies of revolution about parallel axes, or of one and a point, by formula.
//!
//! # Method
//! The difference of the two is a body of revolution again, and what is nearest lies in the half plane through its axis and
//! the second form's origin. There each of the two is a trapezoid (a triangle, a line, a point are such), so the difference
//! is a polygon of at most four edges on this side of the axis: the flat top, the two slants in the order of their normals,
//! the flat bottom. The rest is plane geometry.
//!
//! ```text
//!     y |___________                        cylinder a, upright cone b:
//!       |     top   |                       the cone is seen upside down, and its slant comes after the side
//!       |           | a's side
//!       |           |          x  second's origin
//!       |          /
//!       |_________/ b's slant
//!         bottom     r
//! ```
//!
//! # Source
//! Ours; the sum of convex polygons by merging their edges is in de Berg et al., Computational Geometry (2008), 13.3.
//!
//! # Limits
//! Axes that lean by less than [`NEARLY_PARALLEL_SINE`] are taken for parallel, and what that may be off by, the lean over the
//! reach of the second form, is added to the interval. Others have no formula here.

use glam::{DVec2, DVec3};

use super::{
    body::Body,
    formula::{Signed, plane},
    frame::Pair,
};
use crate::{
    math::Norm,
    shape::Core,
    tolerance::{NEARLY_PARALLEL_SINE, PAIR_ROUNDING},
};

/// The signed distance, if both are such bodies and their axes are parallel.
pub(super) fn signed(pair: &Pair<'_>) -> Option<Signed> {
    let (a, b) = (Frustum::of(&pair.a)?, Frustum::of(&pair.b)?);
    let axis = pair.b.rotation.y_axis;
    let (b, lean) = match pair.b.core {
        Core::Point => (b, 0.0),
        _ if axis.y > 0.0 => (b, DVec2::new(axis.x, axis.z).norm()),
        _ => (b.upside_down(), DVec2::new(axis.x, axis.z).norm()),
    };
    if lean > NEARLY_PARALLEL_SINE {
        return None;
    }
    let meridian = Meridian::through(pair.b.position);
    let touch = Difference::of(&a, &b.upside_down()).touch(meridian.point)?;
    let normal = DVec3::ZERO - meridian.out(touch.outward);
    let rounding = PAIR_ROUNDING + lean * b.reach();
    let (on_a, on_b) = (meridian.out(touch.on_a), pair.b.position - meridian.out(touch.on_b));
    // Inside, the formula alone proves how far the boundary is at least; outside, the two points are no nearer than the forms.
    let upper = if touch.signed < 0.0 {
        touch.signed + PAIR_ROUNDING + rounding
    } else {
        touch.signed.max((on_a - on_b).norm()) + rounding
    };
    let [on_a, on_b] = if lean > 0.0 { on_planes(pair, normal, [on_a, on_b]) } else { [on_a, on_b] };
    Some(Signed {
        lower: plane(pair, normal).min(upper),
        upper,
        normal,
        on_a,
        on_b,
        common: meridian.out(common_point(&a, &b, meridian.point)),
        corners: [touch.feature; 2],
    })
}

/// Points moved along the normal onto the planes that the forms reach to: of forms that lean from each other the formula's points
/// are off by the lean, and would lie deeper in each other than the forms are.
fn on_planes(pair: &Pair<'_>, normal: DVec3, [on_a, on_b]: [DVec3; 2]) -> [DVec3; 2] {
    let (a, b) = (pair.a.support(DVec3::ZERO - normal).point, pair.b.support(normal).point);
    [on_a + normal * (a - on_a).dot(normal), on_b + normal * (b - on_b).dot(normal)]
}

/// The half plane through the first form's axis and a point.
struct Meridian {
    /// Unit vector away from the axis.
    across: DVec3,
    /// The point: away from the axis, and along it.
    point: DVec2,
}

impl Meridian {
    fn through(point: DVec3) -> Self {
        let across = DVec3::new(point.x, 0.0, point.z);
        Self { across: across.try_unit().unwrap_or(DVec3::X), point: DVec2::new(across.norm(), point.y) }
    }

    fn out(&self, point: DVec2) -> DVec3 {
        self.across * point.x + DVec3::Y * point.y
    }
}

/// A cylinder, a cone, a segment or a point, upright about the origin.
#[derive(Clone, Copy)]
struct Frustum {
    half_height: f64,
    top_radius: f64,
    bottom_radius: f64,
}

impl Frustum {
    /// In its own axes, of the frame's size.
    fn of(body: &Body<'_>) -> Option<Self> {
        let of = |half_height: f64, top_radius: f64, bottom_radius: f64| Self {
            half_height: half_height * body.scale,
            top_radius: top_radius * body.scale,
            bottom_radius: bottom_radius * body.scale,
        };
        match body.core {
            Core::Cylinder { half_height, radius } => Some(of(*half_height, *radius, *radius)),
            Core::Cone { half_height, radius } => Some(of(*half_height, 0.0, *radius)),
            Core::Segment { half_height } => Some(of(*half_height, 0.0, 0.0)),
            Core::Point => Some(of(0.0, 0.0, 0.0)),
            Core::Cuboid { .. } | Core::Hull(_) | Core::Triangle(_) | Core::Ellipsoid { .. } => None,
        }
    }

    fn upside_down(self) -> Self {
        Self { top_radius: self.bottom_radius, bottom_radius: self.top_radius, ..self }
    }

    /// No point is farther from the origin.
    fn reach(&self) -> f64 {
        self.half_height + self.top_radius.max(self.bottom_radius)
    }

    fn top(&self) -> DVec2 {
        DVec2::new(self.top_radius, self.half_height)
    }

    fn bottom(&self) -> DVec2 {
        DVec2::new(self.bottom_radius, -self.half_height)
    }

    /// How far it reaches from its axis at a height.
    fn radius_at(&self, y: f64) -> f64 {
        if self.half_height <= 0.0 {
            return self.top_radius;
        }
        let share = ((y / self.half_height + 1.0) / 2.0).clamp(0.0, 1.0);
        self.bottom_radius + (self.top_radius - self.bottom_radius) * share
    }
}

/// An edge of the difference: the sum of one of `a` and one of the reflected `b`, either of which may be a corner only.
#[derive(Clone, Copy)]
struct Edge {
    a: [DVec2; 2],
    b: [DVec2; 2],
}

impl Edge {
    fn start(&self) -> DVec2 {
        self.a[0] + self.b[0]
    }

    fn along(&self) -> DVec2 {
        (self.a[1] - self.a[0]) + (self.b[1] - self.b[0])
    }

    /// How a point lies to it; `None` if the edge has no length.
    fn look(&self, point: DVec2) -> Option<Look> {
        let along = self.along();
        let outward = DVec2::new(-along.y, along.x).try_unit()?;
        let from_start = point - self.start();
        let share = from_start.dot(along) / along.length_squared();
        let clamped = share.clamp(0.0, 1.0);
        let [on_a, on_b] = [self.a, self.b].map(|[start, end]| start + (end - start) * clamped);
        let (height, from_corner) = (outward.dot(from_start), point - (on_a + on_b));
        let distance = if share == clamped { height.abs() } else { from_corner.norm() };
        // Corners have even numbers, edges odd ones.
        let feature = if share <= 0.0 {
            0
        } else if share >= 1.0 {
            2
        } else {
            1
        };
        Some(Look { height, distance, outward, from_corner, on_a, on_b, feature })
    }
}

/// How a point lies to an edge.
struct Look {
    /// Above its line.
    height: f64,
    /// From the edge itself.
    distance: f64,
    outward: DVec2,
    /// From what is nearest of the edge.
    from_corner: DVec2,
    on_a: DVec2,
    on_b: DVec2,
    feature: u32,
}

/// The section of the difference, clockwise from the top of the axis to its bottom.
struct Difference {
    edges: [Edge; 4],
}

/// Where a point is nearest to the boundary of the difference.
struct Touch {
    signed: f64,
    outward: DVec2,
    on_a: DVec2,
    on_b: DVec2,
    /// Numbers the edges and corners.
    feature: u32,
}

impl Difference {
    fn of(a: &Frustum, b: &Frustum) -> Self {
        let (top_a, bottom_a, top_b, bottom_b) = (a.top(), a.bottom(), b.top(), b.bottom());
        let turn = (bottom_a - top_a).perp_dot(bottom_b - top_b);
        let slants = if turn < 0.0 {
            [Edge { a: [top_a, bottom_a], b: [top_b; 2] }, Edge { a: [bottom_a; 2], b: [top_b, bottom_b] }]
        } else if turn > 0.0 {
            [Edge { a: [top_a; 2], b: [top_b, bottom_b] }, Edge { a: [top_a, bottom_a], b: [bottom_b; 2] }]
        } else {
            [Edge { a: [top_a, bottom_a], b: [top_b, bottom_b] }, Edge { a: [bottom_a; 2], b: [bottom_b; 2] }]
        };
        let to_axis = |point: DVec2| DVec2::new(0.0, point.y);
        let top = Edge { a: [to_axis(top_a), top_a], b: [to_axis(top_b), top_b] };
        let bottom = Edge { a: [bottom_a, to_axis(bottom_a)], b: [bottom_b, to_axis(bottom_b)] };
        Self { edges: [top, slants[0], slants[1], bottom] }
    }

    /// Of a point outside, what is nearest of the boundary; of one inside, its foot on the edge whose line is nearest. `None`
    /// only if no edge has a length.
    fn touch(&self, point: DVec2) -> Option<Touch> {
        let looks = self.edges.map(|edge| edge.look(point));
        let is_outside = looks.iter().flatten().any(|look| look.height > 0.0);
        let far = |look: &Look| if is_outside { look.distance } else { -look.height };
        let mut nearest = None::<(u32, &Look)>;
        for (number, look) in (0..).zip(&looks) {
            // From outside only the edges that see the point count: of a flat form the far side may be as near.
            if let Some(look) = look
                && (!is_outside || look.height > 0.0)
                && nearest.is_none_or(|(_, least)| far(look) < far(least))
            {
                nearest = Some((number, look));
            }
        }
        let (number, look) = nearest?;
        let at_corner = look.from_corner.try_unit().filter(|_| is_outside && look.feature != 1);
        Some(Touch {
            signed: if at_corner.is_some() { look.distance } else { look.height },
            outward: at_corner.unwrap_or(look.outward),
            on_a: look.on_a,
            on_b: look.on_b,
            feature: 2 * number + look.feature,
        })
    }
}

/// A point of both forms about the middle of what they share at the height where that is widest: the radii change evenly
/// between the ends, so it is at one of them.
fn common_point(a: &Frustum, b: &Frustum, origin_b: DVec2) -> DVec2 {
    let radii = |y: f64| (a.radius_at(y), b.radius_at(y - origin_b.y));
    let low = (origin_b.y - b.half_height).max(-a.half_height);
    let high = (origin_b.y + b.half_height).min(a.half_height);
    let sum = |y: f64| radii(y).0 + radii(y).1;
    let y = if sum(low) == sum(high) {
        0.5 * low + 0.5 * high
    } else if sum(low) > sum(high) {
        low
    } else {
        high
    };
    let (radius_a, radius_b) = radii(y);
    let (inner, outer) = ((origin_b.x - radius_b).max(-radius_a), (origin_b.x + radius_b).min(radius_a));
    DVec2::new(0.5 * inner + 0.5 * outer, y)
}
