//! Rays as columns.

use collision::{
    DVec3,
    narrow::{Faces, Ray},
    world::{HitMode, Raycast, ShapeId},
};
use wire::v1 as pb;

use super::{
    columns::{Distances, Ids, VectorColumn, item_count},
    place::position,
    question::{faces, hit_mode},
};
use crate::problem::{Checked, Problem, Reason, Under};

/// The rays of a request.
#[derive(Debug)]
pub(crate) struct Rays<'a> {
    n: usize,
    frame_origin: DVec3,
    origins: VectorColumn<'a>,
    directions: VectorColumn<'a>,
    max_distances: Distances<'a>,
    ignore_ids: Ids<'a>,
    mode: HitMode,
    hollow: bool,
    faces: Faces,
}

impl<'a> Rays<'a> {
    /// As many as the longest column has.
    ///
    /// # Errors
    /// A column's length, no directions, a mode that columns have no room for.
    pub(crate) fn new(sent: &'a pb::RaycastBatchRequest) -> Checked<Self> {
        let (origins, directions) = (&sent.origins, &sent.directions);
        if directions.is_empty() {
            let what = "is absent: x, y, z of each ray are required, such as [0, 0, 1]";
            return Err(Problem::at("directions", Reason::Missing, what));
        }
        let mode = hit_mode(sent.mode, 0, None)?;
        let list = match mode {
            HitMode::Closest | HitMode::Any => None,
            HitMode::All(_) => Some("HIT_MODE_ALL"),
            HitMode::Pierce { .. } => Some("HIT_MODE_PIERCE"),
        };
        if let Some(list) = list {
            let what = format!("is {list}: columns have one hit for each ray; ask Batch for lists");
            return Err(Problem::at("mode", Reason::OutOfLimits, what));
        }
        let lengths =
            [(origins.len(), 3), (directions.len(), 3), (sent.max_distances.len(), 1), (sent.ignore_ids.len(), 1)];
        let n = item_count(lengths);
        Ok(Self {
            n,
            frame_origin: position(sent.frame_origin.as_ref(), DVec3::ZERO).under("frame_origin")?,
            origins: VectorColumn::new("origins", origins, n)?,
            directions: VectorColumn::new("directions", directions, n)?,
            max_distances: Distances::new("max_distances", &sent.max_distances, n)?,
            ignore_ids: Ids::new("ignore_ids", &sent.ignore_ids, n)?,
            mode,
            hollow: sent.hollow,
            faces: faces(sent.faces)?,
        })
    }

    /// How many.
    pub(crate) fn len(&self) -> usize {
        self.n
    }

    /// What origins are relative to, and points of answers.
    pub(crate) fn frame_origin(&self) -> DVec3 {
        self.frame_origin
    }

    /// A ray, and the shape that it does not see.
    ///
    /// # Errors
    /// A number that is not finite or beyond the limits, a direction of length 0.
    #[inline]
    pub(crate) fn item(&self, index: usize) -> Checked<(Raycast, Option<ShapeId>)> {
        let direction = self.directions.item_from(index, DVec3::ZERO)?.unwrap_or(DVec3::ZERO);
        if direction == DVec3::ZERO {
            let place = self.directions.place(index);
            let what = "begins a direction of (0, 0, 0): it may have any length but 0, such as 0, 0, 1";
            return Err(Problem::at(format!("directions[{place}]"), Reason::OutOfLimits, what));
        }
        let ray = Ray {
            origin: self.origins.item_from(index, self.frame_origin)?.unwrap_or(self.frame_origin),
            direction,
            min_distance: 0.0,
            max_distance: self.max_distances.item(index)?,
            hollow: self.hollow,
            faces: self.faces,
        };
        Ok((Raycast { ray, mode: self.mode }, self.ignore_ids.item(index)))
    }
}
