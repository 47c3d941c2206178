//! Which way is left between planes that must not be crossed.

use glam::DVec3;
use smallvec::SmallVec;

use crate::{
    math::{Norm, try_unit},
    tolerance::{SAME_PLANE, SLIDE_SLACK},
};

/// Planes that what moves must not go into, each by its normal, which points to the free side.
#[derive(Debug, Default)]
pub(super) struct Planes {
    normals: SmallVec<[DVec3; 16]>,
}

impl Planes {
    /// Adds a plane; one that is there already is not added again.
    pub(super) fn add(&mut self, normal: DVec3) {
        if self.normals.iter().all(|known| (*known - normal).norm() > SAME_PLANE) {
            self.normals.push(normal);
        }
    }

    /// Whether a way goes into none of them.
    pub(super) fn allow(&self, way: DVec3) -> bool {
        let slack = -SLIDE_SLACK * way.norm();
        self.normals.iter().all(|normal| way.dot(*normal) >= slack)
    }

    /// The way nearest to `wish` that goes into none of the planes: the wish itself, its shadow on one plane, or on the line
    /// of two; nothing in a corner of three. Equally near ones: that of the planes added first.
    pub(super) fn slide(&self, wish: DVec3) -> DVec3 {
        if self.allow(wish) {
            return wish;
        }
        let mut best: Option<(f64, DVec3)> = None;
        let mut offer = |way: DVec3| {
            let off = (way - wish).norm();
            if best.is_none_or(|(nearest, _)| off < nearest) && self.allow(way) {
                best = Some((off, way));
            }
        };
        for (index, &normal) in self.normals.iter().enumerate() {
            if wish.dot(normal) >= 0.0 {
                continue;
            }
            offer(wish - normal * wish.dot(normal));
            for (other, &second) in self.normals.iter().enumerate() {
                if other != index
                    && let Some(line) = try_unit(normal.cross(second))
                {
                    offer(line * wish.dot(line));
                }
            }
        }
        best.map_or(DVec3::ZERO, |(_, way)| way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planes(normals: &[DVec3]) -> Planes {
        let mut planes = Planes::default();
        normals.iter().for_each(|&normal| planes.add(normal));
        planes
    }

    #[test]
    fn a_wish_goes_along_a_floor_along_an_edge_and_nowhere_in_a_corner() {
        let wish = DVec3::new(1.0, -2.0, -3.0);
        assert_eq!(planes(&[]).slide(wish), wish);
        assert_eq!(planes(&[DVec3::Y]).slide(wish), DVec3::new(1.0, 0.0, -3.0));
        assert_eq!(planes(&[DVec3::Y, DVec3::Z]).slide(wish), DVec3::new(1.0, 0.0, 0.0));
        assert_eq!(planes(&[DVec3::Y, DVec3::Z, DVec3::NEG_X]).slide(wish), DVec3::ZERO);
        assert_eq!(planes(&[DVec3::Y, DVec3::X]).slide(DVec3::NEG_Y), DVec3::ZERO);
    }

    /// No way that the planes allow is nearer to the wish: held against a search over many.
    #[test]
    fn no_way_that_is_allowed_is_nearer_to_the_wish() {
        let mut state = 5_u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut slid = 0;
        for case in 0..200 {
            let normals: Vec<DVec3> =
                (0..1 + case % 4).filter_map(|_| try_unit(DVec3::new(number(), number(), number()))).collect();
            let (planes, wish) = (planes(&normals), DVec3::new(number(), number(), number()));
            let way = planes.slide(wish);
            assert!(planes.allow(way));
            slid += usize::from(way != wish);
            for _ in 0..300 {
                let other = way + DVec3::new(number(), number(), number()) * 0.1;
                let nearer = (other - wish).norm() < (way - wish).norm() - 1e-9;
                let is_inside = normals.iter().all(|normal| other.dot(*normal) >= 0.0);
                assert!(!(nearer && is_inside), "{other} is nearer to {wish} than {way} between {normals:?}");
            }
        }
        assert!((60..190).contains(&slid), "{slid}");
    }
}
