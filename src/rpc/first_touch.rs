//! `FirstTouch`: when, in the past that is held, the subject touched something first.

use tonic::{Request, Response, Status};
use wire::v1::{self as pb, answer::Answer as Kind};

use super::{Caller, Server, scene::Scene};
use crate::{
    compute::{self, Weight},
    convert::first_touch,
    problem::Checked,
};

/// Answers a call, on another thread: many ticks may have to be prepared for it.
///
/// # Errors
/// What is wrong with the question.
pub(super) async fn call(
    server: &Server,
    request: Request<pb::FirstTouchRequest>,
) -> Result<Response<pb::FirstTouchResponse>, Status> {
    let caller = Caller::of(&request);
    let asked = request.into_inner();
    let scene = Scene::of(server, &caller, &asked).await?;
    let answered = compute::run(Weight::Heavy, "answering a question", move || {
        let answered = answer(&asked, &scene);
        scene.tell(|| (asked.into(), answered.clone().map(Kind::from)));
        answered
    })
    .await?;
    Ok(Response::new(answered))
}

/// Answers it on the history of the scene's version.
///
/// # Errors
/// What is wrong with the question, the deadline.
pub(super) fn answer(sent: &pb::FirstTouchRequest, scene: &Scene) -> Checked<pb::FirstTouchResponse> {
    let question = first_touch::first_touch(sent, &scene.session.geometries, &scene.snapshot)?;
    let terms = scene.shared.overridden_by(sent.options.as_deref())?;
    let (found, account) =
        scene.ask(&terms, |meter| scene.snapshot.first_touch(&question, &terms.filter, &terms.accuracy, meter))?;
    Ok(pb::FirstTouchResponse { info: scene.info(&terms, account), ..first_touch::touched(&found)? })
}
