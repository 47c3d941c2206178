//! What accuracy costs on every named scene: `calipers bench` as a bench. `cargo bench --bench pareto -- debris coins` measures two of them.

use std::env;
use std::io::{self, Write};
use std::process::ExitCode;

use yardstick::{
    measure::{self, Options},
    scenes::{Name, Scene},
};

fn main() -> io::Result<ExitCode> {
    let named: Vec<Name> = env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    let names = if named.is_empty() { Name::ALL.to_vec() } else { named };
    let mut out = io::stdout().lock();
    let mut lie_count = 0;
    for name in names {
        let report = measure::run(&Scene::named(name, 1), &Options::default(), &mut |_, _, _| {});
        measure::table(&report.rows, &mut out)?;
        for lie in &report.lies {
            writeln!(out, "{} {} at {}: {}", lie.kind.text(), lie.number, lie.request, lie.sentence)?;
        }
        lie_count += report.lies.len();
    }
    Ok(ExitCode::from(u8::from(lie_count > 0)))
}
