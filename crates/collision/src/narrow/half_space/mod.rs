//! One question to a half space and another form.
//!
//! # Method
//! All closed form. The height of a form is that of its lowest point along the plane's normal: one support of a convex
//! form in its own axes, one pass over the vertices of a mesh. It splits into the height of the form's local origin, which
//! is computed from exact differences in numbers of twice the length ([`plane`]), and the lowest point relative to that,
//! off by a few roundings of the form's reach. Where the height is within its error, exact sums decide the touch of what
//! is not turned ([`exact`]).
//!
//! # Limits
//! Of meshes and height fields the height is that of the lowest corner, and only triangles have contacts; of surfaces that are
//! felt from one side only some, which `sides.rs` tells. Two half spaces
//! always overlap unless their normals are exactly opposite, which is proved for equal rotations only ([`spaces`]).

mod contact;
mod exact;
mod impact;
mod plane;
mod sides;
mod signed;
mod spaces;
mod turning;

use std::cmp::Ordering;

use glam::DVec3;

pub(super) use self::{
    exact::ExactPlane,
    plane::{Height, Plane, difference, unit},
};
use self::{sides::Felt, signed::Signed, turning::Ways};
use super::{Contact, Contacts, Depth, ImpactTouch, Motion, Placed, Separation, convex, place::Place};
use crate::{
    accuracy::Accuracy,
    answer::{Certificate, Feature, Stop, Verdict, Work},
    math::{Pose, twofold::Twofold},
    shape::{Convex, Form, HalfSpace, HeightField, Mesh},
    tolerance::{LOWEST_POINT, ROUNDING, TURNED_LOWEST_POINT},
};

