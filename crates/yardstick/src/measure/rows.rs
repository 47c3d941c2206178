//! What was measured at one setting, and tables of that.

use std::io::{self, Write};

use collision::answer::Work;

use super::{Kind, Knob, Setting, judge::Judged};

/// Everything about one setting, question by question.
#[derive(Default)]
pub(super) struct Measured {
    pub(super) judged: Vec<Judged>,
    /// The least time of each, ns; infinite if none was taken.
    pub(super) times: Vec<f64>,
    pub(super) work: Work,
    /// Answers that hold the truth.
    pub(super) held: usize,
}

/// What was measured of one kind of question at one setting.
#[derive(Clone, Debug)]
pub struct Row {
    /// Of which scene.
    pub scene: String,
    /// Of which kind.
    pub kind: Kind,
    /// What was turned.
    pub knob: Knob,
    /// How far.
    pub label: String,
    /// The same as `QueryOptions.accuracy` says it, in JSON.
    pub request: String,
    /// Questions.
    pub count: usize,
    /// Answers that hold the truth.
    pub held: usize,
    /// Time of a question, ns: mean, half, and 99 of 100 take no longer.
    pub time_ns: [f64; 3],
    /// Iterations, tree nodes, pairs of pieces, and all steps, of a question in the mean.
    pub work: [f64; 4],
    /// True error, metres: half, 99 of 100, all are no larger. Of overlaps the share left open, three times.
    pub error: [f64; 3],
    /// Width of the interval, metres: half, 99 of 100, all are no wider.
    pub width: [f64; 3],
    /// The part of the answers that leave something open.
    pub open: f64,
    /// The part of the answers in which a stand-in took part.
    pub stood_in: f64,
    /// What making its world cost.
    pub note: String,
}

/// The values that half, 99 of 100, and all do not exceed; 0 of none.
fn quantiles(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return [0.0; 3] };
    [sorted[last / 2], sorted[last * 99 / 100], sorted[last]]
}

impl Row {
    pub(super) fn new(scene: &str, kind: Kind, setting: &Setting, measured: &Measured, note: &str) -> Self {
        let count = measured.judged.len();
        let share = |test: fn(&Judged) -> bool| {
            measured.judged.iter().filter(|judged| test(judged)).count() as f64 / count.max(1) as f64
        };
        let [half, most, _] = quantiles(measured.times.iter().copied());
        let mean = measured.times.iter().sum::<f64>() / count.max(1) as f64;
        let Work { nodes_visited, pairs_tested, iterations, .. } = measured.work;
        let errors = quantiles(measured.judged.iter().map(|judged| judged.error));
        Self {
            scene: scene.to_owned(),
            kind,
            knob: setting.knob,
            label: setting.label.clone(),
            request: setting.request.clone(),
            count,
            held: measured.held,
            time_ns: [mean, half, most],
            work: [iterations, nodes_visited, pairs_tested, measured.work.steps()]
                .map(|steps| steps as f64 / count.max(1) as f64),
            error: if kind == Kind::Overlap { [share(|judged| judged.is_open); 3] } else { errors },
            width: quantiles(measured.judged.iter().map(|judged| judged.width)),
            open: share(|judged| judged.is_open),
            stood_in: share(|judged| judged.stood_in),
            note: note.to_owned(),
        }
    }
}

/// Writes a table for people.
///
/// # Errors
/// It cannot be written.
pub fn table(rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    let mut last = None;
    for row in rows {
        if last != Some((row.scene.as_str(), row.kind)) {
            last = Some((row.scene.as_str(), row.kind));
            let error = if row.kind == Kind::Overlap { "left open" } else { "max error" };
            writeln!(out, "\n{}, {}: {} questions", row.scene, row.kind.text(), row.count)?;
            writeln!(
                out,
                "  {:<19}{:<23}{:>10}{:>10}{:>8}{:>8}{:>8}{:>11}{:>11}{:>7}{:>7}{:>7}",
                "knob",
                "setting",
                "p50 ns",
                "p99 ns",
                "iter",
                "nodes",
                "pairs",
                error,
                "max width",
                "open",
                "stood",
                "held"
            )?;
        }
        let percent = |part: f64| format!("{:.0} %", part * 100.0);
        let [iterations, nodes, pairs, _] = row.work;
        write!(
            out,
            "  {:<19}{:<23}{:>10.0}{:>10.0}{:>8.1}{:>8.1}{:>8.1}{:>11.1e}{:>11.1e}{:>7}{:>7}{:>7}",
            row.knob.text(),
            row.label,
            row.time_ns[1],
            row.time_ns[2],
            iterations,
            nodes,
            pairs,
            row.error[2],
            row.width[2],
            percent(row.open),
            percent(row.stood_in),
            percent(row.held as f64 / row.count.max(1) as f64),
        )?;
        writeln!(out, "{}{}", if row.note.is_empty() { "" } else { "  " }, row.note)?;
    }
    Ok(())
}

/// Writes rows as CSV, with a line of names.
///
/// # Errors
/// It cannot be written.
pub fn csv(rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "scene,question,knob,setting,request,count,held,mean_ns,p50_ns,p99_ns,iterations,nodes,pairs,steps,\
         error_p50_m,error_p99_m,error_max_m,width_p50_m,width_p99_m,width_max_m,open,stood_in,note"
    )?;
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    for row in rows {
        let texts = [&*row.scene, row.kind.text(), row.knob.text(), &*row.label, &*row.request].map(quoted);
        let counts = [row.count, row.held].map(|count| count.to_string());
        let [times, errors, widths] = [row.time_ns, row.error, row.width];
        let numbers = times.into_iter().chain(row.work).chain(errors).chain(widths).chain([row.open, row.stood_in]);
        let numbers = numbers.map(|number| number.to_string());
        let cells: Vec<String> = texts.into_iter().chain(counts).chain(numbers).chain([quoted(&row.note)]).collect();
        writeln!(out, "{}", cells.join(","))?;
    }
    Ok(())
}
