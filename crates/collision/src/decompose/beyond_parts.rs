//! Convex parts as the set that the mesh reaches beyond.

use glam::DVec3;

use super::{
    cell::Simplex,
    farthest::{Field, Near},
};
use crate::{
    accuracy::{Accuracy, Tier},
    answer::{Bound, Work},
    broad::{ALL_LAYERS, StaticTree, Tree},
    math::{Aabb, Pose},
    narrow::{Placed, distance},
    shape::{Containment, Geometry},
    tolerance::CELL_ROUNDING,
};

/// Convex parts, and a tree of their boxes.
pub(super) struct Parts<'a> {
    parts: &'a [Geometry],
    tree: StaticTree,
    point: Geometry,
    farthest: f64,
}

impl<'a> Parts<'a> {
    /// At least one part.
    pub(super) fn new(parts: &'a [Geometry]) -> Self {
        let boxes: Vec<Aabb> = parts.iter().map(Geometry::local_bounds).collect();
        let farthest = boxes.iter().map(|bounds| bounds.min.abs().max(bounds.max.abs()).max_element());
        let farthest = farthest.fold(0.0, f64::max);
        Self { parts, tree: StaticTree::build(&boxes), point: Geometry::point(), farthest }
    }

    fn distance(&self, point: DVec3, item: u32, limit: f64, work: &mut Work) -> Option<Bound> {
        let point = Placed { geometry: &self.point, pose: Pose::at(point) };
        let part = Placed { geometry: &self.parts[item as usize], pose: Pose::IDENTITY };
        Some(distance(point, part, limit, &Accuracy::of(Tier::Exact), work)?.certificate.bound)
    }
}

impl Field for Parts<'_> {
    fn near(&self, point: DVec3, hint: u32, enough: f64, work: &mut Work) -> Near {
        let unbounded = Bound::new(0.0, f64::INFINITY);
        let first = self.distance(point, hint, f64::INFINITY, work).unwrap_or(unbounded);
        let mut near = Near { lower: first.lower, upper: first.upper, item: hint };
        if near.upper <= enough {
            return near;
        }
        let limit = near.upper;
        let Ok(()) = self.tree.visit_nearest(Aabb::new(point, point), limit, ALL_LAYERS, work, |work, leaf| {
            if let Some(found) = self.distance(point, leaf, near.upper, work) {
                near.lower = near.lower.min(found.lower);
                if found.upper < near.upper {
                    (near.upper, near.item) = (found.upper, leaf);
                }
            }
            Ok::<f64, std::convert::Infallible>(if near.upper <= enough { f64::NEG_INFINITY } else { near.upper })
        });
        near
    }

    fn upper_to(&self, point: DVec3, item: u32, work: &mut Work) -> f64 {
        self.distance(point, item, f64::INFINITY, work).map_or(f64::INFINITY, |bound| bound.upper)
    }

    /// The distance is 0 in a part, so nothing need be known of an inside.
    fn side(&self, _: DVec3, _: &mut Work) -> Containment {
        Containment::Outside
    }

    fn lid(&self, _: &Simplex, _: DVec3, _: Near, _: f64, _: &mut Work) -> f64 {
        f64::INFINITY
    }

    fn slack(&self) -> f64 {
        self.farthest * CELL_ROUNDING
    }
}
