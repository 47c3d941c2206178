//! Whether a point lies in the matter of a height field.
//!
//! # Method
//! The cell below or above the point says: its surface is two planes that meet at the diagonal. A point that is known to
//! within a slack may be in several cells, and then all of them must say the same. What rounding leaves open is said to be so.

use glam::DVec3;

use super::HeightField;
use crate::tolerance::STANDING;

/// How a point stands to the matter of a height field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Standing {
    /// In it, below this leaf of the surface.
    Inside(usize),
    /// Not in it.
    Outside,
    /// One of the two; it is within so many metres of the matter.
    Open(f64),
}

impl HeightField {
    /// How a point stands that lies within `slack` metres of this one.
    pub(crate) fn standing(&self, point: DVec3, slack: f64) -> Standing {
        let size = self.bounds.max.abs().max(self.bounds.min.abs()).element_sum() + point.abs().element_sum();
        let slack = slack + STANDING * size;
        let (low, high) = (point - slack, point + slack);
        if low.cmpgt(self.bounds.max).any() || high.cmplt(self.bounds.min).any() {
            return Standing::Outside;
        }
        // Cells are counted from 0, so that what is below is beyond the border.
        let span =
            |low: f64, high: f64, spacing: f64| ((low / spacing).floor() as isize, (high / spacing).floor() as isize);
        let (columns, rows) = (span(low.x, high.x, self.spacing.x), span(low.z, high.z, self.spacing.z));
        if columns.1.saturating_sub(columns.0) > 1 || rows.1.saturating_sub(rows.0) > 1 {
            return Standing::Open(self.bounds.max.y - self.floor + 4.0 * slack);
        }
        let mut found = None;
        for row in rows.0..=rows.1 {
            for column in columns.0..=columns.1 {
                let here = self.standing_in_cell((column, row), point, slack);
                found = Some(found.map_or(here, |known| both(known, here, slack)));
            }
        }
        found.unwrap_or(Standing::Outside)
    }

    fn standing_in_cell(&self, (column, row): (isize, isize), point: DVec3, slack: f64) -> Standing {
        if !self.is_filled(column, row) {
            return Standing::Outside;
        }
        let [a, b, c, d] = self.cell_corners(column as usize, row as usize);
        let (along_x, along_z) = ((point.x - a.x) / (b.x - a.x), (point.z - a.z) / (c.z - a.z));
        let (along_x, along_z) = (along_x.clamp(0.0, 1.0), along_z.clamp(0.0, 1.0));
        // Beyond the diagonal towards +z is the triangle A C D, towards +x the triangle A D B.
        let (number, height) = if along_z >= along_x {
            (0, a.y + (c.y - a.y) * along_z + (d.y - c.y) * along_x)
        } else {
            (1, a.y + (b.y - a.y) * along_x + (d.y - b.y) * along_z)
        };
        let heights = [a.y, b.y, c.y, d.y];
        let range = heights.into_iter().fold(f64::MIN, f64::max) - heights.into_iter().fold(f64::MAX, f64::min);
        let doubt = slack + slack * range * (1.0 / (b.x - a.x) + 1.0 / (c.z - a.z));
        let (above, over_floor) = (point.y - height, point.y - self.floor);
        if above > doubt || over_floor < -slack {
            Standing::Outside
        } else if above < -doubt && over_floor > slack {
            Standing::Inside((row as usize * (self.columns - 1) + column as usize) * 16 + number)
        } else {
            Standing::Open(doubt + 4.0 * slack)
        }
    }
}

/// What two cells say of a point that may be in either.
fn both(one: Standing, other: Standing, slack: f64) -> Standing {
    match (one, other) {
        (Standing::Outside, Standing::Outside) => Standing::Outside,
        (Standing::Inside(leaf), Standing::Inside(_)) => Standing::Inside(leaf),
        (Standing::Open(a), Standing::Open(b)) => Standing::Open(a.max(b)),
        (Standing::Open(a), _) | (_, Standing::Open(a)) => Standing::Open(a),
        (Standing::Inside(_), Standing::Outside) | (Standing::Outside, Standing::Inside(_)) => {
            Standing::Open(4.0 * slack)
        }
    }
}
