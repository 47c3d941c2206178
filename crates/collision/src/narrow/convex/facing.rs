//! The face, edge or corner with which a core looks along a direction.
//!
//! # Limits
//! The rim of a cylinder or a cone is an octagon of points on it: what is clipped by it may lose up to 8 % of the radius at
//! the arcs between.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::body::{Body, Corner};
use crate::{
    math::{Norm, exact},
    shape::{Core, Hull},
    tolerance::FLAT_CONTACT_SINE,
};

pub(super) type Corners = SmallVec<[Corner; 8]>;

/// A core's face, edge or corner that looks along a direction.
pub(super) struct Facing {
    pub(super) corners: Corners,
    /// Whether the corners lie flat across the direction.
    pub(super) is_flat: bool,
    /// Unit normal of a face, on either side of it; of an edge or a corner the direction itself.
    normal: DVec3,
}

impl Facing {
    fn corner(body: &Body<'_>, direction: DVec3) -> Self {
        Self { corners: smallvec![body.support(direction)], is_flat: false, normal: direction }
    }

    /// A face, with its normal, or the edge or corner that is left of it.
    fn face(corners: Corners, normal: DVec3, direction: DVec3) -> Self {
        let is_flat = normal.cross(direction).norm() <= FLAT_CONTACT_SINE;
        let normal = if corners.len() > 2 { normal } else { direction };
        Self { corners, is_flat, normal }
    }

    /// How far a point is from the plane of a flat face, along `direction`. Faces without area have no normal of their own: the
    /// plane across the direction stands for theirs.
    pub(super) fn height(&self, point: DVec3, direction: DVec3) -> f64 {
        let from_corner = point - self.corners[0].point;
        let cosine = self.normal.dot(direction);
        if cosine.abs() > 0.5 { self.normal.dot(from_corner) / cosine } else { direction.dot(from_corner) }
    }

    /// How much farther than `radius`, at most, the surface of the rounded core lies from the feature along `direction`: the
    /// surface over a face leans as the face does, so above one of its corners it may be higher than a ball's is.
    pub(super) fn beyond(&self, radius: f64, direction: DVec3) -> f64 {
        if radius == 0.0 || self.corners.len() == 1 {
            return 0.0;
        }
        if self.is_flat {
            return radius * (FLAT_CONTACT_SINE * FLAT_CONTACT_SINE);
        }
        let cosine = self.normal.dot(direction).abs();
        if cosine > 0.0 { radius * (1.0 / cosine - 1.0).max(0.0) } else { f64::INFINITY }
    }

    pub(super) fn is_flat_face(&self) -> bool {
        self.is_flat && self.corners.len() > 2
    }

    /// A flat face can be clipped against; a flat edge only by another flat edge beside it.
    pub(super) fn is_reference_for(&self, other: &Self) -> bool {
        if !self.is_flat || self.corners.len() < 2 {
            return false;
        }
        self.corners.len() > 2 || {
            let [p, q] = [self, other].map(|facing| {
                let ends = &facing.corners;
                (ends[ends.len() - 1].point - ends[0].point).try_unit().unwrap_or_default()
            });
            other.corners.len() == 2 && other.is_flat && p.cross(q).norm() <= FLAT_CONTACT_SINE
        }
    }
}

/// The face, edge or corner of a core that looks along `direction`.
pub(super) fn facing(body: &Body<'_>, direction: DVec3) -> Facing {
    match body.core {
        Core::Cuboid { half_extents } => cuboid_face(body, *half_extents, direction),
        Core::Hull(hull) => hull_face(body, hull, direction).unwrap_or_else(|| Facing::corner(body, direction)),
        Core::Segment { .. } if is_across(body.turn(DVec3::Y), direction) => {
            Facing { corners: smallvec![body.corner(0), body.corner(1)], is_flat: true, normal: direction }
        }
        Core::Cylinder { half_height, radius } => {
            let ends = [-*half_height, *half_height];
            round_face(body, direction, *radius, ends).unwrap_or_else(|| Facing::corner(body, direction))
        }
        Core::Cone { half_height, radius } => {
            cone_face(body, direction, *radius, *half_height).unwrap_or_else(|| Facing::corner(body, direction))
        }
        Core::Triangle(_) => {
            let corners: Corners = (0..3).map(|index| body.corner(index)).collect();
            let [a, b, c] = [0, 1, 2].map(|i: usize| corners[i].point);
            // A needle's normal must be right to its last digits: what it leans by lifts the plane at the far end.
            let normal = exact::cross(b - a, c - a).try_unit().unwrap_or_default();
            Facing::face(corners, normal, direction)
        }
        Core::Point | Core::Segment { .. } | Core::Ellipsoid { .. } => Facing::corner(body, direction),
    }
}

