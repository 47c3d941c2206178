//! Writes `docs/accuracy.md` with its plots: what each tier promises, and what that costs.
//!
//! # Limits
//! Times are those of the machine that writes it; everything else is the same everywhere. What peers get wrong is measured elsewhere (`benches/peers`)
//! and only put in here.

use std::{
    fmt::Write,
    fs, io,
    path::{Path, PathBuf},
};

use collision::{
    accuracy::{Accuracy, Tier},
    shape::GeometryError,
};

use super::{
    Kind, Knob, Lie, Needed, Options, Report, Row, needed, run, svg,
    trades::{audits, trades},
};
use crate::{
    ladder::{self, LadderError},
    scenes::{Name, Scene, Triangles},
    sets::{SetError, read_obj},
};

/// Why nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum DocumentError {
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// An asset is not understood.
    #[error(transparent)]
    Set(#[from] SetError),
    /// An asset is no form.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Pairs of assets cannot be measured.
    #[error(transparent)]
    Ladder(#[from] LadderError),
    /// An answer does not hold the truth.
    #[error("{scene}, {} {} at {}: {}", lie.kind.text(), lie.number, lie.request, lie.sentence)]
    Lie {
        /// On which scene.
        scene: String,
        /// Which.
        lie: Box<Lie>,
    },
}

/// Of which plots are shown: where the kind of question has the most to trade.
const SHOWN: [(Name, Kind); 6] = [
    (Name::Arena, Kind::Raycast),
    (Name::Debris, Kind::Overlap),
    (Name::Debris, Kind::Distance),
    (Name::Debris, Kind::Penetration),
    (Name::Columns, Kind::Impact),
    (Name::Coins, Kind::TurningImpact),
];

/// Questions of a kind on real assets, which take long; those about a way longest.
const REAL: [(Kind, usize); 4] =
    [(Kind::Distance, 24), (Kind::Overlap, 40), (Kind::Impact, 24), (Kind::TurningImpact, 12)];

const INTRODUCTION: &str = "# What accuracy costs\n\n\
Written by `cargo run --release -p yardstick -- accuracy docs` (after `cargo run --release --manifest-path benches/peers/Cargo.toml --bin wrong > \
docs/accuracy/peers.md` for the part about peers): do not edit. Times are processor times of one thread of one machine, the least of three turns, and good \
for comparing within a table; errors, counts and verdicts are the same everywhere. Your own scene: `calipers bench FILE`; which setting to \
take: `calipers tune FILE --max-error 1e-3`.\n\n\
Every answer below was checked: its interval holds the truth, which is what the exact tier proves. The part of that in the table was judged by an oracle of \
32 digits that shares nothing with the kernels; concave forms and hulls of more than 12 corners take it too long, and those `yardstick coverage` draws by the \
million, small enough for it.\n\n";

/// Writes the document and its plots into a folder. `data` is the folder with the query sets.
///
/// # Errors
/// An asset cannot be read, a file cannot be written, or an answer does not hold the truth.
pub fn document(
    folder: &Path,
    data: &Path,
    count: usize,
    progress: &mut dyn FnMut(usize, usize, &str),
) -> Result<(), DocumentError> {
    let options = Options { count, ..Options::default() };
    let mut reports = Vec::new();
    for name in Name::ALL {
        // Rocks that turn among rocks take minutes, and tell nothing that coins do not.
        let is_short = |kind: &Kind| name != Name::Debris || *kind != Kind::TurningImpact;
        let options = Options { kinds: Kind::ALL.into_iter().filter(is_short).collect(), ..options.clone() };
        reports.push(honest(run(&Scene::named(name, options.seed), &options, progress))?);
    }
    let herd = herd(data, options.seed)?;
    let mut real = Vec::new();
    for (kind, count) in REAL {
        let knobs = vec![Knob::Tier, Knob::MaxErrorRelative, Knob::NoStandIns];
        let options = Options { kinds: vec![kind], count, knobs, turns: 2, ..Options::default() };
        real.push(honest(run(&herd, &options, progress))?);
    }
    let all: Vec<&Report> = reports.iter().chain(&real).collect();
    let mut out = INTRODUCTION.to_owned();
    audits(&mut out, &all);
    tiers(&mut out);
    let plots = folder.join("accuracy");
    fs::create_dir_all(&plots).map_err(|source| DocumentError::File { path: plots.clone(), source })?;
    pictures(&mut out, &plots, &reports)?;
    decades(&mut out, &reports);
    trades(&mut out, &all);
    freedom(&mut out, &reports);
    climbing(&mut out, data)?;
    other_knobs(&mut out, &reports);
    put_in(&mut out, &plots.join("peers.md"))?;
    requirements(&mut out, count.min(40), options.seed);
    write(&folder.join("accuracy.md"), &out)
}

fn honest(mut report: Report) -> Result<Report, DocumentError> {
    match report.lies.pop() {
        Some(lie) => Err(DocumentError::Lie { scene: report.scene, lie: Box::new(lie) }),
        None => Ok(report),
    }
}

fn herd(data: &Path, seed: u64) -> Result<Scene, DocumentError> {
    let mesh = read_obj(&data.join("mesh").join("spot.obj"))?;
    let spot = Triangles { name: "spot".to_owned(), vertices: mesh.vertices, triangles: mesh.triangles };
    Ok(Scene::herd(&spot, seed)?)
}

fn write(path: &Path, text: &str) -> Result<(), DocumentError> {
    fs::write(path, text).map_err(|source| DocumentError::File { path: path.to_owned(), source })
}

fn put_in(out: &mut String, path: &Path) -> Result<(), DocumentError> {
    let text = fs::read_to_string(path).map_err(|source| DocumentError::File { path: path.to_owned(), source })?;
    let _ = writeln!(out, "{}", text.trim_end());
    out.push('\n');
    Ok(())
}

/// What each tier promises, as its defaults say.
fn tiers(out: &mut String) {
    out.push_str(
        "## What each tier promises\n\n| tier | relative error | budget | stand-ins | so |\n|---|---|---|---|---|\n",
    );
    for (name, tier, so) in [
        (
            "FAST",
            Tier::Fast,
            "intervals within a tenth of the value, of whatever form is good enough for that; what grazes may stay open",
        ),
        ("STANDARD", Tier::Standard, "intervals within a millionth of the value, of the geometry itself"),
        (
            "EXACT",
            Tier::Exact,
            "intervals as narrow as the arithmetic allows; open verdicts are asked again with more digits",
        ),
    ] {
        let Accuracy { max_error_relative, budget, .. } = Accuracy::of(tier);
        let relative = if max_error_relative == 0.0 { "0".to_owned() } else { format!("{max_error_relative:e}") };
        let may = if Accuracy::of(tier).may_stand_in() { "may answer" } else { "never" };
        let _ = writeln!(out, "| {name} | {relative} | {budget} | {may} | {so} |");
    }
    out.push_str(
        "\nAn interval is narrow enough if its width is within `max_error` **or** within `max_error_relative` of the value. It holds the truth in every \
tier: a tier says how narrow it is, never whether it is true. A budget that ends first leaves the interval wider and says so (`stop`).\n\n",
    );
}

fn pictures(out: &mut String, plots: &Path, reports: &[Report]) -> Result<(), DocumentError> {
    out.push_str(
        "## Time and true error\n\nA point for each setting; the line joins those that no other beats in both. Points one above the other are accuracy for nothing.\n\n",
    );
    for (name, kind) in SHOWN {
        let Some(report) = reports.iter().find(|report| report.scene == name.text()) else { continue };
        let rows: Vec<&Row> = report.rows.iter().filter(|row| row.kind == kind).collect();
        let file = format!("{}-{}.svg", name.text(), kind.text());
        write(&plots.join(&file), &svg(&rows))?;
        let _ = writeln!(out, "![{}, {}: largest true error over time](accuracy/{file})\n", name.text(), kind.text());
    }
    Ok(())
}

fn of(report: &Report, kind: Kind, knob: Knob) -> impl Iterator<Item = &Row> {
    report.rows.iter().filter(move |row| row.kind == kind && row.knob == knob && row.count > 0)
}

fn tier_of(report: &Report, kind: Kind, label: &str) -> Option<Row> {
    of(report, kind, Knob::Tier).find(|row| row.label == label).cloned()
}

/// What a decade of each tolerance costs.
fn decades(out: &mut String, reports: &[Report]) {
    out.push_str(
        "## What a decade costs\n\nMean time of a question in the widest and in the narrowest tolerance of nine decades, and what each decade costs in between.\n\n\
| question | scene | knob | widest, ns | narrowest, ns | a decade |\n|---|---|---|---|---|---|\n",
    );
    for (kind, scene) in [
        (Kind::Raycast, Name::Arena),
        (Kind::Overlap, Name::Arena),
        (Kind::Distance, Name::Coins),
        (Kind::Distance, Name::Debris),
        (Kind::Penetration, Name::Coins),
        (Kind::Penetration, Name::Debris),
        (Kind::Impact, Name::Coins),
        (Kind::TurningImpact, Name::Arena),
        (Kind::TurningImpact, Name::Coins),
        (Kind::TurningImpact, Name::Terrain),
    ] {
        let Some(report) = reports.iter().find(|report| report.scene == scene.text()) else { continue };
        for knob in [Knob::MaxError, Knob::MaxErrorRelative] {
            let rows: Vec<&Row> = of(report, kind, knob).collect();
            let [Some(first), Some(last)] = [rows.first(), rows.last()] else { continue };
            let [first, last] = [first.time_ns[0], last.time_ns[0]];
            let each = (last / first).powf(1.0 / (rows.len() - 1).max(1) as f64) - 1.0;
            let (kind, scene, knob) = (kind.text(), scene.text(), knob.text());
            let _ = writeln!(out, "| {kind} | {scene} | `{knob}` | {first:.0} | {last:.0} | {:+.0} % |", each * 100.0);
        }
    }
    out.push('\n');
}

/// Where nothing is to be had by asking for less.
fn freedom(out: &mut String, reports: &[Report]) {
    out.push_str(
        "## Where accuracy is free\n\nHow many times as long the exact tier takes as the fast one (mean), with the largest true error of the fast one. `=` is where both take the same \
steps (iterations, nodes, pairs), so that times differ by the noise of the clock alone. Around 1 there is nothing to be had: ask exactly. Below 1 asking for less costs more: stand-ins were asked in vain, or wide intervals left more shapes to look at. Where shapes are so near to each other in time or distance that their intervals overlap, the one of the least best value is told as the closest, and the error is from \
that to the true first. Rays and straight motions of convex forms are answered to rounding \
at any setting, and so are boxes, hulls and what else has flat faces only, in the few steps that end at a corner, an edge or a face. What trades is what turns, what is \
round, and what is large.\n\n| scene |",
    );
    for kind in Kind::ALL {
        let _ = write!(out, " {} |", kind.text());
    }
    out.push_str("\n|---|---|---|---|---|---|---|\n");
    for report in reports {
        let _ = write!(out, "| {} |", report.scene);
        for kind in Kind::ALL {
            let cell = match (tier_of(report, kind, "EXACT"), tier_of(report, kind, "FAST")) {
                (Some(exact), Some(fast)) => {
                    let times = match exact.work == fast.work {
                        true => "=".to_owned(),
                        false => format!("{:.2}", exact.time_ns[0] / fast.time_ns[0]),
                    };
                    match kind {
                        Kind::Overlap => format!("{times}, {:.0} % open", fast.open * 100.0),
                        _ => format!("{times}, {:.0e} m", fast.error[2]),
                    }
                }
                _ => "–".to_owned(),
            };
            let _ = write!(out, " {cell} |");
        }
        out.push('\n');
    }
    out.push('\n');
}

/// What each rung costs on pairs alone, without a world around them.
fn climbing(out: &mut String, data: &Path) -> Result<(), DocumentError> {
    out.push_str(
        "## What each stand-in costs and knows\n\nPairs of real assets alone, from touching to twenty sizes apart (`yardstick ladder`). Distances gain most; whether two meshes touch is told \
by stand-ins where they do not. A convex form is asked about the mesh itself, as that is as cheap.\n\n```text\n",
    );
    let mut table = Vec::new();
    ladder::run(data, &mut table)?;
    let _ = writeln!(out, "{}```\n", String::from_utf8_lossy(&table));
    Ok(())
}

/// Trees, margins, simplified hulls, parts.
fn other_knobs(out: &mut String, reports: &[Report]) {
    out.push_str(
        "## Trees, margins, simpler hulls, parts\n\nNone of these is a field of a question. Trees and margins never change an answer. There is no switch for filters in f32: boxes of trees are in f32 \
always, and what decides never is.\n\n| scene | question | knob | setting | p50, ns | nodes | largest error | made in |\n|---|---|---|---|---|---|---|---|\n",
    );
    let shown = [(Name::Debris, Kind::Distance), (Name::Debris, Kind::Overlap), (Name::Coins, Kind::Penetration)];
    for (name, kind) in shown {
        let Some(report) = reports.iter().find(|report| report.scene == name.text()) else { continue };
        for knob in [Knob::Tree, Knob::Margin, Knob::HullVertices, Knob::PartsError] {
            for row in of(report, kind, knob) {
                let [_, half, _] = row.time_ns;
                let (scene, kind, knob, nodes) = (name.text(), kind.text(), knob.text(), row.work[1]);
                let error =
                    if row.kind == Kind::Overlap { "–".to_owned() } else { format!("{:.0e} m", row.error[2]) };
                let _ = writeln!(
                    out,
                    "| {scene} | {kind} | {knob} | {} | {half:.0} | {nodes:.1} | {error} | {} |",
                    row.label, row.note
                );
            }
        }
    }
    out.push('\n');
}

/// What scenes had built.
fn requirements(out: &mut String, count: usize, seed: u64) {
    let _ = write!(
        out,
        "## A scene pays for what it asks\n\nWhat is built when {count} questions of a kind are asked of a new world, beside everything that can be built (but for convex parts, which only a \
user asks for). Built in is what the first time of all questions took longer than the second; memory is all that the world holds, forms included.\n\n\
| scene | asked | built | memory, KiB | built in, ms |\n|---|---|---|---|---|\n"
    );
    for name in Name::ALL {
        for Needed { asked, description, build_ms } in needed(&|| Scene::named(name, seed), count, seed) {
            let built: Vec<String> = description.built.iter().map(|it| format!("{} {}", it.count, it.name)).collect();
            let built = if built.is_empty() { "–".to_owned() } else { built.join(", ") };
            let memory = description.memory_bytes as f64 / 1024.0;
            let _ = writeln!(out, "| {} | {asked} | {built} | {memory:.0} | {build_ms:.1} |", name.text());
        }
    }
}
