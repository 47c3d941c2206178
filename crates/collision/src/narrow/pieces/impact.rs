//! The first touch of a concave form and another form, in motion.

use glam::DVec3;
use smallvec::SmallVec;

use super::{
    Next, Ordered, Piece, Side, facet,
    inside::{Held, held, instant_held},
    matter::Met,
    next, overlap,
    sweep::{Span, swept, turned},
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Feature, Method, Model, Stop, Verdict, Work},
    narrow::{ImpactTouch, InitialTouch, Motion, Placed},
};

/// The first touch of `a` and `b`, one of them concave; `None` is a proof that the way is free. An initial touch that is
/// ignored is so piece by piece.
pub(in crate::narrow) fn impact(
    a: Placed<'_>,
    b: Placed<'_>,
    motion: &Motion,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Option<ImpactTouch> {
    let Ordered { first: side_a, second: side_b, is_swapped, origin } = Ordered::new(a, b);
    let (a, b, motion) = if is_swapped { (b, a, &motion.swapped()) } else { (a, b, motion) };
    let mut first = First::default();
    first.search(&side_a, &side_b, &Ask { motion, accuracy, skin: Skin::FromBothSides, span: None }, work);
    let Candidate { mut touch, feature_a } = first.winner()?;
    touch.point += origin;
    let Certificate { verdict, bound: Bound { lower, .. }, .. } = touch.certificate;
    if verdict == Verdict::Undecided
        && (motion.initial == InitialTouch::Counts || overlap(a, b, accuracy, work).verdict == Verdict::Miss)
        && let Some(instant) = instant_held(a, b, motion, lower, work)
    {
        touch.certificate =
            Certificate { verdict: Verdict::Hit, bound: Bound::new(lower, instant), ..touch.certificate };
        touch.fraction = touch.fraction.clamp(lower, instant);
    }
    if !is_swapped {
        return Some(touch);
    }
    let normal_b_to_a = touch.normal_b_to_a.map(|normal| DVec3::ZERO - normal);
    Some(ImpactTouch { normal_b_to_a, feature_b: feature_a, ..touch })
}

/// What is asked of each pair of pieces.
#[derive(Clone, Copy)]
struct Ask<'a> {
    motion: &'a Motion,
    accuracy: &'a Accuracy,
    skin: Skin,
    /// In which part of the motion pieces are sought; `None` if that is to be chosen.
    span: Option<Span>,
}

/// How skin may be touched.
#[derive(Clone, Copy, PartialEq)]
enum Skin {
    FromBothSides,
    /// The form begins inside, which is ignored: it goes out without a touch.
    FromOutside,
}

impl Ask<'_> {
    /// Whether a touch is that of a form that goes out of the matter in which it began.
    fn leaves(&self, a: &Piece<'_>, b: &Piece<'_>, touch: &ImpactTouch) -> bool {
        if self.skin == Skin::FromBothSides {
            return false;
        }
        let Motion { displacement_a, displacement_b, rotation_a, rotation_b, .. } = *self.motion;
        // How fast a piece moves where they touch.
        let velocity = |piece: &Piece<'_>, displacement: DVec3, rotation: DVec3| {
            let pivot = piece.place.pose.position - piece.place.arm + displacement * touch.fraction;
            displacement + rotation.cross(touch.point - pivot)
        };
        let ahead = velocity(a, displacement_a, rotation_a) - velocity(b, displacement_b, rotation_b);
        let goes_out = |skin: &Piece<'_>, rotation: DVec3, way: DVec3| {
            skin.outward().is_some_and(|outward| turned(rotation * touch.fraction, outward).dot(way) > 0.0)
        };
        goes_out(b, rotation_b, ahead) || goes_out(a, rotation_a, DVec3::ZERO - ahead)
    }
}

/// A touch, and where it is on the first form.
#[derive(Clone, Copy)]
struct Candidate {
    touch: ImpactTouch,
    feature_a: Feature,
}

/// All that may be the first touch.
pub(in crate::narrow) struct First {
    candidates: SmallVec<[Candidate; 2]>,
    /// The first certain touch is not later than this.
    limit: f64,
}

impl Default for First {
    fn default() -> Self {
        Self { candidates: SmallVec::new(), limit: 1.0 }
    }
}

impl First {
    fn search(&mut self, a: &Side<'_>, b: &Side<'_>, ask: &Ask<'_>, work: &mut Work) {
        if ask.motion.initial == InitialTouch::Counts {
            match held(a, b, work) {
                Held::No => {}
                Held::Surely(point) => return self.take(beginning_inside(point, Verdict::Hit)),
                Held::Open => self.take(beginning_inside(a.place().pose.position, Verdict::Undecided)),
            }
        }
        if ask.span.is_some() {
            return self.search_pieces(a, b, ask, work);
        }
        for span in Span::of(a, b, ask.motion) {
            if span.reaches(self.limit) < 0.0 {
                break;
            }
            self.search_pieces(a, b, &Ask { span: Some(span), ..*ask }, work);
        }
    }

