//! Which of many points lies farthest along a direction, by looking at all of them.
//!
//! # Method
//! Points are kept eight at a time as columns, so that two of them fill a register of plain x86-64. Where there are more than
//! eight, a first pass finds the block with the greatest height. The block's heights are then kept until the greatest is
//! known, and the first point that has it is told from a mask: no branch depends on where the farthest point is, which a
//! processor could not foresee.
//!
//! ```text
//! block 0: x0..x3 | y0..y3 | z0..z3 | x4..x7 | y4..y7 | z4..z7      block 1: x8 ...      filled up with point 0
//! ```
//!
//! # Limits
//! The winner is that of the plain loop to the last bit: heights are `x·dx + y·dy + z·dz` summed in this order, and of
//! equal ones the first counts.

use glam::DVec3;

/// Points of a column.
const LANES: usize = 4;

/// Four points by columns.
#[derive(Clone, Copy, Debug)]
struct Four {
    xs: [f64; LANES],
    ys: [f64; LANES],
    zs: [f64; LANES],
}

/// Eight points.
type Block = [Four; 2];

/// Points of a block.
const BLOCK: usize = 2 * LANES;

/// Points, by columns.
#[derive(Debug)]
pub(super) struct Columns {
    blocks: Vec<Block>,
}

impl Columns {
    /// The columns of `points`, at least one.
    pub(super) fn new(points: &[DVec3]) -> Self {
        let four = |first: usize| {
            let lanes: [DVec3; LANES] =
                std::array::from_fn(|lane| points.get(first + lane).copied().unwrap_or(points[0]));
            Four { xs: lanes.map(|point| point.x), ys: lanes.map(|point| point.y), zs: lanes.map(|point| point.z) }
        };
        Self { blocks: (0..points.len()).step_by(BLOCK).map(|first| [four(first), four(first + LANES)]).collect() }
    }

    /// A point by its index.
    #[inline(always)]
    pub(super) fn point(&self, index: u32) -> DVec3 {
        let index = index as usize;
        let (four, lane) = (&self.blocks[index / BLOCK][index / LANES % 2], index % LANES);
        DVec3::new(four.xs[lane], four.ys[lane], four.zs[lane])
    }

    /// The index of the point of greatest `point · direction`; of equal ones the first. 0 if no height is a number.
    #[inline(always)]
    pub(super) fn farthest(&self, direction: DVec3) -> u32 {
        let number = if self.blocks.len() == 1 { 0 } else { highest_block(&self.blocks, direction) };
        (number * BLOCK) as u32 + farthest_of(&self.blocks[number], direction)
    }

    /// Bytes it holds beside itself.
    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice())
    }
}

/// Which block has the highest point; of equal ones the first. 0 if no height is a number.
#[inline(never)]
fn highest_block(blocks: &[Block], direction: DVec3) -> usize {
    let mut best = (0, f64::NEG_INFINITY);
    for (number, block) in blocks.iter().enumerate() {
        let height = greatest(&heights(block, direction));
        best = if height > best.1 { (number, height) } else { best };
    }
    best.0
}

/// The first of a block's points that is highest; 0 if no height is a number. All heights are kept until the greatest is
/// known, so that the way to its index has no branch that cannot be foreseen.
#[inline(always)]
fn farthest_of(block: &Block, direction: DVec3) -> u32 {
    let heights = heights(block, direction);
    let greatest = greatest(&heights);
    if greatest > f64::NEG_INFINITY {
        let mut found = 0;
        for (number, heights) in heights.iter().enumerate() {
            let [a, b, c, d] = heights.map(|height| u32::from(height == greatest));
            found |= (a | b << 1 | c << 2 | d << 3) << (LANES * number);
        }
        found.trailing_zeros()
    } else {
        0
    }
}

#[inline(always)]
fn heights(block: &Block, direction: DVec3) -> [[f64; LANES]; 2] {
    std::array::from_fn(|number| {
        let Four { xs, ys, zs } = &block[number];
        std::array::from_fn(|lane| xs[lane] * direction.x + ys[lane] * direction.y + zs[lane] * direction.z)
    })
}

/// The greatest height, −∞ if none is a number.
#[inline(always)]
fn greatest(heights: &[[f64; LANES]; 2]) -> f64 {
    let greater = |a: f64, b: f64| if b > a { b } else { a };
    let lanes = |a: [f64; LANES], b: [f64; LANES]| std::array::from_fn(|lane| greater(a[lane], b[lane]));
    let [a, b, c, d] = heights.iter().copied().fold([f64::NEG_INFINITY; LANES], lanes);
    greater(greater(a, b), greater(c, d))
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
