//! Boxes and radii that surely hold a form: every rounding goes outwards.

use glam::{DMat3, DVec3};

use super::{Convex, Core, Form, Geometry, HalfSpace, Limits};
use crate::{
    math::{
        Aabb, Norm, Pose,
        directed::{add_down, add_up},
        larger,
    },
    tolerance::{LENGTH_WIDENING, ROTATED_COORDINATE},
};

/// The local box of a form; exact but for a radius around a core, which is rounded outwards.
pub(super) fn local_bounds(form: &Form) -> Aabb {
    match form {
        Form::Mesh(mesh) => mesh.bounds(),
        Form::Convex(convex) => convex.local_bounds(),
        Form::HalfSpace(half_space) => half_space.bounds(&Pose::IDENTITY),
        Form::Compound(compound) => compound.bounds(),
        Form::HeightField(field) => field.bounds(),
    }
}

/// The largest distance of a point of the form from the local origin, rounded up; of a half space, of a point of its box.
pub(super) fn reach(form: &Form) -> f64 {
    match form {
        Form::Mesh(mesh) => farthest(mesh.vertices()),
        Form::Convex(convex) => convex.reach(),
        Form::HalfSpace(_) => length_up(DVec3::splat(Limits::HALF_SPACE_BOX)),
        Form::Compound(compound) => compound.reach(),
        Form::HeightField(field) => length_up(field.bounds().min.abs().max(field.bounds().max.abs())),
    }
}

/// The box of a geometry at a pose.
#[inline]
pub(super) fn placed_bounds(geometry: &Geometry, pose: &Pose) -> Aabb {
    if let Form::Convex(convex) = geometry.form()
        && is_turned(pose)
    {
        return turned_convex(convex, geometry.reach(), pose);
    }
    if let Form::HalfSpace(half_space) = geometry.form() {
        return half_space.bounds(pose);
    }
    let local = geometry.local_bounds();
    let local = if is_turned(pose) { turned_box(&pose.matrix(), local) } else { local };
    sum(local, Aabb::new(pose.position, pose.position))
}

impl Convex {
    /// The box of this form at a pose, rounded outwards so that it surely holds every point.
    #[must_use]
    pub(crate) fn bounds(&self, pose: &Pose) -> Aabb {
        if is_turned(pose) {
            turned_convex(self, self.reach(), pose)
        } else {
            sum(self.local_bounds(), Aabb::new(pose.position, pose.position))
        }
    }

    /// The largest distance of a point of the form from the local origin, rounded up.
    #[must_use]
    pub(crate) fn reach(&self) -> f64 {
        let core = match &self.core {
            Core::Point => 0.0,
            Core::Segment { half_height } => *half_height,
            Core::Cuboid { half_extents } => length_up(*half_extents),
            Core::Hull(hull) => hull.reach_up(),
            Core::Triangle(corners) => farthest(corners),
            Core::Cylinder { half_height, radius } | Core::Cone { half_height, radius } => {
                length_up(DVec3::new(*radius, *half_height, 0.0))
            }
            Core::Ellipsoid { radii } => radii.max_element(),
        };
        add_up(core, self.radius)
    }

    /// The box of this form in its own frame, rounded outwards.
    pub(crate) fn local_bounds(&self) -> Aabb {
        let core = match &self.core {
            Core::Point => Aabb::new(DVec3::ZERO, DVec3::ZERO),
            Core::Segment { half_height } => symmetric(DVec3::new(0.0, *half_height, 0.0)),
            Core::Cuboid { half_extents } => symmetric(*half_extents),
            Core::Hull(hull) => hull.bounds(),
            Core::Triangle(corners) => around(corners),
            Core::Cylinder { half_height, radius } | Core::Cone { half_height, radius } => {
                symmetric(DVec3::new(*radius, *half_height, *radius))
            }
            Core::Ellipsoid { radii } => symmetric(*radii),
        };
        sum(core, symmetric(DVec3::splat(self.radius)))
    }
}

impl HalfSpace {
    /// The part of it within [`Limits::HALF_SPACE_BOX`] of the world's origin lies in this box: where the normal is along
    /// an axis and the pose not turned, it ends at the plane.
    fn bounds(&self, pose: &Pose) -> Aabb {
        let mut bounds = symmetric(DVec3::splat(Limits::HALF_SPACE_BOX));
        let across = self.normal.abs().max_position();
        let along = DVec3::AXES[across] * self.normal[across];
        if along != self.normal || is_turned(pose) {
            return bounds;
        }
        if along[across] > 0.0 {
            bounds.max[across] = add_up(pose.position[across], self.offset);
        } else {
            bounds.min[across] = add_down(pose.position[across], -self.offset);
        }
        bounds
    }
}

/// Any turn but that of a quaternion along w, which is none, exactly.
fn is_turned(pose: &Pose) -> bool {
    pose.rotation.xyz() != DVec3::ZERO
}

