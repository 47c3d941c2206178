//! What each rung of stand-ins costs and how well it knows a distance, on scenes of real assets.
//!
//! # Method
//! Pairs of a scene are placed at random, from touching to twenty sizes apart, and every rung is asked for the distance of all of
//! them, in turns, several times over; the least mean time of a turn counts. Widths are those of the intervals that have an
//! upper side.
//!
//! # Limits
//! Times are those of this machine, now: compare them within one table only.

mod scenes;

use std::{
    hint::black_box,
    io::{self, Write},
    path::Path,
    time::Instant,
};

use collision::{
    accuracy::{Accuracy, Tier},
    answer::{Certificate, Representation, Work},
    narrow::{self, Placed},
};

use self::scenes::{Scene, scenes};
use crate::sets::SetError;

/// Turns; the fastest counts.
const TURNS: usize = 3;

/// No pair is farther apart, metres.
const FAR: f64 = 1e12;

/// How a row of the table asks.
#[derive(Clone, Copy)]
enum Asked {
    /// One rung, whatever it says.
    Rung(Representation),
    /// Whatever rung is good enough.
    Climbing(Accuracy),
    /// The same, only whether they touch.
    Overlap(Accuracy),
}

struct Row {
    name: &'static str,
    asked: Asked,
    seconds: f64,
    /// Of the intervals with two sides: how many, the sum of their widths in metres, and as parts of the distance.
    bounded: (usize, f64, f64),
    answered: usize,
    stood_in: usize,
}

fn rows() -> Vec<Row> {
    let row = |name, asked| Row { name, asked, seconds: f64::MAX, bounded: (0, 0.0, 0.0), answered: 0, stood_in: 0 };
    let relative = |max_error_relative| Accuracy { max_error_relative, ..Accuracy::default() };
    vec![
        row("ball", Asked::Rung(Representation::Ball)),
        row("box", Asked::Rung(Representation::OrientedBox)),
        row("hull of 32", Asked::Rung(Representation::SimplifiedHull)),
        row("exact", Asked::Climbing(Accuracy::of(Tier::Exact))),
        row("to 100 %", Asked::Climbing(relative(1.0))),
        row("to 10 %", Asked::Climbing(relative(0.1))),
        row("to 1 %", Asked::Climbing(relative(0.01))),
        row("touch, exact", Asked::Overlap(Accuracy::of(Tier::Exact))),
        row("touch, fast", Asked::Overlap(Accuracy::of(Tier::Fast))),
    ]
}

impl Row {
    fn ask(&self, a: Placed<'_>, b: Placed<'_>) -> Option<Certificate> {
        let mut work = Work::default();
        let distance = match self.asked {
            Asked::Rung(rung) => narrow::distance_on(rung, a, b, FAR, &Accuracy::default(), &mut work),
            Asked::Climbing(accuracy) => narrow::distance(a, b, FAR, &accuracy, &mut work),
            Asked::Overlap(accuracy) => return Some(narrow::overlap(a, b, &accuracy, &mut work)),
        };
        distance.map(|found| found.certificate)
    }

    fn judge(&mut self, scene: &Scene) {
        for [a, b] in scene.pairs() {
            let Some(found) = self.ask(a, b) else { continue };
            let bound = found.bound;
            self.answered += 1;
            self.stood_in += usize::from(found.model.representation != Representation::Exact);
            if bound.upper.is_finite() && bound.lower > 0.0 {
                self.bounded.0 += 1;
                self.bounded.1 += bound.width();
                self.bounded.2 += bound.width() / bound.lower;
            }
        }
    }

    fn time(&mut self, scene: &Scene) {
        let begin = Instant::now();
        for [a, b] in scene.pairs() {
            black_box(self.ask(a, b));
        }
        self.seconds = self.seconds.min(begin.elapsed().as_secs_f64());
    }
}

/// Writes the table of the scenes whose assets are in a folder of query sets.
///
/// # Errors
/// An asset is not understood, or nothing can be written.
pub fn run(folder: &Path, out: &mut dyn Write) -> Result<(), LadderError> {
    for scene in scenes(folder)? {
        let builds = scene.build();
        writeln!(out, "{}: {} pairs", scene.name, scene.pairs().count())?;
        writeln!(
            out,
            "  built in ms: ball and box {:.2}, hull {:.2}, what exact questions need {:.2}",
            builds[0], builds[1], builds[2]
        )?;
        let mut rows = rows();
        rows.iter_mut().for_each(|row| row.judge(&scene));
        for _ in 0..TURNS {
            rows.iter_mut().for_each(|row| row.time(&scene));
        }
        writeln!(
            out,
            "  {:<14}{:>10}{:>12}{:>12}{:>12}{:>12}",
            "rung", "ns", "two-sided", "width m", "width %", "stood in"
        )?;
        for row in rows.iter().filter(|row| row.answered > 0) {
            let count = scene.pairs().count() as f64;
            let (bounded, metres, parts) = row.bounded;
            writeln!(
                out,
                "  {:<14}{:>10.0}{:>10.0} %{:>12.2e}{:>12.2e}{:>10.0} %",
                row.name,
                row.seconds / count * 1e9,
                bounded as f64 / count * 100.0,
                metres / bounded.max(1) as f64,
                parts / bounded.max(1) as f64 * 100.0,
                row.stood_in as f64 / count * 100.0,
            )?;
        }
    }
    Ok(())
}

/// Why there is no table.
#[derive(Debug, thiserror::Error)]
pub enum LadderError {
    /// A scene cannot be made.
    #[error(transparent)]
    Set(#[from] SetError),
    /// The table cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
}
