//! Closed meshes of cubes on a grid, of which volume and inside are known.
#![allow(dead_code, reason = "each test file uses its part of it")]

use collision::{DVec3, shape::Containment};

/// Pseudo-random numbers (xorshift64).
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn below(&mut self, bound: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) % bound
    }

    /// From 0 to 1.
    pub(crate) fn share(&mut self) -> f64 {
        self.below(1 << 40) as f64 / (1_u64 << 40) as f64
    }

    /// Each component from −1 to 1.
    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.share(), self.share(), self.share()) * 2.0 - 1.0
    }
}

pub(crate) const SIZE: i64 = 4;

/// Cubes of edge 1 on a grid, some of them filled.
pub(crate) struct Cubes(pub(crate) Vec<bool>);

impl Cubes {
    pub(crate) fn random(noise: &mut Noise) -> Self {
        Self((0..SIZE * SIZE * SIZE).map(|_| noise.below(2) == 0).collect())
    }

    pub(crate) fn is_filled(&self, cell: [i64; 3]) -> bool {
        cell.iter().all(|index| (0..SIZE).contains(index))
            && self.0[(cell[0] + SIZE * (cell[1] + SIZE * cell[2])) as usize]
    }

    pub(crate) fn volume(&self) -> usize {
        self.0.iter().filter(|&&is_filled| is_filled).count()
    }

    /// Its surface, two triangles for each side of a cube that is not another's.
    pub(crate) fn surface(&self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for index in 0..SIZE * SIZE * SIZE {
            let cell = [index % SIZE, index / SIZE % SIZE, index / SIZE / SIZE];
            for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
                let mut beyond = cell;
                beyond[axis] += 2 * side - 1;
                if !self.is_filled(cell) || self.is_filled(beyond) {
                    continue;
                }
                let first = vertices.len() as u32;
                for (u, v) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
                    let mut corner = cell.map(|index| index as f64);
                    corner[axis] += side as f64;
                    corner[(axis + 1) % 3] += f64::from(u);
                    corner[(axis + 2) % 3] += f64::from(v);
                    vertices.push(DVec3::from_array(corner));
                }
                let quad = if side == 1 { [0, 1, 2, 3] } else { [0, 3, 2, 1] }.map(|corner| first + corner);
                triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
            }
        }
        (vertices, triangles)
    }

    /// Where a point in quarters of a cube lies.
    pub(crate) fn side(&self, quarters: [i64; 3]) -> Containment {
        let below = |at: i64| {
            if at.rem_euclid(4) == 0 { vec![at.div_euclid(4) - 1, at.div_euclid(4)] } else { vec![at.div_euclid(4)] }
        };
        let mut filled = Vec::new();
        for &x in &below(quarters[0]) {
            for &y in &below(quarters[1]) {
                filled.extend(below(quarters[2]).iter().map(|&z| self.is_filled([x, y, z])));
            }
        }
        match (filled.contains(&true), filled.contains(&false)) {
            (true, true) => Containment::Undecided,
            (true, false) => Containment::Inside,
            (false, _) => Containment::Outside,
        }
    }
}