fn turned_convex(convex: &Convex, reach: f64, pose: &Pose) -> Aabb {
    let pad = symmetric(DVec3::splat(add_up(convex.radius, reach * ROTATED_COORDINATE)));
    // A ball has no turn to see, and the very same box.
    let is_ball = matches!(convex.core, Core::Point);
    let turned = if is_ball { pad } else { sum(turned_core(&pose.matrix(), &convex.core), pad) };
    sum(turned, Aabb::new(pose.position, pose.position))
}

fn turned_core(turn: &DMat3, core: &Core) -> Aabb {
    match core {
        Core::Point => Aabb::new(DVec3::ZERO, DVec3::ZERO),
        Core::Segment { half_height } => symmetric(turn.y_axis.abs() * *half_height),
        Core::Cuboid { half_extents } => symmetric(absolute(turn) * *half_extents),
        Core::Hull(hull) => turned_points(turn, hull.vertices()),
        Core::Triangle(corners) => turned_points(turn, corners),
        Core::Cylinder { half_height, radius } => {
            symmetric(turn.y_axis.abs() * *half_height + across_y(turn) * *radius)
        }
        Core::Cone { half_height, radius } => {
            let (apex, base) = (turn.y_axis * *half_height, across_y(turn) * *radius);
            Aabb::new(apex.min(DVec3::ZERO - apex - base), apex.max(base - apex))
        }
        Core::Ellipsoid { radii } => {
            let stretched = [turn.x_axis * radii.x, turn.y_axis * radii.y, turn.z_axis * radii.z];
            symmetric(DVec3::from_array([0, 1, 2].map(|row| DVec3::from_array(stretched.map(|axis| axis[row])).norm())))
        }
    }
}

/// For each axis of the world, how far a unit circle about the turned y axis reaches along it.
fn across_y(turn: &DMat3) -> DVec3 {
    DVec3::from_array(
        [0, 1, 2].map(|row| (turn.x_axis[row] * turn.x_axis[row] + turn.z_axis[row] * turn.z_axis[row]).sqrt()),
    )
}

fn turned_points(turn: &DMat3, points: &[DVec3]) -> Aabb {
    let nothing = Aabb::new(DVec3::INFINITY, DVec3::NEG_INFINITY);
    points.iter().fold(nothing, |found, &point| {
        let turned = *turn * point;
        found.union(Aabb::new(turned, turned))
    })
}

/// The farthest corner of the local box may lie √3 times as far out as the reach, so its own rounding is added here.
fn turned_box(turn: &DMat3, local: Aabb) -> Aabb {
    let center = *turn * local.center();
    let half = absolute(turn) * (local.max * 0.5 - local.min * 0.5);
    let pad = (local.min.abs().max(local.max.abs()).element_sum()) * ROTATED_COORDINATE;
    sum(Aabb::new(center, center), symmetric(half + pad))
}

fn absolute(turn: &DMat3) -> DMat3 {
    DMat3::from_cols(turn.x_axis.abs(), turn.y_axis.abs(), turn.z_axis.abs())
}

/// The largest distance of a point from the local origin, rounded up. The largest coordinate is taken out first, so that no square of
/// a point that may be the farthest vanishes.
pub(super) fn farthest(points: &[DVec3]) -> f64 {
    let largest = points.iter().fold(DVec3::ZERO, |largest, point| largest.max(point.abs())).max_element();
    if largest == 0.0 {
        return 0.0;
    }
    let squares = points.iter().map(|&point| (point / largest).length_squared());
    largest * squares.fold(0.0, larger).sqrt() * LENGTH_WIDENING
}

/// The box of points; exact.
pub(super) fn around(points: &[DVec3]) -> Aabb {
    let nothing = Aabb::new(DVec3::INFINITY, DVec3::NEG_INFINITY);
    let found = points.iter().fold(nothing, |found, &point| found.union(Aabb::new(point, point)));
    Aabb::new(found.min + DVec3::ZERO, found.max + DVec3::ZERO)
}

/// The box around boxes of which there is one at least.
pub(super) fn part_bounds(boxes: impl Iterator<Item = Aabb>) -> Aabb {
    boxes.reduce(Aabb::union).unwrap_or(Aabb::new(DVec3::ZERO, DVec3::ZERO))
}

/// The largest distance from the local origin of a part that reaches so far about its own, rounded up.
pub(super) fn farthest_of_part(position: DVec3, reach: f64) -> f64 {
    add_up(length_up(position), reach)
}

fn symmetric(half: DVec3) -> Aabb {
    Aabb::new(DVec3::ZERO - half, half)
}

/// The Minkowski sum, rounded outwards.
#[inline]
fn sum(a: Aabb, b: Aabb) -> Aabb {
    let lower = |axis: usize| add_down(a.min[axis], b.min[axis]) + 0.0;
    let upper = |axis: usize| add_up(a.max[axis], b.max[axis]) + 0.0;
    Aabb::new(DVec3::from_array([0, 1, 2].map(lower)), DVec3::from_array([0, 1, 2].map(upper)))
}

/// The length of a vector, rounded up.
pub(super) fn length_up(vector: DVec3) -> f64 {
    farthest(&[vector])
}
