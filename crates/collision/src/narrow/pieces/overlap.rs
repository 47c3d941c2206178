//! Whether a concave form touches another form.

use std::ops::ControlFlow;

use super::{
    Next, Ordered, Side,
    inside::{Held, held},
    matter::Met,
    next,
    rod::Rod,
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Method, Model, Stop, Verdict, Work},
    narrow::{Placed, convex},
};

/// Whether `a` and `b` touch, one of them concave. The bound is that of the least signed distance of their pieces: above 0
/// only a lower bound of 0 is given, since what lies farther off is not measured. Where a body that is known by its surface is
/// touched, or may be, there is no lower bound.
pub(in crate::narrow) fn overlap(a: Placed<'_>, b: Placed<'_>, accuracy: &Accuracy, work: &mut Work) -> Certificate {
    let Ordered { first, second, .. } = Ordered::new(a, b);
    overlap_of(&first, &second, accuracy, work)
}

/// The same of two sides.
pub(super) fn overlap_of(a: &Side<'_>, b: &Side<'_>, accuracy: &Accuracy, work: &mut Work) -> Certificate {
    let mut touching = Touching::nothing();
    touching.search(a, b, accuracy, work);
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
                model: Model::EXACT,
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

    fn search(&mut self, a: &Side<'_>, b: &Side<'_>, accuracy: &Accuracy, work: &mut Work) {
        self.search_pieces(a, b, accuracy, work);
        if self.certificate.verdict != Verdict::Hit {
            self.take_held(held(a, b, work));
        }
    }

    /// What is known once it is told whether one of the forms is inside the other.
    fn take_held(&mut self, held: Held) {
        let (verdict, upper) = match held {
            Held::No => return,
            Held::Surely(_) => (Verdict::Hit, 0.0),
            Held::Open => (Verdict::Undecided, f64::INFINITY),
        };
        self.take(Certificate {
            verdict,
            bound: Bound::new(f64::NEG_INFINITY, upper),
            model: Model::EXACT,
            method: Method::ClosedForm,
            stop: Stop::Converged,
            iterations: 1,
        });
    }

    fn search_pieces(&mut self, a: &Side<'_>, b: &Side<'_>, accuracy: &Accuracy, work: &mut Work) {
        match next(a, b) {
            Next::Ask(a, b) => {
                let mut found = convex::overlap(a.placed(), b.placed(), accuracy, work);
                // How deep a form lies in a body, its surface does not tell.
                if found.verdict == Verdict::Undecided && (a.bounds_matter() || b.bounds_matter()) {
                    found.bound.lower = f64::NEG_INFINITY;
                }
                self.take(found);
            }
            Next::AskSpace(form, space) => {
                if let Some((pair, _)) = space.below(form) {
                    self.take(pair.overlap(work));
                }
            }
            Next::SplitFirst(a, b) => {
                if self.meet(Met::of_pair(a, b, work)).is_continue() {
                    a.in_box(a.box_of(b), work, |piece, work| {
                        self.search(&piece, b, accuracy, work);
                        self.flow()
                    });
                }
            }
            Next::SplitSecond(a, b) => {
                if self.meet(Met::of_pair(b, a, work)).is_continue() {
                    let rod = Rod::of(a, b);
                    let query = rod.as_ref().map_or_else(|| b.box_of(a), Rod::bounds);
                    b.in_box(query, work, |piece, work| {
                        if rod.as_ref().is_some_and(|rod| rod.is_clear_of(&piece, 1.0)) {
                            work.pairs_tested += 1;
                        } else {
                            self.search(a, &piece, accuracy, work);
                        }
                        self.flow()
                    });
                }
            }
        }
    }

    /// What lies in the other's matter touches it.
    fn meet(&mut self, met: Option<Met>) -> ControlFlow<()> {
        if let Some(met) = met {
            self.take(met.overlap());
        }
        self.flow()
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
            model: Model::EXACT,
            method: if is_news { piece.method } else { known.method },
            stop: if is_news { piece.stop } else { known.stop },
            iterations: known.iterations.saturating_add(piece.iterations),
        };
    }
}
