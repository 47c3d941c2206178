//! The shortest way that leads far enough out along several directions at once.
//!
//! # Method
//! Walls are taken in turn. If the shortest way past those before is past the new one too, it stays. Else the shortest way past
//! all of them ends on the new wall, since the ways past a set of walls are convex and length is strictly so: it is found on
//! that plane by the same steps, then on a line, then at a point. A wall that cannot be passed with those before it, or only by a
//! way that is too long, is left out; so the first walls count most.
//!
//! # Source
//! R. Seidel, Small-Dimensional Linear Programming and Convex Hulls Made Easy (1991), with length for the objective and the
//! order of the caller for a random one: at most n³ steps for n walls.

use glam::DVec3;

use crate::{
    math::{Norm, try_unit},
    tolerance::{SAME_PLANE, SLIDE_SLACK},
};

/// A wall: a way is past it if it leads at least `least` metres along `normal`, a unit vector.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    pub(super) normal: DVec3,
    pub(super) least: f64,
}

impl Wall {
    fn is_passed_by(&self, way: DVec3) -> bool {
        self.normal.dot(way) >= self.least - SLIDE_SLACK * (self.least.abs() + way.norm())
    }
}

/// A way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WayOut {
    pub(super) way: DVec3,
    pub(super) past: Past,
}

/// What a way is past.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Past {
    /// All walls.
    All,
    /// Some cannot be passed.
    Some,
}

/// The shortest way past the walls, of at most `longest` metres.
pub(super) fn way_out(walls: &[Wall], longest: f64) -> WayOut {
    let mut kept: Vec<Wall> = Vec::new();
    let mut found = WayOut { way: DVec3::ZERO, past: Past::All };
    for wall in walls {
        if !wall.is_passed_by(found.way) {
            match on_plane(&kept, wall).filter(|way| way.norm() <= longest) {
                Some(way) => found.way = way,
                None => {
                    found.past = Past::Some;
                    continue;
                }
            }
        }
        // One of two walls that are the same but for rounding is enough.
        match kept.iter_mut().find(|known| (known.normal - wall.normal).norm() <= SAME_PLANE) {
            Some(known) => known.least = known.least.max(wall.least),
            None => kept.push(*wall),
        }
    }
    found
}

/// The shortest way past `walls` that ends on `wall`.
fn on_plane(walls: &[Wall], wall: &Wall) -> Option<DVec3> {
    let mut way = wall.normal * wall.least;
    for (index, other) in walls.iter().enumerate() {
        if !other.is_passed_by(way) && (other.normal - wall.normal).norm() > SAME_PLANE {
            way = on_line(&walls[..index], wall, other)?;
        }
    }
    Some(way)
}

/// The shortest way past `walls` that ends on two more; `None` if these are parallel.
fn on_line(walls: &[Wall], a: &Wall, b: &Wall) -> Option<DVec3> {
    let cross = a.normal.cross(b.normal);
    if cross.norm() <= SAME_PLANE {
        return None;
    }
    let along = try_unit(cross)?;
    let foot = (b.normal.cross(cross) * a.least + cross.cross(a.normal) * b.least) / cross.length_squared();
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    for wall in walls {
        let (slope, missing) = (wall.normal.dot(along), wall.least - wall.normal.dot(foot));
        if slope.abs() <= SAME_PLANE {
            if !wall.is_passed_by(foot) {
                return None;
            }
        } else if slope > 0.0 {
            from = from.max(missing / slope);
        } else {
            to = to.min(missing / slope);
        }
    }
    let step = 0.0_f64.max(from).min(to);
    let way = foot + along * step;
    walls.iter().all(|wall| wall.is_passed_by(way)).then_some(way)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(normal: DVec3, least: f64) -> Wall {
        Wall { normal: try_unit(normal).expect("a direction"), least }
    }

    #[test]
    fn out_of_a_floor_an_edge_and_a_corner() {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
        let way = |walls: &[Wall]| way_out(walls, 9.0);
        assert_eq!(way(&[]), WayOut { way: DVec3::ZERO, past: Past::All });
        assert_eq!(way(&[wall(y, 0.5), wall(y, 0.25)]).way, y * 0.5);
        assert_eq!(way(&[wall(y, 0.5), wall(x, 0.25), wall(z, -1.0)]).way, DVec3::new(0.25, 0.5, 0.0));
        assert_eq!(way(&[wall(y, 0.5), wall(x, 0.25), wall(-z, 1.0)]).way, DVec3::new(0.25, 0.5, -1.0));
        // Between two walls that face each other there is none: the first is passed.
        assert_eq!(way(&[wall(x, 0.5), wall(-x, 0.5)]), WayOut { way: x * 0.5, past: Past::Some });
        assert_eq!(way(&[wall(x, 10.0), wall(y, 1.0)]), WayOut { way: y, past: Past::Some });
    }

    /// Held against a search over many ways: none is shorter and past all walls.
    #[test]
    fn no_way_past_all_walls_is_shorter() {
        let mut state = 5_u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let (mut out, mut tight) = (0, 0);
        for case in 0..400 {
            let walls: Vec<Wall> = (0..1 + case % 7)
                .filter_map(|_| {
                    let normal = try_unit(DVec3::new(number(), number(), number() + 0.6))?;
                    Some(Wall { normal, least: number() })
                })
                .collect();
            let found = way_out(&walls, 1e3);
            let passed = walls.iter().filter(|wall| wall.normal.dot(found.way) >= wall.least - 1e-9).count();
            tight += usize::from(found.past == Past::Some);
            if found.past == Past::Some {
                continue;
            }
            assert_eq!(passed, walls.len(), "{walls:?} {found:?}");
            out += usize::from(found.way != DVec3::ZERO);
            for _ in 0..300 {
                let other = found.way + DVec3::new(number(), number(), number()) * 0.1;
                let is_past = walls.iter().all(|wall| wall.normal.dot(other) >= wall.least);
                assert!(!is_past || other.norm() >= found.way.norm() - 1e-9, "{other} is shorter: {walls:?} {found:?}");
            }
        }
        assert!(out > 200 && tight > 5, "vacuous: {out} {tight}");
    }
}
