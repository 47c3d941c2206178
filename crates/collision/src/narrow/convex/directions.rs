//! The depth of two cores that overlap, by a search over all directions.
//!
//! # Method
//! The depth is the least width over all unit vectors `n`, the width being the support function of the Minkowski difference.
//! Directions are told by the angles about an axis, so a cell of them is a rectangle, and cells that are halved leave no
//! direction out. Any point `p` of the difference has `p · n` no greater than the width along `n`, and the least of `p · n` over
//! a cell is a matter of two angles, one after the other:
//!
//! ```text
//!   p · n = (p's part across the axis · u(azimuth)) cos(elevation) + (p's part along it) sin(elevation)
//! ```
//!
//! since for a fixed elevation only the least of the first factor counts, and either factor is a stretch of a sine.
//! So a cell is bounded below by the support point along its middle, the whole is bounded by its lowest cell, and that is halved,
//! along the side in which more was lost, until it is as high as the least width that was met.
//!
//! Three things make the bound of a cell better than that of one point. A point between the one that bounded the whole cell
//! and the one met in its half is as good as any, so the best of them is taken. Where a form is round about the axis, the whole
//! circle that a point goes round on lies in it, and with the circle's radius `r` instead, `(r + p · u) cos + p sin` bounds the
//! width for every azimuth: one cell holds what would take a polytope millions of triangles, a circle of directions that are
//! equally short ways out. And an ellipsoid has each point `q` of its surface on a ball inside it, of the radius
//! `r₀² |q/r²|` about `q − r₀² q/r²` (`r₀` the least half axis, the quotients by components), whose width is its middle's and
//! its radius, whatever the direction.
//!
//! # Source
//! Ours: branch and bound (Land, Doig, "An automatic method of solving discrete programming problems", 1960) over the support
//! function. The balls follow from the nearest point of an ellipsoid as in [`super::ellipsoid`], at `s = 0`.
//!
//! # Limits
//! Valleys of the width that lie aslant to the angles take many cells, so a second axis is tried; some hundred cells are
//! enough mostly. Slower than an expanding polytope where that ends well, so it is asked only where it does not. A difference
//! without volume has no depth that could be proved.

use std::{cmp::Ordering, collections::BinaryHeap};

use glam::{DVec2, DVec3};

use super::{body::Body, frame::Pair, gjk, simplex::Vertex};
use crate::{
    answer::Stop,
    math::Norm,
    shape::Core,
    tolerance::{PAIR_ROUNDING, PARALLEL_LEAN},
};

/// Thirds cut off while the best orbit between two is sought.
const MIXING_STEPS: usize = 40;

/// What is known of the depth of two cores, in the pair's frame.
pub(super) struct Found {
    /// The width along `normal`.
    pub(super) best: f64,
    /// The depth is not below this; negative infinity where nothing is proved.
    pub(super) lower: f64,
    /// Unit vector from `b` to `a`; 0 if no width below the one that was known was met.
    pub(super) normal: DVec3,
    pub(super) iterations: u32,
    pub(super) stop: Stop,
}

/// Narrows the depth of two cores, which is known to be no more than `width`, until `is_enough(lower, best)` or the budget is
/// spent: half of it about the axis of the larger core, the rest about that of the other.
pub(super) fn depth(pair: &Pair<'_>, width: f64, budget: u32, is_enough: impl Fn(f64, f64) -> bool) -> Found {
    let mut search = Search { pair, poles: Poles::about(pair, DVec3::Y), best: width, found: None, iterations: 0 };
    let mut lower = f64::NEG_INFINITY;
    let mut stop = Stop::Budget;
    for (axis, budget) in axes(pair).into_iter().zip([budget / 2, budget]) {
        search.poles = Poles::about(pair, axis);
        let (low, ended) = search.run(budget, |low, best| is_enough(lower.max(proved(low)), best));
        (lower, stop) = (lower.max(proved(low)), ended);
        if stop != Stop::Budget {
            break;
        }
    }
    let normal = search.found.map_or(DVec3::ZERO, |outward| DVec3::ZERO - outward);
    Found { best: search.best, lower, normal, iterations: search.iterations, stop }
}

