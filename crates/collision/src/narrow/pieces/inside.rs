//! Whether a form lies inside a solid mesh, off its surface, or comes to do so in a terrain.
//!
//! # Method
//! Of a form that the surface does not cross, one point tells for all of it; of a mesh, one vertex of each of its connected
//! parts. The point is taken into the solid's frame, and all that it may be there must lie alike.

use std::ops::ControlFlow;

use glam::DVec3;
use smallvec::SmallVec;

use super::{Concave, Piece, Side, instant::at_instant, matter::Met};
use crate::{
    answer::Work,
    math::{Norm, Pose, exact::exact_difference},
    narrow::{Motion, Placed, place::Place},
    shape::{Containment, Convex, Core, Hull, Mesh, MeshMode, Standing},
    tolerance::RELATIVE_POSE,
};

/// 2⁻⁴⁰, the first of the steps at which an instant of overlap is sought: a later one is as good a proof.
const FIRST_STEP: f64 = 1.0 / (1_u64 << 40) as f64;

/// What is known of a pair of which one may be inside the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Held {
    /// This point of the world lies in both.
    Surely(DVec3),
    /// That is open.
    Open,
    /// No point that was asked about lies in the other form.
    No,
}

/// Whether one of two forms holds a point of the other. Pieces of a mesh are not asked: their mesh was.
pub(super) fn held(a: &Side<'_>, b: &Side<'_>, work: &mut Work) -> Held {
    let first = solid_of(b).map_or(Held::No, |(solid, mesh)| held_by(a, solid, mesh, work));
    if let Held::Surely(_) = first {
        return first;
    }
    match solid_of(a).map_or(Held::No, |(solid, mesh)| held_by(b, solid, mesh, work)) {
        Held::No => first,
        second => second,
    }
}

/// An instant after `time`, as a fraction of a motion, at which one of two forms surely holds a point of the other: of points
/// and plates triangles alone prove no touch. `None` if there is none among those asked, at growing steps.
pub(super) fn instant_held<'a>(
    a: Placed<'a>,
    b: Placed<'a>,
    motion: &Motion,
    time: f64,
    work: &mut Work,
) -> Option<f64> {
    let at_home = |placed: Placed<'_>| has_matter(&Side::of(placed.geometry, Place::of(placed.pose), None));
    if !at_home(a) && !at_home(b) {
        return None;
    }
    let mut ahead = FIRST_STEP;
    while ahead < 4.0 {
        let instant = (time + ahead).min(1.0);
        let [moved, stood] = at_instant(a, b, motion, instant);
        let is_held = matches!(held(&moved, &stood, work), Held::Surely(_));
        if is_held || lies_in_matter(&moved, &stood, work) || lies_in_matter(&stood, &moved, work) {
            return Some(instant);
        }
        ahead *= 4.0;
    }
    None
}

/// Whether points of another form may tell that it is in this one.
fn has_matter(side: &Side<'_>) -> bool {
    solid_of(side).is_some() || matches!(side, Side::Concave(concave) if concave.has_inside())
}

/// Whether a point of the first form surely lies in the matter of a terrain, the second.
fn lies_in_matter(form: &Side<'_>, terrain: &Side<'_>, work: &mut Work) -> bool {
    let Side::Concave(terrain) = terrain else { return false };
    matches!(Met::of_pair(terrain, form, work), Some(met) if matches!(met.standing, Standing::Inside(_)))
}

/// Where the middle of a convex form lies as to a solid mesh.
pub(super) fn middle_held(piece: &Piece<'_>, concave: &Concave<'_>, work: &mut Work) -> Held {
    match concave.as_mesh().filter(|mesh| mesh.mode() == MeshMode::Solid) {
        Some(mesh) => {
            let (middle, reach) = middle_and_reach(piece.convex);
            point_held((&piece.place, middle, reach), concave.place(), mesh, work)
        }
        None => Held::No,
    }
}

fn solid_of<'s, 'a>(side: &'s Side<'a>) -> Option<(&'s Concave<'a>, &'a Mesh)> {
    let Side::Concave(concave) = side else { return None };
    let mesh = concave.as_mesh().filter(|mesh| mesh.mode() == MeshMode::Solid)?;
    Some((concave, mesh))
}

