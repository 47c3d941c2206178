//! One question to one pair: the kernels. Knows nothing of trees of shapes or of worlds.
//!
//! Every function here takes two placed geometries (or a ray and one), answers with an interval that holds the truth
//! for the numbers sent, and never returns NaN. Results are symmetric: swapping the arguments swaps the answer.

mod convex;
mod pieces;
mod ray;

use glam::DVec3;

use convex::PlacedConvex;

pub use ray::{Ray, RayTouch, RayTouches, raycast};

use crate::{
    accuracy::Accuracy,
    answer::{Certificate, Feature, Work},
    math::Pose,
    shape::{Form, Geometry},
};

/// A geometry at a pose.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// The form.
    pub geometry: &'a Geometry,
    /// Where it is.
    pub pose: Pose,
}

impl<'a> Placed<'a> {
    fn as_convex(&self) -> Option<PlacedConvex<'a>> {
        match self.geometry.form() {
            Form::Convex(convex) => Some(PlacedConvex { convex, pose: self.pose }),
            Form::Mesh(_) => None,
        }
    }
}

/// How far apart two placed geometries are.
#[derive(Clone, Copy, Debug)]
pub struct Separation {
    /// The best value, metres; 0 where they overlap.
    pub distance: f64,
    /// Nearest point of `a`, world frame.
    pub point_on_a: DVec3,
    /// Nearest point of `b`, world frame.
    pub point_on_b: DVec3,
    /// Unit vector from `b` to `a`; `None` at distance 0.
    pub normal_b_to_a: Option<DVec3>,
    /// Where on `a`.
    pub feature_a: Feature,
    /// Where on `b`.
    pub feature_b: Feature,
    /// What the distance is worth; `Hit` where the distance is proved to be within the limit asked.
    pub certificate: Certificate,
}

/// A contact of two convex pieces.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Unit vector from `b` to `a`: moving `a` by `normal * depth` parts the two pieces.
    pub normal_b_to_a: DVec3,
    /// The best value, metres; negative is a gap.
    pub depth: f64,
    /// Where they touch: 1 to 4 points.
    pub points: Vec<ContactPoint>,
    /// The piece of `a`.
    pub feature_a: Feature,
    /// The piece of `b`.
    pub feature_b: Feature,
    /// What the depth is worth.
    pub certificate: Certificate,
}

/// A point of a contact, world frame.
#[derive(Clone, Copy, Debug)]
pub struct ContactPoint {
    /// On `a`.
    pub point_on_a: DVec3,
    /// On `b`.
    pub point_on_b: DVec3,
    /// Depth along the normal; negative is a gap.
    pub depth: f64,
    /// Names the pair of features; the same from tick to tick while they are the same.
    pub feature_pair: u32,
}

/// The first touch of two moving geometries. `Miss` is never returned in it: that is `None`.
#[derive(Clone, Copy, Debug)]
pub struct ImpactTouch {
    /// Fraction of the motion, 0 to 1: the best value.
    pub fraction: f64,
    /// Where, world frame.
    pub point: DVec3,
    /// Unit vector from `b` to `a`; `None` if they overlap at the start deeper than rounding.
    pub normal_b_to_a: Option<DVec3>,
    /// They touch at the start.
    pub initial: bool,
    /// Where on `b`.
    pub feature_b: Feature,
    /// What the fraction is worth.
    pub certificate: Certificate,
}

/// How far apart `a` and `b` are. `None` if that is proved to be beyond `limit` metres.
pub fn distance(a: Placed<'_>, b: Placed<'_>, limit: f64, accuracy: &Accuracy, work: &mut Work) -> Option<Separation> {
    match (a.as_convex(), b.as_convex()) {
        (Some(a), Some(b)) => convex::distance(a, b, limit, accuracy, work),
        _ => pieces::distance(a, b, limit, accuracy, work),
    }
}

/// Whether `a` and `b` touch; the bound is that of the signed distance, often one-sided.
pub fn overlap(a: Placed<'_>, b: Placed<'_>, accuracy: &Accuracy, work: &mut Work) -> Certificate {
    match (a.as_convex(), b.as_convex()) {
        (Some(a), Some(b)) => convex::overlap(a, b, accuracy, work),
        _ => pieces::overlap(a, b, accuracy, work),
    }
}

/// Contacts of all pairs of convex pieces whose gap is not proved to be above `max_gap` metres, in order of pieces.
///
/// # Errors
/// [`NeedsDecomposition`] if both are meshes.
pub fn penetration(
    a: Placed<'_>,
    b: Placed<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Result<Vec<Contact>, NeedsDecomposition> {
    match (a.as_convex(), b.as_convex()) {
        (Some(a), Some(b)) => Ok(convex::penetration(a, b, max_gap, accuracy, work).into_iter().collect()),
        _ => pieces::penetration(a, b, max_gap, accuracy, work),
    }
}

/// How two geometries move over the time from 0 to 1, each from its pose in a straight line and without turning.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// How far `a` goes, metres.
    pub displacement_a: DVec3,
    /// How far `b` goes, metres.
    pub displacement_b: DVec3,
    /// What becomes of a touch at the start.
    pub initial: InitialTouch,
}

/// What becomes of pieces that touch at the start of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InitialTouch {
    /// It is the first touch, at time 0.
    #[default]
    Counts,
    /// It is passed over until they are clear of each other, which convex pieces then stay.
    IsIgnored,
}

/// The first touch of `a` and `b` in motion; `None` is a proof that the way is free.
pub fn linear_impact(
    a: Placed<'_>,
    b: Placed<'_>,
    motion: &Motion,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<ImpactTouch> {
    match (a.as_convex(), b.as_convex()) {
        (Some(a), Some(b)) => convex::linear_impact(a, b, motion, accuracy, work),
        _ => pieces::linear_impact(a, b, motion, accuracy, work),
    }
}

/// The question needs convex parts, which a mesh does not have yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("both geometries are meshes without convex parts")]
pub struct NeedsDecomposition;
