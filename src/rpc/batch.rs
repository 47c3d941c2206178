//! `Batch`: questions of any kinds, answered on one tick; each fails by itself.

use wire::v1 as pb;

use super::{
    question::{self, Heading},
    raycast,
    scene::{Naming, Patience, Scene},
    turns::Turns,
};
use crate::{
    convert::number::at_most,
    problem::{Checked, Problem, Reason, Under},
};

/// Most questions of a batch.
const QUESTIONS: usize = 65_536;

/// Answers it on the scene's version.
///
/// # Errors
/// What is wrong with the batch itself; the deadline.
pub(super) async fn answer(sent: &pb::BatchRequest, scene: &Scene) -> Checked<pb::BatchResponse> {
    at_most("questions", sent.questions.len(), QUESTIONS)?;
    let shared = scene.shared.overridden_by(sent.options.as_deref())?.into_owned();
    let info = pb::AnswerInfo {
        tick: scene.snapshot.tick().get(),
        tick_fraction: scene.snapshot.fraction(),
        ..pb::AnswerInfo::default()
    };
    let scene = Scene { shared, naming: Naming::Nothing, patience: Patience::Short, ..scene.clone() };
    let mut answers = Vec::with_capacity(sent.questions.len());
    let mut turns = Turns::begun(scene.deadline);
    while let Some(rest) = sent.questions.get(answers.len()..).filter(|rest| !rest.is_empty()) {
        let plain_ray = |asked| raycast::plain(asked).filter(|ray| ray.session.is_empty());
        let rays: Vec<&pb::RaycastRequest> = rest.iter().take(raycast::TOGETHER).map_while(plain_ray).collect();
        if rays.len() > 1 {
            turns.next().await?;
            if let Some(told) = raycast::answer_together(&rays, &scene) {
                answers.extend(told.into_iter().map(|told| pb::Answer { answer: Some(told.into()) }));
                continue;
            }
        }
        for question in &rest[..rays.len().max(1)] {
            turns.next().await?;
            answers.push(answer_one(question, &scene, answers.len()).await);
        }
    }
    Ok(pb::BatchResponse { answers, info: Some(info) })
}

async fn answer_one(asked: &pb::Question, scene: &Scene, index: usize) -> pb::Answer {
    let answered = match check(asked) {
        Ok(heading) => question::answer_anywhere(&heading, asked, scene).await,
        Err(problem) => Err(problem),
    };
    let answered = answered.under_item("questions", index).unwrap_or_else(|problem| problem.into_wire().into());
    pb::Answer { answer: Some(answered) }
}

/// Checks that a question leaves to its batch what is the batch's to say.
fn check(asked: &pb::Question) -> Checked<Heading<'_>> {
    let heading = question::heading(asked)?;
    let refuse = |field: &str| {
        let what = "must be left out in a batch: the batch's own holds for all its questions";
        Err(Problem::at(field, Reason::OutOfLimits, what)).under(heading.name)
    };
    if !heading.session.is_empty() {
        return refuse("session");
    }
    if heading.options.is_some_and(|options| options.read_at.is_some()) {
        return refuse("options.read_at");
    }
    Ok(heading)
}
