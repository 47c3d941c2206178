//! What each engine says, and how far that is off.

use std::{
    io::{self, Write},
    panic::{AssertUnwindSafe, catch_unwind},
};

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Verdict, Work},
    narrow::{self, Placed},
    shape::Geometry,
};

use crate::{parry, workload::Pair};

/// A form.
pub(crate) enum Form {
    Cuboid(DVec3),
    Capsule { half_height: f64, radius: f64 },
    Cylinder { half_height: f64, radius: f64 },
    Hull(Vec<DVec3>),
}

impl Form {
    pub(crate) fn geometry(&self) -> Option<Geometry> {
        match self {
            Self::Cuboid(half_extents) => Geometry::cuboid(*half_extents),
            Self::Capsule { half_height, radius } => Geometry::capsule(*half_height, *radius),
            Self::Cylinder { half_height, radius } => Geometry::cylinder(*half_height, *radius),
            Self::Hull(points) => Geometry::hull(points),
        }
        .ok()
    }
}

/// An engine.
#[derive(Clone, Copy)]
pub(crate) enum Asker {
    Calipers,
    Single,
    Double,
}

/// What an engine says of a pair, metres.
#[derive(Clone, Copy)]
pub(crate) struct Said {
    pub(crate) touches: bool,
    /// 0 where they overlap.
    pub(crate) distance: f64,
    /// `None` where it tells no contact.
    pub(crate) depth: Option<f64>,
}

impl Asker {
    pub(crate) const ALL: [Self; 3] = [Self::Calipers, Self::Single, Self::Double];

    fn name(self) -> &'static str {
        match self {
            Self::Calipers => "Calipers",
            Self::Single => "parry3d",
            Self::Double => "parry3d-f64",
        }
    }

    fn ask(self, pair: &Pair) -> Option<Said> {
        match self {
            Self::Calipers => ours(pair),
            Self::Single => parry::single::ask(pair),
            Self::Double => parry::double::ask(pair),
        }
    }
}

/// In the exact tier, with the two the other way round.
fn ours(pair: &Pair) -> Option<Said> {
    let geometries = [pair.forms[0].geometry()?, pair.forms[1].geometry()?];
    let [a, b] = [0, 1].map(|side| Placed { geometry: &geometries[side], pose: pair.poses[side] });
    let (accuracy, work) = (Accuracy::of(Tier::Exact), &mut Work::default());
    Some(Said {
        touches: narrow::overlap(b, a, &accuracy, work).verdict == Verdict::Hit,
        distance: narrow::distance(b, a, f64::MAX, &accuracy, work)?.distance,
        depth: narrow::depth(b, a, 0.0, &accuracy, work).map(|found| found.depth),
    })
}

/// Errors of an engine on the pairs of one extreme.
#[derive(Default)]
pub(crate) struct Tally {
    distances: Vec<f64>,
    depths: Vec<f64>,
    wrong: usize,
    failed: usize,
    count: usize,
}

impl Tally {
    pub(crate) fn add(&mut self, asker: Asker, pair: &Pair) {
        self.count += 1;
        let said = catch_unwind(AssertUnwindSafe(|| asker.ask(pair))).ok().flatten();
        let Some(said) = said.filter(|said| said.distance.is_finite() && said.depth.is_none_or(f64::is_finite)) else {
            self.failed += 1;
            return;
        };
        let truth = pair.truth;
        // Of ours the most that its own interval allows.
        let off = |value: f64| match asker {
            Asker::Calipers => truth.width() / pair.size,
            Asker::Single | Asker::Double => (truth.lower - value).max(value - truth.upper).max(0.0) / pair.size,
        };
        if truth.lower > 0.0 {
            self.wrong += usize::from(said.touches);
            self.distances.push(off(said.distance));
        } else if truth.upper < 0.0 {
            self.wrong += usize::from(!said.touches);
            match said.depth {
                Some(depth) => self.depths.push(off(-depth)),
                None => self.failed += 1,
            }
        }
    }

    pub(crate) fn print(&mut self, pairs: &str, asker: Asker, out: &mut impl Write) -> io::Result<()> {
        let mut of = |errors: fn(&mut Self) -> &mut Vec<f64>| {
            let errors = errors(self);
            errors.sort_by(f64::total_cmp);
            let at = |part: usize| errors.get((errors.len().max(1) - 1) * part / 1000).copied().unwrap_or(0.0);
            let text = |value: f64| if value == 0.0 { "0".to_owned() } else { format!("{value:.0e}") };
            [text(at(999)), text(at(1000))]
        };
        let ([near, nearest], [deep, deepest]) = (of(|tally| &mut tally.distances), of(|tally| &mut tally.depths));
        let (name, count) = (asker.name(), self.count);
        let of_count = |found: usize| format!("{:.2} %", found as f64 / count as f64 * 100.0);
        let shares = [of_count(self.wrong), of_count(self.failed)];
        writeln!(out, "| {pairs} | {name} | {near} | {nearest} | {deep} | {deepest} | {} | {} |", shares[0], shares[1])
    }
}
