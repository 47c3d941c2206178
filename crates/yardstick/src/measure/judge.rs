//! Whether an answer holds the truth, and how far it is off.

use std::collections::HashMap;

use collision::{
    answer::{Bound, Verdict},
    world::ShapeId,
};

use super::{
    Kind,
    ask::{Answer, Found},
};

/// What an answer is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Judged {
    /// How far the value is from the truth, metres; of an overlap 1 if something is left open, else 0.
    pub(super) error: f64,
    /// How wide its interval is, metres; 0 without one.
    pub(super) width: f64,
    /// Something is left open.
    pub(super) is_open: bool,
    /// A stand-in answered.
    pub(super) stood_in: bool,
}

/// What is true of a question.
pub(super) struct Truth<'a> {
    pub(super) kind: Kind,
    /// What the exact tier says.
    pub(super) exact: &'a Answer,
    /// The same of one shape alone.
    pub(super) about: &'a dyn Fn(ShapeId) -> Option<Found>,
    /// How deep a contact is along its own normal, and how far that may be off, if it is one with a triangle.
    pub(super) along: &'a dyn Fn(&Found) -> Option<Vec<[f64; 2]>>,
}

fn meets(a: Bound, b: Bound) -> bool {
    a.lower <= b.upper && b.lower <= a.upper
}

/// Where the truth most likely is.
fn middle(found: &Found) -> f64 {
    let Bound { lower, upper } = found.bound;
    if (upper - lower).is_finite() { 0.5 * (lower + upper) } else { found.value }
}

impl Truth<'_> {
    /// What an answer is worth.
    ///
    /// # Errors
    /// A sentence that says in what it lies.
    pub(super) fn judge(&self, answer: &Answer, outside: &HashMap<ShapeId, f64>) -> Result<Judged, String> {
        let widened: Vec<Found> = answer.found.iter().map(|found| self.widened(found, outside)).collect();
        for found in &widened {
            let Bound { lower, upper } = found.bound;
            let is_value = self.kind != Kind::Overlap;
            let is_sound = lower <= upper && found.value.is_finite();
            let is_within = lower <= found.value && found.value <= upper;
            if !is_sound || is_value && !is_within {
                return Err(format!("{:e} in [{lower:e}, {upper:e}] of shape {}", found.value, found.id));
            }
        }
        let answer = &Answer { found: widened, ..answer.clone() };
        let mut judged = match self.kind {
            Kind::Overlap => self.overlap(answer)?,
            Kind::Penetration => self.contacts(answer, outside)?,
            Kind::Raycast | Kind::Distance | Kind::Impact | Kind::TurningImpact => self.closest(answer)?,
        };
        judged.stood_in = answer.found.iter().any(|found| found.stood_in);
        Ok(judged)
    }

    /// What an answer of a form that lies in the one sent says of that.
    fn widened(&self, found: &Found, outside: &HashMap<ShapeId, f64>) -> Found {
        let Some(off) = outside.get(&found.id) else { return *found };
        let Bound { lower, upper } = found.bound;
        let bound = match self.kind {
            Kind::Penetration => Bound::new(lower, (upper + off).next_up()),
            _ => Bound::new((lower - off).next_down().max(0.0), upper),
        };
        Found { bound, ..*found }
    }

    fn closest(&self, answer: &Answer) -> Result<Judged, String> {
        let (said, truth) = (answer.main(), self.exact.main());
        let is_open = answer.found.iter().any(|found| found.verdict == Verdict::Undecided);
        if answer.verdict == Verdict::Miss && self.exact.verdict == Verdict::Hit {
            return Err(format!("MISS, the truth is {truth:?}"));
        }
        let Some(said) = said else { return Ok(Judged { is_open, ..Judged::default() }) };
        let own = truth.copied().filter(|truth| truth.id == said.id).or_else(|| (self.about)(said.id));
        match own {
            None if said.verdict == Verdict::Hit => return Err(format!("{said:?}, the truth is MISS")),
            Some(own) if !meets(said.bound, own.bound) => return Err(format!("{said:?}, the truth is {own:?}")),
            None | Some(_) => {}
        }
        // Of shapes whose intervals overlap the closest is the one of the least best value: the true first is what the error is from.
        let error = truth.map_or(0.0, |truth| (said.value - middle(truth)).abs());
        Ok(Judged { error, width: said.bound.width(), is_open, stood_in: false })
    }

    fn overlap(&self, answer: &Answer) -> Result<Judged, String> {
        let true_of: HashMap<ShapeId, &Found> = self.exact.found.iter().map(|found| (found.id, found)).collect();
        let said_of: HashMap<ShapeId, &Found> = answer.found.iter().map(|found| (found.id, found)).collect();
        for said in &answer.found {
            match true_of.get(&said.id) {
                None if said.verdict == Verdict::Hit => return Err(format!("{said:?}, the truth is MISS")),
                Some(truth) if !meets(said.bound, truth.bound) => {
                    return Err(format!("{said:?}, the truth is {truth:?}"));
                }
                None | Some(_) => {}
            }
        }
        let is_lost = |truth: &&Found| truth.verdict == Verdict::Hit && !said_of.contains_key(&truth.id);
        if let Some(lost) = self.exact.found.iter().find(is_lost) {
            return Err(format!("MISS of shape {}, the truth is {lost:?}", lost.id));
        }
        let is_open = answer.found.iter().any(|found| found.verdict == Verdict::Undecided);
        Ok(Judged { error: f64::from(u8::from(is_open)), is_open, ..Judged::default() })
    }

    fn contacts(&self, answer: &Answer, outside: &HashMap<ShapeId, f64>) -> Result<Judged, String> {
        let of = |all: &[Found], id: ShapeId| all.iter().filter(|found| found.id == id).copied().collect::<Vec<_>>();
        for said in &answer.found {
            if let Some(depths) = (self.along)(said) {
                let holds = |&[depth, off]: &[f64; 2]| meets(said.bound, Bound::new(depth - off, depth + off));
                if !depths.is_empty() && !depths.iter().any(holds) {
                    return Err(format!("{said:?}, along its normal the depth is {depths:?}"));
                }
                continue;
            }
            let truths = of(&self.exact.found, said.id);
            let same = truths.iter().find(|truth| truth.features == said.features);
            let alone = || (truths.len() == 1 && of(&answer.found, said.id).len() == 1).then(|| &truths[0]);
            match same.or_else(alone) {
                Some(truth) if !meets(said.bound, truth.bound) => {
                    return Err(format!("{said:?}, the truth is {truth:?}"));
                }
                None if truths.is_empty() && said.verdict == Verdict::Hit => {
                    return Err(format!("{said:?}, the truth is MISS"));
                }
                None | Some(_) => {}
            }
        }
        // A form that lies in the one sent may be clear of what that touches by a little.
        let is_deep = |truth: &Found| outside.get(&truth.id).is_none_or(|off| truth.bound.lower > *off);
        let is_lost =
            |truth: &&Found| truth.verdict == Verdict::Hit && is_deep(truth) && of(&answer.found, truth.id).is_empty();
        if let Some(lost) = self.exact.found.iter().find(is_lost) {
            return Err(format!("no contact with shape {}, the truth is {lost:?}", lost.id));
        }
        let is_open = answer.found.iter().any(|found| found.verdict == Verdict::Undecided);
        let (Some(said), Some(truth)) = (answer.main(), self.exact.main()) else {
            return Ok(Judged { is_open, ..Judged::default() });
        };
        let error = (said.value - middle(truth)).abs();
        Ok(Judged { error, width: said.bound.width(), is_open, stood_in: false })
    }
}

