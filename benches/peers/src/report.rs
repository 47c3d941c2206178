//! What a run writes: the table as rows are done, and the JSON at the end.

use std::io::{self, Write};

use serde::Serialize;

use crate::{errors::Errors, rows::Row, timing::Times};

/// What was measured of a row.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    pub(crate) row: Row,
    pub(crate) times: Times,
    pub(crate) errors: Errors,
}

impl Outcome {
    /// Our time over parry3d's.
    fn ratio(&self) -> f64 {
        self.times.calipers_ns / self.times.parry_ns
    }

    /// Whether the goal is reached, if there is one.
    fn is_met(&self) -> Option<bool> {
        self.row.goal_over_parry.map(|goal| self.ratio() <= goal)
    }
}

/// A row of the JSON. A number that is infinite is written as `null`.
#[derive(Debug, Serialize)]
struct Line<'a> {
    row: &'a str,
    calipers_ns: f64,
    parry_ns: f64,
    ratio: f64,
    max_error: f64,
}

/// The names of the columns.
pub(crate) fn write_heading(out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{:<30} {:>8} {:>8} {:>6} {:>6} {:<6} {:>9} {:>9} {:>6} {:>11} {:>11} {:>11} {:>7} {:>8} {:>8}",
        "row",
        "calipers",
        "parry",
        "ratio",
        "goal",
        "",
        "max error",
        "undecided",
        "hit",
        "parry wrong",
        "parry p99.9",
        "parry max",
        "timed",
        "obvhs",
        "embree"
    )
}

/// One row of the table.
pub(crate) fn write_outcome(out: &mut impl Write, outcome: &Outcome) -> io::Result<()> {
    let Outcome { row, times, errors } = outcome;
    let goal = row.goal_over_parry.map_or_else(|| "-".to_owned(), |goal| format!("{goal:.3}"));
    writeln!(
        out,
        "{:<30} {:>8.0} {:>8.0} {:>6.3} {:>6} {:<6} {:>9.1e} {:>9} {:>5.1}% {:>11} {:>11.1e} {:>11.1e} {:>7} {:>8} {:>8}",
        row.id,
        times.calipers_ns,
        times.parry_ns,
        outcome.ratio(),
        goal,
        outcome.is_met().map_or("", |is_met| if is_met { "met" } else { "missed" }),
        errors.max_error,
        errors.undecided_count,
        errors.hit_share * 100.0,
        errors.peer_wrong_count,
        errors.peer_error_p999,
        errors.peer_error_max,
        times.operations,
        if_known(times.obvhs_ns),
        if_known(times.embree_ns),
    )
}

fn if_known(time_ns: Option<f64>) -> String {
    time_ns.map_or_else(String::new, |time| format!("{time:.0}"))
}

/// What the columns mean, and how many goals were met.
pub(crate) fn write_summary(out: &mut impl Write, outcomes: &[Outcome]) -> io::Result<()> {
    let goals: Vec<bool> = outcomes.iter().filter_map(Outcome::is_met).collect();
    let met_count = goals.iter().filter(|is_met| **is_met).count();
    writeln!(out, "{met_count} of {} goals met; ns per operation, errors in metres", goals.len())
}

/// The figures as a JSON array, in the order of `rows`.
pub(crate) fn write_json(out: &mut impl Write, rows: &[Row], outcomes: &[Outcome]) -> io::Result<()> {
    let lines: Vec<Line<'_>> = rows
        .iter()
        .filter_map(|row| outcomes.iter().find(|outcome| outcome.row.id == row.id))
        .map(|outcome| Line {
            row: &outcome.row.id,
            calipers_ns: outcome.times.calipers_ns,
            parry_ns: outcome.times.parry_ns,
            ratio: outcome.ratio(),
            max_error: outcome.errors.max_error,
        })
        .collect();
    serde_json::to_writer_pretty(&mut *out, &lines)?;
    writeln!(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows;

    #[test]
    fn the_json_has_each_row_with_its_five_fields() {
        let rows = rows::all(&[1000]);
        let mut outcomes: Vec<Outcome> = rows
            .iter()
            .map(|row| Outcome {
                row: row.clone(),
                times: Times { calipers_ns: 100.0, parry_ns: 400.0, obvhs_ns: None, embree_ns: None, operations: 1000 },
                errors: Errors { max_error: 0.5, ..Errors::default() },
            })
            .collect();
        outcomes.reverse();
        let mut text = Vec::new();
        write_json(&mut text, &rows, &outcomes).expect("memory takes it");
        let lines: Vec<serde_json::Value> = serde_json::from_slice(&text).expect("JSON");
        assert_eq!(lines.len(), rows.len());
        for (line, row) in lines.iter().zip(&rows) {
            let expected = serde_json::json!({
                "row": row.id, "calipers_ns": 100.0, "parry_ns": 400.0, "ratio": 0.25, "max_error": 0.5
            });
            assert_eq!(line, &expected);
        }
    }
}
