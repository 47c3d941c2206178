//! Two forms in motion, and what is asked of their first touch.

use std::f64::consts::{PI, TAU};

use collision::{
    accuracy::Accuracy,
    answer::Work,
    narrow::{self, ImpactTouch, InitialTouch, Motion, Placed},
};
use glam::DVec3;

use super::{
    forms::{Kind, power_of_ten},
    moves_judge::judge,
    outcome::{Asked, Outcome},
    pairs::{accuracy, placed_pair},
    report::Labels,
    source,
    whole::PlacedWhole,
    whole_pairs::{labels_of, scale_of},
    wholes::{Class, place_of, placed_wholes},
};
use crate::{
    oracle::{Place, Union},
    scene::Random,
};

/// Two forms and how they move.
#[derive(Clone, Debug)]
pub struct MoveQuestion {
    /// What is hard about the places and the motion.
    pub categories: [&'static str; 2],
    /// The forms.
    pub sides: [PlacedWhole; 2],
    /// The motion.
    pub motion: Motion,
    /// How exact the answer must be.
    pub accuracy: Accuracy,
}

/// Which forms move.
#[derive(Clone, Copy, Debug)]
pub(super) enum Movers {
    Convex(Kind, Kind),
    Concave(Class, Kind),
}

/// Whether they turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Turning {
    No,
    Yes,
}

/// The question that a seed and forms name.
pub(super) fn move_question(seed: u64, movers: Movers, turning: Turning) -> MoveQuestion {
    move_question_at(seed, movers, turning, None)
}

/// The same, with a motion that is hard in a way that is named.
pub(super) fn move_question_at(seed: u64, movers: Movers, turning: Turning, style: Option<&str>) -> MoveQuestion {
    let mut random = Random::new(seed);
    let random = &mut random;
    let (category, mut sides) = match movers {
        Movers::Convex(a, b) => {
            let (category, a, b) = placed_pair(random, (a, b), None);
            (category, [a.into(), b.into()])
        }
        Movers::Concave(class, kind) => placed_wholes(random, class, kind, None),
    };
    let (way, mut motion) = motion(random, &mut sides, style);
    let mut categories = [category, way];
    if turning == Turning::Yes {
        let spin = if style == Some("many_turns") { TAU * random.uniform(3.5, 300.0) } else { spin(random) };
        if spin > 3.0 * TAU {
            categories[1] = "many_turns";
        }
        motion.rotation_a = random.direction() * spin;
        if random.one_in(2) {
            motion.rotation_b = random.direction() * (spin * random.uniform(0.0, 1.0));
        }
    }
    let is_convex = matches!(movers, Movers::Convex(..));
    if is_convex && random.one_in(6) {
        motion.initial = InitialTouch::IsIgnored;
    }
    let accuracy = accuracy(random, scale_of(&sides));
    MoveQuestion { categories, sides, motion, accuracy }
}

fn spin(random: &mut Random) -> f64 {
    match random.bits() % 8 {
        0 => power_of_ten(random, -12.0, -1.0),
        1 => 5e-324,
        2 | 3 => TAU * power_of_ten(random, 0.5, 2.5),
        _ => random.uniform(0.1, PI),
    }
}

/// What may be hard about a motion, in the order of the numbers below; `many_turns` is one that goes anywhere.
pub(super) const STYLES: [&str; 6] = ["zero_motion", "enormous_motion", "grazing", "random", "approach", "many_turns"];

/// A motion, and what is hard about it. What grazes begins elsewhere.
fn motion(random: &mut Random, sides: &mut [PlacedWhole; 2], style: Option<&str>) -> (&'static str, Motion) {
    let reach = sides.each_ref().map(|side| side.whole.reach().min(1e9));
    let size = (reach[0] + reach[1]).max(1e-9);
    let apart = sides[1].position - sides[0].position;
    let any = random.bits() % 8;
    let named = |style| STYLES.iter().position(|known| *known == style);
    let (style, way) = match style.and_then(named).map_or(any, |index| index as u64) {
        0 => ("zero_motion", DVec3::ZERO),
        1 => ("enormous_motion", random.direction() * (size * power_of_ten(random, 3.0, 9.0)).min(1e11)),
        2 => ("grazing", graze(random, sides, size)),
        3 => ("random", random.direction() * (size * power_of_ten(random, -9.0, 1.0))),
        _ => {
            let back = random.direction() * (size * random.uniform(0.5, 6.0));
            sides[1].position += back;
            let aim = random.direction() * (size * random.uniform(0.0, 0.6));
            ("approach", (aim - apart - back) * random.uniform(0.3, 2.0))
        }
    };
    // Both go along with something, or one alone moves.
    let drift = match random.bits() % 3 {
        0 => DVec3::ZERO,
        1 => -way * random.uniform(0.0, 1.0),
        _ => random.direction() * size,
    };
    let is_still = style == "zero_motion" && random.one_in(2);
    let drift = if is_still { DVec3::ZERO } else { drift };
    (style, Motion { displacement_a: drift, displacement_b: way + drift, ..Motion::default() })
}

