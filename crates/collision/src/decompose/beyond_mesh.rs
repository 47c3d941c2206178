//! The mesh as the set that its parts reach beyond.
//!
//! # Method
//! Distances are those to its triangles, found by its tree. A closed mesh has an inside, which an exact count of windings
//! tells. A simplex whose middle is inside and that no triangle enters is inside as a whole; where triangles touch it from
//! without, what they may cut off by rounding is bounded ([`Subject::lid`]), so that hulls which share faces with
//! the mesh need no cells along them.

use std::ops::ControlFlow;

use glam::DVec3;

use super::{
    cell::Simplex,
    farthest::{Field, Near},
};
use crate::{
    answer::Work,
    broad::{ALL_LAYERS, Tree},
    math::{Aabb, Norm},
    shape::{Containment, Mesh, foot, radius_up},
    tolerance::{CELL_ROUNDING, LENGTH_WIDENING, LID_DEPTH, SQUARE_MIN},
};

/// A mesh whose parts are measured against it.
#[derive(Clone, Copy)]
pub(super) struct Subject<'a> {
    pub(super) mesh: &'a Mesh,
    /// It encloses a volume, which counts as its own.
    pub(super) is_solid: bool,
    /// Diagonal of its box.
    pub(super) diagonal: f64,
    /// Its farthest coordinate.
    pub(super) farthest: f64,
}

impl<'a> Subject<'a> {
    pub(super) fn new(mesh: &'a Mesh) -> Self {
        let farthest = |most: f64, vertex: &DVec3| most.max(vertex.abs().max_element());
        let bounds = mesh.tree().bounds().unwrap_or(Aabb::new(DVec3::ZERO, DVec3::ZERO));
        Self {
            mesh,
            is_solid: mesh.is_closed(),
            diagonal: (bounds.max - bounds.min).norm(),
            farthest: mesh.vertices().iter().fold(0.0, farthest),
        }
    }

    /// How far points are from the mesh at most: from one of its vertices.
    pub(super) fn surely_within(&self, points: &[DVec3]) -> f64 {
        let from = self.mesh.vertices().first().copied().unwrap_or_default();
        if self.is_measurable() {
            return radius_up(from, points);
        }
        points.iter().map(|&point| (point - from).abs().element_sum()).fold(0.0, f64::max) * LENGTH_WIDENING
    }

    /// Whether squares of its lengths have all their digits.
    pub(super) fn is_measurable(&self) -> bool {
        self.diagonal * self.diagonal >= SQUARE_MIN
    }

    /// How far what a triangle may cut off of a simplex, as seen from a point inside of that, reaches from the triangle; infinite
    /// unless that is all but nothing.
    fn cut_off(&self, simplex: &Simplex, center: DVec3, triangle: u32) -> f64 {
        let (radius, slack) = (radius_up(center, simplex.corners()), self.slack());
        let corners = self.mesh.corners(triangle as usize).map(|corner| corner - center);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_unit().unwrap_or_default();
        let mut least = f64::INFINITY;
        for direction in simplex.inward_normals().chain([normal, -normal]) {
            let base = simplex.corners().iter().map(|&corner| direction.dot(corner - center));
            let base = base.fold(f64::INFINITY, f64::min);
            let top = corners.iter().map(|corner| direction.dot(*corner)).fold(f64::NEG_INFINITY, f64::max);
            // Both heights are rounded, by less than this together.
            let depth = (top - base).max(0.0) + slack;
            let rest = -base - slack - depth;
            if depth <= self.diagonal * LID_DEPTH + slack && rest > depth {
                least = least.min(radius * (depth / rest));
            }
        }
        least
    }
}

impl Field for Subject<'_> {
    fn near(&self, point: DVec3, hint: u32, enough: f64, work: &mut Work) -> Near {
        let first = foot(point, self.mesh.corners(hint as usize));
        let mut near = Near { lower: first.lower, upper: first.upper, item: hint };
        if near.upper <= enough {
            return near;
        }
        let limit = near.upper;
        let Ok(()) = self.mesh.tree().visit_nearest(Aabb::new(point, point), limit, ALL_LAYERS, work, |work, leaf| {
            work.iterations += 1;
            let found = foot(point, self.mesh.corners(leaf as usize));
            near.lower = near.lower.min(found.lower);
            if found.upper < near.upper {
                (near.upper, near.item) = (found.upper, leaf);
            }
            Ok::<f64, std::convert::Infallible>(if near.upper <= enough { f64::NEG_INFINITY } else { near.upper })
        });
        near
    }

    fn upper_to(&self, point: DVec3, item: u32, _: &mut Work) -> f64 {
        foot(point, self.mesh.corners(item as usize)).upper
    }

    /// All of space is outside of a surface.
    fn side(&self, point: DVec3, work: &mut Work) -> Containment {
        if self.is_solid { self.mesh.contains(point, work) } else { Containment::Outside }
    }

    /// How far a simplex, of which the point `inside` lies there and has no surface nearer than `clear`, may reach out of the solid, if every triangle near it lies beyond one of
    /// its faces, or it beyond theirs, but for `LID_DEPTH`; infinite otherwise.
    ///
    /// Let `n` be the direction across which a triangle reaches into the simplex by `d` at most, and `h` how far the middle is from
    /// the simplex's border along it. What lies outside is reached from the middle through a triangle; on that way the height along
    /// `n` falls by `h − d` at least up to the triangle, so at most `d/(h − d)` of the way's length, the ball's radius, lies beyond.
    fn lid(&self, simplex: &Simplex, inside: DVec3, near: Near, target: f64, work: &mut Work) -> f64 {
        let (center, Near { lower: clear, item, .. }) = (simplex.mean(), near);
        let is_inside = radius_up(center, &[inside]) < clear || self.mesh.contains(center, work) == Containment::Inside;
        if !is_inside {
            return f64::INFINITY;
        }
        let mut reach = self.cut_off(simplex, center, item);
        if reach <= target {
            let around = simplex.bounds().inflated(self.diagonal * LID_DEPTH);
            self.mesh.near_box(around, work, |triangle| {
                reach = reach.max(self.cut_off(simplex, center, triangle as u32));
                if reach <= target { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            });
        }
        if reach <= target { reach } else { f64::INFINITY }
    }

    fn slack(&self) -> f64 {
        self.farthest * CELL_ROUNDING
    }
}
