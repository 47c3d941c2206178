//! What a triangle of a mesh feels of another form: from which side, and with which normal.
//!
//! # Method
//! A triangle that is asked by itself answers by its edges too, though its neighbours go on from there: a ball that rolls over a
//! flat floor would bump into each of them. So a normal that the surface does not have there ([`Mesh::looks_along`]) is
//! replaced by that of a face which meets there; the depth is then that along this normal, which is as certain as any.
//!
//! Of one-sided and solid meshes a triangle is felt by what has its middle before it, and pushes to its front.
//!
//! # Limits
//! In motion each piece of the other form is judged for itself: one that a triangle is passed over for does not hide its front from
//! the next. Where something turns, points of a form go different ways, and those of a ball that spins say nothing of where it goes:
//! the normal of the touch alone tells the side.

use glam::DVec3;

use super::{Piece, inside::middle};
use crate::{
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::{Norm, Pose},
    narrow::{
        Contact, ImpactTouch, InitialTouch, Motion,
        convex::{self, Ruling},
        place::Place,
    },
    shape::{Convex, Core, Mesh, MeshMode, Sides},
    tolerance::SURFACE_LEAN,
};

/// Which triangle of a mesh a piece is.
#[derive(Clone, Copy)]
pub(super) struct Facet<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) triangle: usize,
}

/// What became of a question for a contact.
pub(super) struct Felt {
    /// `None` if there is none within the gap, or if neighbours tell it.
    pub(super) contact: Option<Contact>,
    /// Whether it is a touch, or may be one, that does not count because of the side that is touched.
    pub(super) is_from_back: bool,
}

/// A facet at a pose, and the other piece at one.
struct Meeting<'m> {
    facet: Facet<'m>,
    pose: Pose,
    other: &'m Piece<'m>,
    other_pose: Pose,
}

impl<'m> Meeting<'m> {
    fn new(facet: Facet<'m>, own: &Piece<'_>, other: &'m Piece<'m>) -> Self {
        Self { facet, pose: own.place.pose, other, other_pose: other.place.pose }
    }

    /// The same a part of a motion later, where it has turned about its arm.
    fn after(self, own: Course<'_>, other: Course<'_>, fraction: f64) -> Self {
        Self { pose: own.at(fraction), other_pose: other.at(fraction), ..self }
    }

    fn is_felt_from_both_sides(&self) -> bool {
        self.facet.mesh.mode() == MeshMode::TwoSided
    }

    /// The front normal in the world.
    fn front(&self) -> DVec3 {
        self.pose.matrix() * self.facet.mesh.normal(self.facet.triangle)
    }

    fn to_local(&self, world: DVec3) -> DVec3 {
        self.pose.matrix().transpose() * world
    }

    /// Whether the other form has its middle behind the triangle.
    fn is_behind(&self) -> bool {
        let [corner, ..] = self.facet.mesh.corners(self.facet.triangle);
        let apart = self.other_pose.position - self.pose.position;
        let middle = self.other_pose.matrix() * middle(self.other.convex);
        let from_corner = apart + middle - self.pose.matrix() * corner;
        self.front().dot(from_corner) < 0.0
    }

    /// What becomes of a contact whose normal, towards the other form, is this.
    fn ruling(&self, towards_other: DVec3, verdict: Verdict) -> Ruling {
        let Facet { mesh, triangle } = self.facet;
        let local = self.to_local(towards_other);
        let is_front = self.is_felt_from_both_sides() || mesh.normal(triangle).dot(local) >= -SURFACE_LEAN;
        if is_front && mesh.looks_along(triangle, local) {
            return Ruling::Stands;
        }
        if verdict == Verdict::Miss {
            return Ruling::LeftOut;
        }
        let matrix = self.pose.matrix();
        Ruling::Along(self.normals_beside(local).into_iter().map(|normal| matrix * normal).collect())
    }

    fn normals_beside(&self, local: DVec3) -> crate::shape::Normals {
        let sides = if self.is_felt_from_both_sides() { Sides::Both } else { Sides::Front };
        self.facet.mesh.normals_beside(self.facet.triangle, local, sides)
    }

    /// The normal of an impact as the surface has it.
    fn impact_normal(&self, towards_other: DVec3) -> DVec3 {
        let local = self.to_local(towards_other);
        if self.facet.mesh.looks_along(self.facet.triangle, local) {
            return towards_other;
        }
        let beside = self.normals_beside(local);
        // Where it lies along the face, that side which the other form is on.
        let lean = if self.is_behind() { -SURFACE_LEAN } else { SURFACE_LEAN };
        let wanted = local + self.facet.mesh.normal(self.facet.triangle) * lean;
        let nearest = beside.into_iter().max_by(|a, b| a.dot(wanted).total_cmp(&b.dot(wanted)));
        nearest.map_or(towards_other, |normal| self.pose.matrix() * normal + DVec3::ZERO)
    }

