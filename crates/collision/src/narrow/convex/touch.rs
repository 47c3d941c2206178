//! Exact touch of forms that are not turned.
//!
//! # Method
//! Points, segments along y and boxes, unturned, are boxes along the axes, flat ones among them. With any radii around
//! them they touch if the squared gaps of the three axes sum up to no more than the square of the radii: sums and products
//! of what was sent, whose sign is found exactly. So a crate that stands on a floor, or two balls side by side, are not
//! left open within rounding, as they would be otherwise.
//!
//! # Source
//! Shewchuk (1997), by [`crate::math::expansion`].
//!
//! # Limits
//! Turned forms and hulls: their touch stays open within rounding.

use std::cmp::Ordering;

use glam::DVec3;

use super::PlacedConvex;
use crate::{math::expansion::Expansion, shape::Core};

/// The exact sign of the signed distance of two forms: `Greater` apart, `Equal` touching, `Less` overlapping. `None` if
/// one of them is turned, is not known to be just where its pose says, or is none of the simple ones.
pub(super) fn sign(a: PlacedConvex<'_>, b: PlacedConvex<'_>) -> Option<Ordering> {
    if a.blur + b.blur > 0.0 {
        return None;
    }
    let (half_a, half_b) = (half_extents(a)?, half_extents(b)?);
    let gaps = [0, 1, 2].map(|axis| {
        let apart = Expansion::difference(a.pose.position[axis], b.pose.position[axis]);
        let mut gap = if apart.sign() == Ordering::Less { apart.negated() } else { apart };
        gap.add(-half_a[axis]);
        gap.add(-half_b[axis]);
        gap
    });
    let mut radius = Expansion::default();
    radius.add(a.convex.radius);
    radius.add(b.convex.radius);
    let widest = gaps.iter().map(Expansion::sign).max()?;
    if widest != Ordering::Greater {
        return Some(if radius.sign() == Ordering::Greater { Ordering::Less } else { widest });
    }
    // Without a radius there is nothing to square, which would lose what is very small.
    if radius.sign() == Ordering::Equal {
        return Some(widest);
    }
    let mut excess = Expansion::default();
    excess.add_product(&radius.negated(), &radius);
    for gap in gaps.iter().filter(|gap| gap.sign() == Ordering::Greater) {
        excess.add_product(gap, gap);
    }
    Some(excess.sign())
}

/// Half extents of a core that is a box along the axes.
fn half_extents(placed: PlacedConvex<'_>) -> Option<DVec3> {
    let is_turned = placed.pose.rotation.xyz() != DVec3::ZERO;
    match &placed.convex.core {
        Core::Point => Some(DVec3::ZERO),
        Core::Segment { half_height } if !is_turned => Some(DVec3::new(0.0, *half_height, 0.0)),
        Core::Cuboid { half_extents } if !is_turned => Some(*half_extents),
        Core::Segment { .. }
        | Core::Cuboid { .. }
        | Core::Hull(_)
        | Core::Triangle(_)
        | Core::Cylinder { .. }
        | Core::Cone { .. }
        | Core::Ellipsoid { .. } => None,
    }
}
