//! `yardstick attack`.

use std::{
    fs,
    io::{self, Write},
    path::PathBuf,
};

use yardstick::attack::{Climb, Find, climb, climb_from, faults};

#[derive(clap::Args)]
pub(crate) struct AttackArguments {
    /// Names the search.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Questions that it begins from: pairs, rays and motions in turn.
    #[arg(long, value_name = "COUNT", default_value_t = 300)]
    starts: u64,
    /// Changes tried of each.
    #[arg(long, value_name = "COUNT", default_value_t = 200)]
    steps: u64,
    /// How many of the worst to keep of each sort.
    #[arg(long, value_name = "COUNT", default_value_t = 12)]
    keep: usize,
    /// Begin from the finds in this file, in place of random questions; with `--steps 0` they are only measured anew.
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// Write them to this file as JSON: `crates/yardstick/attacks.json` is asked again by a test.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Runs it, and says the exit code: 0, or 1 if an answer is wrong.
pub(crate) fn attack(arguments: &AttackArguments) -> io::Result<u8> {
    let AttackArguments { seed, starts, steps, keep, .. } = *arguments;
    let settings = Climb { seed, starts, steps, keep };
    let (finds, begun) = match &arguments.from {
        None => (climb(&settings), starts as usize),
        Some(path) => {
            let kept: Vec<Find> = serde_json::from_slice(&fs::read(path)?).map_err(io::Error::from)?;
            let begun = kept.len();
            (climb_from(kept, &settings), begun)
        }
    };
    let mut out = io::stdout().lock();
    for find in &finds {
        let forms: Vec<&str> = find.forms.iter().map(|form| form.core.as_str()).collect();
        let sort = match (find.forms.len(), find.way.is_empty()) {
            (1, _) => "ray",
            (_, true) => "pair",
            (_, false) => "impact",
        };
        writeln!(out, "{:<8}{:<20}{:.6}", sort, forms.join("-"), find.ratio)?;
        for fault in find.asked().iter().flat_map(faults) {
            writeln!(out, "    {fault} of {find:?}")?;
        }
    }
    if let Some(path) = &arguments.json {
        let lines: Result<Vec<String>, _> = finds.iter().map(serde_json::to_string).collect();
        fs::write(path, format!("[\n{}\n]\n", lines.map_err(io::Error::from)?.join(",\n")))?;
    }
    let wrong = finds.iter().filter(|find| find.ratio > 1.0).count();
    writeln!(out, "{} kept of {begun}, {wrong} wrong", finds.len())?;
    Ok(u8::from(wrong > 0))
}
