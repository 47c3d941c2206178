//! The way of one polytope to another, up to the face of the difference that the way leads through.
//!
//! # Method
//! Seen along the way, the difference is a flat shadow and the origin a point. Three corners of the difference whose
//! shadows hold that point are a portal: support planes across the way find it, or one of them parts the shadow from the
//! point, and the way is free. Then the portal is pushed to the support point along its normal, and of the three
//! triangles that this makes the one is kept that the way leads through, until nothing lies before the portal: it is a
//! part of the face that the way meets.
//!
//! ```text
//!          q                       q
//!         / \                     /|\
//!        / o \    beyond: v      / | \        o: the way, seen along itself
//!       /     \                 / .v. \
//!      p-------s               p-'o  '-s       kept: p, s, v
//! ```
//!
//! No distance is measured on the way, so a step costs a support pair and four products. Whatever the portal is, each plane
//! proves the way free up to itself: the greatest of these times is a lower bound of the first touch.
//!
//! # Source
//! Snethen, "Xenocollide" (Game Programming Gems 7, 2008): portal refinement. What was changed: the portal is sought across
//! the way itself, and planes are lowered by their rounding.
//!
//! # Limits
//! Cores with corners and no radius. Where the way leads through an edge of the difference to within rounding, or where the
//! difference lies behind the start, the portal may be none; the time is a lower bound all the same.

use glam::DVec3;

use super::{
    cast::{self, Approach},
    frame::Pair,
    gjk,
    simplex::{self, Simplex, Vertex},
};
use crate::{
    math::Norm,
    tolerance::{PAIR_ROUNDING, SQUARE_MIN, STEP_SHORTENING},
};

/// Most planes that are asked: some ten do for hulls of 128 corners, and what takes more goes round in circles.
const PLANES_MAX: u32 = 64;

/// Whether the two cores can be asked.
pub(super) fn applies(pair: &Pair<'_>) -> bool {
    pair.radius() <= 0.0 && pair.a.core.is_polytope() && pair.b.core.is_polytope()
}

/// How far `b` may go by `-way`, which takes the time from 0 to 1; up to `entry` it is known to be free.
pub(super) fn approach(pair: &Pair<'_>, way: DVec3, entry: f64, budget: u32) -> Approach {
    let toward_a = pair.a.center() - pair.b.center() + way * entry;
    let budget = budget.min(PLANES_MAX);
    let mut search = Search { pair, way, budget, iterations: 0, time: 0.0, normal: DVec3::ZERO };
    let corners = search.portal(toward_a).and_then(|portal| search.refined(portal));
    let shift = way * search.time.min(1.0);
    let simplex =
        corners.and_then(|corners| Simplex::nearest_of(corners.into_iter().map(|corner| cast::moved(corner, shift))));
    Approach { time: search.time, normal: search.normal, simplex, iterations: search.iterations }
}

/// Whether the origin surely lies behind three points of the difference that have moved by `shift` as all of it has: in the
/// tetrahedron that they make with a point inside, by more than `rounding`. So the forms overlap.
pub(super) fn is_behind(pair: &Pair<'_>, corners: &[DVec3; 3], shift: DVec3, rounding: f64) -> bool {
    let [a, b, c] = corners.map(|corner| corner + shift);
    let inner = pair.a.center() - pair.b.center() + shift;
    // Most origins that do not are before the three.
    let normal = (b - a).cross(c - a);
    let is_beside = normal.dot(a) * normal.dot(inner - a) < 0.0;
    is_beside && simplex::margin(&[a, b, c, inner]).is_some_and(|margin| margin > rounding)
}

struct Search<'p, 'a> {
    pair: &'p Pair<'a>,
    way: DVec3,
    budget: u32,
    iterations: u32,
    /// The way is free up to here.
    time: f64,
    /// Unit normal of the plane that proves it.
    normal: DVec3,
}

impl Search<'_, '_> {
    /// The vertex along a direction, and what its plane proves; `None` once the way is proved to be free or the budget is
    /// spent.
    fn support(&mut self, direction: DVec3) -> Option<Vertex> {
        if self.iterations >= self.budget {
            return None;
        }
        self.iterations += 1;
        let vertex = gjk::support(self.pair, direction);
        let length_sq = direction.length_squared();
        let length = length_sq.sqrt();
        let free = direction.dot(vertex.point) - PAIR_ROUNDING * length;
        if free > 0.0 && length_sq >= SQUARE_MIN {
            let closing = -direction.dot(self.way);
            let time = if closing > 0.0 { free / closing * STEP_SHORTENING } else { f64::INFINITY };
            if time > self.time {
                (self.time, self.normal) = (time, direction / length);
            }
        }
        (self.time <= 1.0).then_some(vertex)
    }

    /// On which side of the line of the way the edge from `p` to `q` passes: above 0 if it turns about it to the left.
    fn side(&self, p: &Vertex, q: &Vertex) -> f64 {
        -self.way.dot(p.point.cross(q.point))
    }

    /// Three vertices, in order about the way, between which it leads.
    fn portal(&mut self, toward_a: DVec3) -> Option<[Vertex; 3]> {
        let first = self.support(toward_a)?;
        let length_sq = self.way.length_squared();
        let aside = first.point - self.way * (first.point.dot(self.way) / length_sq.max(SQUARE_MIN));
        let second = self.support(aside)?;
        if second.is_same(&first) {
            return None;
        }
        let (mut p, mut q) = if self.side(&first, &second) < 0.0 { (second, first) } else { (first, second) };
        loop {
            let s = self.support(self.way.cross(q.point - p.point))?;
            if self.side(&q, &s) < 0.0 {
                if s.is_same(&p) {
                    return None;
                }
                p = s;
            } else if self.side(&s, &p) < 0.0 {
                if s.is_same(&q) {
                    return None;
                }
                q = s;
            } else {
                return Some([p, q, s]);
            }
        }
    }

    /// The portal that nothing lies before.
    fn refined(&mut self, [mut p, mut q, mut s]: [Vertex; 3]) -> Option<[Vertex; 3]> {
        loop {
            let normal = (q.point - p.point).cross(s.point - p.point);
            let vertex = self.support(normal)?;
            if normal.dot(vertex.point - p.point) >= -PAIR_ROUNDING * normal.norm() {
                return Some([p, q, s]);
            }
            // From which corner's side the way passes the edge to the new vertex.
            let across = vertex.point.cross(self.way);
            let [by_p, by_q, by_s] = [&p, &q, &s].map(|corner| across.dot(corner.point));
            if by_p >= 0.0 && by_q <= 0.0 {
                s = vertex;
            } else if by_q >= 0.0 && by_s <= 0.0 {
                p = vertex;
            } else {
                q = vertex;
            }
        }
    }
}
