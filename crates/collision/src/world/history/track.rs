//! Where one shape was during a span of a few ticks.
//!
//! # Method
//! A track tells its placements in order, and by a bit for each tick when the next one began, so that finding that of a
//! tick is counting bits. Between ticks a shape goes as in a time of impact: its position in a straight line, its rotation
//! by constant angular velocity along the shorter arc.
//!
//! The box of a track holds the shape at every moment of the span. Between two placements a point goes on an arc, which
//! is nowhere farther than `θ²ρ/8` from where it would be if it went straight (the second derivative of the arc is at most
//! `θ²ρ`, the error of linear interpolation at most an eighth of that), and going straight it stays in the box of both ends.
//! With `d` the distance of the two unit quaternions, `θ/4 = asin(d/2) <= 1.1107·d/2` for the shorter arc, so `θ²/8` is at
//! most [`tolerance::ARC_HEIGHT`] times `d²`. And whatever turns stays within its ball.

use glam::DVec3;

use super::super::{Shape, search::outward, store::Slot};
use crate::{
    math::{Aabb, Norm, Pose},
    shape::{Form, Geometry, Limits},
    tolerance,
};

/// Ticks of a span, its first and the one after its last included: moments up to there are between two of them.
pub(super) const SPAN_TICKS: u64 = 8;

/// Where a shape was and how fast.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    pub(super) pose: Pose,
    pub(super) velocity: DVec3,
    pub(super) angular_velocity: DVec3,
}

impl Placement {
    /// That of a shape as it is.
    pub(super) fn of(shape: &Shape) -> Self {
        let Shape { pose, velocity, angular_velocity, .. } = *shape;
        Self { pose, velocity, angular_velocity }
    }
}

/// Where all else about the shape is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// In this slot of the state that the span is based on.
    Base(Slot),
    /// As [`Origin::Base`], and nothing about it changed from the span up to there.
    Still(Slot),
    /// Among the shapes that the span keeps, by index.
    Own(u32),
}

/// Where one shape was during a span, from its first to its last tick in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track {
    pub(super) origin: Origin,
    /// Ticks after the first of the span at which it was there first and last.
    pub(super) first: u8,
    pub(super) last: u8,
    /// Bit `n`: at tick `n` it has another placement than at the tick before.
    moved: u16,
    /// Of these, the ones that it did not go to.
    jumped: u16,
    /// Index of its first placement.
    start: u32,
}

/// How a shape came to a placement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arrival {
    /// From the placement before, all the way.
    Went,
    /// It was put there.
    Jumped,
}

impl Track {
    /// A shape that is first there at `first`; its placement is the next of `placements`.
    pub(super) fn new(origin: Origin, first: u8, placement: Placement, placements: &mut Vec<Placement>) -> Self {
        placements.push(placement);
        let start = (placements.len() - 1) as u32;
        Self { origin, first, last: first, moved: 0, jumped: 0, start }
    }

    /// A shape that is as in the base all the time.
    pub(super) fn still(slot: Slot, last: u8) -> Self {
        Self { origin: Origin::Still(slot), first: 0, last, moved: 0, jumped: 0, start: 0 }
    }

    /// Has another placement from the tick `at` on.
    pub(super) fn go(&mut self, at: u8, arrival: Arrival, placement: Placement, placements: &mut Vec<Placement>) {
        placements.push(placement);
        self.moved |= 1 << at;
        if arrival == Arrival::Jumped {
            self.jumped |= 1 << at;
        }
    }

    /// Whether it was there at a tick.
    pub(super) fn is_there(&self, at: u8) -> bool {
        (self.first..=self.last).contains(&at)
    }

    /// Where it was at a tick.
    pub(super) fn placement<'a>(&self, at: u8, placements: &'a [Placement]) -> &'a Placement {
        let up_to = self.moved & (u16::MAX >> (15 - at));
        &placements[self.start as usize + up_to.count_ones() as usize]
    }

    /// Where it was between a tick and the next.
    pub(super) fn pose(&self, at: u8, fraction: f64, placements: &[Placement]) -> Pose {
        let pose = self.placement(at, placements).pose;
        let next = 1_u16 << (at + 1);
        if fraction <= 0.0 || self.moved & next == 0 || self.jumped & next != 0 {
            return pose;
        }
        pose.between(&self.placement(at + 1, placements).pose, fraction)
    }

    /// Where it went from a tick to the next; `None` if it stood until then.
    pub(super) fn end(&self, at: u8, placements: &[Placement]) -> Option<Pose> {
        let next = 1_u16 << (at + 1);
        let went = self.moved & next != 0 && self.jumped & next == 0;
        went.then(|| self.placement(at + 1, placements).pose)
    }

    /// A box that holds its canonical box at every moment of the span.
    pub(super) fn bounds(&self, geometry: &Geometry, placements: &[Placement]) -> Aabb {
        let pose = self.placement(self.first, placements).pose;
        let mut before = (pose, geometry.bounds(&pose));
        let mut all = before.1;
        for at in self.first + 1..=self.last {
            if self.moved & (1 << at) == 0 {
                continue;
            }
            let pose = self.placement(at, placements).pose;
            let after = (pose, geometry.bounds(&pose));
            all = all.union(after.1);
            if self.jumped & (1 << at) == 0 {
                all = all.union(on_the_way(geometry, &before, &after));
            }
            before = after;
        }
        all
    }
}