fn is_across(axis: DVec3, direction: DVec3) -> bool {
    axis.dot(direction).abs() <= FLAT_CONTACT_SINE
}

/// The rim of an end, as an octagon of points on it, or the line along the side of a cylinder.
fn round_face(body: &Body<'_>, direction: DVec3, radius: f64, [low, high]: [f64; 2]) -> Option<Facing> {
    let local = body.to_local(direction);
    let across = DVec3::new(local.x, 0.0, local.z);
    if across.norm() <= FLAT_CONTACT_SINE {
        return Some(rim(body, radius, if local.y > 0.0 { high } else { low }));
    }
    let side = across.try_unit().filter(|_| local.y.abs() <= FLAT_CONTACT_SINE)? * radius;
    Some(line(body, [side + DVec3::Y * low, side + DVec3::Y * high], direction))
}

/// The rim of the base, or the line from it to the apex.
fn cone_face(body: &Body<'_>, direction: DVec3, radius: f64, half_height: f64) -> Option<Facing> {
    let local = body.to_local(direction);
    let across = DVec3::new(local.x, 0.0, local.z);
    if across.norm() <= FLAT_CONTACT_SINE {
        return (local.y < 0.0).then(|| rim(body, radius, -half_height));
    }
    let (base, apex) = (across.try_unit()? * radius - DVec3::Y * half_height, DVec3::Y * half_height);
    let slant = (apex - base).try_unit()?;
    (slant.dot(local).abs() <= FLAT_CONTACT_SINE).then(|| line(body, [base, apex], direction))
}

/// Eight points of a circle about y, counter-clockwise as seen from above.
fn rim(body: &Body<'_>, radius: f64, height: f64) -> Facing {
    let slope = radius * std::f64::consts::FRAC_1_SQRT_2;
    let ring = [(radius, 0.0), (slope, -slope), (0.0, -radius), (-slope, -slope)];
    let ring = ring.into_iter().chain([(-radius, 0.0), (-slope, slope), (0.0, radius), (slope, slope)]);
    let corner = |(index, (x, z))| Corner { point: body.out(DVec3::new(x, height, z)), index };
    Facing { corners: (0..).zip(ring).map(corner).collect(), is_flat: true, normal: body.turn(DVec3::Y) }
}

fn line(body: &Body<'_>, ends: [DVec3; 2], direction: DVec3) -> Facing {
    let corner = |(index, point)| Corner { point: body.out(point), index };
    Facing { corners: (0..).zip(ends).map(corner).collect(), is_flat: true, normal: direction }
}

/// The face that looks along a direction most; of a plate seen along its plane, or of a stick, what is left of it.
fn cuboid_face(body: &Body<'_>, half_extents: DVec3, direction: DVec3) -> Facing {
    let local = body.to_local(direction);
    let size = local.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let high = u32::from(local[axis] > 0.0) << axis;
    let (second, third) = (1u32 << ((axis + 1) % 3), 1u32 << ((axis + 2) % 3));
    let mut lean = local;
    lean[axis] = 0.0;
    let mut flat = 0;
    for side in (0..3).filter(|&side| side != axis && half_extents[side] == 0.0) {
        flat |= 1u32 << side;
        lean[side] = 0.0;
    }
    let mut corners = Corners::new();
    for rest in [0, second, second | third, third] {
        if rest & flat == 0 {
            corners.push(body.corner(high | rest));
        }
    }
    let normal = if corners.len() > 2 { body.turn(DVec3::AXES[axis]) } else { direction };
    Facing { corners, is_flat: lean.norm() <= FLAT_CONTACT_SINE, normal }
}

fn hull_face(body: &Body<'_>, hull: &Hull, direction: DVec3) -> Option<Facing> {
    let local = body.to_local(direction);
    let face = hull.facing(local)?;
    let corners = face.vertices.iter().map(|&vertex| body.corner(vertex)).collect();
    Some(Facing::face(corners, body.turn(face.normal), direction))
}
