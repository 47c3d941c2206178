//! A terrain in plain words: its samples, its holes, and all triangles of its skin, made here and not by the crate.

use collision::{
    DVec3,
    answer::Work,
    shape::{Containment, Form, Geometry, Terrain},
};

use crate::whole::Numbers;

/// A height field as it is sent.
pub(crate) struct Land {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    pub(crate) heights: Vec<f32>,
    pub(crate) spacing: DVec3,
    pub(crate) holes: Vec<u32>,
}

impl Land {
    /// Hills of about 2 metres to each side, a few holes in every second one.
    pub(crate) fn random(numbers: &mut Numbers) -> Self {
        let (columns, rows) = (2 + numbers.below(12) as usize, 2 + numbers.below(12) as usize);
        let spacing = DVec3::new(2.0 / columns as f64, 0.3 + 0.2 * numbers.share(), 2.0 / rows as f64);
        let heights = (0..columns * rows).map(|_| numbers.share() as f32).collect();
        let cells = (columns - 1) * (rows - 1);
        let count = if numbers.below(2) == 0 { 0 } else { cells / 6 };
        let holes = (0..count).map(|_| numbers.below(cells as i128) as u32).collect();
        Self { columns, rows, heights, spacing, holes }
    }

    pub(crate) fn field(&self) -> Geometry {
        let Self { columns, rows, ref heights, spacing, ref holes } = *self;
        Geometry::height_field(&Terrain { columns, rows, heights, spacing, holes }).expect("a terrain")
    }

    pub(crate) fn sample(&self, column: usize, row: usize) -> DVec3 {
        let height = f64::from(self.heights[row * self.columns + column]);
        DVec3::new(column as f64 * self.spacing.x, height * self.spacing.y, row as f64 * self.spacing.z)
    }

    /// As deep below the lowest sample as the longer side is long.
    pub(crate) fn floor(&self) -> f64 {
        let far = self.sample(self.columns - 1, self.rows - 1);
        let lowest =
            self.heights.iter().fold(f64::INFINITY, |low, &height| low.min(f64::from(height) * self.spacing.y));
        lowest - far.x.max(far.z)
    }

    fn is_filled(&self, column: i64, row: i64) -> bool {
        let (columns, rows) = (self.columns as i64 - 1, self.rows as i64 - 1);
        let is_cell = (0..columns).contains(&column) && (0..rows).contains(&row);
        is_cell && !self.holes.contains(&((row * columns + column) as u32))
    }

    /// The corners of all triangles of the skin, each with its cell; outwards they go counter-clockwise.
    pub(crate) fn skin(&self) -> Vec<(u32, [DVec3; 3])> {
        let mut skin = Vec::new();
        let floor = self.floor();
        let down = |corner: DVec3| DVec3::new(corner.x, floor, corner.z);
        for row in 0..self.rows - 1 {
            for column in 0..self.columns - 1 {
                let (x, z) = (column as i64, row as i64);
                if !self.is_filled(x, z) {
                    continue;
                }
                let (a, b) = (self.sample(column, row), self.sample(column + 1, row));
                let (c, d) = (self.sample(column, row + 1), self.sample(column + 1, row + 1));
                let mut of_cell = vec![[a, c, d], [a, d, b], [down(a), down(d), down(c)], [down(a), down(b), down(d)]];
                let walls = [(x - 1, z, a, c), (x + 1, z, d, b), (x, z - 1, b, a), (x, z + 1, c, d)];
                for (beside, beyond, from, to) in walls {
                    if !self.is_filled(beside, beyond) {
                        of_cell.extend([[from, down(from), down(to)], [from, down(to), to]]);
                    }
                }
                skin.extend(of_cell.into_iter().map(|corners| ((row * (self.columns - 1) + column) as u32, corners)));
            }
        }
        skin
    }

    /// The skin as a mesh: a surface, which has no inside.
    pub(crate) fn mesh(&self) -> Geometry {
        let skin = self.skin();
        let vertices: Vec<DVec3> = skin.iter().flat_map(|(_, corners)| *corners).collect();
        let triangles: Vec<[u32; 3]> =
            (0..skin.len() as u32).map(|first| [3 * first, 3 * first + 1, 3 * first + 2]).collect();
        Geometry::mesh(&vertices, &triangles).expect("a skin")
    }
}

/// Whether a point lies in a closed mesh; `None` on its surface.
pub(crate) fn contains(mesh: &Geometry, point: DVec3) -> Option<bool> {
    let Form::Mesh(mesh) = mesh.form() else { panic!("a mesh") };
    match mesh.contains(point, &mut Work::default()) {
        Containment::Inside => Some(true),
        Containment::Outside => Some(false),
        Containment::Undecided => None,
    }
}