fn held_by(inner: &Side<'_>, solid: &Concave<'_>, mesh: &Mesh, work: &mut Work) -> Held {
    let points: SmallVec<[(DVec3, f64); 4]> = match inner {
        Side::Convex(piece) if piece.facet.is_none() && !piece.skin => {
            SmallVec::from_slice(&[middle_and_reach(piece.convex)])
        }
        Side::Convex(_) | Side::Space(_) => SmallVec::new(),
        Side::Concave(concave) => match concave.as_mesh() {
            Some(mesh) => mesh.part_vertices().map(|vertex| (vertex, vertex.norm())).collect(),
            None => corner_of_skin(concave, work).into_iter().collect(),
        },
    };
    let mut known = Held::No;
    for (point, reach) in points {
        match point_held((inner.place(), point, reach), solid.place(), mesh, work) {
            Held::Surely(point) => return Held::Surely(point),
            Held::Open => known = Held::Open,
            Held::No => {}
        }
    }
    known
}

/// A corner of a body that is known by its skin, and how far out it lies; of a compound none, its parts are asked.
fn corner_of_skin(concave: &Concave<'_>, work: &mut Work) -> Option<(DVec3, f64)> {
    let mut found = None;
    if concave.has_inside() {
        concave.in_box(concave.geometry().local_bounds(), work, |piece, _| {
            if let Side::Convex(Piece { convex: Convex { core: Core::Triangle([corner, ..]), .. }, .. }) = piece {
                found = Some((*corner, corner.norm()));
            }
            ControlFlow::Break(())
        });
    }
    found
}

/// `reach` bounds what the point may be off by relative to its form's local origin.
fn point_held((place, point, reach): (&Place, DVec3, f64), solid: &Place, mesh: &Mesh, work: &mut Work) -> Held {
    let (pose, blur) = (&place.pose, place.blur + solid.blur);
    let (apart, lost) = exact_difference(pose.position, solid.pose.position);
    let to_local = solid.pose.matrix().transpose();
    let local = to_local * apart + to_local * (pose.matrix() * point);
    let is_turned = |pose: &Pose| pose.rotation.xyz() != DVec3::ZERO;
    let is_exact = lost == DVec3::ZERO
        && blur == 0.0
        && !is_turned(&solid.pose)
        && (point == DVec3::ZERO && reach == 0.0 || apart == DVec3::ZERO && !is_turned(pose));
    let error = if is_exact { 0.0 } else { RELATIVE_POSE * (apart.norm() + reach) + blur };
    match mesh.contains_ball(local, error, work) {
        Containment::Inside => Held::Surely(pose.transform_point(point) + DVec3::ZERO),
        Containment::Undecided => Held::Open,
        Containment::Outside => Held::No,
    }
}

/// The middle of a convex form, and what it may be off by in units of rounding; nothing at the local origin.
fn middle_and_reach(convex: &Convex) -> (DVec3, f64) {
    let middle = middle(convex);
    (middle, if middle == DVec3::ZERO && !matches!(convex.core, Core::Hull(_)) { 0.0 } else { convex.reach() })
}

/// A point of a convex form, to within a few roundings of its reach.
pub(super) fn middle(convex: &Convex) -> DVec3 {
    let mean = |points: &[DVec3]| points.iter().map(|&point| point / points.len() as f64).sum();
    let farthest = |hull: &Hull| {
        let along = |axis: DVec3| [hull.support(axis), hull.support(-axis)].map(|index| hull.vertex(index));
        DVec3::AXES.map(along)
    };
    match &convex.core {
        Core::Point
        | Core::Segment { .. }
        | Core::Cuboid { .. }
        | Core::Cylinder { .. }
        | Core::Cone { .. }
        | Core::Ellipsoid { .. } => DVec3::ZERO,
        Core::Hull(hull) => mean(farthest(hull).as_flattened()),
        Core::Triangle(corners) => mean(corners),
    }
}
