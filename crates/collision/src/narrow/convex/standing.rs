//! What a convex form turns towards a plane.

use glam::DVec3;
use smallvec::SmallVec;

use super::{
    body::{Body, Corner},
    facing::facing,
    manifold::{Point, four, short},
};
use crate::shape::Convex;

/// The point of the core, in the form's own axes, that is lowest along `normal`.
pub(in crate::narrow) fn lowest(convex: &Convex, normal: DVec3) -> DVec3 {
    Body::in_own_axes(convex).support(DVec3::ZERO - normal).point
}

/// Corners of the face, edge or corner of the core that looks against `normal` (a unit vector in the form's own axes):
/// at most four, those that span it best, the lowest first. Each is named by 16 bits.
pub(in crate::narrow) fn feet(convex: &Convex, normal: DVec3) -> SmallVec<[Corner; 4]> {
    let body = Body::in_own_axes(convex);
    let down = DVec3::ZERO - normal;
    let (mut corners, lowest) = (facing(&body, down).corners, body.support(down));
    // The face that looks down best need not hold the lowest corner.
    if !corners.contains(&lowest) {
        corners.push(lowest);
    }
    let points = corners.into_iter().map(|corner| Point {
        on_a: corner.point,
        on_b: corner.point - normal * normal.dot(corner.point),
        beyond: 0.0,
        feature_pair: short(corner.index).into(),
    });
    let chosen = four(points.collect(), normal);
    chosen.into_iter().map(|point| Corner { point: point.on_a, index: point.feature_pair }).collect()
}
