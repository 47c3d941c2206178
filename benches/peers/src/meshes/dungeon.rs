//! A level made of dice: rooms joined by corridors on two storeys, with walls, pillars and ramps.

use std::collections::HashMap;

use collision::DVec3;

use super::workload::Triangles;
use crate::{dice::Dice, forms::single};

/// Cells along each side.
const CELLS: usize = 40;
/// Width of a cell, metres.
const CELL: f64 = 2.0;
/// Height of a storey, metres.
const STOREY: f64 = 6.0;
/// Rows of quads in a wall.
const WALL_ROWS: usize = 2;
/// Rooms on each storey.
const ROOMS: usize = 34;
/// Pillars on each storey, and their corners.
const PILLARS: usize = 67;
const PILLAR_CORNERS: usize = 12;
/// How far a floor's vertex is off its grid at most, metres.
const ROUGHNESS: f64 = 0.08;

/// Which cells of a storey are hollow.
type Plan = Vec<[bool; CELLS]>;

/// The level; the same each time.
pub(super) fn dungeon() -> Triangles {
    let mut maker = Maker { dice: Dice::new(10_133), known: HashMap::new(), made: Triangles::default() };
    for storey in 0..2 {
        let plan = maker.plan();
        maker.storey(storey, &plan);
    }
    maker.ramps();
    maker.made
}

struct Maker {
    dice: Dice,
    /// Numbers of the vertices of the grid, which walls and floors share.
    known: HashMap<[usize; 3], u32>,
    made: Triangles,
}

impl Maker {
    fn plan(&mut self) -> Plan {
        let mut plan = vec![[false; CELLS]; CELLS];
        let mut doors = Vec::new();
        for _ in 0..ROOMS {
            let (wide, long) = (4 + self.dice.index(5), 4 + self.dice.index(5));
            let (x, z) = (1 + self.dice.index(CELLS - wide - 2), 1 + self.dice.index(CELLS - long - 2));
            plan[x..x + wide].iter_mut().for_each(|row| row[z..z + long].fill(true));
            doors.push((x + wide / 2, z + long / 2));
        }
        for pair in doors.windows(2) {
            let ((x, z), (to_x, to_z)) = (pair[0], pair[1]);
            plan[x.min(to_x)..=x.max(to_x)].iter_mut().for_each(|row| row[z] = true);
            plan[to_x][z.min(to_z)..=z.max(to_z)].fill(true);
        }
        plan
    }

    fn storey(&mut self, storey: usize, plan: &Plan) {
        let rows = storey * (WALL_ROWS + 1);
        let is_hollow = |x: usize, z: usize| plan.get(x).and_then(|row| row.get(z)).copied().unwrap_or(false);
        for x in 0..CELLS {
            for z in (0..CELLS).filter(|&z| is_hollow(x, z)) {
                self.quad([[x, rows, z], [x, rows, z + 1], [x + 1, rows, z + 1], [x + 1, rows, z]]);
                let walls = [
                    (is_hollow(x.wrapping_sub(1), z), [x, z + 1], [x, z]),
                    (is_hollow(x + 1, z), [x + 1, z], [x + 1, z + 1]),
                    (is_hollow(x, z.wrapping_sub(1)), [x, z], [x + 1, z]),
                    (is_hollow(x, z + 1), [x + 1, z + 1], [x, z + 1]),
                ];
                for (_, from, to) in walls.into_iter().filter(|(is_open, ..)| !is_open) {
                    for row in rows..rows + WALL_ROWS {
                        let at = |[x, z]: [usize; 2], row: usize| [x, row, z];
                        self.quad([at(from, row), at(from, row + 1), at(to, row + 1), at(to, row)]);
                    }
                }
            }
        }
        let base = STOREY * storey as f64;
        for _ in 0..PILLARS {
            let center =
                [self.dice.within(2.0, CELL * CELLS as f64 - 2.0), self.dice.within(2.0, CELL * CELLS as f64 - 2.0)];
            self.pillar(DVec3::new(center[0], base, center[1]));
        }
    }

    fn pillar(&mut self, foot: DVec3) {
        let radius = self.dice.within(0.3, 0.8);
        let first = self.made.vertices.len() as u32;
        for corner in 0..PILLAR_CORNERS {
            // Points of a circle by halving chords are not needed: a polygon on the diamond's sides is as good.
            let turn = 4.0 * corner as f64 / PILLAR_CORNERS as f64;
            let side = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
            let (at, part) = (turn as usize, turn.fract());
            let (from, to) = (side[at % 4], side[(at + 1) % 4]);
            let way = DVec3::new(from[0] + (to[0] - from[0]) * part, 0.0, from[1] + (to[1] - from[1]) * part);
            let outwards = way / way.length() * radius;
            self.made.vertices.push(single(foot + outwards));
            self.made.vertices.push(single(foot + outwards + DVec3::Y * (0.75 * STOREY)));
        }
        for corner in 0..PILLAR_CORNERS as u32 {
            let next = (corner + 1) % PILLAR_CORNERS as u32;
            let [low, high, next_low, next_high] =
                [2 * corner, 2 * corner + 1, 2 * next, 2 * next + 1].map(|at| first + at);
            self.made.indices.extend([[low, high, next_high], [low, next_high, next_low]]);
        }
    }

    /// Ways up from the lower storey.
    fn ramps(&mut self) {
        for _ in 0..6 {
            let foot = self.dice.point(0.5 * CELL * (CELLS - 12) as f64) + DVec3::splat(0.5 * CELL * CELLS as f64);
            let foot = DVec3::new(foot.x, 0.0, foot.z);
            let way = self.dice.direction();
            let way = DVec3::new(way.x, 0.0, way.z);
            let along = way / way.length();
            let across = DVec3::new(-along.z, 0.0, along.x) * 1.5;
            let steps = 24;
            let first = self.made.vertices.len() as u32;
            for step in 0..=steps {
                let share = f64::from(step) / f64::from(steps);
                let middle = foot + along * (10.0 * share) + DVec3::Y * (STOREY * share);
                self.made.vertices.extend([single(middle - across), single(middle + across)]);
            }
            for step in 0..steps {
                let at = first + 2 * step;
                self.made.indices.extend([[at, at + 1, at + 3], [at, at + 3, at + 2]]);
            }
        }
    }

    /// Two triangles between vertices of the grid.
    fn quad(&mut self, corners: [[usize; 3]; 4]) {
        let [a, b, c, d] = corners.map(|corner| self.vertex(corner));
        self.made.indices.extend([[a, b, c], [a, c, d]]);
    }

    fn vertex(&mut self, at: [usize; 3]) -> u32 {
        if let Some(&number) = self.known.get(&at) {
            return number;
        }
        let [x, row, z] = at;
        let (storey, row) = (row / (WALL_ROWS + 1), row % (WALL_ROWS + 1));
        let height = STOREY * storey as f64 + 0.75 * STOREY * row as f64 / WALL_ROWS as f64;
        let corner = DVec3::new(CELL * x as f64, height, CELL * z as f64) + self.dice.point(ROUGHNESS);
        let number = self.made.vertices.len() as u32;
        self.made.vertices.push(single(corner));
        self.known.insert(at, number);
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_is_the_same_each_time_and_about_as_large_as_the_one_that_the_goals_are_from() {
        let made = dungeon();
        assert_eq!(made, dungeon());
        let count = made.indices.len();
        assert!(count.abs_diff(10_133) < 200, "{count} triangles");
    }
}
