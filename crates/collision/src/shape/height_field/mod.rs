//! Height fields: a terrain over a grid, with matter below.
//!
//! ```text
//!        x ->                              y
//!   z  A---B---*     corners of a cell     |  .-._   surface
//!   |  |\ 1|\  |     and its triangles:    | /    '-.___
//!   v  | \ | \ |     0 is A C D,           | |matter   |
//!      |0 \|  \|     1 is A D B            | |_________|  floor
//!      C---D---*
//! ```
//!
//! # Method
//! Samples lie `spacing.x` and `spacing.z` apart from the local origin on, their heights times `spacing.y`; each product is
//! rounded to nearest, and that is the form. The diagonal of each cell goes from its corner of least x and z to that of
//! greatest x and z. Matter fills what is below the surface, down to a level floor ([`HeightField::floor`]): so the form is a
//! body with an inside, and has walls at its border and around its holes. No triangle is stored: skin is made where it is
//! asked ([`skin`]), found by the least and greatest heights of blocks of cells ([`pyramid`]).

mod pyramid;
mod skin;
mod standing;

use std::sync::Arc;

use glam::DVec3;

use self::pyramid::Pyramid;
pub(crate) use self::standing::Standing;
use super::{
    Form, Geometry,
    built::Structure,
    lazy::Lazy,
    limits::{AXES, GeometryError, Limits, check_size, is_size, out_of_limits},
};
use crate::math::{Aabb, Ball};

/// A terrain over a grid, with matter below.
#[derive(Debug)]
pub struct HeightField {
    columns: usize,
    rows: usize,
    /// Row by row, as sent.
    heights: Arc<[f32]>,
    spacing: DVec3,
    /// The cells left open, in order, each once.
    holes: Arc<[u32]>,
    /// One bit for each cell that is left open; empty if none is.
    open: Arc<[u64]>,
    floor: f64,
    bounds: Aabb,
    pyramid: Lazy<Pyramid>,
}

/// What a height field is made of, as sent.
#[derive(Clone, Copy, Debug)]
pub struct Terrain<'a> {
    /// Samples along x, at least 2.
    pub columns: usize,
    /// Samples along z, at least 2.
    pub rows: usize,
    /// `columns * rows` heights, row by row.
    pub heights: &'a [f32],
    /// Distance between samples along x and z, metres, and factor on heights (y); each from 1e-9 to 1e9.
    pub spacing: DVec3,
    /// Cells left open: `row * (columns - 1) + column`.
    pub holes: &'a [u32],
}

impl HeightField {
    /// Samples along x.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Samples along z.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The heights as they were sent, row by row.
    #[must_use]
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// Distance between samples along x and z, and factor on heights (y).
    #[must_use]
    pub fn spacing(&self) -> DVec3 {
        self.spacing
    }

    /// The cells left open, in order, each once.
    #[must_use]
    pub fn holes(&self) -> &[u32] {
        &self.holes
    }

    /// How many cells there are, open ones included.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        (self.columns - 1) * (self.rows - 1)
    }

    /// The height down to which there is matter: that of the lowest sample, less the longer side of the grid.
    #[must_use]
    pub fn floor(&self) -> f64 {
        self.floor
    }

    /// Bytes held now, what was built lazily included.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        let lists = size_of_val(&*self.heights) + size_of_val(&*self.holes) + size_of_val(&*self.open);
        (size_of::<Self>() + lists) as u64 + self.pyramid.built().map_or(0, Pyramid::memory_bytes)
    }

    /// What questions made it build.
    pub(super) fn structure(&self) -> Option<Structure> {
        let bytes = self.pyramid.built().map_or(0, Pyramid::memory_bytes);
        Structure::of("height_pyramid", bytes, [self.pyramid.receipt()])
    }

    /// Its box: exact.
    pub(super) fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The ball around that.
    pub(crate) fn ball(&self) -> Ball {
        self.bounds.ball()
    }

    /// The same samples `scale` times as far from each other and as high; they are shared.
    pub(super) fn scaled(&self, scale: f64) -> Result<Geometry, GeometryError> {
        let spacing = self.spacing * scale;
        if !spacing.to_array().into_iter().all(is_size) {
            let allowed = "such that the spacing stays from 1e-9 to 1e9 metres";
            return Err(out_of_limits("scale".into(), scale, allowed));
        }
        let (heights, holes, open) = (self.heights.clone(), self.holes.clone(), self.open.clone());
        Geometry::of_height_field(Self { spacing, heights, holes, open, pyramid: Lazy::default(), ..*self }, "scale")
    }

    /// With floor and bounds that follow from the samples.
    fn settled(self) -> Self {
        let (low, high) = self
            .heights
            .iter()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &height| (low.min(height), high.max(height)));
        let far = self.sample_place(self.columns - 1, self.rows - 1);
        let [low, high] = [low, high].map(|height| f64::from(height) * self.spacing.y + 0.0);
        let floor = low - far.0.max(far.1);
        Self { floor, bounds: Aabb::new(DVec3::new(0.0, floor, 0.0), DVec3::new(far.0, high, far.1)), ..self }
    }

    /// Along x and z.
    fn sample_place(&self, column: usize, row: usize) -> (f64, f64) {
        (column as f64 * self.spacing.x, row as f64 * self.spacing.z)
    }

    /// A sample.
    fn sample(&self, column: usize, row: usize) -> DVec3 {
        let (x, z) = self.sample_place(column, row);
        DVec3::new(x, f64::from(self.heights[row * self.columns + column]) * self.spacing.y + 0.0, z)
    }

    /// Whether there is matter below a cell: not beyond the border, and not in a hole.
    fn is_filled(&self, column: isize, row: isize) -> bool {
        let (Ok(column), Ok(row)) = (usize::try_from(column), usize::try_from(row)) else {
            return false;
        };
        if column >= self.columns - 1 || row >= self.rows - 1 {
            return false;
        }
        let cell = row * (self.columns - 1) + column;
        self.open.get(cell / 64).is_none_or(|bits| bits >> (cell % 64) & 1 == 0)
    }
}