/// A box that holds the canonical box of a shape at every moment between two poses, given the boxes at both.
fn on_the_way(geometry: &Geometry, (begin, box_begin): &(Pose, Aabb), (end, box_end): &(Pose, Aabb)) -> Aabb {
    let reach = match geometry.form() {
        Form::Convex(_) => geometry.reach(),
        // Its canonical box is that of its turned box, whose corners go beyond its points.
        Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_) => {
            let local = geometry.local_bounds();
            local.min.abs().max(local.max.abs()).norm() * tolerance::LENGTH_WIDENING
        }
        Form::HalfSpace(_) => {
            let farthest = DVec3::splat(Limits::HALF_SPACE_BOX);
            return Aabb::new(-farthest, farthest);
        }
    };
    let straight = box_begin.union(*box_end);
    let centers = Aabb::new(begin.position.min(end.position), begin.position.max(end.position));
    let farthest = centers.min.abs().max(centers.max.abs()).max_element() + reach;
    let rounding = farthest * tolerance::ON_THE_WAY;
    let arc = begin.chord_sq(end) * tolerance::ARC_HEIGHT * reach;
    let (near, ball) = (outward(straight, arc + rounding), outward(centers, reach + rounding));
    Aabb::new(near.min.max(ball.min), near.max.min(ball.max))
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    #[test]
    fn the_box_of_a_track_holds_it_at_every_moment() {
        let mut state = 3_u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let corners = [DVec3::X, DVec3::new(0.2, 1.0, 0.3), DVec3::Z, -DVec3::ONE];
        let forms = [
            Geometry::cuboid(DVec3::new(1.0, 0.1, 0.3)),
            Geometry::hull(&corners),
            Geometry::mesh(&corners, &[[0, 1, 2], [1, 2, 3]]),
            Geometry::sphere(0.7),
            Geometry::half_space(DVec3::Y, 0.5),
        ];
        let (mut needed_arc, mut tried) = (0, 0);
        for geometry in forms.map(|form| form.expect("a form")) {
            for case in 0..300 {
                let far = [0.0, 1e6, 1e12][case % 3];
                let turn = [0.0, 0.1, 3.0][case / 3 % 3];
                let mut place = |spread: f64| {
                    let position = DVec3::new(number(), number(), number()) * spread + far;
                    let rotation = DQuat::from_xyzw(number() * turn, number() * turn, number() * turn, 1.0);
                    Placement {
                        pose: Pose::new(position, rotation),
                        velocity: DVec3::ZERO,
                        angular_velocity: DVec3::ZERO,
                    }
                };
                let mut placements = Vec::new();
                let mut track = Track::new(Origin::Own(0), 0, place(0.3), &mut placements);
                track.go(1, Arrival::Went, place(0.3), &mut placements);
                track.go(3, Arrival::Jumped, place(9.0), &mut placements);
                track.last = 4;
                let bounds = track.bounds(&geometry, &placements);
                let ends = placements.iter().map(|placement| geometry.bounds(&placement.pose));
                let ends = ends.reduce(Aabb::union).expect("three");
                for step in 0..40 {
                    let pose = track.pose(step / 10, f64::from(step % 10) * 0.1, &placements);
                    let found = geometry.bounds(&pose);
                    assert!(bounds.contains(found), "{found:?} is not in {bounds:?}");
                    tried += 1;
                    needed_arc += usize::from(!ends.contains(found));
                }
            }
        }
        assert!(needed_arc * 100 > tried, "vacuous: {needed_arc} of {tried}");
    }

    #[test]
    fn a_track_is_where_it_was_put_last() {
        let place =
            |x: f64| Placement { pose: Pose::at(DVec3::X * x), velocity: DVec3::ZERO, angular_velocity: DVec3::ZERO };
        let mut placements = vec![place(-1.0)];
        let mut track = Track::new(Origin::Own(0), 1, place(1.0), &mut placements);
        track.go(3, Arrival::Went, place(3.0), &mut placements);
        track.go(4, Arrival::Jumped, place(9.0), &mut placements);
        track.go(8, Arrival::Went, place(8.0), &mut placements);
        track.last = 8;
        let at = |tick, fraction| track.pose(tick, fraction, &placements).position.x;
        assert_eq!((0..=8).map(|tick| track.is_there(tick)).filter(|is_there| *is_there).count(), 8);
        assert_eq!((1..=8).map(|tick| at(tick, 0.0)).collect::<Vec<_>>(), [1.0, 1.0, 3.0, 9.0, 9.0, 9.0, 9.0, 8.0]);
        assert_eq!([at(1, 0.5), at(2, 0.5), at(3, 0.5), at(7, 0.5)], [1.0, 2.0, 3.0, 8.5]);
    }
}
