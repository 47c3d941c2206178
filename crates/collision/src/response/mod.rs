//! How bodies in contact bounce and are pushed apart: pure functions of contacts, masses and velocities. Nothing is
//! simulated, nothing is kept.
//!
//! # Method
//! Sequential impulses: each point of each contact in turn gets the impulse that brings its two sides to the wanted speed
//! along the normal, never pulling, and then the friction that stops them from sliding, at most `friction` times as much. A few passes over
//! all of them settle what they do to each other. Impulses act at one place on both bodies, in opposite directions, so that
//! momentum and angular momentum are kept to rounding. Positions are corrected by the same scheme, with lengths in place of
//! speeds and without turning.
//!
//! # Source
//! Catto, "Iterative Dynamics with Temporal Coherence" (GDC 2005) and "Fast and Simple Physics using Sequential Impulses"
//! (GDC 2006). Friction is bounded by a circle, not by a square.
//!
//! # Limits
//! With few passes, stacks and heavy bodies on light ones are not at rest. Bodies that touch in several points may gain or
//! lose some energy where a single point would not.

mod friction;

use glam::{DMat3, DVec3};
use smallvec::SmallVec;

use crate::math::Pose;

/// A body as impulses see it.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// One over its mass, 1/kg; 0 is a body that cannot be pushed.
    pub inverse_mass: f64,
    /// Of its inertia about its centre in the world's axes, 1/(kg m²); 0 is one that cannot be turned.
    pub inverse_inertia: DMat3,
    /// Centre of mass, world.
    pub center: DVec3,
    /// Of its centre, metres a second.
    pub velocity: DVec3,
    /// Radians a second about the world's axes.
    pub angular_velocity: DVec3,
}

impl Motion {
    /// A body of this mass in kg, at most turned by its `pose`, with moments of inertia in kg m² about the axes of its form
    /// through `center`, a place in its form; without moments it cannot be turned.
    #[must_use]
    pub fn of_body(pose: &Pose, mass: f64, center: DVec3, inertia: Option<DVec3>) -> Self {
        let turn = pose.matrix();
        let inverse_inertia =
            inertia.map_or(DMat3::ZERO, |inertia| turn * DMat3::from_diagonal(DVec3::ONE / inertia) * turn.transpose());
        Self {
            inverse_mass: 1.0 / mass,
            inverse_inertia,
            center: pose.position + turn * center,
            velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
        }
    }

    /// One that goes its way whatever meets it.
    #[must_use]
    pub fn unmoved(position: DVec3, velocity: DVec3, angular_velocity: DVec3) -> Self {
        Self { inverse_mass: 0.0, inverse_inertia: DMat3::ZERO, center: position, velocity, angular_velocity }
    }

    /// How fast a place of it moves.
    fn velocity_at(&self, point: DVec3) -> DVec3 {
        self.velocity + self.angular_velocity.cross(point - self.center)
    }

    fn push(&mut self, point: DVec3, impulse: DVec3) {
        self.velocity += impulse * self.inverse_mass;
        self.angular_velocity += self.inverse_inertia * (point - self.center).cross(impulse);
    }

    /// What an impulse at a place changes of the velocity there, as a matrix.
    fn yielding_at(&self, point: DVec3) -> DMat3 {
        let arm = point - self.center;
        let across = DMat3::from_cols(
            DVec3::new(0.0, arm.z, -arm.y),
            DVec3::new(-arm.z, 0.0, arm.x),
            DVec3::new(arm.y, -arm.x, 0.0),
        );
        DMat3::from_diagonal(DVec3::splat(self.inverse_mass)) - across * self.inverse_inertia * across
    }
}

/// A contact of two bodies.
#[derive(Clone, Debug)]
pub struct Touch {
    /// The first body, by its place in the list.
    pub a: usize,
    /// The other.
    pub b: usize,
    /// Unit vector from `b` to `a`.
    pub normal: DVec3,
    /// How deep they are in each other along it, metres.
    pub depth: f64,
    /// Where they touch.
    pub points: SmallVec<[DVec3; 4]>,
    /// 0 is ice.
    pub friction: f64,
    /// 0 does not bounce, 1 loses nothing.
    pub restitution: f64,
}