    /// Whether a touch is felt. `way` is how far the other form goes past the triangle, where neither turns.
    fn feels(&self, touch: &ImpactTouch, towards_other: Option<DVec3>, way: Option<DVec3>) -> bool {
        let front = self.front();
        match towards_other {
            None => !self.is_behind(),
            Some(normal) if touch.initial => front.dot(normal) >= -SURFACE_LEAN,
            Some(normal) => {
                front.dot(normal) >= -SURFACE_LEAN && way.is_none_or(|way| front.dot(way) <= SURFACE_LEAN * way.norm())
            }
        }
    }
}

/// Where a piece goes, and how it turns.
#[derive(Clone, Copy)]
struct Course<'p> {
    place: &'p Place,
    way: DVec3,
    turn: DVec3,
}

impl Course<'_> {
    fn at(self, fraction: f64) -> Pose {
        let Place { pose, arm, .. } = self.place;
        let turned = Pose::new(DVec3::ZERO, Pose::IDENTITY.rotation_after(self.turn, fraction)).transform_point(*arm);
        Pose::new(pose.position + self.way * fraction + (turned - *arm), pose.rotation_after(self.turn, fraction))
    }
}

/// Hulls of no more corners touch a triangle exactly in hardly more steps than nearly.
const CORNERS_FEW: usize = 64;

/// What is asked of the depth in a triangle. A normal that is nearly right is none that the surface has, and replacing it costs more than
/// finding the right one, which flat forms of few corners have after a step or two more.
fn asked(other: &Convex, accuracy: &Accuracy) -> Accuracy {
    let is_flat = match &other.core {
        Core::Hull(hull) => hull.vertices().len() <= CORNERS_FEW,
        core => core.is_polytope(),
    };
    if is_flat { Accuracy { max_error: 0.0, max_error_relative: 0.0, ..*accuracy } } else { *accuracy }
}

/// The contact of two pieces, of which at most one is a facet.
pub(super) fn contact(a: &Piece<'_>, b: &Piece<'_>, max_gap: f64, accuracy: &Accuracy, work: &mut Work) -> Felt {
    let (meeting, is_first) = match (a.facet, b.facet) {
        (_, Some(facet)) => (Meeting::new(facet, b, a), false),
        (Some(facet), None) => (Meeting::new(facet, a, b), true),
        (None, None) => {
            let contact = convex::penetration(a.placed(), b.placed(), max_gap, accuracy, work);
            return Felt { contact, is_from_back: false };
        }
    };
    let turned = |normal: DVec3| if is_first { DVec3::ZERO - normal } else { normal };
    let is_from_back = !meeting.is_felt_from_both_sides() && meeting.is_behind();
    let accuracy = &asked(meeting.other.convex, accuracy);
    let mut verdict = Verdict::Miss;
    let contact =
        convex::penetration_ruled([a.placed(), b.placed()], max_gap, accuracy, work, |normal_b_to_a, found| {
            verdict = found;
            if is_from_back {
                return Ruling::LeftOut;
            }
            match meeting.ruling(turned(normal_b_to_a), found) {
                Ruling::Along(normals) => Ruling::Along(normals.into_iter().map(turned).collect()),
                ruling => ruling,
            }
        });
    Felt { contact, is_from_back: is_from_back && verdict != Verdict::Miss }
}

/// The first touch of two pieces; `None` also where it is not felt, or is surely later than `limit`: most of what a touch costs beside
/// finding it is the normal that the surface has there.
pub(super) fn impact(
    a: &Piece<'_>,
    b: &Piece<'_>,
    (motion, limit): (&Motion, f64),
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<ImpactTouch> {
    let mut touch = convex::impact(a.placed(), b.placed(), motion, [a.place.arm, b.place.arm], accuracy, work)?;
    if touch.certificate.bound.lower > limit {
        return None;
    }
    let course_a = Course { place: &a.place, way: motion.displacement_a, turn: motion.rotation_a };
    let course_b = Course { place: &b.place, way: motion.displacement_b, turn: motion.rotation_b };
    let way = (!motion.turns()).then_some(motion.displacement_a - motion.displacement_b);
    // From which side a triangle is touched is told by the touch itself, not by the normal that the other surface has there.
    let normal_of_touch = touch.normal_b_to_a;
    for (own, other, sign, courses) in [(b, a, 1.0, [course_b, course_a]), (a, b, -1.0, [course_a, course_b])] {
        let Some(facet) = own.facet else { continue };
        let meeting = Meeting::new(facet, own, other).after(courses[0], courses[1], touch.fraction);
        let is_one_way = match facet.mesh.mode() {
            MeshMode::TwoSided => false,
            MeshMode::OneSided => true,
            // What begins in a solid and is not yet clear of it comes to its walls from behind.
            MeshMode::Solid => motion.initial == InitialTouch::IsIgnored,
        };
        if is_one_way && normal_of_touch.is_none() && !touch.initial {
            // They are apart at the start by so little that nothing tells the side.
            touch.certificate.verdict = Verdict::Undecided;
        } else if is_one_way
            && !meeting.feels(&touch, normal_of_touch.map(|normal| normal * sign), way.map(|way| way * sign))
        {
            return None;
        }
        touch.normal_b_to_a =
            touch.normal_b_to_a.map(|normal| meeting.impact_normal(normal * sign) * sign + DVec3::ZERO);
    }
    Some(touch)
}