/// The depth that is proved by cells no lower than `low`: a support point is right to one error, the ball that it is on to as
/// much again, and the products of axes, angles and points, all below 2, to a third.
fn proved(low: f64) -> f64 {
    if low > 3.0 * PAIR_ROUNDING { low - 3.0 * PAIR_ROUNDING } else { f64::NEG_INFINITY }
}

/// The axis that elevations are counted from, and what is round about it.
struct Poles {
    axis: DVec3,
    /// Unit vectors across it and each other.
    across: [DVec3; 2],
    is_round: [bool; 2],
}

impl Poles {
    fn about(pair: &Pair<'_>, axis: DVec3) -> Self {
        let (u, v) = axis.any_orthonormal_pair();
        let is_round = [&pair.a, &pair.b].map(|body| {
            lone_axis(body).is_some_and(|(own, roundness)| {
                roundness == Roundness::Whole && own.cross(axis).norm() <= PARALLEL_LEAN
            })
        });
        Self { axis, across: [u, v], is_round }
    }

    fn across(&self, point: DVec3) -> DVec2 {
        DVec2::new(self.across[0].dot(point), self.across[1].dot(point))
    }

    fn direction(&self, azimuth: DVec2, elevation: DVec2) -> DVec3 {
        (self.across[0] * azimuth.x + self.across[1] * azimuth.y) * elevation.x + self.axis * elevation.y
    }

    /// What of the two cores is surely there about a vertex: balls that its points are on, and circles that those go round on.
    fn orbit(&self, pair: &Pair<'_>, vertex: &Vertex) -> Orbit {
        let mut orbit = Orbit { ball: 0.0, radius: 0.0, across: DVec2::ZERO, along: 0.0 };
        let sides = [(&pair.a, vertex.on_a, 1.0), (&pair.b, vertex.on_a - vertex.point, -1.0)];
        for ((body, point, sign), is_round) in sides.into_iter().zip(self.is_round) {
            let (middle, ball) = ball_inside(body, point - body.position);
            let around = self.across(middle);
            orbit.ball += ball;
            orbit.across += self.across(body.position) * sign;
            orbit.along += self.axis.dot(body.position + middle) * sign;
            if is_round {
                orbit.radius += around.norm();
            } else {
                orbit.across += around * sign;
            }
        }
        orbit
    }
}

/// The middle and the radius of the greatest ball in a core that has a point of its surface, seen from its own origin, on its
/// own; of what is no ellipsoid the point itself.
fn ball_inside(body: &Body<'_>, point: DVec3) -> (DVec3, f64) {
    let Core::Ellipsoid { radii } = body.core else { return (point, 0.0) };
    let radii = *radii * body.scale;
    let least = radii.min_element();
    let shares = (DVec3::splat(least) / radii) * (DVec3::splat(least) / radii);
    let inwards = body.to_local(point) * shares;
    (point - body.turn(inwards), inwards.norm())
}

/// The axes to count elevations from: that of a round core first, of two that of the larger, whose circles reach farther.
fn axes(pair: &Pair<'_>) -> [DVec3; 2] {
    let axis = |body: &Body<'_>| lone_axis(body).map_or(DVec3::Y, |(axis, _)| axis);
    let rank = |body: &Body<'_>| {
        let is_whole = lone_axis(body).is_some_and(|(_, roundness)| roundness == Roundness::Whole);
        (is_whole, !body.core.is_polytope(), body.core.reach())
    };
    let [first, second] = if rank(&pair.a) >= rank(&pair.b) { [&pair.a, &pair.b] } else { [&pair.b, &pair.a] };
    let [first, second] = [first, second].map(axis);
    let is_one = second.cross(first).norm() <= PARALLEL_LEAN;
    [first, if is_one { first.any_orthonormal_vector() } else { second }]
}

/// Whether a core goes over into itself however it is turned about its axis.
#[derive(Clone, Copy, PartialEq)]
enum Roundness {
    Whole,
    Nearly,
}

