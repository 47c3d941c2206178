//! The first touch of a mesh and another form, in motion.

use std::{convert::Infallible, ops::ControlFlow};

use glam::DVec3;
use smallvec::SmallVec;

use super::{
    Side, Surface,
    sweep::{Mover, Passage, swept},
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Verdict, Work},
    broad::{ALL_LAYERS, Path, Tree},
    math::Aabb,
    narrow::{
        ImpactTouch, Motion, Placed,
        convex::{self, PlacedConvex},
    },
};

/// What is asked of each pair of pieces.
#[derive(Clone, Copy)]
struct Ask<'a> {
    motion: &'a Motion,
    accuracy: &'a Accuracy,
}

/// The first touch of `a` and `b`, one of them a mesh; `None` is a proof that the way is free. An initial touch that is
/// ignored is so triangle by triangle.
pub(in crate::narrow) fn impact(
    a: Placed<'_>,
    b: Placed<'_>,
    motion: &Motion,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<ImpactTouch> {
    let ask = Ask { motion, accuracy };
    let mut first = First::default();
    match (Side::of(a), Side::of(b)) {
        (Side::Convex(a), Side::Convex(b)) => first.offer(ask.touch(a, b, None, work)),
        (Side::Convex(a), Side::Surface(b)) => first.search(a, &b, &ask, work),
        (Side::Surface(a), Side::Convex(b)) => {
            let swept = swept(&a, &Mover::convex(&a, b), &ask.of_b());
            along(&a, swept, first.limit, work, |work, triangle| {
                let piece = a.piece(triangle);
                // Named as if it were of `b`, so that of equal touches the one on the same triangle wins as with swapped roles.
                first.offer(ask.touch(a.placed(&piece), b, a.face(triangle), work));
                first.limit
            });
            let mut merged = first.merged()?;
            merged.feature_b.face = None;
            return Some(merged);
        }
        (Side::Surface(a), Side::Surface(b)) => {
            let swept = swept(&a, &Mover::surface(&a, &b), &ask.of_b());
            along(&a, swept, first.limit, work, |work, triangle| {
                let piece = a.piece(triangle);
                first.search(a.placed(&piece), &b, &ask, work);
                first.limit
            });
        }
    }
    first.merged()
}

impl Ask<'_> {
    /// How `a` moves, as seen by `b`.
    fn of_a(&self) -> Passage {
        let Motion { displacement_a, displacement_b, rotation_a, rotation_b, .. } = *self.motion;
        Passage { way: displacement_a - displacement_b, turn: rotation_a, turn_of_mesh: rotation_b }
    }

    /// How `b` moves, as seen by `a`.
    fn of_b(&self) -> Passage {
        let Passage { way, turn, turn_of_mesh } = self.of_a();
        Passage { way: -way, turn: turn_of_mesh, turn_of_mesh: turn }
    }

    fn touch(
        &self,
        a: PlacedConvex<'_>,
        b: PlacedConvex<'_>,
        face_b: Option<u32>,
        work: &mut Work,
    ) -> Option<ImpactTouch> {
        let mut touch = convex::impact(a, b, self.motion, self.accuracy, work)?;
        touch.feature_b.face = face_b;
        Some(touch)
    }
}

/// Visits the triangles of a mesh that a path may meet at a fraction of at most `limit`; the visitor returns the new limit.
fn along(
    surface: &Surface<'_>,
    path: Path,
    limit: f64,
    work: &mut Work,
    mut visit: impl FnMut(&mut Work, usize) -> f64,
) {
    let tree = surface.mesh.tree();
    if path.direction == DVec3::ZERO {
        let mover = Aabb::new(path.origin - path.reach, path.origin + path.reach);
        let Ok(()) = tree.visit_box(mover, ALL_LAYERS, work, |work, leaf| {
            visit(work, leaf as usize);
            Ok::<_, Infallible>(ControlFlow::Continue(()))
        });
        return;
    }
    let Ok(()) =
        tree.visit_ray(&path, limit, ALL_LAYERS, work, |work, leaf| Ok::<f64, Infallible>(visit(work, leaf as usize)));
}

/// All that may be the first touch.
pub(in crate::narrow) struct First {
    candidates: SmallVec<[ImpactTouch; 2]>,
    /// The first certain touch is not later than this.
    limit: f64,
}

impl Default for First {
    fn default() -> Self {
        Self { candidates: SmallVec::new(), limit: 1.0 }
    }
}

impl First {
    fn search(&mut self, a: PlacedConvex<'_>, b: &Surface<'_>, ask: &Ask<'_>, work: &mut Work) {
        let swept = swept(b, &Mover::convex(b, a), &ask.of_a());
        along(b, swept, self.limit, work, |work, triangle| {
            let piece = b.piece(triangle);
            self.offer(ask.touch(a, b.placed(&piece), b.face(triangle), work));
            self.limit
        });
    }

    /// Takes a touch, unless another is surely before it.
    pub(in crate::narrow) fn offer(&mut self, touch: Option<ImpactTouch>) {
        let Some(touch) = touch.filter(|touch| touch.certificate.bound.lower <= self.limit) else {
            return;
        };
        if touch.certificate.verdict == Verdict::Hit {
            self.limit = self.limit.min(touch.certificate.bound.upper);
        }
        let limit = self.limit;
        self.candidates.push(touch);
        self.candidates.retain(|known| known.certificate.bound.lower <= limit);
    }

    /// The earliest certain touch, or else the earliest open one; its bound reaches down to whatever may come before it.
    pub(in crate::narrow) fn merged(self) -> Option<ImpactTouch> {
        let is_certain = |touch: &&ImpactTouch| touch.certificate.verdict == Verdict::Hit;
        let verdict =
            if self.candidates.iter().any(|touch| is_certain(&touch)) { Verdict::Hit } else { Verdict::Undecided };
        let those = || self.candidates.iter().filter(|touch| touch.certificate.verdict == verdict);
        let lower = self.candidates.iter().map(|touch| touch.certificate.bound.lower);
        let lower = lower.fold(f64::INFINITY, f64::min);
        let upper = those().map(|touch| touch.certificate.bound.upper);
        let upper = match verdict {
            Verdict::Hit => upper.fold(f64::INFINITY, f64::min),
            Verdict::Undecided | Verdict::Miss => upper.fold(f64::NEG_INFINITY, f64::max),
        };
        let winner = those().min_by(|a, b| {
            let by_face = a.feature_b.face.cmp(&b.feature_b.face);
            a.fraction.total_cmp(&b.fraction).then(by_face)
        });
        let mut merged = *winner?;
        merged.certificate.bound = Bound::new(lower, upper);
        merged.fraction = merged.fraction.clamp(lower, upper);
        Some(merged)
    }
}
