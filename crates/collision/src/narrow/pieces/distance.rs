//! How far a mesh is from another form.

use std::convert::Infallible;

use smallvec::SmallVec;

use super::{Side, Surface, is_swapped};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Verdict, Work},
    broad::{ALL_LAYERS, Tree},
    narrow::{
        Placed, Separation,
        convex::{self, PlacedConvex},
    },
};

/// How far apart `a` and `b` are, one of them a mesh; `None` if that is proved to be beyond `limit` metres.
pub(in crate::narrow) fn distance(
    a: Placed<'_>,
    b: Placed<'_>,
    limit: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Separation> {
    let mut nearest = Nearest::within(limit);
    match (Side::of(a), Side::of(b)) {
        (Side::Convex(a), Side::Convex(b)) => return convex::distance(a, b, limit, accuracy, work),
        (Side::Convex(a), Side::Surface(b)) => search(a, None, &b, &mut nearest, accuracy, work),
        (Side::Surface(a), Side::Convex(b)) => {
            search(b, None, &a, &mut nearest, accuracy, work);
            return nearest.merged().map(Separation::swapped);
        }
        (Side::Surface(a), Side::Surface(b)) if is_swapped(&a, &b) => {
            surfaces(&b, &a, &mut nearest, accuracy, work);
            return nearest.merged().map(Separation::swapped);
        }
        (Side::Surface(a), Side::Surface(b)) => surfaces(&a, &b, &mut nearest, accuracy, work),
    }
    nearest.merged()
}

fn surfaces(a: &Surface<'_>, b: &Surface<'_>, nearest: &mut Nearest, accuracy: &Accuracy, work: &mut Work) {
    let near_b = a.box_of_surface(b);
    let limit = nearest.limit;
    let Ok(()) = a.mesh.tree().visit_nearest(near_b, limit, ALL_LAYERS, work, |work, leaf| {
        let triangle = leaf as usize;
        let piece = a.piece(triangle);
        search(a.placed(&piece), a.face(triangle), b, nearest, accuracy, work);
        Ok::<f64, Infallible>(nearest.limit)
    });
}

/// Measures a convex form (a triangle has a face number) against the triangles of a mesh, nearest first.
fn search(
    a: PlacedConvex<'_>,
    face_a: Option<u32>,
    b: &Surface<'_>,
    nearest: &mut Nearest,
    accuracy: &Accuracy,
    work: &mut Work,
) {
    let limit = nearest.limit;
    let Ok(()) = b.mesh.tree().visit_nearest(b.box_of(a), limit, ALL_LAYERS, work, |work, leaf| {
        let triangle = leaf as usize;
        let piece = b.piece(triangle);
        if let Some(mut found) = convex::distance(a, b.placed(&piece), nearest.limit, accuracy, work) {
            found.feature_a.face = face_a;
            found.feature_b.face = b.face(triangle);
            nearest.offer(found);
        }
        Ok::<f64, Infallible>(nearest.limit)
    });
}

/// All that may be nearest.
struct Nearest {
    /// As many as triangles meet at a usual vertex have room here.
    candidates: SmallVec<[Separation; 8]>,
    /// Nothing farther counts: what was asked, and what is proved.
    limit: f64,
    asked: f64,
}

impl Nearest {
    fn within(limit: f64) -> Self {
        Self { candidates: SmallVec::new(), limit, asked: limit }
    }

    fn offer(&mut self, found: Separation) {
        self.limit = self.limit.min(found.certificate.bound.upper);
        let limit = self.limit;
        self.candidates.retain(|known| known.certificate.bound.lower <= limit);
        if found.certificate.bound.lower <= limit {
            self.candidates.push(found);
        }
    }

    /// The nearest, bounded by all that may be; of equals that of the least face.
    fn merged(self) -> Option<Separation> {
        let bounds = || self.candidates.iter().map(|candidate| candidate.certificate.bound);
        let lower = bounds().map(|bound| bound.lower).fold(f64::INFINITY, f64::min);
        let upper = bounds().map(|bound| bound.upper).fold(f64::INFINITY, f64::min);
        let winner = self.candidates.iter().min_by(|a, b| {
            let faces = |found: &Separation| (found.feature_a.face, found.feature_b.face);
            a.distance.total_cmp(&b.distance).then_with(|| faces(a).cmp(&faces(b)))
        });
        let mut merged = *winner?;
        merged.certificate.bound = Bound::new(lower, upper);
        merged.certificate.verdict = if upper <= self.asked { Verdict::Hit } else { Verdict::Undecided };
        merged.distance = merged.distance.clamp(lower, upper);
        Some(merged)
    }
}