impl Geometry {
    /// A terrain: see [`HeightField`].
    ///
    /// # Errors
    /// Fewer than two samples along a side, too many, a list that is too short or long, a height that is not finite or
    /// beyond [`Limits::COORDINATE`], a spacing out of limits, a hole that is no cell, nothing but holes.
    ///
    /// ```
    /// use collision::{DVec3, accuracy::Accuracy, answer::Work, math::Pose, narrow, shape::{Geometry, Terrain}};
    /// let slope = Terrain { columns: 2, rows: 2, heights: &[0.0, 1.0, 0.0, 1.0], spacing: DVec3::ONE, holes: &[] };
    /// let (slope, ball) = (Geometry::height_field(&slope).unwrap(), Geometry::sphere(0.25).unwrap());
    /// let slope = narrow::Placed { geometry: &slope, pose: Pose::IDENTITY };
    /// let ball = narrow::Placed { geometry: &ball, pose: Pose::at(DVec3::new(0.5, 1.5, 0.5)) };
    /// let apart = narrow::distance(ball, slope, 9.0, &Accuracy::default(), &mut Work::default()).unwrap();
    /// assert!((apart.distance - (0.5_f64.sqrt() - 0.25)).abs() < 1e-12);
    /// ```
    pub fn height_field(terrain: &Terrain<'_>) -> Result<Self, GeometryError> {
        let Terrain { columns, rows, heights, spacing, holes } = *terrain;
        for (field, count) in [("columns", columns), ("rows", rows)] {
            if count < 2 {
                let reason = format!("is {count}: a height field needs 2 samples at least along each side");
                return Err(GeometryError::Bad { field: field.into(), reason });
            }
        }
        let (found, most) = (columns.saturating_mul(rows), Limits::HEIGHT_FIELD_SAMPLES);
        if found > most {
            return Err(GeometryError::TooMany { field: "heights".into(), found, most });
        }
        if heights.len() != found {
            let expected = format!("{columns} columns of {rows} rows need {found}");
            return Err(GeometryError::ColumnLength { field: "heights".into(), found: heights.len(), expected });
        }
        for (axis, value) in AXES.into_iter().zip(spacing.to_array()) {
            check_size(&format!("spacing.{axis}"), value, "from 1e-9 to 1e9 metres")?;
        }
        if let Some((index, &height)) = heights.iter().enumerate().find(|(_, height)| !height.is_finite()) {
            return Err(GeometryError::NotFinite { field: format!("heights[{index}]"), value: f64::from(height) });
        }
        let (holes, open) = checked_holes(holes, (columns - 1) * (rows - 1))?;
        let nowhere = Aabb::new(DVec3::ZERO, DVec3::ZERO);
        let heights = heights.into();
        let field = HeightField {
            columns,
            rows,
            heights,
            spacing,
            holes: holes.into(),
            open: open.into(),
            floor: 0.0,
            bounds: nowhere,
            pyramid: Lazy::default(),
        };
        Self::of_height_field(field, "heights")
    }

    fn of_height_field(field: HeightField, name: &str) -> Result<Self, GeometryError> {
        let field = field.settled();
        let farthest = field.bounds.min.abs().max(field.bounds.max.abs()).max_element();
        if farthest > Limits::COORDINATE {
            let allowed = "such that all of the height field stays within 1e12 metres of the local origin";
            return Err(out_of_limits(name.into(), farthest, allowed));
        }
        Ok(Self::of(Form::HeightField(Arc::new(field))))
    }
}

/// The holes in order, each once, and a bit for each cell.
fn checked_holes(sent: &[u32], cells: usize) -> Result<(Vec<u32>, Vec<u64>), GeometryError> {
    let mut holes = sent.to_vec();
    let mut open = vec![0_u64; if sent.is_empty() { 0 } else { cells.div_ceil(64) }];
    for (index, &hole) in sent.iter().enumerate() {
        let cell = hole as usize;
        if cell >= cells {
            let (field, reason) =
                (format!("holes[{index}]"), format!("is {hole}: there are {cells} cells, so it must be below that"));
            return Err(GeometryError::Bad { field, reason });
        }
        open[cell / 64] |= 1 << (cell % 64);
    }
    holes.sort_unstable();
    holes.dedup();
    if holes.len() == cells {
        let reason = "is every cell: one at least must be filled".into();
        return Err(GeometryError::Bad { field: "holes".into(), reason });
    }
    Ok((holes, open))
}
