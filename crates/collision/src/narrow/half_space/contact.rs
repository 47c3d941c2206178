//! The contact of a form and a half space: its normal is the plane's, its depth the form's depth below the plane.

use super::{Above, Body, Low, Signed, sides::Felt};
use crate::{
    answer::{Bound, Feature, Stop, Verdict, Work},
    narrow::{Contact, ContactPoint, Contacts, convex},
    shape::{Convex, Core},
};

impl Above<'_> {
    /// The contact of a convex form, or those of the triangles of another in the order of their numbers, unless the gap is
    /// proved to be above `max_gap`.
    pub(super) fn contacts(&self, max_gap: f64, work: &mut Work) -> Contacts {
        match self.body {
            Body::Convex(convex) => {
                super::count(work);
                self.contact(convex, &self.lowest(), max_gap).into_iter().collect()
            }
            Body::Mesh(_) | Body::Field(_) => {
                self.feeling(Felt::in_contact(self.body)).contacts_of_triangles(max_gap, work)
            }
        }
    }

    fn contacts_of_triangles(&self, max_gap: f64, work: &mut Work) -> Contacts {
        let mut contacts = Contacts::new();
        self.body.each_triangle(|face, corners| {
            super::count(work);
            if !self.feels(corners) {
                return;
            }
            let [a, b, c] = corners.map(|corner| self.normal.dot(corner));
            let point = corners[if a <= b && a <= c { 0 } else { 1 + usize::from(c < b) }];
            let feature = Feature { part: None, face: Some(face) };
            let piece = Convex { core: Core::Triangle(corners), radius: 0.0 };
            contacts.extend(self.contact(&piece, &Low { point, radius: 0.0, feature }, max_gap));
        });
        contacts.sort_by_key(|contact| contact.feature_a.face);
        contacts
    }

    fn contact(&self, piece: &Convex, low: &Low, max_gap: f64) -> Option<Contact> {
        let signed = self.signed(Body::Convex(piece), low);
        if signed.lower > max_gap || signed.verdict == Verdict::Miss && max_gap <= 0.0 {
            return None;
        }
        let normal = self.plane.normal;
        let points = convex::feet(piece, self.normal).into_iter().map(|foot| {
            let depth = -self.height(foot.point, low.radius) + 0.0;
            let error = self.error_at(depth);
            let point_on_a = self.point_out(foot.point, low.radius);
            ContactPoint {
                point_on_a,
                point_on_b: point_on_a + normal * depth,
                depth,
                bound: Bound::new(depth - error, depth + error),
                feature_pair: foot.index << 16,
            }
        });
        let depth = Signed { lower: -signed.upper, best: -signed.best, upper: -signed.lower, ..signed };
        Some(Contact {
            normal_b_to_a: normal,
            depth: depth.best + 0.0,
            points: points.collect(),
            feature_a: low.feature,
            feature_b: Feature::default(),
            certificate: depth.certificate(signed.verdict, Stop::Converged),
        })
    }
}
