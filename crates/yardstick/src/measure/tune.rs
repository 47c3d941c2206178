//! Which setting is the cheapest that is good enough for a scene?
//!
//! # Method
//! Every setting that a request alone can make is asked the same questions. Those count whose answers are all within the wanted error of the
//! truth and leave no more open than the exact tier does. The cheapest is the one of the fewest steps: tree nodes, shapes, pairs of pieces and
//! iterations, as an answer's `work` counts them, which are the same on every machine and in every run. Where the exact tier takes no more than
//! a twentieth more, it is the advice: what costs nothing is not traded for anything. Else, within a hundredth of the fewest, the one of the
//! narrowest intervals.

use super::{Kind, Options, Report, Row, Setting, run::run_with};
use crate::scenes::Scene;

/// Which setting is the cheapest that was good enough.
#[derive(Clone, Debug)]
pub struct Advice {
    /// For which questions.
    pub kind: Kind,
    /// What was measured of the cheapest setting.
    pub chosen: Row,
    /// The cheapest whose intervals are all as narrow as the wanted error: what it says holds of every answer, not only of those measured.
    pub proved: Option<Row>,
    /// What was measured of the exact tier.
    pub exact: Row,
}

/// So many times as many steps are no more.
const AS_CHEAP: f64 = 1.01;

/// The exact tier is free if it takes no more than so many times as many.
const FREE: f64 = 1.05;

impl Advice {
    /// Whether the exact tier costs no more than anything else.
    #[must_use]
    pub fn is_free(&self) -> bool {
        self.chosen.request == self.exact.request
    }
}

/// What is advised for each kind of question in `options`, whose knobs are passed over. `max_error` is in metres.
///
/// # Errors
/// An answer did not hold the truth: the report says which.
pub fn advise(
    scene: &Scene,
    max_error: f64,
    options: &Options,
    progress: &mut dyn FnMut(usize, usize, &str),
) -> Result<Vec<Advice>, Report> {
    let settings = |_: Kind| {
        let mut all = Setting::of_requests(scene);
        all.push(Setting::of_error(max_error));
        all
    };
    let report = run_with(scene, options, &settings, progress);
    if !report.lies.is_empty() {
        return Err(report);
    }
    let of = |kind: Kind| report.rows.iter().filter(move |row| row.kind == kind && row.count > 0);
    let advice = options.kinds.iter().filter_map(|&kind| {
        let exact = of(kind).find(|row| row.label == "EXACT")?;
        let is_enough = |row: &&Row| row.open <= exact.open && (kind == Kind::Overlap || row.error[2] <= max_error);
        let is_proved = |row: &&Row| kind == Kind::Overlap || row.width[2] <= max_error;
        Some(Advice {
            kind,
            chosen: cheapest(of(kind).filter(is_enough), exact)?.clone(),
            proved: cheapest(of(kind).filter(is_enough).filter(is_proved), exact).cloned(),
            exact: exact.clone(),
        })
    });
    Ok(advice.collect())
}

fn cheapest<'a>(rows: impl Iterator<Item = &'a Row>, exact: &'a Row) -> Option<&'a Row> {
    let rows: Vec<&Row> = rows.collect();
    let steps = |row: &&Row| row.work[3];
    let fewest = rows.iter().map(steps).min_by(f64::total_cmp)?;
    if exact.work[3] <= fewest * FREE && rows.iter().any(|row| row.request == exact.request) {
        return Some(exact);
    }
    let as_cheap = rows.into_iter().filter(|row| row.work[3] <= fewest * AS_CHEAP);
    // The first of equal ones: tiers come before what is told number by number.
    as_cheap.min_by(|a, b| a.width[2].total_cmp(&b.width[2]).then(a.width[0].total_cmp(&b.width[0])))
}
