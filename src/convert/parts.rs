//! Convex parts of meshes: what is asked of them, how far they are, and what they are worth.

use collision::{
    answer::{Bound, Stop},
    decompose::Options,
    shape::{Geometry, MeshParts, PartsAsked},
};
use wire::v1::{self as pb, geometry::Kind};

use super::{
    answer::interval,
    built::build_time_out,
    geometry::{info_out, registrable},
    number::{count, not_finite},
};
use crate::{
    building::{Building, Stage},
    geometries::{Geometries, id_text},
    problem::{Checked, Problem, Reason, Under},
};

/// Most parts that may be asked for, and how many there are at most if none is said.
const PARTS_MAX: u32 = 1024;
const PARTS_USUAL: u32 = 32;

/// A geometry to register: as it is, or as soon as its parts are made.
#[derive(Debug)]
pub(crate) enum ToRegister {
    /// It is whole.
    Whole(Geometry),
    /// A mesh that is to be cut.
    ToCut(Geometry, Options),
}

/// A geometry that is to be registered.
///
/// # Errors
/// What is wrong with it; kinds that are not served yet; an id that names nothing.
pub(crate) fn to_register(sent: &pb::Geometry, known: &Geometries) -> Checked<ToRegister> {
    let Some(Kind::Mesh(mesh)) = &sent.kind else { return registrable(sent, known).map(ToRegister::Whole) };
    let Some(asked) = &mesh.decompose else { return registrable(sent, known).map(ToRegister::Whole) };
    let options = options(asked, known).under("mesh.decompose")?;
    let mut bare = sent.clone();
    if let Some(Kind::Mesh(mesh)) = &mut bare.kind {
        mesh.decompose = None;
    }
    Ok(ToRegister::ToCut(registrable(&bare, known)?, options))
}

impl ToRegister {
    /// A mesh that was made already, and what was sent of it.
    ///
    /// # Errors
    /// What is wrong with what is asked of its parts.
    pub(super) fn of_mesh(mesh: Geometry, sent: &pb::TriangleMesh, known: &Geometries) -> Checked<Self> {
        match &sent.decompose {
            None => Ok(Self::Whole(mesh)),
            Some(asked) => Ok(Self::ToCut(mesh, options(asked, known).under("mesh.decompose")?)),
        }
    }
}

fn options(asked: &pb::Decompose, known: &Geometries) -> Checked<Options> {
    let max_parts = count("max_parts", asked.max_parts, PARTS_USUAL as usize, PARTS_MAX as usize)?;
    let max_error = asked.max_error;
    if !max_error.is_finite() {
        return Err(not_finite("max_error".to_owned(), max_error));
    }
    if max_error < 0.0 {
        let what = format!("is {max_error}: it must be at least 0 metres; 0 means 1 % of the diagonal");
        return Err(Problem::at("max_error", Reason::OutOfLimits, what));
    }
    let budget = steps(asked.max_steps, known.decompose_steps())?;
    Ok(Options { max_parts: u32::try_from(max_parts).unwrap_or(PARTS_MAX), max_error, budget })
}

/// Steps that are asked of `most` that the server allows.
fn steps(asked: u64, most: u64) -> Checked<u64> {
    match asked {
        0 => Ok(Options::BUDGET_USUAL.min(most)),
        1.. if asked <= most => Ok(asked),
        1.. => {
            let what = format!(
                "is {asked}: this server allows at most {most} steps, so ask for as many or fewer parts, or have decompose_steps raised"
            );
            let problem = Problem::at("max_steps", Reason::QuotaExceeded, what);
            Err(problem.with("quota", "decompose_steps").with("limit", most))
        }
    }
}

/// What was asked of parts.
pub(crate) fn asked_out(parts: &MeshParts) -> pb::Decompose {
    let PartsAsked { max_parts, max_error, max_steps } = parts.asked;
    pb::Decompose { max_parts, max_error, max_steps }
}

/// What parts are worth.
///
/// # Errors
/// A number is not finite, which is a fault of the server.
pub(crate) fn result_out(parts: &MeshParts) -> Checked<pb::DecomposeResult> {
    let within = |bound: Bound| interval(bound).map(Some);
    Ok(pb::DecomposeResult {
        part_count: parts.part_count,
        outside: within(parts.outside)?,
        inside: within(parts.inside)?,
        volume_excess: parts.volume_excess,
        stop: match parts.stop {
            Stop::Converged => pb::Stop::Converged,
            Stop::Tolerance => pb::Stop::Tolerance,
            Stop::Budget => pb::Stop::Budget,
        }
        .into(),
        build_time: build_time_out(parts.receipt.build_ns),
        first_tick: parts.receipt.first_tick.unwrap_or(0),
        steps: parts.steps,
    })
}

/// What is said of a geometry in work.
///
/// # Errors
/// As [`info_out`].
pub(crate) fn building_out(building: &Building) -> Checked<pb::GeometryInfo> {
    let (state, progress, problem) = match building.stage() {
        Stage::InWork(progress) => (pb::GeometryState::Building, progress, None),
        Stage::Ready => (pb::GeometryState::Building, 1.0, None),
        Stage::Failed(problem) => (pb::GeometryState::Failed, 0.0, Some(problem.into_wire())),
        Stage::Forgotten => (pb::GeometryState::Failed, 0.0, None),
    };
    Ok(pb::GeometryInfo {
        geometry_id: id_text(building.id),
        state: state.into(),
        progress: progress.into(),
        problem,
        ..info_out(&building.mesh, 0)?
    })
}
