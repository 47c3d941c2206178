//! Calipers beside parry3d on the same work in one run: `--only PREFIX` chooses rows, `--json FILE` keeps the figures.
//!
//! `benches/README.md` says what is measured and how to read it. `rows.rs` lists the rows; `worlds` measures those of
//! part A (worlds of many shapes), `pairs` those of part B (pairs of convex shapes) and `meshes` those of part C (triangle
//! meshes). `timing.rs` takes the times, `errors.rs` compares the answers and `report.rs` writes table and JSON.

mod dice;
mod errors;
mod files;
mod forms;
mod meshes;
mod pairs;
mod report;
mod rows;
mod timing;
mod worlds;

use std::{
    error::Error,
    fs::File,
    io::{BufWriter, Write, stdout},
    path::PathBuf,
};

use clap::Parser;

/// What to measure.
#[derive(Debug, Parser)]
#[command(about)]
struct Arguments {
    /// Only the rows whose id begins with this.
    #[arg(long, value_name = "PREFIX", default_value = "")]
    only: String,
    /// Where to write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Shapes in each world; may be given several times.
    #[arg(long, value_name = "N", default_values_t = [1000, 10_000, 100_000], value_parser = clap::value_parser!(u32).range(1000..=10_000_000))]
    shapes: Vec<u32>,
    /// Pairs of shapes in each set.
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(1000..))]
    pairs: u32,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let rows = rows::beginning_with(&arguments.only, &arguments.shapes).unwrap_or_else(|error| {
        clap::Error::raw(clap::error::ErrorKind::InvalidValue, format!("{error}\n")).exit();
    });
    // Before the minutes of work, so that a bad path costs none.
    let json = arguments.json.map(File::create).transpose()?;
    let mut out = stdout();
    report::write_heading(&mut out)?;
    let mut outcomes = Vec::new();
    let mut done = |outcome| {
        report::write_outcome(&mut out, &outcome)?;
        outcomes.push(outcome);
        Ok(())
    };
    worlds::measure(&rows, &mut done)?;
    pairs::measure(&rows, arguments.pairs as usize, &mut done)?;
    meshes::measure(&rows, &mut done)?;
    report::write_summary(&mut out, &outcomes)?;
    if let Some(file) = json {
        let mut writer = BufWriter::new(file);
        report::write_json(&mut writer, &rows, &outcomes)?;
        writer.flush()?;
    }
    Ok(())
}
