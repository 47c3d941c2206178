//! `Explain`: a question answered together with all that its answer depends on.

use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Caller, Server, fitting, question, replay, scene::Scene};
use crate::{
    compute::{self, Weight},
    convert::item,
    problem::{Checked, Problem, Reason, Under},
    token::Role,
};

/// Answers a question and returns what it depends on.
///
/// # Errors
/// There is no question; who may not read the session; a version that is not held; the deadline; what it depends on is too
/// large.
pub(super) async fn answer(
    server: &Server,
    request: Request<pb::ExplainRequest>,
) -> Result<Response<pb::ExplainResponse>, Status> {
    let caller = Caller::of(&request);
    let pb::ExplainRequest { session, question, item } = request.into_inner();
    let entered = server.enter(&caller, &session, Role::Reader)?;
    let question = match (question, item) {
        (Some(question), None) => question,
        (None, Some(item)) => pb::Question { question: Some(item::asked(&item, &entered.geometries).under("item")?) },
        (Some(_), Some(_)) => {
            let what = "goes without question: leave one of the two out";
            return Err(Problem::at("item", Reason::OutOfLimits, what).into());
        }
        (None, None) => {
            let what = "is absent: send one, such as {\"raycast\": {\"direction\": {\"z\": 1}}}, or an item";
            return Err(Problem::at("question", Reason::Missing, what).into());
        }
    };
    let heading = question::heading(&question).under("question")?;
    if !heading.session.is_empty() {
        let what =
            "must be left out: the session beside the question holds, as in {\"session\": \"arena\", \"question\": {}}";
        let refused: Checked<()> = Err(Problem::at("session", Reason::OutOfLimits, what));
        refused.under(heading.name).under("question")?;
    }
    let scene = Scene::enter(server, &caller, &session, heading.options).await;
    let scene = scene.under(heading.name).under("question")?;
    let replay = compute::run(Weight::Heavy, "explaining a question", move || replay::keep(question, scene)).await?;
    Ok(Response::new(fitting(pb::ExplainResponse { replay: Some(replay) }, replay::SMALLER)?))
}
