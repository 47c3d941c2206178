//! `tune`: the cheapest setting that is good enough for a scene.

use std::io::Write;

use clap::Args;
use yardstick::measure::{self, Advice, Kind, Options, Row};

use super::Failure;
use super::stage::{self, Stage};

/// Recommends the cheapest accuracy that is good enough.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: calipers tune level.obj --max-error 1e-3 --question distance\nCheapest is what takes the fewest steps (tree nodes, \
                  shapes, pairs and iterations), which are the same on every machine: the same scene and seed give the same advice. Times \
                  are printed beside it. Needs no server."
)]
pub(crate) struct Tune {
    #[command(flatten)]
    stage: Stage,
    /// No answer may be farther from the truth than this, metres
    #[arg(long, value_name = "METRES")]
    max_error: f64,
    /// How many questions of each kind
    #[arg(long, value_name = "N", default_value_t = 200)]
    count: usize,
}

impl Tune {
    pub(crate) fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        if !(self.max_error.is_finite() && self.max_error > 0.0) {
            return Err(Failure::new(format!("--max-error is {}: it must be above 0 metres", self.max_error)));
        }
        if !self.stage.is_said() {
            return Err(Failure::new("say for which scene: a FILE or --scene NAME"));
        }
        let options = Options {
            kinds: self.stage.kinds(),
            count: self.count,
            seed: self.stage.seed,
            turns: 2,
            ..Options::default()
        };
        let bar = stage::bar()?;
        for scene in self.stage.scenes()? {
            let mut progress = |done: usize, all: usize, what: &str| {
                bar.set_length(all as u64);
                bar.set_position(done as u64);
                bar.set_message(what.to_owned());
            };
            let advised = measure::advise(&scene, self.max_error, &options, &mut progress).map_err(|report| {
                let first =
                    report.lies.first().map(|lie| format!("{} {}: {}", lie.kind.text(), lie.number, lie.sentence));
                Failure::new(format!("an answer does not hold the truth: {}", first.unwrap_or_default()))
            })?;
            bar.finish_and_clear();
            writeln!(out, "{}, {} questions of a kind, seed {}:", scene.name, self.count, self.stage.seed)?;
            for kind in &options.kinds {
                match advised.iter().find(|advice| advice.kind == *kind) {
                    Some(advice) => say(advice, self.max_error, out)?,
                    None => writeln!(out, "\n{}: nothing is good enough, or nothing can be asked", kind.text())?,
                }
            }
        }
        Ok(())
    }
}

fn say(advice: &Advice, wanted: f64, out: &mut impl Write) -> Result<(), Failure> {
    let Advice { kind, chosen, proved, exact } = advice;
    let name = |row: &Row| format!("{} {}", row.knob.text(), row.label);
    let free = if advice.is_free() { ": accuracy is free here, nothing that is less exact is cheaper" } else { "" };
    writeln!(out, "\n{}: {}{free}", kind.text(), name(chosen))?;
    let ([steps, of_exact], [time, time_of_exact]) =
        ([chosen.work[3], exact.work[3]], [chosen.time_ns[1], exact.time_ns[1]]);
    write!(out, "  {steps:.1} steps a question, {time:.0} ns here (p50)")?;
    if !advice.is_free() {
        write!(out, "; in the exact tier {of_exact:.1} steps, {time_of_exact:.0} ns")?;
    }
    writeln!(out)?;
    if *kind == Kind::Overlap {
        writeln!(out, "  {:.1} % of the answers leave something open, as in the exact tier", chosen.open * 100.0)?;
    } else {
        let (error, width) = (chosen.error[2], chosen.width[2]);
        let margin = match wanted / error {
            times if times < 1000.0 => format!("{times:.1} times less than"),
            times if times.is_finite() => format!("{times:.0e} times less than"),
            _ => "nothing of".to_owned(),
        };
        writeln!(
            out,
            "  largest error {error:.1e} m, {margin} the {wanted:e} m wanted; widest interval {width:.1e} m"
        )?;
    }
    writeln!(out, "  in {}Request: {}", kind.call(), field(chosen))?;
    match proved {
        _ if *kind == Kind::Overlap => {}
        Some(row) if row.request == chosen.request => {
            writeln!(out, "  each answer proves that error, on other questions too")?;
        }
        Some(row) => {
            let more = row.work[3];
            writeln!(out, "  to have each answer prove it, on other questions too: {} ({more:.1} steps)", name(row))?;
            writeln!(out, "  in {}Request: {}", kind.call(), field(row))?;
        }
        None => writeln!(out, "  no setting proves that error in every answer")?,
    }
    Ok(())
}

/// The field of the request that asks for a setting, as JSON.
fn field(row: &Row) -> String {
    format!(r#"{{"options":{{"accuracy":{}}}}}"#, row.request)
}
