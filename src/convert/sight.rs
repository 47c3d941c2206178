//! Observers and targets as columns, and what each observer sees.

use collision::{
    DVec3,
    world::{Seen, SeenCount, ShapeId, Sight},
};
use wire::v1 as pb;

use super::{
    columns::{Distances, Ids, VectorColumn},
    place::position,
};
use crate::problem::{Checked, Problem, Reason, Under};

/// Most pairs of an observer and a point.
const WAYS: usize = 65_536;

/// Who looks at what.
#[derive(Debug)]
pub(crate) struct Watched<'a> {
    frame_origin: DVec3,
    eyes: VectorColumn<'a>,
    eye_count: usize,
    points: VectorColumn<'a>,
    point_count: usize,
    /// Where the points of each target begin, and where the last ones end; empty if each point is a target of its own.
    offsets: &'a [u32],
    max_distances: Distances<'a>,
    eye_ids: Ids<'a>,
    target_ids: Ids<'a>,
}

impl<'a> Watched<'a> {
    /// Those of a request.
    ///
    /// # Errors
    /// A column's length, no eyes or points, too many of them, offsets that do not ascend from 0 to the number of points.
    pub(crate) fn new(sent: &'a pb::LineOfSightRequest) -> Checked<Self> {
        let eye_count = vectors("eyes", &sent.eyes)?;
        let point_count = vectors("points", &sent.points)?;
        if eye_count.saturating_mul(point_count) > WAYS {
            let what = format!(
                "has {point_count} points for {eye_count} eyes: at most {WAYS} pairs of an eye and a point are allowed; ask \
                 in several calls"
            );
            return Err(Problem::at("points", Reason::TooManyItems, what));
        }
        check_offsets(&sent.offsets, point_count)?;
        let target_count = sent.offsets.len().checked_sub(1).unwrap_or(point_count);
        Ok(Self {
            frame_origin: position(sent.frame_origin.as_ref(), DVec3::ZERO).under("frame_origin")?,
            eyes: VectorColumn::new("eyes", &sent.eyes, eye_count)?,
            eye_count,
            points: VectorColumn::new("points", &sent.points, point_count)?,
            point_count,
            offsets: &sent.offsets,
            max_distances: Distances::new("max_distances", &sent.max_distances, eye_count)?,
            eye_ids: Ids::new("eye_ids", &sent.eye_ids, eye_count)?,
            target_ids: Ids::new("target_ids", &sent.target_ids, target_count)?,
        })
    }

    /// How many observers.
    pub(crate) fn eye_count(&self) -> usize {
        self.eye_count
    }

    /// How many targets.
    pub(crate) fn target_count(&self) -> usize {
        self.offsets.len().checked_sub(1).unwrap_or(self.point_count)
    }

    /// How many points of all targets.
    pub(crate) fn point_count(&self) -> usize {
        self.point_count
    }

    /// The points of a target, by index.
    pub(crate) fn points_of(&self, target: usize) -> std::ops::Range<usize> {
        match self.offsets.get(target..target + 2) {
            Some(ends) => ends[0] as usize..ends[1] as usize,
            None => target..target + 1,
        }
    }

    /// How an observer looks at a point.
    ///
    /// # Errors
    /// A number that is not finite or beyond the limits.
    pub(crate) fn sight(&self, eye: usize, point: usize) -> Checked<Sight> {
        Ok(Sight {
            eye: self.eyes.item_from(eye, self.frame_origin)?.unwrap_or(self.frame_origin),
            point: self.points.item_from(point, self.frame_origin)?.unwrap_or(self.frame_origin),
            max_distance: self.max_distances.item(eye)?,
        })
    }

    /// The shapes that hide nothing between the two: those that they are themselves.
    pub(crate) fn own(&self, eye: usize, target: usize) -> impl Iterator<Item = ShapeId> {
        self.eye_ids.item(eye).into_iter().chain(self.target_ids.item(target))
    }
}

/// How many vectors a column has.
fn vectors(name: &'static str, numbers: &[f32]) -> Checked<usize> {
    if numbers.is_empty() {
        let what = "is absent: x, y, z of each are required, such as [0, 1.5, 0]";
        return Err(Problem::at(name, Reason::Missing, what));
    }
    if !numbers.len().is_multiple_of(3) {
        let what = format!("has {} numbers: it must have x, y, z of each, a multiple of 3", numbers.len());
        return Err(Problem::at(name, Reason::ColumnLength, what));
    }
    Ok(numbers.len() / 3)
}

fn check_offsets(offsets: &[u32], point_count: usize) -> Checked<()> {
    let (Some(&first), Some(&last)) = (offsets.first(), offsets.last()) else { return Ok(()) };
    if first != 0 {
        return Err(Problem::at("offsets[0]", Reason::OutOfLimits, format!("is {first}: it must be 0")));
    }
    if let Some(index) = offsets.windows(2).position(|pair| pair[0] > pair[1]) {
        let what =
            format!("is {}, below {} before it: offsets ascend, such as 0, 1, 3", offsets[index + 1], offsets[index]);
        return Err(Problem::at(format!("offsets[{}]", index + 1), Reason::OutOfLimits, what));
    }
    if last as usize != point_count {
        let what = format!("is {last}, and there are {point_count} points: the last offset must be their number");
        return Err(Problem::at(format!("offsets[{}]", offsets.len() - 1), Reason::OutOfLimits, what));
    }
    Ok(())
}

/// The columns of what is seen.
#[derive(Debug, Default)]
pub(crate) struct SeenColumns(pb::LineOfSightResponse);

impl SeenColumns {
    /// Room for so many pairs of an observer and a target.
    pub(crate) fn new(pair_count: usize) -> Self {
        Self(pb::LineOfSightResponse {
            visible: Vec::with_capacity(pair_count),
            hidden: Vec::with_capacity(pair_count),
            undecided: Vec::with_capacity(pair_count),
            ..pb::LineOfSightResponse::default()
        })
    }

    /// Adds what an observer sees of the next target.
    pub(crate) fn add(&mut self, count: SeenCount) {
        self.0.visible.push(count.visible);
        self.0.hidden.push(count.hidden);
        self.0.undecided.push(count.undecided);
    }

    /// Adds whether an observer sees the next point; `None` if it was not looked at.
    pub(crate) fn add_point(&mut self, seen: Option<Seen>) {
        let seen = match seen {
            None => pb::Sight::Unspecified,
            Some(Seen::Visible) => pb::Sight::Visible,
            Some(Seen::Hidden) => pb::Sight::Hidden,
            Some(Seen::Undecided) => pb::Sight::Undecided,
            Some(Seen::Beyond) => pb::Sight::Beyond,
        };
        self.0.points.push(seen.into());
    }

    /// All of them.
    pub(crate) fn finish(self, info: Option<pb::AnswerInfo>) -> pb::LineOfSightResponse {
        pb::LineOfSightResponse { info, ..self.0 }
    }
}
