//! `load`: a triangle mesh from a file into a world.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use calipers_client::{Client, geometry, proto, shape};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

use super::Failure;
use super::input::Triple;
use super::mesh_file::{self, Triangles, Unit, Up};
use super::print;
use super::target::Target;

/// Time for the server to answer what is not the upload.
const DEADLINE: Duration = Duration::from_secs(60);

/// Puts a triangle mesh from a file into a world.
#[derive(Debug, Args)]
#[command(after_help = "Example: calipers load level.glb --id 7 --at 0,-1,0")]
pub(crate) struct Load {
    /// The file: .obj, .stl, .ply, .gltf or .glb; polygons are cut into triangles, nodes placed, materials passed over
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// What a number of the file means
    #[arg(long, value_enum, default_value_t)]
    unit: Unit,
    /// The axis that points up in the file
    #[arg(long, value_enum, default_value_t)]
    up: Up,
    /// Which side of its triangles is matter
    #[arg(long, value_enum, default_value_t)]
    mode: Mode,
    /// Id of the shape that is made of it; a shape that has this id is replaced
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    id: u64,
    /// Where the shape's origin is, in metres
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true)]
    at: Triple,
    /// Factor on the mesh, on top of its unit
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true)]
    scale: Option<f64>,
    /// Only registers the geometry, and makes no shape of it
    #[arg(long)]
    geometry_only: bool,
    #[command(flatten)]
    target: Target,
}

/// Which side of a triangle is matter.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Mode {
    /// A surface, felt from both sides
    #[default]
    TwoSided,
    /// A surface, felt only from where its corners go counter-clockwise
    OneSided,
    /// A body: the mesh must be closed and its triangles must face outwards
    Solid,
}

impl From<Mode> for proto::MeshMode {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::TwoSided => Self::TwoSided,
            Mode::OneSided => Self::OneSided,
            Mode::Solid => Self::Solid,
        }
    }
}

impl Load {
    pub(crate) async fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        let triangles = read(&self.file, self.unit, self.up)?;
        for note in &triangles.notes {
            writeln!(out, "note: {note}")?;
        }
        let (sent_count, vertex_count) = (triangles.indices.len() / 3, triangles.vertices.len() / 3);
        // Connecting comes after reading: a broken file is told whether or not a server runs.
        let client = self.target.connect(DEADLINE).await?;
        let info = upload(&client, triangles, self.mode).await?;
        report(out, &info, sent_count, vertex_count)?;
        if let Some(problem) = info.problem {
            return Err(Failure::new(format!("the server cannot use the mesh: {}", problem.message)));
        }
        if self.geometry_only {
            return Ok(());
        }
        let mut form = geometry::registered(info.geometry_id);
        form.scale = self.scale;
        let done = client.edit([shape::of(self.id, form).at(self.at.0).fixed().insert()]).await?;
        Ok(writeln!(out, "shape {}, seen from tick {}", self.id, done.tick)?)
    }
}

/// Reads the file beside a progress bar, which is drawn on a terminal only.
fn read(path: &Path, unit: Unit, up: Up) -> Result<Triangles, Failure> {
    let length = path.metadata().map_or(0, |file| file.len());
    let bar = bar(length, "reading")?;
    let triangles = mesh_file::read(path, unit, up, |file| bar.wrap_read(file));
    bar.finish_and_clear();
    Ok(triangles?)
}

/// Sends the mesh beside another one, which waits at its end while the server takes the mesh in.
async fn upload(client: &Client, triangles: Triangles, mode: Mode) -> Result<proto::GeometryInfo, Failure> {
    let mesh = proto::TriangleMesh {
        vertices: triangles.vertices,
        indices: triangles.indices,
        mode: proto::MeshMode::from(mode).into(),
        decompose: None,
    };
    let kind = Some(proto::geometry::Kind::Mesh(mesh));
    let bar = bar(0, "sending")?;
    bar.enable_steady_tick(Duration::from_millis(100));
    let geometry = proto::Geometry { kind, ..proto::Geometry::default() };
    let info = client.upload(geometry, |so_far| {
        bar.set_length(so_far.total_bytes);
        bar.set_position(so_far.sent_bytes);
        if so_far.sent_bytes == so_far.total_bytes {
            bar.set_message("the server takes it in");
        }
    });
    let info = info.await;
    bar.finish_and_clear();
    Ok(info?)
}

fn bar(length: u64, what: &'static str) -> Result<ProgressBar, Failure> {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {bytes}/{total_bytes}")?;
    Ok(ProgressBar::new(length).with_style(style).with_message(what))
}

fn report(
    out: &mut impl Write,
    info: &proto::GeometryInfo,
    sent_count: usize,
    vertex_count: usize,
) -> Result<(), Failure> {
    let left_out_count = (sent_count as u64).saturating_sub(info.face_count);
    write!(out, "{} in the file, ", print::count(sent_count as u64, "triangle"))?;
    writeln!(out, "{left_out_count} of them without area and left out")?;
    writeln!(out, "{vertex_count} vertices sent, {} different ones", info.vertex_count)?;
    for warning in &info.warnings {
        writeln!(out, "warning: {warning}")?;
    }
    Ok(writeln!(out, "geometry {}", info.geometry_id)?)
}
