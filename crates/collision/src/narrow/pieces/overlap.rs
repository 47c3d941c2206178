//! Whether and how deep a mesh touches another form.

use std::{convert::Infallible, ops::ControlFlow};

use super::{Side, Surface, is_swapped};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Method, Stop, Verdict, Work},
    broad::{ALL_LAYERS, Tree},
    narrow::{
        Contacts, NeedsDecomposition, Placed,
        convex::{self, PlacedConvex},
    },
};

/// Whether `a` and `b` touch, one of them a mesh. The bound is that of the least signed distance of their pieces: above 0
/// only a lower bound of 0 is given, since what lies farther off is not measured.
pub(in crate::narrow) fn overlap(a: Placed<'_>, b: Placed<'_>, accuracy: &Accuracy, work: &mut Work) -> Certificate {
    let mut touching = Touching::nothing();
    match (Side::of(a), Side::of(b)) {
        (Side::Convex(a), Side::Convex(b)) => return convex::overlap(a, b, accuracy, work),
        (Side::Convex(a), Side::Surface(b)) | (Side::Surface(b), Side::Convex(a)) => {
            touching.search(a, &b, accuracy, work);
        }
        (Side::Surface(a), Side::Surface(b)) => {
            let counts = (a.mesh.triangles().len(), b.mesh.triangles().len());
            let is_turned = counts.1 < counts.0 || counts.0 == counts.1 && is_swapped(&a, &b);
            let (a, b) = if is_turned { (b, a) } else { (a, b) };
            let near_b = a.box_of_surface(&b);
            let Ok(()) = a.mesh.tree().visit_box(near_b, ALL_LAYERS, work, |work, leaf| {
                let piece = a.piece(leaf as usize);
                touching.search(a.placed(&piece), &b, accuracy, work);
                Ok::<_, Infallible>(touching.flow())
            });
        }
    }
    touching.certificate
}

/// What is known of the pieces looked at so far.
struct Touching {
    certificate: Certificate,
}

impl Touching {
    fn nothing() -> Self {
        Self {
            certificate: Certificate {
                verdict: Verdict::Miss,
                bound: Bound::new(0.0, f64::INFINITY),
                method: Method::Bounds,
                stop: Stop::Tolerance,
                iterations: 0,
            },
        }
    }

    /// A piece that surely touches ends the search.
    fn flow(&self) -> ControlFlow<()> {
        if self.certificate.verdict == Verdict::Hit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn search(&mut self, a: PlacedConvex<'_>, b: &Surface<'_>, accuracy: &Accuracy, work: &mut Work) {
        let Ok(()) = b.mesh.tree().visit_box(b.box_of(a), ALL_LAYERS, work, |work, leaf| {
            let piece = b.piece(leaf as usize);
            self.take(convex::overlap(a, b.placed(&piece), accuracy, work));
            Ok::<_, Infallible>(self.flow())
        });
    }

    fn take(&mut self, piece: Certificate) {
        let known = self.certificate;
        let verdict = match (known.verdict, piece.verdict) {
            (Verdict::Hit, _) | (_, Verdict::Hit) => Verdict::Hit,
            (Verdict::Undecided, _) | (_, Verdict::Undecided) => Verdict::Undecided,
            (Verdict::Miss, Verdict::Miss) => Verdict::Miss,
        };
        let lower = match verdict {
            // Pieces not looked at may be deeper.
            Verdict::Hit => f64::NEG_INFINITY,
            Verdict::Undecided | Verdict::Miss => known.bound.lower.min(piece.bound.lower),
        };
        let is_news = piece.verdict == verdict;
        self.certificate = Certificate {
            verdict,
            bound: Bound::new(lower, known.bound.upper.min(piece.bound.upper)),
            method: if is_news { piece.method } else { known.method },
            stop: if is_news { piece.stop } else { known.stop },
            iterations: known.iterations.saturating_add(piece.iterations),
        };
    }
}

/// Contacts of a convex form with the triangles of a mesh whose gap is not proved to be above `max_gap` metres, by
/// triangle.
///
/// # Errors
/// [`NeedsDecomposition`] if both are meshes.
pub(in crate::narrow) fn penetration(
    a: Placed<'_>,
    b: Placed<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Result<Contacts, NeedsDecomposition> {
    let mut contacts = Contacts::new();
    match (Side::of(a), Side::of(b)) {
        (Side::Convex(a), Side::Convex(b)) => {
            return Ok(convex::penetration(a, b, max_gap, accuracy, work).into_iter().collect());
        }
        (Side::Surface(_), Side::Surface(_)) => return Err(NeedsDecomposition),
        (Side::Convex(a), Side::Surface(b)) => near(a, &b, max_gap, work, |piece, face, work| {
            if let Some(mut contact) = convex::penetration(a, piece, max_gap, accuracy, work) {
                contact.feature_b.face = face;
                contacts.push(contact);
            }
        }),
        (Side::Surface(a), Side::Convex(b)) => near(b, &a, max_gap, work, |piece, face, work| {
            if let Some(mut contact) = convex::penetration(piece, b, max_gap, accuracy, work) {
                contact.feature_a.face = face;
                contacts.push(contact);
            }
        }),
    }
    contacts.sort_by_key(|contact| (contact.feature_a.face, contact.feature_b.face));
    Ok(contacts)
}

/// Calls `visit` with each triangle that may be within `max_gap` of a convex form.
fn near(
    other: PlacedConvex<'_>,
    surface: &Surface<'_>,
    max_gap: f64,
    work: &mut Work,
    mut visit: impl FnMut(PlacedConvex<'_>, Option<u32>, &mut Work),
) {
    let around = surface.box_of(other).inflated(max_gap);
    let Ok(()) = surface.mesh.tree().visit_box(around, ALL_LAYERS, work, |work, leaf| {
        let piece = surface.piece(leaf as usize);
        visit(surface.placed(&piece), surface.face(leaf as usize), work);
        Ok::<_, Infallible>(ControlFlow::Continue(()))
    });
}
