//! How far a concave form is from another form.

use glam::DVec3;
use smallvec::SmallVec;

use super::{
    Next, Ordered, Side,
    inside::{Held, held},
    matter::Met,
    next,
    rod::Rod,
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Feature, Method, Model, Stop, Verdict, Work},
    narrow::{Placed, Separation, convex},
};

/// How far apart `a` and `b` are, one of them concave; `None` if that is proved to be beyond `limit` metres.
pub(in crate::narrow) fn distance(
    a: Placed<'_>,
    b: Placed<'_>,
    limit: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<Separation> {
    let Ordered { first, second, is_swapped, origin } = Ordered::new(a, b);
    let mut nearest = Nearest::within(limit);
    nearest.search(&first, &second, accuracy, work);
    let mut found = nearest.merged()?;
    found.point_on_a += origin;
    found.point_on_b += origin;
    Some(if is_swapped { found.swapped() } else { found })
}

/// All that may be nearest.
struct Nearest {
    /// As many as triangles meet at a usual vertex have room here.
    candidates: SmallVec<[Separation; 8]>,
    /// Nothing farther counts: what was asked, and what is proved.
    limit: f64,
    asked: f64,
    /// One of the forms may lie inside the other, so that they touch.
    may_be_inside: bool,
}

impl Nearest {
    fn within(limit: f64) -> Self {
        Self { candidates: SmallVec::new(), limit, asked: limit, may_be_inside: false }
    }

    /// Measures what may be nearest of two forms.
    fn search(&mut self, a: &Side<'_>, b: &Side<'_>, accuracy: &Accuracy, work: &mut Work) {
        match held(a, b, work) {
            Held::No => self.search_pieces(a, b, accuracy, work),
            Held::Surely(point) => self.offer(touching_at(point)),
            Held::Open => {
                // The surface is near then, if not as near as was asked; it bounds the distance above.
                self.may_be_inside = true;
                self.limit = if self.candidates.is_empty() { f64::INFINITY } else { self.limit };
                self.search_pieces(a, b, accuracy, work);
            }
        }
    }

    /// Measures what may be nearest of two forms, nearest pieces first.
    fn search_pieces(&mut self, a: &Side<'_>, b: &Side<'_>, accuracy: &Accuracy, work: &mut Work) {
        match next(a, b) {
            Next::Ask(a, b) => {
                if let Some(mut found) = convex::distance(a.placed(), b.placed(), self.limit, accuracy, work) {
                    (found.feature_a, found.feature_b) = (a.feature, b.feature);
                    self.offer(found);
                }
            }
            Next::AskSpace(form, space) => {
                if let Some((pair, feature)) = space.below(form)
                    && let Some(mut found) = pair.distance(self.limit, work)
                {
                    found.feature_a.part = feature.part;
                    self.offer(found);
                }
            }
            Next::SplitFirst(a, b) => {
                self.meet(Met::of_pair(a, b, work));
                a.nearest_to(a.box_of(b), self.limit, work, |piece, work| {
                    self.search(&piece, b, accuracy, work);
                    self.limit
                });
            }
            Next::SplitSecond(a, b) => {
                self.meet(Met::of_pair(b, a, work).map(Met::swapped));
                let mut rod = Rod::of(a, b);
                let query = rod.as_ref().map_or_else(|| b.box_of(a), Rod::bounds);
                b.nearest_to(query, self.limit, work, |piece, work| {
                    if rod.as_mut().is_some_and(|rod| rod.is_beyond(&piece, self.limit)) {
                        work.pairs_tested += 1;
                    } else {
                        self.search(a, &piece, accuracy, work);
                    }
                    self.limit
                });
            }
        }
    }

    /// What lies in the other's matter is at distance 0.
    fn meet(&mut self, met: Option<Met>) {
        if let Some(met) = met {
            self.offer(met.separation());
        }
    }

    fn offer(&mut self, found: Separation) {
        // Where intervals are wide nearly all stay: looking through them each time would cost their square.
        if found.certificate.bound.upper < self.limit {
            self.limit = found.certificate.bound.upper;
            let limit = self.limit;
            self.candidates.retain(|known| known.certificate.bound.lower <= limit);
        }
        if found.certificate.bound.lower <= self.limit {
            self.candidates.push(found);
        }
    }

    /// The nearest, bounded by all that may be; of equals that of the least piece.
    fn merged(self) -> Option<Separation> {
        let bounds = || self.candidates.iter().map(|candidate| candidate.certificate.bound);
        let least = bounds().map(|bound| bound.lower).fold(f64::INFINITY, f64::min);
        let lower = if self.may_be_inside { 0.0 } else { least };
        let upper = bounds().map(|bound| bound.upper).fold(f64::INFINITY, f64::min);
        let winner = self.candidates.iter().min_by(|a, b| {
            let pieces = |found: &Separation| (found.feature_a, found.feature_b);
            a.distance.total_cmp(&b.distance).then_with(|| pieces(a).cmp(&pieces(b)))
        });
        let mut merged = *winner?;
        // What may be nearer than the winner is why the interval is as wide as it is.
        if lower < merged.certificate.bound.lower {
            let nearest = self.candidates.iter().find(|found| found.certificate.bound.lower == lower);
            merged.certificate.stop = nearest.map_or(Stop::Converged, |found| found.certificate.stop);
        }
        merged.certificate.bound = Bound::new(lower, upper);
        merged.certificate.verdict = if upper <= self.asked { Verdict::Hit } else { Verdict::Undecided };
        merged.distance = merged.distance.clamp(lower, upper);
        Some(merged)
    }
}

/// The distance of a form that holds a point of the other.
fn touching_at(point: DVec3) -> Separation {
    Separation {
        distance: 0.0,
        point_on_a: point,
        point_on_b: point,
        normal_b_to_a: None,
        feature_a: Feature::default(),
        feature_b: Feature::default(),
        certificate: Certificate {
            verdict: Verdict::Hit,
            bound: Bound::new(0.0, 0.0),
            model: Model::EXACT,
            method: Method::ClosedForm,
            stop: Stop::Converged,
            iterations: 1,
        },
    }
}
