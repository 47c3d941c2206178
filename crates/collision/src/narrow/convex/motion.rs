//! Where a pair in a motion that turns is at a time, and what its speeds prove of the time between two instants.
//!
//! # Method
//! The course has the axes of the world, and its origin goes with the first form: the first form turns in place, the
//! second turns and goes in a straight line. Turns are given by one axis and one angle each, so the pose at any time is a
//! rotation by the angle's part: no steps add up. For the kernels the pair is taken into the first form's own axes of that
//! time, and what they find is turned back.
//!
//! Between two instants with proved gaps `s0` along `n0` and `s1` along `n1`, a time `h` apart, the pair is free if
//!
//! * `L·h < s0 + s1`, where no point comes nearer to another faster than `L`, or
//! * `K < (√s0 + √s1)²`, where `K = h²/2` times a bound of how fast the gap's speed changes, along a normal that
//!   goes from `n0` to `n1` at a constant speed.
//!
//! Proof of the second: let `n(t)` turn from `n0` to `n1` by the angle `φ` in their plane, with the speed `Ω = φ/h`, and let
//! `f = n·z` be the gap along it of one pair of points, where `z` is their difference. Then
//! `f″ = n″·z + 2n′·z′ + n·z″ = −Ω²f + 2n′·z′ + n·z″`, with `|n′·z′| ≤ Ω·(|v·m| + Σ|ω|ρ)` (`m` the direction of `n′`, `v` the
//! relative velocity, `ρ` the reach from the axis) and `|n·z″| ≤ Σω²ρ`. Let `M` be the sum without the first term. If `f`
//! went below 0, its least value `−μ` at the part `u` of the way would be at least
//! `(1−u)s0 + us1 − (M + Ω²μ)·u(1−u)h²/2`; for `φ < √8` this says that the chord lies below the parabola of `M` at `u`, which
//! is impossible for `M·h²/2 < (√s0 + √s1)²`. It holds for every pair of points, hence for the least of them: the gap
//! along `n(t)`. Radii around the cores do not turn and are taken off `s0` and `s1` beforehand.
//!
//! # Source
//! Mirtich, "Impulse-based dynamic simulation" (1996), section 2.3, and Zhang, Redon, Lee, Kim, "Continuous collision
//! detection for articulated models using Taylor models and temporal culling" (2007): bounds of the first order, which
//! converge linearly. The bound of the second order with a normal that turns is our own; it makes the advancement
//! converge as Newton's method does.

use glam::{DMat3, DVec3};

use super::{PlacedConvex, balls, frame::Pair, gjk};
use crate::{
    math::{Norm, Pose, try_unit},
    narrow::advance::{Instant, Paces},
    shape::Core,
    tolerance::{ANGLE_ROUNDING, BEND_WIDENING, LENGTH_WIDENING, MOTION_ROUNDING, PAIR_ROUNDING, ROUNDING},
};

/// How two forms turn, in the axes of the world.
pub(super) struct Swings {
    /// Rotation vectors over the whole motion.
    pub(super) turns: [DVec3; 2],
    /// From what each turns about to its own local origin at the start, metres.
    pub(super) arms: [DVec3; 2],
}

/// How one form turns.
struct Turn {
    /// Unit vector.
    axis: DVec3,
    /// Radians over the whole motion.
    angle: f64,
    start: DMat3,
    /// From what it turns about to its local origin at the start, in the frame.
    arm: DVec3,
    /// The farthest point of the core from the axis, in the frame, rounded up.
    reach: f64,
}

/// A pair in motion: the first form turns where it is, the second turns and goes by `−way`, over the time from 0 to 1. A
/// form with an arm turns about the end of that, so its local origin goes round too.
pub(super) struct Course<'a> {
    /// Where the pair is now.
    pub(super) pair: Pair<'a>,
    a: Turn,
    b: Turn,
    /// From what the first turns about to what the second does.
    start: DVec3,
    way: DVec3,
    /// The first form's axes now, and where the second is.
    axes: DMat3,
    place: DVec3,
    /// The arms now.
    arms: [DVec3; 2],
    /// What the turning adds to the speed of the fastest points.
    spin: f64,
    /// What the turning adds to the change of speed.
    bend: f64,
    /// What a gap may be off by, beyond what the kernels count.
    pub(super) rounding: f64,
}