#[cfg(test)]
mod tests {
    use collision::answer::{Feature, Work};

    use super::*;
    use crate::scenes::Scene;

    fn found(index: usize, lower: f64, upper: f64) -> Found {
        Found {
            id: Scene::id(index),
            features: [Feature::default(); 2],
            verdict: Verdict::Hit,
            bound: Bound::new(lower, upper),
            value: 0.5 * (lower + upper),
            normal: None,
            stood_in: false,
        }
    }

    fn answer(found: Vec<Found>) -> Answer {
        let verdict = if found.is_empty() { Verdict::Miss } else { Verdict::Hit };
        Answer { verdict, found, work: Work::default() }
    }

    fn judged(kind: Kind, said: Vec<Found>, exact: Vec<Found>) -> Result<Judged, String> {
        let exact = answer(exact);
        let about = |id: ShapeId| (id == Scene::id(7)).then(|| found(7, 4.0, 4.0));
        let truth = Truth { kind, exact: &exact, about: &about, along: &|_| None };
        truth.judge(&answer(said), &HashMap::from([(Scene::id(9), 0.5)]))
    }

    #[test]
    fn an_interval_without_the_truth_is_a_lie() {
        for kind in [Kind::Raycast, Kind::Distance, Kind::Penetration, Kind::Impact] {
            let of = |lower, upper| judged(kind, vec![found(0, lower, upper)], vec![found(0, 2.0, 2.0)]);
            assert!(of(1.0, 1.9).is_err() && of(2.1, 3.0).is_err(), "{kind:?}");
            let judged = of(1.5, 3.5).expect("it holds the truth");
            assert_eq!((judged.error, judged.width), (0.5, 2.0));
        }
    }

    #[test]
    fn a_verdict_against_a_proof_is_a_lie() {
        for kind in Kind::ALL {
            assert!(judged(kind, vec![], vec![found(0, -2.0, -2.0)]).is_err(), "{kind:?}: what is there is missed");
            assert!(judged(kind, vec![found(0, -2.0, -2.0)], vec![]).is_err(), "{kind:?}: nothing is there");
            assert!(judged(kind, vec![], vec![]).is_ok());
        }
    }

    #[test]
    fn another_shape_is_held_to_its_own_truth() {
        let of = |lower, upper| judged(Kind::Distance, vec![found(7, lower, upper)], vec![found(0, 3.9, 3.9)]);
        assert!(of(3.8, 4.2).is_ok_and(|judged| (judged.error - 0.1).abs() < 1e-9));
        assert!(of(3.8, 3.95).is_err());
    }

    #[test]
    fn a_simplified_hull_is_allowed_what_it_leaves_out() {
        let of = |kind, value| judged(kind, vec![found(9, 2.0, 2.0)], vec![found(9, value, value)]);
        assert!(of(Kind::Distance, 1.6).is_ok() && of(Kind::Distance, 1.4).is_err());
        assert!(of(Kind::Penetration, 2.4).is_ok() && of(Kind::Penetration, 2.6).is_err());
    }
}
