//! The inside of height fields: what lies wholly in it touches none of the skin, and is found by one of its points.
//!
//! # Method
//! A convex form that touches no triangle of the skin lies wholly inside or wholly outside, and each of its points knows
//! which. So one point is asked. Where rounding leaves open how it stands, the answer is left open.
//!
//! The contact of a form with a triangle of the skin parts the two along the shortest way. If that leads into the matter, the
//! form is pushed out along the triangle's normal instead, as far as it lies below the triangle's plane.

use std::ops::ControlFlow;

use glam::DVec3;

use super::{Piece, Side, concave::Concave};
use crate::{
    answer::{Bound, Certificate, Feature, Method, Model, Stop, Verdict, Work},
    math::Norm,
    narrow::{
        Contact, ImpactTouch, Separation,
        half_space::{Body, Pair},
        place::Place,
    },
    shape::{Convex, Core, HalfSpace, Standing},
    tolerance::PAIR_ROUNDING,
};

/// A point of one form that may lie in the matter of another.
#[derive(Clone, Copy)]
pub(super) struct Met {
    /// How it stands; never outside.
    pub(super) standing: Standing,
    /// Where it is, in the axes of the world.
    point: DVec3,
    /// Of the two forms in their order.
    features: (Feature, Feature),
}

impl Met {
    /// Of `matter` and what is in it.
    pub(super) fn of_pair(matter: &Concave<'_>, other: &Side<'_>, work: &mut Work) -> Option<Self> {
        if !matter.has_inside() {
            return None;
        }
        match other {
            Side::Convex(piece) => Self::of_piece(matter, piece, work),
            Side::Concave(inner) if inner.has_inside() => {
                let mut found = None;
                inner.in_box(inner.box_of(&Side::Concave(*matter)), work, |piece, work| {
                    if let Side::Convex(piece) = piece {
                        found = found.or(Self::of_piece(matter, &piece, work));
                    }
                    if found.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                });
                found
            }
            // Its pieces are asked one by one.
            Side::Concave(_) | Side::Space(_) => None,
        }
    }

    fn of_piece(matter: &Concave<'_>, piece: &Piece<'_>, work: &mut Work) -> Option<Self> {
        work.iterations += 1;
        let local = point_of(piece.convex);
        let (standing, cell) = matter.standing_of(&Side::Convex(*piece), local)?;
        let feature = Feature { face: cell, ..matter.feature() };
        let point = piece.place.pose.transform_point(local);
        Some(Self { standing, point, features: (feature, piece.feature) })
    }

    /// The same where the matter is that of the second form.
    pub(super) fn swapped(self) -> Self {
        Self { features: (self.features.1, self.features.0), ..self }
    }

    fn certificate(&self, inside: Bound, open: impl Fn(f64) -> Bound) -> Certificate {
        let (verdict, bound) = match self.standing {
            Standing::Open(beyond) => (Verdict::Undecided, open(beyond)),
            Standing::Inside(_) | Standing::Outside => (Verdict::Hit, inside),
        };
        Certificate {
            verdict,
            bound,
            model: Model::EXACT,
            method: Method::ClosedForm,
            stop: Stop::Converged,
            iterations: 1,
        }
    }

    /// What it says of the signed distance.
    pub(super) fn overlap(&self) -> Certificate {
        let down_to = |upper| Bound::new(f64::NEG_INFINITY, upper);
        self.certificate(down_to(0.0), down_to)
    }

    /// What it says of the distance.
    pub(super) fn separation(&self) -> Separation {
        let certificate = self.certificate(Bound::new(0.0, 0.0), |beyond| Bound::new(0.0, beyond));
        Separation {
            // Of what is open the other candidates know more.
            distance: certificate.bound.upper,
            point_on_a: self.point,
            point_on_b: self.point,
            normal_b_to_a: None,
            feature_a: self.features.0,
            feature_b: self.features.1,
            certificate,
        }
    }

    /// The touch at the start of a motion, and where it is on the first form.
    pub(super) fn initial_touch(&self) -> (ImpactTouch, Feature) {
        let at_start = Bound::new(0.0, 0.0);
        let touch = ImpactTouch {
            fraction: 0.0,
            point: self.point,
            normal_b_to_a: None,
            initial: true,
            feature_b: self.features.1,
            certificate: self.certificate(at_start, |_| at_start),
        };
        (touch, self.features.0)
    }
}

/// A point of a convex form, in its own frame.
fn point_of(convex: &Convex) -> DVec3 {
    match &convex.core {
        Core::Point
        | Core::Segment { .. }
        | Core::Cuboid { .. }
        | Core::Cylinder { .. }
        | Core::Cone { .. }
        | Core::Ellipsoid { .. } => DVec3::ZERO,
        Core::Hull(hull) => hull.vertices()[0],
        Core::Triangle([a, b, c]) => *a * 0.5 + (*b * 0.25 + *c * 0.25),
    }
}

impl Piece<'_> {
    /// Of a triangle of a skin: outwards, in the axes of the world, of any length.
    pub(super) fn outward(&self) -> Option<DVec3> {
        let Core::Triangle([a, b, c]) = self.convex.core else { return None };
        self.skin.then(|| self.place.pose.matrix() * (b - a).cross(c - a))
    }
}

/// What becomes of a gap between a form and a piece of skin that looks away from it.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum AcrossGaps {
    /// The form is not in the matter: around the corner another piece is nearer.
    LeaveOut,
    /// The form is in the matter, so it is pushed out.
    PushOut,
}

/// The contact of a form with a piece of skin, given that along the shortest way: one that leads out of the matter.
pub(super) fn out_of(
    form: &Piece<'_>,
    skin: &Piece<'_>,
    found: Contact,
    across_gaps: AcrossGaps,
    work: &mut Work,
) -> Option<Contact> {
    let is_outward = skin.outward().is_none_or(|outward| found.normal_b_to_a.dot(outward) >= 0.0);
    let is_gap = found.certificate.verdict == Verdict::Miss;
    match (is_outward, is_gap, across_gaps) {
        (true, ..) => Some(found),
        (false, true, AcrossGaps::LeaveOut) => None,
        (false, ..) => {
            let is_proved = found.certificate.verdict == Verdict::Hit || across_gaps == AcrossGaps::PushOut;
            let mut contact = below(form, skin, work)?;
            // To be below a plane proves no touch of the piece that lies in it.
            if !is_proved && contact.certificate.verdict == Verdict::Hit {
                contact.certificate.verdict = Verdict::Undecided;
            }
            Some(contact)
        }
    }
}

/// The contact of a form with the matter below the plane of a piece of skin.
pub(super) fn below(form: &Piece<'_>, skin: &Piece<'_>, work: &mut Work) -> Option<Contact> {
    let Core::Triangle([a, b, c]) = skin.convex.core else { return None };
    let normal = (b - a).cross(c - a);
    let unit = normal.try_unit()?;
    // Depths are along this very normal, whatever it is off the triangle's, so the triangle is where it is highest.
    let offset = unit.dot(a).max(unit.dot(b)).max(unit.dot(c));
    let plane = HalfSpace { normal, offset };
    let rounding = PAIR_ROUNDING * skin.convex.reach();
    let place = Place { blur: skin.place.blur + rounding, ..skin.place };
    let pair = Pair::of_leaf(Body::Convex(form.convex), (&form.place, form.convex.reach()), (&plane, &place));
    let contact = pair.penetration(f64::INFINITY, work).into_iter().next()?;
    Some(Contact { feature_a: form.feature, feature_b: skin.feature, ..contact })
}