impl Turn {
    fn new(core: &Core, pose: &Pose, [rotation, arm]: [DVec3; 2], scale: f64) -> Self {
        let axis = try_unit(rotation).unwrap_or(DVec3::Y);
        let start = pose.matrix();
        let reach = (reach_from(core, start.transpose() * axis) + axis.cross(arm).norm()) * scale;
        let angle = if reach > 0.0 { length(rotation) } else { 0.0 };
        Self { axis, angle, start, arm: arm * scale, reach: reach * LENGTH_WIDENING }
    }

    /// The axes of the form and its arm at a time.
    fn at(&self, time: f64) -> (DMat3, DVec3) {
        if self.angle == 0.0 {
            return (self.start, self.arm);
        }
        let turned = DMat3::from_axis_angle(self.axis, self.angle * time);
        (turned * self.start, turned * self.arm)
    }

    fn speed(&self) -> f64 {
        self.angle * self.reach
    }

    fn velocity(&self, arm: DVec3) -> DVec3 {
        self.axis.cross(arm) * self.angle
    }
}

impl<'a> Course<'a> {
    /// The course of a pair; `way` is how far `a` goes relative to `b`, metres.
    pub(super) fn new(a: PlacedConvex<'a>, b: PlacedConvex<'a>, way: DVec3, swings: &Swings) -> Self {
        // The first form without its rotation makes the axes those of the world.
        let upright = Pose::at(a.pose.position);
        let [turn_a, turn_b] = swings.turns;
        let [arm_a, arm_b] = swings.arms;
        // The ends of arms may go to the other side.
        let pair = Pair::of(
            [a.convex, b.convex],
            [&upright, b.pose],
            a.blur + b.blur,
            length(way) + 2.0 * (length(arm_a) + length(arm_b)),
        );
        let scale = pair.length_in(1.0);
        let turn_a = Turn::new(&a.convex.core, a.pose, [turn_a, arm_a], scale);
        let turn_b = Turn::new(&b.convex.core, b.pose, [turn_b, arm_b], scale);
        let spin = turn_a.speed() + turn_b.speed();
        Self {
            start: pair.b.position + (turn_a.arm - turn_b.arm),
            axes: turn_a.start,
            place: pair.b.position,
            arms: [turn_a.arm, turn_b.arm],
            way: pair.displacement_in(way),
            spin: spin * BEND_WIDENING,
            bend: (turn_a.angle * turn_a.speed() + turn_b.angle * turn_b.speed()) * BEND_WIDENING,
            rounding: MOTION_ROUNDING + ANGLE_ROUNDING * spin,
            pair,
            a: turn_a,
            b: turn_b,
        }
    }

    /// Puts the pair where it is at a time.
    pub(super) fn go_to(&mut self, time: f64) {
        let ((axes_a, arm_a), (axes_b, arm_b)) = (self.a.at(time), self.b.at(time));
        self.axes = axes_a;
        self.arms = [arm_a, arm_b];
        self.place = self.start - self.way * time + (arm_b - arm_a);
        let to_first = self.axes.transpose();
        self.pair.place_second(to_first * axes_b, to_first * self.place);
    }

    /// A vector of the pair, where it is now, in the axes of the course.
    pub(super) fn out(&self, vector: DVec3) -> DVec3 {
        self.axes * vector
    }

    /// No two points of the forms come nearer to each other by more than this, in the time 1.
    fn speed(&self) -> f64 {
        self.way.norm() * BEND_WIDENING + self.spin
    }

    /// The same of points on the radii around the cores, which a turn moves too though no gap feels it.
    pub(super) fn speed_of_surface(&self) -> f64 {
        self.speed() + self.a.angle * self.pair.a.radius + self.b.angle * self.pair.b.radius
    }

    /// What bounds the changes of the gap.
    pub(super) fn paces(&self) -> Paces {
        Paces {
            speed: self.speed(),
            bend: self.bend,
            turn: self.a.angle.max(self.b.angle),
            doubt: PAIR_ROUNDING + self.rounding,
        }
    }

