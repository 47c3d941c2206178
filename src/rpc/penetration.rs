//! `Penetration`: what overlaps a subject, and how deep.

use wire::v1::{self as pb, geometry::Kind, subject::Form};

use super::scene::Scene;
use crate::{
    convert::{answer as found, question as asked},
    problem::{Checked, Reason},
};

/// Answers it on the scene's version.
///
/// # Errors
/// What is wrong with the question, the deadline.
pub(super) fn answer(sent: &pb::PenetrationRequest, scene: &Scene) -> Checked<pb::PenetrationResponse> {
    let question = asked::penetration(sent, &scene.session.geometries)?;
    let terms = scene.shared.overridden_by(sent.options.as_deref())?;
    let brings_mesh = brings_mesh(sent);
    let alone = brings_mesh.then(|| scene.without_workshop());
    let scene = alone.as_ref().unwrap_or(scene);
    let asked = scene.ask(&terms, |meter| scene.snapshot.penetration(&question, &terms.filter, &terms.accuracy, meter));
    let (hits, account) = asked.map_err(|problem| match brings_mesh && problem.is(Reason::GeometryNotReady) {
        true => found::parts_of_nobody(),
        false => problem,
    })?;
    Ok(pb::PenetrationResponse { info: scene.info(&terms, account), ..found::penetration(&hits)? })
}

/// Whether a mesh is sent with the question, not named: what is made of it is gone with the question.
fn brings_mesh(sent: &pb::PenetrationRequest) -> bool {
    let subjects = [sent.subject.as_ref(), sent.against.as_deref()].into_iter().flatten();
    let mut forms = subjects.filter_map(|subject| match &subject.form {
        Some(Form::Geometry(geometry)) => Some(geometry),
        Some(Form::Id(_)) | None => None,
    });
    forms.any(is_mesh)
}

/// Compounds are few deep, which was checked.
fn is_mesh(geometry: &pb::Geometry) -> bool {
    match &geometry.kind {
        Some(Kind::Mesh(_)) => true,
        Some(Kind::Compound(compound)) => compound.parts.iter().filter_map(|part| part.geometry.as_ref()).any(is_mesh),
        _ => false,
    }
}
