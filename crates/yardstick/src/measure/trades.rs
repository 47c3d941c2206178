//! For each kind of question, the scene where asking for less buys most, and what else was measured where it buys nothing.

use std::fmt::Write;

use super::{Kind, Knob, Report, Row};

/// Relative errors that are shown.
const SHOWN: [&str; 3] = ["1e0", "1e-1", "1e-3"];

/// Less than this is not called a gain.
const WORTH: f64 = 1.5;

/// Why a kind gains nothing, where it does not.
fn reason(kind: Kind) -> &'static str {
    match kind {
        Kind::Raycast => {
            "no stand-in answers a ray: one that is off by a millimetre is off by any length along a ray that grazes it, and the last \
digits of a ray cost less than the boxes on its way"
        }
        Kind::Overlap => "whether two forms touch is told to the last digit wherever it is not plain before",
        Kind::Distance | Kind::Penetration => "forms with flat faces end in a few steps at any error",
        Kind::Impact => {
            "straight motions end at a face, an edge or a corner, and are answered to rounding at any error; a stand-in only proves that a \
way is free, of one mesh past others"
        }
        Kind::TurningImpact => "the way of what turns is proved in steps, each of which takes a gap",
    }
}

/// How many times as long as a setting the exact tier takes, in the mean.
struct Trade<'a> {
    row: &'a Row,
    exact: &'a Row,
    without: Option<&'a Row>,
}

impl Trade<'_> {
    fn gain(&self) -> f64 {
        self.exact.time_ns[0] / self.row.time_ns[0]
    }
}

/// The best scene at a relative error.
fn best<'a>(reports: &[&'a Report], kind: Kind, label: &str) -> Option<Trade<'a>> {
    let trades = reports.iter().filter_map(|report| {
        let find = |knob: Knob, label: &str| {
            report.rows.iter().find(|row| row.kind == kind && row.knob == knob && row.label == label && row.count > 0)
        };
        let (row, exact) = (find(Knob::MaxErrorRelative, label)?, find(Knob::Tier, "EXACT")?);
        Some(Trade { row, exact, without: find(Knob::NoStandIns, label) })
    });
    trades.max_by(|a, b| a.gain().total_cmp(&b.gain()))
}

/// Writes the section.
pub(super) fn trades(out: &mut String, reports: &[&Report]) {
    out.push_str(
        "## What each kind of question gains\n\nFor each kind and relative error the scene where that gains most over the exact tier, in the mean. Errors are true ones; no \
interval is wider than the last but one column says. Without stand-ins: the same error where only the geometries themselves may answer, so what is gained beside that \
is gained by tolerance alone.\n\n| question | `max_error_relative` | scene | exact, ns | mean, ns | gained | without stand-ins, ns | largest error | widest interval | open |\n\
|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut words = String::new();
    for kind in Kind::ALL {
        let found: Vec<Trade<'_>> = SHOWN.iter().filter_map(|label| best(reports, kind, label)).collect();
        for trade in &found {
            let Trade { row, exact, without } = trade;
            let without = without.map_or("–".to_owned(), |row| format!("{:.0}", row.time_ns[0]));
            let [error, width] = match kind {
                Kind::Overlap => ["–".to_owned(), "–".to_owned()],
                _ => [row.error[2], row.width[2]].map(|metres| format!("{metres:.0e} m")),
            };
            let _ = writeln!(
                out,
                "| {} | {} | {} | {:.0} | {:.0} | {:.1}× | {without} | {error} | {width} | {:.0} % |",
                kind.text(),
                row.label,
                row.scene,
                exact.time_ns[0],
                row.time_ns[0],
                trade.gain(),
                row.open * 100.0,
            );
        }
        let most = found.iter().map(Trade::gain).fold(0.0, f64::max);
        if most < WORTH {
            let _ = writeln!(words, "- **{}**: at most {most:.1}×: {}.", kind.text(), reason(kind));
        }
    }
    if !words.is_empty() {
        let _ = write!(out, "\nWhere there is no scene with {WORTH}× or more:\n\n{words}");
    }
    out.push('\n');
}

/// Which part of the exact answers the oracle was asked about.
pub(super) fn audits(out: &mut String, reports: &[&Report]) {
    out.push_str("| question | exact hits | judged by the oracle |\n|---|---|---|\n");
    for kind in Kind::ALL {
        let of_kind = reports.iter().flat_map(|report| &report.audited).filter(|audited| audited.kind == kind);
        let [answers, judged] =
            of_kind.fold([0, 0], |[answers, judged], one| [answers + one.answers, judged + one.judged]);
        let share = 100.0 * judged as f64 / answers.max(1) as f64;
        let _ = writeln!(out, "| {} | {answers} | {judged}, {share:.0} % |", kind.text());
    }
    out.push('\n');
}
