//! For each kind of question, the scene where stand-ins buy most and the one where an error alone does, and what else was measured where
//! they buy nothing.

use std::fmt::Write;

use super::{Kind, Knob, Report, Row};

/// Relative errors that are shown.
const SHOWN: [&str; 3] = ["1e0", "1e-1", "1e-3"];

/// Less than this is not called a gain.
const WORTH: f64 = 1.5;

/// What is compared.
#[derive(Clone, Copy, PartialEq)]
enum Bought {
    /// The same error, with stand-ins and without.
    ByStandIns,
    /// An error, without stand-ins, and none.
    ByError,
}

impl Bought {
    /// Why a kind gains nothing, where it does not.
    fn reason(self, kind: Kind) -> &'static str {
        match (self, kind) {
            (_, Kind::Raycast) => {
                "nothing stands in for a form that a ray meets: one that is off by a millimetre is off by any length along a ray that \
grazes it, and the last digits of a ray cost less than the boxes on its way"
            }
            (Self::ByError, Kind::Overlap) => {
                "whether two forms touch is told to the last digit wherever it is not plain before"
            }
            (Self::ByError, Kind::Impact) => {
                "straight motions end at a face, an edge or a corner, and are answered to rounding at any error"
            }
            (Self::ByStandIns, Kind::Penetration) => {
                "a depth that a stand-in tells is off by as much as that is, and forms are seldom in each other by much more"
            }
            (Self::ByError, Kind::Distance | Kind::Penetration) => {
                "forms with flat faces end in a few steps at any error"
            }
            (Self::ByError, Kind::TurningImpact) => {
                "the way of what turns is proved in steps, each of which takes a gap"
            }
            (Self::ByStandIns, _) => "what is asked here is told by the geometries as soon",
        }
    }
}

/// How many times as long the same question takes without what is bought.
struct Trade<'a> {
    row: &'a Row,
    before: &'a Row,
}

impl Trade<'_> {
    fn gain(&self) -> f64 {
        self.before.time_ns[0] / self.row.time_ns[0]
    }
}

/// The best scene at a relative error.
fn best<'a>(reports: &[&'a Report], bought: Bought, kind: Kind, label: &str) -> Option<Trade<'a>> {
    let trades = reports.iter().filter_map(|report| {
        let find = |knob: Knob, label: &str| {
            report.rows.iter().find(|row| row.kind == kind && row.knob == knob && row.label == label && row.count > 0)
        };
        let without = find(Knob::NoStandIns, label)?;
        Some(match bought {
            Bought::ByStandIns => Trade { row: find(Knob::MaxErrorRelative, label)?, before: without },
            Bought::ByError => Trade { row: without, before: find(Knob::Tier, "EXACT")? },
        })
    });
    trades.max_by(|a, b| a.gain().total_cmp(&b.gain()))
}

/// Writes the section.
pub(super) fn trades(out: &mut String, reports: &[&Report]) {
    out.push_str(
        "## What each kind of question gains\n\nMean times. Errors are true ones; no interval is wider than the last but one column says.\n\n\
### By stand-ins\n\nFor each kind and relative error the scene where it gains most that stand-ins may answer, beside the same error where only the geometries \
themselves may. The last column says how many of the answers name a stand-in; others gain by what stand-ins prove not to be touched.\n\n",
    );
    table(out, reports, Bought::ByStandIns);
    out.push_str(
        "### By an error alone\n\nFor each kind and relative error the scene where that gains most over the exact tier, with no stand-in allowed in either.\n\n",
    );
    table(out, reports, Bought::ByError);
}

fn table(out: &mut String, reports: &[&Report], bought: Bought) {
    let before = match bought {
        Bought::ByStandIns => "without, ns",
        Bought::ByError => "exact, ns",
    };
    let _ = write!(
        out,
        "| question | `max_error_relative` | scene | {before} | mean, ns | gained | largest error | widest interval | open | stood in |\n\
|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut words = String::new();
    for kind in Kind::ALL {
        let found: Vec<Trade<'_>> = SHOWN.iter().filter_map(|label| best(reports, bought, kind, label)).collect();
        for trade in &found {
            let Trade { row, before } = trade;
            let [error, width] = match kind {
                Kind::Overlap => ["–".to_owned(), "–".to_owned()],
                _ => [row.error[2], row.width[2]].map(|metres| format!("{metres:.0e} m")),
            };
            let _ = writeln!(
                out,
                "| {} | {} | {} | {:.0} | {:.0} | {:.1}× | {error} | {width} | {:.0} % | {:.0} % |",
                kind.text(),
                row.label,
                row.scene,
                before.time_ns[0],
                row.time_ns[0],
                trade.gain(),
                row.open * 100.0,
                row.stood_in * 100.0,
            );
        }
        let most = found.iter().map(Trade::gain).fold(0.0, f64::max);
        if most < WORTH {
            let _ = writeln!(words, "- **{}**: at most {most:.1}×: {}.", kind.text(), bought.reason(kind));
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
