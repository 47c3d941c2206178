//! `load`: a triangle mesh from a file into a world.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use calipers_client::{geometry, proto, shape};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use prost::Message;

use super::Failure;
use super::input::Triple;
use super::obj::{self, Triangles};
use super::print;
use super::target::Target;

/// Time for the server to take in the largest mesh that fits into a message.
const DEADLINE: Duration = Duration::from_secs(60);
/// The largest message that the API allows.
const MESSAGE_BYTES_MAX: usize = 4 << 20;

/// Puts a triangle mesh from a Wavefront OBJ file into a world.
#[derive(Debug, Args)]
#[command(after_help = "Example: calipers load level.obj --id 7 --at 0,-1,0")]
pub(crate) struct Load {
    /// The file; polygons are cut into triangles, materials and normals are passed over
    #[arg(value_name = "FILE.obj")]
    file: PathBuf,
    /// Id of the shape that is made of it; a shape that has this id is replaced
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    id: u64,
    /// Where the shape's origin is, in metres
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true)]
    at: Triple,
    /// Factor on the mesh, for files in centimetres and the like
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true)]
    scale: Option<f64>,
    /// Only registers the geometry, and makes no shape of it
    #[arg(long)]
    geometry_only: bool,
    #[command(flatten)]
    target: Target,
}

impl Load {
    pub(crate) async fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        let triangles = read(&self.file)?;
        let sent_count = triangles.indices.len() / 3;
        let vertex_count = triangles.vertices.len() / 3;
        let request = request(&self.file, triangles)?;
        // Connecting comes after reading: a broken file is told whether or not a server runs.
        let client = self.target.connect(DEADLINE).await?;
        let waiting = ProgressBar::new_spinner().with_message("the server takes it in");
        waiting.enable_steady_tick(Duration::from_millis(100));
        let made = client.create_geometry(request).await;
        waiting.finish_and_clear();
        let info = made?.geometry.ok_or_else(|| Failure::new("the server did not say what it made of the mesh"))?;
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
fn read(path: &Path) -> Result<Triangles, Failure> {
    let length = path.metadata().map_or(0, |file| file.len());
    let style = ProgressStyle::with_template("{msg} {wide_bar} {bytes}/{total_bytes}")?;
    let bar = ProgressBar::new(length).with_style(style).with_message("reading");
    let triangles = obj::read(path, |file| bar.wrap_read(file));
    bar.finish_and_clear();
    Ok(triangles?)
}

/// The message, if one message is enough.
fn request(path: &Path, triangles: Triangles) -> Result<proto::CreateGeometryRequest, Failure> {
    let (vertex_count, triangle_count) = (triangles.vertices.len() / 3, triangles.indices.len() / 3);
    let mesh = proto::TriangleMesh {
        vertices: triangles.vertices,
        indices: triangles.indices,
        mode: proto::MeshMode::TwoSided.into(),
        decompose: None,
    };
    let kind = Some(proto::geometry::Kind::Mesh(mesh));
    let geometry = Some(proto::Geometry { kind, ..proto::Geometry::default() });
    let request = proto::CreateGeometryRequest { geometry, ..proto::CreateGeometryRequest::default() };
    let found = request.encoded_len();
    // The session's name comes on top, 65 bytes at most.
    if found + 65 > MESSAGE_BYTES_MAX {
        return Err(Failure::new(format!(
            "{} has {vertex_count} vertices and {triangle_count} triangles, a message of {found} bytes; one message holds \
             at most {MESSAGE_BYTES_MAX}, and uploads in several pieces (UploadGeometry) come with a later version",
            path.display()
        )));
    }
    Ok(request)
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
