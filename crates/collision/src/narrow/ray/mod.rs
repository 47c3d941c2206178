//! Where a ray meets a geometry.
//!
//! # Method
//! The ray is taken into the frame of its target, with a bound on what that costs ([`frame`]); each form then has its own
//! formula. Convex bodies answer with the stretch of the line inside them, from which [`crossing`] reads what the ray
//! touches; meshes are searched by their tree.
//!
//! # Never
//! A miss that is not proved: what rounding leaves open is an undecided touch.

mod advance;
mod compound;
mod cone;
mod crossing;
mod cylinder;
mod ellipsoid;
mod frame;
mod half_space;
mod height_field;
mod mesh;
mod nearest;
mod polytope;
mod round;
mod rounded;
mod sieve;
mod solid;
mod stretch;
mod surface;
mod triangle;

use glam::DVec3;

pub(crate) use self::frame::Aim;
use self::{
    advance::Rounded,
    cone::Cone,
    crossing::Crossing,
    frame::{LocalRay, Spot, Target},
    nearest::Solid,
    round::Round,
};
use super::Placed;
use crate::{
    accuracy::Accuracy,
    answer::{Certificate, Feature, Work},
    math::{Norm, Pose},
    shape::{Convex, Core, Form, Geometry, Hull, Simple, Span},
};

/// A ray. Its direction is of any length but 0; distances along it are metres.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it begins.
    pub origin: DVec3,
    /// Where it goes.
    pub direction: DVec3,
    /// Pass over what is nearer than this, metres.
    pub min_distance: f64,
    /// How far, metres; less than `min_distance`, it touches nothing.
    pub max_distance: f64,
    /// Bodies are hollow: a ray that begins inside goes on to the wall. Of no account unless `faces` is
    /// [`Faces::Both`], since the others are about walls only.
    pub hollow: bool,
    /// Which sides of a surface count.
    pub faces: Faces,
}

/// Which sides of a surface stop a ray. The front of a triangle is the side from which its corners go
/// counter-clockwise; the front of a body is its outside.
///
/// ```text
///              +--------+                 | triangle, its front
///   ray ------>|  body  |------>  ----->  | on the left
///           front      back             front
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Faces {
    /// Both sides.
    #[default]
    Both,
    /// Surfaces met from their front: a ray enters bodies, and goes out of one it began in without a touch.
    Front,
    /// Surfaces met from their back: a ray goes into bodies without a touch and touches where it leaves.
    Back,
}

/// Where a ray meets a geometry. `Miss` is never returned in it: that is `None`.
#[derive(Clone, Copy, Debug)]
pub struct RayTouch {
    /// Metres along the ray: the best value.
    pub distance: f64,
    /// Where, world frame.
    pub point: DVec3,
    /// Unit normal of the surface, towards the asker; `None` if the ray began inside.
    pub normal: Option<DVec3>,
    /// The ray began inside.
    pub inside: bool,
    /// Where on the geometry.
    pub feature: Feature,
    /// For a triangle of a mesh: the weights of its corners, in the order sent, whose mean is the point. From 0 to 1, they
    /// sum up to 1. They are right to what rounding moves the point within the triangle. `None` for bodies, and for
    /// triangles below 1e-70 metres.
    pub barycentric: Option<DVec3>,
    /// What the distance is worth.
    pub certificate: Certificate,
}

/// What a ray meets: at most one certain touch, and one undecided one that may be closer.
#[derive(Clone, Copy, Debug, Default)]
pub struct RayTouches {
    /// The closest that is proved.
    pub certain: Option<RayTouch>,
    /// One that may be closer, hull of all such.
    pub undecided: Option<RayTouch>,
}

/// Where a ray meets a geometry first. An absent touch is a proof that there is none between the ray's `min_distance` and
/// `max_distance`. A body is full unless the ray says `hollow`: a ray that begins inside touches where it begins.
///
/// A mesh is a surface unless it is solid: it has no inside, both sides count unless the ray's [`Faces`] say otherwise, and a
/// ray in the plane of a triangle does not meet that triangle. Of a one-sided mesh only fronts count, whatever the ray says, so
/// that a ray for backs goes through. A solid mesh is a body: a ray that begins in it touches where it begins, unless it says
/// `hollow` or asks for fronts or backs only. Where triangles share an edge the least number wins. An undecided touch does not
/// hide a certain one behind it: see [`RayTouches`]. A height field is a body. A compound is met where the first of its parts is; each part is full, hollow or
/// culled by itself.
///
/// ```
/// use collision::{DVec3, accuracy::Accuracy, answer::Work, math::Pose, narrow, shape::Geometry};
/// let ball = Geometry::sphere(1.0).unwrap();
/// let ray = narrow::Ray {
///     origin: DVec3::new(-1e9, 0.0, 0.0),
///     direction: DVec3::X,
///     min_distance: 0.0,
///     max_distance: 4e12,
///     hollow: false,
///     faces: narrow::Faces::Both,
/// };
/// let target = narrow::Placed { geometry: &ball, pose: Pose::IDENTITY };
/// let touch = narrow::raycast(&ray, target, &Accuracy::default(), &mut Work::default()).certain.unwrap();
/// assert_eq!(touch.distance, 1e9 - 1.0);
/// assert!(touch.certificate.bound.contains(1e9 - 1.0));
/// ```
pub fn raycast(ray: &Ray, target: Placed<'_>, accuracy: &Accuracy, work: &mut Work) -> RayTouches {
    raycast_of(&Aim::new(ray), (target.geometry, &target.pose), None, accuracy, work)
}

