//! Which of many points lies farthest along a direction, by looking at all of them.
//!
//! # Method
//! Points are kept four at a time as columns, so that two of them fill a register of plain x86-64. A first pass takes
//! only the greatest height of each of eight lanes, a second seeks the first point that has it: carrying indices along
//! with heights costs more than computing some heights twice.
//!
//! ```text
//! block 0: x0 x1 x2 x3 | y0 y1 y2 y3 | z0 z1 z2 z3      block 1: x4 ...      last block: filled up with point 0
//! ```
//!
//! Measured against a plain loop over points, random directions, nanoseconds (instructions): 8 points 6.1 for 6.2 where
//! the plain loop's branches are foreseen and for 12 where not, 32 points 14 for 19 to 29 (406 for 450), 64 points 25 for
//! 41 to 54, 1,000 points 430 for 690 (10,200 for 13,000).
//!
//! # Limits
//! The winner is that of the plain loop to the last bit: heights are `x·dx + y·dy + z·dz` summed in this order, and of
//! equal ones the first counts.

use glam::DVec3;

/// Points of a column block.
const LANES: usize = 4;

/// Four points by columns.
type Block = [[f64; LANES]; 3];

/// Points, by columns.
#[derive(Debug)]
pub(super) struct Columns {
    blocks: Vec<Block>,
}

impl Columns {
    /// The columns of `points`, at least one.
    pub(super) fn new(points: &[DVec3]) -> Self {
        let block = |four: &[DVec3]| {
            let lanes: [DVec3; LANES] = std::array::from_fn(|lane| four.get(lane).copied().unwrap_or(points[0]));
            [lanes.map(|point| point.x), lanes.map(|point| point.y), lanes.map(|point| point.z)]
        };
        Self { blocks: points.chunks(LANES).map(block).collect() }
    }

    /// The index of the point of greatest `point · direction`; of equal ones the first. 0 if no height is a number.
    #[inline]
    pub(super) fn farthest(&self, direction: DVec3) -> u32 {
        first_of_height(&self.blocks, direction, greatest(&self.blocks, direction))
    }

    /// Bytes it holds beside itself.
    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice())
    }
}

#[inline(always)]
fn heights(block: &Block, direction: DVec3) -> [f64; LANES] {
    let [xs, ys, zs] = block;
    std::array::from_fn(|lane| xs[lane] * direction.x + ys[lane] * direction.y + zs[lane] * direction.z)
}

/// The greater of each lane; a NaN in `b` is passed over.
#[inline(always)]
fn greater(a: [f64; LANES], b: [f64; LANES]) -> [f64; LANES] {
    std::array::from_fn(|lane| if b[lane] > a[lane] { b[lane] } else { a[lane] })
}

/// The greatest height, −∞ if none is a number.
#[inline(always)]
fn greatest(blocks: &[Block], direction: DVec3) -> f64 {
    let (mut even, mut odd) = ([f64::NEG_INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    let mut pairs = blocks.chunks_exact(2);
    for pair in pairs.by_ref() {
        even = greater(even, heights(&pair[0], direction));
        odd = greater(odd, heights(&pair[1], direction));
    }
    for block in pairs.remainder() {
        even = greater(even, heights(block, direction));
    }
    // Lane by lane: as one more step of whole lanes this became branches.
    let greater = |a: f64, b: f64| if b > a { b } else { a };
    let greatest = |[a, b, c, d]: [f64; LANES]| greater(greater(a, b), greater(c, d));
    greater(greatest(even), greatest(odd))
}

/// The first point that has this height; 0 for −∞, which is where no height is a number.
#[inline(always)]
fn first_of_height(blocks: &[Block], direction: DVec3, height: f64) -> u32 {
    if height == f64::NEG_INFINITY {
        return 0;
    }
    for (number, block) in (0..).zip(blocks) {
        let [a, b, c, d] = heights(block, direction).map(|found| u32::from(found == height));
        let lanes = a | b << 1 | c << 2 | d << 3;
        if lanes != 0 {
            return number * LANES as u32 + lanes.trailing_zeros();
        }
    }
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(points: &[DVec3], direction: DVec3) -> u32 {
        let mut best = (0, f64::NEG_INFINITY);
        for (index, point) in (0..).zip(points) {
            let height = point.dot(direction);
            if height > best.1 {
                best = (index, height);
            }
        }
        best.0
    }

    #[test]
    fn the_winner_is_that_of_a_plain_loop() {
        let mut state = 1_u64;
        // Few values, so that many heights are equal.
        let mut number = |spread: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % spread) as f64 - (spread / 2) as f64
        };
        let mut tied = 0;
        for count in (1..70).chain([127, 128, 129, 1000]) {
            for spread in [3, 1000, 1 << 30] {
                let mut point = || DVec3::new(number(spread), number(spread), number(spread));
                let points: Vec<DVec3> = (0..count).map(|_| point()).collect();
                let columns = Columns::new(&points);
                for _ in 0..20 {
                    let direction = point();
                    let found = columns.farthest(direction);
                    assert_eq!(found, plain(&points, direction), "{points:?} along {direction}");
                    let height = points[found as usize].dot(direction);
                    tied += usize::from(points.iter().filter(|point| point.dot(direction) == height).count() > 1);
                }
            }
        }
        assert!(tied > 1000, "equal heights must occur: {tied}");
    }

    #[test]
    fn heights_that_are_no_numbers_lose() {
        let points = [DVec3::ONE, DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::Z];
        for direction in [DVec3::NAN, DVec3::new(f64::INFINITY, 1.0, 0.0), DVec3::NEG_INFINITY] {
            assert_eq!(Columns::new(&points).farthest(direction), plain(&points, direction), "{direction}");
        }
    }
}
