//! The corner of a large hull farthest along a direction, by walking uphill from corner to corner.
//!
//! # Method
//! From a start the walk goes to the highest neighbour as long as there is a higher one. In exact arithmetic a corner
//! with no higher neighbour is a highest one. With rounded heights that is false, and not by a few roundings: where a
//! face's outline bends by an angle of 1e-8, a direction tilted by 1e-8 makes both neighbours of the bend equal to it to
//! the last bit while the far side of the face is 1e-8 higher.
//!
//! ```text
//!            v          d leans by 1e-8 away from v: its neighbours are lower by 5e-17, the far side is
//!     w1 ---- ---- w2   higher by 1e-8
//!     |            |
//!     |            |
//!     +------------+
//! ```
//!
//! So where a neighbour is not lower for certain, the sign of `(w − v) · d` is found exactly, and of corners exactly
//! equal the one of least index is taken. What is returned is therefore a highest corner of the very numbers, whatever
//! the start was; its rounded height lies within [`PAIR_ROUNDING`](crate::tolerance::PAIR_ROUNDING) of the greatest one
//! as that of a search of all points does.
//!
//! Starts come from a table: the highest corner along each of 26 directions, those to the faces, edges and corners of a
//! cube.
//!
//! Measured on points of a sphere, random directions, in nanoseconds; a walk begins at the table, or, warm, at the last
//! corner found while the direction turns by about 0.1:
//!
//! | vertices | all points | from the table | warm |
//! |---|---|---|---|
//! | 32 | 14 | 31 | 17 |
//! | 64 | 25 | 34 | 19 |
//! | 96 | 37 | 38 | 21 |
//! | 128 | 46 | 39 | 22 |
//! | 1,024 | 470 | 61 | 34 |
//!
//! # Source
//! Gilbert, Johnson, Keerthi (1988), support by adjacency; Dobkin, Kirkpatrick, "Determining the separation of
//! preprocessed polyhedra" (1990), for why a local maximum is a global one. The exact end is ours.
//!
//! # Limits
//! Where a coordinate is so small that exact sums would leave the range of f64 (see
//! [`EXACT_PART_MIN`](crate::tolerance::EXACT_PART_MIN)) and the doubt remains, all points are looked at instead.

use std::cmp::Ordering;

use glam::DVec3;

use super::topology::{Topology, index_u32};
use crate::{math::expansion::ExactVector, tolerance::CLIMB_DOUBT};

/// For each corner of a hull those that an edge joins it with, and where to start.
#[derive(Debug)]
pub(super) struct Slopes {
    /// The neighbours of corner `i` are `neighbors[first[i]..first[i + 1]]`; points that are no corners have none.
    first: Vec<u32>,
    neighbors: Vec<u32>,
    /// By [`start_slot`].
    starts: [u32; 27],
}

impl Slopes {
    pub(super) fn new(points: &[DVec3], topology: &Topology) -> Self {
        let ends = || topology.edges.iter().flat_map(|edge| [(edge.start, edge.end), (edge.end, edge.start)]);
        let mut first = vec![0_u32; points.len() + 1];
        for (corner, _) in ends() {
            first[corner as usize + 1] += 1;
        }
        for index in 0..points.len() {
            first[index + 1] += first[index];
        }
        let mut next = first.clone();
        let mut neighbors = vec![0_u32; 2 * topology.edges.len()];
        for (corner, neighbor) in ends() {
            neighbors[next[corner as usize] as usize] = neighbor;
            next[corner as usize] += 1;
        }
        let mut slopes = Self { first, neighbors, starts: [0; 27] };
        slopes.starts = std::array::from_fn(|slot| slopes.highest_corner(points, slot_direction(slot)));
        slopes
    }

    /// A corner of which no other one lies far along `direction`: where a walk should begin.
    pub(super) fn start(&self, direction: DVec3) -> u32 {
        self.starts[start_slot(direction)]
    }