    /// How fast the gap between two points of the cores grows along a direction, where the pair is now; all in the axes of
    /// the course.
    pub(super) fn growth(&self, direction: DVec3, on_a: DVec3, on_b: DVec3) -> f64 {
        let [arm_a, arm_b] = self.arms;
        let turning = self.a.velocity(on_a + arm_a) - self.b.velocity(on_b - self.place + arm_b);
        direction.dot(turning + self.way)
    }

    /// The gap along a direction where the pair is now, at `time`: one support pair.
    pub(super) fn along(&self, direction: DVec3, time: f64) -> Instant {
        let local = self.axes.transpose() * direction;
        let plane = local.dot(gjk::support(&self.pair, local).point) - PAIR_ROUNDING;
        Instant { time, free: plane - self.pair.radius() - self.rounding, normal: direction }
    }

    /// As [`Gaps::strain_between`](crate::narrow::advance::Gaps::strain_between).
    pub(super) fn strain_between(&self, from: &Instant, to: &Instant) -> f64 {
        if !(from.free > 0.0 && to.free > 0.0) {
            return f64::INFINITY;
        }
        let time = to.time - from.time;
        let straight = self.speed() * time * BEND_WIDENING / (from.free + to.free);
        if straight < 1.0 {
            return straight;
        }
        let turned = to.normal - from.normal;
        let chord_sq = turned.length_squared();
        // Of a quarter turn, whose chord is √2, the angle is not above the first term of its series by more than this.
        if chord_sq > 2.0 {
            return straight;
        }
        let angle = chord_sq.sqrt() * (1.0 + chord_sq / 16.0);
        let ahead = self.way.dot(from.normal).abs();
        let across = self.way.dot(turned).abs() + chord_sq * 0.5 * ahead + 8.0 * ROUNDING * self.way.norm();
        // The angle is not above 1 + angle²/4 times its sine.
        let swing = across * (1.0 + angle * angle * 0.25) + angle * (angle * ahead + self.spin);
        let bent = (swing + self.bend * time * 0.5) * time * BEND_WIDENING;
        let root = from.free.sqrt() + to.free.sqrt();
        straight.min(bent / (root * root) * BEND_WIDENING)
    }

    /// As [`balls::entry`], of balls about what the forms turn about.
    pub(super) fn entry_of_balls(&self) -> Option<f64> {
        let arms = (self.a.arm.norm() + self.b.arm.norm()) * LENGTH_WIDENING;
        balls::entry(self.start, self.pair.reach + arms, self.way, self.rounding)
    }

    /// How far the first form's local origin has gone round by a time, metres, in the axes of the world.
    pub(super) fn swing_of_first(&self, time: f64) -> DVec3 {
        (self.a.at(time).1 - self.a.arm) * self.pair.length_out(1.0)
    }
}

/// The length of a vector, however long or short it is.
fn length(vector: DVec3) -> f64 {
    let largest = vector.abs().max_element();
    if largest > 0.0 { largest * (vector / largest).norm() } else { 0.0 }
}

/// The farthest point of a core from an axis through its local origin, metres.
fn reach_from(core: &Core, axis: DVec3) -> f64 {
    let farthest =
        |points: &[DVec3]| points.iter().map(|&point| axis.cross(point).length_squared()).fold(0.0, f64::max).sqrt();
    let on_y = |half_height: f64| axis.cross(DVec3::Y * half_height).norm();
    match core {
        Core::Point => 0.0,
        Core::Segment { half_height } => on_y(*half_height),
        Core::Cuboid { half_extents: h } => {
            farthest(&[*h, DVec3::new(-h.x, h.y, h.z), DVec3::new(h.x, -h.y, h.z), DVec3::new(h.x, h.y, -h.z)])
        }
        Core::Hull(_) => core.reach(),
        Core::Triangle(corners) => farthest(corners),
        Core::Cylinder { half_height, radius } | Core::Cone { half_height, radius } => on_y(*half_height) + radius,
        Core::Ellipsoid { radii } => radii.max_element(),
    }
}
