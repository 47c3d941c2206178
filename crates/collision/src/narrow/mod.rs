//! One question to one pair: the kernels. Knows nothing of trees of shapes or of worlds.
//!
//! Every function here takes two placed geometries (or a ray and one), answers with an interval that holds the truth
//! for the numbers sent, and never returns NaN. Results are symmetric: swapping the arguments swaps the answer.

mod advance;
mod convex;
mod half_space;
mod ladder;
mod motion;
mod pieces;
mod place;
mod ray;

use glam::DVec3;
use smallvec::SmallVec;

use self::{convex::PlacedConvex, ladder::Climb};

pub use convex::Warm;
pub use ladder::distance_on;
pub use motion::{InitialTouch, Motion};
pub use pieces::{PartsWanted, parts_wanted};
pub use ray::{Faces, Ray, RayTouch, RayTouches, raycast};

pub(crate) use ray::{Aim, raycast_of};

use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Feature, Work},
    math::Pose,
    shape::{Form, Geometry, Simple},
};

/// A geometry at a pose.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// The form.
    pub geometry: &'a Geometry,
    /// Where it is.
    pub pose: Pose,
}

impl Placed<'_> {
    fn is_compound(&self) -> bool {
        matches!(self.geometry.form(), Form::Compound(_))
    }

    fn as_convex(&self) -> Option<PlacedConvex<'_>> {
        match self.geometry.form() {
            Form::Convex(convex) => Some(PlacedConvex::new(convex, &self.pose)),
            Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_) | Form::HalfSpace(_) => None,
        }
    }
}

/// A geometry at a pose that may have its form at hand, so that the geometry need not be read.
#[derive(Clone, Copy)]
pub(crate) struct Operand<'a> {
    pub(crate) placed: Placed<'a>,
    /// The same form, if it is simple.
    pub(crate) simple: Option<&'a Simple>,
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
    /// Where they touch: 1 to 4 points, deepest first.
    pub points: SmallVec<[ContactPoint; 4]>,
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
    /// Bounds of that depth: of how far apart the two surfaces are there, along the normal as it was returned.
    pub bound: Bound,
    /// Names the pair of features; the same from tick to tick while they are the same.
    pub feature_pair: u32,
}

/// Contacts of all pairs of convex pieces, in order of pieces.
pub type Contacts = SmallVec<[Contact; 1]>;

/// How deep two placed geometries are in each other.
#[derive(Clone, Copy, Debug)]
pub struct Depth {
    /// The best value, metres; negative is a gap.
    pub depth: f64,
    /// Unit vector from `b` to `a`: moving `a` by `normal * depth` parts the two.
    pub normal_b_to_a: DVec3,
    /// Deepest point of `a` in `b`, world frame; across a gap the nearest.
    pub point_on_a: DVec3,
    /// Deepest point of `b` in `a`, world frame.
    pub point_on_b: DVec3,
    /// What the depth is worth.
    pub certificate: Certificate,
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
    if let Some(pair) = half_space::Pair::of(&a, &b) {
        return pair.distance(limit, work);
    }
    if let Climb::Answered(found) = ladder::distance(&a, &b, limit, accuracy, work) {
        return found;
    }
    match (a.as_convex(), b.as_convex()) {
        (Some(a), Some(b)) => convex::distance(a, b, limit, accuracy, work),
        _ => pieces::distance(a, b, limit, accuracy, work),
    }
}

