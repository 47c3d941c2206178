//! The fixed order of a pair's arguments: by kind, then content, then pose, so that `(a, b)` and `(b, a)` run the same
//! computation.

use std::cmp::Ordering;

use glam::DVec3;

use super::PlacedConvex;
use crate::{math::Pose, shape::Core};

/// The two in their order, and whether they were swapped for it.
pub(super) fn in_order<'a>(a: PlacedConvex<'a>, b: PlacedConvex<'a>) -> (PlacedConvex<'a>, PlacedConvex<'a>, bool) {
    if is_swapped(a, b) { (b, a, true) } else { (a, b, false) }
}

/// Whether `b` goes before `a`.
pub(super) fn is_swapped(a: PlacedConvex<'_>, b: PlacedConvex<'_>) -> bool {
    let order = kind(&a.convex.core)
        .cmp(&kind(&b.convex.core))
        .then_with(|| content(&a.convex.core, &b.convex.core))
        .then_with(|| a.convex.radius.total_cmp(&b.convex.radius))
        .then_with(|| pose(a.pose, b.pose));
    order == Ordering::Greater
}

/// Boxes first: the frame of the pair is then the box's own, in which its support function is exact.
fn kind(core: &Core) -> u8 {
    match core {
        Core::Cuboid { .. } => 0,
        Core::Hull(_) => 1,
        Core::Triangle(_) => 2,
        Core::Cylinder { .. } => 3,
        Core::Cone { .. } => 4,
        Core::Ellipsoid { .. } => 5,
        Core::Segment { .. } => 6,
        Core::Point => 7,
    }
}

/// Orders cores of one kind.
fn content(a: &Core, b: &Core) -> Ordering {
    match (a, b) {
        (Core::Cuboid { half_extents: a }, Core::Cuboid { half_extents: b }) => points(&[*a], &[*b]),
        (Core::Segment { half_height: a }, Core::Segment { half_height: b }) => a.total_cmp(b),
        // Mostly the reach tells them apart, which is at hand.
        (Core::Hull(a), Core::Hull(b)) => {
            a.reach().total_cmp(&b.reach()).then_with(|| points(a.vertices(), b.vertices()))
        }
        (Core::Triangle(a), Core::Triangle(b)) => points(a, b),
        (Core::Cylinder { half_height: a, radius: r }, Core::Cylinder { half_height: b, radius: s })
        | (Core::Cone { half_height: a, radius: r }, Core::Cone { half_height: b, radius: s }) => {
            compare(&[*a, *r], &[*b, *s])
        }
        (Core::Ellipsoid { radii: a }, Core::Ellipsoid { radii: b }) => points(&[*a], &[*b]),
        _ => Ordering::Equal,
    }
}

fn points(a: &[DVec3], b: &[DVec3]) -> Ordering {
    let first_difference = a.iter().zip(b).find(|(p, q)| p != q);
    first_difference.map_or_else(|| a.len().cmp(&b.len()), |(p, q)| compare(&p.to_array(), &q.to_array()))
}

fn pose(a: &Pose, b: &Pose) -> Ordering {
    compare(&a.position.to_array(), &b.position.to_array())
        .then_with(|| compare(&a.rotation.to_array(), &b.rotation.to_array()))
}

/// Orders two lists of numbers as long as each other.
pub(super) fn compare(a: &[f64], b: &[f64]) -> Ordering {
    a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}
