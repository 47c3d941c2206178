//! Which scene is measured: a named one, or the user's own files.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use glam::DVec3;
use indicatif::{ProgressBar, ProgressStyle};
use yardstick::measure::Kind;
use yardstick::scenes::{Name, Scene, TakenFor, Triangles};

use super::Failure;
use super::carry;
use super::mesh_file::{self, Unit, Up};

/// Which scene.
#[derive(Debug, Args)]
pub(crate) struct Stage {
    /// Mesh files (as `load` reads them): the first stands, the others are asked about; without others a ball, a capsule and a
    /// box of a thirtieth of its size. Or one world that `export` wrote, such as that of a session or of a trace that was played: what
    /// moves in it is asked about
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// A generated scene: arena, debris, terrain, columns, needles, planet or coins; can be given several times
    #[arg(long = "scene", value_name = "NAME", conflicts_with = "files")]
    names: Vec<Name>,
    /// What a number of the files means
    #[arg(long, value_enum, default_value_t)]
    unit: Unit,
    /// The axis that points up in the files
    #[arg(long, value_enum, default_value_t)]
    up: Up,
    /// What the files are taken for
    #[arg(long, value_enum, default_value_t)]
    taken_for: Taken,
    /// Names the scene and the questions: the same seed, the same ones
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Only this kind of question: raycast, overlap, distance, penetration, impact or turning-impact; can be given several times
    #[arg(long = "question", value_name = "KIND")]
    kinds: Vec<Kind>,
}

/// What a file is taken for.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Taken {
    /// Its triangles
    #[default]
    Mesh,
    /// The convex hull of its corners
    Hull,
}

impl Stage {
    /// The scenes; all generated ones if nothing is said.
    pub(crate) fn scenes(&self) -> Result<Vec<Scene>, Failure> {
        if self.files.is_empty() {
            let names = if self.names.is_empty() { &Name::ALL[..] } else { &self.names };
            return Ok(names.iter().map(|&name| Scene::named(name, self.seed)).collect());
        }
        if let [path] = &*self.files
            && !mesh_file::is_known(path)
        {
            if is_trace(path) {
                let name = path.display();
                return Err(Failure::new(format!(
                    "{name} is a trace, which does not say what its actors look like. Play it to a server, then measure the world that it \
                     leaves: calipers play {name} --kind NAME=FORM --speed max, then calipers export FILE, then this with FILE"
                )));
            }
            let world = calipers::exported::world(carry::pieces(path)?.into_iter())
                .map_err(|why| Failure::new(format!("{} is no whole export: {why}", path.display())))?;
            return Ok(vec![Scene::of_world(&name_of(path), &world.newest())?]);
        }
        let files = self.files.iter().map(|path| {
            let read = mesh_file::read(path, self.unit, self.up, |file| file)?;
            let corner = |[x, y, z]: &[f32; 3]| DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z));
            let vertices = read.vertices.as_chunks().0.iter().map(corner).collect();
            Ok(Triangles { name: name_of(path), vertices, triangles: read.indices.as_chunks().0.to_vec() })
        });
        let files: Vec<Triangles> = files.collect::<Result<_, Failure>>()?;
        let taken_for = match self.taken_for {
            Taken::Mesh => TakenFor::Mesh,
            Taken::Hull => TakenFor::Hull,
        };
        Ok(vec![Scene::of_files(&files, taken_for)?])
    }

    /// Whether a scene is named at all.
    pub(crate) fn is_said(&self) -> bool {
        !self.files.is_empty() || !self.names.is_empty()
    }

    /// The kinds of questions; all if nothing is said.
    pub(crate) fn kinds(&self) -> Vec<Kind> {
        if self.kinds.is_empty() { Kind::ALL.to_vec() } else { self.kinds.clone() }
    }

    /// The arguments that name the scene again.
    pub(crate) fn again(&self, scene: &Scene) -> String {
        let files: Vec<String> = self.files.iter().map(|path| path.display().to_string()).collect();
        let which = if files.is_empty() { format!("--scene {}", scene.name) } else { files.join(" ") };
        let taken_for = if matches!(self.taken_for, Taken::Hull) { " --taken-for hull" } else { "" };
        format!("{which}{taken_for} --seed {}", self.seed)
    }
}

/// Whether a file is named as traces are.
fn is_trace(path: &Path) -> bool {
    let name = path.to_string_lossy().to_lowercase();
    name.ends_with(".csv") || name.ends_with(".csv.gz")
}

fn name_of(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// A bar on standard error that is drawn on a terminal only.
pub(crate) fn bar() -> Result<ProgressBar, Failure> {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}")?;
    Ok(ProgressBar::new(0).with_style(style))
}