/// As [`raycast`], with a ray that was made ready, and a target whose form may be at hand. The pose is read where it is: a copy that was
/// just written is waited for.
pub(crate) fn raycast_of(
    aim: &Aim<'_>,
    (geometry, pose): (&Geometry, &Pose),
    simple: Option<&Simple>,
    accuracy: &Accuracy,
    work: &mut Work,
) -> RayTouches {
    if aim.ray.min_distance > aim.ray.max_distance {
        return RayTouches::default();
    }
    if let Some(simple) = simple {
        let about = Target::about_origin(simple.reach(), 0.0);
        return convex_touches(aim, &simple.convex(), (about, pose), accuracy, work);
    }
    let spot = Spot { pose, blur: 0.0 };
    match geometry.form() {
        Form::Mesh(mesh) => solid::touches(aim, (mesh.as_ref(), geometry), spot, work),
        Form::HalfSpace(half_space) => {
            work.pairs_tested += 1;
            work.iterations += 1;
            half_space::touches(aim.ray, half_space, pose)
        }
        Form::Convex(convex) => touches(aim, (convex, geometry), spot, accuracy, work),
        Form::HeightField(field) => height_field::touches(aim, (field, geometry), spot, work),
        Form::Compound(compound) => compound::touches(aim.ray, (compound, geometry), pose, accuracy, work),
    }
}

/// What a ray touches of a convex body.
fn touches(
    aim: &Aim<'_>,
    (convex, geometry): (&Convex, &Geometry),
    spot: Spot<'_>,
    accuracy: &Accuracy,
    work: &mut Work,
) -> RayTouches {
    let about = match &convex.core {
        Core::Point
        | Core::Segment { .. }
        | Core::Cuboid { .. }
        | Core::Cylinder { .. }
        | Core::Cone { .. }
        | Core::Ellipsoid { .. } => Target::about_origin(geometry.reach(), spot.blur),
        Core::Hull(_) | Core::Triangle(_) => Target::about_center(geometry, spot.blur),
    };
    convex_touches(aim, convex, (about, spot.pose), accuracy, work)
}

#[inline]
fn convex_touches(
    aim: &Aim<'_>,
    convex: &Convex,
    (about, pose): (Target, &Pose),
    accuracy: &Accuracy,
    work: &mut Work,
) -> RayTouches {
    work.pairs_tested += 1;
    work.iterations += 1;
    let local = LocalRay::new(aim, pose, about);
    if local.passes_ball(about.radius) {
        return RayTouches::default();
    }
    let crossing = match (simple_crossing(&local, convex, about), convex.radius > 0.0) {
        (Some(found), _) => found,
        (None, true) => rounded_crossing(&local, convex, about, accuracy, work),
        (None, false) => core_crossing(&local, &convex.core, about.center),
    };
    crossing.map_or_else(RayTouches::default, |crossing| crossing.touches(aim.ray, &local, pose))
}

/// Forms around a point or a segment have formulas with any radius. `None`: it is none of them.
fn simple_crossing(local: &LocalRay, convex: &Convex, about: Target) -> Option<Option<Crossing>> {
    let round = |center: DVec3, axis: DVec3, half: f64| Round { center, axis, half, radius: convex.radius };
    let round = match &convex.core {
        Core::Point => round(DVec3::ZERO, DVec3::Y, 0.0),
        Core::Segment { half_height } => round(DVec3::ZERO, DVec3::Y, *half_height),
        Core::Hull(hull) => {
            let (start, end) = ends(hull)?;
            let along = end - start;
            let axis = along.try_unit().unwrap_or(DVec3::X);
            round(start * 0.5 + end * 0.5 - about.center, axis, 0.5 * along.norm())
        }
        Core::Cuboid { .. }
        | Core::Triangle(_)
        | Core::Cylinder { .. }
        | Core::Cone { .. }
        | Core::Ellipsoid { .. } => return None,
    };
    Some(round.crossing(local))
}

/// The ends of a hull that is a segment or a point.
fn ends(hull: &Hull) -> Option<(DVec3, DVec3)> {
    let topology = hull.topology();
    let vertex = |index: u32| hull.vertices()[index as usize];
    match topology.span {
        Span::Point => Some((vertex(0), vertex(0))),
        Span::Segment => Some((vertex(topology.edges[0].start), vertex(topology.edges[0].end))),
        Span::Polygon | Span::Solid => None,
    }
}

fn rounded_crossing(
    local: &LocalRay,
    convex: &Convex,
    about: Target,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Crossing> {
    let core = || core_crossing(local, &convex.core, about.center);
    match Solid::of(&convex.core) {
        Some(solid) => {
            let body = Rounded { core: solid, radius: convex.radius, reach: about.radius };
            let crossing = body.crossing(local, accuracy, core)?;
            work.iterations += u64::from(crossing.iterations);
            Some(crossing)
        }
        None => rounded::crossing(local, convex, about, accuracy, work),
    }
}

/// The core alone, where it has an inside of its own or is flat. `None` if it is surely missed, or is a point or a segment.
fn core_crossing(local: &LocalRay, core: &Core, center: DVec3) -> Option<Crossing> {
    match core {
        Core::Cuboid { half_extents } => polytope::cuboid(local, *half_extents),
        Core::Hull(hull) => polytope::hull(local, hull, center),
        Core::Triangle(corners) => polytope::polygon(local, corners.iter().copied(), center),
        Core::Cylinder { half_height, radius } => cylinder::crossing(local, *half_height, *radius),
        Core::Cone { half_height, radius } => Cone::new(*half_height, *radius).crossing(local),
        Core::Ellipsoid { radii } => ellipsoid::crossing(local, *radii),
        Core::Point | Core::Segment { .. } => None,
    }
}
