//! The gap between two cores, with proof on both sides.
//!
//! # Method
//! Gilbert-Johnson-Keerthi: the simplex's nearest point bounds the gap from above, the support plane across it from
//! below. When the simplex no longer changes, the normal is taken from the features that support it (edge, face) instead
//! of from the nearest point, whose direction loses ε·S/d of its accuracy at a gap d; so narrow gaps keep their proof. Where
//! that leaves more than rounding, beside round cores, the normals of straight features are tried ([`straight`]), and at the tips of
//! needles normals that lean.
//!
//! # Source
//! Gilbert, Johnson, Keerthi (1988); stopping on the certified gap: van den Bergen, "A fast and robust GJK
//! implementation" (1999), sections 3 and 4.
//!
//! # Limits
//! Round cores converge linearly: about 17 iterations to the last bit for an ellipsoid, more for flat ones. A budget that
//! is spent leaves a wide interval, never a verdict.

use glam::DVec3;

use super::{
    boxes,
    depth::Touch,
    formula,
    frame::Pair,
    rods,
    simplex::{Simplex, Vertex},
    straight,
    warm::Seed,
};
use crate::{
    answer::{Method, Stop},
    math::{Norm, exact},
    tolerance::{DEPTH_WIDTH, PAIR_ROUNDING},
};

/// Most vertices that join the features of a nearest point once it has settled. One or two do for faces that meet at an
/// edge; the rest is for slivers and for round hulls.
const POLISH_ROUNDS: u32 = 32;

/// Most planes that are tried by leaning: a few do, unless there is no such plane.
const LEAN_ROUNDS: u32 = 16;

/// What is known of the gap between two cores, in the pair's frame.
pub(super) struct Gap {
    /// The gap is not below this; 0 where nothing better is proved.
    pub(super) lower: f64,
    /// The gap is not above this.
    pub(super) upper: f64,
    /// The best value.
    pub(super) length: f64,
    /// Unit vector from `b` to `a` across which `lower` was proved; 0 where nothing was.
    pub(super) normal: DVec3,
    /// Where it ended: its point is the nearest that was found, its tetrahedron may hold the origin.
    pub(super) simplex: Simplex,
    /// How deep inside a tetrahedron of the difference the origin lies; the cores overlap at least so deep.
    pub(super) inside: f64,
    pub(super) iterations: u32,
    pub(super) method: Method,
    pub(super) stop: Stop,
}

impl Gap {
    /// Where the cores are nearest: on `a` and on `b`.
    pub(super) fn witnesses(&self) -> (DVec3, DVec3) {
        self.simplex.witnesses()
    }
}

/// Measures the gap until `is_enough(lower, upper)`, or until the arithmetic gives no more, or the budget is spent.
pub(super) fn gap(pair: &Pair<'_>, budget: u32, is_enough: impl Fn(f64, f64) -> bool) -> Gap {
    gap_warm(pair, &mut None, budget, is_enough)
}

/// The same from what an earlier question about the pair found, which what is found now takes the place of.
pub(super) fn gap_warm(
    pair: &Pair<'_>,
    seed: &mut Option<Seed>,
    budget: u32,
    is_enough: impl Fn(f64, f64) -> bool,
) -> Gap {
    // One after the other: a gap is large to hand on.
    if let Some(gap) = rods::gap(pair) {
        return gap;
    }
    if let Some(gap) = formula::gap(pair) {
        return gap;
    }
    if seed.is_none()
        && let Some(gap) = boxes::gap(pair)
    {
        *seed = Some(Seed::of(&gap));
        return gap;
    }
    let mut gap = match seed {
        Some(seed) if seed.is_known_to(pair) => Gap::beginning_with(seed.simplex(pair)),
        _ => Gap::cold(pair),
    };
    let stop = gap.run(pair, budget, is_enough);
    gap.end(stop);
    *seed = Some(Seed::of(&gap));
    gap
}

