//! The part of a simplex that is nearest to the origin after a vertex was taken in.
//!
//! # Method
//! The old vertices are all needed for their own nearest point, and the new one lies beyond it; then the part that is nearest
//! now holds the new vertex. So only its edges and the faces between them are looked at, all relative to it. A foot of the
//! origin inside a face that the origin lies beyond is the nearest point of all, and no second face is asked; where there is
//! none the nearest of the edges' feet is, or else the new vertex itself.
//!
//! ```text
//!       a
//!      / \          new: edges to a and b, one face;
//!     /   \         the side from a to b is never nearest
//!    b-----new
//! ```
//!
//! # Source
//! The signed volumes of [`simplex`](super::simplex), which see; that the newest vertex stays is from Gilbert, Johnson,
//! Keerthi (1988).
//!
//! # Limits
//! Slivers, and what rounding makes contradict itself, are left to the search of all parts.

use glam::DVec3;

use super::simplex::Part;
use crate::tolerance::SMALL_AREA;

/// The part nearest to the origin of the first `newest` vertices, one to three, and the one after them. `None` if rounding
/// leaves it open.
#[inline(always)]
pub(super) fn newest_part(p: &[DVec3; 4], newest: usize) -> Option<Part> {
    let fan = Fan { p, newest, middle: p[newest] };
    match newest {
        1 => fan.nearest_edge::<1>(),
        2 => match fan.foot([0, 1], fan.edge(0).cross(fan.edge(1))) {
            Foot::Outside => fan.nearest_edge::<2>(),
            Foot::Inside(part) => Some(part),
            Foot::Unclear => None,
        },
        _ => fan.nearest_of_tetrahedron(),
    }
}

/// A vertex and its edges to the others.
struct Fan<'a> {
    p: &'a [DVec3; 4],
    newest: usize,
    middle: DVec3,
}

/// Where the foot of the origin on a triangle's plane lies.
enum Foot {
    Inside(Part),
    Outside,
    /// The triangle is a sliver.
    Unclear,
}

impl Fan<'_> {
    #[inline(always)]
    fn edge(&self, i: usize) -> DVec3 {
        self.p[i] - self.middle
    }

    /// The foot of the origin on the triangle of two edges, whose product is `normal`.
    #[inline(always)]
    fn foot(&self, [i, j]: [usize; 2], normal: DVec3) -> Foot {
        let whole = normal.length_squared();
        if whole <= SMALL_AREA * SMALL_AREA {
            return Foot::Unclear;
        }
        let across = self.middle.cross(normal);
        let (u, v) = (self.edge(i), self.edge(j));
        let areas = [v.dot(across), -u.dot(across)];
        if areas[0] > 0.0 && areas[1] > 0.0 && areas[0] + areas[1] < whole {
            let scale = 1.0 / whole;
            let [on_i, on_j] = [areas[0] * scale, areas[1] * scale];
            let weights = [on_i, on_j, 1.0 - (on_i + on_j), 0.0];
            let point = self.middle + (u * on_i + v * on_j);
            return Foot::Inside(Part { members: [i, j, self.newest, 0], weights, count: 3, point });
        }
        Foot::Outside
    }

    /// The nearest of the first `COUNT` edges, or the vertex.
    #[inline(always)]
    fn nearest_edge<const COUNT: usize>(&self) -> Option<Part> {
        // How much nearer the foot on an edge is than the vertex is the square of the one over the other.
        let (mut best, mut along, mut whole) = (0, 0.0, 1.0);
        for i in 0..COUNT {
            let edge = self.edge(i);
            let (next, square) = (-self.middle.dot(edge), edge.length_squared());
            if next > 0.0 && next * next * whole > along * along * square {
                (best, along, whole) = (i, next, square);
            }
        }
        if along <= 0.0 {
            return Some(Part::one(self.p, self.newest));
        }
        let weight = along / whole;
        let weights = [weight, 1.0 - weight, 0.0, 0.0];
        let point = self.middle + self.edge(best) * weight;
        (weight < 1.0).then_some(Part { members: [best, self.newest, 0, 0], weights, count: 2, point })
    }

    #[inline(always)]
    fn nearest_of_tetrahedron(&self) -> Option<Part> {
        let edges = [self.edge(0), self.edge(1), self.edge(2)];
        let normals = [edges[1].cross(edges[2]), edges[2].cross(edges[0]), edges[0].cross(edges[1])];
        let volume = edges[0].dot(normals[0]);
        let shares = normals.map(|normal| -self.middle.dot(normal));
        // What weighs nothing or less has the origin beyond the face across from it.
        let is_beyond = shares.map(|share| share * volume <= 0.0);
        if is_beyond == [false; 3] {
            let [a, b, c] = shares.map(|share| share / volume);
            let weights = [a, b, c, 1.0 - (a + b + c)];
            let point = self.middle + (edges[0] * a + edges[1] * b + edges[2] * c);
            return (weights[3] > 0.0).then_some(Part { members: [0, 1, 2, 3], weights, count: 4, point });
        }
        for (i, [j, k]) in [[1, 2], [0, 2], [0, 1]].into_iter().enumerate() {
            if is_beyond[i] {
                let normal = if i == 1 { -normals[i] } else { normals[i] };
                match self.foot([j, k], normal) {
                    Foot::Outside => {}
                    Foot::Inside(part) => return Some(part),
                    Foot::Unclear => return None,
                }
            }
        }
        self.nearest_edge::<3>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow::convex::simplex::nearest_part;

    /// What is found is compared with the search of all parts, from simplexes as a search meets them.
    #[test]
    fn no_other_part_is_nearer() {
        let mut state = 1_u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        let mut point = || DVec3::new(number(), number(), number());
        let mut found = [[0; 5]; 4];
        for _ in 0..100_000 {
            let p = [point(), point(), point(), point()];
            for newest in 1..4 {
                let old = nearest_part(&p, newest);
                if old.count < newest || old.point.dot(p[newest]) >= old.point.length_squared() {
                    continue;
                }
                let Some(part) = newest_part(&p, newest) else { continue };
                let best = nearest_part(&p, newest + 1);
                let (length, least) = (part.point.length(), best.point.length());
                assert!((length - least).abs() < crate::tolerance::PAIR_ROUNDING, "{p:?} {newest}: {length} {least}");
                assert!(part.members[..part.count].contains(&newest));
                found[newest][part.count] += 1;
            }
        }
        let [_, [_, a, b, ..], [_, c, d, e, _], [_, f, g, h, i]] = found;
        assert!([a, b, c, d, e, f, g, h, i].iter().all(|&count| count > 10), "each kind must occur: {found:?}");
    }
}
