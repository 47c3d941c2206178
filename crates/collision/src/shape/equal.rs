//! Which of many points are the same.
//!
//! # Method
//! A table of the points seen so far, found by a hash of their bits and looked through from there. Whoever sends points whose
//! hashes are alike makes the way long: then a map whose hashes nobody can foresee is asked instead. Which it is changes the
//! time it takes and nothing else.

use std::collections::HashMap;

use glam::DVec3;

use super::topology::index_u32;

/// The longest way in the table. Points that nobody made alike on purpose are found on ways of a few; a shorter one would
/// now and then have the slow map asked for them, a longer one lets a sender of 12 million points cost more time.
const WAY_MAX: usize = 256;

/// Nothing is there.
const FREE: u32 = u32::MAX;

/// For each point the first one equal to it (−0 and +0 are equal), and how many were equal to an earlier one.
pub(super) fn first_equal(points: &[DVec3]) -> (Vec<u32>, usize) {
    let first = by_table(points, hash).unwrap_or_else(|| by_map(points));
    let merged = (0..).zip(&first).filter(|&(index, &first)| first != index).count();
    (first, merged)
}

fn bits(point: DVec3) -> [u64; 3] {
    (point + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// Coordinates that are small whole numbers have bits in their upper halves only, so each step folds these down.
fn hash(point: [u64; 3]) -> u64 {
    point.into_iter().fold(0, |mixed, bits| {
        let mixed = (mixed ^ bits).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        mixed ^ mixed >> 32
    })
}

/// `None` if a way became too long.
fn by_table(points: &[DVec3], hash: impl Fn([u64; 3]) -> u64) -> Option<Vec<u32>> {
    let size = (2 * points.len()).next_power_of_two();
    let mut table = vec![FREE; size];
    let mut first = Vec::with_capacity(points.len());
    for (index, &point) in points.iter().enumerate() {
        let own = bits(point);
        let begin = hash(own) as usize;
        let mut steps = (0..WAY_MAX).map(|step| (begin + step) & (size - 1));
        let at = steps.find(|&at| table[at] == FREE || bits(points[table[at] as usize]) == own)?;
        if table[at] == FREE {
            table[at] = index_u32(index);
        }
        first.push(table[at]);
    }
    Some(first)
}

fn by_map(points: &[DVec3]) -> Vec<u32> {
    let mut seen: HashMap<[u64; 3], u32> = HashMap::with_capacity(points.len());
    (0..).zip(points).map(|(index, &point)| *seen.entry(bits(point)).or_insert(index)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_and_map_find_the_same_and_a_table_whose_ways_are_long_gives_up() {
        let numbers = [0.0, -0.0, 1.0, 1.0f64.next_up(), -1.0, 1e300];
        let points: Vec<DVec3> = (0..600)
            .map(|index| DVec3::new(numbers[index % 6], numbers[index / 6 % 6], numbers[index / 36 % 5]))
            .collect();
        let (first, merged) = first_equal(&points);
        assert_eq!(first, by_map(&points));
        assert_eq!(Some(first), by_table(&points, hash));
        assert_eq!(merged, 600 - 5 * 5 * 4, "as many as differ");
        assert_eq!(by_table(&points, |_| 7).map(|first| first.len()), Some(600), "fewer than the longest way");
        let many: Vec<DVec3> = (0..600).map(|index| DVec3::X * f64::from(index)).collect();
        assert_eq!(by_table(&many, |_| 7), None);
        assert!(by_table(&many, hash).is_some());
    }
}
