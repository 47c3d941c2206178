//! Rays against boxes, hulls and flat polygons: clipping by planes, each with the error of the ray.
//!
//! # Method
//! A plane is met at `t = gap / speed`, off by at most `error / |speed|`. The body is met if every entry comes before every
//! exit. The two sides of one slab need no comparing: they are in order by construction, so that a plate without
//! thickness is surely hit where its middle is.
//!
//! # Source
//! Cyrus, Beck, "Generalized two- and three-dimensional clipping" (1978), with intervals for numbers.

use glam::DVec3;

use super::{
    crossing::{Crossing, Wall},
    frame::LocalRay,
};
use crate::{
    answer::{Bound, Method, Stop},
    math::{Norm, expansion::triangle_cross},
    shape::{Hull, Span},
};

/// Where the line crosses a box about the centre; `None` if surely nowhere. As [`Clip::slab`] for each axis, but which of two
/// sides is entered is a sign here, and which of three walls is the last or the first a number: no processor foresees them.
pub(super) fn cuboid(ray: &LocalRay, half_extents: DVec3) -> Option<Crossing> {
    let (mut entry, mut exit) = (First::new(), First::new());
    let mut certain = true;
    for axis in 0..3 {
        let error = if ray.is_still(axis) { 0.0 } else { ray.error };
        let (direction, foot, half) = (ray.direction[axis], ray.foot[axis], half_extents[axis]);
        let speed = direction.abs();
        let sign = 1.0_f64.copysign(direction);
        let (entry_gap, exit_gap) = (half + sign * foot, half - sign * foot);
        if speed * ray.extent <= error {
            let gap = entry_gap.min(exit_gap);
            if gap < -2.0 * error {
                return None;
            }
            certain &= gap >= 2.0 * error;
            continue;
        }
        let width = error / speed;
        // The entry is turned round, so that the first of three is wanted of both.
        let (entered, left) = (entry_gap / speed, exit_gap / speed);
        certain &= width - entered <= exit.bound.lower && -entry.bound.lower <= left - width;
        entry.take(entered, width, axis);
        exit.take(left, width, axis);
    }
    if -entry.bound.upper > exit.bound.upper {
        return None;
    }
    let wall = |bound: Bound, best: f64, axis: Option<usize>, turn: f64| {
        let (normal, face) = axis.map_or((DVec3::ZERO, None), |axis| {
            let sign = turn * 1.0_f64.copysign(ray.direction[axis]);
            (DVec3::AXES[axis] * sign, u32::try_from(2 * axis + usize::from(sign > 0.0)).ok())
        });
        Wall { bound, best, normal, face }
    };
    let turned = Bound::new(-entry.bound.upper, -entry.bound.lower);
    let clip = Clip {
        entry: wall(turned, -entry.best, entry.axis(), -1.0),
        exit: wall(exit.bound, exit.best, exit.axis(), 1.0),
        certain,
    };
    Some(clip.crossing(ray))
}

/// The first of the walls of up to three axes.
struct First {
    bound: Bound,
    best: f64,
    /// 3 if there is none.
    axis: usize,
}

impl First {
    fn new() -> Self {
        Self { bound: Bound::new(f64::INFINITY, f64::INFINITY), best: f64::INFINITY, axis: 3 }
    }

    fn take(&mut self, best: f64, width: f64, axis: usize) {
        let (lower, upper) = (best - width, best + width);
        self.bound = Bound { lower: self.bound.lower.min(lower), upper: self.bound.upper.min(upper) };
        self.axis = if best < self.best { axis } else { self.axis };
        self.best = if best < self.best { best } else { self.best };
    }

    fn axis(&self) -> Option<usize> {
        (self.axis < 3).then_some(self.axis)
    }
}

/// Where the line crosses a hull with faces; `None` if surely nowhere. `center` is what the ray is relative to.
pub(super) fn hull(ray: &LocalRay, hull: &Hull, center: DVec3) -> Option<Crossing> {
    let topology = hull.topology();
    if topology.span == Span::Polygon {
        let corners = topology.faces[0].vertices.iter().map(|&vertex| hull.vertices()[vertex as usize]);
        return polygon(ray, corners, center);
    }
    let mut clip = Clip::new();
    for (index, face) in topology.faces.iter().enumerate() {
        let corner = hull.vertices()[face.vertices[0] as usize] - center;
        let gap = face.normal.dot(corner - ray.foot);
        let speed = face.normal.dot(ray.direction);
        if !clip.is_beyond(speed, gap, ray.error) {
            clip.plane(
                ray,
                Side { normal: face.normal, speed, gap, error: ray.error, face: u32::try_from(index).ok() },
            )?;
        }
    }
    Some(clip.crossing(ray))
}

/// Where the line crosses a convex polygon in one plane, given by its corners in order, at least one.
pub(super) fn polygon(ray: &LocalRay, corners: impl Iterator<Item = DVec3> + Clone, center: DVec3) -> Option<Crossing> {
    let first = corners.clone().next()?;
    let normal = area_vector(corners.clone(), first).try_unit().unwrap_or(DVec3::ZERO);
    let gap = normal.dot(first - center - ray.foot);
    let side = |normal: DVec3, gap: f64, face: Option<u32>| Side {
        normal,
        speed: normal.dot(ray.direction),
        gap,
        error: ray.error,
        face,
    };
    let mut clip = Clip::new();
    clip.slab(ray, side(-normal, -gap, Some(1)), side(normal, gap, Some(0)))?;
    let followers = corners.clone().skip(1).chain([first]);
    for (corner, next) in corners.zip(followers) {
        let outwards = (next - corner).cross(normal).try_unit().unwrap_or(DVec3::ZERO);
        clip.plane(ray, side(outwards, outwards.dot(corner - center - ray.foot), None))?;
    }
    Some(clip.crossing(ray))
}

