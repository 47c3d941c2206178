//! Columns: one list of numbers for each component, for many items at once.

use collision::{DQuat, DVec3, shape::Limits, world::ShapeId};
use wire::v1 as pb;

use super::{
    number::{FROM_ZERO_TO_REACH, REACH, not_finite},
    place::{is_zero_quat, position},
};
use crate::problem::{Checked, Problem, Reason, Under};

/// How many items there are: as many as the longest column has, each of a length and so many numbers for an item.
pub(crate) fn item_count<const COLUMNS: usize>(columns: [(usize, usize); COLUMNS]) -> usize {
    columns.into_iter().map(|(length, width)| length / width).max().unwrap_or(0)
}

/// A column of `WIDTH`-vectors for `n` items: one for each, one for all, or none.
#[derive(Clone, Copy, Debug)]
struct Column<'a, const WIDTH: usize> {
    name: &'static str,
    numbers: &'a [f32],
    n: usize,
}

impl<'a, const WIDTH: usize> Column<'a, WIDTH> {
    fn new(name: &'static str, numbers: &'a [f32], n: usize) -> Checked<Self> {
        let found = numbers.len();
        if found == 0 || found == WIDTH || found == WIDTH * n {
            return Ok(Self { name, numbers, n });
        }
        let what = format!(
            "has {found} numbers: it must have {} ({WIDTH} for each of {n} items), {WIDTH} (for all of them) or none",
            WIDTH * n
        );
        Err(Problem::at(name, Reason::ColumnLength, what))
    }

    /// Where the numbers of an item begin.
    fn begin(&self, index: usize) -> usize {
        if self.numbers.len() == WIDTH * self.n { index * WIDTH } else { 0 }
    }

    /// The numbers of an item, whatever they are; `None` if the column is absent.
    #[inline]
    fn unchecked(&self, index: usize) -> Option<[f64; WIDTH]> {
        let numbers = self.numbers.get(self.begin(index)..)?.first_chunk()?;
        Some(numbers.map(f64::from))
    }

    /// The numbers of an item; `None` if the column is absent.
    ///
    /// # Errors
    /// One is not finite.
    #[inline]
    fn item(&self, index: usize) -> Checked<Option<[f64; WIDTH]>> {
        let item = self.unchecked(index);
        match item.is_none_or(|item| item.iter().all(|number| number.is_finite())) {
            true => Ok(item),
            false => Err(self.not_finite(index)),
        }
    }

    /// What is said of an item with a number that is not finite.
    #[cold]
    fn not_finite(&self, index: usize) -> Problem {
        let item = self.unchecked(index).unwrap_or([0.0; WIDTH]);
        let offset = item.iter().position(|number| !number.is_finite()).unwrap_or(0);
        not_finite(format!("{}[{}]", self.name, self.begin(index) + offset), item[offset])
    }
}

/// Vectors of many items, such as velocities.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VectorColumn<'a>(Column<'a, 3>);

impl<'a> VectorColumn<'a> {
    /// The column `name`.
    ///
    /// # Errors
    /// Its length.
    pub(crate) fn new(name: &'static str, numbers: &'a [f32], n: usize) -> Checked<Self> {
        Column::new(name, numbers, n).map(Self)
    }

    /// The vector of an item; `None` if the column is absent.
    ///
    /// # Errors
    /// A number that is not finite or beyond the limits.
    #[inline]
    pub(crate) fn item(&self, index: usize) -> Checked<Option<DVec3>> {
        self.item_from(index, DVec3::ZERO)
    }

    /// The vector of an item from `origin`; `None` if the column is absent.
    ///
    /// # Errors
    /// As [`VectorColumn::item`].
    #[inline]
    pub(crate) fn item_from(&self, index: usize, origin: DVec3) -> Checked<Option<DVec3>> {
        let Some(item) = self.0.unchecked(index) else { return Ok(None) };
        let vector = origin + DVec3::from_array(item);
        // What is not finite is not within either.
        match vector.abs().cmple(DVec3::splat(Limits::COORDINATE)).all() {
            true => Ok(Some(vector)),
            false => Err(self.beyond(index, vector)),
        }
    }

    /// What is said of an item that is not finite or beyond the limits, which `vector` is with the frame's origin.
    #[cold]
    fn beyond(&self, index: usize, vector: DVec3) -> Problem {
        if let Err(problem) = self.0.item(index) {
            return problem;
        }
        let vector = vector.to_array();
        let offset = vector.iter().position(|value| value.abs() > Limits::COORDINATE).unwrap_or(0);
        let what = format!("is {} with the frame origin: it must be within 1e12 of 0", vector[offset]);
        Problem::at(format!("{}[{}]", self.0.name, self.0.begin(index) + offset), Reason::OutOfLimits, what)
    }

    /// Where the vector of an item begins in the column.
    pub(crate) fn place(&self, index: usize) -> usize {
        self.0.begin(index)
    }
}

/// Single numbers of many items, such as factors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Numbers<'a>(Column<'a, 1>);

impl<'a> Numbers<'a> {
    /// The column `name`.
    ///
    /// # Errors
    /// Its length.
    pub(crate) fn new(name: &'static str, numbers: &'a [f32], n: usize) -> Checked<Self> {
        Column::new(name, numbers, n).map(Self)
    }

