//! Part D: convex parts of meshes, ours beside those of parry3d's V-HACD and published ones.
//!
//! `CALIPERS_DATA` names the folder of data (`../shared/data` from the workspace, if it is not set). Errors of all are certified by
//! `collision::decompose::measure`, as parts of the diagonal of the mesh's box; V-HACD itself states none.

#[path = "../files.rs"]
mod files;

use std::{
    io::{self, Write},
    ops::ControlFlow,
    path::Path,
    time::Duration,
};

use collision::{
    DVec3,
    decompose::{self, Errors, Options, Progress},
    shape::{Convex, Core, Form, Geometry, Mesh},
};
use files::obj;
use parry3d::{
    math::Vector,
    transformation::vhacd::{VHACD, VHACDParameters},
};
use rustix::time::{ClockId, clock_gettime};

/// Errors are known to within this part of the diagonal.
const WIDTH: f64 = 0.001;

/// Most steps of one measurement.
const BUDGET: u64 = 1 << 30;

const MESHES: [&str; 4] = ["teddy", "spot", "not_convex", "featuretype"];

fn main() -> io::Result<()> {
    let folder = files::folder();
    let mut out = io::stdout();
    writeln!(
        out,
        "{:<28} {:>5} {:>8} {:>9} {:>16} {:>16} {:>8}",
        "row", "parts", "corners", "ms", "inside %", "outside %", "excess %"
    )?;
    for name in MESHES {
        let (vertices, triangles) = obj(&folder.join(format!("{name}.obj")))?;
        let geometry = Geometry::mesh(&vertices, &triangles).map_err(io::Error::other)?;
        let Form::Mesh(mesh) = geometry.form() else { return Err(io::Error::other("a mesh")) };
        let bounds = geometry.local_bounds();
        let subject = Subject { name, mesh, diagonal: (bounds.max - bounds.min).length() };
        subject.write_ours(&mut out)?;
        subject.write_peer(&mut out, &vertices, &triangles)?;
        if name == "teddy" {
            let published = published(&folder.join("teddy_vhacd_parts.obj"), [bounds.min, bounds.max])?;
            let errors = subject.measured(&published)?;
            subject.write_row(&mut out, "published", &published, None, &errors)?;
        }
    }
    Ok(())
}

/// A mesh and what it is called.
struct Subject<'a> {
    name: &'a str,
    mesh: &'a Mesh,
    diagonal: f64,
}

impl Subject<'_> {
    fn write_ours(&self, out: &mut impl Write) -> io::Result<()> {
        for (engine, share) in [("calipers-1%", 0.01), ("calipers-5%", 0.05)] {
            let options = Options { max_error: share * self.diagonal, ..Options::default() };
            let (found, time) = timed(|| decompose::decompose(self.mesh, &options, &mut go_on));
            let found = found.map_err(io::Error::other)?;
            let parts: Vec<Geometry> = found.parts.iter().map(|part| part.geometry.clone()).collect();
            self.write_row(out, engine, &parts, Some(time), &found.errors)?;
        }
        Ok(())
    }

    fn write_peer(&self, out: &mut impl Write, vertices: &[DVec3], triangles: &[[u32; 3]]) -> io::Result<()> {
        let points: Vec<Vector> = vertices.iter().map(|v| Vector::new(v.x as f32, v.y as f32, v.z as f32)).collect();
        for resolution in [64, 128] {
            let parameters = VHACDParameters { max_convex_hulls: 32, resolution, ..VHACDParameters::default() };
            let (hulls, time) = timed(|| {
                VHACD::decompose(&parameters, &points, triangles, true).compute_exact_convex_hulls(&points, triangles)
            });
            let made = hulls.iter().filter(|(points, _)| !points.is_empty()).map(|(points, _)| {
                let points: Vec<DVec3> =
                    points.iter().map(|p| DVec3::new(f64::from(p.x), f64::from(p.y), f64::from(p.z))).collect();
                Geometry::hull(&points).map_err(io::Error::other)
            });
            let parts = made.collect::<io::Result<Vec<Geometry>>>()?;
            let errors = self.measured(&parts)?;
            self.write_row(out, &format!("parry-vhacd-{resolution}"), &parts, Some(time), &errors)?;
        }
        Ok(())
    }

    fn measured(&self, parts: &[Geometry]) -> io::Result<Errors> {
        decompose::measure(self.mesh, parts, WIDTH * self.diagonal, BUDGET, &mut go_on).map_err(io::Error::other)
    }

    fn write_row(
        &self,
        out: &mut impl Write,
        engine: &str,
        parts: &[Geometry],
        time: Option<Duration>,
        errors: &Errors,
    ) -> io::Result<()> {
        let hulls = parts.iter().filter_map(|part| match part.form() {
            Form::Convex(Convex { core: Core::Hull(hull), .. }) => Some(hull),
            _ => None,
        });
        let corners: usize = hulls.clone().map(|hull| hull.vertices().len()).sum();
        let volume: f64 = hulls.map(|hull| hull.volume()).sum();
        let excess = self.mesh.volume().map(|whole| 100.0 * (volume / whole - 1.0));
        let percent = |bound: collision::answer::Bound| {
            format!("{:.3} to {:.3}", 100.0 * bound.lower / self.diagonal, 100.0 * bound.upper / self.diagonal)
        };
        writeln!(
            out,
            "{:<28} {:>5} {corners:>8} {:>9} {:>16} {:>16} {:>8}",
            format!("D/{}/{engine}", self.name),
            parts.len(),
            time.map_or_else(|| "-".into(), |time| format!("{:.0}", time.as_secs_f64() * 1e3)),
            percent(errors.inside),
            percent(errors.outside),
            excess.map_or_else(|| "-".into(), |excess| format!("{excess:.1}")),
        )
    }
}

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// What work makes, and the CPU time of this thread that it took.
fn timed<Made>(work: impl FnOnce() -> Made) -> (Made, Duration) {
    let now = || {
        let now = clock_gettime(ClockId::ThreadCPUTime);
        Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
    };
    let start = now();
    let made = work();
    (made, now() - start)
}

/// The published parts, each a connected surface, turned by half a turn about y, moved and scaled so that their box fits that of the
/// mesh: they were made of a copy of another size that looks the other way. How well the two fit is in their errors.
fn published(path: &Path, [min, max]: [DVec3; 2]) -> io::Result<Vec<Geometry>> {
    let (vertices, triangles) = obj(path)?;
    let (low, high) = vertices
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &vertex| (low.min(vertex), high.max(vertex)));
    let ratios = (max - min) / (high - low);
    let scale = ratios.element_sum() / 3.0;
    let half_turn = DVec3::new(-1.0, 1.0, -1.0);
    let placed = |vertex: DVec3| (vertex - (low + high) * 0.5) * scale * half_turn + (min + max) * 0.5;
    let mut group: Vec<usize> = (0..vertices.len()).collect();
    loop {
        let before = group.clone();
        for triangle in &triangles {
            let least = triangle.iter().map(|&vertex| group[vertex as usize]).min().unwrap_or(0);
            triangle.iter().for_each(|&vertex| group[vertex as usize] = least);
        }
        if group == before {
            break;
        }
    }
    let firsts = (0..vertices.len()).filter(|&index| group[index] == index);
    let part = |first: usize| {
        let points: Vec<DVec3> =
            (0..vertices.len()).filter(|&index| group[index] == first).map(|index| placed(vertices[index])).collect();
        Geometry::hull(&points).map_err(io::Error::other)
    };
    firsts.map(part).collect()
}
