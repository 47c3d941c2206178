//! The skin of a height field: triangles of the surface, the walls and the floor, none of them stored.
//!
//! # Method
//! A leaf is sixteen times its cell and the number of the triangle there: 0 and 1 are the surface, 2 and 3 the floor, 4 to 11
//! the walls towards −x, +x, −z and +z, where the next cell is not filled. All corners go counter-clockwise seen from outside.

use glam::DVec3;

use super::HeightField;

/// Numbers of leaves in a cell; the last four name none.
const LEAVES: usize = 16;
/// The next cell beyond each wall: along x, along z.
const BEYOND: [(isize, isize); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];

impl HeightField {
    /// The cell of a leaf.
    pub(crate) fn cell_of(leaf: usize) -> usize {
        leaf / LEAVES
    }

    /// The corners of a leaf.
    pub(crate) fn corners(&self, leaf: usize) -> [DVec3; 3] {
        let (column, row) = self.place_of(leaf / LEAVES);
        self.triangle(leaf % LEAVES, self.cell_corners(column, row))
    }

    /// A triangle of a cell whose corners are known.
    fn triangle(&self, number: usize, [a, b, c, d]: [DVec3; 4]) -> [DVec3; 3] {
        let down = |corner: DVec3| DVec3::new(corner.x, self.floor, corner.z);
        let wall = |from: DVec3, to: DVec3| match number % 2 {
            0 => [from, down(from), down(to)],
            _ => [from, down(to), to],
        };
        match number {
            0 => [a, c, d],
            1 => [a, d, b],
            2 => [down(a), down(d), down(c)],
            3 => [down(a), down(b), down(d)],
            4 | 5 => wall(a, c),
            6 | 7 => wall(d, b),
            8 | 9 => wall(b, a),
            _ => wall(c, d),
        }
    }

    /// The leaf of the surface beyond a side of a leaf of the surface; `None` if there is a wall, or if it is none of those.
    pub(crate) fn across(&self, leaf: usize, side: usize) -> Option<usize> {
        let (column, row) = self.place_of(leaf / LEAVES);
        let leaf_at = |x: isize, z: isize, number: usize| {
            let (column, row) = (column.checked_add_signed(x)?, row.checked_add_signed(z)?);
            let is_filled = self.is_filled(column as isize, row as isize);
            is_filled.then(|| (row * (self.columns - 1) + column) * LEAVES + number)
        };
        match (leaf % LEAVES, side) {
            (0, 0) => leaf_at(-1, 0, 1),
            (0, 1) => leaf_at(0, 1, 1),
            (0, _) => leaf_at(0, 0, 1),
            (1, 0) => leaf_at(0, 0, 0),
            (1, 1) => leaf_at(1, 0, 0),
            (1, _) => leaf_at(0, -1, 0),
            _ => None,
        }
    }

    /// Calls `visit` with each leaf of a cell that is there, and its corners.
    pub(super) fn each_leaf(&self, (column, row): (usize, usize), mut visit: impl FnMut(u32, [DVec3; 3])) {
        if !self.is_filled(column as isize, row as isize) {
            return;
        }
        let first = (row * (self.columns - 1) + column) * LEAVES;
        let corners = self.cell_corners(column, row);
        let mut leaf = |number: usize| visit((first + number) as u32, self.triangle(number, corners));
        (0..4).for_each(&mut leaf);
        for (wall, (x, z)) in BEYOND.into_iter().enumerate() {
            if !self.is_filled(column as isize + x, row as isize + z) {
                leaf(4 + 2 * wall);
                leaf(5 + 2 * wall);
            }
        }
    }

    /// Calls `visit` with the cell and the corners of each triangle of the skin, in order of leaves.
    pub(crate) fn each_triangle(&self, mut visit: impl FnMut(usize, [DVec3; 3])) {
        for row in 0..self.rows - 1 {
            for column in 0..self.columns - 1 {
                self.each_leaf((column, row), |leaf, corners| visit(Self::cell_of(leaf as usize), corners));
            }
        }
    }

    /// Whether a wall of a cell is there.
    pub(super) fn has_wall(&self, column: usize, row: usize) -> bool {
        BEYOND.iter().any(|(x, z)| !self.is_filled(column as isize + x, row as isize + z))
    }

    /// Those of least x and z, greatest x, greatest z, and both.
    pub(super) fn cell_corners(&self, column: usize, row: usize) -> [DVec3; 4] {
        [
            self.sample(column, row),
            self.sample(column + 1, row),
            self.sample(column, row + 1),
            self.sample(column + 1, row + 1),
        ]
    }

    /// Column and row of a cell.
    fn place_of(&self, cell: usize) -> (usize, usize) {
        (cell % (self.columns - 1), cell / (self.columns - 1))
    }
}