    /// The number of an item; `None` if the column is absent.
    ///
    /// # Errors
    /// It is not finite.
    #[inline]
    pub(crate) fn item(&self, index: usize) -> Checked<Option<f64>> {
        Ok(self.0.item(index)?.map(|[number]| number))
    }
}

/// How far each item looks, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Distances<'a>(Column<'a, 1>);

impl<'a> Distances<'a> {
    /// The column `name`.
    ///
    /// # Errors
    /// Its length.
    pub(crate) fn new(name: &'static str, numbers: &'a [f32], n: usize) -> Checked<Self> {
        Column::new(name, numbers, n).map(Self)
    }

    /// The distance of an item; across every world if the column is absent.
    ///
    /// # Errors
    /// It is not finite, or out of range.
    #[inline]
    pub(crate) fn item(&self, index: usize) -> Checked<f64> {
        let Some([distance]) = self.0.item(index)? else { return Ok(REACH) };
        if (0.0..=REACH).contains(&distance) {
            return Ok(distance);
        }
        let what = format!("is {distance}: it must be {FROM_ZERO_TO_REACH}");
        Err(Problem::at(format!("{}[{}]", self.0.name, self.0.begin(index)), Reason::OutOfLimits, what))
    }
}

/// A shape of each item, or none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ids<'a> {
    ids: &'a [u64],
    n: usize,
}

impl<'a> Ids<'a> {
    /// The column `name`.
    ///
    /// # Errors
    /// Its length.
    pub(crate) fn new(name: &'static str, ids: &'a [u64], n: usize) -> Checked<Self> {
        if [0, 1, n].contains(&ids.len()) {
            return Ok(Self { ids, n });
        }
        let what = format!("has {} ids: it must have {n} (one for each item), 1 (for all of them) or none", ids.len());
        Err(Problem::at(name, Reason::ColumnLength, what))
    }

    /// The shape of an item.
    #[inline]
    pub(crate) fn item(&self, index: usize) -> Option<ShapeId> {
        let place = if self.ids.len() == self.n { index } else { 0 };
        self.ids.get(place).copied().and_then(ShapeId::new)
    }
}

/// The poses of many items.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Poses<'a> {
    frame_origin: DVec3,
    positions: VectorColumn<'a>,
    rotations: Column<'a, 4>,
}

impl<'a> Poses<'a> {
    /// The poses of `n` items; absent columns are absent in each.
    ///
    /// # Errors
    /// A column's length, the frame origin.
    pub(crate) fn new(sent: Option<&'a pb::PoseColumns>, n: usize) -> Checked<Self> {
        let frame_origin = sent.and_then(|sent| sent.frame_origin.as_ref());
        Ok(Self {
            frame_origin: position(frame_origin, DVec3::ZERO).under("frame_origin")?,
            positions: VectorColumn::new("positions", sent.map_or(&[], |sent| &sent.positions), n)?,
            rotations: Column::new("rotations", sent.map_or(&[], |sent| &sent.rotations), n)?,
        })
    }

    /// Where the frame of all positions is.
    pub(crate) fn frame_origin(&self) -> DVec3 {
        self.frame_origin
    }

    /// The position of an item in the world; `None` if the column is absent.
    ///
    /// # Errors
    /// A number that is not finite or beyond the limits.
    pub(crate) fn position(&self, index: usize) -> Checked<Option<DVec3>> {
        self.positions.item_from(index, self.frame_origin)
    }

    /// The rotation of an item; `None` if the column is absent.
    ///
    /// # Errors
    /// A number that is not finite, a quaternion of length 0.
    pub(crate) fn rotation(&self, index: usize) -> Checked<Option<DQuat>> {
        let Some(item) = self.rotations.item(index)? else { return Ok(None) };
        if is_zero_quat(item) {
            let what = "begins a quaternion of four zeros: it may have any length but 0; 0, 0, 0, 1 is no rotation";
            return Err(Problem::at(format!("rotations[{}]", self.rotations.begin(index)), Reason::OutOfLimits, what));
        }
        Ok(Some(DQuat::from_array(item)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(positions: &[f32], rotations: &[f32]) -> pb::PoseColumns {
        pb::PoseColumns {
            frame_origin: Some(pb::Vec3 { x: 100.0, y: 0.0, z: 0.0 }),
            positions: positions.to_vec(),
            rotations: rotations.to_vec(),
        }
    }

    #[test]
    fn one_vector_serves_for_all_and_is_relative_to_the_frame_origin() {
        let sent = columns(&[1.0, 2.0, 3.0], &[]);
        let poses = Poses::new(Some(&sent), 5).unwrap();
        assert_eq!(poses.position(4).unwrap(), Some(DVec3::new(101.0, 2.0, 3.0)));
        assert_eq!(poses.rotation(4).unwrap(), None);
    }

    #[test]
    fn a_wrong_length_says_what_would_be_right() {
        let sent = columns(&[0.0; 7], &[]);
        let problem = Poses::new(Some(&sent), 2).unwrap_err().into_wire();
        assert_eq!(problem.field, "positions");
        assert!(problem.message.contains("has 7 numbers: it must have 6"), "{}", problem.message);
    }

    #[test]
    fn a_number_is_named_by_its_place_in_the_column() {
        let sent = columns(&[0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        let poses = Poses::new(Some(&sent), 2).unwrap();
        assert_eq!(poses.position(1).unwrap_err().into_wire().field, "positions[4]");
        assert_eq!(poses.rotation(1).unwrap_err().into_wire().field, "rotations[4]");
    }
}