/// Puts the second form to where it passes the first at a gap near 0, and says its way.
fn graze(random: &mut Random, sides: &mut [PlacedWhole; 2], size: f64) -> DVec3 {
    let unions = sides.each_ref().map(|side| side.whole.union());
    let places = sides.each_ref().map(place_of);
    let nearest = Union::nearest((&unions[0], &places[0]), (&unions[1], &places[1]));
    let Some((truth, _)) = nearest.filter(|(truth, _)| truth.nearest().is_finite()) else { return DVec3::X * size };
    let normal = truth.normal_a_to_b();
    let gap = size * power_of_ten(random, -16.0, -2.0) * if random.one_in(2) { 1.0 } else { -1.0 };
    sides[1].position += normal * (gap - truth.nearest());
    let along = normal.cross(random.direction()).normalize_or(normal.any_orthonormal_vector());
    let run = size * random.uniform(0.5, 3.0);
    sides[1].position -= along * run;
    along * (2.0 * run)
}

impl MoveQuestion {
    pub(super) fn asked(&self) -> Asked {
        if self.motion.turns() { Asked::TurningImpact } else { Asked::Impact }
    }

    /// What its answers are counted as.
    pub(super) fn labels(&self) -> Labels {
        labels_of(&self.sides, self.categories.to_vec(), &self.accuracy)
    }

    /// Where the forms are at each time.
    #[must_use]
    pub fn places(&self) -> [Place; 2] {
        let motion = &self.motion;
        let [a, b] = self.sides.each_ref().map(place_of);
        [
            Place { displacement: motion.displacement_a, spin: motion.rotation_a, ..a },
            Place { displacement: motion.displacement_b, spin: motion.rotation_b, ..b },
        ]
    }

    /// A test to paste.
    pub(super) fn source(&self, name: &str) -> String {
        let [a, b] = &self.sides;
        let m = &self.motion;
        format!(
            "#[test]\nfn {name}() {{\n{}{}    let motion = Motion {{ displacement_a: {}, displacement_b: {}, rotation_a: {}, rotation_b: {}, \
             initial: InitialTouch::{:?} }};\n    panic!(\"{{:?}}\", narrow::impact(a, b, &motion, &accuracy, &mut Work::default()));\n}}\n",
            source::sides(a, b),
            source::accuracy(&self.accuracy),
            source::vector(m.displacement_a),
            source::vector(m.displacement_b),
            source::vector(m.rotation_a),
            source::vector(m.rotation_b),
            m.initial,
        )
    }
}

/// What the kernel says, and with the arguments swapped.
pub(super) struct Moved {
    pub(super) there: Option<ImpactTouch>,
    pub(super) back: Option<ImpactTouch>,
    pub(super) work: Work,
}

/// Asks and judges; `None` if the crate refuses one of the forms.
pub(super) fn examine(question: &MoveQuestion) -> Option<Outcome> {
    ask(question).map(|moved| judge(question, &moved))
}

/// Asks in both orders; `None` if the crate refuses one of the forms.
pub(super) fn ask(question: &MoveQuestion) -> Option<Moved> {
    let geometries = question.sides.each_ref().map(|side| side.whole.geometry());
    let [Ok(a), Ok(b)] = &geometries else { return None };
    let a = Placed { geometry: a, pose: question.sides[0].pose() };
    let b = Placed { geometry: b, pose: question.sides[1].pose() };
    let motion = &question.motion;
    let swapped = Motion {
        displacement_a: motion.displacement_b,
        displacement_b: motion.displacement_a,
        rotation_a: motion.rotation_b,
        rotation_b: motion.rotation_a,
        initial: motion.initial,
    };
    let mut work = Work::default();
    let there = narrow::impact(a, b, motion, &question.accuracy, &mut work);
    let back = narrow::impact(b, a, &swapped, &question.accuracy, &mut Work::default());
    Some(Moved { there, back, work })
}