    /// A highest corner along `direction`, of exactly equal ones that of least index; none if that stays in doubt.
    pub(super) fn climb(&self, points: &[DVec3], reach: f64, direction: DVec3, start: u32) -> Option<u32> {
        let mut at = if self.around(start).is_empty() { self.start(direction) } else { start };
        let mut height = points[at as usize].dot(direction);
        let next = loop {
            let mut best = (at, f64::NEG_INFINITY);
            for &neighbor in self.around(at) {
                let found = points[neighbor as usize].dot(direction);
                if found > best.1 {
                    best = (neighbor, found);
                }
            }
            if best.1 > height {
                (at, height) = best;
            } else {
                break best.1;
            }
        };
        // Not of what is subnormal, where the rounding is no part of the height.
        let doubt = CLIMB_DOUBT * reach * (direction.x.abs() + direction.y.abs() + direction.z.abs());
        let is_certain = next < height - (doubt + f64::MIN_POSITIVE);
        if is_certain || self.around(at).is_empty() { Some(at) } else { self.settle(points, direction, at) }
    }

    /// Walks on by exact signs.
    fn settle(&self, points: &[DVec3], direction: DVec3, start: u32) -> Option<u32> {
        let mut at = start;
        'uphill: loop {
            for &neighbor in self.around(at) {
                if compare(points, direction, neighbor, at)? == Ordering::Greater {
                    at = neighbor;
                    continue 'uphill;
                }
            }
            break;
        }
        self.least_of_plateau(points, direction, at)
    }

    /// The least index of the corners exactly as high as a highest one: they are a corner, a chain of edges or the
    /// outline of a face.
    fn least_of_plateau(&self, points: &[DVec3], direction: DVec3, top: u32) -> Option<u32> {
        let mut least = top;
        for &side in self.around(top) {
            let mut ahead = (compare(points, direction, side, top)? == Ordering::Equal).then_some(side);
            let mut behind = top;
            // Each step leads to another corner of the outline, until the outline ends or is closed.
            for _ in 0..points.len() {
                let Some(at) = ahead.take().filter(|&at| at != top) else { break };
                least = least.min(at);
                for &beyond in self.around(at).iter().filter(|&&beyond| beyond != behind) {
                    if compare(points, direction, beyond, at)? == Ordering::Equal {
                        ahead = Some(beyond);
                        break;
                    }
                }
                behind = at;
            }
        }
        Some(least)
    }

    fn around(&self, corner: u32) -> &[u32] {
        let corner = corner as usize;
        &self.neighbors[self.first[corner] as usize..self.first[corner + 1] as usize]
    }

    fn highest_corner(&self, points: &[DVec3], direction: DVec3) -> u32 {
        let mut best = (0, f64::NEG_INFINITY);
        for (index, point) in points.iter().enumerate() {
            let corner = index_u32(index);
            let height = point.dot(direction);
            if height > best.1 && !self.around(corner).is_empty() {
                best = (corner, height);
            }
        }
        best.0
    }

    /// Bytes it holds beside itself.
    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(self.first.as_slice()) + size_of_val(self.neighbors.as_slice())
    }
}

/// Whether `w` is higher than `v`, exactly; none if that cannot be told.
fn compare(points: &[DVec3], direction: DVec3, w: u32, v: u32) -> Option<Ordering> {
    let (to, from) = (points[w as usize], points[v as usize]);
    let parts = (to - from) * direction;
    let sum = parts.x + parts.y + parts.z;
    let size = parts.x.abs() + parts.y.abs() + parts.z.abs();
    // Three roundings of each part and two of the sum; what is subnormal may hide more.
    if sum.abs() > CLIMB_DOUBT * size + f64::MIN_POSITIVE {
        return sum.partial_cmp(&0.0);
    }
    let exact = ExactVector::difference(to, from);
    let along = ExactVector::difference(direction, DVec3::ZERO);
    (exact.is_in_range() && along.is_in_range()).then(|| exact.dot(&along).sign())
}

/// Which of the cells of a cube's surface a direction meets: each component counts as −1, 0 or 1, as it is compared
/// with half the largest.
fn start_slot(direction: DVec3) -> usize {
    let half = 0.5 * direction.abs().max_element();
    let third = |value: f64| 1 + usize::from(value > half) - usize::from(value < -half);
    third(direction.x) + 3 * third(direction.y) + 9 * third(direction.z)
}

fn slot_direction(slot: usize) -> DVec3 {
    let third = |power: usize| (slot / power % 3) as f64 - 1.0;
    DVec3::new(third(1), third(3), third(9))
}
