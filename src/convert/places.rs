//! One geometry at many places or on many ways, as columns.

use std::sync::Arc;

use collision::{DQuat, DVec3, math::Pose, shape::Geometry};
use wire::v1 as pb;

use super::{
    columns::{Numbers, Poses, item_count},
    geometry::{of_question, scaled},
    question::check_bounded,
};
use crate::{
    geometries::Geometries,
    problem::{Checked, Problem, Reason, Under},
};

/// A geometry at many places.
#[derive(Debug)]
pub(crate) struct Places<'a> {
    n: usize,
    geometry: Arc<Geometry>,
    poses: Poses<'a>,
    scales: Numbers<'a>,
    /// The geometry at the scale that was asked last.
    last_scaled: Option<(f64, Arc<Geometry>)>,
}

impl<'a> Places<'a> {
    /// As many as the longest column has; `others` is the length of one that goes with them.
    ///
    /// # Errors
    /// What is wrong with the geometry, a column's length.
    pub(crate) fn new(
        geometry: Option<&pb::Geometry>,
        poses: Option<&'a pb::PoseColumns>,
        scales: &'a [f32],
        others: usize,
        known: &Geometries,
    ) -> Checked<Self> {
        let n = item_count([longest(poses), (scales.len(), 1), (others, 1)]);
        Ok(Self {
            n,
            geometry: subject(geometry, known)?,
            poses: Poses::new(poses, n).under("poses")?,
            scales: Numbers::new("scales", scales, n)?,
            last_scaled: None,
        })
    }

    /// How many.
    pub(crate) fn len(&self) -> usize {
        self.n
    }

    /// What positions are relative to, and points of answers.
    pub(crate) fn frame_origin(&self) -> DVec3 {
        self.poses.frame_origin()
    }

    /// The geometry at its scale there, and where.
    ///
    /// # Errors
    /// A number that is not finite or beyond the limits, a scale that the geometry does not bear.
    pub(crate) fn item(&mut self, index: usize) -> Checked<(Arc<Geometry>, Pose)> {
        let pose = pose(&self.poses, index, Pose::at(self.frame_origin())).under("poses")?;
        let Some(scale) = self.scales.item(index)? else { return Ok((self.geometry.clone(), pose)) };
        if let Some((_, known)) = self.last_scaled.as_ref().filter(|(known, _)| known.total_cmp(&scale).is_eq()) {
            return Ok((known.clone(), pose));
        }
        let geometry = scaled(&self.geometry, scale).map_err(|problem| problem.at_field(format!("scales[{index}]")))?;
        let geometry = Arc::new(geometry);
        self.last_scaled = Some((scale, geometry.clone()));
        Ok((geometry, pose))
    }
}

/// A geometry on many ways.
#[derive(Debug)]
pub(crate) struct Ways<'a> {
    n: usize,
    geometry: Arc<Geometry>,
    starts: Poses<'a>,
    ends: Poses<'a>,
}

impl<'a> Ways<'a> {
    /// As many as the longest column has.
    ///
    /// # Errors
    /// What is wrong with the geometry, a column's length, ends relative to another frame.
    pub(crate) fn new(sent: &'a pb::TimeOfImpactBatchRequest, known: &Geometries) -> Checked<Self> {
        let (starts, ends) = (sent.starts.as_ref(), sent.ends.as_ref());
        let n = item_count([longest(starts), longest(ends)]);
        let ways = Self {
            n,
            geometry: subject(sent.geometry.as_ref(), known)?,
            starts: Poses::new(starts, n).under("starts")?,
            ends: Poses::new(ends, n).under("ends")?,
        };
        if ends.is_some() && ways.ends.frame_origin() != ways.starts.frame_origin() {
            let what =
                "is not that of starts: both columns must be relative to the same point, so send the same frame_origin";
            return Err(Problem::at("ends.frame_origin", Reason::OutOfLimits, what));
        }
        Ok(ways)
    }

    /// How many.
    pub(crate) fn len(&self) -> usize {
        self.n
    }

    /// What moves.
    pub(crate) fn geometry(&self) -> Arc<Geometry> {
        self.geometry.clone()
    }

    /// What positions are relative to, and points of answers.
    pub(crate) fn frame_origin(&self) -> DVec3 {
        self.starts.frame_origin()
    }

    /// Where it begins and ends.
    ///
    /// # Errors
    /// A number that is not finite or beyond the limits.
    pub(crate) fn item(&self, index: usize) -> Checked<(Pose, Pose)> {
        let start = pose(&self.starts, index, Pose::at(self.frame_origin())).under("starts")?;
        Ok((start, pose(&self.ends, index, start).under("ends")?))
    }
}

/// The pose of an item; what no column says is that of `default`.
fn pose(poses: &Poses<'_>, index: usize, default: Pose) -> Checked<Pose> {
    let rotation: Option<DQuat> = poses.rotation(index)?;
    Ok(Pose::new(poses.position(index)?.unwrap_or(default.position), rotation.unwrap_or(default.rotation)))
}

fn subject(sent: Option<&pb::Geometry>, known: &Geometries) -> Checked<Arc<Geometry>> {
    let Some(sent) = sent else { return Ok(Arc::new(Geometry::point())) };
    let geometry = of_question(sent, known).under("geometry")?;
    check_bounded(&geometry, sent)?;
    Ok(geometry)
}

fn longest(poses: Option<&pb::PoseColumns>) -> (usize, usize) {
    let positions = poses.map_or(0, |poses| poses.positions.len() / 3);
    (positions.max(poses.map_or(0, |poses| poses.rotations.len() / 4)), 1)
}
