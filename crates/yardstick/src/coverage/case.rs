//! Which question a number stands for.

use std::panic::{AssertUnwindSafe, catch_unwind};

use collision::accuracy::Tier;

use super::{
    forms::Kind,
    moves::{self, MoveQuestion, Movers, Turning, move_question},
    outcome::{Asked, Outcome},
    pairs::{Question, question},
    rays::{RayQuestion, ray_question},
    report::Labels,
    run::{Settings, examine, examine_ray},
    source::{ray_test_source, test_source},
    whole::convex_labels,
    whole_pairs::{self, WholeQuestion, whole_question},
    whole_rays::{self, WholeRay, whole_ray},
    wholes::Class,
};
use crate::{oracle::Truth, scene::Random};

/// One question of any sort.
pub(super) enum Case {
    Pair(Box<Question>, [Kind; 2]),
    Ray(Box<RayQuestion>, Kind),
    Move(Box<MoveQuestion>, Option<[Kind; 2]>),
    Whole(Box<WholeQuestion>),
    WholeRay(Box<WholeRay>),
}

/// How often each sort comes in a round of so many cases.
const ROUND: u64 = 20;
const PAIRS: u64 = 8;
const RAYS: u64 = 3;
const MOVES: u64 = 3;
const TURNS: u64 = 2;
const WHOLES: u64 = 2;
const WHOLE_RAYS: u64 = 1;

impl Case {
    /// The case of a number.
    pub(super) fn of(settings: &Settings, index: u64) -> Self {
        let mut random = Random::new(settings.seed ^ index.wrapping_mul(0xD134_2543_DE82_EF95));
        let seed = random.bits();
        let (a, b) = settings.kinds.unwrap_or_else(|| kinds(&mut random));
        let class = Class::ALL[(random.bits() % Class::ALL.len() as u64) as usize];
        let slot = index % ROUND;
        let of = |first: u64, count: u64| (first..first + count).contains(&slot);
        // The oracle knows no stretch of a ray that has no end.
        let bounded = if a == Kind::HalfSpace { b } else { a };
        if of(0, PAIRS) {
            Self::Pair(Box::new(question(seed, (a, b))), [a, b])
        } else if of(PAIRS, RAYS) {
            Self::Ray(Box::new(ray_question(seed, bounded)), bounded)
        } else if of(PAIRS + RAYS, MOVES) {
            Self::Move(Box::new(move_question(seed, Movers::Convex(a, b), Turning::No)), Some([a, b]))
        } else if of(PAIRS + RAYS + MOVES, TURNS) {
            Self::Move(Box::new(move_question(seed, Movers::Convex(a, b), Turning::Yes)), Some([a, b]))
        } else if of(PAIRS + RAYS + MOVES + TURNS, WHOLES) {
            Self::Whole(Box::new(whole_question(seed, class, b)))
        } else if of(PAIRS + RAYS + MOVES + TURNS + WHOLES, WHOLE_RAYS) {
            Self::WholeRay(Box::new(whole_ray(seed, class)))
        } else {
            let turning = if (index / ROUND).is_multiple_of(2) { Turning::No } else { Turning::Yes };
            Self::Move(Box::new(move_question(seed, Movers::Concave(class, b), turning)), None)
        }
    }

    /// What came of it; `None` if the crate refuses a form.
    pub(super) fn examine(&self) -> Option<Outcome> {
        let asked = self.asked();
        let examined = catch_unwind(AssertUnwindSafe(|| match self {
            Self::Pair(question, _) => examine(question).map(|(outcome, _)| outcome),
            Self::Ray(question, _) => examine_ray(question),
            Self::Move(question, _) => moves::examine(question),
            Self::Whole(question) => whole_pairs::examine(question),
            Self::WholeRay(question) => whole_rays::examine(question),
        }));
        examined.unwrap_or_else(|_| Some(Outcome::panicked(asked)))
    }

    fn asked(&self) -> Asked {
        match self {
            Self::Pair(..) | Self::Whole(_) => Asked::Distance,
            Self::Ray(..) | Self::WholeRay(_) => Asked::Ray,
            Self::Move(question, _) => question.asked(),
        }
    }

    /// What its answers are counted as.
    pub(super) fn labels(&self) -> Labels {
        match self {
            Self::Pair(question, kinds) => {
                let rounded = [&question.a.solid, &question.b.solid].into_iter().flat_map(convex_labels);
                let accuracy = accuracy_name(question.accuracy.tier, question.accuracy.max_error);
                convex(kinds, rounded.filter(|label| *label == "rounded").collect(), question.category, accuracy)
            }
            Self::Ray(question, kind) => {
                let rounded = convex_labels(&question.target.solid);
                let rounded = rounded.into_iter().filter(|label| *label == "rounded").collect();
                convex(&[*kind], rounded, question.category, "exact")
            }
            Self::Move(question, kinds) => {
                let mut labels = question.labels();
                labels.forms.extend(kinds.iter().flatten().map(|kind| kind.name()));
                labels.extremes.extend(kinds.iter().flatten().filter_map(thin));
                deduplicated(labels)
            }
            Self::Whole(question) => question.labels(),
            Self::WholeRay(question) => question.labels(),
        }
    }

    /// A test to paste.
    pub(super) fn source(&self, name: &str, faults: &[String]) -> String {
        let comments: String = faults.iter().map(|fault| format!("// {fault}\n")).collect();
        match self {
            Self::Pair(question, _) => test_source(name, question, &Truth::of(&question.a, &question.b, &[]), faults),
            Self::Ray(question, _) => ray_test_source(name, question, faults),
            Self::Move(question, _) => comments + &question.source(name),
            Self::Whole(question) => comments + &question.source(name),
            Self::WholeRay(question) => comments + &question.source(name),
        }
    }
}

/// The tier, and whether a tolerance is named.
pub(super) fn accuracy_name(tier: Tier, max_error: f64) -> &'static str {
    match (tier, max_error > 0.0) {
        (Tier::Fast, false) => "fast",
        (Tier::Fast, true) => "fast within",
        (Tier::Standard, false) => "standard",
        (Tier::Standard, true) => "standard within",
        (Tier::Exact, false) => "exact",
        (Tier::Exact, true) => "exact within",
    }
}

fn thin(kind: &Kind) -> Option<&'static str> {
    matches!(kind, Kind::Flat | Kind::Needle).then(|| kind.name())
}

fn convex(kinds: &[Kind], mut forms: Vec<&'static str>, category: &'static str, accuracy: &'static str) -> Labels {
    forms.extend(kinds.iter().map(|kind| kind.name()));
    let extremes = kinds.iter().filter_map(thin).chain([category]).collect();
    deduplicated(Labels { class: "convex", forms, extremes, accuracy })
}

/// Each label once.
fn deduplicated(mut labels: Labels) -> Labels {
    for list in [&mut labels.forms, &mut labels.extremes] {
        list.sort_unstable();
        list.dedup();
    }
    labels
}

/// Any two kinds of which one at least is bounded.
fn kinds(random: &mut Random) -> (Kind, Kind) {
    let mut pick = || Kind::ALL[(random.bits() % Kind::ALL.len() as u64) as usize];
    match (pick(), pick()) {
        (Kind::HalfSpace, Kind::HalfSpace) => (Kind::HalfSpace, Kind::Hull),
        kinds => kinds,
    }
}