/// The vertex of `a − b` that lies least far along `direction`.
#[inline(always)]
pub(super) fn support(pair: &Pair<'_>, direction: DVec3) -> Vertex {
    Vertex::new(pair.a.support(-direction), pair.b.support(direction))
}

/// The search: what it knows is the gap as far as that has been found, where it stays until it is done.
impl Gap {
    /// Begins with the vertex across the line of the middles, and what its plane proves.
    #[inline(always)]
    fn cold(pair: &Pair<'_>) -> Self {
        let apart = pair.a.center() - pair.b.center();
        let length = apart.norm();
        let (direction, length) = if length > PAIR_ROUNDING { (apart, length) } else { (DVec3::X, 1.0) };
        let first = support(pair, direction);
        let mut gap = Self::beginning_with(Simplex::of(first));
        gap.raise_lower_to(direction, length, &first);
        gap
    }

    #[inline(always)]
    fn beginning_with(simplex: Simplex) -> Self {
        Self {
            lower: 0.0,
            upper: f64::INFINITY,
            length: 0.0,
            normal: DVec3::ZERO,
            simplex,
            inside: 0.0,
            iterations: 0,
            method: Method::Gjk,
            stop: Stop::Budget,
        }
    }

    #[inline(always)]
    fn run(&mut self, pair: &Pair<'_>, budget: u32, is_enough: impl Fn(f64, f64) -> bool) -> Stop {
        while self.iterations < budget {
            self.iterations += 1;
            if self.simplex.vertices().len() == 4 {
                return Stop::Converged;
            }
            let nearest = self.simplex.point();
            let length = nearest.norm();
            if length <= PAIR_ROUNDING {
                return Stop::Converged;
            }
            if is_enough(self.lower, length + PAIR_ROUNDING) {
                return Stop::Tolerance;
            }
            if length - self.lower <= 2.0 * PAIR_ROUNDING {
                return Stop::Converged;
            }
            let vertex = self.raise_lower(pair, nearest, length);
            if is_enough(self.lower, length + PAIR_ROUNDING) {
                return Stop::Tolerance;
            }
            if length - self.lower <= 2.0 * PAIR_ROUNDING {
                return Stop::Converged;
            }
            let is_settled = self.simplex.contains(&vertex) || !self.simplex.advance(&vertex);
            if is_settled
                && !self.polish(pair, nearest / length, length)
                && !self.straighten(pair, nearest / length, length)
            {
                self.lean(pair, nearest / length, length);
                return Stop::Converged;
            }
        }
        Stop::Budget
    }

    /// Proves what the plane across `direction` of that `length` can prove, and returns its vertex. The support needs no
    /// unit vector, so the processor seeks it while the root and the quotient are still on their way.
    fn raise_lower(&mut self, pair: &Pair<'_>, direction: DVec3, length: f64) -> Vertex {
        let vertex = support(pair, direction);
        self.raise_lower_to(direction, length, &vertex);
        vertex
    }

    /// The same with the support vertex along the direction.
    fn raise_lower_to(&mut self, direction: DVec3, length: f64, vertex: &Vertex) {
        let plane = direction.dot(vertex.point) / length - PAIR_ROUNDING;
        if plane > self.lower {
            self.lower = plane;
            self.normal = direction / length;
        }
    }