/// An impulse on `a` of a touch at one of its points; the opposite one acts on `b`.
#[derive(Clone, Copy, Debug)]
pub struct PointImpulse {
    /// Which touch.
    pub touch: usize,
    /// Where.
    pub point: DVec3,
    /// Along the normal, at least 0, newton seconds.
    pub normal_impulse: f64,
    /// Friction, across the normal.
    pub friction_impulse: DVec3,
}

/// A point while it is worked on.
struct Working {
    impulse: PointImpulse,
    /// Speed along the normal that is wanted, metres a second.
    wanted: f64,
    yielding: DMat3,
}

/// Gives bodies the impulses of their touches, `passes` times in turn, and says which: one for each point, in order. The
/// speed at which two bodies come apart at a point is at least `restitution` times that at which they met.
///
/// # Panics
/// A touch names a body that is not there.
#[must_use]
pub fn impulses(motions: &mut [Motion], touches: &[Touch], passes: u32) -> Vec<PointImpulse> {
    let mut working: Vec<Working> = Vec::new();
    for (index, touch) in touches.iter().enumerate() {
        let (a, b) = (&motions[touch.a], &motions[touch.b]);
        working.extend(touch.points.iter().map(|&point| {
            let closing = (b.velocity_at(point) - a.velocity_at(point)).dot(touch.normal);
            Working {
                impulse: PointImpulse { touch: index, point, normal_impulse: 0.0, friction_impulse: DVec3::ZERO },
                wanted: touch.restitution * closing.max(0.0),
                yielding: a.yielding_at(point) + b.yielding_at(point),
            }
        }));
    }
    for _ in 0..passes {
        for point in &mut working {
            point.work(motions, &touches[point.impulse.touch]);
        }
    }
    working.into_iter().map(|point| point.impulse).collect()
}

impl Working {
    fn work(&mut self, motions: &mut [Motion], touch: &Touch) {
        let point = self.impulse.point;
        let yields = touch.normal.dot(self.yielding * touch.normal);
        // Two bodies that cannot be pushed.
        if yields <= 0.0 {
            return;
        }
        let speed = speed_at(motions, touch, point).dot(touch.normal);
        let before = self.impulse.normal_impulse;
        self.impulse.normal_impulse = (before + (self.wanted - speed) / yields).max(0.0);
        push(motions, touch, point, touch.normal * (self.impulse.normal_impulse - before));
        let most = touch.friction * self.impulse.normal_impulse;
        let slides = speed_at(motions, touch, point);
        let before = self.impulse.friction_impulse;
        self.impulse.friction_impulse = friction::impulse(&self.yielding, touch.normal, slides, before, most);
        push(motions, touch, point, self.impulse.friction_impulse - before);
    }
}

/// How fast `a` moves at a point, seen from `b`.
fn speed_at(motions: &[Motion], touch: &Touch, point: DVec3) -> DVec3 {
    motions[touch.a].velocity_at(point) - motions[touch.b].velocity_at(point)
}

fn push(motions: &mut [Motion], touch: &Touch, point: DVec3, impulse: DVec3) {
    motions[touch.a].push(point, impulse);
    motions[touch.b].push(point, -impulse);
}

/// By how much to move each body so that what is deeper than `allowed_depth` is corrected by its `correction`, a part of it
/// from 0 to 1. The lighter body moves more; none turns.
///
/// # Panics
/// A touch names a body that is not there.
#[must_use]
pub fn corrections(
    motions: &[Motion],
    touches: &[Touch],
    allowed_depth: f64,
    correction: f64,
    passes: u32,
) -> Vec<DVec3> {
    let mut moved = vec![DVec3::ZERO; motions.len()];
    let mut pushed = vec![0.0_f64; touches.len()];
    for _ in 0..passes {
        for (touch, pushed) in touches.iter().zip(&mut pushed) {
            let (a, b) = (motions[touch.a].inverse_mass, motions[touch.b].inverse_mass);
            if a + b <= 0.0 {
                continue;
            }
            let wanted = (touch.depth - allowed_depth).max(0.0) * correction;
            let parted = (moved[touch.a] - moved[touch.b]).dot(touch.normal);
            let before = *pushed;
            *pushed = (before + (wanted - parted) / (a + b)).max(0.0);
            moved[touch.a] += touch.normal * ((*pushed - before) * a);
            moved[touch.b] -= touch.normal * ((*pushed - before) * b);
        }
    }
    moved
}
