//! `Raycast`: what a ray hits.

use collision::{
    answer::Verdict,
    world::{Raycast, ShapeId},
};
use wire::v1::{self as pb, question::Question as Asked};

use super::{account::Account, answering::ANSWERING, scene::Scene};
use crate::{
    convert::{answer as found, question as asked},
    fence::fenced,
    problem::Checked,
};

/// Rays that are asked together at most: some fifty microseconds of work.
pub(super) const TOGETHER: usize = 64;

/// Answers it on the scene's version.
///
/// # Errors
/// What is wrong with the question, the deadline.
pub(super) fn answer(sent: &pb::RaycastRequest, scene: &Scene) -> Checked<pb::RaycastResponse> {
    let question = asked::raycast(sent)?;
    let terms = scene.shared.overridden_by(sent.options.as_deref())?;
    let against = asked::against(sent.against.as_deref(), &scene.session.geometries)?;
    let (hits, account) = scene.ask(&terms, |meter| match &against {
        None => scene.snapshot.raycast(&question, &terms.filter, &terms.accuracy, meter),
        Some(against) => scene.snapshot.raycast_against(&question, against, &terms.accuracy, meter),
    })?;
    Ok(pb::RaycastResponse { info: scene.info(&terms, account), ..found::raycast(&hits)? })
}

/// A ray that may be asked together with others of its session: it leaves options to whoever asks, and is asked of the world.
pub(super) fn plain(asked: &pb::Question) -> Option<&pb::RaycastRequest> {
    match &asked.question {
        Some(Asked::Raycast(ray)) if ray.options.is_none() && ray.against.is_none() => Some(ray),
        _ => None,
    }
}

/// Answers plain rays on the scene's version, on the terms that it has for all. `None` where each is to be answered by itself: because
/// there are few, or they are to tell what they do, or something is wrong with one.
pub(super) fn answer_together(rays: &[&pb::RaycastRequest], scene: &Scene) -> Option<Vec<pb::RaycastResponse>> {
    let terms = &scene.shared;
    if rays.len() < 2 || terms.explains() {
        return None;
    }
    let questions: Vec<(Raycast, Option<ShapeId>)> =
        rays.iter().map(|ray| Some((asked::raycast(ray).ok()?, None))).collect::<Option<_>>()?;
    let found = fenced(ANSWERING, || {
        scene.ask_uncounted(terms, |meter| scene.snapshot.raycasts(&questions, &terms.filter, &terms.accuracy, meter))
    });
    let (found, _) = found.ok()?.ok()?;
    let info = scene.info(terms, Account::default());
    let told =
        found.iter().map(|found| Some(pb::RaycastResponse { info: info.clone(), ..found::raycast(found).ok()? }));
    let told: Vec<pb::RaycastResponse> = told.collect::<Option<_>>()?;
    scene.count(found.len() as u64, found.iter().filter(|found| found.verdict == Verdict::Undecided).count() as u64);
    rays.iter().zip(&told).for_each(|(ray, told)| scene.tell(|| ((*ray).clone().into(), Ok(told.clone().into()))));
    Some(told)
}