/// Twice the area, along the normal.
fn area_vector(corners: impl Iterator<Item = DVec3> + Clone, first: DVec3) -> DVec3 {
    let fan = corners.clone().zip(corners.skip(1)).map(|(a, b)| triangle_cross([first, a, b]));
    fan.sum()
}

/// Everything on one side of a plane.
struct Side {
    /// Outward unit normal.
    normal: DVec3,
    /// Of the ray along the normal, per metre.
    speed: f64,
    /// From the foot of the ray to the plane, along the normal.
    gap: f64,
    error: f64,
    face: Option<u32>,
}

/// What a plane says of a line.
enum Met {
    /// The line enters by it.
    Entry(Wall),
    /// The line leaves by it.
    Exit(Wall),
    /// The line is surely on the inner side all the way.
    Inside,
    /// The line runs so close to it that nothing is sure.
    Open,
}

impl Side {
    /// `None` if the line is surely outside. Distances are from the foot.
    fn meet(&self, ray: &LocalRay) -> Option<Met> {
        let speed = self.speed;
        if speed.abs() * ray.extent <= self.error {
            return match self.gap {
                gap if gap < -2.0 * self.error => None,
                gap if gap >= 2.0 * self.error => Some(Met::Inside),
                _ => Some(Met::Open),
            };
        }
        let (time, width) = (self.gap / speed, self.error / speed.abs());
        let wall =
            Wall { bound: Bound::new(time - width, time + width), best: time, normal: self.normal, face: self.face };
        Some(if speed < 0.0 { Met::Entry(wall) } else { Met::Exit(wall) })
    }
}

/// What is left of a line, from its foot.
struct Clip {
    entry: Wall,
    exit: Wall,
    certain: bool,
}

impl Clip {
    fn new() -> Self {
        let nowhere = |at: f64| Wall { bound: Bound::new(at, at), best: at, normal: DVec3::ZERO, face: None };
        Self { entry: nowhere(f64::NEG_INFINITY), exit: nowhere(f64::INFINITY), certain: true }
    }

    fn plane(&mut self, ray: &LocalRay, side: Side) -> Option<()> {
        match side.meet(ray)? {
            Met::Entry(wall) => self.clip(Some(wall), None),
            Met::Exit(wall) => self.clip(None, Some(wall)),
            Met::Inside => Some(()),
            Met::Open => {
                self.certain = false;
                Some(())
            }
        }
    }

    /// Whether all that is left of the line is surely on the inner side of a plane, and not near it: most planes of a hull
    /// cost a comparison instead of two divisions.
    fn is_beyond(&self, speed: f64, gap: f64, error: f64) -> bool {
        if speed < 0.0 {
            error - gap < self.entry.bound.lower * -speed
        } else {
            gap - error > self.exit.bound.upper * speed
        }
    }

    /// Two parallel planes, whose entry comes before their exit by construction.
    fn slab(&mut self, ray: &LocalRay, a: Side, b: Side) -> Option<()> {
        match (a.meet(ray)?, b.meet(ray)?) {
            (Met::Entry(entry), Met::Exit(exit)) | (Met::Exit(exit), Met::Entry(entry)) => {
                self.clip(Some(entry), Some(exit))
            }
            (Met::Inside, Met::Inside) => Some(()),
            _ => {
                self.certain = false;
                Some(())
            }
        }
    }

    /// Takes in walls of one slab; `None` if nothing can be left.
    fn clip(&mut self, entry: Option<Wall>, exit: Option<Wall>) -> Option<()> {
        let (old_entry, old_exit) = (self.entry, self.exit);
        if let Some(wall) = entry {
            self.certain &= wall.bound.upper <= old_exit.bound.lower;
            self.entry = later(old_entry, wall);
        }
        if let Some(wall) = exit {
            self.certain &= old_entry.bound.upper <= wall.bound.lower;
            self.exit = sooner(old_exit, wall);
        }
        (self.entry.bound.lower <= self.exit.bound.upper).then_some(())
    }

    fn crossing(self, ray: &LocalRay) -> Crossing {
        let moved = |wall: Wall| Wall {
            bound: Bound::new(wall.bound.lower + ray.shift - ray.error, wall.bound.upper + ray.shift + ray.error),
            best: wall.best + ray.shift,
            ..wall
        };
        let (mut entry, mut exit) = (moved(self.entry), moved(self.exit));
        if !self.certain {
            entry.bound.upper = entry.bound.upper.max(exit.bound.upper);
            exit.bound.lower = exit.bound.lower.min(entry.bound.lower);
        }
        Crossing {
            entry,
            exit,
            certain: self.certain,
            method: Method::ClosedForm,
            stop: Stop::Converged,
            iterations: 1,
        }
    }
}

fn later(a: Wall, b: Wall) -> Wall {
    let bound = Bound::new(a.bound.lower.max(b.bound.lower), a.bound.upper.max(b.bound.upper));
    let winner = if b.best > a.best { b } else { a };
    Wall { bound, ..winner }
}

fn sooner(a: Wall, b: Wall) -> Wall {
    let bound = Bound::new(a.bound.lower.min(b.bound.lower), a.bound.upper.min(b.bound.upper));
    let winner = if b.best < a.best { b } else { a };
    Wall { bound, ..winner }
}