/// The axis about which a core is round, or most nearly so: an ellipsoid's axis across the two radii that differ least, a
/// polytope's way to its farthest corner.
fn lone_axis(body: &Body<'_>) -> Option<(DVec3, Roundness)> {
    let of = |axis: DVec3, roundness| Some((body.turn(axis), roundness));
    match body.core {
        Core::Point | Core::Segment { .. } | Core::Cylinder { .. } | Core::Cone { .. } => {
            of(DVec3::Y, Roundness::Whole)
        }
        Core::Ellipsoid { radii } => {
            let off = (DVec3::new(radii.y - radii.z, radii.z - radii.x, radii.x - radii.y)).abs();
            let least = off.min_element();
            let axis = if off.y == least {
                DVec3::Y
            } else if off.x == least {
                DVec3::X
            } else {
                DVec3::Z
            };
            of(axis, if least == 0.0 { Roundness::Whole } else { Roundness::Nearly })
        }
        Core::Cuboid { .. } | Core::Hull(_) | Core::Triangle(_) => {
            let center = body.center();
            let ways = (0..body.corner_count().unwrap_or(0) as u32).map(|corner| body.corner(corner).point - center);
            let longest = ways.max_by(|v, w| v.length_squared().total_cmp(&w.length_squared()));
            Some((longest?.try_unit()?, Roundness::Nearly))
        }
    }
}

/// A point of the difference less what goes round, with the radius that it goes round on and that of a ball about it.
#[derive(Clone, Copy)]
struct Orbit {
    ball: f64,
    radius: f64,
    across: DVec2,
    along: f64,
}

impl Orbit {
    /// What lies between two, for a share of the second from 0 to 1.
    fn mixed(&self, other: &Self, share: f64) -> Self {
        Self {
            ball: self.ball + (other.ball - self.ball) * share,
            radius: self.radius + (other.radius - self.radius) * share,
            across: self.across + (other.across - self.across) * share,
            along: self.along + (other.along - self.along) * share,
        }
    }
}

/// A rectangle of directions: unit vectors of the least and greatest azimuth, and (cosine, sine) of the elevations.
#[derive(Clone, Copy)]
struct Sides {
    azimuth: [DVec2; 2],
    elevation: [DVec2; 2],
}

impl Sides {
    fn middle(&self) -> Option<[DVec2; 2]> {
        let middle = |[start, end]: [DVec2; 2]| (start + end).try_unit();
        Some([middle(self.azimuth)?, middle(self.elevation)?])
    }

    /// The least over all directions of what an orbit is high along them.
    fn low(&self, orbit: &Orbit) -> f64 {
        let across = orbit.radius + least(self.azimuth, orbit.across);
        orbit.ball + least(self.elevation, DVec2::new(across, orbit.along))
    }

    /// Of the orbits between two the one with the greatest low, all but.
    fn highest_between(&self, first: &Orbit, second: &Orbit) -> Orbit {
        let (mut start, mut end) = (0.0, 1.0);
        for _ in 0..MIXING_STEPS {
            let third = (end - start) / 3.0;
            let [p, q] = [start + third, end - third];
            if self.low(&first.mixed(second, p)) < self.low(&first.mixed(second, q)) { start = p } else { end = q }
        }
        let between = first.mixed(second, 0.5 * start + 0.5 * end);
        [first, second]
            .into_iter()
            .fold(between, |best, &end| if self.low(&end) > self.low(&best) { end } else { best })
    }
}

/// The least product of a vector and the unit vectors from one to another, less than half a turn on.
fn least([start, end]: [DVec2; 2], vector: DVec2) -> f64 {
    let against = -vector;
    let is_between = start.perp_dot(against) >= 0.0 && against.perp_dot(end) >= 0.0;
    if is_between { -vector.norm() } else { vector.dot(start).min(vector.dot(end)) }
}

/// What a cell is halved along.
#[derive(Clone, Copy)]
enum Halving {
    Azimuth,
    Elevation,
}

struct Cell {
    sides: Sides,
    /// What bounds it.
    orbit: Orbit,
    /// No width along one of its directions is below this, but for rounding.
    low: f64,
    halving: Halving,
}