/// A pair of which one is a half space at least.
pub(super) enum Pair<'a> {
    /// `b` is the half space.
    Above(Above<'a>),
    /// `a` is.
    Below(Above<'a>),
    /// Both are.
    Spaces(spaces::Spaces<'a>),
}

impl<'a> Pair<'a> {
    /// `None` if neither is a half space, or one is a compound, of which each leaf is asked.
    pub(super) fn of(a: &Placed<'a>, b: &Placed<'a>) -> Option<Self> {
        match (a.geometry.form(), b.geometry.form()) {
            (Form::HalfSpace(first), Form::HalfSpace(second)) => {
                Some(Self::Spaces(spaces::Spaces::new((first, a.pose), (second, b.pose))))
            }
            (Form::HalfSpace(half_space), _) => Above::new(b, half_space, a.pose).map(Self::Below),
            (_, Form::HalfSpace(half_space)) => Above::new(a, half_space, b.pose).map(Self::Above),
            _ => None,
        }
    }

    /// A form at a place that is no compound, and a half space, which is `b`.
    pub(super) fn of_leaf(
        body: Body<'a>,
        (place, reach): (&Place, f64),
        (half_space, space_place): (&'a HalfSpace, &Place),
    ) -> Self {
        let place = Place { blur: place.blur + space_place.blur, ..*place };
        Self::Above(Above::of(body, reach, &place, half_space, space_place.pose))
    }

    /// As [`super::distance`].
    pub(super) fn distance(&self, limit: f64, work: &mut Work) -> Option<Separation> {
        count(work);
        match self {
            Self::Above(above) => above.distance(limit),
            Self::Below(above) => above.distance(limit).map(Separation::swapped),
            Self::Spaces(spaces) => spaces.distance(limit),
        }
    }

    /// As [`super::overlap`].
    pub(super) fn overlap(&self, work: &mut Work) -> Certificate {
        count(work);
        let signed = match self {
            Self::Above(above) | Self::Below(above) => above.signed(above.body, &above.lowest()),
            Self::Spaces(spaces) => spaces.signed(),
        };
        let is_open = signed.verdict == Verdict::Undecided;
        signed.certificate(signed.verdict, if is_open { Stop::Converged } else { Stop::Tolerance })
    }

    /// As [`super::within`].
    pub(super) fn within(&self, margin: f64, work: &mut Work) -> Certificate {
        let found = self.overlap(work);
        let verdict = match found.verdict {
            Verdict::Hit => Verdict::Hit,
            Verdict::Undecided | Verdict::Miss if found.bound.upper <= margin => Verdict::Hit,
            Verdict::Miss if found.bound.lower > margin || margin <= 0.0 => Verdict::Miss,
            Verdict::Undecided | Verdict::Miss => Verdict::Undecided,
        };
        Certificate { verdict, ..found }
    }

    /// As [`super::depth`]: `None` for concave forms.
    pub(super) fn depth(&self, max_gap: f64, work: &mut Work) -> Option<Depth> {
        if let Self::Above(above) | Self::Below(above) = self
            && !matches!(above.body, Body::Convex(_))
        {
            return None;
        }
        let contact = self.penetration(max_gap, work).into_iter().next()?;
        let deepest = contact.points.first()?;
        Some(Depth {
            depth: contact.depth,
            normal_b_to_a: contact.normal_b_to_a,
            point_on_a: deepest.point_on_a,
            point_on_b: deepest.point_on_b,
            certificate: contact.certificate,
        })
    }

    /// As [`super::penetration`].
    pub(super) fn penetration(&self, max_gap: f64, work: &mut Work) -> Contacts {
        match self {
            Self::Above(above) => above.contacts(max_gap, work),
            Self::Below(above) => {
                let mut contacts = above.contacts(max_gap, work);
                contacts.iter_mut().for_each(Contact::swap);
                contacts
            }
            Self::Spaces(spaces) => super::contacts(spaces.contact(max_gap, work)),
        }
    }

    /// As [`super::impact`].
    pub(super) fn impact(&self, motion: &Motion, accuracy: &Accuracy, work: &mut Work) -> Option<ImpactTouch> {
        if motion.turns() {
            return self.turning_impact(motion, accuracy, work);
        }
        count(work);
        match self {
            Self::Above(above) => above.impact([motion.displacement_a, motion.displacement_b], motion.initial),
            Self::Below(above) => {
                let touch = above.impact([motion.displacement_b, motion.displacement_a], motion.initial)?;
                Some(ImpactTouch { normal_b_to_a: touch.normal_b_to_a.map(|normal| DVec3::ZERO - normal), ..touch })
            }
            Self::Spaces(spaces) => spaces.impact(motion),
        }
    }

    fn turning_impact(&self, motion: &Motion, accuracy: &Accuracy, work: &mut Work) -> Option<ImpactTouch> {
        let [of_a, of_b] = [(motion.displacement_a, motion.rotation_a), (motion.displacement_b, motion.rotation_b)];
        let ways = |of_form: (DVec3, DVec3), of_space: (DVec3, DVec3)| Ways {
            displacements: [of_form.0, of_space.0],
            rotations: [of_form.1, of_space.1],
            initial: motion.initial,
        };
        match self {
            Self::Above(above) => above.turning_impact(ways(of_a, of_b), accuracy, work),
            Self::Below(above) => {
                let touch = above.turning_impact(ways(of_b, of_a), accuracy, work)?;
                Some(ImpactTouch { normal_b_to_a: touch.normal_b_to_a.map(|normal| DVec3::ZERO - normal), ..touch })
            }
            Self::Spaces(spaces) => {
                count(work);
                spaces.turning_impact(motion)
            }
        }
    }
}

fn count(work: &mut Work) {
    work.pairs_tested += 1;
    work.iterations += 1;
}

/// What lies against the plane.
#[derive(Clone, Copy)]
pub(super) enum Body<'a> {
    Convex(&'a Convex),
    Mesh(&'a Mesh),
    Field(&'a HeightField),
}

impl Body<'_> {
    /// Calls `visit` with the face number and the corners of each triangle, in a fixed order; a convex form has none.
    fn each_triangle(self, mut visit: impl FnMut(u32, [DVec3; 3])) {
        match self {
            Body::Convex(_) => {}
            Body::Mesh(mesh) => (0..mesh.triangles().len())
                .for_each(|triangle| visit(mesh.sent_number(triangle), mesh.corners(triangle))),
            Body::Field(field) => field.each_triangle(|cell, corners| visit(cell as u32, corners)),
        }
    }
}

/// A form and the plane of a half space, which is called `b` in answers.
#[derive(Clone, Copy)]
pub(super) struct Above<'a> {
    body: Body<'a>,
    pose: Pose,
    half_space: &'a HalfSpace,
    space_pose: Pose,
    plane: Plane,
    /// Outward unit normal in the form's own axes.
    normal: DVec3,
    /// Of the form's local origin.
    origin: Height,
    /// What a point relative to that costs.
    error: f64,
    /// Of the form about its local origin.
    reach: f64,
    /// What of the error comes from where the form is.
    blur: f64,
    /// From what the form turns about to its local origin, in the axes of the world.
    arm: DVec3,
    /// Which of its triangles count.
    felt: Felt,
}

/// The lowest point of a form.
struct Low {
    /// On the core, in the form's own axes.
    point: DVec3,
    /// Around it.
    radius: f64,
    feature: Feature,
}

impl<'a> Above<'a> {
    /// `None` if the form is a half space too, or a compound.
    fn new(placed: &Placed<'a>, half_space: &'a HalfSpace, space_pose: Pose) -> Option<Self> {
        let body = match placed.geometry.form() {
            Form::Convex(convex) => Body::Convex(convex),
            Form::Mesh(mesh) => Body::Mesh(mesh),
            Form::HeightField(field) => Body::Field(field),
            Form::HalfSpace(_) | Form::Compound(_) => return None,
        };
        Some(Self::of(body, placed.geometry.reach(), &Place::of(placed.pose), half_space, space_pose))
    }

    fn of(body: Body<'a>, reach: f64, place: &Place, half_space: &'a HalfSpace, space_pose: Pose) -> Self {
        let Place { pose, blur, arm } = *place;
        let plane = Plane::new(half_space, &space_pose);
        let origin = plane.height(&difference(pose.position, space_pose.position));
        let (normal, error) = if pose.rotation.xyz() == DVec3::ZERO {
            (plane.normal, LOWEST_POINT * reach)
        } else if pose.rotation == space_pose.rotation {
            (Plane::new(half_space, &Pose::IDENTITY).normal, LOWEST_POINT * reach)
        } else {
            (pose.matrix().transpose() * plane.normal, TURNED_LOWEST_POINT * reach)
        };
        Self {
            body,
            pose,
            half_space,
            space_pose,
            plane,
            normal,
            origin,
            error: error + blur,
            reach,
            blur,
            arm,
            felt: Felt::All,
        }
    }

    fn lowest(&self) -> Low {
        match self.body {
            Body::Convex(convex) => {
                let point = convex::lowest(convex, self.normal);
                Low { point, radius: convex.radius, feature: Feature::default() }
            }
            Body::Mesh(_) | Body::Field(_) => self.lowest_of_triangles(|_| true).unwrap_or(Low {
                point: DVec3::ZERO,
                radius: 0.0,
                feature: Feature::default(),
            }),
        }
    }

    /// The lowest corner of those triangles that count and that `counts` accepts, by their corners; of equals that of the first.
    fn lowest_of_triangles(&self, counts: impl Fn([DVec3; 3]) -> bool) -> Option<Low> {
        let mut best: Option<(f64, DVec3, u32)> = None;
        self.body.each_triangle(|face, corners| {
            for corner in corners {
                let height = self.normal.dot(corner);
                if best.is_none_or(|(least, ..)| height < least) && self.feels(corners) && counts(corners) {
                    best = Some((height, corner, face));
                }
            }
        });
        let (_, point, face) = best?;
        Some(Low { point, radius: 0.0, feature: Feature { part: None, face: Some(face) } })
    }

    /// Height of a point of the core less the radius around it.
    fn height(&self, local: DVec3, radius: f64) -> f64 {
        let above_origin = Twofold::of(self.normal.dot(local)) - Twofold::of(radius);
        (self.origin.value + above_origin).high
    }

    /// How far a height may be from the exact one.
    fn error_at(&self, height: f64) -> f64 {
        self.origin.error + self.error + 2.0 * ROUNDING * height.abs()
    }

    /// The height of a body, the form's own or a piece of it, by its lowest point.
    fn signed(&self, body: Body<'_>, low: &Low) -> Signed {
        let best = self.height(low.point, low.radius);
        let error = self.error_at(best);
        let signed = Signed::new(best - error, best, best + error);
        match signed.verdict {
            Verdict::Undecided => signed.with_sign(self.exact_sign(body, low, [DVec3::ZERO; 2])),
            Verdict::Hit | Verdict::Miss => signed,
        }
    }

    /// The exact sign of a body's height after the form and the half space have gone these ways; `None` if it is not known.
    fn exact_sign(&self, body: Body<'_>, low: &Low, ways: [DVec3; 2]) -> Option<Ordering> {
        let exact = ExactPlane::new(self.half_space, &self.space_pose).filter(|_| self.blur <= 0.0)?;
        let is_turned = self.pose.rotation.xyz() != DVec3::ZERO;
        let limit = self.normal.dot(low.point) + 2.0 * self.error;
        let near = |corner: DVec3| self.normal.dot(corner) <= limit;
        let corners = match body {
            Body::Convex(convex) => {
                let corners = exact::lowest_corners(convex, self.half_space.normal, near)?;
                let is_at_origin = corners.iter().all(|&corner| corner == DVec3::ZERO);
                (!is_turned || is_at_origin).then_some(corners)?
            }
            Body::Mesh(_) | Body::Field(_) if is_turned => return None,
            Body::Mesh(mesh) if self.felt == Felt::All => {
                mesh.vertices().iter().copied().filter(|&vertex| near(vertex)).collect()
            }
            Body::Mesh(_) | Body::Field(_) => {
                let mut corners = Vec::new();
                body.each_triangle(|_, triangle| {
                    if triangle.into_iter().any(near) && self.feels(triangle) {
                        corners.extend(triangle.into_iter().filter(|&corner| near(corner)));
                    }
                });
                corners
            }
        };
        let signs = corners.into_iter().map(|corner| exact.sign(self.pose.position, corner, low.radius, ways));
        signs.collect::<Option<Vec<Ordering>>>()?.into_iter().min()
    }

    fn distance(&self, limit: f64) -> Option<Separation> {
        let low = self.lowest();
        let signed = self.signed(self.body, &low);
        let (lower, upper) = (signed.lower.max(0.0), signed.upper.max(0.0));
        if lower > limit {
            return None;
        }
        let best = if signed.verdict == Verdict::Hit { 0.0 } else { signed.best.clamp(lower, upper) };
        let point_on_a = self.point_out(low.point, low.radius);
        let normal = self.plane.normal;
        Some(Separation {
            distance: best,
            point_on_a,
            point_on_b: point_on_a - normal * best + DVec3::ZERO,
            normal_b_to_a: (best > 0.0).then_some(normal),
            feature_a: low.feature,
            feature_b: Feature::default(),
            certificate: Signed { lower, upper, ..signed }
                .certificate(if upper <= limit { Verdict::Hit } else { Verdict::Undecided }, Stop::Converged),
        })
    }

    /// The surface point below a point of the core, in the world.
    fn point_out(&self, local: DVec3, radius: f64) -> DVec3 {
        self.pose.transform_point(local) - self.plane.normal * radius + DVec3::ZERO
    }
}
