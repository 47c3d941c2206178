//! Where to cut a piece in two.
//!
//! # Method
//! Planes are tried through the point of the surface that is nearest to the part's farthest: the bottom of the deepest
//! hollow. They go along the axes, along the triangles there (of two boxes that meet in an edge, that cuts them apart), and
//! along the hollow's depth; and planes along the axes are tried at even steps. The best leaves the least volume (and, a
//! little, surface) in the hulls of both sides, with a small penalty on sides that differ.
//!
//! # Source
//! The hollow as where to cut: Lien, Amato, "Approximate convex decomposition of polyhedra" (2007). The cost: Mamou, "Volumetric
//! hierarchical approximate convex decomposition" (2016); the sum of hulls' volumes stands for the concavity.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    Cancelled,
    beyond_mesh::Subject,
    farthest::Farthest,
    meter::Meter,
    piece::{Cut, InPlane, Piece, Plane},
};
use crate::{
    math::{Aabb, Norm},
    shape::{Hull, foot},
    tolerance::CUT_SNAP,
};

/// Planes along each axis at even steps.
const STEPS: u32 = 9;

/// What surface counts beside volume, as a part of the piece's diagonal: flat pieces have no other.
const SURFACE_SHARE: f64 = 1.0 / 256.0;

/// What a difference in volume of the two sides costs, as a part of it.
const BALANCE_SHARE: f64 = 1.0 / 64.0;

/// Of more points than this some are measured only.
const MEASURED_WHOLE: usize = 128;

/// The best cut of a piece by its farthest point; `None` if none has both sides.
///
/// # Errors
/// The caller called it off.
pub(super) fn best_cut(
    subject: &Subject<'_>,
    piece: &Piece,
    found: &Farthest,
    meter: &mut Meter<'_>,
) -> Result<Option<Cut>, Cancelled> {
    let bounds = around(&piece.points);
    let diagonal = (bounds.max - bounds.min).norm();
    let mut best: Option<(f64, Cut)> = None;
    for cut in candidates(subject, bounds, found) {
        if meter.is_spent() && best.is_some() {
            break;
        }
        meter.pass()?;
        let Some(sides) = piece.points_of_sides(&cut) else { continue };
        meter.add(sides[0].len() + sides[1].len());
        let sizes = sides.map(|points| size(&points, diagonal));
        let cost = sizes[0] + sizes[1] + BALANCE_SHARE * (sizes[0] - sizes[1]).abs();
        if best.is_none_or(|(least, _)| cost.total_cmp(&least) == Ordering::Less) {
            best = Some((cost, cut));
        }
    }
    Ok(best.map(|(_, cut)| cut))
}

/// Volume of the hull of points, and a little of its surface; of many points, of the hull of those that lie farthest along some.
fn size(points: &[DVec3], diagonal: f64) -> f64 {
    let hull = if points.len() > MEASURED_WHOLE { Hull::new(&farthest_along(points)) } else { Hull::new(points) };
    hull.volume() + SURFACE_SHARE * diagonal * hull.surface_area()
}

/// The points farthest along the directions of whole numbers up to 2, both ways.
fn farthest_along(points: &[DVec3]) -> Vec<DVec3> {
    let mut found = Vec::new();
    for code in 63..125 {
        let direction = [code / 25, code / 5 % 5, code % 5].map(|part| part - 2);
        if direction.iter().all(|part| part % 2 == 0) {
            // Half of it comes as well.
            continue;
        }
        let [x, y, z] = direction.map(f64::from);
        let direction = DVec3::new(x, y, z);
        let (mut low, mut high) = ((f64::INFINITY, 0), (f64::NEG_INFINITY, 0));
        for (index, &point) in points.iter().enumerate() {
            let height = direction.dot(point);
            low = if height < low.0 { (height, index) } else { low };
            high = if height > high.0 { (height, index) } else { high };
        }
        found.extend([points[low.1], points[high.1]]);
    }
    found
}

fn around(points: &[DVec3]) -> Aabb {
    let (min, max) = points
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), &point| (min.min(point), max.max(point)));
    Aabb::new(min, max)
}

/// Cuts worth trying, the likeliest first: of equal ones the first is taken.
fn candidates(subject: &Subject<'_>, bounds: Aabb, found: &Farthest) -> Vec<Cut> {
    let corners = subject.mesh.corners(found.item as usize);
    let way = foot(found.point, corners).way;
    let bottom = found.point + way;
    let mut planes = Vec::new();
    let mut along_triangle = |triangle: usize| {
        let [a, b, c] = subject.mesh.corners(triangle);
        planes.extend(Plane::through(a, (b - a).cross(c - a)));
    };
    along_triangle(found.item as usize);
    for side in 0..3 {
        let across = subject.mesh.adjacency().across(found.item as usize, side);
        across.take(2).for_each(|(triangle, _)| along_triangle(triangle));
    }
    for axis in DVec3::AXES {
        planes.extend(Plane::through(bottom, axis));
        planes.extend(Plane::through(bottom, way.cross(axis)));
    }
    for (axis, normal) in DVec3::AXES.into_iter().enumerate() {
        for step in 1..=STEPS {
            let share = f64::from(step) / f64::from(STEPS + 1);
            let offset = bounds.min[axis] + (bounds.max[axis] - bounds.min[axis]) * share;
            planes.push(Plane { normal, offset });
        }
    }
    let snap = CUT_SNAP * bounds.min.abs().max(bounds.max.abs()).max_element();
    let cut = |plane: Plane, in_plane: InPlane| Cut { plane, snap, in_plane };
    let turned = |plane: Plane| Plane { normal: -plane.normal, offset: -plane.offset };
    if subject.is_solid {
        planes.into_iter().map(|plane| cut(plane, InPlane::Behind)).collect()
    } else {
        planes.into_iter().flat_map(|plane| [plane, turned(plane)]).map(|plane| cut(plane, InPlane::Ahead)).collect()
    }
}