impl Cell {
    /// `None` if its sides are too close together to have anything between them.
    fn halves(&self) -> Option<[Sides; 2]> {
        let [azimuth, elevation] = self.sides.middle()?;
        let (mut first, mut second) = (self.sides, self.sides);
        match self.halving {
            Halving::Azimuth => (first.azimuth[1], second.azimuth[0]) = (azimuth, azimuth),
            Halving::Elevation => (first.elevation[1], second.elevation[0]) = (elevation, elevation),
        }
        Some([first, second])
    }
}

/// The lowest cell is the greatest: what a heap gives first.
impl Ord for Cell {
    fn cmp(&self, other: &Self) -> Ordering {
        other.low.total_cmp(&self.low)
    }
}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cell {}

struct Search<'a> {
    pair: &'a Pair<'a>,
    poles: Poles,
    /// The least width so far.
    best: f64,
    /// Along which direction, outwards; `None` as long as it is the one known before.
    found: Option<DVec3>,
    iterations: u32,
}

impl Search<'_> {
    /// Halves the lowest cell until the least width is reached, `is_enough(low, best)`, or as many iterations are done. Returns
    /// what no width is below.
    fn run(&mut self, budget: u32, is_enough: impl Fn(f64, f64) -> bool) -> (f64, Stop) {
        let mut cells: BinaryHeap<Cell> = self.sphere().into();
        while let Some(lowest) = cells.pop() {
            if self.is_reached(lowest.low) {
                return (lowest.low, Stop::Converged);
            }
            if is_enough(lowest.low, self.best) {
                return (lowest.low, Stop::Tolerance);
            }
            let halves = if self.iterations < budget { lowest.halves() } else { None };
            let Some(halves) = halves else { return (lowest.low, Stop::Budget) };
            cells.extend(halves.map(|sides| self.cell(sides, Some(&lowest))));
        }
        (f64::NEG_INFINITY, Stop::Budget)
    }

    /// Whether a cell need not be halved any more.
    fn is_reached(&self, low: f64) -> bool {
        self.best - low <= 4.0 * PAIR_ROUNDING
    }

    /// All directions, in four quarters on each side of the equator.
    fn sphere(&mut self) -> Vec<Cell> {
        let quarters = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
        let heights = [[DVec2::NEG_Y, DVec2::X], [DVec2::X, DVec2::Y]];
        let sides = (0..8).map(|number: usize| Sides {
            azimuth: [quarters[number % 4], quarters[(number + 1) % 4]],
            elevation: heights[number / 4],
        });
        sides.map(|sides| self.cell(sides, None)).collect()
    }

    /// Bounds a cell, which is all or half of one.
    fn cell(&mut self, sides: Sides, whole: Option<&Cell>) -> Cell {
        self.iterations += 1;
        let [azimuth, elevation] = sides.middle().unwrap_or([sides.azimuth[0], sides.elevation[0]]);
        let outward = self.poles.direction(azimuth, elevation);
        let vertex = gjk::support(self.pair, DVec3::ZERO - outward);
        if let Some(unit) = outward.try_unit() {
            let width = unit.dot(vertex.point);
            if width < self.best {
                (self.best, self.found) = (width, Some(unit));
            }
        }
        let met = self.poles.orbit(self.pair, &vertex);
        let orbit = match whole {
            Some(whole) if !self.is_reached(sides.low(&met)) => sides.highest_between(&whole.orbit, &met),
            _ => met,
        };
        let low = sides.low(&orbit).max(whole.map_or(f64::NEG_INFINITY, |whole| whole.low));
        let Orbit { radius, across, along, .. } = met;
        let along_azimuth = DVec2::new(radius + least(sides.azimuth, across), along).dot(elevation);
        let along_elevation = least(sides.elevation, DVec2::new(radius + across.dot(azimuth), along));
        let halving = if along_azimuth < along_elevation { Halving::Azimuth } else { Halving::Elevation };
        Cell { sides, orbit, low, halving }
    }
}
