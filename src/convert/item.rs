//! An item of a call with columns, as the single question that it stands for.
//!
//! # Method
//! The columns are read by what reads them for the call, so what is wrong with them is refused in the same words.

use wire::v1::{self as pb, column_item::Call, question::Question as Asked};

use super::{
    columns::Distances,
    places::{Places, Ways},
    rays::Rays,
    sight::Watched,
    trace,
};
use crate::{
    geometries::Geometries,
    problem::{Checked, Problem, Reason, Under},
};

/// The question of an item.
///
/// # Errors
/// What is wrong with the columns or the item; there is no such item; the call names a session.
pub(crate) fn asked(sent: &pb::ColumnItem, known: &Geometries) -> Checked<Asked> {
    let index = sent.index as usize;
    let Some(call) = &sent.call else {
        let what = "is absent: it is one of raycast_batch, overlap_batch, time_of_impact_batch, distance_batch, \
                    line_of_sight, such as {\"raycastBatch\": {\"directions\": [0, 0, 1]}}";
        return Err(Problem::at("call", Reason::Missing, what));
    };
    let (name, session, asked) = match call {
        Call::RaycastBatch(call) => ("raycast_batch", &call.session, ray(call, index)),
        Call::OverlapBatch(call) => ("overlap_batch", &call.session, overlap(call, index, known)),
        Call::TimeOfImpactBatch(call) => ("time_of_impact_batch", &call.session, way(call, index, known)),
        Call::DistanceBatch(call) => ("distance_batch", &call.session, distance(call, index, known)),
        Call::LineOfSight(call) => ("line_of_sight", &call.session, sight(call, index)),
    };
    if !session.is_empty() {
        let what = "must be left out: the session beside the item holds, as in {\"session\": \"arena\", \"item\": {}}";
        return Err(Problem::at(format!("{name}.session"), Reason::OutOfLimits, what));
    }
    asked.under(name)?.ok_or_else(|| {
        let what =
            format!("is {index}: the call has no such item; they are counted from 0, as in the columns of its answer");
        Problem::at("index", Reason::OutOfLimits, what)
    })
}

fn ray(call: &pb::RaycastBatchRequest, index: usize) -> Checked<Option<Asked>> {
    let rays = Rays::new(call)?;
    if index >= rays.len() {
        return Ok(None);
    }
    let (question, ignored) = rays.item(index)?;
    Ok(Some(trace::ray(call, &question.ray, ignored)))
}

fn overlap(call: &pb::OverlapBatchRequest, index: usize, known: &Geometries) -> Checked<Option<Asked>> {
    let mut places = Places::new(call.geometry.as_ref(), call.poses.as_ref(), &call.scales, 0, known)?;
    if index >= places.len() {
        return Ok(None);
    }
    let (_, pose) = places.item(index)?;
    Ok(Some(trace::overlap(call, index, &pose)))
}

fn way(call: &pb::TimeOfImpactBatchRequest, index: usize, known: &Geometries) -> Checked<Option<Asked>> {
    let ways = Ways::new(call, known)?;
    if index >= ways.len() {
        return Ok(None);
    }
    let (start, end) = ways.item(index)?;
    Ok(Some(trace::time_of_impact(call, &start, &end)))
}

fn distance(call: &pb::DistanceBatchRequest, index: usize, known: &Geometries) -> Checked<Option<Asked>> {
    let other_count = call.max_distances.len();
    let mut places = Places::new(call.geometry.as_ref(), call.poses.as_ref(), &[], other_count, known)?;
    let max_distances = Distances::new("max_distances", &call.max_distances, places.len())?;
    if index >= places.len() {
        return Ok(None);
    }
    let (_, pose) = places.item(index)?;
    Ok(Some(trace::distance(call, &pose, max_distances.item(index)?)))
}

fn sight(call: &pb::LineOfSightRequest, index: usize) -> Checked<Option<Asked>> {
    let watched = Watched::new(call)?;
    let (eye, point) = (index / watched.point_count(), index % watched.point_count());
    if eye >= watched.eye_count() {
        return Ok(None);
    }
    let Some(ray) = watched.sight(eye, point)?.ray() else {
        let what = "ends before the point: what is that far is not looked at; leave it out, or look farther";
        return Err(Problem::at("max_distances", Reason::OutOfLimits, what));
    };
    let target = (0..watched.target_count()).find(|&target| watched.points_of(target).contains(&point));
    Ok(target.map(|target| trace::sight(call, &ray, watched.own(eye, target))))
}