/// As [`distance`], of a form that may be at hand.
pub(crate) fn distance_of(
    a: Placed<'_>,
    b: Operand<'_>,
    limit: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Separation> {
    if let (Some(a), Some(simple)) = (a.as_convex(), b.simple) {
        let convex = simple.convex();
        let b = PlacedConvex::new(&convex, &b.placed.pose);
        return convex::distance(a, b, limit, accuracy, work);
    }
    distance(a, b.placed, limit, accuracy, work)
}

/// As [`distance`], beginning where the last question about this pair ended: see [`Warm`]. Concave forms remember nothing.
pub fn distance_warm(
    a: Placed<'_>,
    b: Placed<'_>,
    limit: f64,
    accuracy: &Accuracy,
    warm: &mut Warm,
    work: &mut Work,
) -> Option<Separation> {
    if let Some(pair) = half_space::Pair::of(&a, &b) {
        return pair.distance(limit, work);
    }
    match (a.as_convex(), b.as_convex()) {
        (Some(a), Some(b)) => convex::distance_warm(a, b, limit, accuracy, warm, work),
        _ => pieces::distance(a, b, limit, accuracy, work),
    }
}

/// Whether `a` and `b` touch; the bound is that of the signed distance, often one-sided. What lies in a solid mesh touches it.
pub fn overlap(a: Placed<'_>, b: Placed<'_>, accuracy: &Accuracy, work: &mut Work) -> Certificate {
    if let Some(pair) = half_space::Pair::of(&a, &b) {
        return pair.overlap(work);
    }
    if let Climb::Answered(found) = ladder::overlap(&a, &b, accuracy, work) {
        return found;
    }
    match (a.as_convex(), b.as_convex()) {
        (Some(a), Some(b)) => convex::overlap(a, b, accuracy, work),
        _ => pieces::overlap(a, b, accuracy, work),
    }
}

/// As [`overlap`], of a form that may be at hand.
pub(crate) fn overlap_of(a: Placed<'_>, b: Operand<'_>, accuracy: &Accuracy, work: &mut Work) -> Certificate {
    if let (Some(a), Some(simple)) = (a.as_convex(), b.simple) {
        let convex = simple.convex();
        let b = PlacedConvex::new(&convex, &b.placed.pose);
        return convex::overlap(a, b, accuracy, work);
    }
    overlap(a, b.placed, accuracy, work)
}

/// Whether two convex geometries, or a half space and any form but a compound, come within `margin` metres (at least 0) of each other; otherwise `None` if one is concave, whose
/// answer is that of [`distance`] with `margin` for its limit. The work ends as soon as this is proved either way, and the
/// bound, which is that of the signed distance, is as wide as it is then.
///
/// ```
/// use collision::{DVec3, accuracy::Accuracy, answer::{Verdict, Work}, math::Pose, narrow, shape::Geometry};
/// let ball = Geometry::sphere(1.0).unwrap();
/// let here = narrow::Placed { geometry: &ball, pose: Pose::IDENTITY };
/// let there = narrow::Placed { geometry: &ball, pose: Pose::at(DVec3::X * 3.0) };
/// let within = |margin| narrow::within(here, there, margin, &Accuracy::default(), &mut Work::default()).unwrap();
/// assert_eq!((within(0.9).verdict, within(1.1).verdict), (Verdict::Miss, Verdict::Hit));
/// ```
pub fn within(a: Placed<'_>, b: Placed<'_>, margin: f64, accuracy: &Accuracy, work: &mut Work) -> Option<Certificate> {
    if let Some(pair) = half_space::Pair::of(&a, &b) {
        return Some(pair.within(margin, work));
    }
    Some(convex::within(a.as_convex()?, b.as_convex()?, margin, accuracy, work))
}

/// How deep two convex geometries are in each other, without contact points. `None` if they are proved to be more than
/// `max_gap` metres apart, or if one is concave: see [`penetration`]. Half spaces are as in [`penetration`].
pub fn depth(a: Placed<'_>, b: Placed<'_>, max_gap: f64, accuracy: &Accuracy, work: &mut Work) -> Option<Depth> {
    if let Some(pair) = half_space::Pair::of(&a, &b) {
        return pair.depth(max_gap, work);
    }
    convex::depth(a.as_convex()?, b.as_convex()?, max_gap, accuracy, work)
}

/// Contacts of all pairs of convex pieces whose gap is not proved to be above `max_gap` metres, in order of pieces. Two half
/// spaces that no way parts have a contact whose depth is bounded below only.
///
/// A triangle of a mesh has the normals that the surface has there: its own, and on edges and corners that stick out those
/// between the faces that meet. Where another would be a shorter way out, which only parts the form from this one triangle,
/// the contact is told along the face there that is left soonest, and its depth and bounds are those along that normal. Across a
/// gap such a contact is left out, as a neighbour is nearer.
///
/// Triangles of one-sided and solid meshes push to their front, and only forms whose middle is before them: the local origin, of
/// a hull the mean of its farthest vertices along the axes. That of a half space lies far in its matter: it is felt by the triangles
/// whose front looks into it.
///
/// # Errors
/// [`NeedsDecomposition`] if both are meshes or compounds with such; if one is solid and the other has its middle in it (or may
/// have), or touches it only from behind; and the meshes bring no convex parts along that are enough. Where the accuracy names an
/// error, such parts can be made: [`parts_wanted`] says which, [`furnish`](crate::decompose::furnish) makes them.
pub fn penetration(
    a: Placed<'_>,
    b: Placed<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Result<Contacts, NeedsDecomposition> {
    if let Some(pair) = half_space::Pair::of(&a, &b) {
        return Ok(pair.penetration(max_gap, work));
    }
    match (a.as_convex(), b.as_convex()) {
        (Some(a), Some(b)) => Ok(contacts(convex::penetration(a, b, max_gap, accuracy, work))),
        _ => pieces::penetration(a, b, max_gap, accuracy, work),
    }
}

/// Those of one pair of pieces. A contact is large, and an iterator would hand it on twice.
#[inline]
fn contacts(found: Option<Contact>) -> Contacts {
    found.map_or_else(Contacts::new, |contact| Contacts::from_buf([contact]))
}

/// As [`penetration`], beginning where the last question about this pair ended: see [`Warm`]. Concave forms remember nothing.
///
/// # Errors
/// [`NeedsDecomposition`] if both are meshes or compounds with such.
pub fn penetration_warm(
    a: Placed<'_>,
    b: Placed<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    warm: &mut Warm,
    work: &mut Work,
) -> Result<Contacts, NeedsDecomposition> {
    if let Some(pair) = half_space::Pair::of(&a, &b) {
        return Ok(pair.penetration(max_gap, work));
    }
    match (a.as_convex(), b.as_convex()) {
        (Some(a), Some(b)) => Ok(contacts(convex::penetration_warm(a, b, max_gap, accuracy, warm, work))),
        _ => pieces::penetration(a, b, max_gap, accuracy, work),
    }
}

/// The first touch of `a` and `b` in motion; `None` is a proof that the way is free. Linear motions of convex forms are answered to
/// rounding at any accuracy; of those that turn, and of two concave forms that stand-ins may answer for, the interval is as wide as
/// `accuracy` allows.
///
/// Normals of a mesh are those that its surface has, as in [`penetration`]. What begins in a solid mesh touches it at the start.
/// A triangle of a one-sided mesh is touched only from its front, and, where neither turns, not by what goes along its front
/// or away from it: where one does, the side alone tells, at an edge as well. At the start it is touched only by what has its middle
/// before it. One that is touched from its back first is passed over for the rest of the motion, by each convex part and each triangle
/// of the other form for itself: another part may still touch its front. So are those of a solid mesh where the initial touch is
/// ignored: what begins inside leaves through its walls.
///
/// ```
/// use collision::{DVec3, accuracy::{Accuracy, Tier}, answer::Work, math::Pose, shape::Geometry};
/// use collision::narrow::{Motion, Placed, impact};
///
/// // A stick along y turns about z towards a ball whose top is at the height of its middle.
/// let (stick, ball) = (Geometry::capsule(1.0, 0.0)?, Geometry::sphere(0.25)?);
/// let stick = Placed { geometry: &stick, pose: Pose::IDENTITY };
/// let ball = Placed { geometry: &ball, pose: Pose::at(DVec3::new(-0.5, -0.25, 0.0)) };
/// let motion = Motion { rotation_a: DVec3::Z * 3.0, ..Motion::default() };
/// let touch = impact(stick, ball, &motion, &Accuracy::of(Tier::Exact), &mut Work::default()).expect("they meet");
/// // The stick's upper half lies along −x a quarter turn later: then it touches the ball from above.
/// assert!((touch.fraction * 3.0 - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
/// # Ok::<(), collision::shape::GeometryError>(())
/// ```
pub fn impact(
    a: Placed<'_>,
    b: Placed<'_>,
    motion: &Motion,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<ImpactTouch> {
    impact_of(a, Operand { placed: b, simple: None }, motion, 1.0, accuracy, work)
}

/// As [`impact`], of a form that may be at hand; also `None` where it is cheaply proved that there is no touch up to the fraction `limit` of
/// the motion.
pub(crate) fn impact_of(
    a: Placed<'_>,
    b: Operand<'_>,
    motion: &Motion,
    limit: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<ImpactTouch> {
    if let (Some(a), Some(simple)) = (a.as_convex(), b.simple) {
        let convex = simple.convex();
        let b = PlacedConvex::new(&convex, &b.placed.pose);
        return convex::impact(a, b, motion, [DVec3::ZERO; 2], accuracy, work);
    }
    let b = b.placed;
    if let Some(pair) = half_space::Pair::of(&a, &b) {
        return pair.impact(motion, accuracy, work);
    }
    if let Climb::Answered(found) = ladder::impact(&a, &b, motion, limit, accuracy, work) {
        return found;
    }
    match (a.as_convex(), b.as_convex()) {
        (Some(a), Some(b)) => convex::impact(a, b, motion, [DVec3::ZERO; 2], accuracy, work),
        _ => pieces::impact(a, b, motion, accuracy, work),
    }
}

/// The question needs convex parts, which a mesh, be it part of a compound, does not have yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("both geometries have meshes without convex parts, or one is a solid mesh that the other is deep in")]
pub struct NeedsDecomposition;
