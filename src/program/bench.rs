//! `bench`: what accuracy costs on a scene, as tables and plots.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use clap::Args;
use yardstick::measure::{self, Knob, Options, Report, Row};

use super::Failure;
use super::stage::{self, Stage};

/// Measures what accuracy costs.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: calipers bench --scene debris --question distance --html debris.html\nExample: calipers bench level.obj \
                  prop.obj\nNeeds no server. Exits with 1 if one answer's interval does not hold the truth."
)]
pub(crate) struct Bench {
    #[command(flatten)]
    stage: Stage,
    /// How many questions of each kind
    #[arg(long, value_name = "N", default_value_t = 100)]
    count: usize,
    /// Only the question of this number, counted from 0
    #[arg(long, value_name = "N")]
    only: Option<usize>,
    /// Writes all rows as CSV
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Writes a page with plots; it needs nothing from elsewhere
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Writes a plot for each scene and kind of question into this folder
    #[arg(long, value_name = "DIR")]
    svg: Option<PathBuf>,
}

impl Bench {
    pub(crate) fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        let options = Options {
            kinds: self.stage.kinds(),
            count: self.count,
            seed: self.stage.seed,
            only: self.only,
            ..Options::default()
        };
        let bar = stage::bar()?;
        let mut reports = Vec::new();
        let mut lie_count = 0;
        for scene in self.stage.scenes()? {
            let report = measure::run(&scene, &options, &mut |done, all, what| {
                bar.set_length(all as u64);
                bar.set_position(done as u64);
                bar.set_message(what.to_owned());
            });
            bar.suspend(|| print(&report, &self.stage.again(&scene), self.count, out))?;
            lie_count += report.lies.len();
            reports.push(report);
        }
        bar.finish_and_clear();
        self.write(&reports)?;
        match lie_count {
            0 => Ok(()),
            count => Err(Failure::new(format!("{count} answers do not hold the truth"))),
        }
    }

    fn write(&self, reports: &[Report]) -> Result<(), Failure> {
        let rows: Vec<Row> = reports.iter().flat_map(|report| report.rows.clone()).collect();
        if let Some(path) = &self.csv {
            let mut file = BufWriter::new(File::create(path)?);
            measure::csv(&rows, &mut file)?;
            file.flush()?;
        }
        if let Some(path) = &self.html {
            fs::write(path, measure::page(reports))?;
        }
        let Some(folder) = &self.svg else { return Ok(()) };
        fs::create_dir_all(folder)?;
        for report in reports {
            for audited in &report.audited {
                let rows: Vec<&Row> = report.rows.iter().filter(|row| row.kind == audited.kind).collect();
                let name = format!("{}-{}.svg", report.scene.replace(' ', "-"), audited.kind.text());
                fs::write(folder.join(name), measure::svg(&rows))?;
            }
        }
        Ok(())
    }
}

fn print(report: &Report, again: &str, count: usize, out: &mut impl Write) -> Result<(), Failure> {
    measure::table(&report.rows, out)?;
    let audited: Vec<String> = report
        .audited
        .iter()
        .map(|audited| format!("{} {} of {}", audited.kind.text(), audited.judged, audited.answers))
        .collect();
    writeln!(
        out,
        "\n{}: the truth is what the exact tier proves at the largest budget; of its answers the",
        report.scene
    )?;
    writeln!(out, "oracle judged {} (concave forms, large hulls and more take it too long)", audited.join(", "))?;
    if report.rows.iter().all(|row| row.knob != Knob::Tree) {
        writeln!(out, "fewer than nine shapes: trees and margins are not measured")?;
    }
    for lie in &report.lies {
        let (kind, number) = (lie.kind.text(), lie.number);
        writeln!(out, "\nan answer that does not hold the truth: {kind} at {}\n  {}", lie.request, lie.sentence)?;
        writeln!(out, "  again: calipers bench {again} --question {kind} --count {count} --only {number}")?;
    }
    Ok(())
}