    /// Raises the lower bound by normals of the features that support the nearest point. Where that point lies within
    /// rounding of an edge between faces, no vertex brings it measurably nearer, though the plane may still lean by the
    /// square root of that. So the features are refined as a portal is: support vertices beyond their plane join them,
    /// and of four the triangle that the way to the origin leads through is kept. Says whether the features that were
    /// found lie nearer than `length`: between faces that are all but parallel the true nearest point may be far along
    /// them.
    ///
    /// Portal refinement: Snethen, "Xenocollide" (Game Programming Gems 7, 2008).
    fn polish(&mut self, pair: &Pair<'_>, toward: DVec3, length: f64) -> bool {
        let (mut features, mut nearest) = (self.simplex, length);
        for _ in 0..POLISH_ROUNDS {
            let vertex = self.raise_lower(pair, feature_normal(&features, toward), 1.0);
            if features.contains(&vertex) || nearest - self.lower <= 2.0 * PAIR_ROUNDING {
                break;
            }
            features = features.grown_or_swapped(&vertex);
            // Features of slivers may be given up for others that lie farther off.
            let next = features.nearest();
            let next_length = next.point().norm();
            if next_length < nearest {
                (self.simplex, nearest) = (next, next_length);
            }
        }
        nearest < length
    }

    /// The same by the normals that straight features have exactly, where that left more than rounding: beside round cores. Their
    /// planes touch whole edges and faces, so every corner that is held there is tried with what they touch on the other side.
    #[inline(never)]
    fn straighten(&mut self, pair: &Pair<'_>, toward: DVec3, length: f64) -> bool {
        if length - self.lower <= DEPTH_WIDTH {
            return false;
        }
        for normal in straight::normals(pair, toward) {
            let vertex = self.raise_lower(pair, normal, 1.0);
            self.simplex.cross(&vertex);
        }
        self.simplex.point().norm() < length
    }

    /// The same by leaning, where that left more than rounding: where the nearest point lies at the tip of a needle, which no plane of its
    /// faces is across. What a support vertex lies before the nearest point's plane the normal is leaned towards that vertex, by no
    /// more than it takes; a little lean costs a square of a little.
    ///
    /// Relaxation: Agmon, "The Relaxation Method for Linear Inequalities" (1954).
    #[inline(never)]
    fn lean(&mut self, pair: &Pair<'_>, toward: DVec3, length: f64) {
        let mut normal = toward;
        for _ in 0..LEAN_ROUNDS {
            if length - self.lower <= DEPTH_WIDTH {
                break;
            }
            let vertex = self.raise_lower(pair, normal, 1.0).point;
            let missing = length - normal.dot(vertex);
            let leaned = normal + vertex * (missing / vertex.length_squared());
            match leaned.try_unit() {
                Some(leaned) => normal = leaned,
                None => break,
            }
        }
    }

    /// Goes on where a depth turned out to be a gap and this search had lost its way, among slivers that may hold the origin: from
    /// the normal that parts the cores. Says whether there was more to find.
    pub(super) fn go_on(&mut self, pair: &Pair<'_>, touch: &Touch, budget: u32) -> bool {
        let apart = pair.radius() - touch.upper;
        if apart <= 0.0 || self.upper - apart <= DEPTH_WIDTH {
            return false;
        }
        let vertex = self.raise_lower(pair, touch.normal, 1.0);
        self.simplex.cross(&vertex);
        let stop = self.run(pair, budget, |_, _| false);
        self.end(stop);
        self.lower > 0.0
    }

    #[inline(always)]
    fn end(&mut self, stop: Stop) {
        self.inside = self.simplex.margin().unwrap_or(0.0);
        if self.inside == 0.0 {
            self.simplex.flatten();
        }
        self.length = if self.inside > 0.0 { 0.0 } else { self.simplex.point().norm() };
        self.upper = self.length + PAIR_ROUNDING;
        self.stop = stop;
    }
}

/// The normal of the features that support a point of the difference, on the side of `toward`.
fn feature_normal(features: &Simplex, toward: DVec3) -> DVec3 {
    let across = match features.vertices() {
        [a, b] => {
            let along = (b.point - a.point).try_unit().unwrap_or_default();
            let once = toward - along * along.dot(toward);
            once - along * along.dot(once)
        }
        [a, b, c] => {
            // Of slivers no digit may be lost.
            let normal = exact::cross(b.point - a.point, c.point - a.point);
            normal * normal.dot(toward).signum()
        }
        _ => toward,
    };
    across.try_unit().unwrap_or(toward)
}