    fn search_pieces(&mut self, a: &Side<'_>, b: &Side<'_>, ask: &Ask<'_>, work: &mut Work) {
        match next(a, b) {
            Next::Ask(a, b) => {
                let touch = facet::impact(a, b, (ask.motion, self.limit), ask.accuracy, work);
                if let Some(touch) = touch.filter(|touch| !ask.leaves(a, b, touch)) {
                    self.take(Candidate { touch: ImpactTouch { feature_b: b.feature, ..touch }, feature_a: a.feature });
                }
            }
            Next::AskSpace(form, space) => {
                if let Some((pair, feature_a)) = space.below(form)
                    && let Some(touch) = pair.impact(ask.motion, ask.accuracy, work)
                {
                    self.take(Candidate { touch, feature_a });
                }
            }
            Next::SplitFirst(a, b) => {
                let ask = &self.meet(Met::of_pair(a, b, work), ask);
                let span = ask.span.unwrap_or(Span::WHOLE);
                let (path, _) = swept(a, b, &ask.motion.swapped(), span);
                a.along(&path, span.reaches(self.limit), work, |piece, work| {
                    self.search(&piece, b, ask, work);
                    span.reaches(self.limit)
                });
            }
            Next::SplitSecond(a, b) => {
                let ask = &self.meet(Met::of_pair(b, a, work).map(Met::swapped), ask);
                let span = ask.span.unwrap_or(Span::WHOLE);
                let (path, rod) = swept(b, a, ask.motion, span);
                b.along(&path, span.reaches(self.limit), work, |piece, work| {
                    if rod.as_ref().is_some_and(|rod| rod.is_clear_of(&piece, self.limit)) {
                        work.pairs_tested += 1;
                    } else {
                        self.search(a, &piece, ask, work);
                    }
                    span.reaches(self.limit)
                });
            }
        }
    }

    /// What lies in the other's matter touches it at the start, or is passed over; what is asked of the pieces then.
    fn meet<'a>(&mut self, met: Option<Met>, ask: &Ask<'a>) -> Ask<'a> {
        match (met, ask.motion.initial) {
            (None, _) => *ask,
            (Some(_), InitialTouch::IsIgnored) => Ask { skin: Skin::FromOutside, ..*ask },
            (Some(met), InitialTouch::Counts) => {
                let (touch, feature_a) = met.initial_touch();
                self.take(Candidate { touch, feature_a });
                *ask
            }
        }
    }

    /// Takes a touch, unless another is surely before it.
    pub(in crate::narrow) fn offer(&mut self, touch: Option<ImpactTouch>) {
        if let Some(touch) = touch {
            self.take(Candidate { touch, feature_a: Feature::default() });
        }
    }

    fn take(&mut self, found: Candidate) {
        let certificate = &found.touch.certificate;
        if certificate.bound.lower > self.limit {
            return;
        }
        // Where intervals are wide nearly all stay: looking through them each time would cost their square.
        if certificate.verdict == Verdict::Hit && certificate.bound.upper < self.limit {
            self.limit = certificate.bound.upper;
            let limit = self.limit;
            self.candidates.retain(|known| known.touch.certificate.bound.lower <= limit);
        }
        self.candidates.push(found);
    }

    /// The earliest certain touch, or else the earliest open one; its bound reaches down to whatever may come before it.
    pub(in crate::narrow) fn merged(self) -> Option<ImpactTouch> {
        self.winner().map(|winner| winner.touch)
    }

    fn winner(self) -> Option<Candidate> {
        let touches = || self.candidates.iter().map(|candidate| &candidate.touch);
        let is_certain = touches().any(|touch| touch.certificate.verdict == Verdict::Hit);
        let verdict = if is_certain { Verdict::Hit } else { Verdict::Undecided };
        let those = || self.candidates.iter().filter(|candidate| candidate.touch.certificate.verdict == verdict);
        let lower = touches().map(|touch| touch.certificate.bound.lower).fold(f64::INFINITY, f64::min);
        let upper = those().map(|candidate| candidate.touch.certificate.bound.upper);
        let upper = match verdict {
            Verdict::Hit => upper.fold(f64::INFINITY, f64::min),
            Verdict::Undecided | Verdict::Miss => upper.fold(f64::NEG_INFINITY, f64::max),
        };
        let winner = those().min_by(|a, b| {
            let pieces = |found: &Candidate| (found.feature_a, found.touch.feature_b);
            a.touch.fraction.total_cmp(&b.touch.fraction).then_with(|| pieces(a).cmp(&pieces(b)))
        });
        let mut winner = *winner?;
        // What leaves open a time before the winner's is why the interval is as wide as it is.
        if lower < winner.touch.certificate.bound.lower {
            let is_first = |touch: &&ImpactTouch| touch.certificate.bound.lower == lower;
            winner.touch.certificate.stop =
                touches().find(is_first).map_or(winner.touch.certificate.stop, |touch| touch.certificate.stop);
        }
        winner.touch.certificate.bound = Bound::new(lower, upper);
        winner.touch.fraction = winner.touch.fraction.clamp(lower, upper);
        Some(winner)
    }
}

/// The touch of forms of which one may hold the other at the start.
fn beginning_inside(point: DVec3, verdict: Verdict) -> Candidate {
    let certificate = Certificate {
        verdict,
        bound: Bound::new(0.0, 0.0),
        model: Model::EXACT,
        method: Method::ClosedForm,
        stop: Stop::Converged,
        iterations: 1,
    };
    let feature = Feature::default();
    let touch =
        ImpactTouch { fraction: 0.0, point, normal_b_to_a: None, initial: true, feature_b: feature, certificate };
    Candidate { touch, feature_a: feature }
}
